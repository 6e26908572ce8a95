"""Random scenes made redundant: beside some of their joints another one that holds what those hold already.

A second pin on the same axis, a line beside a slide, a plane at a ball's point: they fit in every pose, so the motion
stays and only reactions become open.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from tests.oracle.read import Placed, end, placed
from tests.oracle.scenes import ALL_KINDS
from tests.oracle.turns import Array, across, random_unit, unit
from tests.shared.loops import loop_scene
from tests.shared.trees import ABOUT, Case, case

LOCKED = (2067,)  # its drives cannot be followed for long
SEEDS = [s for s in range(2000, 2108) if s not in LOCKED]
QUICK = frozenset({2000, 2003, 2009, 2012, 2021, 2030, 2033, 2036, 2045, 2048, 2052, 2058, 2064, 2072, 2087, 2093})


class Held(NamedTuple):
    """A joint as it stands: bodies, points and axes in their own axes, poses."""

    a: str
    p: Array
    axis: Array
    b: str
    q: Array
    to_axis: Array
    A: Placed
    B: Placed

    def beside(self, shift: Array) -> Array:
        """The place of `to` that now coincides with p + shift on `from`."""
        return self.B.rotation.T @ (self.A.point(self.p + shift) - self.B.position)

    def in_b(self, direction: Array) -> Array:
        """A direction of `from` in the axes of `to`."""
        return self.B.rotation.T @ self.A.rotation @ direction


Double = dict[str, Any]
Maker = Callable[[np.random.Generator, Held], Double]


def joint(j: Held, kind: str, p: Array, q: Array, **more: Any) -> Double:
    ends = {"from": {"body": j.a, "at": p.tolist()}, "to": {"body": j.b, "at": q.tolist()}}
    return {"type": kind, **ends, **{k: v.tolist() if isinstance(v, np.ndarray) else v for k, v in more.items()}}


def on_the_axis(kind: str) -> Maker:
    """Another joint of a point or axis that stays where it is: at some place along the axis."""

    def make(rng: np.random.Generator, j: Held) -> Double:
        s = rng.uniform(-0.8, 0.8)
        p, q = j.p + s * j.axis, j.q + s * j.to_axis
        if kind in ("pin", "cylinder"):
            return joint(j, kind, p, q, axis=j.axis, to_axis=j.to_axis)
        if kind == "ball":
            return joint(j, kind, p, q)
        if kind == "plane":
            return joint(j, kind, p, q, normal=random_unit(rng))
        return joint(j, kind, p, q, axis=random_unit(rng))

    return make


def at_the_point(kind: str) -> Maker:
    """The same point held again."""

    def make(rng: np.random.Generator, j: Held) -> Double:
        more = {"plane": {"normal": random_unit(rng)}, "line": {"axis": random_unit(rng)}}.get(kind, {})
        return joint(j, kind, j.p, j.q, **more)

    return make


def along(kind: str) -> Maker:
    """Beside bodies that only slide: another guide parallel to the first, anywhere."""

    def make(rng: np.random.Generator, j: Held) -> Double:
        shift = rng.uniform(-0.6, 0.6, 3)
        p, q = j.p + shift, j.beside(shift)
        if kind == "plane":
            return joint(j, kind, p, q, normal=across(j.axis)[0])
        more = {"to_axis": j.in_b(j.axis)} if kind == "cylinder" else {}
        return joint(j, kind, p, q, axis=j.axis, **more)

    return make


def on_the_line(kind: str) -> Maker:
    """A point that runs along a line of `from`: on that line again, or on a plane through it."""

    def make(rng: np.random.Generator, j: Held) -> Double:
        s = rng.uniform(-0.5, 0.5)
        if kind == "plane":
            e, f = across(j.axis)
            angle = rng.uniform(0, 6)
            return joint(j, kind, j.p + s * j.axis, j.q, normal=np.cos(angle) * e + np.sin(angle) * f)
        return joint(j, kind, j.p + s * j.axis, j.q, axis=j.axis)

    return make


def on_the_spindle(kind: str) -> Maker:
    """The same with any point of the axis of `to` that keeps to the line: a cylinder's."""

    def make(rng: np.random.Generator, j: Held) -> Double:
        s = rng.uniform(-0.5, 0.5)
        more = {"to_axis": j.to_axis} if kind == "cylinder" else {}
        return joint(j, kind, j.p, j.q + s * j.to_axis, axis=j.axis, **more)

    return make


def in_the_plane(rng: np.random.Generator, j: Held) -> Double:
    e, f = across(j.axis)
    return joint(j, "plane", j.p + rng.uniform(-1, 1) * e + rng.uniform(-1, 1) * f, j.q, normal=j.axis)


def of_rigid_bodies(kind: str) -> Maker:
    """Between welded bodies: anything, anywhere."""

    def make(rng: np.random.Generator, j: Held) -> Double:
        shift, axis = rng.uniform(-0.6, 0.6, 3), random_unit(rng)
        p, q = j.p + shift, j.beside(shift)
        if kind == "rod":
            return joint(j, kind, p, j.beside(shift + 0.7 * axis))
        more = {"pin": {"axis": axis, "to_axis": j.in_b(axis)}, "cylinder": {"axis": axis, "to_axis": j.in_b(axis)},
                "universal": {"axis": axis, "to_axis": j.in_b(across(axis)[0])}, "slide": {"axis": axis},
                "line": {"axis": axis}, "plane": {"normal": axis}}.get(kind, {})  # fmt: skip
        return joint(j, kind, p, q, **more)

    return make


DOUBLES: dict[str, list[Maker]] = {
    "pin": [on_the_axis(kind) for kind in ("pin", "ball", "line", "cylinder", "plane")],
    "ball": [at_the_point(kind) for kind in ("ball", "line", "plane")],
    "universal": [at_the_point(kind) for kind in ("ball", "line", "plane")],
    "slide": [along(kind) for kind in ("slide", "line", "cylinder", "plane")],
    "cylinder": [on_the_spindle("line"), on_the_spindle("cylinder")],
    "line": [on_the_line("line"), on_the_line("plane")],
    "plane": [in_the_plane],
    "weld": [of_rigid_bodies(kind) for kind in ALL_KINDS],
    "rod": [lambda rng, j: joint(j, "rod", j.p, j.q)],
}


def held(scene: dict[str, Any], state: dict[str, Placed], name: str) -> Held:
    """A joint of a scene as it stands."""
    spec = scene["joints"][name]
    a, b = end(scene, spec["from"]), end(scene, spec["to"])
    axis = unit(spec.get("axis", spec.get("normal", [1.0, 0.0, 0.0])))
    return Held(
        a.body,
        a.point,
        axis,
        b.body,
        b.point,
        unit(spec.get("to_axis", axis)),
        placed(state, a.body),
        placed(state, b.body),
    )


def with_doubles(
    rng: np.random.Generator, scene: dict[str, Any], state: dict[str, Placed], count: int
) -> dict[str, Any]:
    """The scene with so many joints doubled."""
    driven = {d["joint"] for d in scene.get("drives", {}).values()}
    able = [n for n in scene["joints"] if not (n in driven and scene["joints"][n]["type"] in ("rod", "line"))]
    extra = {}
    for k in range(count):
        name = able[rng.integers(len(able))]
        makers = DOUBLES[scene["joints"][name]["type"]]
        extra[f"double{k}"] = makers[rng.integers(len(makers))](rng, held(scene, state, name))
    return {**scene, "joints": {**scene["joints"], **extra}}


def redundant_scene(seed: int) -> tuple[dict[str, Any], dict[str, Any]]:
    """A scene without and with what holds twice; from 2052 on with drives."""
    scene, state = loop_scene(seed, loops=seed % 2, drives=1 + seed % 2 if seed >= 2052 else 0)
    plain = {**scene, "foundation": {"about": ABOUT.tolist()}}
    return plain, with_doubles(np.random.default_rng(seed), plain, state, 1 + seed % 3)


@cache
def redundant(seed: int) -> Case:
    """The run of the scene with doubles, and the oracle's answer at every instant."""
    return case(redundant_scene(seed)[1])
