"""`heun probe`: find where a motion comes near to states that numerical methods cannot handle."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated

from heuncli.analyses.motion_diagnostics.results import GrowthResults, Probe, StiffnessResults
from heuncli.analyses.motion_diagnostics.study import probe
from heuncli.app.cli import timeout
from heuncli.app.cli.documents import emit_document
from heuncli.app.cli.options import CASE, OUTPUT, QUIET, SET, SPEC, TIME_LIMIT, make_format_option
from heuncli.app.cli.solving import load_spec, print_warnings
from heuncli.app.cli.target import choose_format, require_other_file
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.documents.document import NumberCell, OutputColumn, OutputDocument, OutputTable
from heuncli.study.model.options import Options


class ProbeRequest(NamedTuple):
    """The options and arguments of `heun probe`."""

    spec: Annotated[str, SPEC]
    format: Annotated[
        str | None,
        make_format_option(FORMATS),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False


FORMATS = ("table", "json")


def main(request: ProbeRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = choose_format(request.format, request.output, FORMATS)
    spec = load_spec(request)
    require_other_file(request.output, [request.spec])
    results = probe(spec, Options(time_limit=timeout.remaining_time()))
    emit_document(make_document(results), form, request.output)
    print_warnings(spec, None, request.quiet)
    return 0


MAX_EVENTS = 30  # events that a table lists; JSON has more
REST = "rest"  # stands in `model` in place of a method
GROWTH = "GROWTH  of a small disturbance, largest over all unconstrained directions"
STEPS = "STEPS  of explicit methods: smallest stability limit; approximate step for accuracy"
STEPS_HERE = "STEPS  of explicit methods: stability limit here"
CONDITION = "CONDITION NUMBER  largest / smallest singular value; displacements relative to the model size"
ATTITUDES = (
    "ORIENTATIONS  bodies with three rotational coordinates: half revolutions, condition of Euler angle matrices (max.)"
)
EVENTS = "EVENTS"
NAMES = {"mass": "mass matrix", "closure": "loop closures"}
REASON_NAMES = {"condition": "condition number"}  # where a key is not the term


def make_document(results: Probe) -> OutputDocument:
    """Make the document: the verdict, tables of what was examined, and the data for JSON."""
    return OutputDocument(results.title, list(list_facts(results)), make_tables(results), results.to_block)


def list_facts(results: Probe) -> Iterator[tuple[str, str]]:
    """Yield label and text of the lines above the tables."""
    yield "probe", f"{results.model['space']}, {describe_motion(results)}"
    yield "verdict", results.verdict
    yield from (("", text) for text in results.trouble[1:])
    yield from (("also" if k == 0 else "", text) for k, text in enumerate(results.others))
    yield from (("omitted" if k == 0 else "", text) for k, text in enumerate(format_reasons(results)))


def describe_motion(results: Probe) -> str:
    """Describe by which method the motion was found, and how long it is."""
    method, colon, other_method = str(results.model["method"]).partition(": ")
    if not results.duration:
        return "rest position" if method == REST else "one instant"
    return f"{other_method if colon else f'by {method}'} over {results.duration:.6g} s"


def format_reasons(results: Probe) -> list[str]:
    """List why results are missing, each reason once with the keys that it holds for."""
    keys_by_reason: dict[str, list[str]] = {}
    for key, text in results.reasons.items():
        keys_by_reason.setdefault(text, []).append(REASON_NAMES.get(key, key.replace("_", " ")))
    return [f"{', '.join(keys)}: {text}" for text, keys in keys_by_reason.items()]


def make_tables(results: Probe) -> Iterator[OutputTable]:
    """Yield all tables that have something to show."""
    if grown := tuple(make_growth_row(name, g) for name, g in list_growths(results) if g is not None):
        heads = ("of", "e-folding time [s]", "growth factor", "until [s]", "double precision lost at [s]")
        yield OutputTable(GROWTH, make_columns(heads, 1), grown)
    if results.stiffness is not None and results.stiffness.steps:
        yield make_steps_table(results.stiffness, results.duration)
    if known := results.list_conditions():
        rows = tuple((NAMES[name], make_condition_cell(at.value), at.time, at.where) for name, at in known)
        yield OutputTable(
            CONDITION, (*make_columns(("of", "condition", "t [s]"), 1), OutputColumn("located in", "text")), rows
        )
    if results.attitudes:
        sequences = tuple(results.attitudes[0].euler)
        column_heads = ("body", "half revolutions", *(f"{s} at [s]" if i else s for s in sequences for i in (0, 1)))
        bodies = tuple(
            (t.body, t.half_turns, *(x for k, at in t.euler.values() for x in (make_condition_cell(k), at)))
            for t in results.attitudes
        )
        yield OutputTable(ATTITUDES, make_columns(column_heads, 1), bodies)
    if results.events:
        yield make_events_table(results)


def make_steps_table(stiffness: StiffnessResults, duration: float) -> OutputTable:
    """Make the table of the steps of explicit methods; that for accuracy only for a motion. "any" is longer than the
    run.
    """
    note = (
        f"linearised motion: decay rates up to {stiffness.decay:.3g} 1/s, angular frequencies up to "
        f"{stiffness.oscillation:.3g} rad/s"
    )
    if not duration:
        rows = tuple((s.method, s.order, format_step(s.stability, math.inf)) for s in stiffness.steps)
        return OutputTable(STEPS_HERE, make_columns(("method", "order", "stable [s]"), 1), rows, (note,))
    motion_rows = [
        (s.method, s.order, format_step(s.stability, duration), format_step(s.accuracy, duration))
        for s in stiffness.steps
    ]
    return OutputTable(STEPS, make_columns(("method", "order", "stable [s]", "accurate [s]"), 1), motion_rows, (note,))


def make_events_table(results: Probe) -> OutputTable:
    """Make the table of the instants, limited to the first MAX_EVENTS."""
    rows = [(e.time, e.kind, e.message) for e in results.events[:MAX_EVENTS]]
    omitted = len(results.events) - len(rows) + sum(count for _, _, count in results.further_events)
    notes = (f"{omitted} more; JSON lists up to 100 of each kind and place",) if omitted else ()
    heads = (OutputColumn("t", "instant", "s"), OutputColumn("event", "text"), OutputColumn("", "text"))
    return OutputTable(EVENTS, heads, tuple(rows), notes)


def make_columns(heads: tuple[str, ...], word_count: int) -> tuple[OutputColumn, ...]:
    """Make the columns; the first `word_count` of them hold words and are left-aligned."""
    return tuple(OutputColumn(head, "text") if k < word_count else OutputColumn(head) for k, head in enumerate(heads))


def list_growths(results: Probe) -> tuple[tuple[str, GrowthResults | None], ...]:
    """Return the growths to show, each with the name of its motion."""
    name = "in-plane motion" if results.out_of_plane is not None else "motion"
    return (name, results.growth), ("out-of-plane motion", results.out_of_plane)


def make_growth_row(name: str, growth: GrowthResults) -> tuple[str, ...]:
    """Make the row of a growth of disturbances: its rate, and the horizon that follows from it."""
    rate_text = f"{1.0 / growth.rate:.3g}" if growth.exponential and growth.rate > 0.0 else "not exponential"
    if growth.rate < 0.0 and growth.logarithm < 0.0:
        rate_text = "decays"
    horizon_bound = "after the run" if growth.stop_reason is None else f"after {growth.end_time:.4g}"
    horizon = f"{growth.horizon:.4g}" if growth.horizon is not None else horizon_bound
    if growth.expected_horizon is not None:
        horizon += f", about {growth.expected_horizon:.2g} if growth continues"
    times = f"{math.exp(growth.logarithm):.2g}" if growth.logarithm < 700.0 else f"e^{growth.logarithm:.0f}"
    return name, rate_text, times, f"{growth.end_time:.4g}", horizon


def format_condition(value: float) -> str:
    """Format a condition number for a cell."""
    return f"{value:.3g}" if value < 1e15 else "singular"


def make_condition_cell(value: float) -> NumberCell:
    """Make the cell of a condition number."""
    return NumberCell(value, write=format_condition)


def format_step(value: float, longest: float) -> str:
    """Format a step size for a cell, "any" if it is longer than the run."""
    return f"{value:.2g}" if value <= longest and math.isfinite(value) else "any"
