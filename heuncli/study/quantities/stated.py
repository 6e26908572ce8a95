"""The error of one measure as its run states it, absolute and in SI."""

from __future__ import annotations

import math
from collections.abc import Sequence

from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.results.results_schema import BLOWS, CUT, EVENTS, MAGNITUDES, kind_of_error, quantity
from heuncli.results.run_places import words_of
from heuncli.scene.file_format.models import Spec
from heuncli.study.ask.measure import MeasureRequest, Peak
from heuncli.study.ask.study import Study
from heuncli.study.model.selection import entries_of, entry_at
from heuncli.study.quantities.digits import certainty, error_of_load, is_of_load
from heuncli.study.quantities.labels import labels_for_units
from heuncli.study.quantities.table_units import Units

SI = Units({})
SQUARED = 4.0 * tolerances.EPS  # of the largest square along a run of cuts: what its polynomial loses of a square


def unit_of(path: str, spec: Spec) -> str:
    """The SI unit of what a path leads to; empty where it has none, or that is not known before the run."""
    words = words_of(path)
    entry, rest = entry_at(words, entries_of(spec))
    keys = [*entry, *rest] if entry is not None else words
    while keys and quantity(keys) is None:  # what stands behind the quantity names one of its numbers: .x, .0.x
        keys.pop()
    return _unit(keys, spec)


def _unit(keys: Sequence[str], spec: Spec) -> str:
    """The SI unit of the quantity under some keys; of two that of what turns, or slides."""
    row = quantity(keys)
    if row is None or not row.units:
        return ""
    own = keys[2:] if keys[0] == BLOWS else keys
    turns = len(row.units) > 1 and labels_for_units(spec).turns(own[0], own[1])
    return row.units[1 if turns else 0]


def error_of(asked: MeasureRequest, peak: Peak, study: Study) -> float | None:
    """The error of a measure, as tables and goldens state it; None where the run states none, as of what is counted."""
    there = study.numbers(asked.path)
    keys = there.keys
    if keys[0] == EVENTS:
        return _of_event(keys, peak, study)
    unit = _unit(keys, study.spec)
    if not unit:
        return None
    error = _of_unit(keys, unit, study)
    if error is not None and asked.how == "min" and CUT in there.axes and (there.of_vectors or keys[-1] in MAGNITUDES):
        return max(error, _of_root(peak.value, study.magnitudes.by_unit.get(unit, 0.0)))
    return error


def _of_unit(keys: tuple[str, ...], unit: str, study: Study) -> float | None:
    """The error of numbers of a kind and unit."""
    kind = kind_of_error(keys[0], ".".join(keys[1:-1]), keys[-1])
    of = study.load_magnitudes if is_of_load(kind, unit) else study.magnitudes
    if (kind, unit) in of.errors:
        return max(of.errors[kind, unit], of.lost().get(unit, 0.0))
    labels = replace(labels_for_units(study.spec), units=SI)
    if is_of_load(kind, unit) and study.results.horizon is None:
        return error_of_load(study.results, labels, of, kind, unit) or None
    return certainty(study.results, labels, study.magnitudes).error(kind, unit) or None


def _of_root(value: float, largest: float) -> float:
    """The error of the least magnitude along a run of cuts: the root of a polynomial, known as well as its largest."""
    lost = SQUARED * largest * largest
    return lost / max(value, math.sqrt(lost)) if lost > 0.0 else 0.0


def _of_event(keys: tuple[str, ...], peak: Peak, study: Study) -> float | None:
    """The error of an event's instant [s]."""
    event = study.results.events.get(keys[1])
    if event is None or "time" not in keys[2:3]:
        return None
    errors = [e for t, e in zip(event["time"], event["error"], strict=True) if float(t) == peak.value]
    return float(max(errors)) if errors and all(map(math.isfinite, errors)) else None
