"""The geometry of a scene: shapes of its bodies in their own axes, and where joints, springs, ropes, symbols are.

Everything is in body axes [m]; positions in the world follow from the body's pose. A body with shapes is drawn as these
shapes, with arms to points outside of them. A body without shapes is drawn as the wheel that it is, or by its points
and its centre of mass: as the link between two of them, or as the plate or solid that more of them span.

The force of a coupling is drawn ON each loaded body, at a point of its line of action:

    at = P + F x M / |F|^2        point of a force F whose moment about P is M, without the component of M along F
A force whose counterpart acts at the same point on another body is drawn once, on the body that is listed first. For a
belt the pulls of both strands on the second pulley are drawn: their sum with the pretension is the bearing load.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.output.machine_geometry.discs import BeltGeometry, Disc, PitchPoint, iter_balls
from heuncli.output.machine_geometry.elements import ElementGeometry, collect_elements
from heuncli.output.machine_geometry.marks import JointSymbol, Mark, iter_joint_symbols, iter_marks
from heuncli.output.machine_geometry.poses import Poses
from heuncli.output.machine_geometry.ropes import RopeGeometry, collect_ropes
from heuncli.output.machine_geometry.solids import (
    ROUND_FACES,
    Surface,
    find_nearest_place,
    make_hull,
    make_surfaces,
)
from heuncli.results.results import Array
from heuncli.scene.file_format.models import PairForce, Shape, Spec
from heuncli.scene.file_format.names import GROUND

MIN_LINKED_DISCS = 2  # discs: from this number on, a body without shapes is drawn as a line between them
OUTSIDE_TOLERANCE = 1e-9  # of the distance of a point from a shape's axis; less is rounding
RELATIVE_TOLERANCE = 1e-9  # of the largest force or coordinate: below it, sums of forces and distances count as zero


class BodyGeometry(NamedTuple):
    """The geometry of a body, in its axes.

    points: the named points, (3,) each
    surfaces: those of its shapes; without shapes, of the hull of its points
    lines: drawn on it: rims, spokes, threads, outlines of cams
    bars: lines between its points, or from these to its shapes, which stand for the body itself
    pitch_circles: closed lines of its gears, where these are not the surfaces themselves
    """

    name: str
    points: Mapping[str, Array]
    surfaces: tuple[Surface, ...]
    lines: tuple[Array, ...]
    bars: tuple[Array, ...] = ()
    pitch_circles: tuple[Array, ...] = ()

    @property
    def strokes(self) -> tuple[Array, ...]:
        """Its bars, its lines and its pitch circles."""
        return (*self.bars, *self.lines, *self.pitch_circles)


class JointGeometry(NamedTuple):
    """A joint: its kind in the spec, its ends (body, point in body axes), its axis in the axes of the `from` body."""

    name: str
    kind: str
    a: str
    p: Array
    b: str
    q: Array
    axis: Array


class LineGeometry(NamedTuple):
    """A load or link between two points; its kind is that of the load, or of the joint."""

    name: str
    kind: str
    a: str
    p: Array
    b: str
    q: Array


class Machine(NamedTuple):
    """The geometry of a whole scene.

    ground_points: named points of the ground
    paths: lines on the ground, along which points run, and circles
    belts, ropes: what does not move with one body
    marks: symbols with a position of their own
    joint_symbols: of drives and loads in joints
    pitch_points: where gears mesh
    """

    title: str
    bodies: tuple[BodyGeometry, ...]
    joints: tuple[JointGeometry, ...]
    lines: tuple[LineGeometry, ...]
    ground_points: Mapping[str, Array]
    paths: tuple[Array, ...] = ()
    belts: tuple[BeltGeometry, ...] = ()
    ropes: tuple[RopeGeometry, ...] = ()
    marks: tuple[Mark, ...] = ()
    joint_symbols: tuple[JointSymbol, ...] = ()
    pitch_points: tuple[PitchPoint, ...] = ()


def make_machine(spec: Spec, faces: int = ROUND_FACES, scene: PreparedScene | None = None) -> Machine:
    """Make the geometry of a loaded spec.

    faces: number of faces of round shapes about their axis
    scene: the spec as assembled; without it there are no ropes over sheaves and no marks
    """
    joints = tuple(
        JointGeometry(name, j.kind, j.a, np.array(j.p), j.b, np.array(j.q), np.array(j.axis))
        for name, j in spec.joints.items()
    )
    lines = tuple(
        LineGeometry(name, f.type, f.from_.body, np.array(f.from_.point), f.to.body, np.array(f.to.point))
        for name, f in spec.forces.items()
        if isinstance(f, PairForce)
    )
    elements = collect_elements(spec, None if scene is None else scene.mechanism)
    bodies = tuple(_make_body(name, spec, (joints, lines), elements, faces) for name in spec.bodies)
    ground_points = {name: np.array(point) for name, point in spec.ground.points.items()}
    paths = (*elements.lines.get(GROUND, ()), *(disc.rim for disc in elements.discs.get(GROUND, ())))
    joint_symbols = tuple(iter_joint_symbols(spec))
    machine = Machine(
        spec.title,
        bodies,
        joints,
        lines,
        ground_points,
        paths,
        elements.belts,
        joint_symbols=joint_symbols,
        pitch_points=elements.pitch_points,
    )
    if scene is None:
        return machine
    ropes = collect_ropes(scene.mechanism)
    return machine._replace(ropes=ropes, marks=tuple(iter_marks(spec, scene, ropes)))


def find_drawn_shapes(spec: Spec, body: str, discs: Sequence[Disc]) -> Sequence[Shape]:
    """Return the shapes that a body is drawn by: its own, or, if it has none, balls and discs of its wheels."""
    return spec.bodies[body].shapes or (*iter_balls(spec, body), *(disc.shape for disc in discs if disc.is_solid))


def _make_body(
    name: str,
    spec: Spec,
    connections: tuple[tuple[JointGeometry, ...], tuple[LineGeometry, ...]],
    elements: ElementGeometry,
    faces: int,
) -> BodyGeometry:
    """Make the geometry of a body.

    connections: joints and lines of the scene, whose ends on the body are drawn
    """
    body, discs = spec.bodies[name], elements.discs.get(name, ())
    points = {key: np.array(point, dtype=np.float64) for key, point in body.points.items()}
    ends = [connection.p for part in connections for connection in part if connection.a == name]
    ends += [connection.q for part in connections for connection in part if connection.b == name]
    ends += points.values()
    shapes = find_drawn_shapes(spec, name, discs)
    surfaces = tuple(surface for shape in shapes for surface in make_surfaces(shape, faces))
    rims = [disc for disc in discs if body.shapes or not disc.is_solid]
    spokes = (line for disc in discs if disc.has_spokes for line in disc.iter_spokes(surfaces))
    drawn_lines = (*elements.lines.get(name, ()), *(disc.rim for disc in rims if not disc.is_pitch_circle), *spokes)
    pitch_circles = tuple(disc.rim for disc in rims if disc.is_pitch_circle)
    centre = np.array(body.center, dtype=np.float64)
    if surfaces:
        ends += [np.array(shape.at) for shape in shapes if shape.type == "point"]
        is_linked = not body.shapes and len(discs) >= MIN_LINKED_DISCS
        bars = (_join_points([*ends, centre]),) if is_linked else tuple(_iter_arms(shapes, ends))
        return BodyGeometry(name, points, surfaces, drawn_lines, bars, pitch_circles)
    # for bodies of point masses, centre and inertia are not known yet, and not needed
    bar = _join_points([*ends, *([np.array(shape.at) for shape in shapes] or [centre])])
    hull = make_hull(bar) if not (drawn_lines or pitch_circles) else None
    if hull is not None:
        return BodyGeometry(name, points, (hull,), ())
    return BodyGeometry(name, points, (), drawn_lines, (bar,), pitch_circles)


def _iter_arms(shapes: Sequence[Shape], ends: Sequence[Array]) -> Iterator[Array]:
    """Yield lines (2, 3) to the points that lie outside all shapes, from the nearest shape that is not a point mass."""
    solid = [shape for shape in shapes if shape.type != "point"]
    for end in np.unique(np.array(ends).reshape(-1, 3), axis=0):
        start, gap = min((find_nearest_place(shape, end) for shape in solid), key=lambda found: found[1])
        if gap > OUTSIDE_TOLERANCE * float(np.linalg.norm(end - start)):
            yield np.array([start, end])


def _join_points(ends: list[Array]) -> Array:
    """Join points by a line (n, 3) that starts at an end of their longest distance and goes to the nearest remaining
    point.
    """
    points: Array = np.unique(np.round(np.array(ends, dtype=np.float64), 12), axis=0)
    if len(points) < 3:
        return points
    distances = np.linalg.norm(points[:, None] - points[None], axis=2)
    order = [int(np.unravel_index(np.argmax(distances), distances.shape)[0])]
    remaining = set(range(len(points))) - set(order)
    while remaining:
        order.append(min(remaining, key=lambda k: (distances[order[-1], k], k)))
        remaining.remove(order[-1])
    return np.asarray(points[order], dtype=np.float64)


class CouplingForce(NamedTuple):
    """A coupling's force ON a body or the ground: points of action and components, (n, 3), world axes.

    Components are nan where they are indeterminate.
    """

    name: str
    body: str
    points: Array
    forces: Array


def iter_coupling_forces(
    machine: Machine, poses: Poses, blocks: Mapping[str, Mapping[str, Any]]
) -> Iterator[CouplingForce]:
    """Yield the forces of all couplings at the instants of the poses.

    blocks: the results of the couplings, `couplings`
    """
    belts = {belt.name: belt for belt in machine.belts}
    for name, block in blocks.items():
        if name in belts:
            yield from _iter_belt_forces(belts[name], poses, block)
            continue
        unique_forces: list[CouplingForce] = []
        for body, values in block.get("on", {}).items():
            point, force, moment = (np.asarray(values[key]).reshape(-1, 3) for key in ("point", "force", "moment"))
            pull = CouplingForce(name, body, point + offset_to_line(force, moment), force)
            if np.any(force != 0.0) and not any(are_opposite(pull, other) for other in unique_forces):
                unique_forces.append(pull)
        yield from unique_forces


def offset_to_line(force: Array, moment: Array) -> Array:
    """Compute the vector (n, 3) from the moment's reference point to the force's line of action; zero where it is
    unknown.
    """
    square = np.sum(force * force, axis=1, keepdims=True)
    return np.nan_to_num(np.cross(force, moment) / np.where(square > 0.0, square, 1.0))


def are_opposite(first: CouplingForce, second: CouplingForce) -> bool:
    """Return whether two forces are opposite and act at the same point at all instants; they must be nan at the same
    ones.
    """
    size, reach = (float(np.abs(np.nan_to_num(x)).max()) for x in (second.forces, second.points))
    remainder, separation = first.forces + second.forces, first.points - second.points
    both_open = np.isnan(first.forces) & np.isnan(second.forces)
    balanced = np.abs(np.where(both_open, 0.0, remainder)) <= RELATIVE_TOLERANCE * size
    return bool(balanced.all() and (np.abs(separation) <= RELATIVE_TOLERANCE * reach).all())


def _iter_belt_forces(belt: BeltGeometry, poses: Poses, block: Mapping[str, Any]) -> Iterator[CouplingForce]:
    """Yield the pulls of both strands on the second pulley, each along its strand and away from the pulley."""
    if "tight" not in block:
        return
    driven = np.asarray(block["force"]).reshape(-1) >= 0.0
    tight, slack = (np.asarray(block[key]).reshape(-1) for key in ("tight", "slack"))
    for k, pull in enumerate((np.where(driven, tight, slack), np.where(driven, slack, tight))):
        point, far_end = belt.strands[k][:: 1 if k == 0 else -1]  # the first strand leaves the second pulley
        direction = poses.trace_direction(belt.carrier, (far_end - point) / np.linalg.norm(far_end - point))
        yield CouplingForce(
            belt.name, belt.pulley_bodies[1], poses.trace_point(belt.carrier, point), pull[:, None] * direction
        )
