"""Render a tuning as tables: how it ended, the variables, the measures, and the command line to paste."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.analyses.tune.results import ToleranceMove, ToleranceRange, TuneResults
from heuncli.analyses.variants.measures import MeasureValue
from heuncli.app.cli import terminal
from heuncli.app.commands.tune.result_block import TunedScene
from heuncli.base.text_safety import escape
from heuncli.output.tables.page_width import split_to_width
from heuncli.output.tables.text_table import (
    DEFAULT_WIDTH,
    Align,
    TextColumn,
    TextTable,
    format_head,
    format_labelled_lines,
    format_plain,
)
from heuncli.study.quantities.digits import choose_style, format_error
from heuncli.study.quantities.table_units import Units
from heuncli.version import VERSION

VARIABLES = "VARIABLES  values and bounds, in the unit of the bounds"
MOVES = "MOVES  how far each variable alone may change, down and up, before the goal gets worse"
MEASURES = "MEASURES  goal first; margin to the limit, negative if exceeded"
PASTED = "Command that reproduces these numbers exactly:"
AT_BOUND = {"low": "lower bound", "high": "upper bound", "": ""}
UNTIL = {"worse": "", "bound": " (bound)", "jump": " (jumps)", "less": "", "more": ""}
BOUND_OF = {"less": "<", "more": ">"}
LEFT: Align = "left"


def render_page(results: TuneResults, scene: TunedScene, units: Units, output: str | None) -> str:
    """Render the page as text, for the terminal if it goes to one."""
    tables = [make_variables_table(results), make_measures_table(results, units)]
    if results.tolerance_ranges:
        tables.insert(1, make_moves_table(results, units))
    if output is None and terminal.is_terminal():
        parts = terminal.render_tables(tables)
    else:
        parts = [format_plain(part, DEFAULT_WIDTH) for table in tables for part in split_to_width(table, DEFAULT_WIDTH)]
    body = "\n".join(parts)
    heading = format_labelled_lines(list(format_heading(results, scene, units)))
    return f"{heading}\n{body}\n{PASTED}\n{escape(scene.line)}\n"


def format_heading(results: TuneResults, scene: TunedScene, units: Units) -> Iterator[tuple[str, str]]:
    """Yield label and text of the lines above the tables."""
    task = results.task
    names = ", ".join(one.name for one in task.variables)
    kind = "maximise" if task.goal.is_maximised else "minimise"
    yield "heun", f"{VERSION}  {scene.title}"
    yield "tune", f"{kind} {task.goal.measure}, by {names}"
    yield "", describe_ending(results, units)
    if not results.is_feasible:
        yield "", describe_nearest_unmet(results, units)
    if results.is_spec_better:
        yield "", "the spec's own values, outside the bounds, are better"
    yield "", f"{len(results.history)} variants{format_failures(results)}"


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
    one = results.task.constraints[index]
    unit, size = units.find(one.unit)
    excess, limit = size * one.compute_excess(results.best.constraint_values[index]), size * one.value
    return f"closest limit: {one.measure} {one.relation} {limit:.6g} {unit}, exceeded by {excess:.3g} {unit}".rstrip()


def make_variables_table(results: TuneResults) -> TextTable:
    """Make the table of the variables, one row each."""
    assert results.best is not None
    columns = (
        TextColumn("variable", LEFT), TextColumn("spec"), TextColumn("best"), TextColumn("from"), TextColumn("to"),
        TextColumn("at", LEFT),
    )  # fmt: skip
    rows = []
    for index, one in enumerate(results.task.variables):
        label = f"{one.name} [{one.unit}]" if one.unit else one.name
        base_text = "" if one.spec_value is None else f"{one.spec_value:.6g}"
        value = f"{one.to_number(results.best.place[index]):.6g}"
        rows.append((label, base_text, value, f"{one.low:.6g}", f"{one.high:.6g}", AT_BOUND[results.find_bound(index)]))
    return TextTable(VARIABLES, columns, tuple(rows))


def make_moves_table(results: TuneResults, units: Units) -> TextTable:
    """Make the table of how far each variable may move alone before the goal is worse."""
    unit, size = units.find(results.task.goal.unit)
    floor = f"{format_error(size * results.floor)} {unit}".rstrip()
    columns = (
        TextColumn("variable", LEFT), TextColumn(f"by {floor}: down", LEFT), TextColumn("up", LEFT),
        TextColumn("by 1 %: down", LEFT), TextColumn("up", LEFT),
    )  # fmt: skip
    rows = []
    for one, range_ in zip(results.task.variables, results.tolerance_ranges, strict=True):
        label = f"{one.name} [{one.unit}]" if one.unit else one.name
        rows.append((label, *_format_moves(range_)))
    return TextTable(MOVES, columns, tuple(rows))


def _format_moves(freedom: ToleranceRange) -> Iterator[str]:
    return (_format_move(one) for one in (*freedom.of_floor, *freedom.of_hundredth))


def _format_move(one: ToleranceMove | None) -> str:
    """Format a move to two digits, with what ends it."""
    if one is None:
        return "-"
    distance = f"{one.distance:.2g}".replace("e-0", "e-")
    return f"{BOUND_OF.get(one.limit, '')}{distance}{UNTIL.get(one.limit, f' ({one.limit})')}"


def make_measures_table(results: TuneResults, units: Units) -> TextTable:
    """Make the table of the goal and the constraints, one row each."""
    columns = (
        TextColumn("measure", LEFT), TextColumn("spec"), TextColumn("best"), TextColumn("error"),
        TextColumn("at t [s]"), TextColumn("limit", LEFT), TextColumn("margin"), TextColumn("", LEFT),
    )  # fmt: skip
    assert results.best is not None
    task = results.task
    lines = [_make_measure_row(results, 0, task.goal.measure, task.goal.unit, units, ("", "", ""))]
    for index, one in enumerate(task.constraints):
        size = units.find(one.unit)[1]
        excess = one.compute_excess(results.best.constraint_values[index])
        word = (
            "not met"
            if not one.is_met(results.best.constraint_values[index])
            else "active"
            if results.active_constraints[index]
            else ""
        )
        error = results.best.outcome.measures[index + 1].error or 0.0
        margin = choose_style(size * max(abs(excess), abs(one.value)), size * error).write(-size * excess + 0.0)
        limit = f"{one.relation} {size * one.value:.6g}"
        lines.append(_make_measure_row(results, index + 1, one.measure, one.unit, units, (limit, margin, word)))
    note = (
        () if results.spec_outcome.measures else (f"spec: {results.spec_outcome.reason} [{results.spec_outcome.code}]",)
    )
    return TextTable(MEASURES, columns, tuple(lines), note)


def _make_measure_row(
    results: TuneResults, index: int, text: str, own_unit: str, units: Units, limit_cells: tuple[str, str, str]
) -> tuple[str, ...]:
    """Make the cells of a measure, with as many digits as its error allows."""
    assert results.best is not None
    unit, size = units.find(own_unit)
    label = format_head(text, unit)
    base = results.spec_outcome.get_measure(index)
    best = results.best.outcome.measures[index]
    error = format_error(size * best.error) if best.error is not None else ""
    instant = "" if best.time is None else f"{best.time:.6g}"
    return (label, _format_value(base, size), _format_value(best, size), error, instant, *limit_cells)


def _format_value(one: MeasureValue, size: float) -> str:
    """Format a number with its certain digits, or the word that replaces an unknown one."""
    if one.value is None:
        return one.word
    return choose_style(size * abs(one.value), size * (one.error or 0.0)).write(size * one.value)
