"""A balance as tables, as JSON, and as CSV in long form."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from heuncli.analyses.balancing.results import BalanceResults, Counterbalance, OrderRow, OverCycle, Period
from heuncli.analyses.balancing.told import largest_of
from heuncli.analyses.balancing.words import cycle_of, place_of, unit_of
from heuncli.app.commands.balance.letters import draw
from heuncli.app.commands.balance.remedies_page import remedies
from heuncli.base.records import replace
from heuncli.base.tolerances import WRITTEN
from heuncli.output.tables.export import FORMAT
from heuncli.output.tables.page_width import fit
from heuncli.output.tables.text_table import WIDTH, TextColumn, TextTable, head, labelled, plain
from heuncli.results.results import Array, Block
from heuncli.study.quantities.digits import style, trim
from heuncli.version import VERSION

LETTERS = ("x", "y", "z")
FORCE = "FORCE  ON the foundation, world axes; order k is amplitude · cos(kφ - phase)"
MOMENT = "MOMENT  ON the foundation, about {}; orbital and spin: what the two make of it in its phase"
TORQUE = "TORQUE  that inertia alone takes of the drive, ½ dε/dφ ω²"
LOAD = "LOADS  the torque that loads and weight put on the shaft: their power by its rate"
LEAST_SHOWN, MOST_LOADS = 1e-3, 12  # of the largest order; of how many
RESIDUAL = "OVER THE CYCLE  root of the mean square, largest, what both are known within, and where the largest is"
JOINTS = "joints."
MOSTLY_GONE = 0.5  # of the bodies' own: an order of which less is left is worth a remark
SIGNS = "minus the mass_effect of heun run, which is + sum m xdd"
CSV_COLUMNS = "kind,order,quantity,component,unit,value"


def heading(found: BalanceResults) -> list[tuple[str, str]]:
    """Label and text of the lines above the tables."""
    many = "" if found.settled else "; it varies too much to be followed to its digits: see the errors"
    return [
        ("heun", f"{VERSION}  {found.title}"),
        ("balance", f"{cycle_of(found)}{many}"),
        ("signs", f"force and moment of the masses ON the foundation: {SIGNS}"),
        *((name, found.words[name]) for name in ("force", "moment")),
        *(("", note) for note in found.notes),
    ]


def write(found: BalanceResults) -> str:
    """The page as text."""
    parts = [labelled(heading(found))]
    for table in (*tables(found), *remedies(found)):
        parts += [plain(part, WIDTH) for part in fit(table, WIDTH)]
    return "\n".join([*parts, *(part for part in [draw(found, WIDTH)] if part)])


def tables(found: BalanceResults) -> Iterator[TextTable]:
    """The tables of the page."""
    yield order_table(found, "force", FORCE)
    yield order_table(found, "moment", MOMENT.format(place_of(found)))
    if "torque" in found.orders:
        yield order_table(found, "torque", TORQUE)
    if "load" in found.orders:
        yield load_table(found)
    yield residual_table(found)


def order_table(found: BalanceResults, quantity: str, heading: str) -> TextTable:
    """The shown orders of a quantity; components that have none of them are left out."""
    rows = [row for row in found.orders[quantity] if row.order in found.shown]
    if not rows:
        return TextTable(heading, notes=("of no order",))
    unit = unit_of(found, quantity)
    columns, cells = [TextColumn("order")], [[f"{row.order:g}" for row in rows]]
    scale = max(max(row.size, *(float(part.max()) for part, _ in (row.parts or {}).values()), 0.0) for row in rows)
    error = max(row.error for row in rows)
    sure = max(WRITTEN, error / scale) if scale > 0.0 else WRITTEN
    for k in components(rows):
        letter = "" if quantity in ("torque", "load") else f"{quantity[0].upper()}{LETTERS[k]}"
        columns += [TextColumn(head(letter or quantity, unit), vector=letter), TextColumn("phase°", vector=letter)]
        sizes = numbers([float(row.amplitude[k]) for row in rows], scale, sure)
        cells += [sizes, [degrees(row.phase[k]) if text != "0" else "" for row, text in zip(rows, sizes, strict=True)]]
        if quantity == "moment":
            for part in ("orbital", "spin"):
                columns.append(TextColumn(part, vector=letter))
                cells.append(numbers([in_phase(row, part, k) for row in rows], scale, sure))
    if any(row.with_turn or row.against for row in rows):
        columns += [TextColumn("with turn", vector="turn"), TextColumn("against", vector="turn")]
        cells += [
            numbers([row.with_turn or 0.0 for row in rows], scale, sure),
            numbers([row.against or 0.0 for row in rows], scale, sure),
        ]
    columns.append(TextColumn("", "left"))
    cells.append([remark(row, quantity) for row in rows])
    notes = (f"each within {error:.1g} {unit}",) if any(row.size for row in rows) else ()
    return TextTable(heading, tuple(columns), tuple(zip(*cells, strict=True)), notes)


def load_table(found: BalanceResults) -> TextTable:
    """The orders of what loads and weight put on the shaft, the largest of them or those asked for, and their mean."""
    rows = found.orders["load"]
    largest = max((row.size for row in rows), default=0.0)
    counts = [row for row in rows if row.size > LEAST_SHOWN * largest]
    told = found.shown if found.asked else largest_of([(row.order, row.size) for row in counts], MOST_LOADS)
    table = order_table(replace(found, shown=told), "load", LOAD)
    mean, error = found.mean["load"], found.mean_error["load"]
    how = style(max(largest, abs(mean)), max(error, WRITTEN * largest))
    notes = [f"mean: {how.write(mean)} N·m, within {error:.1g} N·m"]
    left = [row.order for row in counts if row.order not in told]
    if left and not found.asked:
        notes.append(
            f"{len(left)} smaller ones up to order {left[-1]:g} are left out: --orders shows any, JSON has all"
        )
    return table._replace(notes=(*table.notes, *notes))


def components(rows: Sequence[OrderRow]) -> list[int]:
    """The components that have some order; where none has, those of which orbital and spin have."""
    every = range(len(rows[0].amplitude))
    found = [k for k in every if any(row.amplitude[k] for row in rows)]
    return found or [k for k in every if any(part[k] for row in rows for part, _ in (row.parts or {}).values())]


def remark(row: OrderRow, quantity: str) -> str:
    """What is said beside an order that is none, or of whose bodies' own most is gone."""
    if row.verdict != "remains":
        return row.verdict
    share = row.size / row.own
    return (
        f"{100.0 * share:.2g} % of the bodies' own" if share < MOSTLY_GONE and quantity in ("force", "moment") else ""
    )


def in_phase(row: OrderRow, part: str, k: int) -> float:
    """What orbital or spin makes of a moment's component, in the phase of that; where that is none, by its own."""
    assert row.parts is not None
    amplitude, phase = row.parts[part]
    reference = row.phase[k] if row.amplitude[k] else row.parts["orbital"][1][k]
    return float(amplitude[k] * math.cos(phase[k] - reference))


def numbers(values: Sequence[float], scale: float, sure: float = WRITTEN) -> list[str]:
    """Numbers of one family, to the digits of the largest of which so much is sure."""
    how = style(scale, sure * scale)
    return trim([how.write(value) for value in values])


def degrees(phase: float) -> str:
    """A phase in degrees, to a hundredth."""
    text = f"{math.degrees(phase):.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def residual_table(found: BalanceResults) -> TextTable:
    """Root of the mean square and peak of force, moment and torque."""
    rows = []
    for name in ("force", "moment", "torque"):
        if name in found.residual:
            own = found.residual[name]
            sure = max(WRITTEN, own.error / own.peak) if own.peak else WRITTEN
            rms, peak = numbers([own.rms, own.peak], own.peak, sure)
            place, within = (where(found, own.at), f"{own.error:.1g}") if own.peak else ("", "")
            rows.append((f"{name} [{unit_of(found, name)}]", rms, peak, within, place))
    columns = (
        TextColumn("", "left"), TextColumn("rms"), TextColumn("peak"), TextColumn("within"), TextColumn("at", "left"),
    )  # fmt: skip
    return TextTable(RESIDUAL, columns, tuple(rows))


def where(found: BalanceResults, at: float) -> str:
    """An angle of the cycle, or an instant of the period."""
    if found.period is not None:
        return f"t = {at * found.period.seconds / math.tau:.6g} s"
    return f"{found.coordinate} = {math.degrees(at):.2f}°"


def block(found: BalanceResults) -> dict[str, Any]:
    """The balance as the JSON has it."""
    effects = found.effects
    own: Block = {
        "heun": FORMAT, "title": found.title, "spec": dict(found.spec), "version": VERSION,
        "cycle": {
            "coordinate": found.coordinate, "turns": found.turns, "rate": found.rate, "samples": found.samples,
            "settled": found.settled, **period_block(found.period),
        },
        "about": found.about, "axis": found.axis, "words": dict(found.words), "notes": list(found.notes),
        "mean": dict(found.mean), "mean_error": dict(found.mean_error),
        "harmonics": {name: [row.block() for row in rows] for name, rows in found.orders.items()},
        "residual": {name: residual.block() for name, residual in found.residual.items()},
    }  # fmt: skip
    if found.period is None:
        own["per_rate"] = {
            "angle": effects.angles,
            "second": {
                "force": effects.force.sum(axis=1), "moment": effects.moment.sum(axis=1),
                "moment_orbital": effects.orbital.sum(axis=1), "moment_spin": effects.spin.sum(axis=1),
                "torque": effects.half_slope.sum(axis=1),
            },
            "first": {
                "force": effects.first_force.sum(axis=1),
                "moment": (effects.first_orbital + effects.first_spin).sum(axis=1),
                "moment_orbital": effects.first_orbital.sum(axis=1), "moment_spin": effects.first_spin.sum(axis=1),
                "torque": effects.eps.sum(axis=1),
            },
        }  # fmt: skip
    own["counterweights"] = []
    if found.counterbalance is not None:
        own |= weights_block(found.counterbalance)
    if found.flywheel is not None:
        own["flywheel"] = found.flywheel.block()
    as_lists: dict[str, Any] = plain_data(own)
    return as_lists


def period_block(own: Period | None) -> Block:
    """A period of time, and how much the last one differs from the one before, of the largest."""
    return {} if own is None else {"period": own.seconds, "differs_by": own.off}


def weights_block(found: Counterbalance) -> Block:
    """The counterweights as the JSON has them, with what is left and what they cost."""
    return {
        "counterweights": [weight.block() for weight in found.weights],
        "minimised": {"what": found.minimised, "lever": found.lever, "several": found.several},
        "left": {
            "words": dict(found.words),
            "harmonics": {name: [row.block() for row in rows] for name, rows in found.orders.items()},
        },
        "cost": {name: costs(own) for name, own in (("before", found.before), ("after", found.after))},
    }  # fmt: skip


def costs(own: Mapping[str, OverCycle]) -> Block:
    """The loads before or after, the joints by their names."""
    joints = {name.removeprefix(JOINTS): spread.block() for name, spread in own.items() if name.startswith(JOINTS)}
    return {name: spread.block() for name, spread in own.items() if not name.startswith(JOINTS)} | {"joints": joints}


def plain_data(value: Any) -> Any:
    """Arrays as lists, numbers as Python's."""
    if isinstance(value, dict):
        return {key: plain_data(member) for key, member in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain_data(member) for member in value]
    if isinstance(value, np.ndarray):
        return value.tolist()
    return value


def to_csv(found: BalanceResults) -> str:
    """The orders in long form, a line a number."""
    lines = [CSV_COLUMNS]
    for kind, rows in found.orders.items():
        unit = unit_of(found, kind)
        for row in rows:
            for quantity, component, of, value in of_order(row):
                lines.append(f"{kind},{row.order:g},{quantity},{component},{of or unit},{value!r}")
    for kind, own in found.residual.items():
        unit = unit_of(found, kind.partition("_")[0])
        lines += [
            f"{kind},,{name},,{unit},{value!r}"
            for name, value in (("rms", own.rms), ("peak", own.peak), ("error", own.error))
        ]
        lines.append(f"{kind},,at,,rad,{own.at!r}")
    return "\n".join(lines) + "\n"


def of_order(row: OrderRow) -> Iterator[tuple[str, str, str, float]]:
    """Quantity, component, unit (empty: that of the kind) and value of an order's numbers."""
    letters = LETTERS if len(row.amplitude) == len(LETTERS) else ("",)
    sets: list[tuple[str, Array, Array]] = [("", row.amplitude, row.phase)]
    sets += [(f"{name}_", *both) for name, both in (row.parts or {}).items()]
    for name, amplitude, phase in sets:
        for letter, a, p in zip(letters, amplitude.tolist(), phase.tolist(), strict=True):
            yield f"{name}amplitude", letter, "", a
            yield f"{name}phase", letter, "rad", p
    for name, value in (("with", row.with_turn), ("against", row.against), ("error", row.error)):
        if value is not None:
            yield name, "", "", value
