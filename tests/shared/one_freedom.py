"""One block on a guide, or one wheel on a shaft, under loads along its one coordinate; and its passage by quadrature.

    u² = u0² + 2/m ∫ F dx,    t = ∫ dx/u

As long as the block does not turn back these are its motion, whatever the load does in the coordinate, to rounding:
between the marks, where F is smooth, by Gauss's rule.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from heuncli.results.results import Array
from heuncli.study.queries.study import Study
from tests.shared.scenes import study

NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)
ROUNDING = 1e-14  # of the largest coordinate, beside what a run says of itself
TOO_LONG = 20.0  # s; a run that comes to no end
Law = Callable[[Array], Array]


class One(NamedTuple):
    """A block (m, travel, speed) or a wheel (I, angle, rate) and what pushes it: values by name."""

    inertia: float
    loads: Mapping[str, str]
    start: float = 0.0
    rate: float = 0.0
    analysis: str = "duration: 1, samples: 21"
    turns: bool = False
    tables: str = ""
    gravity: float = 0.0

    def text(self) -> str:
        """The scene."""
        names = ("shaft", "pin", "angle", "rate") if self.turns else ("guide", "slide", "travel", "speed")
        joint, kind, place, rate = names
        mass, I = (1.0, self.inertia) if self.turns else (self.inertia, 1.0)
        forces = "\n".join(
            f'  {name}: {{type: torque, joint: {joint}, value: "{value}"}}' for name, value in self.loads.items()
        )
        return f"""
heun: 1
gravity: [0, 0, {-self.gravity!r}]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  block: {{mass: {mass!r}, center: [0, 0, 0], inertia: [{I!r}, {I!r}, {I!r}], points: {{o: [0, 0, 0]}}}}
joints:
  {joint}: {{type: {kind}, from: ground.O, to: block.o, axis: [0, 0, 1],
    initial: {{{place}: {self.start!r}, {rate}: {self.rate!r}}}}}
{self.tables}
forces:
{forces}
analysis: {{{self.analysis}}}
"""


class Moved(NamedTuple):
    """The run, its coordinate and rate at the asked instants, and what it says of its error: of the coordinate."""

    run: Study
    time: Array
    x: Array
    u: Array
    error: float


def moved(scene: One) -> Moved:
    """The scene solved."""
    run = study(scene.text(), time_limit=TOO_LONG)
    found = run.results
    c = found.coordinates["shaft" if scene.turns else "guide"]
    x, u = (c["angle"], c["rate"]) if scene.turns else (c["travel"], c["speed"])
    largest = max(1.0, float(np.abs(x).max()))
    size = largest if scene.turns else run.setup.scene.layout.size
    return Moved(run, found.time, x, u, found.accuracy["estimate"]["motion"] * size + ROUNDING * largest)


def follows(found: Moved, x: Array, u: Array, fastest: float = 10.0) -> None:
    """The coordinate is what it should be, within what the run says of itself; the rate to that by the fastest change.

    fastest: the largest acceleration over the largest rate [1/s].
    """
    closer(found.time, found.x, x, found.error)
    closer(found.time, found.u, u, found.error * fastest)


def closer(time: Array, found: Array, wanted: Array, than: float) -> None:
    """Assert closeness at all instants, and name the worst."""
    off = np.abs(found - wanted)
    k = int(off.argmax())
    assert off[k] <= than, f"at t = {time[k]!r}: {found[k]!r} for {wanted[k]!r}, off by {off[k]:.3g}, told {than:.3g}"


class Passage:
    """The passage from x0 on at the rate u0, ever onwards; marks: places between which the force is smooth."""

    def __init__(self, scene: One, force: Law, marks: Sequence[float]) -> None:
        self.scene, self.force = scene, force
        self.marks = [scene.start, *sorted(m for m in marks if m > scene.start)]
        self.works = np.concatenate([[0.0], np.cumsum([self.part(a, b) for a, b in pairwise(self.marks)])])
        self.times = np.concatenate([[0.0], np.cumsum([self.lasts(k, m) for k, m in enumerate(self.marks[1:])])])

    def part(self, a: float, b: Array | float) -> Array:
        """∫ F dx from a to b."""
        half = 0.5 * (np.asarray(b) - a)
        return np.asarray(half * np.sum(WEIGHTS * self.force(a + half[..., None] * (1.0 + NODES)), axis=-1))

    def work(self, x: Array) -> Array:
        """What the force has done on the way to x."""
        k = self.piece(x)
        done = np.empty_like(x)
        for i in np.unique(k):
            done[k == i] = self.works[i] + self.part(self.marks[i], x[k == i])
        return done

    def piece(self, x: Array) -> Array:
        """The last mark before x."""
        return np.maximum(np.searchsorted(self.marks, x, side="right") - 1, 0)

    def rate(self, x: Array) -> Array:
        """u at x."""
        return np.sqrt(self.scene.rate**2 + 2.0 / self.scene.inertia * self.work(x))

    def lasts(self, k: int, x: float) -> float:
        """The time from a mark to x behind it and before the next; none where it turns back before."""
        a = self.marks[k]
        half = 0.5 * (x - a)
        places = a + half * (1.0 + NODES)
        work = self.works[k] + self.part(a, places)
        squares = self.scene.rate**2 + 2.0 / self.scene.inertia * work
        return float(half * np.sum(WEIGHTS / np.sqrt(squares))) if squares.min() > 0.0 else np.inf

    def time(self, x: Array) -> Array:
        """When x is reached."""
        return np.array([self.times[k] + self.lasts(k, at) for k, at in zip(self.piece(x), x.tolist(), strict=True)])


def passes(scene: One, force: Law, marks: Sequence[float], digits: float = 1e-8) -> Moved:
    """The run meets its passage: rate and work by the energy at each place, and the place at each instant."""
    found = moved(scene)
    passage = Passage(scene, force, marks)
    largest = float(np.abs(found.u).max())
    closer(found.time, found.u, passage.rate(found.x), digits * largest)
    late = passage.time(found.x) - found.time
    closer(found.time, found.x, found.x + late * found.u, found.error)
    kinetic = 0.5 * scene.inertia * largest**2
    work = passage.work(found.x)
    closer(found.time, found.run.results.energy["work"], work, digits * max(kinetic, float(np.abs(work).max())))
    return found


def around(center: float, width: float, reach: float = 7.0) -> list[float]:
    """Marks about a bell exp(-((x - center)/width)²), close enough for Gauss's rule; beyond them it is nothing."""
    return [center + width * k / 2 for k in range(int(-2 * reach), int(2 * reach) + 1)]
