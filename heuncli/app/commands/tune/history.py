"""All variants in the order in which they were tried, as CSV with the best goal so far."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator

from heuncli.analyses.tune.results import TuneResults


def iter_best(results: TuneResults) -> Iterator[float | None]:
    """Yield, for each variant, the best goal so far among those that meet all constraints, or None."""
    best: float | None = None
    constraints, sign = results.task.constraints, results.task.goal.sign
    for trial in results.history:
        if trial.is_solved and all(
            one.is_met(value) for one, value in zip(constraints, trial.constraint_values, strict=True)
        ):
            best = trial.goal if best is None else sign * min(sign * best, sign * trial.goal)
        yield best


def to_csv(results: TuneResults) -> str:
    """Format one line per variant: variables in their units, measures in SI with the goal's error and instant."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    task = results.task
    names = [f"{one.name} [{one.unit}]" if one.unit else one.name for one in task.variables]
    measures = [f"{one.measure} [{one.unit}]" if one.unit else one.measure for one in task.constraints]
    goal = f"{task.goal.measure} [{task.goal.unit}]" if task.goal.unit else task.goal.measure
    writer.writerow(["number", "phase", *names, goal, "error", "at [s]", *measures, "best so far", "code"])
    for trial, best in zip(results.history, iter_best(results), strict=True):
        values = [repr(one.to_number(x)) for one, x in zip(task.variables, trial.place, strict=True)]
        found = trial.outcome.measures
        cells = (
            [_format_number(found[0].value), _format_number(found[0].error), _format_number(found[0].time)]
            if found
            else [""] * 3
        )
        others = [_format_number(one.value) for one in found[1:]] if found else [""] * len(measures)
        code = "" if trial.is_solved else trial.failure.code
        writer.writerow([trial.number, trial.phase, *values, *cells, *others, _format_number(best), code])
    return text.getvalue()


def _format_number(value: float | None) -> str:
    return "" if value is None else repr(value)
