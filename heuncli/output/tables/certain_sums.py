"""Certain sums in plain words: `joints.top Fz + joints.bottom Fz = 49.05 N; the split is open`."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from heuncli.output.tables.table_blocks import short
from heuncli.output.tables.text_table import TextTable
from heuncli.results.results import Array, CertainSum, Results
from heuncli.results.results_schema import AXIAL_FORCES, SECTION_FORCES, XYZ
from heuncli.study.quantities.digits import Certainty, beyond_horizon, largest, write
from heuncli.study.quantities.table_units import Shown

MOST_TERMS = 6  # tables show short sums of forces, JSON all
TURNS = "(t): a factor that turns with the pose, as at the first instant; --format json has them all"
FORCES = frozenset({"force", *AXIAL_FORCES, *SECTION_FORCES})


def sums_table(
    results: Results, certain: Certainty, beyond: Results | None = None, unit: Shown = ("N", 1.0)
) -> TextTable | None:
    """The sums that are certain although their terms are open; None where there are none.

    beyond: the last instant, where the run ends beyond its horizon; unit: that is shown, for N·s of impulses.
    """
    if not results.certain_sums:
        return None
    ends = [None] * len(results.certain_sums) if beyond is None else beyond.certain_sums
    told = [_line(block, certain, end, unit) for block, end in zip(results.certain_sums, ends, strict=True)]
    lines = [line for line in told if line is not None]
    left = len(results.certain_sums) - len(lines)
    rest = f"{left} more in --format json (moments, or more than {MOST_TERMS} terms)" if left else ""
    notes = [*lines, *([TURNS] if any("(t)·" in line for line in lines) else []), *([rest] if rest else [])]
    axes = ", world axes" if "axes" in results.model else ""  # elsewhere others are told
    return TextTable(f"CERTAIN SUMS  of components that redundancy leaves open{axes}", notes=tuple(notes))


def _line(block: CertainSum, certain: Certainty, beyond: CertainSum | None, of: Shown) -> str | None:
    terms = {path: np.atleast_1d(np.asarray(factor, dtype=np.float64)) for path, factor in block["terms"].items()}
    if len(terms) > MOST_TERMS or not all(_is_force(path) for path in terms):
        return None
    unit, size = of
    values = size * np.asarray(block["value"], dtype=np.float64)
    scale = largest(values)
    numbers = [values[0], values[-1], np.nanmin(values), np.nanmax(values)]
    texts = write(numbers, certain.style("reactions", unit, scale))
    if beyond is not None:
        texts[1] = beyond_horizon(size * beyond["value"][-1], unit, certain, texts[1])
    if texts == ["0"] * 4 and _opposite(terms):
        return " = ".join(map(label, terms)) + "; the size is open"
    left = _sum(terms)
    if len(set(texts)) == 1:
        value = "0" if texts[0] == "0" else f"{texts[0]} {unit}"
        return f"{left} = {value}; the split is open"
    first, last, low, high = texts
    course = f"{first} {unit} first, {last} {unit} last, {low} to {high} {unit} in the samples"
    return f"{left} = {course}; the split is open"


def label(path: str) -> str:
    """A path as the tables call it: `joints.top.force.z` is `joints.top Fz`."""
    name, _, component = path.rpartition(".")
    if component in XYZ:
        name, _, quantity = name.rpartition(".")
        component = f"{quantity}.{component}"
    return f"{name} {short(component)}"


def _is_force(path: str) -> bool:
    return bool(FORCES.intersection(path.split(".")[-2:]))


def _opposite(terms: Mapping[str, Array]) -> bool:
    """Whether the sum states that two components are equal."""
    factors = list(terms.values())
    return len(factors) == 2 and bool(np.all(factors[0] + factors[1] == 0.0))


def _sum(terms: Mapping[str, Array]) -> str:
    text = ""
    for path, factors in terms.items():
        steady = bool(np.all(factors == factors[0]))
        size = abs(float(factors[0]))
        number = "" if steady and size == 1.0 else f"{size:.4g}·" if steady else f"{size:.4g}(t)·"
        sign = "−" if factors[0] < 0.0 else "+"
        text += f" {sign} {number}{label(path)}" if text else f"{'−' if sign == '−' else ''}{number}{label(path)}"
    return text
