"""What a page draws of a machine: its bodies with their poses at all frames, joints, springs; its reach."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.output.drawing.symbols import SYMBOLS
from heuncli.output.machine_geometry.coupled_pulls import CoupledPull, coupled_pulls
from heuncli.output.machine_geometry.machine import BodyLook, Machine, machine_of
from heuncli.output.machine_geometry.marks import Mark
from heuncli.output.machine_geometry.poses import Poses
from heuncli.output.machine_geometry.ropes import RopeLook, strand_ends
from heuncli.output.machine_geometry.solids import ROUND, Surface
from heuncli.output.web_page.packing import drawn
from heuncli.results.results import Array, Results
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import GROUND

FINE, FEW = 48, 8  # faces about an axis where there are no more bodies
SEEN = 1e-7  # of a vector: what places that are drawn tell
REACH_FRAMES = 60  # frames by which the reach of a motion is told


def looks_of(spec: Spec, scene: PreparedScene | None = None) -> Machine:
    """What is seen of a spec, scene: as assembled; what is round is the finer the fewer bodies there are."""
    return machine_of(spec, FINE if len(spec.bodies) <= FEW else ROUND, scene)


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


def scene_of(
    machine: Machine, spec: Spec, results: Results, poses: Poses, normal: Array | None = None
) -> dict[str, Any]:
    """The scene as a page reads it; bodies are told by their numbers, the ground by -1.

    normal: of the plane in which all of it stays, (3,), if there is one.
    """
    number = {body.name: k for k, body in enumerate(machine.bodies)} | {GROUND: -1}
    kinds = Topologies()
    rolling = {wheel.wheel.body for wheel in spec.rolling.values()}
    bodies = [_body(body, results, kinds, body.name in rolling) for body in machine.bodies]
    order = {joint.name: k for k, joint in enumerate(machine.joints)}
    belts = {belt.name for belt in machine.belts}
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
        "paths": [drawn(path) for path in machine.paths],
        "belts": [
            {"body": number[belt.carrier], "strands": drawn(belt.strands), "run": drawn(belt.run(results.coordinates))}
            for belt in machine.belts
        ],
        "ropes": [_rope(rope, poses, number) for rope in machine.ropes],
        "marks": [_mark(mark, poses) for mark in machine.marks],
        "acting": [
            {"joint": order[own.joint], "symbols": own.symbols, "slides": own.slides} for own in machine.acting
        ],
        "symbols": {name: _symbol(name) for name in sorted(_symbols(machine))},
        "ground": [{"name": name, "at": _triple(point)} for name, point in machine.grounded.items()],
        "gravity": _triple(np.array(spec.gravity)),
        "pulls": [_pull(pull, belts) for pull in coupled_pulls(machine, poses, results.couplings)],
        "normal": _normal(machine, poses) if normal is None else _triple(normal),
        **_reach(machine, poses),
    }  # fmt: skip


def _triple(vector: Array) -> list[float]:
    return [float(component) for component in vector]


def _body(body: BodyLook, results: Results, kinds: Topologies, rolls: bool) -> dict[str, Any]:
    """A body: its poses, its surfaces, bars and lines, its points, in its own axes; rolls: as a wheel, or a ball."""
    pose = results.bodies[body.name]
    rolled = [edge for surface in body.surfaces if rolls and surface.ball is not None for edge in surface.edges[:2]]
    return {
        "name": body.name,
        "places": drawn(pose["position"]),
        "attitudes": drawn(pose["quaternion"]),
        "surfaces": [_surface(surface, kinds) for surface in body.surfaces],
        "bars": [drawn(line) for line in body.bars],
        "lines": [drawn(line) for line in (*body.lines, *rolled)],
        "spread": body.spread,
        "points": [{"name": name, "at": _triple(point)} for name, point in body.points.items()],
    }


def _surface(surface: Surface, kinds: Topologies) -> dict[str, Any]:
    """Corners and faces; of a sphere no more than what it is: it is round from everywhere."""
    if surface.ball is not None:
        centre, radius = surface.ball
        return {"ball": {"center": _triple(np.array(centre)), "radius": float(radius)}}
    return {"corners": drawn(surface.corners), "faces": kinds.number(surface.faces)}


def _rope(rope: RopeLook, poses: Poses, number: Mapping[str, int]) -> dict[str, Any]:
    """A rope: where its strands begin and end at all frames, and about what it runs between them."""
    return {
        "name": rope.name,
        "count": len(rope.strands),
        "ends": drawn(strand_ends(rope, poses)),
        "arcs": [
            {
                "before": arc.before, "body": number[arc.body], "center": _triple(arc.centre),
                "along": number[arc.along], "axis": _triple(arc.axis),
            }
            for arc in rope.arcs
        ],
    }  # fmt: skip


def _mark(mark: Mark, poses: Poses) -> dict[str, Any]:
    """A symbol with its place and direction, at all frames or, of one that stands still, once."""
    places, ways = mark.stands(poses)
    kept = 1 if stands_still(places) and stands_still(ways) else None
    return {
        "symbol": mark.symbol,
        "name": mark.name,
        "places": drawn(places[:kept]),
        "ways": drawn(ways[:kept]),
    }


def stands_still(vectors: Array) -> bool:
    """Whether vectors (n, 3) are one to the digits that are drawn."""
    return bool(np.abs(vectors - vectors[0]).max() <= SEEN * float(np.abs(vectors[0]).max()))


def _pull(pull: CoupledPull, belts: Collection[str]) -> dict[str, Any]:
    """The force of a coupling ON a body: where it stands at all frames; what it is stands in a row of the numbers.

    Of a belt's strands it is told here, for no row tells the direction of each.
    """
    belt = pull.name in belts
    told = {"row": f"couplings.{pull.name}.{'tight' if belt else f'on.{pull.on}.force'}", "at": drawn(pull.places)}
    return {"name": pull.name, "on": pull.on, **told, "forces": drawn(pull.forces) if belt else None}


def _symbols(machine: Machine) -> set[str]:
    """The symbols that a page draws as they are in pictures."""
    return {mark.symbol for mark in machine.marks} | {name for own in machine.acting for name in own.symbols}


def _symbol(name: str) -> list[dict[str, Any]]:
    """The parts of a symbol, in pixels."""
    return [{"points": part.points, "closed": part.closed, "fill": part.fill} for part in SYMBOLS[name].parts]


def corners_of(body: BodyLook) -> Array:
    """All that is drawn of a body, (n, 3), in its axes."""
    parts = [*(s.corners for s in body.surfaces), *body.strokes, *(p[None] for p in body.points.values())]
    return np.concatenate([np.zeros((0, 3)), *parts]) if parts else np.zeros((1, 3))


def _reach(machine: Machine, poses: Poses) -> dict[str, Any]:
    """Centre and half edges of a box that holds all of the machine at all frames, and the radius of a ball [m]."""
    some = np.linspace(0, len(poses.times) - 1, min(len(poses.times), REACH_FRAMES)).round().astype(int)
    clouds = [point[None] for point in machine.grounded.values()]
    clouds += machine.paths
    clouds += [strand_ends(rope, poses).reshape(-1, 3) for rope in machine.ropes]
    clouds += [mark.stands(poses)[0] for mark in machine.marks]
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
