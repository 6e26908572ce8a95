"""All variants in the order in which they were tried: as CSV, and the best so far."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator

from heuncli.analyses.tune.results import TuneResults


def best_by(found: TuneResults) -> Iterator[float | None]:
    """The best goal so far of those that keep all constraints, a variant each; None: there was none."""
    best: float | None = None
    constraints, sign = found.task.constraints, found.task.goal.sign
    for trial in found.history:
        if trial.solved and all(one.met(value) for one, value in zip(constraints, trial.kept_to, strict=True)):
            best = trial.goal if best is None else sign * min(sign * best, sign * trial.goal)
        yield best


def to_csv(found: TuneResults) -> str:
    """A line a variant: variables in their units, measures in SI with the goal's error and instant."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    task = found.task
    names = [f"{one.name} [{one.unit}]" if one.unit else one.name for one in task.variables]
    measures = [f"{one.measure} [{one.unit}]" if one.unit else one.measure for one in task.constraints]
    goal = f"{task.goal.measure} [{task.goal.unit}]" if task.goal.unit else task.goal.measure
    writer.writerow(["number", "phase", *names, goal, "error", "at [s]", *measures, "best so far", "code"])
    for trial, best in zip(found.history, best_by(found), strict=True):
        values = [repr(one.value(x)) for one, x in zip(task.variables, trial.place, strict=True)]
        readings = trial.outcome.readings
        cells = [_text(readings[0].value), _text(readings[0].error), _text(readings[0].at)] if readings else [""] * 3
        others = [_text(one.value) for one in readings[1:]] if readings else [""] * len(measures)
        code = "" if trial.solved else trial.failure[0]
        writer.writerow([trial.number, trial.phase, *values, *cells, *others, _text(best), code])
    return text.getvalue()


def _text(value: float | None) -> str:
    return "" if value is None else repr(value)
