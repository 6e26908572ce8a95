"""A scene seen from a plane: which bodies cannot tilt out of it whatever acts, how its joints stand to it.

A body is upright where joints lead from the ground to it that only turn about the normal or slide across it, or hold it
as two hinges hold a door. Its motion is one along the plane at any height, and what acts out of the plane is carried by
its joints.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import ABOUT_AXIS, ABOUT_TWO, ABOUT_Z, FLAT, JOINTS, LINE, NOT_AT_ALL, POINT, Kind
from heuncli.base.records import record
from heuncli.multibody.mechanism.model import GROUND, Joint
from heuncli.multibody.reduction.plane.frame import axes_of
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.starts import pose
from heuncli.results.results import Array


@record
class Stance:
    """How a joint stands to the plane: its axis, or one of its two, along the normal, or all of them across it.

    axis: the one along the normal, else its own, world; signed: its component along the normal, 1 or -1, 0 across;
    off: the sine by which what should be along or across is not. What has no axis is taken to stand along. second: of
    two axes the one along the normal is the second.
    """

    along: bool
    axis: Array
    off: float
    second: bool = False

    @property
    def winds(self) -> bool:
        """Whether what turns about the joint's own axis turns along the plane."""
        return self.along and not self.second

    def flat(self, kind: Kind) -> Kind:
        """What moves in the plane of a joint of that kind."""
        return FLAT[kind.name, self.along]


@record
class View:
    """A scene and a plane: its axes E (3, 3), which bodies are upright, and how each joint stands."""

    scene: PreparedScene
    E: Array
    upright: tuple[bool, ...]
    stances: tuple[Stance, ...]
    reach: float  # of places [m]: the scene's size and how far it is from the origin

    @cached_property
    def n(self) -> Array:
        """The normal."""
        return np.asarray(self.E[2])

    def stays(self, body: int) -> bool:
        """Whether nothing can tilt a body out of the plane; the ground."""
        return body == GROUND or self.upright[body]

    def height(self, body: int, point: Array) -> float:
        """Of a body's point above the origin's plane [m]."""
        x, R, _, _ = pose(self.scene.start, body)
        return float(self.n @ (x + R @ point))

    def normal_in(self, body: int, in_body: bool = True) -> Array:
        """The normal in a body's axes, or in the world's."""
        return np.asarray(pose(self.scene.start, body)[1].T @ self.n) if in_body else self.n

    def still(self, joint: int, quantity: str) -> bool:
        """Whether the plane leaves a coordinate no motion."""
        of = self.scene.mechanism.joints[joint]
        kind = JOINTS[of.kind]
        return quantity in kind.coordinates and quantity not in self.stances[joint].flat(kind).coordinates


Neighbours = dict[int, dict[int, list[int]]]  # of a body or the ground: by neighbour, the joints between the two


def neighbours(scene: PreparedScene) -> Neighbours:
    """What the joints of a scene lead to."""
    near: Neighbours = {}
    for k, joint in enumerate(scene.mechanism.joints):
        for a, b in ((joint.a, joint.b), (joint.b, joint.a)):
            near.setdefault(a, {}).setdefault(b, []).append(k)
    return near


def view(scene: PreparedScene, n: Array, near: Neighbours | None = None) -> View:
    """A scene seen from the plane across n; near: its neighbours where they are known, the same from everywhere."""
    E = axes_of(n)
    mechanism, start = scene.mechanism, scene.start
    stances = tuple(_stance(j, pose(start, j.a)[1], pose(start, j.b)[1], E[2]) for j in mechanism.joints)
    upright = _upright(scene, stances, E[2], neighbours(scene) if near is None else near)
    places = [start.position] + [p[None] for j in mechanism.joints for b, p in ((j.a, j.p), (j.b, j.q)) if b == GROUND]
    reach = scene.layout.size + float(np.abs(np.concatenate(places)).max(initial=0.0))
    return View(scene, E, upright, stances, reach)


def _upright(scene: PreparedScene, stances: Sequence[Stance], n: Array, near: Neighbours) -> tuple[bool, ...]:
    """Which bodies joints that keep them upright lead to from the ground, whether the tree has them or not."""
    mechanism = scene.mechanism
    found, waiting = {GROUND}, [GROUND]
    while waiting:
        for body, joints in near.get(waiting.pop(), {}).items():
            if body in found:
                continue
            one = any(_keeps_upright(JOINTS[mechanism.joints[k].kind], stances[k]) for k in joints)
            if one or _hinged(scene, [(mechanism.joints[k], stances[k]) for k in joints], n):
                found.add(body)
                waiting.append(body)
    return tuple(mechanism.planar or i in found for i in range(len(mechanism.bodies)))


def _hinged(scene: PreparedScene, joints: Sequence[tuple[Joint, Stance]], n: Array) -> bool:
    """Whether joints between two bodies hold points of one line along the normal, as two hinges hold a door.

    One of them holds its point altogether, another one where it cannot leave that line.
    """
    points = []
    for joint, stance in joints:
        hold = JOINTS[joint.kind].hold
        if hold is POINT or (hold is LINE and stance.along and stance.off <= tolerances.FLAT):
            x, R, _, _ = pose(scene.start, joint.b)
            points.append((x + R @ joint.q, hold is POINT))
    for i, (x, held) in enumerate(points):
        for y, also in points[:i]:
            lever = abs(float((y - x) @ n))
            beside = y - x - ((y - x) @ n) * n
            near = float(np.sqrt(beside @ beside)) <= tolerances.FLAT * lever
            if (held or also) and lever > tolerances.NO_LENGTH * scene.layout.size and near:
                return True
    return False


def _stance(joint: Joint, R_a: Array, R_b: Array, n: Array) -> Stance:
    kind = JOINTS[joint.kind]
    if not kind.has_axis:
        return Stance(True, n, 0.0)
    axes = [R_a @ joint.axis, *([R_b @ joint.to_axis] if kind.turn is ABOUT_TWO else [])]
    components = [float(axis @ n) for axis in axes]
    offs = [float(np.sqrt(np.sum(np.square(axis - c * n)))) for axis, c in zip(axes, components, strict=True)]
    k = int(np.argmin(offs))
    # of two axes, which stay square, one is along the normal where the other is across, or both are across
    if offs[k] < max(map(abs, components)):
        others = [abs(c) for i, c in enumerate(components) if i != k]
        return Stance(True, np.copysign(1.0, components[k]) * n, max([offs[k], *others]), k == 1)
    return Stance(False, axes[0], max(map(abs, components)))


def _keeps_upright(kind: Kind, stance: Stance) -> bool:
    """Whether a joint leaves no other motion than turns about the normal and shifts across it."""
    if stance.off > tolerances.FLAT:
        return False
    turns = kind.turn in (NOT_AT_ALL, ABOUT_Z) or (kind.turn is ABOUT_AXIS and stance.along)
    return turns and (not kind.shifts or kind.turn is ABOUT_Z or not stance.along)
