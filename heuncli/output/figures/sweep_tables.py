"""The rows of a sweep as columns of numbers, the choice of what to draw, and the axes of variables and measures.

Words make the choice: NAME=VALUE fixes a variable, the name of a variable puts it on the horizontal axis, the name of a
measure (or a part of it that only one has) draws only that measure.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import compress

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import suggest
from heuncli.base.text_safety import escape
from heuncli.output.drawing.axes import choose_ends, choose_ticks, is_zero_near
from heuncli.output.drawing.figure import Cells, Item, Scaling, Strokes, Words
from heuncli.output.figures.courses import NotDrawable
from heuncli.results.results import Array, Mask
from heuncli.scene.file_format.quantity import parse_number_with_unit

MIN_DISTINCT_SHARE = 0.8  # of the rows: two variables with more distinct values form no grid
MIN_ROWS = 4  # fewer rows form a grid
MAX_LETTERS, MAX_NAMES = 100, 12  # of names below an axis; more names are numbered
EVEN_TOLERANCE = 1e-6  # relative difference of equal steps
MIN_LEVELS = 4  # values along each axis; a smaller field has no contours
MAX_CONTOURS = 6


class SweepVariable(NamedTuple):
    """A varied quantity: its name, unit (empty for SI), and values (n,), which are numbers or indices of `texts`."""

    name: str
    unit: str
    values: Array
    texts: tuple[str, ...] = ()

    @property
    def axis_label(self) -> str:
        """The label of its axis."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    @property
    def levels(self) -> Array:
        """Its distinct values, ascending."""
        return np.unique(self.values)

    def format_value(self, value: float) -> str:
        """Format a value."""
        if self.texts:
            return self.texts[int(value)]
        return f"{value:.6g} {self.unit}".rstrip()


class SweepNumbers(NamedTuple):
    """A measure in each row.

    values (n,): SI, nan if there is none
    errors (n,): as stated by the runs, 0 if there is none
    missing_reasons: why the row of a solved variant has no number, else empty
    """

    text: str
    unit: str
    values: Array
    errors: Array
    missing_reasons: tuple[str, ...]


class SweepTable(NamedTuple):
    """A sweep: its variables and measures.

    codes: of each row the code of the error that prevented its solution, else empty
    n_planned: number of variants, if known
    random: whether the variables were drawn at random or listed row by row; None if that must be inferred from the rows
    """

    title: str
    origin: str
    variables: tuple[SweepVariable, ...]
    measures: tuple[SweepNumbers, ...]
    codes: tuple[str, ...]
    n_planned: int | None
    random: bool | None = None

    @property
    def n_rows(self) -> int:
        """The number of rows."""
        return len(self.codes)


class SweepSelection(NamedTuple):
    """What is drawn of a sweep.

    variables: those that vary in its rows, the horizontal one first if it was named
    has_named_axis: whether the horizontal variable was named
    fixed_texts: the fixed variables with their values
    """

    table: SweepTable
    variables: tuple[SweepVariable, ...]
    has_named_axis: bool
    fixed_texts: tuple[str, ...]

    @property
    def is_scattered(self) -> bool:
        """Whether its points are at random places, and not on a grid."""
        if len(self.variables) < 2:
            return bool(self.table.random) and bool(self.variables)
        if self.table.random is not None:
            return self.table.random
        rows = self.table.n_rows
        return (
            rows >= MIN_ROWS
            and sum(len(variable.levels) >= MIN_DISTINCT_SHARE * rows for variable in self.variables) >= 2
        )


def select_sweep(table: SweepTable, words: Sequence[str]) -> SweepSelection:
    """Select what some words pick from a sweep. Raises NotDrawable."""
    row_mask = np.ones(table.n_rows, dtype=bool)
    x_name: str | None = None
    measures: list[SweepNumbers] = []
    for word in words:
        name, equals, value = word.partition("=")
        variable = next((candidate for candidate in table.variables if candidate.name == name.strip()), None)
        if equals and variable is not None:
            row_mask &= _find_rows(variable, value.strip())
        elif variable is not None:
            x_name = variable.name
        else:
            measures.append(_find_measure(table, word))
    selected = _select_rows(table._replace(measures=tuple(measures) or table.measures), row_mask)
    varying = [candidate for candidate in selected.variables if len(candidate.levels) > 1]
    varying.sort(key=lambda candidate: candidate.name != x_name)
    if x_name is not None and x_name not in [candidate.name for candidate in varying]:
        hint = "choose another for the horizontal axis, or fix fewer"
        raise NotDrawable(f"{x_name} has only one value in this plot", hint)
    fixed_texts = tuple(
        f"{candidate.name} = {candidate.format_value(candidate.values[0])}"
        for candidate in selected.variables
        if len(candidate.levels) == 1
    )
    return SweepSelection(selected, tuple(varying), x_name is not None, fixed_texts)


def _find_rows(variable: SweepVariable, text: str) -> Mask:
    """Return the mask of the rows in which a variable has a value."""
    if variable.texts:
        row_mask = np.array([variable.texts[int(k)] == text for k in variable.values], dtype=bool)
    else:
        figure = parse_number_with_unit(text)
        if figure is None or figure.unit not in ("", variable.unit):
            unit = f" in {variable.unit}" if variable.unit else ""
            raise NotDrawable(
                f"{variable.name}={text}: expected a number{unit}", f"for example {make_example(variable)}"
            )
        row_mask = np.isclose(variable.values, figure.value, rtol=tolerances.SAME_VALUE, atol=0.0)
    if not row_mask.any():
        raise NotDrawable(f"{variable.name}={text}: no variant has this value", f"for example {make_example(variable)}")
    return np.asarray(row_mask)


def make_example(variable: SweepVariable) -> str:
    """Return an existing value in the form in which it is typed: NAME=VALUE."""
    levels = variable.levels
    if variable.texts:
        return f"{variable.name}={escape(variable.texts[int(levels[0])])}"
    return f"{variable.name}={levels[len(levels) // 2]:.12g}"


def _find_measure(table: SweepTable, word: str) -> SweepNumbers:
    """Return the measure that a word names completely or in part."""
    exact = [column for column in table.measures if word == column.text]
    found = exact or [column for column in table.measures if word in column.text]
    if len(found) == 1:
        return found[0]
    names = [column.name for column in table.variables] + [column.text for column in table.measures]
    if found:
        raise NotDrawable(f"{word}: {len(found)} measures match", f"name one: {found[0].text}")
    hint = suggest(word, names, "columns") or f"there are: {', '.join(names)}"
    raise NotDrawable(f"{word}: no column of the sweep has this name", hint)


def _select_rows(table: SweepTable, row_mask: Mask) -> SweepTable:
    """Return some of the rows."""
    if row_mask.all():
        return table
    variables = tuple(_drop_unused_texts(column._replace(values=column.values[row_mask])) for column in table.variables)
    measures = tuple(
        column._replace(
            values=column.values[row_mask],
            errors=column.errors[row_mask],
            missing_reasons=tuple(compress(column.missing_reasons, row_mask)),
        )
        for column in table.measures
    )
    return table._replace(
        variables=variables, measures=measures, codes=tuple(compress(table.codes, row_mask)), n_planned=None
    )


def _drop_unused_texts(variable: SweepVariable) -> SweepVariable:
    """Return the variable with only those of its texts that occur."""
    if not variable.texts:
        return variable
    levels, places = np.unique(variable.values, return_inverse=True)
    texts = tuple(variable.texts[int(k)] for k in levels)
    return variable._replace(values=places.astype(np.float64), texts=texts)


class VariableAxis(NamedTuple):
    """A variable along an axis, and a note that lists its names if the axis shows numbers in their place."""

    variable: SweepVariable
    scaling: Scaling
    note: str


def make_axis(variable: SweepVariable, *, cells: bool = False) -> VariableAxis:
    """Make the axis of a variable; cells: each of its values has a cell."""
    levels = variable.levels
    if variable.texts:
        names = [variable.texts[int(k)] for k in levels]
        numbered = len(names) > MAX_NAMES or sum(map(len, names)) > MAX_LETTERS
        tick_texts = [str(k + 1) for k in range(len(names))] if numbered else names
        scaling = Scaling(
            variable.name, float(levels[0]) - 0.5, float(levels[-1]) + 0.5,
            tick_texts=tuple(zip(levels.tolist(), tick_texts, strict=True)),
        )  # fmt: skip
        pairs = ", ".join(f"{k} {name}" for k, name in zip(tick_texts, names, strict=True))
        return VariableAxis(variable, scaling, f"{variable.name}: {pairs}" if numbered else "")
    by_ratio = _is_logarithmic(levels)
    if cells:
        edges = _find_edges(levels, by_ratio)
        return VariableAxis(variable, Scaling(variable.axis_label, float(edges[0]), float(edges[-1]), by_ratio), "")
    if by_ratio:
        return VariableAxis(
            variable, Scaling(variable.axis_label, float(levels[0]), float(levels[-1]), is_logarithmic=True), ""
        )
    return VariableAxis(
        variable, Scaling(variable.axis_label, *choose_ends(float(levels[0]), float(levels[-1]), margin=0.03)), ""
    )


def _is_logarithmic(levels: Array) -> bool:
    """Return whether the logarithms of the values are evenly spaced, but not the values."""
    if len(levels) < 3 or levels[0] <= 0.0:
        return False
    steps, ratios = np.diff(levels), np.diff(np.log(levels))
    return bool(np.ptp(ratios) <= EVEN_TOLERANCE * ratios.max() and np.ptp(steps) > EVEN_TOLERANCE * steps.max())


def _find_edges(levels: Array, by_ratio: bool) -> Array:
    """Return the edges of the cells of values, (n + 1,): half way between neighbours."""
    positions = np.log(levels) if by_ratio else levels
    middle = 0.5 * (positions[1:] + positions[:-1])
    edges = np.concatenate([[2.0 * positions[0] - middle[0]], middle, [2.0 * positions[-1] - middle[-1]]])
    return np.asarray(np.exp(edges) if by_ratio else edges)


def find_cell_edges(variable: SweepVariable, scaling: Scaling) -> Array:
    """Return the edges of the cells of a variable along its axis."""
    if variable.texts:
        return np.asarray(np.arange(len(variable.levels) + 1) + scaling.low)
    return _find_edges(variable.levels, scaling.is_logarithmic)


def make_measure_axis(unit: str, values: Array, errors: Array, spare: float = 0.12) -> Scaling:
    """Make the axis of a measure."""
    known = np.isfinite(values)
    low = float((values - errors)[known].min()) if known.any() else 0.0
    high = float((values + errors)[known].max()) if known.any() else 1.0
    return Scaling(f"[{unit or '-'}]", *choose_ends(low, high, zero=is_zero_near(low, high), margin=spare))


def draw_contours(cells: Cells, x: Array, y: Array) -> Iterator[Item]:
    """Draw contours at round values, each with its value at its middle.

    x, y: the places of the values, the middles of the cells
    """
    values = cells.values
    known = values[np.isfinite(values)]
    if min(values.shape) < MIN_LEVELS or not known.size or not known.max() > known.min():
        return
    for level, text in choose_ticks(Scaling("", float(known.min()), float(known.max())), MAX_CONTOURS):
        squares = [(i, j) for j in range(len(y) - 1) for i in range(len(x) - 1)]
        ends = [stroke for i, j in squares for stroke in _cross(values, x, y, i, j, level)]
        if ends:
            strokes = np.array(ends)
            yield Strokes(strokes, width=1.0)
            middle = strokes[np.argsort(strokes[:, 0, 0], kind="stable")[len(strokes) // 2]].mean(axis=0)
            yield Words(float(middle[0]), float(middle[1]), text)


def _cross(values: Array, x: Array, y: Array, i: int, j: int, level: float) -> list[list[tuple[float, float]]]:
    """Return the strokes of a contour in the square between four values; of a saddle the two that part its corners."""
    corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
    heights = [float(values[b, a]) - level for a, b in corners]
    if not np.isfinite(heights).all():
        return []
    points = []
    for k in range(4):
        (a, b), (c, d), p, q = corners[k], corners[(k + 1) % 4], heights[k], heights[(k + 1) % 4]
        if (p >= 0.0) != (q >= 0.0):
            share = p / (p - q)
            points.append((float(x[a] + share * (x[c] - x[a])), float(y[b] + share * (y[d] - y[b]))))
    return [points[k : k + 2] for k in range(0, len(points), 2)]
