"""Every joint as rows on absolute coordinates (manual/theory.md, "Joints as rows"; written from one pattern).

A row is a force direction f and a moment direction m on `to`, about the point P of `to`; `from` feels the opposite at
the same place:

    f·(Ṗ − v_a − σ_a×w) + m·(σ_b − σ_a) = given rate,   w = P − c_a,  u = P − c_b
    J on (v_b, σ_b) = [f, u×f + m],   on (v_a, σ_a) = −[f, w×f + m]
    γ = f·(σ_b×(σ_b×u) − σ_a×(Ṗ − v_a)) + ḟ·(Ṗ − v_a − σ_a×w) + ṁ·(σ_b − σ_a)

so that J V̇ + γ = given acceleration, and a multiplier λ is the force λf with the moment λm that the joint exerts on
`to`. c: centre of mass, v its velocity, σ the angular velocity. Drives are rows too, kept apart by `drive`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from tests.oracle import cams, gears, ropes
from tests.oracle.curves import seen
from tests.oracle.read import GROUND, Joint, Model, Scene, State, model, placed
from tests.oracle.sums import sums
from tests.oracle.turns import Array, about, across, cross, turn_vector
from tests.oracle.wheels import lines

Directions = list[tuple[Array, Array]]  # world vectors and their rates

# what each kind holds: forces, moments
KINDS = {
    "ball": ("all", "none"),
    "pin": ("all", "across"),
    "slide": ("across", "all"),
    "cylinder": ("across", "across"),
    "universal": ("all", "both"),
    "cv": ("all", "halving"),
    "weld": ("all", "all"),
    "line": ("across", "none"),
    "plane": ("along", "none"),
    "rod": ("between", "none"),
    "curve": ("beside", "none"),
}


class Row(NamedTuple):
    """One equation; rate and acceleration are what it prescribes."""

    joint: str
    drive: bool
    force: Array
    force_rate: Array
    moment: Array
    moment_rate: Array
    rate: float
    acceleration: float


def directions(which: str, joint: Joint, state: State) -> Directions:
    """The world directions a word of KINDS stands for, with their rates of change."""
    A, B = placed(state, joint.a.body), placed(state, joint.b.body)
    zero = np.zeros(3)
    if which == "none":
        return []
    if which == "all":
        return [(e, zero) for e in np.eye(3)]
    if which == "between":
        gap = B.point(joint.b.point) - A.point(joint.a.point)
        opening = B.speed(joint.b.point) - A.speed(joint.a.point)
        length = float(np.linalg.norm(gap))
        n = gap / length
        return [(n, (opening - n * float(n @ opening)) / length)]
    if which == "beside":
        assert joint.track is not None
        x, v = seen(A, joint.a.point, B.point(joint.b.point), B.speed(joint.b.point))
        ways = [(A.rotation @ e, A.rotation @ e_rate) for e, e_rate in joint.track.across(x, v)]
        return [(e, e_rate + cross(A.angular_velocity, e)) for e, e_rate in ways]
    if which == "both":  # a·b = 0: turning about b×a is held
        a, b = A.rotation @ joint.axis, B.rotation @ joint.to_axis
        return [(cross(b, a), cross(cross(B.angular_velocity, b), a) + cross(b, cross(A.angular_velocity, a)))]
    if which == "halving":  # the plane that halves the bend has all axes about which `to` turns in `from`
        a, b = A.rotation @ joint.axis, B.rotation @ joint.to_axis
        n, n_rate = a + b, cross(A.angular_velocity, a) + cross(B.angular_velocity, b)
        size = float(np.linalg.norm(n))
        return [(n / size, (n_rate - n / size * float(n / size @ n_rate)) / size)]
    axes = [joint.axis] if which == "along" else across(joint.axis)
    return [(A.rotation @ e, cross(A.angular_velocity, A.rotation @ e)) for e in axes]


def joint_rows(joint: Joint, state: State, t: float) -> list[Row]:
    """All rows of a joint, its drive last."""
    forces, moments = KINDS[joint.kind]
    zero = np.zeros(3)
    rows = [Row(joint.name, False, d, d_rate, zero, zero, 0.0, 0.0) for d, d_rate in directions(forces, joint, state)]
    rows += [Row(joint.name, False, zero, zero, d, d_rate, 0.0, 0.0) for d, d_rate in directions(moments, joint, state)]
    if joint.drive is None:
        return rows
    quantity, (_, first, second) = joint.drive
    given = float(first(t)), float(second(t))
    if quantity == "length":  # the rod's own row, its length now moving
        return [row._replace(drive=True, rate=given[0], acceleration=given[1]) for row in rows]
    along = coordinate_row(joint, state, quantity == "angle")
    return [*rows, along._replace(rate=given[0], acceleration=given[1])]


def coordinate_row(joint: Joint, state: State, turns: bool) -> Row:
    """The row of a joint's angle, or of its travel."""
    ((d, d_rate),) = directions("along", joint, state)
    zero = np.zeros(3)
    wrench = (zero, zero, d, d_rate) if turns else (d, d_rate, zero, zero)
    return Row(joint.name, True, *wrench, 0.0, 0.0)


class Rows(NamedTuple):
    """J (rows, 6n) on (v of the centre, σ) body by body, γ, what is prescribed, and the rows themselves."""

    J: Array
    gamma: Array
    rate: Array
    acceleration: Array
    rows: list[Row]


def assemble(scene: Model, state: State, t: float) -> Rows:
    """The rows of all joints of a scene, and of its sums, wheels, gears, cams and ropes."""
    rows: list[Row] = []
    J: list[Array] = []
    gamma: list[float] = []
    zero = np.zeros(3)
    for joint in scene.joints:
        own = joint_rows(joint, state, t)
        for row, (line, bias) in zip(own, equations(scene, joint, state, own), strict=True):
            rows.append(row)
            J.append(line)
            gamma.append(bias)
    others = (*sums_of(scene, state), *lines(scene, state), *gears.lines(scene, state), *cams.lines(scene, state))
    others += tuple(ropes.lines(scene, state))
    for name, e, line, bias in others:
        rows.append(Row(name, False, e, zero, zero, zero, 0.0, 0.0))
        J.append(line)
        gamma.append(bias)
    shape = (len(rows), 6 * len(scene.names))
    return Rows(
        np.array(J).reshape(shape),
        np.array(gamma),
        np.array([r.rate for r in rows]),
        np.array([r.acceleration for r in rows]),
        rows,
    )


def equations(scene: Model, joint: Joint, state: State, rows: Iterable[Row]) -> Iterator[tuple[Array, float]]:
    """J (6n,) and γ of rows of a joint."""
    place = {name: 6 * k for k, name in enumerate(scene.names)}
    A, B = placed(state, joint.a.body), placed(state, joint.b.body)
    center = {
        e.body: placed(state, e.body).point(scene.masses[e.body].center) if e.body != GROUND else np.zeros(3)
        for e in (joint.a, joint.b)
    }
    v_a = A.speed(scene.masses[joint.a.body].center) if joint.a.body != GROUND else np.zeros(3)
    P, P_rate = B.point(joint.b.point), B.speed(joint.b.point)
    u, w = P - center[joint.b.body], P - center[joint.a.body]
    s_a, s_b = A.angular_velocity, B.angular_velocity
    bias = cross(s_b, cross(s_b, u)) - cross(s_a, P_rate - v_a)
    slip, turning = P_rate - v_a - cross(s_a, w), s_b - s_a
    for row in rows:
        line = np.zeros(6 * len(scene.names))
        for body, arm, sign in ((joint.b.body, u, 1.0), (joint.a.body, w, -1.0)):
            if body != GROUND:
                k = place[body]
                line[k : k + 3] += sign * row.force
                line[k + 3 : k + 6] += sign * (cross(arm, row.force) + row.moment)
        yield line, float(row.force @ bias + row.force_rate @ slip + row.moment_rate @ turning)


def sums_of(scene: Model, state: State) -> Iterator[tuple[str, Array, Array, float]]:
    """Of sums of coordinates: name, no direction, J (6n,), γ."""
    for name, terms in sums(scene).items():
        line, bias = np.zeros(6 * len(scene.names)), 0.0
        for joint, turns, factor in terms:
            ((own, own_bias),) = equations(scene, joint, state, [coordinate_row(joint, state, turns)])
            line, bias = line + factor * own, bias + factor * own_bias
        yield name, np.zeros(3), line, bias


def velocities(scene: Model, state: State) -> Array:
    """(v of the centre, σ) body by body, (6n,)."""
    return np.concatenate(
        [np.concatenate([state[b].speed(scene.masses[b].center), state[b].angular_velocity]) for b in scene.names]
    )


def rates(scene: Model | Scene, state: State, t: float = 0.0) -> dict[str, Array]:
    """How fast each joint's rows open at velocity level: J V less what is prescribed; zero where it fits."""
    read = scene if isinstance(scene, Model) else model(scene)
    found = assemble(read, state, t)
    opening = found.J @ velocities(read, state) - found.rate
    return {j.name: opening[[r.joint == j.name for r in found.rows]] for j in read.joints}


def gaps(scene: Model | Scene, state: State, t: float = 0.0) -> dict[str, Array]:
    """How far each joint is open, rows as in `joint_rows`: lengths [m] and angles [rad]; zero where the state fits."""
    read = scene if isinstance(scene, Model) else model(scene)
    return {j.name: np.array(joint_gaps(j, state, t)) for j in read.joints}


def joint_gaps(joint: Joint, state: State, t: float) -> list[float]:
    """The gaps of one joint, its drive's last."""
    A, B = placed(state, joint.a.body), placed(state, joint.b.body)
    forces, moments = KINDS[joint.kind]
    offset = B.point(joint.b.point) - A.point(joint.a.point)
    a, b = A.rotation @ joint.axis, B.rotation @ joint.to_axis
    if forces == "between":
        length = joint.length if joint.drive is None else joint.drive[1][0](t)
        return [] if length is None else [float(np.linalg.norm(offset)) - length]
    found = [float(d @ offset) for d, _ in directions(forces, joint, state)]
    if moments == "across":  # the turn that takes the one axis onto the other
        lean = cross(a, b)
        sine = float(np.linalg.norm(lean))
        turn = lean * (np.arctan2(sine, float(a @ b)) / sine) if sine > 0.0 else np.zeros(3)
        found += [float(d @ turn) for d, _ in directions(moments, joint, state)]
        if sine == 0.0 and a @ b < 0.0:
            found[-1] = np.pi
    elif moments == "both":
        found.append(float(np.arcsin(a @ b)))
    elif moments == "halving":  # by how much more than its bend `to` has turned since the start
        since = unbent(A.rotation.T @ B.rotation, joint) @ unbent(joint.relative, joint).T
        found.append(float(turn_vector(since) @ joint.axis))
    elif moments == "all":
        found += list(B.rotation @ turn_vector((A.rotation @ joint.relative).T @ B.rotation))
    if joint.drive is not None:
        quantity, (value, _, _) = joint.drive
        excess = coordinates(joint, state)[quantity] - float(value(t))
        found.append(float(np.arctan2(np.sin(excess), np.cos(excess))) if quantity == "angle" else excess)
    return found


def unbent(relative: Array, joint: Joint) -> Array:
    """An attitude of `to` in `from` less the bend: the least turn that takes its axis onto that of `from`."""
    b = relative @ joint.to_axis
    lean = cross(b, joint.axis)
    sine = float(np.linalg.norm(lean))
    return (about(lean / sine, float(np.arctan2(sine, b @ joint.axis))) if sine > 0.0 else np.eye(3)) @ relative


def coordinates(joint: Joint, state: State) -> dict[str, float]:
    """What the kind has of: angle (within half a turn) and rate, travel and speed, length and (as speed) its rate."""
    A, B = placed(state, joint.a.body), placed(state, joint.b.body)
    found: dict[str, float] = {}
    axis = A.rotation @ joint.axis
    offset = B.point(joint.b.point) - A.point(joint.a.point)
    if joint.kind in ("pin", "cylinder"):
        if joint.zero is not None:
            turn = A.rotation.T @ B.rotation @ joint.zero.T
            e, f = across(joint.axis)
            found["angle"] = float(np.arctan2(f @ turn @ e, e @ turn @ e))
        found["rate"] = float(axis @ (B.angular_velocity - A.angular_velocity))
    if joint.kind in ("slide", "cylinder", "line"):
        found["travel"] = float(axis @ offset)
        seen = A.velocity + cross(A.angular_velocity, B.point(joint.b.point) - A.position)
        found["speed"] = float(axis @ (B.speed(joint.b.point) - seen))
    if joint.kind == "rod":
        n = offset / np.linalg.norm(offset)
        found["length"] = float(np.linalg.norm(offset))
        found["speed"] = float(n @ (B.speed(joint.b.point) - A.speed(joint.a.point)))
    return found
