"""How every reported number changes when a scene is told otherwise: turned, mirrored, other units, other names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from heuncli.results.results import Array, Block, Results
from tests.oracle.tellings import Telling
from tests.shared.scenes import largest, near

Meaning = tuple[str, tuple[int, int, int]]  # what it does when axes turn; powers of mass, length, time
POLAR, AXIAL, TENSOR, SCALAR, SECOND, THIRD = "polar", "axial", "tensor", "scalar", "along e2", "about n or e1"
LENGTH, SPEED, ACCELERATION = (0, 1, 0), (0, 1, -1), (0, 1, -2)
ANGLE, SPIN, SPIN_RATE = (0, 0, 0), (0, 0, -1), (0, 0, -2)
FORCE, MOMENT, ENERGY, POWER = (1, 1, -2), (1, 2, -2), (1, 2, -2), (1, 2, -3)
MOMENTUM, MOMENT_OF_MOMENTUM, SYSTEM = (1, 1, -1), (1, 2, -1), (1, 2, -3)

BODY = {
    "center": (POLAR, LENGTH), "center_velocity": (POLAR, SPEED), "center_acceleration": (POLAR, ACCELERATION),
    "rotation": (TENSOR, ANGLE), "angular_velocity": (AXIAL, SPIN), "angular_acceleration": (AXIAL, SPIN_RATE),
    "momentum": (POLAR, MOMENTUM), "moment_of_momentum": (AXIAL, MOMENT_OF_MOMENTUM),
}  # fmt: skip
POINT = {"position": (POLAR, LENGTH), "velocity": (POLAR, SPEED), "acceleration": (POLAR, ACCELERATION)}
WRENCH = {"force": (POLAR, FORCE), "moment": (AXIAL, MOMENT)}
JOINT = {
    **WRENCH, "point": (POLAR, LENGTH), "contact_point": (POLAR, LENGTH), "radial": (SCALAR, FORCE),
    "tilting": (SCALAR, MOMENT), "tension": (SCALAR, FORCE),
}  # fmt: skip
EFFECT = {"force": (POLAR, FORCE), "moment_orbital": (AXIAL, MOMENT), "moment_spin": (AXIAL, MOMENT)}
SECTION = {
    **WRENCH, "point": (POLAR, LENGTH), "normal": (POLAR, ANGLE), "first_axis": (POLAR, ANGLE), "N": (SCALAR, FORCE),
    "Q1": (SCALAR, FORCE), "Q2": (SECOND, FORCE), "T": (THIRD, MOMENT), "M1": (THIRD, MOMENT), "M2": (SCALAR, MOMENT),
}  # fmt: skip
TOTALS = {
    "total": (POLAR, MOMENTUM),
    **dict.fromkeys(("moment_orbital", "moment_spin"), (AXIAL, MOMENT_OF_MOMENTUM)),
}  # fmt: skip
POWERS = {"kinetic": (SCALAR, ENERGY), "potential": (SCALAR, ENERGY), "work": (SCALAR, ENERGY)}


def as_told(told: Telling, value: Array, kind: str, dimension: tuple[int, int, int]) -> Array:
    """A number of the first telling as the second should say it."""
    det = float(np.sign(np.linalg.det(told.Q)))
    m, l, t = dimension
    scaled = np.asarray(value) * told.mass**m * told.length**l * told.time**t
    if kind == TENSOR:
        return told.Q @ scaled @ told.Q.T
    if kind in (POLAR, AXIAL):
        return (scaled @ told.Q.T) * (det if kind == AXIAL else 1.0)
    return scaled * (det if kind in (SECOND, THIRD) else 1.0)


def same(
    told: Telling,
    first: Block,
    second: Block,
    table: Mapping[str, Meaning],
    tolerance: float,
    force: float,
    length: float,
) -> float:
    """Assert that two blocks say the same; the largest deviation. force, length: sizes of the second."""
    worst = 0.0
    for name, (kind, dimension) in table.items():
        assert (name in first) == (name in second), name
        if name not in first:
            continue
        want = as_told(told, first[name], kind, dimension)
        size = {FORCE: force, MOMENT: force * length, LENGTH: length}.get(dimension, 1.0)
        size = max(size if dimension != ANGLE else 1.0, float(np.abs(want).max(initial=0.0)))
        worst = max(worst, near(second[name], want, size, tolerance))
    return worst


def from_the_other_end(joint: Block, point: Array) -> Block:
    """A reaction as its joint's other end tells it: about that end's point, and turned round; drive and sizes stay."""
    moment = joint["moment"] - np.cross(point - joint["point"], joint["force"])
    return {**joint, "force": -joint["force"], "moment": -moment, "point": point}


def same_results(told: Telling, first: Results, second: Results, tolerance: float) -> float:
    """Assert that all blocks of two runs say the same; the largest deviation, in the sizes of the scene."""
    F = max(largest({n: j["force"] for n, j in second.joints.items()}), float(np.abs(second.foundation["force"]).max()))
    L = max(largest({n: b["center"] for n, b in second.bodies.items()}), told.length)
    near(second.time, first.time * told.time, told.time, 1e-14)
    worst = [0.0]

    def blocks(a: Block, b: Block, table: Mapping[str, Any], names: Mapping[str, str]) -> None:
        assert {names.get(n, n) for n in a} == set(b)
        worst.extend(same(told, a[n], b[names.get(n, n)], table, tolerance, F, L) for n in a)

    blocks(first.bodies, second.bodies, BODY, told.bodies)
    renamed = {p: told.bodies.get(p.split(".")[0], p.split(".")[0]) + "." + p.split(".")[1] for p in first.points}
    blocks(first.points, second.points, POINT, renamed)
    joints = {
        name: from_the_other_end(joint, second.joints[name]["point"]) if name in told.reversed else joint
        for name, joint in first.joints.items()
    }
    blocks(joints, second.joints, JOINT, told.joints)
    for name, joint in joints.items():  # a drive's number turns in a mirror or not as its joint's axis does: not here
        if told.reversed and "drive" in joint:
            worst.append(near(second.joints[name]["drive"], joint["drive"], F, tolerance))
    blocks(first.sections, second.sections, SECTION, {})
    blocks(first.foundation.get("supports", {}), second.foundation.get("supports", {}), WRENCH, told.joints)
    blocks({"": first.foundation}, {"": second.foundation}, WRENCH, {})
    blocks({"": first.foundation["mass_effect"]}, {"": second.foundation["mass_effect"]}, EFFECT, {})
    blocks({"": first.momentum}, {"": second.momentum}, TOTALS, {})
    for part in ("energy_part", "deviation_part"):  # as moments about a spin, they turn as spins do
        own = {told.bodies.get(name, name): B for name, B in first.system_vector[part].items()}
        blocks({"": own}, {"": second.system_vector[part]}, dict.fromkeys(own, (AXIAL, SYSTEM)), {})
    blocks({"": first.energy}, {"": second.energy}, POWERS, {})
    return max(worst)
