"""The error of one measure as its run states it, absolute and in SI."""

from __future__ import annotations

import math
from collections.abc import Sequence

from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.results.path_words import error_kind_of_path, find_quantity, split_path
from heuncli.results.results_schema import CUT, EVENTS, IMPULSES, MAGNITUDES
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.selection import list_entries, split_entry
from heuncli.study.quantities.digits import find_load_error, find_stated_errors, is_load
from heuncli.study.quantities.labels import make_unit_labels
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.study import Study

SI = Units({})
# rounding of the polynomial of squares along a series of cuts, relative to the largest of these
SQUARE_ROUNDING = 4.0 * tolerances.EPS


def find_unit(path: str, spec: Spec) -> str:
    """Return the SI unit of a path; empty if it has none, or if it is unknown before the run."""
    words = split_path(path)
    entry, remaining = split_entry(words, list_entries(spec))
    keys = [*entry, *remaining] if entry is not None else words
    while keys and find_quantity(keys) is None:  # words after the quantity select one of its numbers: .x, .0.x
        keys.pop()
    return _find_unit_of_keys(keys, spec)


def _find_unit_of_keys(keys: Sequence[str], spec: Spec) -> str:
    """Find the SI unit of the quantity under some keys; if it has two, whether the joint turns or slides decides."""
    row = find_quantity(keys)
    if row is None or not row.units:
        return ""
    entry_keys = keys[2:] if keys[0] == IMPULSES else keys
    turns = len(row.units) > 1 and make_unit_labels(spec).is_rotational(entry_keys[0], entry_keys[1])
    return row.units[1 if turns else 0]


def measure_uncertainty(study: Study, path: str, how: str = "", value: float = math.nan) -> float | None:
    """Find the error of the number at a path, SI, as tables and golden files state it; None if the run states none.

    how, value: of a measure: an event's value decides which instant it is, and a least magnitude along a series of cuts
    is less certain
    """
    numbers = study.find_numbers(path)
    keys = numbers.keys
    if keys[0] == EVENTS:
        return _find_event_error(keys, value, study)
    unit = _find_unit_of_keys(keys, study.spec)
    if not unit:
        return None
    error = _find_unit_error(keys, unit, study)
    is_magnitude = numbers.is_vector or keys[-1] in MAGNITUDES
    if error is not None and how == "min" and CUT in numbers.axes and is_magnitude:
        return max(error, _find_root_error(value, study.magnitudes.by_unit.get(unit, 0.0)))
    return error


def find_search_error(study: Study, keys: Sequence[str]) -> float:
    """Find the error to which extremes of the quantity under some keys are searched; nan if it is unknown.

    It is the one that the check run found, without the estimates, which need all results. If angles and travels have
    different units, it is the smaller of the two errors.
    """
    row = find_quantity(keys)
    if row is None:
        return math.nan
    kind = error_kind_of_path(keys[0], ".".join(keys[1:-1]), keys[-1])
    magnitudes = study.load_magnitudes if all(is_load(kind, unit) for unit in row.units) else study.magnitudes
    lost = magnitudes.rounding_errors()
    error_kind = {"travels": "motion"}.get(kind, kind) if (kind, row.units[0]) not in magnitudes.errors else kind
    known = [(magnitudes.errors.get((error_kind, unit), 0.0), lost.get(unit, 0.0)) for unit in row.units]
    return min(map(max, known)) or math.nan


def _find_unit_error(keys: tuple[str, ...], unit: str, study: Study) -> float | None:
    """Return the error of numbers of a kind and unit."""
    kind = error_kind_of_path(keys[0], ".".join(keys[1:-1]), keys[-1])
    magnitudes = study.load_magnitudes if is_load(kind, unit) else study.magnitudes
    if (kind, unit) in magnitudes.errors:
        return max(magnitudes.errors[kind, unit], magnitudes.rounding_errors().get(unit, 0.0))
    labels = replace(make_unit_labels(study.spec), units=SI)
    if is_load(kind, unit) and study.results.horizon is None:
        return find_load_error(study.results, labels, magnitudes, kind, unit) or None
    return find_stated_errors(study.results, labels, study.magnitudes).error_of(kind, unit) or None


def _find_root_error(value: float, largest: float) -> float:
    """Find the error of the least magnitude along a series of cuts.

    It is the root of a polynomial that is as accurate as its largest value.
    """
    rounding = SQUARE_ROUNDING * largest * largest
    return rounding / max(value, math.sqrt(rounding)) if rounding > 0.0 else 0.0


def _find_event_error(keys: tuple[str, ...], value: float, study: Study) -> float | None:
    """Return the error of an event's instant [s]."""
    event = study.results.events.get(keys[1])
    if event is None or "time" not in keys[2:3]:
        return None
    errors = [e for t, e in zip(event["time"], event["error"], strict=True) if float(t) == value]
    return float(max(errors)) if errors and all(map(math.isfinite, errors)) else None
