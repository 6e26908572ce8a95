"""The same scene told otherwise: other axes, a mirror, other units, names, order, origins, ends swapped, faster.

Each returns a new scene (and what is needed to compare). Scenes hold full states, as `random_scene` makes them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from tests.oracle import told_cams as cams
from tests.oracle.masses import Mass, mass_of
from tests.oracle.read import GROUND, InTime, directed
from tests.oracle.turns import Array, attitude
from tests.oracle.values import Harmonic

Scene = dict[str, Any]
Spec = Mapping[str, Any]
POLAR_AXES = ("slide", "cylinder", "line")  # their axis is a direction to slide, a pin's is a sense of turning


def turned(scene: Scene, Q: Array) -> Scene:
    """The world and all bodies' axes turned by an orthogonal matrix; det Q = −1 is a mirror.

    Polar vectors (places, velocities, forces) become Q v, axial ones (angular velocities, moments) det(Q) Q v; angles,
    travels and their drives stay as they are.
    """
    det = float(np.sign(np.linalg.det(Q)))

    def polar(v: Sequence[InTime]) -> list[InTime]:
        return combined(Q, v)

    def axial(v: Sequence[InTime]) -> list[InTime]:
        return combined(det * Q, v)

    def joint(spec: Spec) -> Spec:
        way = polar if spec["type"] in POLAR_AXES else axial
        return {**spec, **{k: way(spec[k]) for k in ("axis", "to_axis", "normal") if k in spec}}

    def body(spec: Spec) -> Spec:
        new = dict(spec)
        if "shapes" in spec:
            new["shapes"] = [shape_moved(s, Q, np.zeros(3), det) for s in spec["shapes"]]
        else:
            mass = mass_of(spec)
            new = without_mass(new) | entry(mass._replace(center=Q @ mass.center, inertia=Q @ mass.inertia @ Q.T))
        new["points"] = {k: polar(p) for k, p in spec.get("points", {}).items()}
        R = attitude(spec["orientation"])
        new["orientation"] = {"matrix": (Q @ R @ Q.T).tolist()}
        new["position"] = polar(spec["position"])
        new["velocity"] = polar(directed(spec["velocity"], R).tolist())
        new["angular_velocity"] = axial(directed(spec["angular_velocity"], R).tolist())
        return new

    def force(spec: Spec) -> Spec:
        way = axial if spec["type"] == "couple" else polar
        return {**spec, **{key: way(spec[key]) for key in ("vector", "to_vector") if key in spec}}

    ends = ends_mapped(scene, lambda _, at: (Q @ at).tolist())
    return {
        **ends,
        "gravity": polar(scene["gravity"]),
        "ground": {"points": {k: polar(p) for k, p in scene["ground"]["points"].items()}},
        "bodies": {k: body(b) for k, b in scene["bodies"].items()},
        "joints": {k: joint(j) for k, j in ends["joints"].items()},
        **({"forces": {k: force(f) for k, f in ends["forces"].items()}} if "forces" in scene else {}),
        **told_couplings(ends, lambda cam: cams.turned(cam, Q)),
    }


def told_couplings(scene: Scene, way: Callable[[Spec], Spec]) -> Scene:
    """The couplings of a scene, each told another way; nothing of one that has none."""
    return {"couplings": {k: way(c) for k, c in scene["couplings"].items()}} if "couplings" in scene else {}


def combined(Q: Array, v: Sequence[InTime]) -> list[Any]:
    """Q v, also for components that vary in time."""
    if not any(callable(c) for c in v):
        return list((Q @ np.array(v, dtype=float)).tolist())
    return [Together(tuple(float(q) for q in row), tuple(v)) for row in Q]


class Together(NamedTuple):
    """A weighted sum of values in time."""

    factors: tuple[float, ...]
    parts: tuple[InTime, ...]

    def __call__(self, t: float) -> float:
        return sum(f * (p(t) if callable(p) else p) for f, p in zip(self.factors, self.parts, strict=True))

    @property
    def source(self) -> str:
        texts = [str(p.source) if isinstance(p, Harmonic | Together) else repr(p) for p in self.parts]
        return " + ".join(f"({f!r})*({text})" for f, text in zip(self.factors, texts, strict=True))

    def scaled(self, factor: float, time: float = 1.0) -> Together:
        """factor·f(t / time)."""
        parts = tuple(in_time_scaled(p, 1.0, time) for p in self.parts)
        return Together(tuple(factor * f for f in self.factors), parts)


def shape_moved(shape: Spec, Q: Array, shift: Array, det: float = 1.0) -> dict[str, Any]:
    """A shape turned by Q and then moved."""
    new = dict(shape)
    for key in ("from", "to", "center", "at"):
        if key in shape:
            new[key] = (Q @ np.array(shape[key], dtype=float) + shift).tolist()
    if shape["type"] == "box":  # a box is the same seen through its centre, so -Q turns it as Q does
        new["orientation"] = {"matrix": (det * Q @ attitude(shape.get("orientation"))).tolist()}
    return new


def units_changed(scene: Scene, length: float = 1.0, mass: float = 1.0, time: float = 1.0) -> Scene:
    """All numbers in other units: a length of 1 becomes `length`, and so on."""
    force, moment = mass * length / time**2, mass * length**2 / time**2
    scale = {
        "position": length,
        "velocity": length / time,
        "angular_velocity": 1 / time,
        "points": length,
        "mass": mass,
        "center": length,
        "inertia": mass * length**2,
        "deviation": mass * length**2,
    }
    shape_scale = {
        "from": length,
        "to": length,
        "center": length,
        "at": length,
        "size": length,
        "radius": length,
        "inner_radius": length,
        "to_radius": length,
        "mass": mass,
        "density": mass / length**3,
        "line_density": mass / length,
    }

    def shape(spec: Spec) -> Spec:
        return {k: times(v, shape_scale[k]) if k in shape_scale else v for k, v in spec.items()}

    def body(spec: Spec) -> Spec:
        new = {k: times(v, scale.get(k, 1.0)) for k, v in spec.items() if k not in ("shapes", "orientation")}
        if "shapes" in spec:
            new["shapes"] = [shape(s) for s in spec["shapes"]]
        return {**new, **{k: spec[k] for k in ("orientation",) if k in spec}}

    def load(spec: Spec) -> Spec:
        new = dict(spec)
        sliding = "joint" in spec and scene["joints"][spec["joint"]]["type"] in ("slide", "line", "plane")
        speed = length / time if sliding else 1 / time
        factors = {
            "force": {"vector": force},
            "couple": {"vector": moment},
            "actuator": {"value": force},
            "torque": {"value": force if sliding else moment},
            "spring": {"stiffness": mass / time**2, "length": length, "damping": mass / time},
            "damper": {"coefficient": mass / time if sliding else moment * time, "sliding": mass / time},
            "distributed": {"vector": force / length, "to_vector": force / length},
            "turn_spring": {"stiffness": moment, "damping": moment * time},
            "bushing": {
                "stiffness": mass / time**2,
                "damping": mass / time,
                "preload": force,
                "turning": moment,
                "coupling": force,
                "coupling_damping": force * time,
                "turning_damping": moment * time,
                "turning_preload": moment,
            },
            "friction": {"torque": moment, "force": force, "speed": speed, "radius": length, "length": length},
        }[spec["type"]]
        for key, factor in factors.items():
            if key in spec:
                new[key] = times(spec[key], factor, time)
        return new

    def drive(spec: Spec) -> Spec:
        key = next(k for k in ("angle", "travel", "length") if k in spec)
        return {**spec, key: spec[key][0].scaled(1.0 if key == "angle" else length, time).drive()}

    new = ends_mapped(scene, lambda _, at: (length * at).tolist())
    new["gravity"] = times(scene["gravity"], length / time**2)
    new["ground"] = {"points": times(scene["ground"]["points"], length)}
    new["bodies"] = {k: body(b) for k, b in scene["bodies"].items()}
    for name, spec in new["joints"].items():
        if "length" in spec:
            new["joints"][name] = {**spec, "length": length * spec["length"]}
    new |= told_couplings(new, lambda cam: cams.in_units(cam, length)) | cams.tables_in_units(scene, length)
    if "forces" in scene:
        new["forces"] = {k: load(f) for k, f in new["forces"].items()}
    if "drives" in scene:
        new["drives"] = {k: drive(d) for k, d in scene["drives"].items()}
    return new


def faster(scene: Scene, c: float) -> Scene:
    """Rates c times, forces c² times as large, all in time c times as fast: every reaction is c² times as large."""
    return units_changed(scene, time=1 / c)


def times(value: Any, factor: float, time: float = 1.0) -> Any:
    """Numbers, lists, mappings and values in time, multiplied."""
    if isinstance(value, Mapping):
        return {k: v if k == "frame" else times(v, factor, time) for k, v in value.items()}
    if callable(value) or isinstance(value, int | float):
        return in_time_scaled(value, factor, time)
    return [times(v, factor, time) for v in value]


def in_time_scaled(value: Any, factor: float, time: float) -> Any:
    return value.scaled(factor, time) if callable(value) else factor * value


def renamed(scene: Scene, rng: np.random.Generator) -> tuple[Scene, dict[str, str], dict[str, str]]:
    """Bodies and joints under other names, in another order; with the new names of bodies and joints by the old."""
    bodies, joints = list(scene["bodies"]), list(scene["joints"])
    body_names = {b: f"m{k}" for k, b in enumerate(rng.permutation(bodies))} | {GROUND: GROUND}
    joint_names = {j: f"c{k}" for k, j in enumerate(rng.permutation(joints))}

    def name(value: Any) -> Any:
        if isinstance(value, Mapping):
            return {**value, "body": body_names[value["body"]]}
        if isinstance(value, list):  # a distributed load's end on the body that it names
            return value
        body, dot, point = value.partition(".")
        return body_names[body] + dot + point

    def spec(entry: Spec) -> Spec:
        new = {k: name(v) if k in ("from", "to", "on") else v for k, v in entry.items()}
        return {**new, **({"joint": joint_names[entry["joint"]]} if "joint" in entry else {})}

    new = {
        **scene,
        "bodies": {body_names[b]: scene["bodies"][b] for b in rng.permutation(bodies)},
        "joints": {joint_names[j]: spec(scene["joints"][j]) for j in rng.permutation(joints)},
    }
    new |= told_couplings(scene, lambda cam: cams.renamed(cam, body_names, joint_names))
    for part in ("forces", "drives"):
        if part in scene:
            new[part] = {k: spec(v) for k, v in scene[part].items()}
    return new, body_names, joint_names


def origin_moved(scene: Scene, body: str, by: Array) -> Scene:
    """The same body told from an origin `by` (body axes) away: nothing physical changes."""
    spec = scene["bodies"][body]
    R = attitude(spec["orientation"])
    spin = directed(spec["angular_velocity"], R)
    new = dict(spec)
    new["position"] = (np.array(spec["position"]) + R @ by).tolist()
    new["velocity"] = (directed(spec["velocity"], R) + np.cross(spin, R @ by)).tolist()
    new["points"] = {k: (np.array(p) - by).tolist() for k, p in spec.get("points", {}).items()}
    if "shapes" in spec:
        new["shapes"] = [shape_moved(s, np.eye(3), -by) for s in spec["shapes"]]
    else:
        new["center"] = (np.array(spec.get("center", [0, 0, 0])) - by).tolist()
    moved = ends_mapped(scene, lambda owner, at: (at - by if owner == body else at).tolist())
    return {**moved, "bodies": {**scene["bodies"], body: new}}


def swapped(scene: Scene, joint: str) -> Scene:
    """A ball, pin, weld or rod told from its other end: its reaction turns round; angles, torques and drives stay."""
    spec = scene["joints"][joint]
    new = {**spec, "from": spec["to"], "to": spec["from"]}
    if spec["type"] == "pin":  # the angle of a in b about −axis is that of b in a about axis
        new["axis"] = [-c for c in spec.get("to_axis", spec["axis"])]
        if "to_axis" in spec:
            new["to_axis"] = [-c for c in spec["axis"]]
    elif spec["type"] not in ("ball", "weld", "rod"):
        raise ValueError(f"{joint}: a {spec['type']} is not told from its other end")
    return {**scene, "joints": {**scene["joints"], joint: new}}


def ends_mapped(scene: Scene, change: Callable[[str, Array], list[float]]) -> Scene:
    """All {body, at} ends of joints, loads and cams with their place changed; named points are the bodies' own affair.

    And those of distributed loads, which are given in the axes of the body that they are on.
    """

    def end(value: Any, on: Any) -> Any:
        if isinstance(value, list):
            return change(on, np.array(value, dtype=float))
        if isinstance(value, Mapping) and "at" in value:
            return {**value, "at": change(value["body"], np.array(value["at"], dtype=float))}
        return value

    parts = [part for part in ("joints", "forces", "couplings") if part in scene]
    keys = ("from", "to", "on", "at")
    return {
        **scene,
        **{
            part: {
                name: {k: end(v, spec.get("on")) if k in keys else v for k, v in spec.items()}
                for name, spec in scene[part].items()
            }
            for part in parts
        },
    }


def without_mass(body: Spec) -> dict[str, Any]:
    return {k: v for k, v in body.items() if k not in ("mass", "center", "inertia", "deviation", "shapes")}


def entry(mass: Mass) -> dict[str, Any]:
    return {"mass": mass.mass, "center": mass.center.tolist(), "inertia": mass.inertia.tolist()}
