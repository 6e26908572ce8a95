"""Mechanisms as they are drawn, before assembling, made of short calls in place of a spec; and whether they close.

For tests of the assembly. The gaps of what it finds are measured here by the joints' plain definitions, not by its own
equations.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Assembly, Body, Joint, Mechanism
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.expressions.scope import Scope
from heuncli.scene.file_format.models import Drive, FramedVector
from heuncli.scene.shapes.rotations import rotation_from_vector, rotation_matrix_about, vector_from_rotation

X, Y, Z = np.eye(3)


def vec(a: Any) -> Any:
    """An array; None stays none."""
    return None if a is None else np.asarray(a, dtype=float)


def in_time(text: str) -> Expression:
    """An expression of t."""
    return compile_expression(text, Scope(in_time=True))


def turned(axis: Any, degrees: float) -> Any:
    """The rotation about an axis."""
    axis = np.asarray(axis, dtype=float)
    return rotation_matrix_about(axis / np.linalg.norm(axis), np.radians(degrees))


def body(name: str, center: Any = (0, 0, 0), **given: Any) -> Body:
    """Given: position, rotation, velocity, angular_velocity (world axes, or Directed), near_..., mass."""
    rates = {
        k: v if v is None or isinstance(v, FramedVector) else FramedVector(vec(v), False)
        for k in ("velocity", "angular_velocity")
        for v in [given.get(k)]
    }
    return Body(
        name,
        given.get("mass", 1.0),
        vec(center),
        np.eye(3),
        {},
        vec(given.get("position")),
        vec(given.get("rotation")),
        rates["velocity"],
        rates["angular_velocity"],
        vec(given.get("near_position")),
        vec(given.get("near_rotation")),
    )


def joint(name: str, kind: str, a: str, p: Any, b: str, q: Any, axis: Any = (0, 0, 1), **given: Any) -> dict[str, Any]:
    """Given: to_axis, angle, rate, travel, speed, length, drive: (quantity, expression[, zero assembled])."""
    return {"name": name, "kind": kind, "a": a, "p": p, "b": b, "q": q, "axis": axis, **given}


def scene(bodies: list[Body], joints: list[dict[str, Any]], planar: bool = False) -> Mechanism:
    """The mechanism of these bodies and joints, which name their bodies."""
    index = {b.name: i for i, b in enumerate(bodies)} | {"ground": GROUND}

    def made(j: dict[str, Any]) -> Joint:
        axis = vec(j["axis"]) / np.linalg.norm(j["axis"])
        to_axis = axis if j.get("to_axis") is None else vec(j["to_axis"]) / np.linalg.norm(j["to_axis"])
        drive = j.get("drive")
        return Joint(
            j["name"],
            j["kind"],
            index[j["a"]],
            vec(j["p"]),
            index[j["b"]],
            vec(j["q"]),
            axis,
            to_axis,
            j.get("to_axis") is not None,
            j.get("angle"),
            j.get("rate"),
            j.get("travel"),
            j.get("speed"),
            j.get("length"),
            False,
            None,
            Drive("motor", j["name"], drive[0], drive[1], len(drive) > 2) if drive else None,
        )

    return Mechanism("scene", planar, np.zeros(3), tuple(bodies), tuple(made(j) for j in joints), ())


def pose(scene: Mechanism, a: Assembly, body: int) -> tuple[Any, Any]:
    """Place and rotation of a body, by its number; the ground stands still."""
    return (np.zeros(3), np.eye(3)) if body == GROUND else (a.position[body], a.rotation[body])


def index(scene: Mechanism, body: str) -> int:
    """The number of a body."""
    return GROUND if body == "ground" else [b.name for b in scene.bodies].index(body)


def point(scene: Mechanism, a: Assembly, body: str, at: Any) -> Any:
    """Where a point of a body is."""
    x, R = pose(scene, a, index(scene, body))
    return x + R @ vec(at)


def centre(scene: Mechanism, a: Assembly, i: int) -> Any:
    """Where the centre of mass of a body is."""
    return a.position[i] + a.rotation[i] @ scene.bodies[i].center


def after(scene: Mechanism, a: Assembly, dt: float) -> Assembly:
    """The poses a short time on, each body moved by its own rates (exact for constant rates)."""
    R = np.array([rotation_from_vector(w * dt) @ R for w, R in zip(a.angular_velocity, a.rotation, strict=True)])
    return Assembly(a.position + dt * a.velocity, R, a.velocity, a.angular_velocity, (), 0.0)


def coordinates(scene: Mechanism, a: Assembly, j: Joint) -> dict[str, Any]:
    """What the joint's kind is about, by its plain definition in manual/format.md, "Joints"."""
    xa, Ra = pose(scene, a, j.a)
    xb, Rb = pose(scene, a, j.b)
    D = xb + Rb @ j.q - xa - Ra @ j.p
    n, m = Ra @ j.axis, Rb @ j.to_axis
    return {
        "apart": np.linalg.norm(D),
        "travel": n @ D,
        "off_line": np.linalg.norm(np.cross(n, D)),
        "between_axes": np.arctan2(np.linalg.norm(np.cross(n, m)), n @ m),
        "turn": Ra.T @ Rb,
        "angle": vector_from_rotation(Ra.T @ Rb) @ j.axis,
    }


def gaps(scene: Mechanism, a: Assembly, j: Joint, relative: Any = None) -> list[float]:
    """Everything that is zero in a closed joint of its kind (without initial values)."""
    c = coordinates(scene, a, j)
    off = np.linalg.norm(vector_from_rotation(c["turn"] @ (np.eye(3) if relative is None else relative).T))
    return {
        "ball": [c["apart"]],
        "pin": [c["apart"], c["between_axes"]],
        "weld": [c["apart"], off],
        "slide": [c["off_line"], off],
        "cylinder": [c["off_line"], c["between_axes"]],
        "universal": [c["apart"], c["between_axes"] - np.pi / 2],
        "line": [c["off_line"]],
        "plane": [c["travel"]],
        "rod": [c["apart"] - (j.length or c["apart"])],
    }[j.kind]


def largest_gap(scene: Mechanism, a: Assembly) -> float:
    """The largest gap of all joints, in m and rad."""
    return max((abs(g) for j in scene.joints for g in gaps(scene, a, j)), default=0.0)


def largest_rate_gap(scene: Mechanism, a: Assembly, dt: float = 1e-5) -> float:
    """Central difference of every gap along the assembled rates, rods as assembled too."""

    def lengths(b: Assembly) -> list[float]:
        return [coordinates(scene, b, j)["apart"] for j in scene.joints if j.kind == "rod"]

    def signed(b: Assembly) -> Any:
        found: list[Any] = [lengths(b)]
        for j in scene.joints:
            xa, Ra = pose(scene, b, j.a)
            xb, Rb = pose(scene, b, j.b)
            D = Ra.T @ (xb + Rb @ j.q - xa - Ra @ j.p)
            axes = np.cross(j.axis, Ra.T @ Rb @ j.to_axis)
            square = [(Ra @ j.axis) @ (Rb @ j.to_axis)]
            found += {
                "ball": [D],
                "pin": [D, axes],
                "weld": [D, (Ra.T @ Rb).ravel()],
                "slide": [np.cross(j.axis, D), (Ra.T @ Rb).ravel()],
                "cylinder": [np.cross(j.axis, D), axes],
                "universal": [D, square],
                "line": [np.cross(j.axis, D)],
                "plane": [[j.axis @ D]],
                "rod": [],
            }[j.kind]
        return np.concatenate([np.atleast_1d(f) for f in found])

    difference = signed(after(scene, a, dt)) - signed(after(scene, a, -dt))
    return float(np.max(np.abs(difference), initial=0.0) / (2.0 * dt))
