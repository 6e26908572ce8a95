"""The orders of a cycle as bars: force and moment on the foundation, torques of inertia and loads on the shaft."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from heuncli.analyses.balancing.results import BalanceResults, OrderRow, format_cycle, format_reference_point, get_unit
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.axes import choose_ends, format_short
from heuncli.output.drawing.figure import BAR, Bars, Figure, Item, Panel, PlaceLabel, Scaling, Spot, share_x_axis
from heuncli.output.figures.curves import choose_number_style
from heuncli.study.quantities.captions import make_readable
from heuncli.study.quantities.table_units import Units

QUANTITY_TITLES = {
    "force": "Inertia force on the foundation", "moment": "Inertia moment on the foundation",
    "torque": "Shaft torque from inertia", "load": "Shaft torque from loads and weight",
}  # fmt: skip
AXIS_NAMES = {"force": "force", "moment": "moment", "torque": "torque", "load": "torque"}
GROUP_WIDTH, DIGITS = 0.7, 3  # width of the bars of an order, digits of their values
BARS_SENTENCE = "bars: largest magnitude of each order over a revolution"
MIN_LABELLED = 1e-3  # of the largest bar: smaller bars have no label
COUNTERBALANCED = "with counterweights"
PEN, COUNTERBALANCED_PEN = 0, 1
LETTERS = {"force": "F", "moment": "M", "torque": "T"}  # of quantities whose orders are compared by their sizes
SIZES_TITLE = "ORDERS  by amplitude"
SIZES_LABEL = "relative to the largest order of its kind"
LEAST_SIZE = 1e-4  # of the largest of its kind: smaller orders are not compared
ROW_HEIGHT = 14.2  # pixels of an order, which are a line of a terminal


class BalancedScene(NamedTuple):
    """A balance in a figure, and its name there (file and case); empty if it is the only one."""

    name: str
    results: BalanceResults


def make_orders_figure(sources: Sequence[BalancedScene], units: Units) -> Figure:
    """Make the figure of some balances: a panel for each quantity, with the same limits for all scenes.

    A quantity of which all orders cancel is a sentence.
    """
    panels, cancelled = list[Panel](), list[str]()
    for quantity in QUANTITY_TITLES:
        sources_with_quantity = [source for source in sources if quantity in source.results.orders]
        high: dict[str, float] = {}
        for source in sources_with_quantity:
            unit = get_unit(source.results, quantity)
            high[unit] = max(high.get(unit, 0.0), _find_largest(source.results, quantity))
        for source in sources_with_quantity:
            largest = high[get_unit(source.results, quantity)]
            if _find_largest(source.results, quantity) > 0.0:
                panels.append(_make_panel(source, quantity, largest, units))
            else:
                prefix = f"{source.name}: " if source.name else ""
                cancelled.append(f"{prefix}{QUANTITY_TITLES[quantity]}: cancels (all orders)")
    words = [*(sentence for source in sources for sentence in _describe_source(source)), BARS_SENTENCE]
    has_counterweights = any(source.results.counterbalance is not None for source in sources)
    names = (("without counterweights", PEN), (COUNTERBALANCED, COUNTERBALANCED_PEN)) if has_counterweights else ()
    marks = [(name, pen, BAR) for name, pen in names]
    notes = [*cancelled, *(note for source in sources for note in source.results.notes)]
    if len({panel.x for panel in panels}) == 1:
        panels = share_x_axis(panels)
    titles = dict.fromkeys(source.results.title for source in sources if source.results.title)
    return Figure(" · ".join(titles) or "Balance", words, panels, (), notes, marks)


def make_order_sizes_figure(results: BalanceResults) -> Figure:
    """Make the figure of the shown orders, a line each: their sizes relative to the largest of their kind,
    logarithmic. Without panels if no order is shown.
    """
    places = {order: float(-k) for k, order in enumerate(results.shown_orders)}
    items: list[Item] = []
    for quantity, letter in LETTERS.items():
        rows = results.orders.get(quantity, ())
        largest = max((row.peak for row in rows), default=0.0)
        for row in rows:
            if row.order in places and row.peak > LEAST_SIZE * largest:
                x, y = row.peak / largest, places[row.order]
                items += [Spot(x, y), PlaceLabel(x, y, quantity, letter)]
    ticks = tuple((place, f"{order:g}") for order, place in places.items())
    x_axis = Scaling(SIZES_LABEL, LEAST_SIZE, 1.0, is_logarithmic=True)
    y_axis = Scaling("", 0.5 - len(places), 0.5, tick_texts=ticks)
    panel = Panel(x_axis, y_axis, tuple(items), ROW_HEIGHT * len(places), title=SIZES_TITLE)
    return Figure("", (), [panel] if places else [])


def _find_largest(results: BalanceResults, quantity: str) -> float:
    """Return the largest order that is drawn."""
    rows = [*results.orders[quantity], *_find_counterbalanced_orders(results).get(quantity, ())]
    return max((row.peak for row in rows if row.order in results.shown_orders), default=0.0)


def _find_counterbalanced_orders(results: BalanceResults) -> Mapping[str, tuple[OrderRow, ...]]:
    """Return the orders that remain with the counterweights."""
    return {} if results.counterbalance is None else results.counterbalance.orders


def _make_panel(source: BalancedScene, quantity: str, high: float, units: Units) -> Panel:
    """Make the panel of one quantity, a bar for each order."""
    results = source.results
    style = choose_number_style(get_unit(results, quantity), high, units)
    per_si = style.per_si
    places = {order: float(k) for k, order in enumerate(results.shown_orders)}
    names = tuple((place, f"{order:g}") for order, place in places.items())
    x = Scaling("order", -0.5, max(len(places), 1) - 0.5, tick_texts=names)
    y = Scaling(f"{AXIS_NAMES[quantity]} [{style.unit}]", 0.0, choose_ends(0.0, per_si * high, margin=0.25)[1])
    point_phrase = f", about {format_reference_point(results)}" if quantity == "moment" else ""
    title = f"{f'{source.name}: ' if source.name else ''}{QUANTITY_TITLES[quantity]}{point_phrase}"
    rows = [(QUANTITY_TITLES[quantity], results.orders[quantity], PEN)]
    counterbalanced = _find_counterbalanced_orders(results).get(quantity, ())
    if counterbalanced:
        rows.append((COUNTERBALANCED, counterbalanced, COUNTERBALANCED_PEN))
    width = GROUP_WIDTH / len(rows)
    items: list[Item] = []
    for k, (name, orders, pen) in enumerate(rows):
        offset = (k + 0.5) * width - 0.5 * GROUP_WIDTH
        drawn = [row for row in orders if row.order in places and row.peak > 0.0]
        sizes = {places[row.order] + offset: per_si * row.peak for row in drawn}
        items.append(Bars(name, np.array(list(sizes)), np.array(list(sizes.values())), pen, 0.9 * width))
        items += _label_bars(sizes, per_si * high, pen)
    return Panel(x, y, tuple(items), title=title)


def _label_bars(sizes: Mapping[float, float], largest: float, pen: int) -> Iterator[Spot]:
    """Label the bars that are large enough to be visible."""
    for place, value in sizes.items():
        if value > MIN_LABELLED * largest:
            yield Spot(place, value, format_short(value, DIGITS), pen, "")


def _describe_source(source: BalancedScene) -> Iterator[str]:
    """Yield the cycle, and what becomes of its orders, in the words of `heun balance` but for paths."""
    results = source.results
    prefix = f"{source.name}: " if source.name else ""
    words = format_cycle(results)
    if results.coordinate:
        words = words.replace(f"of {results.coordinate}", f"of the {make_readable(results.coordinate)}")
    yield prefix + words
    for name in ("force", "moment"):
        yield f"{prefix}{name}: {results.summaries[name]}"
