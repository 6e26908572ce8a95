"""The units of measured numbers: those of `--units` where they apply, else SI."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from heuncli.base.errors import Problem, UsageError
from heuncli.results.path_words import find_quantity, split_path
from heuncli.results.results import Results
from heuncli.scene.file_format.models import Spec
from heuncli.study.quantities.table_units import DisplayUnit, Units, find_si_unit
from heuncli.study.queries.measure import MeasureRequest
from heuncli.study.queries.measure_uncertainty import find_unit
from heuncli.study.queries.study import Study

SUMS = "certain_sums"
EXAMPLES = {
    "N": "kN", "N·m": "kN,m", "N·s": "kN", "N·m·s": "kN,m", "m": "mm", "m/s": "mm", "m/s²": "mm", "rad": "deg",
    "rad/s": "rpm", "rad/s²": "deg", "Pa": "MPa", "J": "kJ", "W": "kW",
}  # fmt: skip


def require_fitting_units(requests: Sequence[MeasureRequest], spec: Spec, units: Units, words: str | None) -> None:
    """Raise UsageError [bad-option] if none of the units of `--units` applies to any of the measures."""
    if words is None:
        return
    known = {request.path: find_unit(request.path, spec) for request in requests}
    if any(_is_unclear(path) or _find_chosen_unit(unit, units, words) is not None for path, unit in known.items()):
        return
    stated = ", ".join(
        f"{path} is in {unit}" if unit not in ("", "1") else f"{path} has no unit" for path, unit in known.items()
    )
    examples = [EXAMPLES[unit] for unit in known.values() if unit in EXAMPLES]
    hint = (
        f"for example --units {examples[0]}; without --units it is printed in SI" if examples else "leave --units out"
    )
    raise UsageError(Problem("bad-option", f"--units {words}: {stated}", hint=hint))


def choose_units(
    requests: Sequence[MeasureRequest], study: Study, units: Units, words: str | None
) -> list[DisplayUnit]:
    """Return the unit in which each measure is printed, and how many of it make one SI unit."""
    found = []
    for request in requests:
        unit = _find_unit_after_run(request.path, study)
        found.append((words is not None and _find_chosen_unit(unit, units, words)) or (unit, 1.0))
    return found


def describe_units(requests: Sequence[MeasureRequest], display_units: Sequence[DisplayUnit]) -> list[str]:
    """Return a line for the unit of each measure; of several with the measure."""
    lines = [f"unit: {unit or '1'}" for unit, _ in display_units]
    if len(lines) == 1:
        return lines
    return [f"{line} ({_describe(request)})" for line, request in zip(lines, requests, strict=True)]


def _describe(request: MeasureRequest) -> str:
    how = {"abs": "max abs", "at": f"at {request.time:g}" if request.time is not None else "at"}
    return f"{how.get(request.how, request.how)} {request.path}".strip()


def _find_chosen_unit(unit: str, units: Units, words: str) -> DisplayUnit | None:
    """Return the unit that `--units` sets in place of an SI unit; MPa, the unit of tables, only if it is asked for."""
    if unit == "Pa" and all(find_si_unit(word.strip())[0] != unit for word in words.split(",")):
        return None
    return units.display_units.get(unit)


def _is_unclear(path: str) -> bool:
    """Whether the unit of a path is known only after the run."""
    return SUMS in split_path(path)


def _find_unit_after_run(path: str, study: Study) -> str:
    """Return the SI unit of a path; a determinate sum is one of moments if no force is among its terms."""
    if not _is_unclear(path):
        return find_unit(path, study.spec)
    return find_sum_unit(study.results, study.find_numbers(path).keys)


def find_sum_unit(results: Results, keys: Sequence[str]) -> str:
    """Return the unit of a determinate sum: that of a moment if no force is among its terms; of an impulse times
    seconds.
    """
    block: Any = vars(results)
    for key in keys[:-1]:
        block = block[int(key) if isinstance(block, list) else key]
    row = find_quantity(tuple(keys))
    return "" if row is None else row.select_unit(turning=not any(".force." in term for term in block["terms"]))
