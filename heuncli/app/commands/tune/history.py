"""All variants in the order in which they were tried, as CSV with the best goal so far."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.analyses.tune.results import TuneResults
from heuncli.output.documents.document import Cell, OutputColumn, OutputTable, format_head


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


def make_history(results: TuneResults) -> OutputTable:
    """Make the table of the variants: variables in their units, measures in SI with the goal's error and instant."""
    task = results.task
    variables = [format_head(one.name, one.unit) for one in task.variables]
    measures = [format_head(one.measure, one.unit) for one in task.constraints]
    goal = format_head(task.goal.measure, task.goal.unit)
    heads = ["number", "phase", *variables, goal, "error", "at [s]", *measures, "best so far", "code"]
    rows: list[tuple[Cell, ...]] = []
    for trial, best in zip(results.history, iter_best(results), strict=True):
        values = [one.to_number(x) for one, x in zip(task.variables, trial.place, strict=True)]
        found = trial.outcome.measures
        cells = (found[0].value, found[0].error, found[0].time) if found else (None,) * 3
        others = [one.value for one in found[1:]] if found else [None] * len(measures)
        rows.append(
            (trial.number, trial.phase, *values, *cells, *others, best, "" if trial.is_solved else trial.failure.code)
        )
    return OutputTable("", [OutputColumn(head) for head in heads], rows)
