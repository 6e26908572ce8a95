"""Machines that go round: engines of pistons on massless rods, and four-bars with oblique centres of mass."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from heuncli.analyses.balancing.results import BalanceOptions, BalanceResults, OrderRow
from heuncli.analyses.balancing.study import balance
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from tests.oracle.values import to_yaml

EYE = np.eye(3)
RPM = math.pi / 30.0


class Cylinder(NamedTuple):
    """Where a piston runs: its throw's angle [deg], its place along the shaft [m], its mass [kg], its bank [deg]."""

    throw: float
    place: float = 0.0
    mass: float = 2.0
    bank: float = 0.0


def engine(
    cylinders: Sequence[Cylinder], r: float = 0.05, l: float = 0.2, rate: float = 2000.0 * RPM, R: Array = EYE
) -> dict[str, Any]:
    """A balanced crank about z, its pistons on massless rods; R (3, 3): how the whole is turned in the world."""
    points, bodies, joints = {}, {}, {}
    for k, (throw, place, mass, bank) in enumerate(cylinders):
        a, b = math.radians(throw), math.radians(bank)
        points[f"p{k}"] = [r * math.cos(a), r * math.sin(a), place]
        at = r * math.cos(a - b) + math.sqrt(l * l - (r * math.sin(a - b)) ** 2)
        along = np.array([math.cos(b), math.sin(b), 0.0])
        bodies[f"piston{k}"] = {
            "mass": mass, "center": [0, 0, 0], "inertia": [1e-3, 1e-3, 1e-3], "points": {"pin": [0, 0, 0]},
            "position": (R @ (at * along + [0, 0, place])).tolist(), "orientation": {"matrix": R.tolist()},
        }  # fmt: skip
        where = {"body": "ground", "at": (R @ [0, 0, place]).tolist()}
        joints[f"bore{k}"] = {"type": "slide", "from": where, "to": f"piston{k}.pin", "axis": (R @ along).tolist(),
                              "to_axis": along.tolist()}  # fmt: skip
        joints[f"rod{k}"] = {"type": "rod", "from": f"crank.p{k}", "to": f"piston{k}.pin", "length": l}
    crank = {"mass": 1.0, "center": [0, 0, 0], "inertia": [0.01, 0.01, 0.02], "points": {"main": [0, 0, 0], **points}}
    main = {
        "type": "pin",
        "from": "ground.O",
        "to": "crank.main",
        "axis": (R @ [0, 0, 1]).tolist(),
        "to_axis": [0, 0, 1],
    }
    return {
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {"crank": crank | {"orientation": {"matrix": R.tolist()}}, **bodies},
        "joints": {"main": main, **joints},
        "drives": {"motor": {"joint": "main", "angle": f"{rate!r}*t"}},
    }  # fmt: skip


def four_bar(rng: np.random.Generator, rate: float = 20.0) -> dict[str, Any]:
    """A crank and rocker with oblique centres of mass, drawn at the crank along x."""
    a = rng.uniform(0.03, 0.05)
    b, c, d = rng.uniform(0.10, 0.14), rng.uniform(0.08, 0.11), rng.uniform(0.10, 0.12)
    phi = rng.uniform(0.3, 1.2)
    A, B, D = np.zeros(2), a * np.array([math.cos(phi), math.sin(phi)]), np.array([d, 0.0])
    way = D - B
    e = math.hypot(*way)
    beta = math.acos((b * b + e * e - c * c) / (2.0 * b * e)) + math.atan2(way[1], way[0])
    C = B + b * np.array([math.cos(beta), math.sin(beta)])
    psi = math.atan2(*(C - D)[::-1])

    def bar(name: str, length: float, at: Array, angle: float, ends: tuple[str, str]) -> dict[str, Any]:
        return {
            "mass": float(rng.uniform(0.1, 0.5)), "inertia": [1e-3, 1e-3, float(rng.uniform(1e-4, 4e-4))],
            "center": [float(rng.uniform(0.2, 0.8) * length), float(rng.uniform(-0.3, 0.3) * length), 0.0],
            "points": {ends[0]: [0, 0, 0], ends[1]: [length, 0, 0]}, "position": [*map(float, at), 0.0],
            "orientation": {"axis": [0, 0, 1], "angle": angle},
        }  # fmt: skip

    z = {"axis": [0, 0, 1]}
    return {
        "ground": {"points": {"A": [0, 0, 0], "D": [d, 0, 0]}},
        "bodies": {
            "crank": bar("crank", a, A, phi, ("A", "B")), "coupler": bar("coupler", b, B, beta, ("B", "C")),
            "rocker": bar("rocker", c, D, psi, ("D", "C")),
        },
        "joints": {
            "main": {"type": "pin", "from": "ground.A", "to": "crank.A", **z},
            "B": {"type": "pin", "from": "crank.B", "to": "coupler.B", **z},
            "C": {"type": "line", "from": "coupler.C", "to": "rocker.C", **z},
            "rocker": {"type": "pin", "from": "ground.D", "to": "rocker.D", **z},
        },
        "drives": {"motor": {"joint": "main", "angle": f"{phi!r} + {rate!r}*t"}},
    }  # fmt: skip


def balance_of(scene: dict[str, Any] | str, **asked: Any) -> BalanceResults:
    """The balance of a scene."""
    text = scene if isinstance(scene, str) else to_yaml(scene)
    return balance(load("scene.yaml", text), BalanceOptions(**asked))


def amplitude(found: BalanceResults, quantity: str, order: float) -> complex | Array:
    """Complex amplitudes of an order, those of cos(kφ) real and of sin(kφ) imaginary; 0 of what is not told."""
    row = row_of(found, quantity, order)
    if row is None:
        return np.zeros(1 if quantity == "torque" else 3, dtype=complex)
    return np.asarray(row.amplitude * np.exp(1j * row.phase))


def row_of(found: BalanceResults, quantity: str, order: float) -> OrderRow | None:
    """The row of an order, if it is told."""
    return next((row for row in found.orders[quantity] if row.order == order), None)
