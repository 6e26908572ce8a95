"""Blows as tables of their own, in newton seconds: what struck when, and of each the jumps and the impulses it made.

An impulse block has the shape of the time blocks without the axis of instants: with that axis put back, it is laid out
as one instant. Of many blows all are listed, and those with the largest impulses shown.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.tables import cut_runs
from heuncli.output.tables.blow_table import blow_table
from heuncli.output.tables.certain_sums import sums_table
from heuncli.output.tables.instants_tables import instants_tables
from heuncli.output.tables.table_blocks import TableBlock, build
from heuncli.output.tables.table_plans import IMPULSES
from heuncli.output.tables.text_table import TextColumn, TextTable
from heuncli.results.results import Array, Block, CertainSum, Extremes, Indices, Magnitudes, Results
from heuncli.results.results_schema import AT_A_BLOW, SHARES, STRUCK, quantity
from heuncli.study.quantities.digits import UNKNOWN, Certainty, largest, with_axis, write, write_times
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.series import Series, in_units, walk_impulse

MOST_SHOWN, MOST_LISTED = 3, 20  # blows with tables of their own, and those in the list, unless all are asked for
UNIT = "N·s"
HEADING = "the blows of the run: largest impulse and moment of a joint, a stop or on the ground; kinetic energy"
ENERGIES = ("energy_before", "energy_after", "energy_jump")


class BlowReport(NamedTuple):
    """The blows of a run and what is known of its numbers; along: of each the extremes along its runs of cuts.

    details: whether tables are shown that only those want who ask for them.
    """

    results: Results
    labels: Labels
    certain: Certainty
    of: Magnitudes
    along: Sequence[Mapping[str, Extremes]] = ()
    details: bool = True


def impulse_tables(blows: BlowReport, *, every: bool = False) -> list[TextTable]:
    """A list of all blows where there are several, then the tables of each, or of the largest."""
    found = blows.results.impulses
    if not found:
        return []
    sizes = np.array([sizes_of(impulse, blows.labels) for impulse in found])
    shown = np.arange(len(found)) if every or len(found) <= MOST_SHOWN else _largest(sizes @ [1.0, 1.0 / blows.of.size])
    tables = [listing(blows, sizes, shown, every)] if len(found) > 1 else []
    return tables + [table for number in shown.tolist() for table in tables_of(blows, number, every)]


def sizes_of(impulse: Block, labels: Labels) -> tuple[float, float]:
    """The largest impulse of a joint or stop, on the ground or of all bodies [N s], and moment of one [N m s]."""
    joints, ground = impulse.get("joints", {}), impulse.get("foundation", {})
    forces = [part["force"] for part in (*joints.values(), ground, ground.get("mass_effect", {})) if "force" in part]
    moments = [joint["moment"] for joint in joints.values() if "moment" in joint]
    for name, joint in joints.items():
        if "drive" in joint:
            (moments if labels.turns("joints", name) else forces).append(joint["drive"])
    forces += [stop["force"] for stop in impulse.get("stops", {}).values() if "force" in stop]
    moments += [stop["moment"] for stop in impulse.get("stops", {}).values() if "moment" in stop]
    force, moment = (np.array([np.linalg.norm(part) for part in parts]) for parts in (forces, moments))
    return largest(force), largest(moment)


def _largest(sizes: Array) -> Indices:
    """The numbers of the largest blows, in their order; of equal ones the first."""
    largest_first = np.argsort(-sizes, kind="stable")
    return np.sort(largest_first[:MOST_SHOWN])


def listing(blows: BlowReport, sizes: Array, shown: Indices, every: bool) -> TextTable:
    """A line a blow: when, by what, with which largest impulse, and what it did to the kinetic energy."""
    found, certain = blows.results.impulses, blows.certain
    times = np.array([float(impulse["time"]) for impulse in found])
    energies = {key: np.array([float(impulse.get(key, np.nan)) for impulse in found]) for key in ENERGIES}
    (of_energy, joules), *told = (blows.labels.units.of(unit) for unit in ("J", UNIT, AT_A_BLOW["N·m"]))
    whole = [joules * own for own in energies.values()]
    energy = write(np.concatenate(whole).tolist(), certain.style("energy", of_energy, max(map(largest, whole))))
    impulse, moment = (
        write((size * own).tolist(), certain.style("reactions", unit, size * largest(own)))
        for own, (unit, size) in zip(sizes.T, told, strict=True)
    )
    clock = write_times(times.tolist(), float(np.ptp(blows.results.time)) or float(np.ptp(times)))
    horizon = blows.results.horizon
    rows = []
    listed = found if every else found[:MOST_LISTED]
    for i, block in enumerate(listed):
        cells = [impulse[i], moment[i], *energy[i :: len(found)]]
        if horizon is not None and times[i] >= horizon:
            cells = [UNKNOWN] * len(cells)
        rows.append((str(i), clock[i], ", ".join(block["names"]), *cells))
    heads = [f"largest [{unit}]" for unit, _ in told]
    heads += [f"{word} [{of_energy}]" for word in ("energy before", "after", "jump")]
    columns = (TextColumn(""), TextColumn("t [s]"), TextColumn("struck by", "left"), *map(TextColumn, heads))
    numbers = ", ".join(map(str, shown.tolist()))
    note = f"below: {numbers}, the largest; all: --all, or --format csv"
    left = f"{len(found) - len(listed)} more, the last at t = {clock[-1]} s"
    notes = (left,) * (len(listed) < len(found)) + (note,) * (len(shown) < len(found))
    return TextTable(f"IMPULSES  {HEADING}", columns, tuple(rows), notes)


def tables_of(blows: BlowReport, number: int, every: bool = False) -> list[TextTable]:
    """The tables of one blow: one of all that it loads, the central axis, the runs of cuts, causes, certain sums."""
    impulse = blows.results.impulses[number]
    view, labels = at_one_instant(blows.results, impulse), blows.labels
    called = f"IMPULSE at t = {float(impulse['time']):.6g} s ({', '.join(impulse['names'])})"
    lead = f"{called}  "
    horizon = blows.results.horizon
    certain = with_axis(blows.certain, view, blows.of, labels.units, UNIT)
    series = in_units(walk_impulse(impulse, labels), labels.units)
    by_cause = any(item.cause for item in series)
    blocks, tables, more = list[TableBlock](), list[TextTable](), list[TextTable]()
    for plan in IMPULSES:
        block = build(plan, view, labels, series) if blows.details or not plan.detail else None
        if block is None:
            continue
        named = block._replace(heading=lead + block.heading)
        blocks += [block] * plan.lasting
        tables += instants_tables(named, view.time, horizon, certain) if not plan.lasting else []
        more += shares_of(named, view, series, certain, horizon) if by_cause else []
    tables[:0] = [blow_table(called, blocks, view.time, horizon, certain)] if blocks else []
    along = blows.along[number] if blows.along else {}
    for run in cut_runs.runs_of(view, labels, AT_A_BLOW):
        made = cut_runs.instants_tables(run, view.time, horizon, certain, every=every)
        if run.name in along:
            found = cut_runs.in_units(run, along[run.name])
            table = cut_runs.extremes_table(run, view.time, found, found.places, certain)
            made = [table, made[0]._replace(heading=""), *made[1:]]
        tables += [made[0]._replace(heading=lead + made[0].heading), *made[1:]]
        more += [own._replace(heading=lead + own.heading) for own in shares_along(run, view, certain, horizon)]
    tables += more
    sums = sums_table(view, certain, unit=labels.units.of(UNIT))
    return [*tables, sums._replace(heading=lead + sums.heading)] if sums else tables


def shares_of(
    block: TableBlock, view: Results, series: Sequence[Series], certain: Certainty, horizon: float | None
) -> list[TextTable]:
    """What each that struck does of a block's impulses."""
    from heuncli.output.tables import cause_tables  # few runs ask for them

    shared = cause_tables.shared_rows(view, series)
    return cause_tables.instants_table(block, shared, view.time, horizon, certain)


def shares_along(run: cut_runs.CutRun, view: Results, certain: Certainty, horizon: float | None) -> list[TextTable]:
    """What each that struck does of the impulses along a run of cuts; none where no shares are asked for."""
    if SHARES not in view.sections[run.name]:
        return []
    from heuncli.output.tables import cause_tables

    return cause_tables.run_instants_table(run, view, horizon, certain)


def at_one_instant(results: Results, impulse: Block) -> Results:
    """The results of a run with what a blow has in place of its own, as at the one instant of the blow."""
    parts: dict[str, Any] = {key: with_instant((key,), impulse.get(key, {})) for key in STRUCK if key != "certain_sums"}
    sums: list[CertainSum] = [
        {"terms": one["terms"], "value": np.atleast_1d(one["value"])} for one in impulse.get("certain_sums", ())
    ]
    time = np.array([float(impulse["time"])])
    return replace(results, time=time, impulses=[], certain_sums=sums, **parts)


def with_instant(keys: tuple[str, ...], value: Any) -> Any:
    """A block of a blow with the axis of instants that the blocks of time have."""
    if isinstance(value, dict):
        return {key: with_instant((*keys, key), member) for key, member in value.items()}
    row = quantity(keys)
    return np.asarray(value, dtype=np.float64)[None] if row is not None and row.timed else value
