"""Make the document of a balance."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from heuncli.analyses.balancing.results import BalanceResults, OrderRow, format_cycle, format_reference_point, get_unit
from heuncli.analyses.balancing.sampling import select_largest
from heuncli.app.commands.balance.as_json import CSV_COLUMNS, iter_records, to_block
from heuncli.app.commands.balance.remedies_page import make_remedy_tables
from heuncli.base.records import replace
from heuncli.base.tolerances import WRITTEN
from heuncli.output.documents.document import (
    Cell,
    NumberCell,
    OutputColumn,
    OutputDocument,
    OutputTable,
    Part,
    make_number_cells,
    make_panels,
)
from heuncli.results.results_schema import XYZ
from heuncli.study.quantities.digits import choose_style

FORCE = "FORCE  ON the foundation, world axes; order k: amplitude · cos(kφ - phase)"
MOMENT = "MOMENT  ON the foundation, about {}; orbital and spin: components in phase with the total"
TORQUE = "TORQUE  drive torque due to inertia alone, ½ dε/dφ ω²; ε: effective inertia"
LOAD = "LOADS  torque of loads and weight on the shaft: their power divided by its speed"
LEAST_SHOWN, MOST_LOADS = 1e-3, 12  # share of the largest order; number of rows
RESIDUAL = "OVER THE CYCLE  rms and peak value, numerical error of both, position of the peak"
REMARK_SHARE = 0.5  # share of the bodies' own effect below which a balanced order gets a remark
SIGNS = "the negative of mass_effect in heun run (Σ m ẍ)"


def make_document(results: BalanceResults) -> OutputDocument:
    """Make the document: the orders, the remedies that were asked for, and the orders as bars."""
    return OutputDocument(
        results.title,
        list_facts(results),
        iter_parts(results),
        lambda: to_block(results),
        lambda: OutputTable("", CSV_COLUMNS, list(iter_records(results))),
    )


def list_facts(results: BalanceResults) -> list[tuple[str, str]]:
    """Return label and text of the lines above the tables."""
    many = "" if results.is_resolved else "; it varies too fast to be resolved to all digits: see the errors"
    return [
        ("balance", f"{format_cycle(results)}{many}"),
        ("signs", f"inertia force and moment ON the foundation: {SIGNS}"),
        *((name, results.summaries[name]) for name in ("force", "moment")),
        *(("", note) for note in results.notes),
    ]


def iter_parts(results: BalanceResults) -> Iterator[Part]:
    """Yield the tables, and the panel of the sizes of the orders."""
    from heuncli.output.figures.orders import make_order_sizes_figure  # where it is drawn

    yield from make_tables(results)
    yield from make_remedy_tables(results)
    yield from make_panels(make_order_sizes_figure(results))


def make_tables(results: BalanceResults) -> Iterator[OutputTable]:
    """Yield the tables of the page."""
    yield make_order_table(results, "force", FORCE)
    yield make_order_table(results, "moment", MOMENT.format(format_reference_point(results)))
    if "torque" in results.orders:
        yield make_order_table(results, "torque", TORQUE)
    if "load" in results.orders:
        yield make_load_table(results)
    yield make_residual_table(results)


def make_order_table(results: BalanceResults, quantity: str, heading: str) -> OutputTable:
    """Make the table of the shown orders of a quantity; components that are zero in all of them are left out."""
    rows = [row for row in results.orders[quantity] if row.order in results.shown_orders]
    if not rows:
        return OutputTable(heading, notes=("no orders",))
    unit = get_unit(results, quantity)
    columns: list[OutputColumn] = [OutputColumn("order")]
    cells: list[Sequence[Cell]] = [[f"{row.order:g}" for row in rows]]
    scale = max(max(row.size, *(float(part.max()) for part, _ in (row.parts or {}).values()), 0.0) for row in rows)
    error = max(row.error for row in rows)
    relative_error = max(WRITTEN, error / scale) if scale > 0.0 else WRITTEN
    for k in list_components(rows):
        letter = "" if quantity in ("torque", "load") else f"{quantity[0].upper()}{XYZ[k]}"
        columns += [
            OutputColumn(letter or quantity, unit=unit, vector=letter),
            OutputColumn("phase°", vector=letter),
        ]
        sizes = make_cells([float(row.amplitude[k]) for row in rows], scale, relative_error)
        cells += [
            sizes,
            [
                NumberCell(row.phase[k], write=format_degrees) if size.text != "0" else None
                for row, size in zip(rows, sizes, strict=True)
            ],
        ]
        if quantity == "moment":
            for part in ("orbital", "spin"):
                columns.append(OutputColumn(part, vector=letter))
                cells.append(make_cells([project_on_phase(row, part, k) for row in rows], scale, relative_error))
    if any(row.with_turn or row.against_turn for row in rows):
        columns += [OutputColumn("forward", vector="turn"), OutputColumn("backward", vector="turn")]
        cells += [
            make_cells([row.with_turn or 0.0 for row in rows], scale, relative_error),
            make_cells([row.against_turn or 0.0 for row in rows], scale, relative_error),
        ]
    columns.append(OutputColumn("", "verdict"))
    cells.append([make_remark(row, quantity) for row in rows])
    notes = (f"largest error {error:.1g} {unit}",) if any(row.size for row in rows) else ()
    return OutputTable(heading, columns, list(zip(*cells, strict=True)), notes)


def make_load_table(results: BalanceResults) -> OutputTable:
    """Make the table of the orders of the load torque on the shaft, the largest or the requested ones, and their
    mean.
    """
    rows = results.orders["load"]
    largest = max((row.size for row in rows), default=0.0)
    counts = [row for row in rows if row.size > LEAST_SHOWN * largest]
    shown_orders = (
        results.shown_orders
        if results.are_orders_requested
        else select_largest([(row.order, row.size) for row in counts], MOST_LOADS)
    )
    table = make_order_table(replace(results, shown_orders=shown_orders), "load", LOAD)
    mean, error = results.mean["load"], results.mean_error["load"]
    number_style = choose_style(max(largest, abs(mean)), max(error, WRITTEN * largest))
    notes = [f"mean: {number_style.write(mean)} N·m, error {error:.1g} N·m"]
    omitted = [row.order for row in counts if row.order not in shown_orders]
    if omitted and not results.are_orders_requested:
        notes.append(f"not shown: {len(omitted)} smaller up to order {omitted[-1]:g}; --orders shows any, JSON has all")
    return table._replace(notes=(*table.notes, *notes))


def list_components(rows: Sequence[OrderRow]) -> list[int]:
    """List the components that are not zero in all orders; if all are, those whose orbital or spin part is not."""
    every = range(len(rows[0].amplitude))
    nonzero = [k for k in every if any(row.amplitude[k] for row in rows)]
    return nonzero or [k for k in every if any(part[k] for row in rows for part, _ in (row.parts or {}).values())]


def make_remark(row: OrderRow, quantity: str) -> str:
    """Return the remark on an order: its verdict, or its share of the bodies' own effect if most of that is
    balanced.
    """
    if row.verdict != "remains":
        return row.verdict
    share = row.size / row.body_sum
    return (
        f"{100.0 * share:.2g} % of the sum over bodies"
        if share < REMARK_SHARE and quantity in ("force", "moment")
        else ""
    )


def project_on_phase(row: OrderRow, part: str, k: int) -> float:
    """Return the part of orbital or spin effects that is in phase with a moment's component.

    If that component is zero, the phase of the orbital part is taken.
    """
    assert row.parts is not None
    amplitude, phase = row.parts[part]
    reference = row.phase[k] if row.amplitude[k] else row.parts["orbital"][1][k]
    return float(amplitude[k] * math.cos(phase[k] - reference))


def make_cells(values: Sequence[float], scale: float, relative_error: float = WRITTEN) -> list[NumberCell]:
    """Make the cells of numbers of one family, with the digits that the relative error of the largest allows."""
    return make_number_cells(values, choose_style(scale, relative_error * scale))


def format_degrees(phase: float) -> str:
    """Format a phase [rad] in degrees, to a hundredth."""
    text = f"{math.degrees(phase):.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def make_residual_table(results: BalanceResults) -> OutputTable:
    """Make the table of root mean square and peak of force, moment and torque."""
    rows: list[tuple[Cell, ...]] = []
    for name in ("force", "moment", "torque"):
        if name in results.residual:
            residual = results.residual[name]
            relative_error = max(WRITTEN, residual.error / residual.peak) if residual.peak else WRITTEN
            cells = make_cells([residual.rms, residual.peak], residual.peak, relative_error)
            error = NumberCell(residual.error, write="{:.1g}".format) if residual.peak else None
            place = format_place(results, residual.peak_angle) if residual.peak else ""
            rows.append((f"{name} [{get_unit(results, name)}]", *cells, error, place))
    columns = (
        OutputColumn("", "path"), OutputColumn("rms"), OutputColumn("peak"), OutputColumn("error"),
        OutputColumn("at", "text"),
    )  # fmt: skip
    return OutputTable(RESIDUAL, columns, rows)


def format_place(results: BalanceResults, angle: float) -> str:
    """Format an angle of the cycle, or an instant of the period."""
    if results.period is not None:
        return f"t = {angle * results.period.seconds / math.tau:.6g} s"
    return f"{results.coordinate} = {math.degrees(angle):.2f}°"
