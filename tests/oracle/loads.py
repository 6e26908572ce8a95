"""Applied loads as pushes: a force at a place and a couple, on a body or the ground, one entry per thing pushed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from tests.oracle import gears, ropes
from tests.oracle.read import GROUND, End, Joint, Model, State, at_time, end, placed, start_state, vector_at
from tests.oracle.rows import coordinates, directions
from tests.oracle.turns import Array, attitude, cross, unit

Spec = Mapping[str, Any]


class Push(NamedTuple):
    """What acts on a body at a place, world axes."""

    body: str
    place: Array
    force: Array
    couple: Array

    def about(self, point: Array) -> Array:
        """Its moment about a point."""
        return cross(self.place - point, self.force) + self.couple

    def power(self, state: State) -> float:
        """Force times speed of the body's own point there, couple times turning."""
        on = placed(state, self.body)
        return float(
            self.force @ (on.velocity + cross(on.angular_velocity, self.place - on.position))
            + self.couple @ on.angular_velocity
        )


def pushes(scene: Model, state: State, t: float) -> dict[str, list[Push]]:
    """All applied loads by name; the weight is called `gravity`."""
    found = {
        "gravity": [
            Push(name, state[name].point(m.center), m.mass * scene.gravity, np.zeros(3))
            for name, m in scene.masses.items()
        ]
    }
    for name, spec in scene.loads.items():
        found[name] = KINDS_OF_LOAD[spec["type"]](scene, state, t, spec)
    for name, pulls in (gears.pulls(scene, state) | ropes.pulls(scene, state)).items():
        found[name] = [Push(body, place, F, np.zeros(3)) for body, place, F in pulls]
    return found


def from_outside(scene: Model, name: str) -> bool:
    """Whether a load is no matter between two bodies, as all others are, a belt's pretension among them."""
    return name in scene.loads and scene.loads[name]["type"] in ("force", "couple")


def force(scene: Model, state: State, t: float, spec: Spec) -> list[Push]:
    on = end(scene.scene, spec["on"])
    return [Push(on.body, placed(state, on.body).point(on.point), in_frame(state, on.body, t, spec), np.zeros(3))]


def couple(scene: Model, state: State, t: float, spec: Spec) -> list[Push]:
    at_point = not isinstance(spec["on"], str) or "." in spec["on"]
    on = end(scene.scene, spec["on"]) if at_point else End(spec["on"], np.zeros(3))
    return [Push(on.body, placed(state, on.body).point(on.point), np.zeros(3), in_frame(state, on.body, t, spec))]


def in_frame(state: State, body: str, t: float, spec: Spec) -> Array:
    vector = vector_at(spec["vector"], t)
    return placed(state, body).rotation @ vector if spec.get("frame", "world") == "body" else vector


def between(scene: Model, state: State, spec: Spec, size: Callable[[float, float], float]) -> list[Push]:
    """Along the line between two points, size(length, rate) pushing apart."""
    a, b = end(scene.scene, spec["from"]), end(scene.scene, spec["to"])
    A, B = placed(state, a.body), placed(state, b.body)
    gap, opening = B.point(b.point) - A.point(a.point), B.speed(b.point) - A.speed(a.point)
    length = float(np.linalg.norm(gap))
    n = gap / length
    F = size(length, float(n @ opening)) * n
    return [Push(b.body, B.point(b.point), F, np.zeros(3)), Push(a.body, A.point(a.point), -F, np.zeros(3))]


def spring(scene: Model, state: State, t: float, spec: Spec) -> list[Push]:
    k, rest, c = float(spec.get("stiffness", 0.0)), float(spec.get("length", 0.0)), float(spec.get("damping", 0.0))
    return between(scene, state, spec, lambda length, rate: -k * (length - rest) - c * rate)


def actuator(scene: Model, state: State, t: float, spec: Spec) -> list[Push]:
    return between(scene, state, spec, lambda length, rate: at_time(spec["value"], t))


def in_joint(joint: Joint, state: State, F: Array, M: Array) -> list[Push]:
    """A force at the `to` point and a couple on `to`, the opposite on `from` at the same place."""
    P = placed(state, joint.b.body).point(joint.b.point)
    return [Push(joint.b.body, P, F, M), Push(joint.a.body, P, -F, -M)]


def slip(joint: Joint, state: State) -> tuple[Array, Array]:
    """Velocity of the `to` point and angular velocity of `to`, both seen from `from`."""
    A, B = placed(state, joint.a.body), placed(state, joint.b.body)
    P = B.point(joint.b.point)
    return (
        B.speed(joint.b.point) - A.velocity - cross(A.angular_velocity, P - A.position),
        B.angular_velocity - A.angular_velocity,
    )


def joint_named(scene: Model, name: str) -> Joint:
    return next(j for j in scene.joints if j.name == name)


def slides(kind: str) -> bool:
    """Whether a kind leaves only sliding to resist (its turning, if free, is not meant)."""
    return kind in ("slide", "line", "plane")


def torque(scene: Model, state: State, t: float, spec: Spec) -> list[Push]:
    joint = joint_named(scene, spec["joint"])
    ((axis, _),) = directions("along", joint, state)
    value = at_time(spec["value"], t) * axis
    zero = np.zeros(3)
    return in_joint(joint, state, value, zero) if slides(joint.kind) else in_joint(joint, state, zero, value)


def damper(scene: Model, state: State, t: float, spec: Spec) -> list[Push]:
    joint = joint_named(scene, spec["joint"])
    sliding, turning = slip(joint, state)
    c = float(spec.get("coefficient", 0.0))
    if slides(joint.kind):
        return in_joint(joint, state, -c * sliding, np.zeros(3))
    return in_joint(joint, state, -float(spec.get("sliding", 0.0)) * sliding, -c * turning)


def friction(scene: Model, state: State, t: float, spec: Spec) -> list[Push]:
    joint = joint_named(scene, spec["joint"])
    sliding, turning = slip(joint, state)
    speed = float(spec["speed"])
    return in_joint(
        joint,
        state,
        opposing(sliding, float(spec.get("force", 0.0)), speed),
        opposing(turning, float(spec.get("torque", 0.0)), speed),
    )


def opposing(rate: Array, size: float, speed: float) -> Array:
    """Against a rate, size·tanh(|rate|/speed)."""
    length = float(np.linalg.norm(rate))
    return -rate / length * size * np.tanh(length / speed) if length > 0.0 and size != 0.0 else np.zeros(3)


def distributed(scene: Model, state: State, t: float, spec: Spec) -> list[Push]:
    """By Gauss's rule of two points a half, which has no error in forces and moments that are cubic along the line."""
    me = placed(state, spec["on"])
    a, b = (np.array(spec[key], dtype=float) for key in ("from", "to"))
    turn = me.rotation if spec.get("frame", "world") == "body" else np.eye(3)
    first, last = (turn @ vector_at(spec.get(key, spec["vector"]), t) for key in ("vector", "to_vector"))
    places = [0.25 + 0.5 * half + side * 0.25 / np.sqrt(3.0) for half in (0, 1) for side in (-1.0, 1.0)]
    length = float(np.linalg.norm(b - a))
    return [
        Push(spec["on"], me.point(a + x * (b - a)), 0.25 * length * ((1.0 - x) * first + x * last), np.zeros(3))
        for x in places
    ]


def turn_spring(scene: Model, state: State, t: float, spec: Spec) -> list[Push]:
    joint = joint_named(scene, spec["joint"])
    A, B = placed(state, joint.a.body), placed(state, joint.b.body)
    axis = A.rotation @ joint.axis
    angle = turned_by(joint, state)
    start = turned_by(joint, start_state(scene.scene))
    angle += 2.0 * np.pi * np.round((start - angle) / (2.0 * np.pi))  # short motions only
    rate = float(axis @ (B.angular_velocity - A.angular_velocity))
    value = -spec["stiffness"] * (angle - spec.get("angle", 0.0)) - spec.get("damping", 0.0) * rate
    return in_joint(joint, state, np.zeros(3), value * axis)


def bushing(scene: Model, state: State, t: float, spec: Spec) -> list[Push]:
    """Force and couple on `to` at its point, the opposite on `from` at the same place."""
    a, b = end(scene.scene, spec["from"]), end(scene.scene, spec["to"])
    B, (F, M) = placed(state, b.body), elastic(scene, state, spec)
    place, T = B.point(b.point), elastic_axes(scene, state, spec)[0]
    return [Push(b.body, place, T @ F, T @ M), Push(a.body, place, -T @ F, -T @ M)]


def elastic_axes(scene: Model, state: State, spec: Spec) -> tuple[Array, Array]:
    """The bushing's axes in `from` and in `to`, world."""
    a, b = end(scene.scene, spec["from"]), end(scene.scene, spec["to"])
    own = attitude(spec.get("orientation"))
    to = attitude(spec["to_orientation"]) if "to_orientation" in spec else own
    return placed(state, a.body).rotation @ own, placed(state, b.body).rotation @ to


def strain(scene: Model, state: State, spec: Spec) -> tuple[Array, Array]:
    """Shift and rotation vector of `to` in the bushing's axes; the latter by SciPy."""
    a, b = end(scene.scene, spec["from"]), end(scene.scene, spec["to"])
    T, U = elastic_axes(scene, state, spec)
    gap = placed(state, b.body).point(b.point) - placed(state, a.body).point(a.point)
    return T.T @ gap, Rotation.from_matrix(T.T @ U).as_rotvec()


def elastic(scene: Model, state: State, spec: Spec) -> tuple[Array, Array]:
    """Force and moment on `to` in the bushing's axes: by the derivative of the exponential map, solved for."""
    a, b = end(scene.scene, spec["from"]), end(scene.scene, spec["to"])
    A, B = placed(state, a.body), placed(state, b.body)
    T = elastic_axes(scene, state, spec)[0]
    d, phi = strain(scene, state, spec)
    place = B.point(b.point)
    slip = T.T @ (B.speed(b.point) - A.velocity - cross(A.angular_velocity, place - A.position))
    spin = T.T @ (B.angular_velocity - A.angular_velocity)
    six = [
        np.block([[square(spec, shift), (X := square(spec, coupling))], [X.T, square(spec, turn)]])
        for shift, turn, coupling in BLOCKS
    ]
    preload = np.concatenate([np.broadcast_to(spec.get(key, 0.0), 3) for key in ("preload", "turning_preload")])
    elastic_load = preload - six[0] @ np.concatenate([d, phi])
    drag = six[1] @ np.concatenate([slip, spin])
    angle = float(np.linalg.norm(phi))
    K = np.array([[0.0, -phi[2], phi[1]], [phi[2], 0.0, -phi[0]], [-phi[1], phi[0], 0.0]])
    J = np.eye(3)
    if angle > 0.0:
        J = J + (1.0 - np.cos(angle)) / angle**2 * K + (angle - np.sin(angle)) / angle**3 * K @ K
    return elastic_load[:3] - drag[:3], np.linalg.solve(J.T, elastic_load[3:]) - drag[3:]


BLOCKS = ("stiffness", "turning", "coupling"), ("damping", "turning_damping", "coupling_damping")


def square(spec: Spec, key: str) -> Array:
    """A matrix from one number, three, or nine."""
    value = np.asarray(spec.get(key, 0.0), dtype=float)
    return value if value.ndim == 2 else np.diag(np.broadcast_to(value, 3))


def turned_by(joint: Joint, state: State) -> float:
    """The angle about the axis; of a universal that of its second axis."""
    if joint.kind != "universal":
        return coordinates(joint, state)["angle"]
    A, B = placed(state, joint.a.body), placed(state, joint.b.body)
    now = A.rotation.T @ B.rotation @ joint.to_axis
    u = unit(joint.to_axis - (joint.to_axis @ joint.axis) * joint.axis)
    return float(np.arctan2(now @ cross(joint.axis, u), now @ u))


KINDS_OF_LOAD: dict[str, Callable[[Model, State, float, Spec], list[Push]]] = {
    "force": force,
    "couple": couple,
    "torque": torque,
    "actuator": actuator,
    "spring": spring,
    "damper": damper,
    "friction": friction,
    "distributed": distributed,
    "turn_spring": turn_spring,
    "bushing": bushing,
}


def gathered(scene: Model, state: State, loads: Mapping[str, list[Push]]) -> Array:
    """All pushes on the bodies as (force, moment about the centre) body by body, (6n,)."""
    total = np.zeros(6 * len(scene.names))
    place = {name: 6 * k for k, name in enumerate(scene.names)}
    for push in (p for parts in loads.values() for p in parts if p.body != GROUND):
        k = place[push.body]
        total[k : k + 3] += push.force
        total[k + 3 : k + 6] += push.about(state[push.body].point(scene.masses[push.body].center))
    return total
