"""Cams as rows on absolute coordinates: a force between disc and follower alone, across the way of one on the other.

    t = L'(phi) t_b - t_a            how the follower moves against the disc by a unit of its angle, a field of velocities
    f: across t(C), outward          of a roller's centre C or a point, with P = C - R f
    f = h, t(C + s e x h) . h = 0    of a face with the normal h through C, with P = C + s e x h
    f . (v_b(P) - v_a(P)) = 0,       gamma = d/dt of that while no velocity changes, by differences
The lift is SciPy's periodic spline through the points of the table.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from tests.oracle.read import Joint, Model, State, end, moved_on, placed
from tests.oracle.turns import Array, across, cross, unit

H = 1e-4  # [s] of the differences: of fourth order, at tens of rad/s


class Cam(NamedTuple):
    """A cam: its pin, the follower's joint, the lift over the angle, and what touches, axes of the follower."""

    name: str
    shaft: Joint
    follower: Joint
    lift: CubicSpline
    phase: float
    C: Array
    radius: float
    normal: Array | None


def cams(read: Model) -> list[Cam]:
    """Those of a scene."""
    joints = {j.name: j for j in read.joints}
    found = []
    for name, given in (read.scene.get("couplings") or {}).items():
        if given["type"] == "cam":
            table = read.scene["tables"][given["lift"]]
            spline = CubicSpline(table["x"], table["y"], bc_type="periodic")
            shaft, follower = (joints[k] for k in given["of"])
            normal = unit(given["normal"]) if "normal" in given else None
            C = end(read.scene, given["at"]).point
            own = Cam(name, shaft, follower, spline, given.get("phase", 0.0), C, given.get("radius", 0.0), normal)
            found.append(own)
    return found


def angle(joint: Joint, state: State) -> float:
    """The angle of a pin."""
    assert joint.zero is not None
    turn = placed(state, joint.a.body).rotation.T @ placed(state, joint.b.body).rotation @ joint.zero.T
    e, f = across(joint.axis)
    return float(np.arctan2(f @ turn @ e, e @ turn @ e))


def touch(own: Cam, state: State) -> tuple[Array, Array]:
    """Where they touch, and the direction of the force ON the follower there."""
    carrier, b = placed(state, own.shaft.a.body), placed(state, own.follower.b.body)
    slope = float(own.lift(angle(own.shaft, state) - own.phase, 1))
    O, e = carrier.point(own.shaft.a.point), carrier.rotation @ own.shaft.axis
    pivot, g = carrier.point(own.follower.a.point), carrier.rotation @ own.follower.axis
    C, turns = b.point(own.C), own.follower.kind == "pin"

    def passing(x: Array) -> Array:
        return slope * (cross(g, x - pivot) if turns else g) - cross(e, x - O)

    if own.normal is None:
        f = unit(cross(e, passing(C)))
        return C - own.radius * f, f
    h = b.rotation @ own.normal
    k = cross(e, h)
    s = -float(h @ passing(C)) / float(h @ (passing(C + k) - passing(C)))
    return C + s * k, h


def leaves(own: Cam, state: State) -> float:
    """How fast the follower leaves along the force by a unit of its coordinate."""
    P, f = touch(own, state)
    carrier = placed(state, own.follower.a.body)
    g = carrier.rotation @ own.follower.axis
    return float(f @ (cross(g, P - carrier.point(own.follower.a.point)) if own.follower.kind == "pin" else g))


def line(read: Model, own: Cam, state: State) -> Array:
    """J (6n,) on (v of the centre of mass, sigma) body by body."""
    P, f = touch(own, state)
    found = np.zeros(6 * len(read.names))
    for body, sign in ((own.follower.b.body, 1.0), (own.shaft.b.body, -1.0)):
        k = 6 * read.names.index(body)
        found[k : k + 3] += sign * f
        found[k + 3 : k + 6] += sign * cross(P - placed(state, body).point(read.masses[body].center), f)
    return found


def lines(read: Model, state: State) -> list[tuple[str, Array, Array, float]]:
    """Of all of them: name, direction, J, gamma."""
    found = []
    for own in cams(read):
        far, near = (
            line(read, own, moved_on(read, state, s * H)) - line(read, own, moved_on(read, state, -s * H))
            for s in (2.0, 1.0)
        )
        V = [(placed(state, b).speed(read.masses[b].center), placed(state, b).angular_velocity) for b in read.names]
        gamma = float((8.0 * near - far) @ np.ravel(V)) / (12.0 * H)
        found.append((own.name, touch(own, state)[1], line(read, own, state), gamma))
    return found
