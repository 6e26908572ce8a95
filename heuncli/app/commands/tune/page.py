"""Make the document of a tuning: how it ended, the variables, the measures, and the command line to paste."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from heuncli.analyses.tune.results import ToleranceMove, ToleranceRange, TuneResults
from heuncli.analyses.variants.measures import MeasureValue
from heuncli.app.commands.tune.as_json import TunedScene, to_block
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
        for direction, nearer, farther in zip(("down", "up"), range_.floor_moves, range_.hundredth_moves, strict=True):
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
    return (_format_move(move) for move in (*tolerance_range.floor_moves, *tolerance_range.hundredth_moves))


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
