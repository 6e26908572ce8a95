"""The same scene told otherwise, a row each: other axes, a mirror, other units, faster, other names, origins, ends.

Sections, where a scene has them, are told in the new way, too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from tests.oracle.transforms import Scene, origin_moved, renamed, swapped, turned, units_changed
from tests.oracle.turns import Array, random_rotation

EITHER_END = ("ball", "pin", "weld", "rod")  # joints that may be told from their other end


@dataclass(frozen=True, eq=False)
class Telling:
    """A scene told otherwise: axes turned by Q (det −1: mirrored), a length of 1 called `length`, and so on.

    reversed: joints told from their other end.
    """

    scene: Scene
    Q: Array = field(default_factory=lambda: np.eye(3))
    length: float = 1.0
    mass: float = 1.0
    time: float = 1.0
    bodies: Mapping[str, str] = field(default_factory=dict)
    joints: Mapping[str, str] = field(default_factory=dict)
    reversed: frozenset[str] = frozenset()

    @property
    def force(self) -> float:
        """What a force of 1 is called."""
        return self.mass * self.length / self.time**2

    @property
    def moment(self) -> float:
        """What a moment of 1 is called."""
        return self.force * self.length


def unchanged(_: str, v: Array, place: bool) -> Array:
    return v


def with_cuts(
    scene: Scene,
    told: Scene,
    change: Callable[[str, Array, bool], Array] = unchanged,
    names: Mapping[str, str] | None = None,
) -> Scene:
    """The scene as told, its sections told alike: change(body, vector, whether it is a place)."""
    if "sections" not in scene:
        return told
    cuts = {}
    for name, cut in scene["sections"].items():
        body = cut["body"]
        cuts[name] = {"body": (names or {}).get(body, body)}
        cuts[name] |= {k: change(body, np.array(cut[k]), k == "at").tolist() for k in ("at", "normal", "first_axis")}
    return {**told, "sections": cuts}


def in_other_axes(det: float, scene: Scene, rng: np.random.Generator) -> Telling:
    """Forces and places turn with the world; in a mirror moments and spins turn the other way round as well."""
    Q = random_rotation(rng) @ np.diag([1, 1, det])
    return Telling(with_cuts(scene, turned(scene, Q), lambda _, v, place: Q @ v), Q=Q)


def in_other_units(length: float, mass: float, time: float, scene: Scene, rng: np.random.Generator) -> Telling:
    other = units_changed(scene, length, mass, time)
    other = with_cuts(scene, other, lambda _, v, place: length * v if place else v)
    return Telling(other, length=length, mass=mass, time=time)


def under_other_names(shuffle: int, scene: Scene, rng: np.random.Generator) -> Telling:
    """Bodies and joints in another order under other names."""
    for _ in range(shuffle):
        rng = rng.spawn(1)[0]
    other, bodies, joints = renamed(scene, rng)
    return Telling(with_cuts(scene, other, names=bodies), bodies=bodies, joints=joints)


def from_other_origins(scene: Scene, rng: np.random.Generator) -> Telling:
    by = {name: rng.standard_normal(3) for name in scene["bodies"]}
    other = {k: v for k, v in scene.items() if k != "sections"}
    for name, shift in by.items():
        other = origin_moved(other, name, shift)
    return Telling(with_cuts(scene, other, lambda body, v, place: v - by[body] if place else v))


def from_the_other_ends(scene: Scene, rng: np.random.Generator) -> Telling:
    """All joints that may be: their reactions turn round."""
    names = [name for name, joint in scene["joints"].items() if joint["type"] in EITHER_END]
    other = scene
    for name in names:
        other = swapped(other, name)
    return Telling(other, reversed=frozenset(names))


TELLINGS: dict[str, Callable[[Scene, np.random.Generator], Telling]] = {
    "turned": partial(in_other_axes, 1.0),
    "mirrored": partial(in_other_axes, -1.0),
    "inches, pounds": partial(in_other_units, 39.37, 2.2, 10.0),  # and tenths of a second
    "mm, t, ms": partial(in_other_units, 1e3, 1e-3, 1e3),  # every number far from where it was
    "faster": partial(in_other_units, 1.0, 1.0, 1 / 3),  # Heun: k -> c²k with σ -> cσ makes all reactions c² times
    "renamed": partial(under_other_names, 0),
    "renamed again": partial(under_other_names, 1),
    "other origins": from_other_origins,
    "other ends": from_the_other_ends,
}
