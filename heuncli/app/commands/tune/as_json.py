"""A tuning as JSON, and its history as CSV: every variant that was tried."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from heuncli.analyses.tune.results import ToleranceMove, ToleranceRange, Trial, TuneResults, make_values
from heuncli.analyses.variants.measures import VariantResult
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import Cell, OutputColumn, OutputTable, format_head
from heuncli.version import VERSION


class TunedScene(NamedTuple):
    """The tuned spec, and the command line that gives the best variant's numbers with `heun run`."""

    title: str
    path: str
    sha256: str
    line: str


def to_block(results: TuneResults, scene: TunedScene) -> dict[str, Any]:
    """Return the whole result as the JSON has it."""
    task, best = results.task, results.best
    assert best is not None
    goal = task.goal
    return {
        "title": scene.title,
        "spec": {"path": scene.path, "sha256": scene.sha256},
        "version": VERSION,
        "ended": results.ending,
        "converged": results.ending == "converged",
        "feasible": results.is_feasible,
        "goal": {
            "measure": goal.measure,
            "unit": goal.unit,
            "kind": "maximise" if goal.is_maximised else "minimise",
            "before": make_measure_block(results.spec_outcome, 0),
            "best": make_measure_block(best.outcome, 0),
            "gain": results.gain,
            "floor": results.floor,
        },
        "variables": [make_variable_block(results, index) for index in range(len(task.variables))],
        "constraints": [make_constraint_block(results, index) for index in range(len(task.constraints))],
        "set": results.best_texts,
        "command": scene.line,
        "evaluations": len(results.history),
        "allowed": task.max_variants,
        "seed": task.seed,
        "unsolved": dict(results.failures),
        "history": [
            make_trial_block(results, trial, best)
            for trial, best in zip(results.history, iter_best(results), strict=True)
        ],
    }


def make_variable_block(results: TuneResults, index: int) -> dict[str, Any]:
    """Return one variable as the JSON has it.

    Its moves say how far it may go down and up until the goal is worse by the floor, and by a hundredth.
    """
    variable = results.task.variables[index]
    assert results.best is not None
    block: dict[str, Any] = {
        "name": variable.name,
        "unit": variable.unit,
        "low": variable.low,
        "high": variable.high,
        "before": variable.spec_value,
        "value": variable.to_number(results.best.place[index]),
        "active": results.find_bound(index) or None,
    }
    range_ = results.tolerance_ranges[index] if results.tolerance_ranges else ToleranceRange()
    block["moves"] = {
        "floor": [*map(make_move_block, range_.floor_moves)],
        "hundredth": [*map(make_move_block, range_.hundredth_moves)],
    }
    return block


def make_move_block(move: ToleranceMove | None) -> dict[str, Any] | None:
    """Return a move as the JSON has it: how far, what ends it, and the measure that jumps there."""
    return (
        None
        if move is None
        else {"by": move.distance, "until": move.limit} | ({"jumps": move.jumps} if move.jumps else {})
    )


def make_constraint_block(results: TuneResults, index: int) -> dict[str, Any]:
    """Return one constraint as the JSON has it; `left` is the margin to its limit, negative beyond it."""
    constraint = results.task.constraints[index]
    assert results.best is not None
    best = make_measure_block(results.best.outcome, index + 1)
    value = results.best.constraint_values[index]
    return {
        "measure": constraint.measure,
        "sign": constraint.relation,
        "limit": constraint.value,
        "unit": constraint.unit,
        "before": make_measure_block(results.spec_outcome, index + 1),
        "best": best,
        "left": -constraint.compute_excess(value),
        "met": constraint.is_met(value),
        "active": results.active_constraints[index],
    }


def make_measure_block(outcome: VariantResult, index: int) -> dict[str, Any] | None:
    """Return the value of a measure, or code and reason if the variant could not be solved."""
    if not outcome.measures:
        return {"code": outcome.code, "reason": outcome.reason}
    measure = outcome.measures[index]
    block: dict[str, Any] = {"value": measure.value, "error": measure.error, "at": measure.time}
    return block | ({"word": measure.word} if measure.word else {})


def make_trial_block(results: TuneResults, trial: Trial, best: float | None) -> dict[str, Any]:
    """Return a tried variant as the JSON has it, and the best goal so far."""
    values = make_values(results.task.variables, trial.place)
    block: dict[str, Any] = {"number": trial.number, "phase": trial.phase}
    block["set"] = {name: value.format() for name, value in values.items()}
    if trial.is_solved:
        block |= {"goal": trial.goal, "constraints": list(trial.constraint_values)}
    else:
        block |= {"goal": None, "code": trial.failure.code}
    return block | {"best": best}


def iter_best(results: TuneResults) -> Iterator[float | None]:
    """Yield, for each variant, the best goal so far among those that meet all constraints, or None."""
    best: float | None = None
    constraints, sign = results.task.constraints, results.task.goal.sign
    for trial in results.history:
        if trial.is_solved and all(
            constraint.is_met(value) for constraint, value in zip(constraints, trial.constraint_values, strict=True)
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
