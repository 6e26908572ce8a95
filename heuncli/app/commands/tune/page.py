"""A tuning as tables: what became of it, the variables, the measures, and the line that can be pasted."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.analyses.tune.results import Leeway, Move, Reading, TuneResults
from heuncli.app.cli import terminal
from heuncli.app.commands.tune.told import TunedScene
from heuncli.base.foreign_text import shown
from heuncli.output.tables.page_width import fit
from heuncli.output.tables.text_table import WIDTH, Align, TextColumn, TextTable, labelled, plain
from heuncli.study.quantities.digits import rough, style
from heuncli.study.quantities.table_units import Units
from heuncli.version import VERSION

VARIABLES = "VARIABLES  values and bounds, in the unit of the bounds"
MOVES = "MOVES  how far a variable may move alone, down and up, before the goal is worse"
MEASURES = "MEASURES  the goal first; left: to the limit, below 0 where it is passed"
PASTED = "Its numbers, to the bit:"
AT_BOUND = {"low": "lower bound", "high": "upper bound", "": ""}
UNTIL = {"worse": "", "bound": " (bound)", "jump": " (jumps)", "less": "", "more": ""}
BOUND_OF = {"less": "<", "more": ">"}
LEFT: Align = "left"


def write(found: TuneResults, scene: TunedScene, units: Units, output: str | None) -> str:
    """The page as text: for the terminal at hand where it goes to one."""
    tables = [variables(found), measures(found, units)]
    if found.freedoms:
        tables.insert(1, moves(found, units))
    if output is None and terminal.present():
        parts = terminal.write(tables)
    else:
        parts = [plain(part, WIDTH) for table in tables for part in fit(table, WIDTH)]
    body = "\n".join(parts)
    return f"{labelled(list(heading(found, scene, units)))}\n{body}\n{PASTED}\n{shown(scene.line)}\n"


def heading(found: TuneResults, scene: TunedScene, units: Units) -> Iterator[tuple[str, str]]:
    """Label and text of the lines above the tables."""
    task = found.task
    names = ", ".join(one.name for one in task.variables)
    kind = "greatest" if task.goal.greatest else "least"
    yield "heun", f"{VERSION}  {scene.title}"
    yield "tune", f"{kind} {task.goal.measure}, by {names}"
    yield "", outcome(found, units)
    if not found.feasible:
        yield "", nearest(found, units)
    if found.own_is_better:
        yield "", "as it is, outside of the bounds, it is better"
    yield "", f"{len(found.history)} variants{unsolved(found)}"


def unsolved(found: TuneResults) -> str:
    """How many variants could not be solved, and why, behind their number."""
    count = sum(found.failures.values())
    codes = ", ".join(f"{code} {count}" for code, count in sorted(found.failures.items()))
    return f", of which {count} could not be solved: {codes}" if count else ""


def outcome(found: TuneResults, units: Units) -> str:
    """How the search ended."""
    if found.ending == "converged":
        assert found.gain is not None
        unit, size = units.of(found.task.goal.unit)
        most = f"{rough(size * max(found.gain, found.floor))} {unit}".rstrip()
        return f"converged: two restarts gained no more than {most}"
    if found.ending == "infeasible":
        return "nothing was found that keeps all limits: this passes them least"
    why = "the time limit is reached" if found.ending == "time" else f"all {found.task.most} evaluations are used up"
    what = "this is the best so far" if found.feasible else "nothing that keeps all limits was found so far"
    more = f"; --evaluations {2 * found.task.most} looks on" if found.ending == "evaluations" else ""
    return f"not converged: {why}; {what}{more}"


def nearest(found: TuneResults, units: Units) -> str:
    """Which of the constraints that are not met is nearest to it."""
    which = found.nearest_unmet
    assert which is not None and found.best is not None
    one = found.task.constraints[which]
    unit, size = units.of(one.unit)
    over, limit = size * one.excess(found.best.kept_to[which]), size * one.limit
    return f"nearest to being met: {one.measure} {one.sign} {limit:.6g} {unit}, passed by {over:.3g} {unit}".rstrip()


def variables(found: TuneResults) -> TextTable:
    """A line a variable."""
    assert found.best is not None
    columns = (
        TextColumn("variable", LEFT), TextColumn("as it is"), TextColumn("best"), TextColumn("from"), TextColumn("to"),
        TextColumn("at", LEFT),
    )  # fmt: skip
    rows = []
    for which, one in enumerate(found.task.variables):
        label = f"{one.name} [{one.unit}]" if one.unit else one.name
        own = "" if one.own is None else f"{one.own:.6g}"
        value = f"{one.value(found.best.place[which]):.6g}"
        rows.append((label, own, value, f"{one.low:.6g}", f"{one.high:.6g}", AT_BOUND[found.at_bound(which)]))
    return TextTable(VARIABLES, columns, tuple(rows))


def moves(found: TuneResults, units: Units) -> TextTable:
    """How flat the best is, a line a variable."""
    unit, size = units.of(found.task.goal.unit)
    floor = f"{rough(size * found.floor)} {unit}".rstrip()
    columns = (
        TextColumn("variable", LEFT), TextColumn(f"by {floor}: down", LEFT), TextColumn("up", LEFT),
        TextColumn("by 1 %: down", LEFT), TextColumn("up", LEFT),
    )  # fmt: skip
    rows = []
    for one, freedom in zip(found.task.variables, found.freedoms, strict=True):
        label = f"{one.name} [{one.unit}]" if one.unit else one.name
        rows.append((label, *_cells(freedom)))
    return TextTable(MOVES, columns, tuple(rows))


def _cells(freedom: Leeway) -> Iterator[str]:
    return (_move(one) for one in (*freedom.of_floor, *freedom.of_hundredth))


def _move(one: Move | None) -> str:
    """A way, to two digits, and what ends it."""
    if one is None:
        return "-"
    by = f"{one.by:.2g}".replace("e-0", "e-")
    return f"{BOUND_OF.get(one.until, '')}{by}{UNTIL.get(one.until, f' ({one.until})')}"


def measures(found: TuneResults, units: Units) -> TextTable:
    """The goal and the constraints, a line each."""
    columns = (
        TextColumn("measure", LEFT), TextColumn("as it is"), TextColumn("best"), TextColumn("error"),
        TextColumn("at t [s]"), TextColumn("limit", LEFT), TextColumn("left"), TextColumn("", LEFT),
    )  # fmt: skip
    assert found.best is not None
    task = found.task
    lines = [_measure(found, 0, task.goal.measure, task.goal.unit, units, ("", "", ""))]
    for which, one in enumerate(task.constraints):
        size = units.of(one.unit)[1]
        excess = one.excess(found.best.kept_to[which])
        word = "not met" if not one.met(found.best.kept_to[which]) else "active" if found.active[which] else ""
        error = found.best.outcome.readings[which + 1].error or 0.0
        left = style(size * max(abs(excess), abs(one.limit)), size * error).write(-size * excess + 0.0)
        limit = f"{one.sign} {size * one.limit:.6g}"
        lines.append(_measure(found, which + 1, one.measure, one.unit, units, (limit, left, word)))
    note = () if found.own.readings else (f"as it is: {found.own.reason} [{found.own.code}]",)
    return TextTable(MEASURES, columns, tuple(lines), note)


def _measure(
    found: TuneResults, which: int, text: str, own_unit: str, units: Units, kept: tuple[str, str, str]
) -> tuple[str, ...]:
    """A measure's cells: digits as far as its error lets them be."""
    assert found.best is not None
    unit, size = units.of(own_unit)
    label = f"{text} [{unit}]" if unit and unit != "1" else text
    own = found.own.readings[which] if found.own.readings else Reading(None)
    best = found.best.outcome.readings[which]
    error = rough(size * best.error) if best.error is not None else ""
    at = "" if best.at is None else f"{best.at:.6g}"
    return (label, _value(own, size), _value(best, size), error, at, *kept)


def _value(one: Reading, size: float) -> str:
    """A number with its certain digits; the word where it is not known."""
    if one.value is None:
        return one.word
    return style(size * abs(one.value), size * (one.error or 0.0)).write(size * one.value)
