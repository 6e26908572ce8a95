"""Place bodies outward from the held ones, one after another, each by one joint, in linear time.

Each joint first turns the body it reaches by the smallest turn needed, about the body's pivot (the centre of mass; the
origin where the position is held), then shifts it by the least amount. A placed body is not moved again.

A loop drawn closed is turned from the drawing to its held or driven coordinates. A loop usually closes in several ways,
and the way that needs the smallest rotations may lie beyond a dead centre. So its coordinates move to their prescribed
values in small steps, as the machine would be cranked, and it is closed at each.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record, replace
from heuncli.multibody.assembly.conditions import JointCondition, JointConstraint
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import orthonormalize, rotation_between, rotation_matrix_about

# Walk


@record
class PlacementTree:
    """The order in which bodies are reached, roots first.

    order: bodies as reached
    tree_joint[body]: index of the joint, -1 for a root
    parent[body]: the body before, -1 for the ground or a root (tree_joint shows which)
    depth[body]: joints between it and its root
    """

    order: list[int]
    tree_joint: list[int]
    parent: list[int]
    depth: list[int]


def find_placement_tree(
    mechanism: Mechanism, constraints: Sequence[tuple[int, int, JointConstraint]],
    is_held: Sequence[bool], is_preferred: Sequence[bool],
) -> PlacementTree:  # fmt: skip
    """Search breadth first from the ground and the held bodies, through strong joints before line, plane and rod.

    A connected part without ground or held body starts from a preferred body, else one that is `to` of no joint, else
    the heaviest. Ties are decided by name, not by the order of the file.
    """
    n, names = len(mechanism.bodies), [j.name for j in mechanism.joints]
    links: list[list[tuple[int, int, bool]]] = [[] for _ in range(n + 1)]
    is_to = [False] * (n + 1)
    for k in sorted(range(len(constraints)), key=names.__getitem__):
        a, b, condition = constraints[k]
        if condition.hold == "none":
            continue
        links[a].append((k, b, condition.is_strong))
        links[b].append((k, a, condition.is_strong))
        is_to[b] = True

    order: list[int] = []
    via, parent, depth = [-1] * n, [-1] * n, [0] * n
    reached = [False] * n + [True]
    strong: deque[int] = deque()
    weak: deque[tuple[int, int, int]] = deque()

    def reach(body: int, k: int, parent_body: int) -> None:
        reached[body] = True
        order.append(body)
        strong.append(body)
        if k >= 0:
            via[body], parent[body], depth[body] = k, parent_body, 1 + (depth[parent_body] if parent_body >= 0 else 0)

    def spread() -> None:
        while strong or weak:
            if strong:
                body = strong.popleft()
                for k, other, is_strong in links[body]:
                    if reached[other]:
                        continue
                    if is_strong:
                        reach(other, k, body)
                    else:
                        weak.append((k, body, other))
            else:
                k, body, other = weak.popleft()
                if not reached[other]:
                    reach(other, k, body)

    bodies = mechanism.bodies
    strong.append(-1)
    for i in sorted((i for i in range(n) if is_held[i]), key=lambda i: bodies[i].name):
        reach(i, -1, -1)
    spread()
    unreached = (i for i in range(n) if not reached[i])
    for i in sorted(unreached, key=lambda i: (not is_preferred[i], is_to[i], -bodies[i].mass, bodies[i].name)):
        if not reached[i]:
            reach(i, -1, -1)
            spread()
    return PlacementTree(order, via, parent, depth)


@record
class AssemblyPoses:
    """Poses of the bodies while they are assembled; its arrays are written to. The last row is the ground.

    x (n+1, 3): origins
    R (n+1, 3, 3): attitudes
    pivot (n+1, 3): the point that turns are about, body axes
    shifts, turns: which bodies may shift, and turn
    """

    x: Array
    R: Array
    pivot: Array
    shifts: list[bool]
    turns: list[bool]

    def copy(self) -> AssemblyPoses:
        """Copy the poses; pivots and the flags of what may move are shared."""
        return AssemblyPoses(self.x.copy(), self.R.copy(), self.pivot, self.shifts, self.turns)

    def set_attitude(self, body: int, new: Array) -> None:
        """Set the attitude of a body; its pivot stays."""
        new = orthonormalize(new)
        self.x[body] += (self.R[body] - new) @ self.pivot[body]
        self.R[body] = new


def start_poses(mechanism: Mechanism) -> AssemblyPoses:
    """Return the poses as held, else at near, else as drawn."""
    n = len(mechanism.bodies)
    x, R, pivot = np.zeros((n + 1, 3)), np.tile(np.eye(3), (n + 1, 1, 1)), np.zeros((n + 1, 3))
    for i, b in enumerate(mechanism.bodies):
        place = b.position if b.position is not None else b.near_position
        attitude = b.rotation if b.rotation is not None else b.near_rotation
        if place is not None:
            x[i] = place
        if attitude is not None:
            R[i] = attitude
        if b.position is None:
            pivot[i] = b.center
    return AssemblyPoses(
        x, R, pivot,
        [b.position is None for b in mechanism.bodies] + [False],
        [b.rotation is None for b in mechanism.bodies] + [False],
    )  # fmt: skip


def place_body(poses: AssemblyPoses, d: JointCondition, body: int) -> None:
    """Turn and shift the body at one end of a joint so that it fits the body at the other, as far as it may move."""
    R, x = poses.R, poses.x
    is_to = body == d.b
    if poses.turns[body] and d.pose.turn not in ("free", "alike"):
        poses.set_attitude(body, required_attitude(d, R[d.a], R[d.b], is_to))
    if poses.shifts[body]:
        D = (x[d.b] + R[d.b] @ d.q) - (x[d.a] + R[d.a] @ d.p)
        if d.path is not None:  # to the nearest place
            D = D - R[d.a] @ d.path.evaluate(d.path.find_nearest(R[d.a].T @ D))[0]
        shift = closing_shift(d, R[d.a] @ d.axis, D)
        x[body] += shift if is_to else -shift


def required_attitude(d: JointCondition, Ra: Array, Rb: Array, is_to: bool) -> Array:
    """Return the attitude of `to` (or of `from`) that satisfies the joint's turn condition, nearest to the present one,
    (3, 3).
    """
    if d.pose.turn == "all":
        return Ra @ d.relative if is_to else Rb @ d.relative.T
    n, m = Ra @ d.axis, Rb @ d.to_axis
    if not is_to:
        n, m = m, n
    if d.pose.turn == "square":
        n = _nearest_perpendicular(m, n)
    return rotation_between(m, n) @ (Rb if is_to else Ra)


def _nearest_perpendicular(m: Array, n: Array) -> Array:
    """Return the unit vector perpendicular to n nearest to m; where m is along n, toward a world axis."""
    s = m - (m @ n) * n
    size = float(np.sqrt(s @ s))
    if size < tolerances.PARALLEL:
        e = np.zeros(3)
        e[int(np.argmin(np.abs(n)))] = 1.0
        s = e - (e @ n) * n
        size = float(np.sqrt(s @ s))
    return s / size


def closing_shift(d: JointCondition, n: Array, D: Array) -> Array:
    """Return the least shift of the `to` point that closes the hold, (3,); n the axis, D from its place on `from`,
    world.
    """
    hold = d.pose.hold
    if hold in ("point", "curve"):
        return -D
    if hold == "line":
        return (n @ D) * n - D
    if hold == "plane":
        return -(n @ D) * n
    size = float(np.sqrt(D @ D))
    e = D / size if size > 0.0 else np.array([1.0, 0.0, 0.0])
    return (d.length - size) * e


def place_bodies(
    poses: AssemblyPoses, tree: PlacementTree, conditions: Sequence[JointCondition], only: Sequence[int] | None = None
) -> None:
    """Place the bodies of the tree outward, or `only` those given (in the order of the tree)."""
    for body in tree.order if only is None else only:
        if tree.tree_joint[body] >= 0:
            place_body(poses, conditions[tree.tree_joint[body]], body)


# Continuation

STEP = 0.1  # [rad], or of the lever: shorter than what separates the two ways to close but beside a dead centre
MOST_STEPS = 64


def prescribed_coordinates(mechanism: Mechanism, conditions: Sequence[JointCondition]) -> dict[int, tuple[bool, bool]]:
    """Return the joints with a prescribed coordinate: whether an angle, and whether a travel or length."""
    kinds = [JOINTS[j.kind] for j in mechanism.joints]
    prescribed = {
        k: (
            d.pose.turn == "all" != kind.turn.condition,
            d.pose.hold == "distance" or (d.pose.hold == "point" != kind.hold.gap_type and not kind.follows_path),
        )
        for k, (d, kind) in enumerate(zip(conditions, kinds, strict=True))
    }
    return {k: which for k, which in prescribed.items() if any(which)}


def iter_continuation(
    conditions: Sequence[JointCondition],
    prescribed: Mapping[int, tuple[bool, bool]],
    drawn_poses: AssemblyPoses,
    lever: float,
) -> Iterator[list[JointCondition]]:
    """Yield the conditions with the coordinates as drawn, then closer and closer to the prescribed values; last at
    these.

    prescribed: joints as in `prescribed_coordinates`

    Yields nothing if all are as drawn, or too far away for small steps.
    """
    offsets = {k: _coordinate_offset(conditions[k], which, drawn_poses) for k, which in prescribed.items()}
    count = math.ceil(
        max((max(abs(angle), abs(length) / lever) for angle, length in offsets.values()), default=0.0) / STEP
    )
    if not 1 <= count <= MOST_STEPS:
        return
    for i in range(count + 1):
        step_conditions = list(conditions)
        for k, (angle, length) in offsets.items():
            remaining = (count - i) / count
            step_conditions[k] = _shift_condition(conditions[k], remaining * angle, remaining * length)
        yield step_conditions


def _coordinate_offset(d: JointCondition, which: tuple[bool, bool], drawn_poses: AssemblyPoses) -> tuple[float, float]:
    """Return the angle [rad] and length [m] by which the coordinates of a joint exceed the prescribed ones, as
    drawn.
    """
    Ra, Rb = drawn_poses.R[d.a], drawn_poses.R[d.b]
    D = Ra.T @ (drawn_poses.x[d.b] + Rb @ d.q - drawn_poses.x[d.a]) - d.p
    angle = _angle(d.axis, Ra.T @ Rb @ d.relative.T) if which[0] else 0.0
    if not which[1]:
        return angle, 0.0
    return angle, float(np.sqrt(D @ D)) - d.length if d.pose.hold == "distance" else float(d.axis @ D)


def _shift_condition(d: JointCondition, angle: float, length: float) -> JointCondition:
    """Return the condition with its coordinates offset by an angle and a length."""
    relative = rotation_matrix_about(d.axis, angle) @ d.relative if angle else d.relative
    if d.pose.hold == "distance":
        return replace(d, relative=relative, length=d.length + length)
    return replace(d, relative=relative, p=d.p + length * d.axis)


def _angle(axis: Array, E: Array) -> float:
    """Angle by which E turns about the axis, -π to π."""
    sin = axis @ np.array([E[2, 1] - E[1, 2], E[0, 2] - E[2, 0], E[1, 0] - E[0, 1]])
    return math.atan2(float(sin), float(np.trace(E) - axis @ E @ axis))
