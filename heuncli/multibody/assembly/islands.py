"""Bodies that must be fitted together: the loops of a tree and its closures, merged where they share a body.

A loop runs from the two bodies of a closure to where their paths meet, or to a root; the body where they meet stays,
and so do the ground and bodies that are held altogether.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from heuncli.base.records import record
from heuncli.multibody.assembly.conditions import JointCondition
from heuncli.multibody.assembly.walk import Tree
from heuncli.multibody.mechanism.model import GROUND

PASSES = 100
TOGETHER = 1000  # bodies in one island: dense matrices of its freedoms must fit into memory and patience


@record
class AssemblyIsland:
    """Members, outward; the joint each hangs on (-1: none); the other joints of their loops; what the loops hang on."""

    members: list[int]
    via: list[int]
    closures: list[int]
    above: int


Fitting = Callable[[AssemblyIsland, bool], None]
Again = Callable[[int], None]


class Islands:
    """The loops of a tree, merged in almost linear time. It changes: loops may be added and merge others."""

    def __init__(
        self, tree: Tree, found: Sequence[JointCondition], links: Sequence[bool], fixed: Sequence[bool]
    ) -> None:
        """links: which joints count; fixed: which bodies stay whatever happens."""
        n = len(tree.via)
        self._tree = tree
        self._found = found
        self._fixed = fixed
        self._group = list(range(n))  # union-find over the bodies
        # Of a group's representative:
        self._above = list(tree.parent)
        self._closures: list[list[int]] = [[] for _ in range(n)]
        self._members: list[list[int]] = [[i] for i in range(n)]
        self.on_tree = set(tree.via)
        self._rank = {body: i for i, body in enumerate(tree.order)}
        for k in range(len(found)):
            if links[k] and k not in self.on_tree:
                self._merge(k)

    def group(self, body: int) -> int:
        """The body that stands for this one's island."""
        while self._group[body] != body:
            self._group[body] = self._group[self._group[body]]
            body = self._group[body]
        return body

    def _merge(self, joint: int, to_root: bool = False) -> None:
        """Merge the loop a joint makes; to_root: with everything its bodies hang on, wherever their paths meet."""
        ends = [self.moving(i) for i in (self._found[joint].a, self._found[joint].b)]
        merged: set[int] = set()
        while ends[0] != ends[1] or (to_root and ends[0] != GROUND):
            lower = 0 if self._depth(ends[0]) >= self._depth(ends[1]) else 1
            top = self.group(ends[lower])
            merged.add(top)
            ends[lower] = self.moving(self._above[top])
        if not merged:
            return
        into, *others = sorted(merged, key=lambda i: -len(self._members[i]))
        for other in others:
            self._group[other] = into
            self._members[into] += self._members[other]
            self._closures[into] += self._closures[other]
        self._above[into] = ends[0]
        if not to_root:
            self._closures[into].append(joint)

    def moving(self, body: int) -> int:
        """The body, or the ground where it is held altogether."""
        return GROUND if body == GROUND or self._fixed[body] else body

    def _depth(self, body: int) -> int:
        return -1 if body == GROUND else self._tree.depth[body]

    def of(self, joint: int) -> int | None:
        """Who stands for the island of a closure; None where both its bodies stay."""
        d = self._found[joint]
        deeper = max(self.moving(d.a), self.moving(d.b), key=self._depth)
        return None if deeper == GROUND else self.group(deeper)

    def widened(self, joint: int) -> int | None:
        """Who stands for the island of a closure, merged with all that its bodies hang on; None where both stay."""
        self._merge(joint, to_root=True)
        return self.of(joint)

    def island(self, group: int) -> AssemblyIsland:
        """The island a body stands for."""
        members = sorted(self._members[group], key=self._rank.__getitem__)
        return AssemblyIsland(members, [self._tree.via[i] for i in members], self._closures[group], self._above[group])

    def loops(self, body: int) -> bool:
        """Whether a body is in a loop."""
        return bool(self._closures[self.group(body)])

    def all(self) -> list[int]:
        """Who stand for the islands that have loops."""
        return [i for i, g in enumerate(self._group) if g == i and self._closures[i]]


def settle(tree: Tree, islands: Islands, still_open: Callable[[], list[int]], fit: Fitting, again: Again) -> list[int]:
    """Fit the islands of open joints until none is open; gives the joints that no fit can close.

    fit(island, afresh): afresh where what it hangs on has moved; it may widen the island instead. again(body): place
    one body from its start. A pass closes the islands it meets, and what it opens lies further out: few are needed.
    """
    is_open = still_open()
    for _ in range(PASSES):
        groups = set()
        for k in is_open:
            group = islands.widened(k) if k in islands.on_tree else islands.of(k)
            if group is None:
                return is_open
            groups.add(group)
        if not groups:
            break
        _sweep(tree, islands, {islands.group(g) for g in groups}, fit, again)
        is_open = still_open()
    return is_open


def _sweep(tree: Tree, islands: Islands, groups: Iterable[int], fit: Fitting, again: Again) -> None:
    """Fit islands outward, and walk again whatever hangs on a body that was moved."""
    members = {body: g for g in groups for body in islands.island(g).members}
    moved: set[int] = set()
    done: set[int] = set()
    for body in tree.order:
        group = members.get(body)
        if group is None:
            if tree.parent[body] in moved:
                again(body)
                moved.add(body)
        elif group not in done:
            island = islands.island(group)
            fit(island, island.above in moved)
            moved.update(island.members)
            done.add(group)
