"""The orders of a cycle as bars: force and moment on the foundation, what inertia and loads put on the shaft."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from heuncli.analyses.balancing.results import BalanceResults, OrderRow
from heuncli.analyses.balancing.words import cycle_of, place_of, unit_of
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import Bars, Figure, Item, Panel, Scaling, Spot
from heuncli.output.drawing.ticks import ends
from heuncli.study.quantities.table_units import Units

NAMES = {
    "force": "force of the masses ON the foundation", "moment": "moment of the masses ON the foundation",
    "torque": "torque of the inertia", "load": "torque of loads and weight on the shaft",
}  # fmt: skip
BARS = "bars: the largest magnitude that an order reaches over a turn"
WRITTEN = 1e-3  # of the largest bar: smaller ones are not written beside
LEFT = "with the counterweights"
PEN, PEN_LEFT = 0, 1


class BalancedScene(NamedTuple):
    """A balance in a figure, and how it is called there: its file and case; nothing where it is the only one."""

    name: str
    found: BalanceResults


def orders(sources: Sequence[BalancedScene], units: Units) -> Figure:
    """The figure of some balances: a panel a quantity, the same of all with the same ends."""
    panels = []
    for quantity in NAMES:
        some = [source for source in sources if quantity in source.found.orders]
        high: dict[str, float] = {}
        for source in some:
            unit = unit_of(source.found, quantity)
            high[unit] = max(high.get(unit, 0.0), _largest(source.found, quantity))
        panels += [_panel(source, quantity, high[unit_of(source.found, quantity)], units) for source in some]
    words = [*(sentence for source in sources for sentence in _words(source)), BARS]
    left = any(source.found.counterbalance is not None for source in sources)
    legend = [("as it is", PEN), (LEFT, PEN_LEFT)] if left else []
    notes = [note for source in sources for note in source.found.notes]
    titles = dict.fromkeys(source.found.title for source in sources if source.found.title)
    return Figure(" · ".join(titles) or "Balance", words, panels, legend, notes)


def _largest(found: BalanceResults, quantity: str) -> float:
    """The largest order that is drawn."""
    rows = [*found.orders[quantity], *_left(found).get(quantity, ())]
    return max((row.reach for row in rows if row.order in found.shown), default=0.0)


def _left(found: BalanceResults) -> Mapping[str, tuple[OrderRow, ...]]:
    """What counterweights leave."""
    return {} if found.counterbalance is None else found.counterbalance.orders


def _panel(source: BalancedScene, quantity: str, high: float, units: Units) -> Panel:
    """The bars of one quantity, an order beside the other."""
    found = source.found
    unit, size = units.of(unit_of(found, quantity))
    places = {order: float(k) for k, order in enumerate(found.shown)}
    names = tuple((place, f"{order:g}") for order, place in places.items())
    x = Scaling("order", -0.5, max(len(places), 1) - 0.5, named=names)
    y = Scaling(f"[{unit}]", 0.0, ends(0.0, size * high or 1.0, spare=0.25)[1])
    about = f", about {place_of(found)}" if quantity == "moment" else ""
    title = f"{f'{source.name}: ' if source.name else ''}{NAMES[quantity]}{about}"
    sizes = {row.order: size * row.reach for row in found.orders[quantity] if row.order in places and row.reach > 0.0}
    items: list[Item] = [
        Bars(NAMES[quantity], np.array([places[order] for order in sizes]), np.array(list(sizes.values())), PEN)
    ]
    items += _written(sizes, places, size * high)
    for row in _left(found).get(quantity, ()):
        if row.order in places:
            items.append(Spot(places[row.order], size * row.reach, "", PEN_LEFT, "diamond", filled=True))
    return Panel(x, y, tuple(items), title=title)


def _written(sizes: Mapping[float, float], places: Mapping[float, float], largest: float) -> Iterator[Spot]:
    """The sizes of the bars that are seen."""
    for order, value in sizes.items():
        if value > WRITTEN * largest:
            yield Spot(places[order], value, f"{value:.4g}", PEN, filled=True)


def _words(source: BalancedScene) -> Iterator[str]:
    """The cycle, and what becomes of its orders, as `heun balance` tells them."""
    found = source.found
    called = f"{source.name}: " if source.name else ""
    yield called + cycle_of(found)
    for name in ("force", "moment"):
        yield f"{called}{name}: {found.words[name]}"
