"""`heun methods`: list the integration methods and their purpose."""

from __future__ import annotations

from typing import Annotated, Any

from heuncli.app.cli.documents import emit_document
from heuncli.app.cli.options import OUTPUT, make_format_option
from heuncli.app.cli.target import choose_format
from heuncli.base.method_rows import AUTO, DEFAULT, METHODS
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import OutputColumn, OutputDocument, OutputTable


class MethodsRequest(NamedTuple):
    """The options and arguments of `heun methods`."""

    format: Annotated[
        str | None,
        make_format_option(FORMATS),
    ] = None
    output: Annotated[str | None, OUTPUT] = None


FORMATS = ("table", "json")
HEADING = "METHODS  integration methods, for analysis: {method: NAME} and --method NAME"
COLUMNS = (
    OutputColumn("name", "text"), OutputColumn("order"), OutputColumn("kind", "text"), OutputColumn("steps", "text"),
    OutputColumn("orientation", "text", key="attitude"), OutputColumn("purpose", "text"),
)  # fmt: skip
NOTES = (
    f"{AUTO} (default) selects by the model and its behaviour during the run: normally {DEFAULT}.",
    "steps: adaptive steps follow analysis: {tolerance: 1e-9}; fixed steps are set by analysis: {step: 0.001}.",
    "orientation: parameters of a body's orientation within a step. SciPy methods are independent checks.",
)


def main(request: MethodsRequest) -> int:
    """Run the command; returns the exit code."""
    form = choose_format(request.format, request.output, FORMATS)
    rows = [tuple(getattr(method, column.name) for column in COLUMNS) for method in METHODS]
    emit_document(OutputDocument(parts=[OutputTable(HEADING, COLUMNS, rows, NOTES)], make_block=make_block), form,
                  request.output)  # fmt: skip
    return 0


def make_block() -> dict[str, Any]:
    """Make the JSON: the default, and a mapping for each method."""
    keys = [column.name for column in COLUMNS]
    return {"default": AUTO, "methods": [{key: getattr(method, key) for key in keys} for method in METHODS]}
