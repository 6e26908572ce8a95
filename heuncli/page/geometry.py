"""What a page draws of a machine: its bodies with their poses at all frames, joints, springs; its reach."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from heuncli import tolerances
from heuncli.page.packing import drawn
from heuncli.results import Array, Results
from heuncli.scenery.machine import GROUND, BodyLook, Machine, machine_of, shapes_of
from heuncli.scenery.poses import Poses
from heuncli.scenery.solids import ROUND, Surface
from heuncli.spec.models import Shape, Spec

FINE, FEW = 48, 8  # faces about an axis where there are no more bodies
REACH_FRAMES = 60  # frames by which the reach of a motion is told


def looks_of(spec: Spec) -> Machine:
    """What is seen of a spec: what is round is the finer the fewer bodies there are."""
    return machine_of(spec, FINE if len(spec.bodies) <= FEW else ROUND)


class Topologies:
    """Faces over numbered corners, each kind once: all spheres of a page share one. Keeps what it has seen."""

    def __init__(self) -> None:
        self._known: dict[tuple[tuple[int, ...], ...], int] = {}

    def number(self, faces: tuple[tuple[int, ...], ...]) -> int:
        """The number of a kind."""
        return self._known.setdefault(faces, len(self._known))

    def told(self) -> list[list[list[int]]]:
        """All of them by their numbers."""
        return [[list(face) for face in faces] for faces in self._known]


def scene_of(machine: Machine, spec: Spec, results: Results, poses: Poses) -> dict[str, Any]:
    """The scene as a page reads it; bodies are told by their numbers, the ground by -1."""
    number = {body.name: k for k, body in enumerate(machine.bodies)} | {GROUND: -1}
    kinds = Topologies()
    bodies = [_body(body, shapes_of(spec, body.name), results, kinds) for body in machine.bodies]
    ropes = {name for name, joint in spec.joints.items() if joint.tension_only}
    return {
        "bodies": bodies,
        "topologies": kinds.told(),
        "joints": [
            {
                "name": j.name, "kind": j.kind, "a": number[j.a], "p": _triple(j.p), "b": number[j.b],
                "q": _triple(j.q), "axis": _triple(j.axis), "rope": j.name in ropes,
            }
            for j in machine.joints
        ],
        "lines": [
            {"name": x.name, "kind": x.kind, "a": number[x.a], "p": _triple(x.p), "b": number[x.b], "q": _triple(x.q)}
            for x in machine.lines
        ],
        "strands": [
            {"body": number[body], "line": drawn(line)}
            for body, lines in (*machine.strands.items(), (GROUND, machine.paths)) for line in lines
        ],
        "ground": [{"name": name, "at": _triple(point)} for name, point in machine.grounded.items()],
        "gravity": _triple(np.array(spec.gravity)),
        "normal": _normal(machine, poses),
        **_reach(machine, poses),
    }  # fmt: skip


def _triple(vector: Array) -> list[float]:
    return [float(component) for component in vector]


def _body(body: BodyLook, shapes: Sequence[Shape], results: Results, kinds: Topologies) -> dict[str, Any]:
    """A body: its poses, its surfaces or lines, its points, in its own axes."""
    pose = results.bodies[body.name]
    seen = [None] if body.spread else [shape for shape in shapes if shape.type != "point"]  # each has one surface
    return {
        "name": body.name,
        "places": drawn(pose["position"]),
        "attitudes": drawn(pose["quaternion"]),
        "surfaces": [_surface(s, shape, kinds) for s, shape in zip(body.surfaces, seen, strict=True)],
        "lines": [drawn(line) for line in body.lines],
        "spread": body.spread,
        "points": [{"name": name, "at": _triple(point)} for name, point in body.points.items()],
    }


def _surface(surface: Surface, shape: Shape | None, kinds: Topologies) -> dict[str, Any]:
    """Corners and faces; of a sphere no more than what it is: it is round from everywhere."""
    if shape is not None and shape.type == "sphere":
        return {"ball": {"center": _triple(np.array(shape.center)), "radius": float(shape.radius or 0.0)}}
    return {"corners": drawn(surface.corners), "faces": kinds.number(surface.faces)}


def corners_of(body: BodyLook) -> Array:
    """All that is drawn of a body, (n, 3), in its axes."""
    parts = [*(s.corners for s in body.surfaces), *body.lines, *(p[None] for p in body.points.values())]
    return np.concatenate([np.zeros((0, 3)), *parts]) if parts else np.zeros((1, 3))


def _reach(machine: Machine, poses: Poses) -> dict[str, Any]:
    """Centre and half edges of a box that holds all of the machine at all frames, and the radius of a ball [m]."""
    some = np.linspace(0, len(poses.times) - 1, min(len(poses.times), REACH_FRAMES)).round().astype(int)
    clouds = [point[None] for point in machine.grounded.values()]
    clouds += [*machine.paths, *machine.strands.get(GROUND, ())]
    clouds += [joint.p[None] for joint in machine.joints if joint.a == GROUND]
    clouds += [joint.q[None] for joint in machine.joints if joint.b == GROUND]
    for body in machine.bodies:
        corners = corners_of(body)
        clouds += [poses.at(body.name, corners, k) for k in some.tolist()]
    cloud = np.concatenate(clouds)
    low, high = cloud.min(axis=0), cloud.max(axis=0)
    centre, half = 0.5 * (low + high), 0.5 * (high - low)
    radius = float(np.sqrt(((cloud - centre) ** 2).sum(axis=1).max()))
    return {"center": _triple(centre), "half": _triple(half), "radius": radius or 1.0}


def _normal(machine: Machine, poses: Poses) -> list[float] | None:
    """The direction about which all joints turn, world axes, if there is one: the machine moves across it."""
    axes = []
    for joint in machine.joints:
        if joint.kind == "pin":
            axis = joint.axis / np.linalg.norm(joint.axis)
            axes.append(axis if joint.a == GROUND else poses.attitudes[joint.a][0] @ axis)
    if not axes or any(np.linalg.norm(np.cross(axes[0], axis)) > tolerances.PARALLEL for axis in axes[1:]):
        return None
    return _triple(axes[0])
