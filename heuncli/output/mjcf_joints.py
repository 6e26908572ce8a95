"""The joints of a scene as elements of MJCF: their types, places, axes, and coordinates at the start."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.multibody.mechanism.model import Joint
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.starts import body_state, compute_joint_start, joint_direction
from heuncli.output.robot_tree import PIN_KINDS, PlacedJoint, choose_name, find_attitude, find_axis
from heuncli.results.results import Array

SCALAR_PARTS = {  # elements of a joint, nearest to the parent first: its type in MJCF, heun's quantity
    **dict.fromkeys(PIN_KINDS, (("hinge", "angle"),)),
    "slide": (("slide", "travel"),),
    "cylinder": (("slide", "travel"), ("hinge", "angle")),
    "universal": (("hinge", ""), ("hinge", "")),
    "ball": (("ball", ""),),
    "weld": (),
}
LOOSE_KINDS = ("line", "plane", "flat line", "flat plane")  # slides and a rotation, counted from the start


class JointElement(NamedTuple):
    """A joint of MJCF, in the frame of the body that carries it, with all joints at 0.

    joint, quantity: heun's
    q, v: its coordinates and rates at the start
    """

    name: str
    type: str
    joint: Joint
    quantity: str
    pos: Array
    axis: Array
    q: tuple[float, ...]
    v: tuple[float, ...]


class JointElements:
    """Makes the elements of joints. joint_names: those that are taken; mutable."""

    def __init__(self, scene: PreparedScene, joint_names: set[str]) -> None:
        self.scene, self.mechanism, self.joint_names = scene, scene.mechanism, joint_names

    def make_elements(self, placed: PlacedJoint, pos: Array, turn: Array, end: int) -> list[JointElement]:
        """Make the elements of a joint, nearest to the parent first.

        pos: its point, turn: the axes of its child, both in the body at the end of the chain, whose number is `end`
        """
        if placed.joint.kind in LOOSE_KINDS:
            return self.make_loose_elements(placed, pos, turn, end)
        return [*self.iter_fixed_elements(placed, pos, turn, end)]

    def iter_fixed_elements(self, placed: PlacedJoint, pos: Array, turn: Array, end: int) -> Iterator[JointElement]:
        """Yield the elements of a joint. pos: its point, turn: the axes of its child, both in the body at the end of
        the chain.
        """
        joint, start = placed.joint, self.scene.start
        values = compute_joint_start(self.mechanism, start, joint)
        parts = SCALAR_PARTS[joint.kind]
        attitude = find_attitude(placed, self.scene)
        axis = turn @ find_axis(placed, attitude)
        names = [joint.name]
        if len(parts) > 1:
            names.append(choose_name(f"{joint.name}_2", self.joint_names))
            self.joint_names.add(names[1])
        (_, _, _, wp), (_, Rc, _, wc) = body_state(start, placed.parent), body_state(start, placed.child)
        if joint.kind == "ball":
            rates = start.rotation[end].T @ (wc - wp)  # in the axes of the body that carries it
            yield JointElement(names[0], "ball", joint, "", pos, axis, (1.0, 0.0, 0.0, 0.0), tuple(map(float, rates)))
        elif joint.kind == "universal":
            # the axis that the parent carries comes first; in the axes of the child, with all joints at 0
            first, second = (joint.to_axis, joint.axis) if placed.is_reversed else (joint.axis, joint.to_axis)
            axes = attitude.T @ first, second
            rates = np.linalg.lstsq(np.column_stack([Rc @ own_axis for own_axis in axes]), wc - wp, rcond=None)[0]
            for name, own_axis, rate in zip(names, axes, rates, strict=True):
                yield JointElement(name, "hinge", joint, "", pos, turn @ own_axis, (0.0,), (float(rate),))
        else:
            coordinates = {"angle": (values.angle, values.rate), "travel": (values.travel, values.speed)}
            # the last part has the joint's own name: of a cylinder the hinge, its slide is "_2"; a weld has no part
            for name, (kind, quantity) in zip(reversed(names), parts, strict=False):
                q, v = coordinates[quantity]
                yield JointElement(name, kind, joint, quantity, pos, axis, (q,), (v,))

    def make_loose_elements(self, placed: PlacedJoint, pos: Array, turn: Array, end: int) -> list[JointElement]:
        """Return the slides and the rotation of a joint that holds a point on a line or in a plane of `from`.

        The rotation is about that point, so it comes after the slides if the parent is `from`, else before them.
        """
        joint, start, kind = placed.joint, self.scene.start, JOINTS[placed.joint.kind]
        attitude = find_attitude(placed, self.scene)
        (xa, Ra, va, wa), (xb, Rb, vb, wb) = body_state(start, joint.a), body_state(start, joint.b)
        arm = Rb @ joint.q
        velocity = Ra.T @ (vb + np.cross(wb, arm) - va - np.cross(wa, arm + xb - xa))
        spin = -(wb - wa) if placed.is_reversed else wb - wa
        slides = []
        for shift in kind.hold.shifts:
            direction = joint_direction(joint, shift)
            axis = turn @ (-direction if placed.is_reversed else attitude.T @ direction)
            name = choose_name(f"{joint.name}_2", self.joint_names)
            self.joint_names.add(name)
            slides.append(JointElement(name, "slide", joint, "", pos, axis, (0.0,), (float(direction @ velocity),)))
        pivot = pos - turn @ attitude.T @ find_offset(placed, self.scene) if placed.is_reversed else pos
        if kind.turn.ball and not self.mechanism.planar:
            rates = tuple(map(float, start.rotation[end].T @ spin))
            rotation = JointElement(joint.name, "ball", joint, "", pivot, np.zeros(3), (1.0, 0.0, 0.0, 0.0), rates)
        else:
            axis = np.array([0.0, 0.0, 1.0])
            rotation = JointElement(joint.name, "hinge", joint, "", pivot, axis, (0.0,), (float(spin[2]),))
        return [rotation, *slides] if placed.is_reversed else [*slides, rotation]


def find_offset(placed: PlacedJoint, scene: PreparedScene) -> Array:
    """Return the vector from the parent's point of a joint to the child's, with all joints at 0, in the axes of the
    parent: as at the start, where the joint has no coordinates.
    """
    if placed.joint.kind not in LOOSE_KINDS:
        return np.zeros(3)
    start = scene.start
    (xp, Rp, _, _), (xc, Rc, _, _) = body_state(start, placed.parent), body_state(start, placed.child)
    return np.asarray(Rp.T @ (xc + Rc @ placed.child_point - xp) - placed.parent_point)


class DrawnPose(NamedTuple):
    """Where the child of a joint is with all joints at 0: the joint's point of the child, the child's origin (3,), its
    axes (3, 3).
    """

    point: Array
    origin: Array
    axes: Array


def find_drawn_pose(placed: PlacedJoint, scene: PreparedScene, p: Array, R: Array) -> DrawnPose:
    """Return the drawn pose of a joint's child; p, R: origin and axes of its parent, in the frame that is wanted."""
    point = p + R @ (placed.parent_point + find_offset(placed, scene))
    axes = R @ find_attitude(placed, scene)
    return DrawnPose(point, point - axes @ placed.child_point, axes)
