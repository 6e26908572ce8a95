"""The error of one measure as its run states it, absolute and in SI."""

from __future__ import annotations

import math

from heuncli.records import replace
from heuncli.report.digits import certainty
from heuncli.report.labels import labels_of
from heuncli.report.table_units import Units
from heuncli.results_paths import find
from heuncli.results_schema import BLOWS, EVENTS, kind_of_error, quantity
from heuncli.spec.models import Spec
from heuncli.study.ask.measure import MeasureRequest, Peak, stated_error
from heuncli.study.ask.study import Study

SI = Units({})


def unit_of(path: str, spec: Spec) -> str:
    """The SI unit of what a path leads to; empty where it has none, or that is not known before the run."""
    keys = [word for word in path.split(".") if word]
    row = quantity(keys)
    if row is None or not row.units:
        return ""
    of_blow = keys[0] == BLOWS
    own = keys[2:] if of_blow else keys
    turns = len(row.units) > 1 and labels_of(spec).turns(own[0], own[1])
    return row.units[1 if turns else 0]


def error_of(asked: MeasureRequest, peak: Peak, study: Study) -> float | None:
    """The error of a measure; None where the run states none, as of what is counted."""
    keys = find(study.results, asked.path).keys
    if keys[0] == EVENTS:
        return _of_event(keys, peak, study)
    row = quantity(keys)
    if row is None or not row.units:
        return None
    kind, known = kind_of_error(keys[0], ".".join(keys[1:-1]), keys[-1]), study.magnitudes.errors
    if any((kind, unit) in known for unit in row.units):
        error = stated_error(study, keys)
        return None if math.isnan(error) else float(error)
    certain = certainty(study.results, replace(labels_of(study.spec), units=SI), study.magnitudes)
    error = min(certain.error(kind, unit) for unit in row.units)
    return error or None


def _of_event(keys: tuple[str, ...], peak: Peak, study: Study) -> float | None:
    """The error of an event's instant [s]."""
    event = study.results.events.get(keys[1])
    if event is None or "time" not in keys[2:3]:
        return None
    errors = [e for t, e in zip(event["time"], event["error"], strict=True) if float(t) == peak.value]
    return float(max(errors)) if errors and all(map(math.isfinite, errors)) else None
