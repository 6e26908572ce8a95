"""A scene in which bodies are part of others, or of the ground: the same tree, joints and loads, seen from there.

    x_S = R_SB x_B + p_SB        a point of body B in the axes of the body S, or of the ground, that it is part of
A joint's axes turn with its body, and so does the attitude at which its angle is zero: R_ref' = R_SA R_ref R_SB^T, so
that all its coordinates stay what they were; only where a plane's two directions are chosen anew do the coordinates
along them turn. A joint between two points of one body is gone, and what acts in it acts on the ground.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base.records import record, replace
from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.mechanism.couplings import Coupling
from heuncli.multibody.mechanism.model import (
    GROUND,
    Blow,
    Body,
    BushingLoad,
    Joint,
    JointLoad,
    Load,
    Mechanism,
    NamedPoint,
    PairLoad,
    PointLoad,
)
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.pack import lay_out
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.spanning import Hang, Spanning
from heuncli.multibody.tree.starts import GivenTree, JointStart
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression


@record
class PlaceInBody:
    """Where a body stands in what it is part of: that body (-1: the ground), its attitude R and origin p there."""

    body: int
    R: Array
    p: Array

    def point(self, x: Array) -> Array:
        """A point of the body."""
        return np.asarray(self.R @ x + self.p)

    def holds(self, inner: PlaceInBody) -> PlaceInBody:
        """Where a body stands that stands so in this one."""
        return PlaceInBody(self.body, self.R @ inner.R, self.point(inner.p))


WHOLE = PlaceInBody(GROUND, np.eye(3), np.zeros(3))  # the ground in itself


@record
class Parts:
    """Of each body what it is part of, by its number in the larger scene; roots: the bodies that are not in others.

    A part's body is numbered as in the larger scene.
    """

    of: tuple[PlaceInBody, ...]
    roots: tuple[int, ...]

    def at(self, body: int) -> PlaceInBody:
        """Of a body, or of the ground."""
        return WHOLE if body == GROUND else self.of[body]

    def inside(self, joint: Joint) -> bool:
        """Whether both ends of a joint are points of one body."""
        return self.at(joint.a).body == self.at(joint.b).body

    def holds_all(self, own: Coupling) -> bool:
        """Whether all that a coupling looks at is of one body."""
        return len({self.at(i).body for i in own.ends}) == 1


def restated(scene: PreparedScene, parts: Parts, bodies: Sequence[Body]) -> PreparedScene:
    """The scene of those bodies that are roots, in the state in which the larger one starts (but for y0)."""
    mechanism, layout, start = scene.mechanism, scene.layout, scene.start
    number = {old: new for new, old in enumerate(parts.roots)} | {GROUND: GROUND}
    left = [k for k, joint in enumerate(mechanism.joints) if not parts.inside(joint)]
    joint_number = {k: n for n, k in enumerate(left)}
    smaller = replace(
        mechanism,
        bodies=tuple(bodies),
        joints=tuple(joint_of(layout, parts, number, k) for k in left),
        loads=tuple(load_of(load, parts, number, joint_number) for load in mechanism.loads),
        blows=tuple(blow_of(blow, parts, number) for blow in mechanism.blows),
        stops=tuple(replace(stop, joint=joint_number[stop.joint]) for stop in mechanism.stops),
        points={name: point_of(point, parts, number) for name, point in mechanism.points.items()},
        couplings=couplings_of(layout, parts, number, joint_number) if mechanism.couplings else (),
    )
    idle = tuple(replace(spin, body=number[spin.body]) for spin in scene.idle if spin.body in number)
    inertias = np.array([body.inertia for body in bodies]).reshape(-1, 3, 3)
    for spin in idle:
        inertias[spin.body] += spin.lent
    own = list(parts.roots)
    begun = replace(
        start, position=start.position[own], rotation=start.rotation[own], velocity=start.velocity[own],
        angular_velocity=start.angular_velocity[own],
    )  # fmt: skip
    tree = tree_of(layout, parts, number, joint_number)
    laid_out = lay_out(smaller, begun, inertias, layout.size, layout.work_at >= 0, tree)
    return PreparedScene(smaller, begun, idle, laid_out)


def tree_of(layout: Layout, parts: Parts, number: dict[int, int], joint_number: dict[int, int]) -> GivenTree:
    """The tree of the smaller scene: the larger one's without the bodies that have become part of others."""
    hangs = [
        Hang(number[h.body], number[parts.at(h.parent).body], joint_number.get(h.joint, -1), h.reverse)
        for h in layout.spanning.hangs
        if h.body in number
    ]
    cut = tuple(joint_number[k] for k in layout.spanning.cut if k in joint_number)
    starts = tuple(start_of(layout, parts, k) for k in joint_number)
    return GivenTree(Spanning(tuple(hangs), cut), starts)


def start_of(layout: Layout, parts: Parts, k: int) -> JointStart:
    """Where a joint stands at the start, its attitude between what its bodies are part of."""
    joint, start = layout.mechanism.joints[k], layout.starts[k]
    return replace(start, R_ref=parts.at(joint.a).R @ start.R_ref @ parts.at(joint.b).R.T)


def joint_of(layout: Layout, parts: Parts, number: dict[int, int], k: int) -> Joint:
    """A joint between what its bodies are part of; a rod keeps the length that it has."""
    joint = layout.mechanism.joints[k]
    a, b = parts.at(joint.a), parts.at(joint.b)
    length = joint.length
    if length is None and k in layout.rows:
        row = layout.tables["closures"][layout.rows.index(k)]
        length = float(row["length"]) if row["kind"] == kernel.ROD else None
    return replace(
        joint, a=number[a.body], p=a.point(joint.p), axis=a.R @ joint.axis,
        b=number[b.body], q=b.point(joint.q), to_axis=b.R @ joint.to_axis, length=length,
        path=None if joint.path is None else joint.path.turned(a.R),
    )  # fmt: skip


def load_of(load: Load, parts: Parts, number: dict[int, int], joint_number: dict[int, int]) -> Load:
    """A load on what its bodies are part of."""
    if isinstance(load, PointLoad):
        part = parts.at(load.body)
        point = None if load.point is None else part.point(load.point)
        vector = turned(part, load) if load.in_body else load.vector
        return replace(load, body=number[part.body], point=point, vector=vector)
    if isinstance(load, PairLoad):
        a, b = parts.at(load.a), parts.at(load.b)
        return replace(load, a=number[a.body], p=a.point(load.p), b=number[b.body], q=b.point(load.q))
    if isinstance(load, BushingLoad):
        a, b = parts.at(load.a), parts.at(load.b)
        return replace(
            load, a=number[a.body], p=a.point(load.p), frame=a.R @ load.frame,
            b=number[b.body], q=b.point(load.q), to_frame=b.R @ load.to_frame,
        )  # fmt: skip
    assert isinstance(load, JointLoad), load  # scenes with ropes, threads that rub are moved as given (compose.py)
    if load.joint in joint_number:
        return replace(load, joint=joint_number[load.joint])
    nothing = Expression.of(0.0)
    value = load.value if load.kind == "torque" and load.value is not None else nothing
    return PointLoad(load.name, "couple", GROUND, None, (value, nothing, nothing), False)


def couplings_of(
    layout: Layout, parts: Parts, number: dict[int, int], joint_number: dict[int, int]
) -> tuple[Coupling, ...]:
    """The couplings between what their bodies are part of; no joint whose coordinate they count is inside a body."""
    from heuncli.multibody.reduction.restated_couplings import SeenFrom, couplings_seen  # few scenes have them

    seen = SeenFrom(
        body=lambda i: number[parts.at(i).body],
        joint=lambda k: joint_number[k],
        point=lambda i, p: parts.at(i).point(np.asarray(p)),
        direction=lambda i, e: np.asarray(parts.at(i).R @ np.asarray(e)),
    )
    return couplings_seen(layout, lambda own: seen)


def turned(part: PlaceInBody, load: PointLoad) -> tuple[Expression, Expression, Expression]:
    """The components of a load that is fixed in a body in the axes of what it is part of.

    What is not constant can stand in the same axes only, or on the ground, which it does not move (`bound_to_axes`).
    """
    constants = [value.constant for value in load.vector]
    if None in constants or np.array_equal(part.R, np.eye(3)):
        return load.vector
    x, y, z = (part.R @ np.array(constants, dtype=float)).tolist()
    return Expression.of(x), Expression.of(y), Expression.of(z)


def bound_to_axes(mechanism: Mechanism) -> set[int]:
    """The bodies with loads that vary and are fixed in their axes: only in those can such loads be stated."""
    return {
        load.body
        for load in mechanism.loads
        if isinstance(load, PointLoad) and load.in_body and any(value.constant is None for value in load.vector)
    }


def point_of(point: NamedPoint, parts: Parts, number: dict[int, int]) -> NamedPoint:
    """A point that expressions name on what its body is part of."""
    part = parts.at(point.body)
    return replace(point, body=number[part.body], place=part.point(point.place))


def blow_of(blow: Blow, parts: Parts, number: dict[int, int]) -> Blow:
    """A blow on what its body is part of."""
    part = parts.at(blow.body)
    point = None if blow.point is None else part.point(blow.point)
    vector = part.R @ blow.vector if blow.in_body else blow.vector
    return replace(blow, body=number[part.body], point=point, vector=vector)
