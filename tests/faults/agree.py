"""Whether two runs that should say the same do so, within the errors that they state of themselves."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from random import Random
from typing import Any, NamedTuple

import numpy as np

from heuncli.results.path_words import ESTIMATE_OF_BLOCK, TREE, Node, find_child
from heuncli.results.results import Array, Block
from heuncli.results.results_schema import ESTIMATE_OF_ERROR_KIND, SPACE, Quantity
from heuncli.study.queries.measure import find_peak
from heuncli.study.queries.study import Study

TIMES = 10.0  # the stated errors
SAME = 1e-9  # of the last instant
FLOOR = 1e-7  # of the largest of a unit: what is hunted here are wrong numbers, not last digits
BLOCKS = ("bodies", "points", "coordinates", "foundation", "joints", "stops", "couplings", "sections", "forces",
          "energy")  # fmt: skip
# not everywhere defined, told elsewhere, or of a strength that is not told otherwise
SKIPPED = frozenset({"quaternion", "rodrigues", "axis", "line", "shares", "about", "pitch", "utilisation"})
LEAST = {"rad": 1.0, "1": 1.0, "Pa": 1e3}  # numbers far below these are rounding of what is 0
# powers of mass, length, time in units
POWERS = {
    "m": (0, 1, 0), "m/s": (0, 1, -1), "m/s²": (0, 1, -2), "rad/s": (0, 0, -1), "rad/s²": (0, 0, -2), "N": (1, 1, -2),
    "N·m": (1, 2, -2), "J": (1, 2, -2), "W": (1, 2, -3), "N·m/s": (1, 2, -3), "Pa": (1, -1, -2), "s": (0, 0, 1),
    "N·s": (1, 1, -1), "N·m·s": (1, 2, -1),
}  # fmt: skip


class Apart(NamedTuple):
    """Two numbers that are not the same: where, how far apart, and how far they may be."""

    path: str
    off: float
    allowed: float

    def __str__(self) -> str:
        return f"{self.path} off by {self.off:.3g} where {self.allowed:.3g} is stated"


Change = Callable[[Array, Quantity], Array]


def apart(first: Study, second: Study, change: Change, *, same_open: bool = True, skipped: frozenset[str] = frozenset(),
          clock: Callable[[Array], Array] = lambda t: t, more: bool = False) -> list[Apart]:  # fmt: skip
    """What the second run says otherwise than the first, changed as the telling wants it; the worst of each block.

    same_open: the same components are open in both. skipped: names of what is not compared. clock: the second's time at
    an instant of the first. more: the second may have entries that the first has not.
    """
    sizes = sizes_of(first, second)
    here, there = instants_of_both(first, second, clock)
    found: list[Apart] = []
    for block in BLOCKS if len(here) else ():
        pairs = _pairs(block, getattr(first.results, block), getattr(second.results, block), TREE[block])
        worst: list[Apart] = []
        for path, one, other, row in pairs:
            if left_out(path, skipped):
                continue
            if row is None:
                worst += [] if more and one is None else [Apart(path, math.inf, 0.0)]
            elif row.is_timed:
                wanted, told = change(np.asarray(one, dtype=float)[here], row), np.asarray(other, dtype=float)[there]
                worst += _compared(path, wanted, told, row, first, second, same_open, sizes)
        if worst:
            found.append(max(worst, key=lambda one: one.off / max(one.allowed, 1e-300)))
    return found + (struck_apart(first, second, change, same_open, skipped) if not found else [])


def left_out(path: str, skipped: frozenset[str]) -> bool:
    """Whether a path has a name that is not compared, or begins with one that is."""
    return bool({*path.split(".")} & (SKIPPED | skipped)) or any(path.startswith(f"{own}.") for own in skipped)


def instants_of_both(first: Study, second: Study, clock: Callable[[Array], Array]) -> tuple[Array, Array]:
    """The places of instants that both runs tell, where both stand behind what they tell."""
    told, wanted = second.results.time, clock(first.results.time)
    place = np.minimum(np.searchsorted(told, wanted - SAME * told[-1]), len(told) - 1)
    here = np.flatnonzero(np.abs(told[place] - wanted) <= SAME * max(told[-1], 1e-300))
    there = place[here]
    known = np.ones(len(here), dtype=bool)
    for one, at in ((first, here), (second, there)):
        times, horizon = one.results.time[at], one.results.accuracy.get("horizon")
        known &= times < horizon if horizon is not None else True
        known &= ~np.isin(times, one.results.accuracy.get("unknown", []))
    return here[known], there[known]


def struck_apart(first: Study, second: Study, change: Change, same_open: bool, skipped: frozenset[str]) -> list[Apart]:
    """The same of the first blows."""
    blows = [one.results.impulses[:1] for one in (first, second)]
    if [bool(one) for one in blows] != [True, True]:
        return []
    found: list[Apart] = []
    one, other = (of[0] for of in blows)
    for path, a, b, row in _pairs("impulses.0", one, other, TREE["impulses"]["NUMBER"]):
        if row is None or left_out(path, skipped) or not row.units:
            continue
        wanted, told = change(np.asarray(a, dtype=float), row), np.asarray(b, dtype=float)
        own = {unit: float(np.nanmax(np.abs(told), initial=0.0)) if told.size else 0.0 for unit in row.units}
        if not path.endswith("time"):
            found += _compared(path, wanted, told, row, first, second, same_open, own)
    return found


def _pairs(path: str, one: Any, other: Any, node: Node | Quantity | None
           ) -> Iterator[tuple[str, Any, Any, Quantity | None]]:  # fmt: skip
    if isinstance(node, Quantity):
        if node.units and one is not None and other is not None:
            yield path, one, other, node
        return
    if not isinstance(one, dict) or not isinstance(other, dict) or node is None:
        return
    for key in dict.fromkeys((*one, *other)):
        if key in SKIPPED:
            continue
        if key not in one or key not in other:
            yield f"{path}.{key}", one.get(key), other.get(key), None
        else:
            yield from _pairs(f"{path}.{key}", one[key], other[key], find_child(node, key))


def _compared(path: str, wanted: Array, told: Array, row: Quantity, first: Study, second: Study, same_open: bool,
              sizes: dict[str, float]) -> Iterator[Apart]:  # fmt: skip
    if wanted.shape != told.shape:
        yield Apart(f"{path} {wanted.shape} {told.shape}", math.inf, 0.0)
        return
    openly = np.isnan(wanted) != np.isnan(told)
    if same_open and openly.any():
        yield Apart(f"{path} (open)", math.inf, 0.0)
        return
    off = np.abs(wanted - told)[~(np.isnan(wanted) | np.isnan(told))]
    if not off.size:
        return
    unit = row.select_unit(turning=True)
    size = max(_size(one, units, sizes) for one in (first, second) for units in row.units)
    error = sum(stated(one, path) for one in (first, second))
    allowed = (TIMES * error + FLOOR) * size
    if not float(off.max()) <= allowed:
        yield Apart(f"{path} [{unit}]", float(off.max()), allowed)


def _size(study: Study, unit: str, sizes: dict[str, float]) -> float:
    """What numbers of a unit are summed from, or the largest of them, if that is more."""
    by_unit = study.magnitudes.by_unit
    momentum = sum(body.mass for body in study.setup.scene.mechanism.bodies) * by_unit.get("m/s", 0.0)
    summed = {"N·s": momentum, "N·m·s": momentum * by_unit.get("m", 0.0)}.get(unit, 0.0)
    return max(sizes.get(unit, 0.0), by_unit.get(unit, 0.0), summed, LEAST.get(unit, 0.0))


def sizes_of(*studies: Study) -> dict[str, float]:
    """The largest number of each unit in any of the runs."""
    sizes: dict[str, float] = {}
    for study in studies:
        for block in BLOCKS:
            told = getattr(study.results, block)
            for _, value, _, row in _pairs(block, told, told, TREE[block]):
                if row is not None:
                    numbers = np.abs(np.asarray(value, dtype=float))
                    largest = float(np.max(numbers, initial=0.0, where=np.isfinite(numbers)))
                    for unit in row.units:
                        sizes[unit] = max(sizes.get(unit, 0.0), largest)
    return sizes


def stated(study: Study, path: str) -> float:
    """The error that a run states of what stands at a path."""
    estimate = study.results.accuracy.get("estimate", {})
    first, *_, last = path.split(".")
    kind = "drives" if last == "drive" else ESTIMATE_OF_BLOCK.get(first, ESTIMATE_OF_ERROR_KIND.get(first, "motion"))
    return max(float(estimate.get(kind, 0.0)), float(estimate.get("motion", 0.0)))


def kept(value: Array, _: Quantity) -> Array:
    """Told in the same numbers."""
    return value


def turning(Q: Array) -> Change:
    """Vectors turn, tensors too, scalars stay."""

    def change(value: Array, row: Quantity) -> Array:
        axes = row.shape
        if axes[-2:] == (SPACE, SPACE):
            return np.asarray(Q @ value @ Q.T)
        return np.asarray(value @ Q.T) if axes[-1:] == (SPACE,) else value

    return change


def growing(c: float) -> Change:
    """Rates c times, loads c² times as large."""
    return measured_in(1.0, 1.0, 1.0 / c)


def measured_in(mass: float, length: float, time: float) -> Change:
    """Told in other units; not looked at where the same row tells lengths and angles, which change apart."""

    def change(value: Array, row: Quantity) -> Array:
        factors = {mass**m * length**l * time**t for m, l, t in (POWERS.get(unit, (0, 0, 0)) for unit in row.units)}
        return np.asarray(value * (factors.pop() if len(factors) == 1 else np.nan))

    return change


def state_at(bodies: Block, k: int) -> dict[str, dict[str, Any]]:
    """The state of all bodies at an instant, as a spec gives it."""
    keys = ("position", "velocity", "angular_velocity", "quaternion")
    return {name: {key: np.asarray(body[key])[k].tolist() for key in keys} for name, body in bodies.items()}


def beyond_peaks(study: Study, dense: Study, random: Random, most: int = 8) -> list[Apart]:
    """Where a run, densely sampled, goes beyond the extremes that are told of it, of some of its numbers."""
    sizes = sizes_of(study, dense)
    found: list[Apart] = []
    rows = [
        (path, np.asarray(value, dtype=float), row)
        for block in BLOCKS
        for path, value, _, row in _pairs(
            block, getattr(dense.results, block), getattr(dense.results, block), TREE[block]
        )
        if row is not None and row.is_timed and row.shape in ((), (SPACE,)) and not set(path.split(".")) & SKIPPED
    ]
    horizon = min((one.results.accuracy.get("horizon") or math.inf for one in (study, dense)), default=math.inf)
    inside = dense.results.time < horizon
    for path, values, row in random.sample(rows, min(most, len(rows))):
        i = random.randrange(3)
        path, values = (f"{path}.{'xyz'[i]}", values[:, i]) if row.shape else (path, values)
        if not np.isfinite(values[inside]).any():
            continue
        size = max(_size(one, units, sizes) for one in (study, dense) for units in row.units)
        allowed = (TIMES * sum(stated(one, path) for one in (study, dense)) + FLOOR) * size
        for how, sign in (("max", 1.0), ("min", -1.0)):
            told = find_peak(study, path, how).value
            most_seen = sign * float(np.nanmax(sign * values[inside]))
            if not math.isnan(told) and not sign * (most_seen - told) <= allowed:
                found.append(
                    Apart(f"{how} {path} is {told:.9g}, seen {most_seen:.9g},", sign * (most_seen - told), allowed)
                )
    return found
