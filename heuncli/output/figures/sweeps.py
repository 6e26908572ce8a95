"""A sweep as a figure: curves over one variable, a field over two, places at random as points, names as bars.

A panel a measure. Where a variant has no number nothing is drawn, and why is counted in a note.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from itertools import product

import numpy as np

from heuncli.output.drawing.figure import (
    Band,
    Bars,
    Cells,
    Figure,
    Item,
    Panel,
    Scaling,
    Spot,
    Strokes,
    Trace,
    over_one_axis,
)
from heuncli.output.drawing.pens import PENS
from heuncli.output.figures.certain import certain
from heuncli.output.figures.error_bands import is_seen
from heuncli.output.figures.refusals import NotDrawable
from heuncli.output.figures.swept import PickedTable, SweptNumbers, SweptTable, SweptVariable, example, picked
from heuncli.output.figures.variable_axes import NAMES_MOST, axis_of, edges_of, measured_axis
from heuncli.results.results import Array, Indices
from heuncli.study.quantities.table_units import Units

MARKED = 40  # points of a curve that are marked, at most
POINTS = ("circle", "square", "triangle", "diamond", "tip", "bow")
FEW_LEVELS = 3  # of the second of two variables: these are curves, no field
MOST_CELLS = 40_000
MOST_SPOTS = 1_500
MOST_PANELS = 16
FIELD, SHADES, STEPS = 300.0, 16.0, 48  # pixels: a field's height, and that of its shades; how many of these


def sweep(table: SweptTable, units: Units, words: Sequence[str] = ()) -> Figure:
    """The figure of a sweep; words: what is picked of it. Raises NotDrawable."""
    if not table.rows:
        raise NotDrawable(f"{table.origin}: the sweep has no rows", "let it run, then draw it")
    own = picked(table, words)
    if not own.varied:
        raise NotDrawable(f"{table.origin}: one variant is no curve", "vary something, or hold fewer variables")
    panels, legend, notes = _kind(own)(own, units)
    told = [table.origin, *(["with " + ", ".join(own.held)] if own.held else [])]
    return Figure(table.title, told, panels, legend, [*notes, *_counted(own.table)])


Drawn = tuple[list[Panel], list[tuple[str, int]], list[str]]


def _kind(own: PickedTable) -> Callable[[PickedTable, Units], Drawn]:
    """How a sweep is drawn."""
    if own.scattered:
        return _scatter
    if len(own.varied) == 1:
        return _bars if own.varied[0].texts else _curves
    if len(own.varied) == 2:
        first, second = own.varied
        numbers = not first.texts and not second.texts
        if numbers and min(len(first.levels), len(second.levels)) > FEW_LEVELS:
            return _fields
        if first.texts and second.texts:
            return _fields
    return _curves


def _curves(own: PickedTable, units: Units) -> Drawn:
    """Curves over one variable, one for each combination of the others."""
    across, others = _across(own)
    groups = _groups(own, others)
    x = axis_of(across)
    panels = []
    for measure in own.table.measures:
        shown, size = units.of(measure.unit)
        items: list[Item] = []
        y = measured_axis(shown, size * measure.values, size * measure.errors)
        for number, (name, rows) in enumerate(groups):
            order = rows[np.argsort(across.values[rows], kind="stable")]
            own_x, values = across.values[order], size * measure.values[order]
            if not across.texts:  # between names there is nothing
                items += _curve(name or measure.text, own_x, values, size * measure.errors[order], y, number)
            items += _points(across, measure, size, order, number, marked=len(groups) == 1)
        panels.append(Panel(x.scaling, y, tuple(items), title=measure.text))
    legend = [(name, number) for number, (name, _) in enumerate(groups) if name]
    return over_one_axis(panels), legend, [x.note] if x.note else []


def _across(own: PickedTable) -> tuple[SweptVariable, list[SweptVariable]]:
    """The variable along the axis across, and the others."""
    numbers = [one for one in own.varied if not one.texts]
    if own.named or not numbers:
        across = own.varied[0]
    else:
        across = max(numbers, key=lambda one: len(one.levels)) if len(own.varied) == 2 else numbers[0]
    return across, [one for one in own.varied if one is not across]


def _groups(own: PickedTable, others: Sequence[SweptVariable]) -> list[tuple[str, Indices]]:
    """Of each combination of the others its name, and its rows. Raises NotDrawable where there are too many."""
    if not others:
        return [("", np.arange(own.table.rows))]
    combinations = np.unique(np.column_stack([one.values for one in others]), axis=0)
    if len(combinations) > len(PENS):
        names = ", ".join(one.name for one in own.varied)
        message = f"{own.table.origin}: {len(own.varied)} variables ({names}) would make {len(combinations)} curves"
        held = example(others[0])
        raise NotDrawable(message, f"hold some, as {held}, until two vary or at most {len(PENS)} curves are left")
    found = []
    for values in combinations:
        mask = np.ones(own.table.rows, dtype=bool)
        for one, value in zip(others, values, strict=True):
            mask &= one.values == value
        name = ", ".join(f"{one.name} = {one.word(value)}" for one, value in zip(others, values, strict=True))
        found.append((name, np.flatnonzero(mask)))
    return found


def _curve(name: str, x: Array, values: Array, errors: Array, y: Scaling, number: int) -> Iterator[Item]:
    """A curve with the band of its stated errors where that is seen."""
    if is_seen(float(np.nanmax(np.where(np.isfinite(values), errors, 0.0), initial=0.0)), y):
        yield Band(f"stated error of {name}", x, values - errors, values + errors, number)
    yield Trace(name, x, values, number)


def _points(
    across: SweptVariable, measure: SweptNumbers, size: float, order: Indices, number: int, *, marked: bool
) -> Iterator[Spot]:
    """The points of a curve, where they are few; marked: the greatest and the least with their places."""
    x, values, errors = across.values[order], size * measure.values[order], size * measure.errors[order]
    known = np.flatnonzero(np.isfinite(values))
    if not len(known):
        return
    high, low = int(np.nanargmax(values)), int(np.nanargmin(values))
    best = [high, low] if marked and values[high] > values[low] else []
    for k in best:
        text = f"{certain(float(values[k]), float(errors[k]))} at {across.word(x[k])}"
        yield Spot(float(x[k]), float(values[k]), text, number, filled=True)
    alone = [k for k in known.tolist() if np.isfinite(values[max(k - 1, 0) : k + 2]).sum() == 1]
    shape = POINTS[number % len(POINTS)] if across.texts else POINTS[0]
    for k in known.tolist() if len(x) <= MARKED or across.texts else alone:
        if k not in best:
            yield Spot(float(x[k]), float(values[k]), "", number, shape)


def _bars(own: PickedTable, units: Units) -> Drawn:
    """A bar a name, as of load cases; with their stated errors where these are seen."""
    (across,) = own.varied
    x = axis_of(across)
    panels = []
    for measure in own.table.measures:
        shown, size = units.of(measure.unit)
        values, errors = size * measure.values, size * measure.errors
        y = measured_axis(shown, np.append(values, 0.0), np.append(errors, 0.0), spare=0.2)
        items: list[Item] = [Bars(measure.text, across.values, values)]
        seen = np.isfinite(values) & np.array([is_seen(error, y) for error in errors.tolist()])
        if seen.any():
            at, middle, off = across.values[seen], values[seen], errors[seen]
            low, high = np.column_stack([at, middle - off]), np.column_stack([at, middle + off])
            items.append(Strokes(np.stack([low, high], axis=1), width=1.4))
        items += [
            Spot(a, b, certain(b, error), 0, filled=True)
            for a, b, error in zip(across.values.tolist(), values.tolist(), errors.tolist(), strict=True)
            if np.isfinite(b) and len(values) <= NAMES_MOST
        ]
        panels.append(Panel(x.scaling, y, tuple(items), title=measure.text))
    return over_one_axis(panels), [], [x.note] if x.note else []


def _fields(own: PickedTable, units: Units) -> Drawn:
    """A field over two variables, and beneath it which shade is which value."""
    across, upward = own.varied
    if len(across.levels) * len(upward.levels) > MOST_CELLS:
        message = f"{own.table.origin}: {len(across.levels)} by {len(upward.levels)} cells; at most {MOST_CELLS:,}"
        raise NotDrawable(message, f"hold one, as {example(across)}")
    x, y = axis_of(across, cells=True), axis_of(upward, cells=True)
    panels: list[Panel] = []
    notes = [one.note for one in (x, y) if one.note]
    for measure in own.table.measures:
        shown, size = units.of(measure.unit)
        values = np.full((len(upward.levels), len(across.levels)), np.nan)
        at = np.searchsorted(upward.levels, upward.values), np.searchsorted(across.levels, across.values)
        values[at] = size * measure.values
        cells = Cells(measure.text, edges_of(across, x.scaling), edges_of(upward, y.scaling), values)
        panels.append(Panel(x.scaling, y.scaling, (cells,), FIELD, title=f"{measure.text} [{shown or '-'}]"))
        known = np.isfinite(measure.values)
        if known.any():
            panels += _shades(values, shown)
            notes.append(_least_and_greatest(measure, size, shown, (across, upward)))
    return panels, [], notes


def _shades(field: Array, unit: str) -> Iterator[Panel]:
    """Which shade of a field is which value."""
    low, high = float(np.nanmin(field)), float(np.nanmax(field))
    if not high > low:
        return
    cells = Cells(
        "shades", np.linspace(low, high, STEPS + 1), np.array([0.0, 1.0]), np.linspace(low, high, STEPS)[None]
    )
    yield Panel(Scaling(f"[{unit or '-'}]", low, high), Scaling("", 0.0, 1.0, named=((0.5, ""),)), (cells,), SHADES)


def _least_and_greatest(
    measure: SweptNumbers, size: float, unit: str, variables: tuple[SweptVariable, SweptVariable]
) -> str:
    """Where a field is lowest and highest."""
    found = []
    for name, k in (("least", int(np.nanargmin(measure.values))), ("greatest", int(np.nanargmax(measure.values)))):
        place = ", ".join(f"{one.name} = {one.word(one.values[k])}" for one in variables)
        value = certain(size * float(measure.values[k]), size * float(measure.errors[k]))
        found.append(f"{name} {value} {unit}".rstrip() + f" at {place}")
    return f"{measure.text}: {'; '.join(found)}"


def _scatter(own: PickedTable, units: Units) -> Drawn:
    """Each variable against each measure, a point a variant. Raises NotDrawable."""
    count = len(own.varied) * len(own.table.measures)
    if count > MOST_PANELS:
        message = (
            f"{own.table.origin}: {len(own.varied)} variables by {len(own.table.measures)} measures: {count} panels"
        )
        raise NotDrawable(message, f"name some of the measures, such as '{own.table.measures[0].text}'")
    every = -(-own.table.rows // MOST_SPOTS)
    chosen = own.varied[:1] if own.named else own.varied
    panels = []
    for measure, variable in product(own.table.measures, chosen):
        shown, size = units.of(measure.unit)
        values = size * measure.values
        y, x = measured_axis(shown, values, np.zeros_like(values)), axis_of(variable)
        some = zip(variable.values[::every].tolist(), values[::every].tolist(), strict=True)
        spots = tuple(Spot(a, b, "", 0) for a, b in some if np.isfinite(b))
        panels.append(Panel(x.scaling, y, spots, title=measure.text))
    notes = [f"every {every}th of {own.table.rows:,} variants is drawn"] if every > 1 else []
    return panels, [], notes + [note for one in chosen if (note := axis_of(one).note)]


def _counted(table: SweptTable) -> Iterator[str]:
    """How many variants there are, and how many have no number, and why."""
    if table.planned is not None and table.rows < table.planned:
        yield f"{table.rows:,} of {table.planned:,} variants are done"
    failed = Counter(code for code in table.codes if code)
    if failed:
        codes = ", ".join(f"{count} {code}" for code, count in failed.most_common())
        yield f"{failed.total():,} of {table.rows:,} variants could not be solved, and are not drawn: {codes}"
    for measure in table.measures:
        for word, count in Counter(word for word in measure.lost if word).items():
            yield f"{measure.text}: {word} in {count:,} of {table.rows:,} variants, not drawn there"
