"""Make the document of a tuning: how it ended, the variables, the measures, and the command line to paste.

JSON has it as plain data, CSV its history.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from heuncli.analyses.tune.results import (
    ToleranceMove,
    ToleranceRange,
    Trial,
    TuneResults,
    make_values,
)
from heuncli.analyses.variants.measures import MeasureValue, VariantResult
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import (
    Cell,
    NumberCell,
    OutputColumn,
    OutputDocument,
    OutputTable,
    Part,
    Sentence,
    Verbatim,
    format_head,
    make_text_columns,
)
from heuncli.study.quantities.digits import choose_style, format_error
from heuncli.study.quantities.table_units import Units
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
        "floor": [*map(make_move_block, range_.of_floor)],
        "hundredth": [*map(make_move_block, range_.of_hundredth)],
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


VARIABLES = "VARIABLES  values and bounds, in the unit of the bounds"
MOVES = "MOVES  how far each variable alone may change, down and up, before the goal gets worse"
MEASURES = "MEASURES  goal first; margin to the limit, negative if exceeded"
PASTED = "Command that reproduces these numbers exactly:"
AT_BOUND = {"low": "lower bound", "high": "upper bound", "": ""}
UNTIL = {"worse": "", "bound": " (bound)", "jump": " (jumps)", "less": "", "more": ""}
BOUND_OF = {"less": "<", "more": ">"}


def make_document(results: TuneResults, scene: TunedScene, units: Units) -> OutputDocument:
    """Make the document: how it ended, the variables, the measures, and the command line to paste."""
    tables = [make_variables_table(results), make_measures_table(results, units)]
    if results.tolerance_ranges:
        tables.insert(1, make_moves_table(results, units))
    parts: list[Part] = [*tables, Sentence(PASTED), Verbatim(scene.line)]
    return OutputDocument(scene.title, list(list_facts(results, units)), parts, lambda: to_block(results, scene))


def list_facts(results: TuneResults, units: Units) -> Iterator[tuple[str, str]]:
    """Yield label and text of the lines above the tables."""
    task = results.task
    names = ", ".join(variable.name for variable in task.variables)
    kind = "maximise" if task.goal.is_maximised else "minimise"
    yield "tune", f"{kind} {task.goal.measure}, by {names}"
    yield "", describe_ending(results, units)
    if not results.is_feasible:
        yield "", describe_nearest_unmet(results, units)
    if results.is_spec_better:
        yield "", "the spec's own values, outside the bounds, are better"
    for text in describe_jumps(results):
        yield "", text
    yield "", f"{len(results.history)} variants{format_failures(results)}"


def describe_jumps(results: TuneResults) -> Iterator[str]:
    """Describe the jumps on which the best rests: a move beyond a certain distance changes a measure at once."""
    for variable, range_ in zip(results.task.variables, results.tolerance_ranges, strict=False):
        for direction, nearer, farther in zip(("down", "up"), range_.of_floor, range_.of_hundredth, strict=True):
            jumping = next((move for move in (nearer, farther) if move is not None and move.jumps), None)
            if jumping is not None:
                distance = f"{jumping.distance:.2g} {variable.unit}".rstrip()
                where = f"{variable.name} goes {direction} by more than {distance}"
                yield f"beside a jump: {jumping.jumps} jumps where {where}"


def format_failures(results: TuneResults) -> str:
    """Format how many variants could not be solved, and why; empty if all were."""
    count = sum(results.failures.values())
    codes = ", ".join(f"{code} {count}" for code, count in sorted(results.failures.items()))
    return f", of which {count} could not be solved: {codes}" if count else ""


def describe_ending(results: TuneResults, units: Units) -> str:
    """Describe how the search ended."""
    if results.ending == "converged":
        assert results.gain is not None
        unit, size = units.find(results.task.goal.unit)
        gain_text = f"{format_error(size * max(results.gain, results.floor))} {unit}".rstrip()
        return f"converged: two restarts improved the goal by no more than {gain_text}"
    if results.ending == "infeasible":
        return "no values meet all limits: these violate them least"
    why = (
        "the time limit is reached"
        if results.ending == "time"
        else f"all {results.task.max_variants} evaluations are used up"
    )
    result_text = "this is the best so far" if results.is_feasible else "no values meet all limits so far"
    advice = (
        f"; --evaluations {2 * results.task.max_variants} continues the search"
        if results.ending == "evaluations"
        else ""
    )
    return f"not converged: {why}; {result_text}{advice}"


def describe_nearest_unmet(results: TuneResults, units: Units) -> str:
    """Describe the constraint that is nearest to being met, among those that are not."""
    index = results.nearest_violated
    assert index is not None and results.best is not None
    constraint = results.task.constraints[index]
    unit, size = units.find(constraint.unit)
    excess, limit = size * constraint.compute_excess(results.best.constraint_values[index]), size * constraint.value
    condition = f"{constraint.measure} {constraint.relation} {limit:.6g} {unit}"
    return f"closest limit: {condition}, exceeded by {excess:.3g} {unit}".rstrip()


def make_variables_table(results: TuneResults) -> OutputTable:
    """Make the table of the variables, one row each."""
    assert results.best is not None
    columns = (
        OutputColumn("variable", "path"), OutputColumn("spec"), OutputColumn("best"), OutputColumn("from"),
        OutputColumn("to"), OutputColumn("at", "verdict"),
    )  # fmt: skip
    rows = [
        (format_head(variable.name, variable.unit), variable.spec_value, variable.to_number(results.best.place[index]),
         variable.low, variable.high, AT_BOUND[results.find_bound(index)])
        for index, variable in enumerate(results.task.variables)
    ]  # fmt: skip
    return OutputTable(VARIABLES, columns, rows)


def make_moves_table(results: TuneResults, units: Units) -> OutputTable:
    """Make the table of how far each variable may move alone before the goal is worse."""
    unit, size = units.find(results.task.goal.unit)
    floor = f"{format_error(size * results.floor)} {unit}".rstrip()
    heads = ("variable", f"by {floor}: down", "up", "by 1 %: down", "up")
    rows = [
        (format_head(variable.name, variable.unit), *_format_moves(range_))
        for variable, range_ in zip(results.task.variables, results.tolerance_ranges, strict=True)
    ]
    return OutputTable(MOVES, make_text_columns(heads), rows)


def _format_moves(tolerance_range: ToleranceRange) -> Iterator[str]:
    """Yield how far each variable may move, in words."""
    return (_format_move(move) for move in (*tolerance_range.of_floor, *tolerance_range.of_hundredth))


def _format_move(move: ToleranceMove | None) -> str:
    """Format a move to two digits, with what ends it."""
    if move is None:
        return "-"
    distance = f"{move.distance:.2g}".replace("e-0", "e-")
    ends = f" ({move.limit}{' jumps' if move.jumps else ''})"
    return f"{BOUND_OF.get(move.limit, '')}{distance}{UNTIL.get(move.limit, ends)}"


def make_measures_table(results: TuneResults, units: Units) -> OutputTable:
    """Make the table of the goal and the constraints, one row each."""
    columns = (
        OutputColumn("measure", "path"), OutputColumn("spec"), OutputColumn("best"), OutputColumn("error"),
        OutputColumn("at t", "instant", "s"), OutputColumn("limit", "text"), OutputColumn("margin"),
        OutputColumn("", "verdict"),
    )  # fmt: skip
    assert results.best is not None
    task = results.task
    rows = [_make_measure_row(results, 0, task.goal.measure, task.goal.unit, units, ("", "", ""))]
    for index, constraint in enumerate(task.constraints):
        size = units.find(constraint.unit)[1]
        value = results.best.constraint_values[index]
        excess = constraint.compute_excess(value)
        word = "not met" if not constraint.is_met(value) else "active" if results.active_constraints[index] else ""
        error = results.best.outcome.measures[index + 1].error or 0.0
        style = choose_style(size * max(abs(excess), abs(constraint.value)), size * error)
        margin = NumberCell(-size * excess + 0.0, size * error, style.write)
        limit = f"{constraint.relation} {size * constraint.value:.6g}"
        rows.append(
            _make_measure_row(results, index + 1, constraint.measure, constraint.unit, units, (limit, margin, word))
        )
    spec = results.spec_outcome
    notes = [] if spec.measures else [f"spec: {spec.reason} [{spec.code}]"]
    return OutputTable(MEASURES, columns, rows, notes)


def _make_measure_row(
    results: TuneResults, index: int, text: str, own_unit: str, units: Units, limit_cells: Sequence[Cell]
) -> tuple[Cell, ...]:
    """Make the cells of a measure, with as many digits as its error allows."""
    assert results.best is not None
    unit, size = units.find(own_unit)
    base = results.spec_outcome.get_measure(index)
    best = results.best.outcome.measures[index]
    error = None if best.error is None else NumberCell(size * best.error, write=format_error)
    return format_head(text, unit), _make_value(base, size), _make_value(best, size), error, best.time, *limit_cells


def _make_value(measure: MeasureValue, size: float) -> Cell:
    """Make the cell of a number with its certain digits, or of the word that replaces an unknown one."""
    if measure.value is None:
        return measure.word
    error = size * (measure.error or 0.0)
    return NumberCell(size * measure.value, error, choose_style(size * abs(measure.value), error).write)
