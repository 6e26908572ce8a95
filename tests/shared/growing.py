"""Scenes that grow in one thing: bodies, loops, cuts, samples. Each as text, by how many there are."""

from __future__ import annotations

from collections.abc import Callable

from tests.bench.generated import chain
from tests.oracle.published import windows
from tests.oracle.values import to_yaml
from tests.shared.scenes import moving

BAR = """
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar:
    shapes: [{{type: cylinder, from: [0, 0, 0], to: [0, 0, -1], radius: 10 mm, density: 7850 kg/m^3}}]
    points: {{top: [0, 0, 0], end: [0, 0, -1]}}
joints:
  pivot: {{type: pin, from: ground.O, to: bar.top, axis: [0, 1, 0], initial: {{angle: 60 deg}}}}
sections:
  bar: {{body: bar, from: top, to: end, count: {cuts}}}
analysis: {{duration: 1, samples: {samples}}}
"""


def bodies(n: int) -> str:
    """A chain of n bars, released level: a tree."""
    return chain(n, 0.05)


def loops(n: int) -> str:
    """n windows of bars in a row, each a loop with three rows too many; away from their flat pose."""
    return to_yaml(moving(windows(n, 0.3, 1.0), (0.0, 0.1, 0.2), 1e-6))


def cuts(n: int) -> str:
    """A bar that swings, cut at n places, at 51 instants."""
    return BAR.format(cuts=n, samples=51)


def samples(n: int) -> str:
    """The bar at n instants, cut at 11 places."""
    return BAR.format(cuts=11, samples=n)


GROWING: dict[str, tuple[Callable[[int], str], tuple[int, ...]]] = {
    "bodies": (bodies, (10, 40, 80)),
    "loops": (loops, (2, 4, 8)),
    "cuts": (cuts, (11, 41, 81)),
    "samples": (samples, (51, 201, 401)),
}
