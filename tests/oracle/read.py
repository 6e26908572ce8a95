"""A scene (the plain dict of a spec, all numbers SI) and a state, as arrays the oracle can work with.

A value in time is a float or a callable of t. A drive is {"joint": ..., quantity: (value, first, second)}, three
callables of t.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from tests.oracle.curves import Track, track
from tests.oracle.masses import Mass, mass_of
from tests.oracle.turns import Array, about, attitude, cross, unit

Scene = Mapping[str, Any]
InTime = float | Callable[[float], float]
GROUND = "ground"


class Placed(NamedTuple):
    """Where a body's origin is and how fast, world axes [m, m/s, rad/s]; rotation: body to world, (3, 3)."""

    position: Array
    rotation: Array
    velocity: Array
    angular_velocity: Array

    def point(self, p: Array) -> Array:
        """Where a point of the body (body axes) is."""
        return self.position + self.rotation @ p

    def speed(self, p: Array) -> Array:
        """How fast a point of the body moves."""
        return self.velocity + cross(self.angular_velocity, self.rotation @ p)


State = Mapping[str, Placed]
AT_REST = Placed(np.zeros(3), np.eye(3), np.zeros(3), np.zeros(3))


class End(NamedTuple):
    """A point of a body, body axes."""

    body: str
    point: Array


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint with its axes at unit length; `relative` is the attitude of `to` in `from` that a slide or weld keeps.

    zero: the attitude of `to` in `from` at which the angle is zero, None if the scene does not tell.
    """

    name: str
    kind: str
    a: End
    b: End
    axis: Array
    to_axis: Array
    length: float | None
    relative: Array
    zero: Array | None
    drive: tuple[str, tuple[Callable[[float], float], ...]] | None
    track: Track | None


@dataclass(frozen=True, eq=False)
class Model:
    """A scene, read: body names in order, their masses, joints in order, loads and gravity as given."""

    scene: Scene
    names: tuple[str, ...]
    masses: dict[str, Mass]
    joints: tuple[Joint, ...]
    loads: Mapping[str, Mapping[str, Any]]
    gravity: Array


def model(scene: Scene) -> Model:
    """Read a scene once."""
    bodies = scene["bodies"]
    drives = {d["joint"]: d for d in (scene.get("drives") or {}).values()}
    joints = tuple(joint(scene, name, j, drives.get(name)) for name, j in (scene.get("joints") or {}).items())
    return Model(
        scene,
        tuple(bodies),
        {name: mass_of(body) for name, body in bodies.items()},
        joints,
        scene.get("forces") or {},
        np.array(scene.get("gravity", [0.0, 0.0, 0.0]), dtype=float),
    )


def joint(scene: Scene, name: str, spec: Mapping[str, Any], drive: Mapping[str, Any] | None) -> Joint:
    """One joint's entry."""
    a, b = end(scene, spec["from"]), end(scene, spec["to"])
    axis = unit(spec.get("axis", spec.get("normal", [1.0, 0.0, 0.0])))
    given = start_attitude(scene, a.body), start_attitude(scene, b.body)
    drawn = None if given[0] is None or given[1] is None else given[0].T @ given[1]
    relative = np.eye(3) if drawn is None else drawn
    assembled = "to_axis" in spec or (drive is not None and drive.get("zero") == "assembled")
    length = spec.get("length")
    if spec["type"] == "rod" and length is None and all(has_position(scene, e.body) for e in (a, b)):
        start = start_state(scene)
        length = float(np.linalg.norm(placed(start, b.body).point(b.point) - placed(start, a.body).point(a.point)))
    prescribed = None
    if drive is not None:
        quantity = next(q for q in ("angle", "travel", "length") if q in drive)
        prescribed = (quantity, tuple(drive[quantity]))
    return Joint(
        name,
        spec["type"],
        a,
        b,
        axis,
        unit(spec.get("to_axis", axis)),
        length,
        relative,
        drawn if assembled else np.eye(3),
        prescribed,
        track(scene, spec),
    )


def end(scene: Scene, value: str | Mapping[str, Any]) -> End:
    """`body.point`, `ground.point` or {body, at}."""
    if not isinstance(value, str):
        return End(value["body"], np.array(value["at"], dtype=float))
    body, _, point = value.partition(".")
    owner = scene["ground"] if body == GROUND else scene["bodies"][body]
    return End(body, np.array(owner["points"][point], dtype=float))


def start_attitude(scene: Scene, body: str) -> Array | None:
    """The attitude a scene gives a body, None if it leaves it out."""
    if body == GROUND:
        return np.eye(3)
    orientation = scene["bodies"][body].get("orientation")
    return None if orientation is None else attitude(orientation)


def has_position(scene: Scene, body: str) -> bool:
    """Whether a scene says where a body's origin is."""
    return body == GROUND or "position" in scene["bodies"][body]


def start_state(scene: Scene) -> dict[str, Placed]:
    """The state the scene itself gives; what it leaves out is as drawn and at rest."""
    state = {}
    for name, body in scene["bodies"].items():
        R = attitude(body.get("orientation"))
        state[name] = Placed(
            np.array(body.get("position", [0, 0, 0]), dtype=float),
            R,
            directed(body.get("velocity"), R),
            directed(body.get("angular_velocity"), R),
        )
    return state


def state_at(bodies: Mapping[str, Mapping[str, Any]], instant: int) -> dict[str, Placed]:
    """The state in a result's `bodies` (manual/results.md, "Paths": arrays with the instants first)."""
    keys = ("position", "rotation", "velocity", "angular_velocity")
    return {name: Placed(*(np.array(body[k][instant], dtype=float) for k in keys)) for name, body in bodies.items()}


def moved_on(read: Model, state: State, dt: float) -> dict[str, Placed]:
    """All bodies carried on by a moment, velocities of the centres of mass and angular ones as they are."""
    found = {}
    for name, own in state.items():
        spin = own.angular_velocity
        size = float(np.linalg.norm(spin))
        R = about(spin / size, size * dt) @ own.rotation if size else own.rotation
        c = read.masses[name].center
        v = own.speed(c)
        centre = own.point(c) + dt * v
        found[name] = own._replace(rotation=R, position=centre - R @ c, velocity=v - cross(spin, R @ c))
    return found


def directed(value: Sequence[float] | Mapping[str, Any] | None, R: Array) -> Array:
    """A velocity entry in world axes."""
    if value is None:
        return np.zeros(3)
    if isinstance(value, Mapping):
        vector = np.array(value["vector"], dtype=float)
        return R @ vector if value.get("frame", "world") == "body" else vector
    return np.array(value, dtype=float)


def placed(state: State, body: str) -> Placed:
    """A body of the state, or the ground."""
    return AT_REST if body == GROUND else state[body]


def at_time(value: InTime, t: float) -> float:
    """A value in time at an instant."""
    return float(value(t)) if callable(value) else float(value)


def vector_at(values: Sequence[InTime], t: float) -> Array:
    """A vector in time at an instant, (3,)."""
    return np.array([at_time(v, t) for v in values])
