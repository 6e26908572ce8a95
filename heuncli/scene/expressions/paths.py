"""Paths in space: a point over a parameter, piece by piece a cubic in each coordinate.

    r(s) = c0 + c1 h + c2 h² + c3 h³,   h = s - s_k        in the piece from s_k on, each c a vector
The tables of the coordinates may have knots of their own: a piece of the path ends where one of any of them does.
Beyond open ends the last piece goes on, and a closed path round again. Beside a path in a plane the centre of a roller
may run, which is the place that is asked for then (beside.py); the path itself is its track.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import record, replace
from heuncli.results.results import Array
from heuncli.scene.expressions.beside import bounds, centre, flat
from heuncli.scene.expressions.programs import TableFunction

PERIODIC = 2  # a table's kind (scene/expressions/programs.py)
LOOKS = 8  # places in a piece at which a path is looked at
AT_ONCE = 2**18  # distances that are looked at together
NEWTON = 32  # steps to the nearest place
TRIED = 4  # of the places looked at, those from which the nearest is sought
BEYOND = 0.01  # of a path, by which it goes on behind a stop at its end: what is at the stop is there to rounding
AROUND = 64  # directions that are tried
NO_PLANE = np.zeros(3)
NO_PLANE.setflags(write=False)


@record
class Path:
    """A path: knots (n + 1,), coefficients (n, 4, 3) [m]; period: of the parameter where it is closed, else 0.

    radius: of a roller [m] whose centre is to the left of the path, seen so that its plane's normal (3,) points here.
    """

    knots: Array
    coefficients: Array
    period: float
    radius: float = 0.0
    normal: Array = NO_PLANE

    @property
    def first(self) -> float:
        """Where the parameter begins."""
        return float(self.knots[0])

    @property
    def last(self) -> float:
        """Where it ends."""
        return float(self.knots[-1])

    def turned(self, R: Array) -> Path:
        """The path seen in other axes: R takes components in its own to those."""
        return replace(self, coefficients=self.coefficients @ R.T, normal=R @ self.normal)

    def later(self, phase: float) -> Path:
        """The path with every place at a parameter that is greater by the phase."""
        return replace(self, knots=self.knots + phase) if phase else self

    def beyond(self, first: bool, last: bool) -> Path:
        """The path with its end pieces gone on a little, at its first end, its last, or both; a closed one as it is."""
        if self.period or not (first or last):
            return self
        more = BEYOND * (self.last - self.first)
        knots, pieces = self.knots.copy(), self.coefficients.copy()
        if first:
            knots[0] -= more
            r, slope, bend, twist = self.track(self.first)
            r, slope, bend = (
                r - more * (slope - more * (bend / 2.0 - more * twist / 6.0)),
                slope - more * (bend - more * twist / 2.0), bend - more * twist,
            )  # fmt: skip
            pieces[0] = r, slope, bend / 2.0, twist / 6.0
        if last:
            knots[-1] += more
        return replace(self, knots=knots, coefficients=pieces)

    def at(self, s: Array | float) -> tuple[Array, Array, Array]:
        """Place, slope and bend of what runs along the path, or beside it, (..., 3) each; s of any shape."""
        return self.course(s)[:3]

    def course(self, s: Array | float) -> tuple[Array, Array, Array, Array]:
        """The same with the third derivative."""
        track = self.track(s)
        return centre(self.radius, self.normal, track) if self.radius else track

    def track(self, s: Array | float) -> tuple[Array, Array, Array, Array]:
        """Place r of the path itself and its derivatives r', r'', r''', (..., 3) each; s of any shape."""
        s = np.asarray(s, dtype=float)
        inside = self.first + np.mod(s - self.first, self.period) if self.period else s
        k = np.clip(np.searchsorted(self.knots, inside, side="right") - 1, 0, len(self.knots) - 2)
        h = (inside - self.knots[k])[..., None]
        c0, c1, c2, c3 = np.moveaxis(self.coefficients[k], -2, 0)
        slope, bend = (3.0 * c3 * h + 2.0 * c2) * h + c1, 6.0 * c3 * h + 2.0 * c2
        return ((c3 * h + c2) * h + c1) * h + c0, slope, bend, np.broadcast_to(6.0 * c3, bend.shape)

    @property
    def looked_at(self) -> Array:
        """Parameters that show the path, a number in each piece, (m,)."""
        steps = np.arange(LOOKS) / LOOKS
        inner = (self.knots[:-1, None] + np.diff(self.knots)[:, None] * steps).ravel()
        return np.append(inner, self.last)

    def nearest(self, points: Array) -> Array:
        """The parameter of the path's place nearest to each point, (...); points (..., 3), in the path's axes.

        By Newton's method on (r - x) . r' = 0 from each of the nearest places looked at, for one of another part of the
        path may lie nearer than those about the place that is sought.
        """
        flat = np.reshape(points, (-1, 3))
        s = self.looked_at
        r = self.at(s)[0]
        room = max(1, AT_ONCE // len(s))
        found = [self._nearest(flat[i : i + room], s, r) for i in range(0, len(flat), room)]
        return np.concatenate(found).reshape(points.shape[:-1]) if found else np.zeros(points.shape[:-1])

    @property
    def off_all_slopes(self) -> Array:
        """A direction (3,) from which all slopes stand off well; of a path in a plane across that."""
        t = self.at(self.looked_at)[1]
        t = t / np.sqrt(np.sum(t * t, axis=-1))[:, None]
        off: Array = np.linalg.eigh(t.T @ t)[1].T
        z = 1.0 - (np.arange(AROUND) + 0.5) / AROUND  # a hemisphere, evenly
        turns = np.arange(AROUND) * np.pi * (3.0 - np.sqrt(5.0))
        ring = np.sqrt(1.0 - z * z)
        off = np.vstack([off, np.stack([ring * np.cos(turns), ring * np.sin(turns), z], axis=-1)])
        nearest = np.max(np.abs(off @ t.T), axis=1)
        nearest[0] -= 0.5  # the plane's normal, if the path is not far from one
        return np.asarray(off[np.argmin(nearest)])

    def along(self, points: Array, counted: Array) -> Array:
        """The parameters of the places beside points (n, 3), each on the branch about one that is counted, (n,)."""
        room = self.last - self.first
        low, high = counted - room, counted + room
        if not self.period:
            low, high = np.maximum(low, self.first), np.minimum(high, self.last)
        return self._descended(points, counted, low, high)

    def near(self, point: Array, s: float) -> float:
        """The parameter of the place nearest to a point (3,) on the branch about a parameter: others may be nearer."""
        inside = self.first + (s - self.first) % self.period if self.period else s
        steps = np.diff(self.looked_at)
        room = float(steps[np.clip(np.searchsorted(self.looked_at, inside) - 1, 0, len(steps) - 1)])
        low, high = (s - room, s + room) if self.period else (max(s - room, self.first), min(s + room, self.last))
        return float(self._descended(point, np.array(s), np.array(low), np.array(high)))

    def branches(self, point: Array, within: float) -> list[float]:
        """The parameters of all places about a point (3,) where the path comes as near as within, each branch once."""
        s = self.looked_at
        low, high = np.append(s[0], s[:-1]), np.append(s[1:], s[-1])
        found = self._descended(point, s, low, high)
        off = np.sqrt(np.sum(np.square(self.at(found)[0] - point), axis=-1))
        same = 0.5 * float(np.min(np.diff(s)))
        told: list[float] = []
        for here in np.sort(found[off <= within]).tolist():
            around = self.period and told and here > told[0] + self.period - same
            if not around and all(here > other + same for other in told):
                told.append(here)
        return told

    def _nearest(self, points: Array, s: Array, r: Array) -> Array:
        """The same of a few points (k, 3); s, r: the places looked at."""
        low, high = np.append(s[0], s[:-1]), np.append(s[1:], s[-1])
        if self.period:
            low[0], high[-1] = s[0] - (s[-1] - s[-2]), s[-1] + (s[1] - s[0])
        away = np.sum(r * r, axis=1) - 2.0 * (points @ r.T)  # but for the point's own square
        falls = away[:, 1:] <= away[:, :-1]
        least = np.ones(away.shape, dtype=bool)
        least[:, 1:] &= falls
        least[:, :-1] &= ~falls | (away[:, 1:] == away[:, :-1])
        away[~least] = np.inf
        begun = np.argpartition(away, min(TRIED, len(s)) - 1, axis=1)[:, :TRIED]
        found = self._descended(points[:, None, :], s[begun], low[begun], high[begun])
        left = np.sum(np.square(points[:, None, :] - self.at(found)[0]), axis=-1)
        return np.asarray(np.take_along_axis(found, np.argmin(left, axis=1)[:, None], axis=1)[:, 0])

    def _descended(self, points: Array, begun: Array, low: Array, high: Array) -> Array:
        """Where Newton's method leads from parameters, held between others."""
        found = begun
        for _ in range(NEWTON):
            place, slope, bend = self.at(found)
            off = place - points
            square = np.sum(slope * slope, axis=-1)
            curved = square + np.sum(off * bend, axis=-1)
            to = np.clip(found - np.sum(off * slope, axis=-1) / np.where(curved > 0.0, curved, square), low, high)
            if np.all(np.abs(to - found) <= np.finfo(float).eps * (abs(self.first) + abs(self.last))):
                return np.asarray(to)
            found = to
        nearest: Array = found
        return nearest

    @property
    def greatest(self) -> tuple[float, float, float]:
        """Bounds of place, slope and bend of what runs along the path, or beside it."""
        r, slope, bend = self.track_greatest
        return (r + self.radius, *bounds(self)) if self.radius else (r, slope, bend)

    @property
    def track_greatest(self) -> tuple[float, float, float]:
        """Bounds of |r|, |r'| and |r''| over all of it: no coordinate of a cubic exceeds its Bernstein coefficients."""
        h = np.diff(self.knots)[:, None]
        c0, c1, c2, c3 = np.moveaxis(self.coefficients, 1, 0)
        a, b, c = c1 * h, c2 * h * h, c3 * h * h * h
        places = np.stack([c0, c0 + a / 3.0, c0 + (2.0 * a + b) / 3.0, c0 + a + b + c])
        slopes = np.stack([a, a + b, a + 2.0 * b + 3.0 * c]) / h
        bends = np.stack([2.0 * b, 2.0 * b + 6.0 * c]) / (h * h)
        r, slope, bend = (float(np.sqrt(np.max(np.sum(x * x, axis=-1)))) for x in (places, slopes, bends))
        return r, slope, bend


def path_beside(path: Path, radius: float, normal: Sequence[float]) -> Path:
    """What the centre of a roller runs along beside a path, which lies across the normal to the digits typed."""
    N = np.asarray(normal, dtype=float)
    N = N / np.sqrt(N @ N)
    return replace(path, coefficients=flat(path.coefficients, N), radius=radius, normal=N)


def path_of(parts: Sequence[TableFunction | float]) -> Path:
    """The path whose three coordinates are tables, or numbers that stay; one at least is a table."""
    tables = [part for part in parts if isinstance(part, TableFunction)]
    open_ones = [table for table in tables if table.kind != PERIODIC] or tables[:1]
    first, last = (f(knots_of(table)[i] for table in open_ones) for f, i in ((max, 0), (min, -1)))
    cuts = [knot for table in tables for knot in repeated(table, first, last)]
    knots = merged(np.unique([first, last, *cuts]), last - first)
    middles = 0.5 * (knots[1:] + knots[:-1])
    columns = [shifted(part, knots[:-1], middles) for part in parts]
    closed = all(table.kind == PERIODIC for table in tables)
    return Path(knots, np.stack(columns, axis=-1), last - first if closed else 0.0)


def knots_of(table: TableFunction) -> Array:
    """The points of the parameter at which a table's pieces begin, and its end."""
    return np.asarray(np.frombuffer(table.numbers)[1 : table.pieces + 2])


def repeated(table: TableFunction, first: float, last: float) -> Iterator[float]:
    """The knots of a table between two parameters, of all its turns where it is periodic."""
    knots, period = knots_of(table), table.numbers[0]
    turns = range(1)
    if table.kind == PERIODIC:
        turns = range(int(np.floor((first - knots[0]) / period)), int(np.floor((last - knots[0]) / period)) + 1)
    for turn in turns:
        own = knots + turn * period
        yield from own[(own > first) & (own < last)].tolist()


def merged(knots: Array, span: float) -> Array:
    """Knots without those that only rounding tells apart; the ends stay."""
    apart = np.diff(knots) > tolerances.SAME_VALUE * span
    kept: Array = knots[np.append(True, apart)]
    kept[-1] = knots[-1]
    return kept


def shifted(part: TableFunction | float, begins: Array, middles: Array) -> Array:
    """The cubics (n, 4) of a coordinate in pieces from `begins` on, each a part of one of its own round the middle."""
    if not isinstance(part, TableFunction):
        return np.array([[part, 0.0, 0.0, 0.0]] * len(begins))
    numbers = np.frombuffer(part.numbers)
    knots = knots_of(part)
    own = numbers[part.pieces + 2 :].reshape(-1, 4)
    turns = np.floor((middles - knots[0]) / numbers[0]) * numbers[0] if part.kind == PERIODIC else 0.0
    k = np.clip(np.searchsorted(knots, middles - turns, side="right") - 1, 0, part.pieces - 1)
    h = begins - turns - knots[k]
    c0, c1, c2, c3 = own[k].T
    return np.stack(
        [((c3 * h + c2) * h + c1) * h + c0, (3.0 * c3 * h + 2.0 * c2) * h + c1, 3.0 * c3 * h + c2, c3], axis=-1
    )


def cusp(path: Path) -> float | None:
    """The parameter at which the path stands still, so that it has no direction there; None where it has one all along.

    The square of the slope is of degree 4 in a piece: where it nearly vanishes it is looked at closely.
    """
    s = path.looked_at
    for _ in range(3):
        slope = path.track(s)[1]
        size = np.sqrt(np.sum(slope * slope, axis=-1))
        i = int(np.argmin(size))
        if size[i] < tolerances.STANDS_STILL * path.track_greatest[1]:
            return float(s[i])
        low, high = s[max(i - 1, 0)], s[min(i + 1, len(s) - 1)]
        s = np.linspace(low, high, 4 * LOOKS + 1)
    return None
