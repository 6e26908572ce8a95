"""The geometry that a page draws: bodies with their poses at all frames, joints, springs, ropes, symbols, extent."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.load_kinds import LOAD_KINDS
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.output.drawing.symbols import SYMBOLS
from heuncli.output.machine_geometry.machine import (
    BodyGeometry,
    CouplingForce,
    LineGeometry,
    Machine,
    iter_coupling_forces,
    make_machine,
)
from heuncli.output.machine_geometry.marks import Mark
from heuncli.output.machine_geometry.poses import Poses
from heuncli.output.machine_geometry.ropes import RopeGeometry, compute_span_ends
from heuncli.output.machine_geometry.solids import ROUND_FACES, Surface
from heuncli.output.web_page.packing import pack_points
from heuncli.results.results import Array, Results
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import GROUND
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.labels import Labels

FINE_FACES, FEW_BODIES = 48, 8  # faces about an axis, used up to this number of bodies
DRAWN_PRECISION = 1e-7  # relative precision of points that are drawn (float32)
MAX_EXTENT_FRAMES = 60  # frames from which the extent of the motion is computed


def make_page_machine(spec: Spec, scene: PreparedScene | None = None) -> Machine:
    """Make the machine geometry of a spec; round shapes get more faces if there are few bodies.

    scene: the spec as assembled, or None
    """
    return make_machine(spec, FINE_FACES if len(spec.bodies) <= FEW_BODIES else ROUND_FACES, scene)


class Topologies:
    """The face lists of a page, each stored once under a number, so that all spheres share one. Mutable: it grows."""

    def __init__(self) -> None:
        self._known: dict[tuple[tuple[int, ...], ...], int] = {}

    def register(self, faces: tuple[tuple[int, ...], ...]) -> int:
        """Return the number of a face list; a new one is stored."""
        return self._known.setdefault(faces, len(self._known))

    def to_lists(self) -> list[list[list[int]]]:
        """Return all face lists in the order of their numbers."""
        return [[list(face) for face in faces] for faces in self._known]


def _pack_ends(link: Any, body_numbers: Mapping[str, int]) -> dict[str, Any]:
    """Pack the two bodies of a joint or line by number, and its points on them, (3,) each."""
    a, b = body_numbers[link.a], body_numbers[link.b]
    return {"a": a, "p": _to_floats(link.p), "b": b, "q": _to_floats(link.q)}


def make_page_scene(
    machine: Machine, spec: Spec, results: Results, poses: Poses, labels: Labels, normal: Array | None = None
) -> dict[str, Any]:
    """Make the scene in the form that the page's scripts read; bodies are referred to by number, the ground by -1.

    normal: of the plane of a planar motion, (3,); None: the common axis of the pins, if they have one
    """
    body_numbers = {body.name: k for k, body in enumerate(machine.bodies)} | {GROUND: -1}
    topologies = Topologies()
    rolling = {wheel.wheel.body for wheel in spec.rolling.values()}
    bodies = [
        {"caption": describe_object("bodies", body.name, labels)}
        | _make_body(body, results, topologies, body.name in rolling)
        for body in machine.bodies
    ]
    joint_numbers = {joint.name: k for k, joint in enumerate(machine.joints)}
    belts = {belt.name for belt in machine.belts}
    ropes = {name for name, joint in spec.joints.items() if joint.tension_only}
    return {
        "bodies": bodies,
        "topologies": topologies.to_lists(),
        "joints": [
            {"name": joint.name, "caption": describe_object("joints", joint.name, labels), "kind": joint.kind}
            | _pack_ends(joint, body_numbers)
            | {"axis": _to_floats(joint.axis), "rope": joint.name in ropes}
            for joint in machine.joints
        ],
        "lines": [
            {"name": line.name, "kind": _find_line_symbol(line, spec)} | _pack_ends(line, body_numbers)
            for line in machine.lines
        ],
        "paths": [pack_points(path) for path in machine.paths],
        "belts": [{"body": body_numbers[belt.carrier], "strands": pack_points(belt.strands)} for belt in machine.belts],
        "ropes": [_make_rope(rope, poses, body_numbers) for rope in machine.ropes],
        "marks": [_make_mark(mark, poses) for mark in machine.marks],
        "acting": [
            {"joint": joint_numbers[joint_load.joint], "symbols": joint_load.symbols, "slides": joint_load.slides}
            for joint_load in machine.joint_symbols
        ],
        "symbols": {name: _make_symbol(name) for name in sorted(_collect_symbols(machine))},
        "ground": [{"name": name, "at": _to_floats(point)} for name, point in machine.ground_points.items()],
        "gravity": _to_floats(np.array(spec.gravity)),
        "pulls": [
            _make_coupling_force(pull, belts, labels)
            for pull in iter_coupling_forces(machine, poses, results.couplings)
        ],
        "normal": _find_common_pin_axis(machine, poses) if normal is None else _to_floats(normal),
        **_compute_extent(machine, poses),
    }


def _find_line_symbol(line: LineGeometry, spec: Spec) -> str:
    """Find the symbol of a load between two points; that of a damped one may differ."""
    is_damped = bool(getattr(spec.forces[line.name], "damping", 0.0))
    return LOAD_KINDS[line.kind].symbols[-1 if is_damped else 0]


def _to_floats(vector: Array) -> list[float]:
    return [float(component) for component in vector]


def _make_body(body: BodyGeometry, results: Results, topologies: Topologies, is_rolling: bool) -> dict[str, Any]:
    """Make a body's entry: its poses, and its surfaces, bars, lines and points in body axes.

    is_rolling: whether the body is a wheel or a ball; then two edges of each sphere are drawn, which show its rotation
    """
    pose = results.bodies[body.name]
    rolling_edges = [
        edge for surface in body.surfaces if is_rolling and surface.ball is not None for edge in surface.edges[:2]
    ]
    return {
        "name": body.name,
        "places": pack_points(pose["position"]),
        "attitudes": pack_points(pose["quaternion"], 4),
        "surfaces": [_make_surface(surface, topologies) for surface in body.surfaces],
        "bars": [pack_points(line) for line in body.bars],
        "lines": [pack_points(line) for line in (*body.lines, *body.pitch_circles, *rolling_edges)],
        "points": [{"name": name, "at": _to_floats(point)} for name, point in body.points.items()],
    }


def _make_surface(surface: Surface, topologies: Topologies) -> dict[str, Any]:
    """Make a surface's entry: corners and faces; for a sphere only its center and radius."""
    if surface.ball is not None:
        centre, radius = surface.ball
        return {"ball": {"center": _to_floats(np.array(centre)), "radius": float(radius)}}
    return {"corners": pack_points(surface.corners), "faces": topologies.register(surface.faces)}


def _make_rope(rope: RopeGeometry, poses: Poses, body_numbers: Mapping[str, int]) -> dict[str, Any]:
    """Make a rope's entry: the ends of its spans at all frames, and the arcs between the spans."""
    return {
        "name": rope.name,
        "count": len(rope.spans),
        "ends": pack_points(compute_span_ends(rope, poses), 6 * len(rope.spans)),
        "arcs": [
            {
                "before": arc.span, "body": body_numbers[arc.body], "center": _to_floats(arc.centre),
                "along": body_numbers[arc.axis_body], "axis": _to_floats(arc.axis),
            }
            for arc in rope.arcs
        ],
    }  # fmt: skip


def _make_mark(mark: Mark, poses: Poses) -> dict[str, Any]:
    """Make a symbol's entry: its position and direction at all frames, or only once if it does not move."""
    places, directions = mark.locate(poses)
    count = 1 if is_constant(places) and is_constant(directions) else None
    return {
        "symbol": mark.symbol,
        "name": mark.name,
        "places": pack_points(places[:count]),
        "ways": pack_points(directions[:count]),
    }


def is_constant(vectors: Array) -> bool:
    """Return whether all vectors (n, 3) are equal to the precision of the drawing."""
    return bool(np.abs(vectors - vectors[0]).max() <= DRAWN_PRECISION * float(np.abs(vectors[0]).max()))


def _make_coupling_force(pull: CouplingForce, belts: Collection[str], labels: Labels) -> dict[str, Any]:
    """Make the entry of a coupling force ON a body: its point of action at all frames, and the row of its values.

    The pulls of a belt's strands are included as vectors, because no row holds the direction of each.
    """
    is_belt = pull.name in belts
    quantity = "tight" if is_belt else f"on.{pull.body}.force"
    coupling, body = describe_object("couplings", pull.name, labels), describe_object("bodies", pull.body, labels)
    return {
        "name": pull.name,
        "caption": f"{coupling} on {body}",
        "row": f"couplings.{pull.name}.{quantity}",
        "at": pack_points(pull.points),
        "forces": pack_points(pull.forces) if is_belt else None,
    }


def _collect_symbols(machine: Machine) -> set[str]:
    """Collect the names of all symbols that the page draws."""
    return {mark.symbol for mark in machine.marks} | {
        name for joint_load in machine.joint_symbols for name in joint_load.symbols
    }


def _make_symbol(name: str) -> list[dict[str, Any]]:
    """Make the parts of a symbol, in pixels."""
    return [{"points": part.points, "closed": part.is_closed, "fill": part.fill} for part in SYMBOLS[name].parts]


def collect_corners(body: BodyGeometry) -> Array:
    """Collect all points that are drawn of a body, (n, 3), body axes."""
    parts = [*(s.corners for s in body.surfaces), *body.strokes, *(p[None] for p in body.points.values())]
    return np.concatenate([np.zeros((0, 3)), *parts]) if parts else np.zeros((1, 3))


def _compute_extent(machine: Machine, poses: Poses) -> dict[str, Any]:
    """Compute center and half edges of a box that holds the machine at all frames, and the radius of a ball [m].

    Points of the ground that are farther away than the machine is large do not count.
    """
    instants = np.linspace(0, len(poses.times) - 1, min(len(poses.times), MAX_EXTENT_FRAMES)).round().astype(int)
    bodies = [
        poses.locate_points(body.name, collect_corners(body), k) for body in machine.bodies for k in instants.tolist()
    ]
    centre, _, radius = _enclose(np.concatenate(bodies)) if bodies else (np.zeros(3), np.zeros(3), math.inf)
    clouds = [point[None] for point in machine.ground_points.values()]
    clouds += machine.paths
    clouds += [compute_span_ends(rope, poses).reshape(-1, 3) for rope in machine.ropes]
    clouds += [mark.locate(poses)[0] for mark in machine.marks]
    clouds += [joint.p[None] for joint in machine.joints if joint.a == GROUND]
    clouds += [joint.q[None] for joint in machine.joints if joint.b == GROUND]
    around = np.concatenate([np.zeros((0, 3)), *clouds])
    near = around[np.sqrt(((around - centre) ** 2).sum(axis=1)) <= 2.0 * (radius or math.inf)]
    centre, half, radius = _enclose(np.concatenate([*bodies, near]))
    return {"center": _to_floats(centre), "half": _to_floats(half), "radius": radius or 1.0}


def _enclose(cloud: Array) -> tuple[Array, Array, float]:
    """Compute center and half edges of the box of points (n, 3), and the largest distance from its center."""
    low, high = cloud.min(axis=0), cloud.max(axis=0)
    centre = 0.5 * (low + high)
    return centre, 0.5 * (high - low), float(np.sqrt(((cloud - centre) ** 2).sum(axis=1).max()))


def _find_common_pin_axis(machine: Machine, poses: Poses) -> list[float] | None:
    """Find the direction to which all pin axes are parallel, world axes, or None; the motion is in the plane across."""
    axes = []
    for joint in machine.joints:
        if joint.kind == "pin":
            axis = joint.axis / np.linalg.norm(joint.axis)
            axes.append(axis if joint.a == GROUND else poses.orientations[joint.a][0] @ axis)
    if not axes or any(np.linalg.norm(np.cross(axes[0], axis)) > tolerances.PARALLEL for axis in axes[1:]):
        return None
    return _to_floats(axes[0])
