"""Islands: bodies that must be fitted together, the loops of a tree and its closures, merged where they share a body.

A loop runs from the two bodies of a closure to where their paths meet, or to a root; the body where they meet stays,
and so do the ground and bodies that are held entirely.

An error of the assembly names the joint, the gap and the two bodies.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record
from heuncli.multibody.assembly.conditions import JointCondition
from heuncli.multibody.assembly.walk import PlacementTree
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array

# Islands

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
        """Return whether a body is in a loop."""
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


# Errors


def does_not_fit(mechanism: Mechanism, distance: Array, angle: Array, size: float, joints: Sequence[int]) -> SolveError:
    """Make the error for poses that do not fit: distance [m] and angle [rad] by which joints stay open; names the worst
    of `joints`.
    """
    open_by = np.maximum(distance, size * angle)
    k = max(joints, key=open_by.__getitem__)
    joint = mechanism.joints[k]
    is_distance = bool(distance[k] >= size * angle[k])
    between = f"{_name(mechanism, joint.a)} and {_name(mechanism, joint.b)}"
    if is_distance:
        gap = f"its points on {between} remain {distance[k]:.3g} m from where the joint requires them"
    else:
        gap = f"{between} remain misaligned by {math.degrees(angle[k]):.3g} deg"
    if all(_is_held(mechanism, i, is_distance) for i in (joint.a, joint.b)):
        what = "position" if is_distance else "orientation"
        return SolveError(
            Problem(
                "held-conflict",
                f"joint {joint.name} ({joint.kind}): {gap}; both are prescribed",
                hint=f"leave out the {what} of one of them" + _other_hints(mechanism, k, joints),
                entry_path=f"joints.{joint.name}",
            )
        )
    return SolveError(Problem(
        "does-not-fit", f"joint {joint.name} ({joint.kind}) cannot be assembled: {gap}",
        hint="check the points and lengths; prescribe fewer start values; or set closer start positions by near:"
        + _other_hints(mechanism, k, joints), entry_path=f"joints.{joint.name}",
    ))  # fmt: skip


def rates_do_not_fit(mechanism: Mechanism, speed: Array, spin: Array, size: float, joints: Sequence[int]) -> SolveError:
    """Make the error for rates that do not fit: the residual of each joint [m/s], [rad/s]; names the worst of
    `joints`.
    """
    k = max(joints, key=np.maximum(speed, size * spin).__getitem__)
    joint = mechanism.joints[k]
    gap = f"{speed[k]:.3g} m/s" if speed[k] >= size * spin[k] else f"{spin[k]:.3g} rad/s"
    message = (
        f"joint {joint.name} ({joint.kind}): the start velocities of {_name(mechanism, joint.a)} and "
        f"{_name(mechanism, joint.b)} are incompatible at the joint by {gap}"
    )
    return SolveError(Problem(
        "rates-do-not-fit", message,
        hint="prescribe fewer velocities; heun computes the others from the joints" + _drive_hint(mechanism, joints),
        entry_path=f"joints.{joint.name}",
    ))  # fmt: skip


def no_length(mechanism: Mechanism, joint: int) -> SolveError:
    """Make the error for a rod whose points coincide."""
    name = mechanism.joints[joint].name
    message = f"joint {name} (rod): its two points coincide at the start, so it has no direction"
    hint = "give its length, or move one of the points"
    return SolveError(Problem("no-length", message, hint=hint, entry_path=f"joints.{name}"))


def too_many(mechanism: Mechanism, island: AssemblyIsland, what: str) -> SolveError:
    """Make the error for an island with more bodies than are fitted at once."""
    name = mechanism.joints[(island.closures or island.tree_joints)[0]].name
    message = (
        f"the loop at joint {name} connects {len(island.members):,} "
        f"bodies whose start {what} do not fit: too many to fit at once"
    )
    return SolveError(Problem("too-many-together", message, hint=f"give the {what} of more of its bodies",
                              entry_path=f"joints.{name}"))  # fmt: skip


def singular_pose(mechanism: Mechanism, joint: int, joints: Sequence[int]) -> SolveError:
    """Make the error for rates without accelerations; joint: a closure of the loop concerned, joints: all of the
    loop.
    """
    message = (
        f"the loop at joint {mechanism.joints[joint].name} is in a singular position (e.g. links in line), "
        "where no acceleration exists for its start velocities"
    )
    hint = (
        "give the rate of one more joint of the loop; all rates together must belong to a motion through this position"
    )
    hint += _drive_hint(mechanism, joints)
    return SolveError(Problem("singular-pose", message, hint=hint, entry_path=f"joints.{mechanism.joints[joint].name}"))


def _name(mechanism: Mechanism, body: int) -> str:
    return "ground" if body == GROUND else mechanism.bodies[body].name


def _is_held(mechanism: Mechanism, body: int, is_distance: bool) -> bool:
    if body == GROUND:
        return True
    b = mechanism.bodies[body]
    return b.rotation is not None and (not is_distance or b.position is not None)


def _other_hints(mechanism: Mechanism, k: int, joints: Sequence[int]) -> str:
    """Suggest what else may be changed: the drives of these joints, or what joint k holds at the start."""
    joint = mechanism.joints[k]
    initial_values = [n for n in ("angle", "travel") if getattr(joint, n) is not None]
    return _drive_hint(mechanism, joints) or (
        f"; or change the initial {initial_values[0]} of the joint" if initial_values else ""
    )


def _drive_hint(mechanism: Mechanism, joints: Sequence[int]) -> str:
    names = [drive.name for k in joints if (drive := mechanism.joints[k].drive) is not None]
    if not names:
        return ""
    return f"; or change drive {names[0]}" if len(names) == 1 else f"; or change one of the drives {', '.join(names)}"
