"""Make a scene in which bodies are part of others, or of the ground: the same tree, joints and loads in the new axes.

    x_S = R_SB x_B + p_SB        a point of body B in the axes of the body S, or of the ground, that it is part of

A joint's axes turn with its body, and so does the attitude at which its angle is zero: R_ref' = R_SA R_ref R_SB^T, so
that all its coordinates stay what they were; only where a plane's two directions are chosen again do the coordinates
along them turn. A joint between two points of one body is dropped, and loads in it act on the ground.

Couplings have the same conditions, between the bodies that theirs are part of there. Each of a part's points and
directions is fixed in one of its bodies, and is transformed as that body is. A condition that keeps its value at the
start keeps it here, too: its length stays.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from heuncli.base.records import record, replace
from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.mechanism.couplings import CamShape, CoupledRow, Coupling, CouplingPart, Place
from heuncli.multibody.mechanism.loads import GROUND, JointLoad, Load, Placement, PointLoad, TwoPointLoad
from heuncli.multibody.mechanism.model import Blow, Body, Joint, Mechanism, NamedPoint
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.pack import lay_out
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.spanning import SpanningTree, TreeLink
from heuncli.multibody.tree.starts import JointStart, PresetTree
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression

# Smaller scene


@record
class BodyPlacement:
    """Where a welded body sits in its compound body: that body (-1: the ground), its attitude R and origin p
    there.
    """

    body: int
    R: Array
    p: Array

    def transform_point(self, x: Array) -> Array:
        """Transform a point of the body."""
        return np.asarray(self.R @ x + self.p)

    def compose(self, inner: BodyPlacement) -> BodyPlacement:
        """Return the placement of a body that is itself placed in this one, in the outer compound body."""
        return BodyPlacement(self.body, self.R @ inner.R, self.transform_point(inner.p))


GROUND_PLACEMENT = BodyPlacement(GROUND, np.eye(3), np.zeros(3))  # the ground in itself


@record
class BodyParts:
    """The placement of each body in its compound body, by its number in the larger scene.

    roots: the bodies that are not part of others

    The bodies of placements are numbered as in the larger scene.
    """

    placements: tuple[BodyPlacement, ...]
    roots: tuple[int, ...]

    def get_placement(self, body: int) -> BodyPlacement:
        """Return the placement of a body, or of the ground."""
        return GROUND_PLACEMENT if body == GROUND else self.placements[body]

    def is_internal(self, joint: Joint) -> bool:
        """Return whether both ends of a joint are points of one body."""
        return self.get_placement(joint.a).body == self.get_placement(joint.b).body

    def contains_coupling(self, coupling: Coupling) -> bool:
        """Return whether all bodies of a coupling are parts of one body."""
        return len({self.get_placement(i).body for i in coupling.bodies_and_ground}) == 1


def make_smaller_scene(scene: PreparedScene, parts: BodyParts, bodies: Sequence[Body]) -> PreparedScene:
    """Make the scene of the bodies that are roots, in the state in which the larger one starts (except y0)."""
    mechanism, layout, start = scene.mechanism, scene.layout, scene.start
    number = {old: new for new, old in enumerate(parts.roots)} | {GROUND: GROUND}
    remaining = [k for k, joint in enumerate(mechanism.joints) if not parts.is_internal(joint)]
    joint_number = {k: n for n, k in enumerate(remaining)}
    smaller = replace(
        mechanism,
        bodies=tuple(bodies),
        joints=tuple(restate_joint(layout, parts, number, k) for k in remaining),
        loads=tuple(restate_load(load, parts, number, joint_number) for load in mechanism.loads),
        impulses=tuple(restate_impulse(blow, parts, number) for blow in mechanism.impulses),
        stops=tuple(replace(stop, joint=joint_number[stop.joint]) for stop in mechanism.stops),
        points={name: restate_point(point, parts, number) for name, point in mechanism.points.items()},
        couplings=restate_couplings(layout, parts, number, joint_number) if mechanism.couplings else (),
    )
    idle_spins = tuple(replace(spin, body=number[spin.body]) for spin in scene.idle_spins if spin.body in number)
    inertias = np.array([body.inertia for body in bodies]).reshape(-1, 3, 3)
    for spin in idle_spins:
        inertias[spin.body] += spin.artificial_inertia
    roots = list(parts.roots)
    smaller_start = replace(
        start, position=start.position[roots], rotation=start.rotation[roots], velocity=start.velocity[roots],
        angular_velocity=start.angular_velocity[roots],
    )  # fmt: skip
    tree = make_smaller_tree(layout, parts, number, joint_number)
    laid_out = lay_out(smaller, smaller_start, inertias, layout.size, layout.work_at >= 0, tree)
    return PreparedScene(smaller, smaller_start, idle_spins, laid_out)


def make_smaller_tree(
    layout: Layout, parts: BodyParts, number: dict[int, int], joint_number: dict[int, int]
) -> PresetTree:
    """Make the tree of the smaller scene: the larger one's without the bodies that have become part of others."""
    links = [
        TreeLink(
            number[link.body],
            number[parts.get_placement(link.parent).body],
            joint_number.get(link.joint, -1),
            link.reverse,
        )
        for link in layout.spanning.links
        if link.body in number
    ]
    cut = tuple(joint_number[k] for k in layout.spanning.cut if k in joint_number)
    starts = tuple(restate_joint_start(layout, parts, k) for k in joint_number)
    return PresetTree(SpanningTree(tuple(links), cut), starts)


def restate_joint_start(layout: Layout, parts: BodyParts, k: int) -> JointStart:
    """Return the start of a joint, with its attitude between the bodies that its own are part of."""
    joint, start = layout.mechanism.joints[k], layout.starts[k]
    return replace(start, R_ref=parts.get_placement(joint.a).R @ start.R_ref @ parts.get_placement(joint.b).R.T)


def restate_joint(layout: Layout, parts: BodyParts, number: dict[int, int], k: int) -> Joint:
    """Return a joint between the bodies that its own are part of; a rod keeps its length."""
    joint = layout.mechanism.joints[k]
    a, b = parts.get_placement(joint.a), parts.get_placement(joint.b)
    length = joint.length
    if length is None and k in layout.rows:
        row = layout.tables["closures"][layout.rows.index(k)]
        length = float(row["length"]) if row["kind"] == kernel.ROD else None
    return replace(
        joint, a=number[a.body], p=a.transform_point(joint.p), axis=a.R @ joint.axis,
        b=number[b.body], q=b.transform_point(joint.q), to_axis=b.R @ joint.to_axis, length=length,
        path=None if joint.path is None else joint.path.rotate(a.R),
    )  # fmt: skip


def restate_load(load: Load, parts: BodyParts, number: dict[int, int], joint_number: dict[int, int]) -> Load:
    """Return the load acting on compound bodies instead of their parts."""
    if isinstance(load, PointLoad):
        part = parts.get_placement(load.body)
        point = None if load.point is None else part.transform_point(load.point)
        vector = rotate_load(part, load) if load.in_body else load.vector
        return replace(load, body=number[part.body], point=point, vector=vector)
    if isinstance(load, TwoPointLoad):
        own = ((parts.get_placement(body), point) for body, point in load.points)
        return load.move(*(Placement(number[part.body], part.transform_point(point), part.R) for part, point in own))
    assert isinstance(load, JointLoad), load  # scenes with ropes, threads that rub are moved as given (compose.py)
    if load.joint in joint_number:
        return replace(load, joint=joint_number[load.joint])
    zero = Expression.from_number(0.0)
    value = load.value if not load.row.opposed_motion and load.value is not None else zero
    return PointLoad(load.name, "couple", GROUND, None, (value, zero, zero), False)


def restate_couplings(
    layout: Layout, parts: BodyParts, number: dict[int, int], joint_number: dict[int, int]
) -> tuple[Coupling, ...]:
    """Return the couplings between the bodies that theirs are part of; no joint that they count is inside a body."""

    transform = SceneTransform(
        body=lambda i: number[parts.get_placement(i).body],
        joint=lambda k: joint_number[k],
        point=lambda i, p: parts.get_placement(i).transform_point(np.asarray(p)),
        direction=lambda i, e: np.asarray(parts.get_placement(i).R @ np.asarray(e)),
    )
    return transform_couplings(layout, lambda own: transform)


def rotate_load(part: BodyPlacement, load: PointLoad) -> tuple[Expression, Expression, Expression]:
    """Return the components of a body-fixed load in the axes of the compound body.

    A load that varies can only be expressed in the same axes, or on the ground, which it does not move
    (`bodies_with_varying_loads`).
    """
    constants = [value.constant for value in load.vector]
    if None in constants or np.array_equal(part.R, np.eye(3)):
        return load.vector
    x, y, z = (part.R @ np.array(constants, dtype=float)).tolist()
    return Expression.from_number(x), Expression.from_number(y), Expression.from_number(z)


def bodies_with_varying_loads(mechanism: Mechanism) -> set[int]:
    """Return the bodies with loads that vary and are fixed in their axes: such loads can only be expressed in these."""
    return {
        load.body
        for load in mechanism.loads
        if isinstance(load, PointLoad) and load.in_body and any(value.constant is None for value in load.vector)
    }


def restate_point(point: NamedPoint, parts: BodyParts, number: dict[int, int]) -> NamedPoint:
    """Return a point that expressions use, on the compound body instead of its part."""
    part = parts.get_placement(point.body)
    return replace(point, body=number[part.body], place=part.transform_point(point.place))


def restate_impulse(impulse: Blow, parts: BodyParts, number: dict[int, int]) -> Blow:
    """Return the impulse acting on the compound body instead of its part."""
    part = parts.get_placement(impulse.body)
    point = None if impulse.point is None else part.transform_point(impulse.point)
    vector = part.R @ impulse.vector if impulse.in_body else impulse.vector
    return replace(impulse, body=number[part.body], point=point, vector=vector)


# Restated couplings

CARRIED = frozenset(("mesh", "cam"))  # kinds whose points and directions are of a third body
SECOND_IN_B = frozenset(("dot", "touches", "rolls", "rolls_aside"))  # and those whose second direction is of b


def point_body(part: CouplingPart) -> int:
    """Return the body in which a part's point p is fixed."""
    return part.c if part.kind in CARRIED else part.a


def first_direction_body(part: CouplingPart) -> int:
    """Return the body in which its direction e is fixed."""
    return part.c if part.kind in CARRIED or part.kind == "wound" else part.a


def second_direction_body(part: CouplingPart) -> int:
    """Return the body in which its direction g is fixed."""
    return part.b if part.kind in SECOND_IN_B else first_direction_body(part)


@record
class SceneTransform:
    """Transforms points, vectors and loads fixed in bodies of a scene to the bodies of a smaller one.

    body, joint: the smaller scene's numbers from the larger one's
    point, direction: transform a body's point or direction
    """

    body: Callable[[int], int]
    joint: Callable[[int], int]
    point: Callable[[int, Place], Array]
    direction: Callable[[int, Place], Array]


def transform_couplings(layout: Layout, transform_for: Callable[[Coupling], SceneTransform]) -> tuple[Coupling, ...]:
    """Transform the couplings of a scene; transform_for: returns the transformation for a coupling."""
    mechanism = layout.mechanism
    lengths = layout.tables["closures"]["length"].tolist() if mechanism.couplings else []
    couplings = []
    for owner, coupling in enumerate(mechanism.couplings, len(mechanism.joints)):
        first_row, transform = layout.rows.index(owner), transform_for(coupling)
        rows = tuple(_transform_row(row, lengths[first_row + k], transform) for k, row in enumerate(coupling.rows))
        held = coupling.friction_row and _transform_row(coupling.friction_row, 0.0, transform)
        couplings.append(replace(coupling, rows=rows, friction_row=held))
    return tuple(couplings)


def _transform_row(row: CoupledRow, length: float, transform: SceneTransform) -> CoupledRow:
    return replace(row, length=length, parts=tuple(transform_part(part, transform) for part in row.parts))


def transform_part(part: CouplingPart, transform: SceneTransform) -> CouplingPart:
    """Transform a part of a coupling."""
    cam = None if part.cam is None else _transform_cam(part.cam, part, transform)
    return replace(
        part,
        a=transform.body(part.a),
        b=transform.body(part.b),
        c=transform.body(part.c),
        p=transform.point(point_body(part), part.p),
        q=transform.point(part.b, part.q),
        e=transform.direction(first_direction_body(part), part.e),
        g=part.g
        if part.kind == "strand"
        else transform.direction(second_direction_body(part), part.g),  # of a strand no direction
        coordinates=tuple(x._replace(joint=transform.joint(x.joint)) for x in part.coordinates),
        separating_force=transform.direction(part.c, part.separating_force),
        other_axis=transform.direction(part.b, part.other_axis),
        on_a=None if part.on_a is None else transform.point(part.c, part.on_a),
        cam=cam,
    )


def _transform_cam(cam: CamShape, part: CouplingPart, transform: SceneTransform) -> CamShape:
    face = None if cam.face is None else transform.direction(part.b, cam.face)
    return replace(cam, pivot=transform.point(part.c, cam.pivot), face=face)
