"""Poses that fit: the walk outward, then the islands that it leaves open, each followed by what hangs on it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.multibody.assembly.conditions import JointCondition
from heuncli.multibody.assembly.continuation import given
from heuncli.multibody.assembly.errors import does_not_fit, no_length, too_many
from heuncli.multibody.assembly.fit import Fit
from heuncli.multibody.assembly.gaps import JointGaps
from heuncli.multibody.assembly.islands import TOGETHER, AssemblyIsland, Islands, settle
from heuncli.multibody.assembly.walk import AssemblyPoses, Tree, place, spanning, start, walk
from heuncli.multibody.mechanism.model import GROUND, Mechanism


class Placing:
    """The poses of a mechanism on their way from the drawing to where all joints are closed; it is written to.

    drawn: where they start; poses: where they are; tree: how the walk reaches them. fitted: bodies fitted in an island.
    folded: joints whose loop was folded in a fixed way. gap: the largest that is left [m].
    """

    def __init__(self, mechanism: Mechanism, found: Sequence[JointCondition], size: float) -> None:
        self.mechanism = mechanism
        self.found = found
        self.size = size
        self.drawn = start(mechanism)
        self.poses = self.drawn.copy()
        self.tree, self.islands = _loops(mechanism, found)
        self.fitted: set[int] = set()
        self.folded: list[str] = []
        self.gap = 0.0
        self.limit = tolerances.OPEN_GAP
        self._given = given(mechanism, found)
        self._gaps = JointGaps(found, [d.pose for d in found])

    def fit(self) -> None:
        """Close all joints. Raises SolveError: does-not-fit, held-conflict."""
        walk(self.poses, self.tree, self.found)
        farthest = float(np.max(np.abs(self.poses.x), initial=0.0))
        self.limit = max(tolerances.OPEN_GAP, tolerances.GAP_ROUNDING * farthest / self.size)
        if stuck := settle(self.tree, self.islands, self._open, self._fit, self._walk_on):
            raise self._refusal(stuck)
        for d in self.found:
            if d.pose.hold == "none" and _span(d, self.poses) < tolerances.NO_LENGTH * self.size:
                raise no_length(self.mechanism, d.joint)

    def _open(self) -> list[int]:
        """Joints that are open."""
        distance, angle = self._gaps(self.poses.x, self.poses.R)
        self.gap = float(np.max(np.maximum(distance, self.size * angle), initial=0.0))
        is_open = np.maximum(distance / self.size, angle) > self.limit
        return [int(k) for k in np.flatnonzero(is_open)]

    def _walk_on(self, body: int) -> None:
        self.poses.x[body], self.poses.R[body] = self.drawn.x[body], self.drawn.R[body]
        if self.tree.via[body] >= 0:
            place(self.poses, self.found[self.tree.via[body]], body)

    def _fit(self, island: AssemblyIsland, afresh: bool) -> None:
        if afresh:
            for body in island.members:
                self._walk_on(body)
        if len(island.members) > TOGETHER:
            raise too_many(self.mechanism, island, "poses")
        fit = Fit(self.poses, island, self.found, self.tree.depth, self.size, self.mechanism.planar)
        before = fit.saved()
        drawn = self.drawn.x[island.members], self.drawn.R[island.members]
        closed, kick = fit.near_drawing(drawn, self.limit)
        if not closed:
            closed = fit.follow(drawn, self._given, self.limit)
        if not closed:
            fit.restore(before)
            closed, kick = self._from_walk(fit)
        if closed:
            self.fitted.update(island.members)
            if kick:
                self.folded.append(self.mechanism.joints[(island.closures or island.via)[0]].name)
        elif self.islands.moving(island.above) == GROUND:
            raise self._refusal(fit.joints)
        else:
            fit.restore(before)
            self.islands.widened(island.closures[0])  # what it hangs on may have to turn, too

    def _from_walk(self, fit: Fit) -> tuple[bool, int]:
        """Whether an island closes from the poses as walked, and which kick it took."""
        bodies = [self.mechanism.bodies[i] for i in fit.island.members]
        fit.meet([(b.near_rotation is not None, b.near_position is not None) for b in bodies], self.limit)
        begun = fit.saved()
        closed, kick = fit.settle(self.limit)
        if closed:
            fit.polish(begun, self.limit)
        return closed, kick

    def _refusal(self, joints: Sequence[int]) -> Exception:
        distance, angle = self._gaps(self.poses.x, self.poses.R)
        return does_not_fit(self.mechanism, distance, angle, self.size, joints)


def _span(d: JointCondition, poses: AssemblyPoses) -> float:
    """Distance of a joint's points [m]."""
    D = poses.x[d.b] + poses.R[d.b] @ d.q - poses.x[d.a] - poses.R[d.a] @ d.p
    return float(np.sqrt(D @ D))


def _loops(mechanism: Mechanism, found: Sequence[JointCondition]) -> tuple[Tree, Islands]:
    """The tree of the walk, from ground and held positions, and in loops from `near` positions too; and its loops."""
    bodies = mechanism.bodies
    asks = [(d.a, d.b, d.pose) for d in found]
    links = [d.pose.hold != "none" for d in found]
    first = [b.rotation is not None for b in bodies]
    fixed = [b.position is not None and b.rotation is not None for b in bodies]
    held = [b.position is not None for b in bodies]
    tree = spanning(mechanism, asks, held, first)
    islands = Islands(tree, found, links, fixed)
    roots = [
        h or (b.near_position is not None and islands.loops(i))
        for i, (b, h) in enumerate(zip(bodies, held, strict=True))
    ]
    if roots != held:
        tree = spanning(mechanism, asks, roots, first)
        islands = Islands(tree, found, links, fixed)
    return tree, islands
