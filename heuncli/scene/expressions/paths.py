"""Represent paths in space: a point as a function of a parameter, piece by piece a cubic in each coordinate.

    r(s) = c0 + c1 h + c2 h² + c3 h³,   h = s - s_k        in the piece from s_k on, each c a vector
The tables of the coordinates may have different knots: a piece of the path ends where a piece of any of them does.
Beyond an open end the last piece continues, and a closed path repeats. The centre of a roller may run along a path in a
plane; then its place is what `evaluate` returns (roller_path.py), and the path itself is the track.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record, replace
from heuncli.results.results import Array
from heuncli.scene.expressions.motion_segments import MotionRows
from heuncli.scene.expressions.programs import TableFunction
from heuncli.scene.expressions.roller_path import bound_derivatives, project_to_plane, roller_centre

PERIODIC = 2  # a table's kind (scene/expressions/programs.py)
SAMPLES_PER_PIECE = 8  # samples of each piece
MAX_DISTANCES_AT_ONCE = 2**18  # distances computed together
NEWTON_STEPS = 32  # most steps of Newton's method
NEWTON_STARTS = 4  # number of nearest samples from which Newton's method starts
END_EXTENSION = 0.01  # of the path's length: extension behind an end stop, where a body stands only up to rounding
DIRECTION_COUNT = 64  # number of directions that are tried
NO_PLANE = np.zeros(3)
NO_PLANE.setflags(write=False)


@record
class Path:
    """A path in space, or the path of a roller's centre along it.

    knots: (n + 1,)
    coefficients: (n, 4, 3) [m]
    period: of the parameter if the path is closed, else 0
    radius: of a roller [m] whose centre is to the left of the path, seen from the side to which the normal points; 0:
    no roller
    normal: of the path's plane, (3,)
    """

    knots: Array
    coefficients: Array
    period: float
    radius: float = 0.0
    normal: Array = NO_PLANE

    @property
    def first(self) -> float:
        """The parameter at the start."""
        return float(self.knots[0])

    @property
    def last(self) -> float:
        """The parameter at the end."""
        return float(self.knots[-1])

    def rotate(self, R: Array) -> Path:
        """Return the path in other axes; R takes components in its own axes to those."""
        return replace(self, coefficients=self.coefficients @ R.T, normal=R @ self.normal)

    def shift_parameter(self, phase: float) -> Path:
        """Return the path with its parameter increased by the phase."""
        return replace(self, knots=self.knots + phase) if phase else self

    def extend(self, first: bool, last: bool) -> Path:
        """Return the path slightly extended at its first end, its last, or both; a closed path stays as it is."""
        if self.period or not (first or last):
            return self
        extension = END_EXTENSION * (self.last - self.first)
        knots, pieces = self.knots.copy(), self.coefficients.copy()
        if first:
            knots[0] -= extension
            r, slope, second, third = self.evaluate_track(self.first)
            r, slope, second = (
                r - extension * (slope - extension * (second / 2.0 - extension * third / 6.0)),
                slope - extension * (second - extension * third / 2.0), second - extension * third,
            )  # fmt: skip
            pieces[0] = r, slope, second / 2.0, third / 6.0
        if last:
            knots[-1] += extension
        return replace(self, knots=knots, coefficients=pieces)

    def evaluate(self, s: Array | float) -> tuple[Array, Array, Array]:
        """Return place, first and second derivative of the path, or of the roller's centre, (..., 3) each; s of any
        shape.
        """
        return self.evaluate_with_third(s)[:3]

    def evaluate_with_third(self, s: Array | float) -> tuple[Array, Array, Array, Array]:
        """Return place and the first three derivatives of the path, or of the roller's centre, (..., 3) each."""
        track = self.evaluate_track(s)
        return roller_centre(self.radius, self.normal, track) if self.radius else track

    def evaluate_track(self, s: Array | float) -> tuple[Array, Array, Array, Array]:
        """Return the place r of the path itself and its derivatives r', r'', r''', (..., 3) each; s of any shape."""
        s = np.asarray(s, dtype=float)
        inside = self.first + np.mod(s - self.first, self.period) if self.period else s
        k = np.clip(np.searchsorted(self.knots, inside, side="right") - 1, 0, len(self.knots) - 2)
        h = (inside - self.knots[k])[..., None]
        c0, c1, c2, c3 = np.moveaxis(self.coefficients[k], -2, 0)
        slope, second = (3.0 * c3 * h + 2.0 * c2) * h + c1, 6.0 * c3 * h + 2.0 * c2
        return ((c3 * h + c2) * h + c1) * h + c0, slope, second, np.broadcast_to(6.0 * c3, second.shape)

    @property
    def sample_parameters(self) -> Array:
        """Parameters that sample the path, several in each piece, (m,)."""
        steps = np.arange(SAMPLES_PER_PIECE) / SAMPLES_PER_PIECE
        inner = (self.knots[:-1, None] + np.diff(self.knots)[:, None] * steps).ravel()
        return np.append(inner, self.last)

    def find_nearest(self, points: Array) -> Array:
        """Find the parameter of the place nearest to each point, (...); points (..., 3), in the path's axes.

        Newton's method on (r - x) . r' = 0 starts from several of the nearest samples, as another part of the path may
        lie nearer than the nearest sample's.
        """
        point_rows = np.reshape(points, (-1, 3))
        s = self.sample_parameters
        r = self.evaluate(s)[0]
        chunk = max(1, MAX_DISTANCES_AT_ONCE // len(s))
        found = [self._find_nearest(point_rows[i : i + chunk], s, r) for i in range(0, len(point_rows), chunk)]
        return np.concatenate(found).reshape(points.shape[:-1]) if found else np.zeros(points.shape[:-1])

    @property
    def direction_off_slopes(self) -> Array:
        """A direction (3,) that is far from all tangents; for a plane path it is the plane's normal."""
        tangents = self.evaluate(self.sample_parameters)[1]
        tangents = tangents / np.sqrt(np.sum(tangents * tangents, axis=-1))[:, None]
        directions: Array = np.linalg.eigh(tangents.T @ tangents)[1].T
        z = 1.0 - (np.arange(DIRECTION_COUNT) + 0.5) / DIRECTION_COUNT  # evenly spread over a hemisphere
        angles = np.arange(DIRECTION_COUNT) * np.pi * (3.0 - np.sqrt(5.0))
        ring = np.sqrt(1.0 - z * z)
        directions = np.vstack([directions, np.stack([ring * np.cos(angles), ring * np.sin(angles), z], axis=-1)])
        nearest = np.max(np.abs(directions @ tangents.T), axis=1)
        nearest[0] -= 0.5  # prefer the plane's normal if the path is nearly plane
        return np.asarray(directions[np.argmin(nearest)])

    def track_parameters(self, points: Array, previous: Array) -> Array:
        """Find the parameters of the places nearest to points (n, 3), each on the branch around its previous parameter,
        (n,).
        """
        length = self.last - self.first
        low, high = previous - length, previous + length
        if not self.period:
            low, high = np.maximum(low, self.first), np.minimum(high, self.last)
        return self._refine_parameters(points, previous, low, high)

    def find_nearby(self, point: Array, s: float) -> float:
        """Find the parameter of the nearest place to a point (3,) on the branch around s; other branches may be
        nearer.
        """
        inside = self.first + (s - self.first) % self.period if self.period else s
        steps = np.diff(self.sample_parameters)
        sample_step = float(steps[np.clip(np.searchsorted(self.sample_parameters, inside) - 1, 0, len(steps) - 1)])
        low, high = (
            (s - sample_step, s + sample_step)
            if self.period
            else (max(s - sample_step, self.first), min(s + sample_step, self.last))
        )
        return float(self._refine_parameters(point, np.array(s), np.array(low), np.array(high)))

    def find_branches(self, point: Array, max_distance: float) -> list[float]:
        """Find the parameters of all locally nearest places within max_distance of a point (3,), one for each
        branch.
        """
        s = self.sample_parameters
        low, high = np.append(s[0], s[:-1]), np.append(s[1:], s[-1])
        found = self._refine_parameters(point, s, low, high)
        distance = np.sqrt(np.sum(np.square(self.evaluate(found)[0] - point), axis=-1))
        same = 0.5 * float(np.min(np.diff(s)))
        distinct: list[float] = []
        for here in np.sort(found[distance <= max_distance]).tolist():
            wraps = self.period and distinct and here > distinct[0] + self.period - same
            if not wraps and all(here > other + same for other in distinct):
                distinct.append(here)
        return distinct

    def _find_nearest(self, points: Array, s: Array, r: Array) -> Array:
        """Find the nearest places of a few points (k, 3). s, r: the samples of the path."""
        low, high = np.append(s[0], s[:-1]), np.append(s[1:], s[-1])
        if self.period:
            low[0], high[-1] = s[0] - (s[-1] - s[-2]), s[-1] + (s[1] - s[0])
        distance = np.sum(r * r, axis=1) - 2.0 * (points @ r.T)  # without the point's square, a constant
        is_falling = distance[:, 1:] <= distance[:, :-1]
        is_minimum = np.ones(distance.shape, dtype=bool)
        is_minimum[:, 1:] &= is_falling
        is_minimum[:, :-1] &= ~is_falling | (distance[:, 1:] == distance[:, :-1])
        distance[~is_minimum] = np.inf
        starts = np.argpartition(distance, min(NEWTON_STARTS, len(s)) - 1, axis=1)[:, :NEWTON_STARTS]
        found = self._refine_parameters(points[:, None, :], s[starts], low[starts], high[starts])
        remaining = np.sum(np.square(points[:, None, :] - self.evaluate(found)[0]), axis=-1)
        return np.asarray(np.take_along_axis(found, np.argmin(remaining, axis=1)[:, None], axis=1)[:, 0])

    def _refine_parameters(self, points: Array, start: Array, low: Array, high: Array) -> Array:
        """Refine parameters by Newton's method, each limited to [low, high]."""
        found = start
        for _ in range(NEWTON_STEPS):
            place, slope, bend = self.evaluate(found)
            offset = place - points
            square = np.sum(slope * slope, axis=-1)
            second_derivative = square + np.sum(offset * bend, axis=-1)
            next_parameter = np.clip(
                found - np.sum(offset * slope, axis=-1) / np.where(second_derivative > 0.0, second_derivative, square),
                low,
                high,
            )
            if np.all(np.abs(next_parameter - found) <= np.finfo(float).eps * (abs(self.first) + abs(self.last))):
                return np.asarray(next_parameter)
            found = next_parameter
        nearest: Array = found
        return nearest

    @property
    def bounds(self) -> tuple[float, float, float]:
        """Bounds of place, first and second derivative of the path, or of the roller's centre."""
        r, slope, bend = self.track_bounds
        return (r + self.radius, *bound_derivatives(self)) if self.radius else (r, slope, bend)

    @property
    def track_bounds(self) -> tuple[float, float, float]:
        """Bounds of |r|, |r'| and |r''| over the whole path: no coordinate of a cubic exceeds its Bernstein
        coefficients.
        """
        h = np.diff(self.knots)[:, None]
        c0, c1, c2, c3 = np.moveaxis(self.coefficients, 1, 0)
        a, b, c = c1 * h, c2 * h * h, c3 * h * h * h
        places = np.stack([c0, c0 + a / 3.0, c0 + (2.0 * a + b) / 3.0, c0 + a + b + c])
        slopes = np.stack([a, a + b, a + 2.0 * b + 3.0 * c]) / h
        bends = np.stack([2.0 * b, 2.0 * b + 6.0 * c]) / (h * h)
        r, slope, second = (float(np.sqrt(np.max(np.sum(x * x, axis=-1)))) for x in (places, slopes, bends))
        return r, slope, second


class LiftPath(Path):
    """The lift of a cam in segments over the disc's angle, in the first component.

    coefficients (n, 4, 3): of a piece, as its polynomial of degree 7 and its sine (motion_segments.py) lie in the
    kernel's rows: a0 to a3, a4 to a7, and amplitude, frequency and phase in one column each
    """

    def evaluate_track(self, s: Array | float) -> tuple[Array, Array, Array, Array]:
        """Return the lift and its derivatives in the first of three components, (..., 3) each; s of any shape."""
        s = np.asarray(s, dtype=float)
        inside = self.first + np.mod(s - self.first, self.period) if self.period else s
        k = np.clip(np.searchsorted(self.knots, inside, side="right") - 1, 0, len(self.knots) - 2)
        h = inside - self.knots[k]
        rows = self.coefficients[k]
        polynomial = np.concatenate([rows[..., 0], rows[..., 1]], axis=-1)
        amplitude, frequency, phase = np.moveaxis(rows[..., :3, 2], -1, 0)
        found = []
        for order in range(4):
            total = np.zeros(h.shape)
            for a in np.moveaxis(polynomial, -1, 0)[::-1]:
                total = a + h * total
            wave = amplitude * frequency**order * np.sin(frequency * h + phase + 0.5 * np.pi * order)
            found.append(np.stack([total + wave, np.zeros(h.shape), np.zeros(h.shape)], axis=-1))
            polynomial = polynomial[..., 1:] * np.arange(1.0, polynomial.shape[-1])
        return found[0], found[1], found[2], found[3]


def make_lift_path(motion: MotionRows, period: float) -> LiftPath:
    """Make the lift of a cam in segments; period: 0 if it is open."""
    coefficients = np.zeros((len(motion.rows), 4, 3))
    for piece, row in zip(coefficients, motion.rows, strict=True):
        polynomial = np.zeros(8)
        polynomial[: len(row.coefficients)] = row.coefficients
        piece[:, 0], piece[:, 1] = polynomial[:4], polynomial[4:]
        piece[:3, 2] = row.amplitude, row.frequency, row.phase
    return LiftPath(np.array(motion.knots), coefficients, period)


def make_roller_path(path: Path, radius: float, normal: Sequence[float]) -> Path:
    """Make the path of a roller's centre along a path, which lies in the plane across the normal up to typed digits."""
    N = np.asarray(normal, dtype=float)
    N = N / np.sqrt(N @ N)
    return replace(path, coefficients=project_to_plane(path.coefficients, N), radius=radius, normal=N)


def make_path(parts: Sequence[TableFunction | float]) -> Path:
    """Make the path whose three coordinates are tables or constants; at least one is a table."""
    tables = [part for part in parts if isinstance(part, TableFunction)]
    open_tables = [table for table in tables if table.kind != PERIODIC] or tables[:1]
    first, last = (f(table_knots(table)[i] for table in open_tables) for f, i in ((max, 0), (min, -1)))
    inner_knots = [knot for table in tables for knot in iter_knots(table, first, last)]
    knots = merge_knots(np.unique([first, last, *inner_knots]), last - first)
    middles = 0.5 * (knots[1:] + knots[:-1])
    columns = [shift_cubics(part, knots[:-1], middles) for part in parts]
    closed = all(table.kind == PERIODIC for table in tables)
    return Path(knots, np.stack(columns, axis=-1), last - first if closed else 0.0)


def table_knots(table: TableFunction) -> Array:
    """Return the parameters at which a table's pieces begin, and its end."""
    return np.asarray(np.frombuffer(table.numbers)[1 : table.pieces + 2])


def iter_knots(table: TableFunction, first: float, last: float) -> Iterator[float]:
    """Yield the knots of a table between two parameters, in all its periods."""
    knots, period = table_knots(table), table.numbers[0]
    periods = range(1)
    if table.kind == PERIODIC:
        periods = range(int(np.floor((first - knots[0]) / period)), int(np.floor((last - knots[0]) / period)) + 1)
    for period_number in periods:
        shifted = knots + period_number * period
        yield from shifted[(shifted > first) & (shifted < last)].tolist()


def merge_knots(knots: Array, span: float) -> Array:
    """Drop knots that differ from others only by rounding; the ends stay."""
    is_separate = np.diff(knots) > tolerances.SAME_VALUE * span
    separate: Array = knots[np.append(True, is_separate)]
    separate[-1] = knots[-1]
    return separate


def shift_cubics(part: TableFunction | float, begins: Array, middles: Array) -> Array:
    """Return the cubics (n, 4) of a coordinate for pieces starting at `begins`, each part of one of its own pieces."""
    if not isinstance(part, TableFunction):
        return np.array([[part, 0.0, 0.0, 0.0]] * len(begins))
    numbers = np.frombuffer(part.numbers)
    knots = table_knots(part)
    coefficients = numbers[part.pieces + 2 :].reshape(-1, 4)
    offsets = np.floor((middles - knots[0]) / numbers[0]) * numbers[0] if part.kind == PERIODIC else 0.0
    k = np.clip(np.searchsorted(knots, middles - offsets, side="right") - 1, 0, part.pieces - 1)
    h = begins - offsets - knots[k]
    c0, c1, c2, c3 = coefficients[k].T
    return np.stack(
        [((c3 * h + c2) * h + c1) * h + c0, (3.0 * c3 * h + 2.0 * c2) * h + c1, 3.0 * c3 * h + c2, c3], axis=-1
    )


def find_cusp(path: Path) -> float | None:
    """Find the parameter at which the path has no direction, as its slope vanishes; None if it has one everywhere.

    The square of the slope is of degree 4 in a piece; where it nearly vanishes, it is sampled more finely.
    """
    s = path.sample_parameters
    for _ in range(3):
        slope = path.evaluate_track(s)[1]
        speed = np.sqrt(np.sum(slope * slope, axis=-1))
        i = int(np.argmin(speed))
        if speed[i] < tolerances.NO_PATH_DIRECTION * path.track_bounds[1]:
            return float(s[i])
        low, high = s[max(i - 1, 0)], s[min(i + 1, len(s) - 1)]
        s = np.linspace(low, high, 4 * SAMPLES_PER_PIECE + 1)
    return None
