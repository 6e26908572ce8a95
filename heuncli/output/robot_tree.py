"""What the files of robot programs have in common: a tree of joints, poses with all joints at 0, limits, notes.

The coordinates in the file are heun's: 0 where heun's angle or travel is 0. A joint that heun counts from the child to
the parent has the opposite axis, so its values stay.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from itertools import count

import numpy as np

from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import list_words
from heuncli.base.text_safety import escape
from heuncli.multibody.mechanism.loads import GROUND, JointLoad
from heuncli.multibody.mechanism.model import Joint, Mechanism
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.starts import body_state, compute_joint_start
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Shape, Spec, Stop

ATTITUDE_ROUNDING = 1e-14  # of the elements of a rotation
START_ROUNDING = 1e-9  # of start coordinates and velocities [rad, m, rad/s, m/s]
WORLD = "world"
PIN_KINDS = ("pin", "spun pin")  # the latter in a planar scene, on a body without moment of inertia
LEFT_OUT_BLOCKS = ("drives", "impulses", "latches", "sections")
LimitKey = tuple[str, str]  # name of the joint, quantity


class PlacedJoint(NamedTuple):
    """A joint of the tree, with its parent and child; number GROUND is the ground."""

    joint: Joint
    parent: int
    child: int

    @property
    def is_reversed(self) -> bool:
        """Whether the child is the `from` body."""
        return self.child == self.joint.a

    @property
    def parent_point(self) -> Array:
        """The joint's point (3,) of the parent, its axes."""
        return self.joint.q if self.is_reversed else self.joint.p

    @property
    def child_point(self) -> Array:
        """The joint's point (3,) of the child, its axes."""
        return self.joint.p if self.is_reversed else self.joint.q


class JointForest(NamedTuple):
    """The joints from the ground outward, then those of free machines; and those that close loops."""

    tree: tuple[PlacedJoint, ...]
    closures: tuple[Joint, ...]


def grow_forest(mechanism: Mechanism, rank: Callable[[Joint], int | None] = lambda _: 0) -> JointForest:
    """Grow trees from the ground and from free bodies, nearest joints first.

    rank: of the joints that can go on, those of the lowest rank are taken; None: never in a tree
    """
    joints_at: dict[int, list[int]] = {}
    for k, joint in enumerate(mechanism.joints):
        joints_at.setdefault(joint.a, []).append(k)
        joints_at.setdefault(joint.b, []).append(k)
    tree: list[PlacedJoint] = []
    closures: dict[int, Joint] = {}
    reached, used, order = set[int](), set[int](), count()

    def reach(body: int, front: list[tuple[int, int, int, int]]) -> None:
        """Add a body, with the joints that go on from it."""
        reached.add(body)
        for k in joints_at.get(body, ()):
            place = rank(mechanism.joints[k])
            if place is None:
                closures[k] = mechanism.joints[k]
            elif k not in used:
                heapq.heappush(front, (place, next(order), k, body))

    for root in (GROUND, *range(len(mechanism.bodies))):
        front: list[tuple[int, int, int, int]] = []  # rank, order of discovery, joint, body that it is reached from
        if root not in reached:
            reach(root, front)
        while front:
            _, _, k, parent = heapq.heappop(front)
            if k in used:
                continue
            used.add(k)
            joint = mechanism.joints[k]
            child = joint.b if parent == joint.a else joint.a
            if child in reached:
                closures[k] = joint
                continue
            tree.append(PlacedJoint(joint, parent, child))
            reach(child, front)
    return JointForest(tuple(tree), tuple(closures[k] for k in sorted(closures)))


def find_axis(placed: PlacedJoint, attitude: Array) -> Array:
    """Return the axis of a joint in the axes of its child (3,), with the sign of heun's coordinate.

    attitude: of the child in the parent with the joint at 0
    """
    return -placed.joint.axis if placed.is_reversed else attitude.T @ placed.joint.axis


def find_attitude(placed: PlacedJoint, scene: PreparedScene) -> Array:
    """Return the axes of the child in those of the parent (3, 3) with the joint at 0."""
    R = compute_joint_start(scene.mechanism, scene.start, placed.joint).R_ref
    return R.T if placed.is_reversed else R


def find_limits(mechanism: Mechanism) -> dict[LimitKey, Stop[int]]:
    """Return the first stop with two limits of each pin, slide or cylinder, by joint and quantity."""
    limits: dict[LimitKey, Stop[int]] = {}
    for stop in mechanism.stops:
        if stop.latch is None and stop.low is not None and stop.high is not None and stop.quantity != "length":
            limits.setdefault((mechanism.joints[stop.joint].name, stop.quantity), stop)
    return limits


def is_linear_damper(load: object) -> bool:
    """Return whether a load is a damper in a joint that a coefficient describes; one with a law is of another kind."""
    return isinstance(load, JointLoad) and load.kind == "damper"


# Notes


def list_left_out(
    spec: Spec, mechanism: Mechanism, written_forces: Collection[str], limits: Mapping[LimitKey, Stop[int]]
) -> list[str]:
    """Say in sentences which entries the file does not hold. written_forces, limits: names and stops that it holds"""
    stops = {stop.name for stop in limits.values()}
    notes = []
    if mechanism.planar:
        notes.append("the model is planar: of each inertia the moments about x and y have no meaning")
    for block in (*LEFT_OUT_BLOCKS, "stops", "forces"):
        written = {"stops": stops, "forces": written_forces}.get(block, ())
        names = [name for name in getattr(spec, block) if name not in written]
        if names:
            notes.append(f"{block} left out: {list_words(names)}")
    return notes


def list_start_notes(scene: PreparedScene, tree: Sequence[PlacedJoint]) -> Iterator[str]:
    """Yield sentences on start values, where the file starts at rest with all coordinates at 0."""
    start, moved = scene.start, []
    for placed in tree:
        joint = placed.joint
        values = compute_joint_start(scene.mechanism, start, joint)
        (xa, Ra, _, _), (xb, Rb, _, _) = body_state(start, joint.a), body_state(start, joint.b)
        gap = Ra.T @ (xb + Rb @ joint.q - xa) - joint.p
        turn = Ra.T @ Rb - values.R_ref
        reach = 1.0 + float(np.abs(xa).max())
        if np.abs(turn).max() > START_ROUNDING or np.abs(gap).max() > START_ROUNDING * reach:
            moved.append(joint.name)
    if moved:
        yield f"start coordinates left out: {list_words(moved)}"
    rates = np.abs(np.hstack([start.velocity, start.angular_velocity])).max(axis=1, initial=0.0)
    moving = [body.name for body, rate in zip(scene.mechanism.bodies, rates, strict=True) if rate > START_ROUNDING]
    if moving:
        yield f"start velocities left out: {list_words(moving)}"


def make_joint_problems(spec: Spec, joints: Sequence[Joint], code: str, reason: str, hint: str) -> list[Problem]:
    """Make a problem for each joint. reason: with {name} and {kind}"""
    return [
        Problem(code, reason.format(name=joint.name, kind=joint.kind), spec.location(f"joints.{joint.name}"), hint)
        for joint in joints
    ]


def make_coupling_problems(spec: Spec, names: Collection[str], form: str, code: str) -> list[Problem]:
    """Make a problem for each coupling or wheel with these names."""
    problems = []
    for name in names:
        is_wheel = name in spec.rolling
        what = "wheel" if is_wheel else f"coupling of type {spec.couplings[name].type}"
        place = spec.location(f"{'rolling' if is_wheel else 'couplings'}.{name}")
        problems.append(
            Problem(code, f"a {what} has no counterpart in {form}", place, "leave it out of the exported spec")
        )
    return problems


# Parts


def list_free_points(spec: Spec, mechanism: Mechanism) -> Iterator[tuple[int, str, Array]]:
    """Yield the named points that are no joint's: body, name, place (3,) in its axes."""
    used = {(joint.a, joint.p_name) for joint in mechanism.joints} | {
        (joint.b, joint.q_name) for joint in mechanism.joints
    }
    for i, body in enumerate(mechanism.bodies):
        for name, place in spec.bodies[body.name].points.items():
            if (i, name) not in used:
                yield i, name, np.array(place)


def place_shape(shape: Shape) -> tuple[Array, Array, tuple[float, ...]] | None:
    """Return the centre [m], the axes and the sizes of a box (x, y, z), a sphere (radius), or a cylinder along z
    (radius, length); None for other shapes.
    """
    R = np.eye(3) if shape.rotation is None else np.array(shape.rotation)
    if shape.type == "box" and shape.center is not None and shape.size is not None:
        return np.array(shape.center), R, shape.size
    if shape.type == "sphere" and shape.center is not None and shape.radius is not None:
        return np.array(shape.center), np.eye(3), (shape.radius,)
    if shape.type == "cylinder" and shape.from_ is not None and shape.to is not None and shape.radius is not None:
        along = np.array(shape.to) - np.array(shape.from_)
        length = float(np.linalg.norm(along))
        return 0.5 * (np.array(shape.from_) + np.array(shape.to)), align_z(along / length), (shape.radius, length)
    return None


def align_z(direction: Array) -> Array:
    """Return a rotation (3, 3) that takes the z axis to a direction (3,) of length 1."""
    first = np.cross(np.eye(3)[int(np.argmin(np.abs(direction)))], direction)
    first /= np.linalg.norm(first)
    return np.column_stack([first, np.cross(direction, first), direction])


# Numbers and texts


def clean_rotation(R: Array) -> Array:
    """Return a rotation with the rounding of right angles taken out."""
    return np.where(np.abs(R - np.round(R)) < ATTITUDE_ROUNDING, np.round(R), R)


def choose_name(name: str, others: Collection[str]) -> str:
    """Return a name that no other has, with as many underscores behind it as that needs."""
    while name in others:
        name += "_"
    return name


def format_numbers(values: Sequence[float] | Array) -> str:
    """Format numbers with all their digits."""
    return " ".join(repr(float(value) + 0.0) for value in values)


def format_line(text: str) -> str:
    """Return a text of the spec on one line of XML."""
    return escape(text).replace("<", "(").replace(">", ")").replace("&", "+")
