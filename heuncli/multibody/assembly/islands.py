"""Islands: bodies that must be fitted together, the loops of a tree and its closures, merged where they share a body.

A loop runs from the two bodies of a closure to where their paths meet, or to a root; the body where they meet stays,
and so do the ground and bodies that are held entirely.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from heuncli.base.records import record
from heuncli.multibody.assembly.conditions import JointCondition
from heuncli.multibody.assembly.walk import PlacementTree
from heuncli.multibody.mechanism.model import GROUND

MAX_PASSES = 100
MAX_BODIES = 1000  # bodies in one island: dense matrices of its freedoms must fit into memory, and be fast enough


@record
class AssemblyIsland:
    """An island of bodies.

    members: bodies, from the root outward
    tree_joints: the joint to each member's parent, -1 for none
    closures: the other joints of their loops
    parent: the body that the loops hang on
    """

    members: list[int]
    tree_joints: list[int]
    closures: list[int]
    parent: int


FitIsland = Callable[[AssemblyIsland, bool], None]
PlaceAgain = Callable[[int], None]


class Islands:
    """The loops of a tree, merged in almost linear time. Mutable: loops may be added, and merge others."""

    def __init__(
        self,
        tree: PlacementTree,
        conditions: Sequence[JointCondition],
        is_link: Sequence[bool],
        is_fixed: Sequence[bool],
    ) -> None:
        """is_link: which joints count; is_fixed: which bodies never move."""
        n = len(tree.tree_joint)
        self._tree = tree
        self._found = conditions
        self._fixed = is_fixed
        self._group = list(range(n))  # union-find over the bodies
        # Of a group's representative:
        self._above = list(tree.parent)
        self._closures: list[list[int]] = [[] for _ in range(n)]
        self._members: list[list[int]] = [[i] for i in range(n)]
        self.on_tree = set(tree.tree_joint)
        self._rank = {body: i for i, body in enumerate(tree.order)}
        for k in range(len(conditions)):
            if is_link[k] and k not in self.on_tree:
                self._merge(k)

    def find_group(self, body: int) -> int:
        """Find the body that represents this one's island."""
        while self._group[body] != body:
            self._group[body] = self._group[self._group[body]]
            body = self._group[body]
        return body

    def _merge(self, joint: int, to_root: bool = False) -> None:
        """Merge the loop that a joint closes; to_root: with all bodies between it and the root, wherever their paths
        meet.
        """
        ends = [self.moving_body(i) for i in (self._found[joint].a, self._found[joint].b)]
        merged: set[int] = set()
        while ends[0] != ends[1] or (to_root and ends[0] != GROUND):
            lower = 0 if self._depth(ends[0]) >= self._depth(ends[1]) else 1
            top = self.find_group(ends[lower])
            merged.add(top)
            ends[lower] = self.moving_body(self._above[top])
        if not merged:
            return
        target, *others = sorted(merged, key=lambda i: -len(self._members[i]))
        for other in others:
            self._group[other] = target
            self._members[target] += self._members[other]
            self._closures[target] += self._closures[other]
        self._above[target] = ends[0]
        if not to_root:
            self._closures[target].append(joint)

    def moving_body(self, body: int) -> int:
        """Return the body, or the ground if the body is held entirely."""
        return GROUND if body == GROUND or self._fixed[body] else body

    def _depth(self, body: int) -> int:
        return -1 if body == GROUND else self._tree.depth[body]

    def find_island_group(self, joint: int) -> int | None:
        """Find the representative of a closure's island; None where both its bodies are fixed."""
        d = self._found[joint]
        deeper = max(self.moving_body(d.a), self.moving_body(d.b), key=self._depth)
        return None if deeper == GROUND else self.find_group(deeper)

    def widen(self, joint: int) -> int | None:
        """Merge the island of a closure with all bodies up to the root; return its representative, None where both
        bodies are fixed.
        """
        self._merge(joint, to_root=True)
        return self.find_island_group(joint)

    def get_island(self, group: int) -> AssemblyIsland:
        """Return the island of a representative."""
        members = sorted(self._members[group], key=self._rank.__getitem__)
        return AssemblyIsland(
            members, [self._tree.tree_joint[i] for i in members], self._closures[group], self._above[group]
        )

    def is_in_loop(self, body: int) -> bool:
        """Whether a body is in a loop."""
        return bool(self._closures[self.find_group(body)])

    def find_looped_groups(self) -> list[int]:
        """Return the representatives of the islands that have loops."""
        return [i for i, g in enumerate(self._group) if g == i and self._closures[i]]


def settle_islands(
    tree: PlacementTree, islands: Islands, still_open: Callable[[], list[int]], fit: FitIsland, place_again: PlaceAgain
) -> list[int]:
    """Fit the islands of open joints until none is open; return the joints that no fit can close.

    fit(island, afresh): afresh where the island's parent has moved; it may widen the island instead
    place_again(body): places one body from its start

    A pass closes the islands it meets; what it opens lies further out, so few passes are needed.
    """
    is_open = still_open()
    for _ in range(MAX_PASSES):
        groups = set()
        for k in is_open:
            group = islands.widen(k) if k in islands.on_tree else islands.find_island_group(k)
            if group is None:
                return is_open
            groups.add(group)
        if not groups:
            break
        _sweep(tree, islands, {islands.find_group(g) for g in groups}, fit, place_again)
        is_open = still_open()
    return is_open


def _sweep(
    tree: PlacementTree, islands: Islands, groups: Iterable[int], fit: FitIsland, place_again: PlaceAgain
) -> None:
    """Fit islands outward, and place again every body whose parent has moved."""
    members = {body: g for g in groups for body in islands.get_island(g).members}
    moved: set[int] = set()
    done: set[int] = set()
    for body in tree.order:
        group = members.get(body)
        if group is None:
            if tree.parent[body] in moved:
                place_again(body)
                moved.add(body)
        elif group not in done:
            island = islands.get_island(group)
            fit(island, island.parent in moved)
            moved.update(island.members)
            done.add(group)
