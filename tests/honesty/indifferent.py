"""Scenes whose null space of the stiffness is known by construction: parts side by side, in a plane or in space.

Of each part is known how many motions nothing holds, how many are held, and of some the one eigenvalue they have.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import rotation_from_vector

G = 9.81
Place = Sequence[float] | Array
LEVEL, ACROSS, UP = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


class Bench:
    """A scene that parts are put on: lengths in units of `metre` m, masses of `kilogram` kg, numbers to some digits."""

    def __init__(
        self, seed: int, *, space: bool = False, metre: float = 1.0, kilogram: float = 1.0, digits: int = 17
    ) -> None:
        self.rng = np.random.default_rng(seed)
        self.turned = rotation_from_vector(self.rng.normal(size=3)) if space else np.eye(3)
        self.metre, self.kilogram, self.digits = metre, kilogram, digits
        self.ground: dict[str, Any] = {}
        self.bodies: dict[str, Any] = {}
        self.joints: dict[str, Any] = {}
        self.forces: dict[str, Any] = {}
        self.free = self.held = 0

    def drawn(self, low: float, high: float) -> float:
        """A number as it is typed."""
        return self.typed(float(self.rng.uniform(low, high)))

    def typed(self, x: float) -> float:
        return float(f"{x:.{self.digits}g}")

    def direction(self, x: Place) -> list[float]:
        return [float(a) for a in self.turned @ np.asarray(x)]

    def place(self, x: Place) -> list[float]:
        return [a / self.metre for a in self.direction(x)]

    def body(self, mass: float, center: Place, at: Array, end: Place = LEVEL) -> str:
        """Of radius of gyration 1 m about its centre, with its point a at a place, and its point e."""
        name = f"b{len(self.bodies)}"
        moment = mass / (self.kilogram * self.metre**2)
        self.bodies[name] = {
            "mass": mass / self.kilogram, "center": self.place(center), "inertia": [moment] * 3,
            "points": {"a": [0, 0, 0], "e": self.place(end)}, "position": self.place(at),
        }  # fmt: skip
        return name

    def on_ground(self, at: Array) -> str:
        name = f"G{len(self.ground)}"
        self.ground[name] = self.place(at)
        return f"ground.{name}"

    def joint(self, kind: str, a: str, b: str, axis: Sequence[float] = ACROSS) -> str:
        name = f"j{len(self.joints)}"
        self.joints[name] = {"type": kind, "from": a, "to": b, "axis": self.direction(axis)}
        return name

    def force(self, **what: Any) -> None:
        self.forces[f"f{len(self.forces)}"] = what

    def scene(self) -> dict[str, Any]:
        gravity = [a * G / self.metre for a in self.direction([0.0, 0.0, -1.0])]
        parts = {"bodies": self.bodies, "joints": self.joints, "forces": self.forces}
        told = {name: part for name, part in parts.items() if part}
        return {"heun": 1, "gravity": gravity, "ground": {"points": self.ground}, **told, "analysis": {"type": "rest"}}


def balanced_chain(bench: Bench, at: Array) -> None:
    """Three bars about level pins, each balanced about its own with what hangs on it; by few digits the last alone."""
    masses = [bench.drawn(0.5, 5.0) for _ in range(3)]
    before = bench.on_ground(at)
    for k, mass in enumerate(masses):
        angle = bench.drawn(-3.0, 3.0)
        way = np.array([math.cos(angle), 0.0, math.sin(angle)])
        center = [bench.typed(-sum(masses[k + 1 :]) / mass * x) for x in way.tolist()]
        body = bench.body(mass, center, at, way)
        bench.joint("pin", before, f"{body}.a")
        before, at = f"{body}.e", at + way
    bench.free += 3 if bench.digits > 15 else 1
    bench.held += 0 if bench.digits > 15 else 2


def slide(bench: Bench, at: Array) -> None:
    """On a level rail, with a pendulum."""
    body = bench.body(bench.drawn(0.1, 50.0), [0.0, 0.0, 0.0], at)
    bench.joint("slide", bench.on_ground(at), f"{body}.a", LEVEL)
    bob = bench.body(bench.drawn(0.1, 50.0), [0.0, 0.0, -bench.drawn(0.1, 1.0)], at + np.array(LEVEL))
    bench.joint("pin", f"{body}.e", f"{bob}.a")
    bench.free += 1
    bench.held += 1


def turntable(bench: Bench, at: Array) -> None:
    """About an upright pin, its mass beside it."""
    body = bench.body(bench.drawn(0.1, 50.0), [bench.drawn(0.2, 1.0), bench.drawn(0.2, 1.0), 0.3], at)
    bench.joint("pin", bench.on_ground(at), f"{body}.a", UP)
    bench.free += 1


def carts(bench: Bench, at: Array) -> None:
    """Two on level rails and a spring between them, soft or stiff."""
    a, b = (bench.body(bench.drawn(0.1, 10.0), [0.0, 0.0, 0.0], at + way) for way in (np.zeros(3), np.array(LEVEL)))
    for body, way in ((a, np.zeros(3)), (b, np.array(LEVEL))):
        bench.joint("slide", bench.on_ground(at + way), f"{body}.a", LEVEL)
    stiffness = 10.0 ** bench.drawn(-6.0, 8.0) / bench.kilogram
    ends = {"from": f"{a}.a", "to": f"{b}.a"}
    bench.force(type="spring", **ends, stiffness=stiffness, length=0.7 / bench.metre)
    bench.free += 1
    bench.held += 1


def hanging_ball(bench: Bench, at: Array) -> None:
    """A body on a ball below which it hangs: it may spin."""
    body = bench.body(bench.drawn(0.1, 50.0), [0.0, 0.0, -bench.drawn(0.1, 1.0)], at)
    name = f"j{len(bench.joints)}"
    bench.joints[name] = {"type": "ball", "from": bench.on_ground(at), "to": f"{body}.a"}
    bench.free += 1
    bench.held += 2


def spring_arm(bench: Bench, at: Array, off: float = 0.0) -> float:
    """An arm on a spring without length, k a l = m g c (1 + off): it stays in any pose; else its eigenvalue upright."""
    a, reach, c, mass = bench.drawn(0.2, 1.0), bench.drawn(0.3, 1.5), bench.drawn(0.2, 1.5), bench.drawn(0.5, 20.0)
    angle = 0.0 if off else bench.drawn(-2.5, 2.5)
    way = np.array([math.sin(angle), 0.0, math.cos(angle)])
    body = bench.body(mass, c * way, at, reach * way)
    bench.joint("pin", bench.on_ground(at), f"{body}.a")
    stiffness = mass * G * c / (a * reach) * (1.0 + off) / bench.kilogram
    above = bench.on_ground(at + a * np.array(UP))
    bench.force(**{"type": "spring", "from": above, "to": f"{body}.e", "stiffness": stiffness, "length": 0})
    bench.free += off == 0.0
    bench.held += off != 0.0
    return off * G * c / (c**2 + 1.0)


def law(bench: Bench, at: Array) -> None:
    """A wheel with a torque whose terms cancel within its expression."""
    body = bench.body(bench.drawn(0.5, 20.0), [0.0, 0.0, 0.0], at)
    joint = bench.joint("pin", bench.on_ground(at), f"{body}.a")
    k, part = bench.drawn(0.1, 50.0), bench.drawn(0.0, 1.0)
    terms = [x / (bench.kilogram * bench.metre**2) for x in (k, -k * part, k * part - k)]
    bench.force(type="torque", joint=joint, value=" + ".join(f"({x!r})*{joint}.angle" for x in terms))
    bench.free += 1


def soft(bench: Bench, at: Array) -> None:
    """A wheel in a turning spring, soft or stiff."""
    body = bench.body(bench.drawn(0.5, 20.0), [0.0, 0.0, 0.0], at)
    joint = bench.joint("pin", bench.on_ground(at), f"{body}.a")
    stiffness = 10.0 ** bench.drawn(-6.0, 8.0) / (bench.kilogram * bench.metre**2)
    bench.force(type="turn_spring", joint=joint, stiffness=stiffness)
    bench.held += 1


TYPED: tuple[Callable[[Bench, Array], Any], ...] = (balanced_chain, slide, turntable, carts, hanging_ball, soft)
PARTS = (*TYPED, spring_arm, law)
