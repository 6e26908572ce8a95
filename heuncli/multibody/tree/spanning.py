"""Choose the spanning tree that carries the motion: which joints are in it, which are cut, and the order of the bodies.

Breadth-first from the ground, so that paths stay short. A joint whose coordinate is driven, used in an expression or
limited by a stop is never cut, one with friction that may stick only where the others must not be. Next come the
joints of a body with negligible mass, which only transmits loads: cut off
from the bodies beyond it, roundings would accelerate it. This does not apply where all its joints leave it free to
spin, as a link on two balls: transmitted loads do not turn it. Then come rigid joints, so that bodies welded together
hang on each other and, apart from the above, only circles of welds are cut. Joints that leave a thin body free to turn
about its axis without inertia are cut first, for that freedom would have no inertia; among the others of one layer
those with most constraints are kept.

`line`, `plane` and `curve` carry a body only from their `from` side, a rod never does; a body that no joint carries has
six freedoms of its own. So has the body of a path that only its runner holds. A curve is cut only where a closed chain
consists of curves and joints that must not be cut: several curves on one body, or one on a point that is held; and
where its runner may lift off.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Collection, Mapping

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Joint, Mechanism
from heuncli.results.results import Array


@record
class TreeLink:
    """The link of a body to its parent in the tree: its joint (-1: free), and whether the body is the joint's `from`
    side.
    """

    body: int
    parent: int
    joint: int
    reverse: bool


@record
class SpanningTree:
    """Bodies, parents first, each with the joint to its parent; and the joints that were cut."""

    links: tuple[TreeLink, ...]
    cut: tuple[int, ...]


def find_spanning_tree(mechanism: Mechanism, uncut: Collection[int], preferred: Collection[int] = ()) -> SpanningTree:
    """Find the tree for a mechanism; uncut: joints that must not be cut; preferred: those to be cut last of the others.

    Raises SolveError where those alone make a closed chain (over-driven).
    """
    edges = defaultdict(list)
    for k, joint in enumerate(mechanism.joints):
        if JOINTS[joint.kind].in_tree != "never":
            edges[joint.a].append(k)
            edges[joint.b].append(k)
    depth = _find_depths(mechanism, edges)
    free_bodies: list[int] = []
    while True:
        forest = _find_forest(mechanism, depth, uncut, preferred, free_bodies)
        tree = _traverse(mechanism, forest, free_bodies)
        detached = None
        for k in (k for k in tree.cut if mechanism.joints[k].path is not None):
            joint = mechanism.joints[k]
            is_closing = k not in forest[joint.b] or joint.b == GROUND or joint.a in free_bodies
            if is_closing and k in uncut:
                raise SolveError(_one_sided_problem(joint) if joint.one_sided else _path_unheld_problem(joint))
            detached = detached if is_closing else joint.a
        if detached is None:
            return tree
        free_bodies.append(detached)


def _find_depths(mechanism: Mechanism, edges: dict[int, list[int]]) -> list[int]:
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


def _find_forest(
    mechanism: Mechanism,
    depth: list[int],
    uncut: Collection[int],
    preferred: Collection[int],
    free_bodies: Collection[int],
) -> dict[int, list[int]]:
    """Kruskal's forest: uncut joints first, then layer by layer, those with most constraints first, then as written.

    free_bodies: bodies with six freedoms of their own, whatever holds the bodies that they carry
    """
    joints = mechanism.joints
    null = find_null_axes(mechanism)
    between = find_transmitting_bodies(mechanism, null)

    def urgency(k: int) -> tuple[bool | int, ...]:
        joint = joints[k]
        passes_on = not between.isdisjoint((joint.a, joint.b))
        spins = any(_leaves_spin_free(joint, end == joint.b, null[end]) for end in {joint.a, joint.b} & null.keys())
        layer, kind = min(depth[joint.a], depth[joint.b]), JOINTS[joint.kind]
        forced = k not in uncut, k not in preferred
        return *forced, not kind.follows_path, not passes_on, not kind.is_rigid, spins, layer, -kind.row_count, k

    group = list(range(len(mechanism.bodies) + 1))

    def root(x: int) -> int:
        x = x if x >= 0 else len(group) - 1
        while group[x] != x:
            group[x] = group[group[x]]
            x = group[x]
        return x

    for body in free_bodies:
        group[root(body)] = root(GROUND)
    forest = defaultdict(list)
    for k in sorted(range(len(joints)), key=urgency):
        joint = joints[k]
        if JOINTS[joint.kind].in_tree == "never" or joint.one_sided:
            continue
        a, b = root(joint.a), root(joint.b)
        if a == b:
            if k in uncut:
                raise SolveError(_over_driven_problem(mechanism, k))
            continue
        group[a] = b
        forest[joint.a].append(k)
        forest[joint.b].append(k)
    return forest


def find_null_axes(mechanism: Mechanism) -> dict[int, Array]:
    """Return the axes without inertia through the centre of each body that has any, (k, 3), k = 1 or 3, body axes."""
    if not mechanism.bodies:
        return {}
    moments, axes = np.linalg.eigh(np.array([body.inertia for body in mechanism.bodies]))
    is_null = moments <= tolerances.NO_INERTIA * np.maximum(moments[:, 2:], 0.0)
    return {int(i): axes[i][:, is_null[i]].T for i in np.flatnonzero(is_null.any(axis=1))}


def find_transmitting_bodies(mechanism: Mechanism, null: Mapping[int, Array]) -> frozenset[int]:
    """Return the bodies with negligible mass that some joint of theirs keeps from spinning idly.

    null: the axes without inertia of each body that has any, from `find_null_axes`

    Such bodies are between the joints of an imported stack.
    """
    least = tolerances.NO_MASS * max((body.mass for body in mechanism.bodies), default=0.0)
    return frozenset(
        end
        for joint in mechanism.joints
        for end in {joint.a, joint.b} - {GROUND}
        if mechanism.bodies[end].mass < least
        and not (end in null and _leaves_spin_free(joint, end == joint.b, null[end]))
    )


def _leaves_spin_free(joint: Joint, is_to: bool, null: Array) -> bool:
    """Return whether a joint leaves one of its bodies free to turn about an axis without inertia."""
    kind = JOINTS[joint.kind]
    if kind.is_ball or len(null) > 1:
        return kind.is_ball
    own_axis = joint.to_axis if is_to else joint.axis
    return bool(kind.turns) and abs(float(null[0] @ own_axis)) > tolerances.ALONG


def _over_driven_problem(mechanism: Mechanism, k: int) -> Problem:
    joint = mechanism.joints[k]
    what = "is driven" if joint.drive else "is used in an expression"
    if JOINTS[joint.kind].coordinates == ():
        what = "has a torsion spring"
    if any(stop.joint == k for stop in mechanism.stops):
        what = "is limited by a stop, or locked by a latch"
    return Problem(
        "over-driven",
        f"joints.{joint.name} {what}, and so is every other joint of a closed chain through it",
        hint="leave at least one joint of each closed chain not driven, limited or used in an expression",
    )


def _one_sided_problem(joint: Joint) -> Problem:
    return Problem(
        "over-driven",
        f"joints.{joint.name} is one-sided: its travel is a result; it cannot be driven, limited or used",
        hint="use the point itself: body.P.x; or leave out one_sided",
    )


def _path_unheld_problem(joint: Joint) -> Problem:
    return Problem(
        "path-unheld",
        f"joints.{joint.name} would constrain the body of its path by a point that is already constrained",
        hint="the path's body carries what moves along it: use a separate body, on a ball or pin at that point",
    )


def _traverse(mechanism: Mechanism, forest: dict[int, list[int]], free_bodies: Collection[int]) -> SpanningTree:
    joints = mechanism.joints
    visited = [False] * len(mechanism.bodies)
    used: set[int] = set()
    links: list[TreeLink] = []
    queue: deque[int] = deque([GROUND])
    roots = iter((*free_bodies, *range(len(mechanism.bodies))))
    while True:
        while queue:
            x = queue.popleft()
            for k in forest[x]:
                joint = joints[k]
                reverse = joint.b == x
                y = joint.a if reverse else joint.b
                if y == GROUND or visited[y] or (reverse and JOINTS[joint.kind].in_tree == "forward"):
                    continue
                visited[y] = True
                used.add(k)
                links.append(TreeLink(y, x, k, reverse))
                queue.append(y)
        start = next((i for i in roots if not visited[i]), None)
        if start is None:
            break
        visited[start] = True
        links.append(TreeLink(start, GROUND, -1, False))
        queue.append(start)
    cut = tuple(k for k in range(len(joints)) if k not in used)
    return SpanningTree(tuple(links), cut)
