"""The list of integration methods, as a table and as plain data for JSON."""

from __future__ import annotations

from typing import Any

from heuncli.base.method_rows import AUTO, DEFAULT, METHODS
from heuncli.output.tables.text_table import TextColumn, TextTable

HEADING = "METHODS  integration methods, for analysis: {method: NAME} and --method NAME"
COLUMNS = tuple(
    TextColumn(head, "point" if head == "order" else "left")
    for head in ("name", "order", "kind", "steps", "orientation", "purpose")
)
NOTES = (
    f"{AUTO} (default) selects by the model and its behaviour during the run: normally {DEFAULT}.",
    "steps: adaptive steps follow analysis: {tolerance: 1e-9}; fixed steps are set by analysis: {step: 0.001}.",
    "orientation: parameters of a body's orientation within a step. SciPy methods are independent checks.",
)


def make_methods_table() -> TextTable:
    """Make the table with a row for each method."""
    rows = tuple((m.name, str(m.order), m.kind, m.steps, m.attitude, m.purpose) for m in METHODS)
    return TextTable(HEADING, COLUMNS, rows, NOTES)


def to_json_block() -> dict[str, Any]:
    """Return the methods as plain data for JSON: the default, and a mapping for each."""
    keys = ("name", "order", "kind", "steps", "attitude", "purpose")
    return {"default": AUTO, "methods": [{key: getattr(m, key) for key in keys} for m in METHODS]}
