"""A sweep as a figure: curves over one variable, a field over two, points for random variables, bars for names.

There is a panel for each measure. A variant without a number is not drawn; a note counts these with their reasons.
"""

from __future__ import annotations

import re
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
    share_x_axis,
)
from heuncli.output.drawing.style import PANEL_HEIGHT, PENS
from heuncli.output.figures.courses import NotDrawable
from heuncli.output.figures.curves import choose_number_style, format_number, is_visible
from heuncli.output.figures.sweep_tables import (
    MAX_NAMES,
    SweepNumbers,
    SweepSelection,
    SweepTable,
    SweepVariable,
    draw_contours,
    find_cell_edges,
    make_axis,
    make_example,
    make_measure_axis,
    select_sweep,
)
from heuncli.results.results import Array, Indices
from heuncli.study.quantities.captions import describe_path
from heuncli.study.quantities.digits import ReaderStyle
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.table_units import Units

MAX_MARKED = 40  # points of a curve; with more they have no marks
POINT_SHAPES = ("circle", "square", "triangle", "diamond", "tip", "bow")
MAX_CURVE_LEVELS = 3  # of the second of two variables: up to this, curves and no field
MAX_CELLS = 40_000
MAX_SPOTS = 1_500
MAX_PANELS = 16
FOLDERS = re.compile(r"(?:[^\s:]*/)+")  # before the name of a file
REDUCERS = {"max": "greatest", "min": "least", "mean": "mean", "rms": "effective", "abs": "magnitude of"}
CURVE_HEIGHT = 260.0  # of a single panel
# heights of a field and of its scale in pixels; shades of the scale
FIELD_HEIGHT, SHADES_HEIGHT, N_SHADES = (300.0, 16.0, 48)


def make_sweep_figure(table: SweepTable, units: Units, words: Sequence[str] = ()) -> Figure:
    """Make the figure of a sweep. Raises NotDrawable.

    words: what to pick from the sweep
    """
    if not table.n_rows:
        raise NotDrawable(f"{table.origin}: the sweep has no rows", "run it first, then plot it")
    picked_table = select_sweep(table, words)
    if not picked_table.variables:
        raise NotDrawable(f"{table.origin}: a single variant gives no curve", "vary a parameter or fix fewer variables")
    panels, legend, notes = _choose_kind(picked_table)(picked_table, units)
    sentences = [
        FOLDERS.sub("", table.origin),
        *(["with " + ", ".join(picked_table.fixed_texts)] if picked_table.fixed_texts else []),
    ]
    return Figure(
        FOLDERS.sub("", table.title), sentences, panels, legend, [*notes, *_count_variants(picked_table.table)]
    )


def describe_measure(text: str) -> str:
    """Describe a measure such as `max joints.main.force` in words; a name of its own stays."""
    *reducers, path = text.split(" ")
    if "." not in path or not set(reducers) <= REDUCERS.keys():
        return text
    owner, comma, quantity = describe_path(path, Labels()).rpartition(", ")
    words = owner + comma + " ".join([*(REDUCERS[reducer] for reducer in reducers), quantity])
    return f"{words[:1].upper()}{words[1:]}"


def _choose_style(measure: SweepNumbers, units: Units) -> ReaderStyle:
    """Choose how the numbers of a measure are written."""
    return choose_number_style(measure.unit, float(np.nanmax(np.abs(measure.values), initial=0.0)), units)


FigureParts = tuple[list[Panel], list[tuple[str, int]], list[str]]


def _choose_kind(picked_table: SweepSelection) -> Callable[[SweepSelection, Units], FigureParts]:
    """Choose the function that draws the sweep."""
    if picked_table.is_scattered:
        return _draw_scatter
    if len(picked_table.variables) == 1:
        return _draw_bars if picked_table.variables[0].texts else _draw_curves
    if len(picked_table.variables) == 2:
        first, second = picked_table.variables
        numbers = not first.texts and not second.texts
        if numbers and min(len(first.levels), len(second.levels)) > MAX_CURVE_LEVELS:
            return _draw_fields
        if first.texts and second.texts:
            return _draw_fields
    return _draw_curves


def _draw_curves(picked_table: SweepSelection, units: Units) -> FigureParts:
    """Draw curves over one variable, one for each combination of the others."""
    x_variable, others = _choose_x_variable(picked_table)
    groups = _group_rows(picked_table, others)
    x = make_axis(x_variable)
    panels = []
    for measure in picked_table.table.measures:
        style = _choose_style(measure, units)
        shown_unit, per_si = style.unit, style.per_si
        items: list[Item] = []
        y = make_measure_axis(shown_unit, per_si * measure.values, per_si * measure.errors)
        for number, (name, rows) in enumerate(groups):
            order = rows[np.argsort(x_variable.values[rows], kind="stable")]
            x_values, values = x_variable.values[order], per_si * measure.values[order]
            if not x_variable.texts:  # there is nothing between names
                items += _draw_curve(name or measure.text, x_values, values, per_si * measure.errors[order], y, number)
            items += _draw_points(x_variable, measure, style, order, number, mark_extremes=len(groups) == 1)
        height = CURVE_HEIGHT if len(picked_table.table.measures) == 1 else PANEL_HEIGHT
        panels.append(Panel(x.scaling, y, tuple(items), height, title=describe_measure(measure.text)))
    legend = [(name, number) for number, (name, _) in enumerate(groups) if name]
    return share_x_axis(panels), legend, [x.note] if x.note else []


def _choose_x_variable(picked_table: SweepSelection) -> tuple[SweepVariable, list[SweepVariable]]:
    """Return the variable along the horizontal axis, and the others."""
    numeric = [variable for variable in picked_table.variables if not variable.texts]
    if picked_table.has_named_axis or not numeric:
        x_variable = picked_table.variables[0]
    else:
        x_variable = (
            max(numeric, key=lambda variable: len(variable.levels)) if len(picked_table.variables) == 2 else numeric[0]
        )
    return x_variable, [variable for variable in picked_table.variables if variable is not x_variable]


def _group_rows(picked_table: SweepSelection, others: Sequence[SweepVariable]) -> list[tuple[str, Indices]]:
    """Return names and rows of groups with equal other values. Raises NotDrawable if there are too many."""
    if not others:
        return [("", np.arange(picked_table.table.n_rows))]
    combinations = np.unique(np.column_stack([variable.values for variable in others]), axis=0)
    if len(combinations) > len(PENS):
        names = ", ".join(variable.name for variable in picked_table.variables)
        message = (
            f"{picked_table.table.origin}: {len(picked_table.variables)} variables ({names}) would make "
            f"{len(combinations)} curves"
        )
        hint_example = make_example(others[0])
        raise NotDrawable(
            message, f"fix some, such as {hint_example}, until two vary or at most {len(PENS)} curves remain"
        )
    groups = []
    for values in combinations:
        mask = np.ones(picked_table.table.n_rows, dtype=bool)
        for variable, value in zip(others, values, strict=True):
            mask &= variable.values == value
        name = ", ".join(
            f"{variable.name} = {variable.format_value(value)}" for variable, value in zip(others, values, strict=True)
        )
        groups.append((name, np.flatnonzero(mask)))
    return groups


def _draw_curve(name: str, x: Array, values: Array, errors: Array, y: Scaling, number: int) -> Iterator[Item]:
    """Draw a curve, with the band of its stated errors if that is visible."""
    if is_visible(float(np.nanmax(np.where(np.isfinite(values), errors, 0.0), initial=0.0)), y):
        yield Band(f"stated error of {name}", x, values - errors, values + errors, number)
    yield Trace(name, x, values, number)


def _draw_points(
    x_variable: SweepVariable,
    measure: SweepNumbers,
    style: ReaderStyle,
    order: Indices,
    number: int,
    *,
    mark_extremes: bool,
) -> Iterator[Spot]:
    """Draw the points of a curve if they are few; mark_extremes: label the largest and the smallest with their
    places.
    """
    x, values = x_variable.values[order], style.per_si * measure.values[order]
    known = np.flatnonzero(np.isfinite(values))
    if not len(known):
        return
    high, low = int(np.nanargmax(values)), int(np.nanargmin(values))
    extremes = [high, low] if mark_extremes and values[high] > values[low] else []
    for k in extremes:
        number_text = format_number(float(measure.values[order[k]]), float(measure.errors[order[k]]), style)
        text = f"{number_text} at {x_variable.format_value(x[k])}"
        yield Spot(float(x[k]), float(values[k]), text, number, is_filled=True)
    isolated = [k for k in known.tolist() if np.isfinite(values[max(k - 1, 0) : k + 2]).sum() == 1]
    shape = POINT_SHAPES[number % len(POINT_SHAPES)] if x_variable.texts else POINT_SHAPES[0]
    for k in known.tolist() if len(x) <= MAX_MARKED or x_variable.texts else isolated:
        if k not in extremes:
            yield Spot(float(x[k]), float(values[k]), "", number, shape)


def _draw_bars(picked_table: SweepSelection, units: Units) -> FigureParts:
    """Draw a bar for each name, as of load cases, with the stated errors that are visible."""
    (x_variable,) = picked_table.variables
    x = make_axis(x_variable)
    panels = []
    for measure in picked_table.table.measures:
        style = _choose_style(measure, units)
        shown_unit, per_si = style.unit, style.per_si
        values, errors = per_si * measure.values, per_si * measure.errors
        y = make_measure_axis(shown_unit, np.append(values, 0.0), np.append(errors, 0.0), spare=0.2)
        items: list[Item] = [Bars(measure.text, x_variable.values, values)]
        has_band = np.isfinite(values) & np.array([is_visible(error, y) for error in errors.tolist()])
        if has_band.any():
            bar_places, middle, half_lengths = x_variable.values[has_band], values[has_band], errors[has_band]
            low, high = (
                np.column_stack([bar_places, middle - half_lengths]),
                np.column_stack([bar_places, middle + half_lengths]),
            )
            items.append(Strokes(np.stack([low, high], axis=1), width=1.4))
        items += [
            Spot(a, b, format_number(b / per_si, error / per_si, style), 0, "")
            for a, b, error in zip(x_variable.values.tolist(), values.tolist(), errors.tolist(), strict=True)
            if np.isfinite(b) and len(values) <= MAX_NAMES
        ]
        panels.append(Panel(x.scaling, y, tuple(items), title=describe_measure(measure.text)))
    return share_x_axis(panels), [], [x.note] if x.note else []


def _draw_fields(picked_table: SweepSelection, units: Units) -> FigureParts:
    """Draw a field over two variables, and below it the scale of its shades."""
    x_variable, y_variable = picked_table.variables
    if len(x_variable.levels) * len(y_variable.levels) > MAX_CELLS:
        message = (
            f"{picked_table.table.origin}: {len(x_variable.levels)} by {len(y_variable.levels)} cells; at "
            f"most {MAX_CELLS:,}"
        )
        raise NotDrawable(message, f"fix one, such as {make_example(x_variable)}")
    x, y = make_axis(x_variable, cells=True), make_axis(y_variable, cells=True)
    panels: list[Panel] = []
    notes = [axis.note for axis in (x, y) if axis.note]
    for measure in picked_table.table.measures:
        style = _choose_style(measure, units)
        shown_unit, per_si = style.unit, style.per_si
        values = np.full((len(y_variable.levels), len(x_variable.levels)), np.nan)
        cell_indices = (
            np.searchsorted(y_variable.levels, y_variable.values),
            np.searchsorted(x_variable.levels, x_variable.values),
        )
        values[cell_indices] = per_si * measure.values
        cells = Cells(
            measure.text, find_cell_edges(x_variable, x.scaling), find_cell_edges(y_variable, y.scaling), values
        )
        items = (cells, *draw_contours(cells, x_variable.levels, y_variable.levels))
        panels.append(Panel(x.scaling, y.scaling, items, FIELD_HEIGHT, title=describe_measure(measure.text)))
        known = np.isfinite(measure.values)
        if known.any():
            panels += _draw_shades(values, f"{describe_measure(measure.text)} [{shown_unit or '-'}]")
            notes.append(_describe_extremes(measure, style, (x_variable, y_variable)))
    return panels, [], notes


def _draw_shades(field: Array, label: str) -> Iterator[Panel]:
    """Draw the scale of the shades of a field."""
    low, high = float(np.nanmin(field)), float(np.nanmax(field))
    if not high > low:
        return
    cells = Cells(
        "shades", np.linspace(low, high, N_SHADES + 1), np.array([0.0, 1.0]), np.linspace(low, high, N_SHADES)[None]
    )
    yield Panel(Scaling(label, low, high), Scaling("", 0.0, 1.0, tick_texts=((0.5, ""),)), (cells,), SHADES_HEIGHT)


def _describe_extremes(
    measure: SweepNumbers, style: ReaderStyle, variables: tuple[SweepVariable, SweepVariable]
) -> str:
    """Describe where a field is smallest and largest."""
    texts = []
    for name, k in (("min.", int(np.nanargmin(measure.values))), ("max.", int(np.nanargmax(measure.values)))):
        place = ", ".join(f"{variable.name} = {variable.format_value(variable.values[k])}" for variable in variables)
        value = format_number(float(measure.values[k]), float(measure.errors[k]), style)
        texts.append(f"{name} {value} at {place}")
    return f"{describe_measure(measure.text)}: {'; '.join(texts)}"


def _draw_scatter(picked_table: SweepSelection, units: Units) -> FigureParts:
    """Draw each variable against each measure, a point for each variant. Raises NotDrawable."""
    count = len(picked_table.variables) * len(picked_table.table.measures)
    if count > MAX_PANELS:
        message = (
            f"{picked_table.table.origin}: {len(picked_table.variables)} variables by "
            f"{len(picked_table.table.measures)} measures: {count} panels"
        )
        raise NotDrawable(message, f"name some of the measures, such as '{picked_table.table.measures[0].text}'")
    stride = -(-picked_table.table.n_rows // MAX_SPOTS)
    chosen = picked_table.variables[:1] if picked_table.has_named_axis else picked_table.variables
    panels = []
    for measure, variable in product(picked_table.table.measures, chosen):
        style = _choose_style(measure, units)
        shown_unit, per_si = style.unit, style.per_si
        values = per_si * measure.values
        y, x = make_measure_axis(shown_unit, values, np.zeros_like(values)), make_axis(variable)
        drawn_points = zip(variable.values[::stride].tolist(), values[::stride].tolist(), strict=True)
        spots = tuple(Spot(a, b, "", 0) for a, b in drawn_points if np.isfinite(b))
        panels.append(Panel(x.scaling, y, spots, title=describe_measure(measure.text)))
    notes = [f"one in {stride} of {picked_table.table.n_rows:,} variants is drawn"] if stride > 1 else []
    return panels, [], notes + [note for chosen_variable in chosen if (note := make_axis(chosen_variable).note)]


def _count_variants(table: SweepTable) -> Iterator[str]:
    """Yield how many variants there are, how many of them have no number, and why."""
    if table.n_planned is not None and table.n_rows < table.n_planned:
        yield f"{table.n_rows:,} of {table.n_planned:,} variants are done"
    failed = Counter(code for code in table.codes if code)
    if failed:
        codes = ", ".join(f"{count} {code}" for code, count in failed.most_common())
        yield f"{failed.total():,} of {table.n_rows:,} variants could not be solved (not drawn): {codes}"
    for measure in table.measures:
        for word, count in Counter(word for word in measure.missing_reasons if word).items():
            yield f"{describe_measure(measure.text)}: {word} in {count:,} of {table.n_rows:,} variants, not drawn there"
