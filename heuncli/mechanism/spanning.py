"""The tree that carries the motion: which joints are kept, which are cut, and in which order bodies come.

Breadth-first from the ground, so that paths stay short. A joint whose coordinate is driven or named in an expression is
never cut; among the others of one layer those that make most conditions are kept. `line` and `plane` carry a body only
from their `from` side, a rod never does; a body that nothing carries hangs on six freedoms of its own.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Collection
from dataclasses import dataclass

from heuncli.errors import Problem, SolveError
from heuncli.mechanism.joints import JOINTS
from heuncli.mechanism.model import GROUND, Mechanism


@dataclass(frozen=True)
class Hang:
    """How a body hangs in the tree: its joint (-1: free), and whether the body is the joint's `from` side."""

    body: int
    parent: int
    joint: int
    reverse: bool


@dataclass(frozen=True)
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
    forest = _forest(mechanism, depth, kept)
    return _walk(mechanism, forest)


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


def _forest(mechanism: Mechanism, depth: list[int], kept: Collection[int]) -> dict[int, list[int]]:
    """Kruskal's forest: kept joints first, then layer by layer, those with most conditions first, then as written."""
    joints = mechanism.joints

    def urgency(k: int) -> tuple[bool, int, int, int]:
        joint = joints[k]
        return k not in kept, min(depth[joint.a], depth[joint.b]), -JOINTS[joint.kind].rows, k

    group = list(range(len(mechanism.bodies) + 1))

    def root(x: int) -> int:
        x = x if x >= 0 else len(group) - 1
        while group[x] != x:
            group[x] = group[group[x]]
            x = group[x]
        return x

    forest = defaultdict(list)
    for k in sorted(range(len(joints)), key=urgency):
        joint = joints[k]
        if JOINTS[joint.kind].in_tree == "never":
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


def _over_driven(mechanism: Mechanism, k: int) -> Problem:
    joint = mechanism.joints[k]
    what = "is driven" if joint.drive else "is named in an expression"
    return Problem(
        "over-driven",
        f"joints.{joint.name} {what}, and so is every other joint of a closed chain through it",
        hint="leave at least one joint of each closed chain neither driven nor named",
    )


def _walk(mechanism: Mechanism, forest: dict[int, list[int]]) -> Spanning:
    joints = mechanism.joints
    seen = [False] * len(mechanism.bodies)
    used: set[int] = set()
    hangs: list[Hang] = []
    queue: deque[int] = deque([GROUND])
    fresh = iter(range(len(mechanism.bodies)))
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
