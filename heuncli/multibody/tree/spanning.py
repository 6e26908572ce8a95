"""The tree that carries the motion: which joints are kept, which are cut, and in which order bodies come.

Breadth-first from the ground, so that paths stay short. A joint whose coordinate is driven, named in an expression or
limited by a stop is never cut. Next come the joints of a body without a mass to speak of, which only passes on what
they carry: cut off from what is behind it, roundings would throw it about. Not so where all of them leave it free to
spin, as a link on two balls: what it passes on does not turn it. Then what leaves nothing free, so that bodies welded
together hang on each other and, but for those, only circles of welds are cut. Joints that leave a thin body free to
turn about the axis without inertia are cut first, for there would be nothing behind that freedom; among the others of
one layer those that make most conditions are kept.
`line`, `plane` and `curve` carry a body only from their `from` side, a rod never does; a body that nothing carries
hangs on six freedoms of its own. So does one with a path whose runner is all that holds it. A curve is cut only where
none but curves, or what must not be cut, make a closed chain: several on one body, or one on a point that is held; and
where it may lift off.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Collection, Mapping

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record
from heuncli.multibody.mechanism.model import GROUND, Joint, Mechanism
from heuncli.results.results import Array


@record
class Hang:
    """How a body hangs in the tree: its joint (-1: free), and whether the body is the joint's `from` side."""

    body: int
    parent: int
    joint: int
    reverse: bool


@record
class Spanning:
    """Bodies, parents first, each with the joint it hangs on; and the joints that were cut."""

    hangs: tuple[Hang, ...]
    cut: tuple[int, ...]


def span(mechanism: Mechanism, kept: Collection[int]) -> Spanning:
    """The tree for a mechanism; `kept`: joints that must not be cut.

    Raises SolveError where those alone make a closed chain (over-driven).
    """
    edges = defaultdict(list)
    for k, joint in enumerate(mechanism.joints):
        if JOINTS[joint.kind].in_tree != "never":
            edges[joint.a].append(k)
            edges[joint.b].append(k)
    depth = _depths(mechanism, edges)
    free: list[int] = []
    while True:
        forest = _forest(mechanism, depth, kept, free)
        found = _walk(mechanism, forest, free)
        turned = None
        for k in (k for k in found.cut if mechanism.joints[k].path is not None):
            joint = mechanism.joints[k]
            closes = k not in forest[joint.b] or joint.b == GROUND or joint.a in free
            if closes and k in kept:
                raise SolveError(_found_from_pose(joint) if joint.one_sided else _path_unheld(joint))
            turned = turned if closes else joint.a
        if turned is None:
            return found
        free.append(turned)


def _depths(mechanism: Mechanism, edges: dict[int, list[int]]) -> list[int]:
    depth = [len(mechanism.bodies)] * len(mechanism.bodies) + [0]  # the last place, index -1, is the ground
    queue = deque([GROUND])
    while queue:
        x = queue.popleft()
        for k in edges[x]:
            joint = mechanism.joints[k]
            y = joint.b if joint.a == x else joint.a
            if y != GROUND and depth[y] > depth[x] + 1:
                depth[y] = depth[x] + 1
                queue.append(y)
    return depth


def _forest(
    mechanism: Mechanism, depth: list[int], kept: Collection[int], free: Collection[int]
) -> dict[int, list[int]]:
    """Kruskal's forest: kept joints first, then layer by layer, those with most conditions first, then as written.

    free: bodies that hang on six freedoms of their own, whatever holds what they carry.
    """
    joints = mechanism.joints
    null = null_axes(mechanism)
    between = passing_on(mechanism, null)

    def urgency(k: int) -> tuple[bool, bool, bool, bool, bool, int, int, int]:
        joint = joints[k]
        passes_on = not between.isdisjoint((joint.a, joint.b))
        spins = any(_leaves(joint, end == joint.b, null[end]) for end in {joint.a, joint.b} & null.keys())
        layer, kind = min(depth[joint.a], depth[joint.b]), JOINTS[joint.kind]
        return k not in kept, not kind.follows_path, not passes_on, not kind.is_rigid, spins, layer, -kind.rows, k

    group = list(range(len(mechanism.bodies) + 1))

    def root(x: int) -> int:
        x = x if x >= 0 else len(group) - 1
        while group[x] != x:
            group[x] = group[group[x]]
            x = group[x]
        return x

    for body in free:
        group[root(body)] = root(GROUND)
    forest = defaultdict(list)
    for k in sorted(range(len(joints)), key=urgency):
        joint = joints[k]
        if JOINTS[joint.kind].in_tree == "never" or joint.one_sided:
            continue
        a, b = root(joint.a), root(joint.b)
        if a == b:
            if k in kept:
                raise SolveError(_over_driven(mechanism, k))
            continue
        group[a] = b
        forest[joint.a].append(k)
        forest[joint.b].append(k)
    return forest


def null_axes(mechanism: Mechanism) -> dict[int, Array]:
    """Of each body that has axes without inertia through its centre: those, (k, 3), k = 1 or 3, body axes."""
    if not mechanism.bodies:
        return {}
    moments, axes = np.linalg.eigh(np.array([body.inertia for body in mechanism.bodies]))
    none = moments <= tolerances.NO_INERTIA * np.maximum(moments[:, 2:], 0.0)
    return {int(i): axes[i][:, none[i]].T for i in np.flatnonzero(none.any(axis=1))}


def passing_on(mechanism: Mechanism, null: Mapping[int, Array]) -> frozenset[int]:
    """The bodies that are no mass beside the heaviest, and that some joint of theirs keeps from spinning idly.

    null: the axes without inertia of each body that has any, as of `null_axes`. Such bodies stand between the joints of
    an imported stack.
    """
    least = tolerances.NO_MASS * max((body.mass for body in mechanism.bodies), default=0.0)
    return frozenset(
        end
        for joint in mechanism.joints
        for end in {joint.a, joint.b} - {GROUND}
        if mechanism.bodies[end].mass < least and not (end in null and _leaves(joint, end == joint.b, null[end]))
    )


def _leaves(joint: Joint, to: bool, null: Array) -> bool:
    """Whether a joint leaves one of its bodies free to turn about an axis without inertia."""
    kind = JOINTS[joint.kind]
    if kind.ball or len(null) > 1:
        return kind.ball
    own = joint.to_axis if to else joint.axis
    return bool(kind.turns) and abs(float(null[0] @ own)) > tolerances.ALONG


def _over_driven(mechanism: Mechanism, k: int) -> Problem:
    joint = mechanism.joints[k]
    what = "is driven" if joint.drive else "is named in an expression"
    if JOINTS[joint.kind].coordinates == ():
        what = "has a turn_spring"
    if any(stop.joint == k for stop in mechanism.stops):
        what = "is limited by a stop, or held by a latch"
    return Problem(
        "over-driven",
        f"joints.{joint.name} {what}, and so is every other joint of a closed chain through it",
        hint="leave at least one joint of each closed chain neither driven nor limited nor named",
    )


def _found_from_pose(joint: Joint) -> Problem:
    return Problem(
        "over-driven",
        f"joints.{joint.name} is one-sided: its travel follows from the pose, and nothing drives, limits or names it",
        hint="name the point itself: body.P.x; or leave one_sided out",
    )


def _path_unheld(joint: Joint) -> Problem:
    return Problem(
        "path-unheld",
        f"joints.{joint.name} is to hold the body of its path by a point that is held already",
        hint="the path's body carries what runs along it: run a body of its own, on a ball or pin at that point",
    )


def _walk(mechanism: Mechanism, forest: dict[int, list[int]], free: Collection[int]) -> Spanning:
    joints = mechanism.joints
    seen = [False] * len(mechanism.bodies)
    used: set[int] = set()
    hangs: list[Hang] = []
    queue: deque[int] = deque([GROUND])
    fresh = iter((*free, *range(len(mechanism.bodies))))
    while True:
        while queue:
            x = queue.popleft()
            for k in forest[x]:
                joint = joints[k]
                reverse = joint.b == x
                y = joint.a if reverse else joint.b
                if y == GROUND or seen[y] or (reverse and JOINTS[joint.kind].in_tree == "forward"):
                    continue
                seen[y] = True
                used.add(k)
                hangs.append(Hang(y, x, k, reverse))
                queue.append(y)
        start = next((i for i in fresh if not seen[i]), None)
        if start is None:
            break
        seen[start] = True
        hangs.append(Hang(start, GROUND, -1, False))
        queue.append(start)
    cut = tuple(k for k in range(len(joints)) if k not in used)
    return Spanning(tuple(hangs), cut)
