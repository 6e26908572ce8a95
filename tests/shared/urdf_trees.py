"""Random robots in URDF, and where all of their links are at given positions: kinematics of their own, in NumPy.

Nothing of heun is used. For the tests of `heun import`, and for those that hold it against other programs.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import cos, pi, sin

import numpy as np

from tests.oracle.turns import Array

RIGHT = (0.0, pi / 2, -pi / 2, pi)
MOVED = ("revolute", "continuous", "prismatic")


@dataclass
class Part:
    """A link with the joint above it; numbers as they are written. A mass of None: it has no inertial."""

    name: str
    parent: str
    kind: str
    xyz: Array
    rpy: Array
    axis: Array
    mass: float | None
    center: Array
    inertial_rpy: Array
    inertia: Array

    @property
    def joint(self) -> str:
        return f"to_{self.name}"


@dataclass
class RandomRobot:
    """A tree of parts below a root, which has the mass properties of a part without a joint."""

    root: Part
    parts: list[Part]
    mimics: dict[str, tuple[str, float, float]] = field(default_factory=dict)  # part -> part, multiplier, offset

    @property
    def movable(self) -> list[Part]:
        """The parts whose joints have a position of their own."""
        return [part for part in self.parts if part.kind in MOVED and part.name not in self.mimics]


def turn(axis: Array, angle: float) -> Array:
    """Rodrigues' formula, (3, 3)."""
    n = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    K = np.array([[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]])
    return np.eye(3) + sin(angle) * K + (1.0 - cos(angle)) * (K @ K)


def of_rpy(rpy: Array) -> Array:
    """Roll about x, then pitch about y, then yaw about z, (3, 3)."""
    roll, pitch, yaw = rpy
    return turn(np.array([0, 0, 1]), yaw) @ turn(np.array([0, 1, 0]), pitch) @ turn(np.array([1, 0, 0]), roll)


def random_robot(rng: np.random.Generator, count: int, right: bool = False, frames: float = 0.2) -> RandomRobot:
    """A tree of so many links; right: all angles are right ones; frames: the share of fixed links without mass."""
    root = _part(rng, "base", "", right, 0.0)
    parts: list[Part] = []
    names = ["base"]
    for number in range(count):
        parent = names[int(rng.integers(max(0, len(names) - 4), len(names)))]
        part = _part(rng, f"link{number}", parent, right, frames)
        parts.append(part)
        names.append(part.name)
    robot = RandomRobot(root, parts)
    leaders = [part for part in parts if part.kind in MOVED]
    for part in leaders[2::3]:
        leader = leaders[int(rng.integers(0, 2))]
        robot.mimics[part.name] = (leader.name, float(np.round(rng.normal(), 2)), float(np.round(rng.normal(), 2)))
    return robot


def _part(rng: np.random.Generator, name: str, parent: str, right: bool, frames: float) -> Part:
    kind = str(rng.choice(["revolute", "continuous", "prismatic", "fixed"], p=[0.4, 0.2, 0.2, 0.2]))
    is_frame = bool(parent) and rng.random() < frames
    axes = np.eye(3)[int(rng.integers(3))] * rng.choice([-1.0, 1.0])
    values = np.sort(np.round(rng.uniform(0.01, 0.05, 3), 4))
    values[2] = min(values[2], values[0] + values[1])
    spun = of_rpy(rng.uniform(-pi, pi, 3))
    return Part(
        name,
        parent,
        "fixed" if is_frame else kind,
        np.round(rng.uniform(-0.5, 0.5, 3), 3),
        rng.choice(RIGHT, 3) if right else _angles(rng),
        axes if right else np.round(rng.normal(size=3), 2) + np.array([0.0, 0.0, 0.01]),
        None if is_frame else float(np.round(rng.uniform(0.1, 3.0), 3)),
        np.round(rng.uniform(-0.2, 0.2, 3), 3),
        rng.choice(RIGHT, 3) if right else _angles(rng),
        np.diag(values) if right else spun @ np.diag(values) @ spun.T,
    )


def _angles(rng: np.random.Generator) -> Array:
    """Some right, some not."""
    return np.where(rng.random(3) < 0.5, rng.choice(RIGHT, 3), rng.uniform(-pi, pi, 3))


def urdf_text(robot: RandomRobot, more: str = "") -> str:
    """The robot as a file; more: elements at its end."""
    links = [_link(part) for part in (robot.root, *robot.parts)]
    joints = [_joint(part, robot.mimics.get(part.name)) for part in robot.parts]
    return f'<?xml version="1.0"?>\n<robot name="random">\n{"".join(links)}{"".join(joints)}{more}</robot>\n'


def _link(part: Part) -> str:
    if part.mass is None:
        return f'  <link name="{part.name}"/>\n'
    xx, xy, xz, yy, yz, zz = part.inertia[np.triu_indices(3)].tolist()
    return (
        f'  <link name="{part.name}">\n    <inertial>\n'
        f'      <origin xyz="{_row(part.center)}" rpy="{_row(part.inertial_rpy)}"/>\n'
        f'      <mass value="{part.mass!r}"/>\n'
        f'      <inertia ixx="{xx!r}" ixy="{xy!r}" ixz="{xz!r}" iyy="{yy!r}" iyz="{yz!r}" izz="{zz!r}"/>\n'
        "    </inertial>\n  </link>\n"
    )


def _joint(part: Part, mimic: tuple[str, float, float] | None) -> str:
    follows = f'    <mimic joint="to_{mimic[0]}" multiplier="{mimic[1]!r}" offset="{mimic[2]!r}"/>\n' if mimic else ""
    return (
        f'  <joint name="{part.joint}" type="{part.kind}">\n    <parent link="{part.parent}"/>\n'
        f'    <child link="{part.name}"/>\n    <origin xyz="{_row(part.xyz)}" rpy="{_row(part.rpy)}"/>\n'
        f'    <axis xyz="{_row(part.axis)}"/>\n{follows}  </joint>\n'
    )


def _row(v: Array) -> str:
    return " ".join(repr(float(x)) for x in v)


@dataclass
class Frame:
    """Where a link is: origin [m] and attitude in the world; and the joint's axis, a unit vector in the world."""

    origin: Array
    R: Array
    axis: Array


def frames_at(robot: RandomRobot, positions: dict[str, float]) -> dict[str, Frame]:
    """All links where the joints of the parts named have these positions [rad, m]; all others that move follow."""
    q = {**positions, **{name: k * positions[of] + c for name, (of, k, c) in robot.mimics.items()}}
    found = {robot.root.name: Frame(np.zeros(3), np.eye(3), np.zeros(3))}
    for part in robot.parts:
        above = found[part.parent]
        zero = above.R @ of_rpy(part.rpy)
        axis = zero @ (part.axis / np.linalg.norm(part.axis))
        origin, R = above.origin + above.R @ part.xyz, zero
        if part.kind == "prismatic":
            origin = origin + axis * q[part.name]
        elif part.kind in MOVED:
            R = turn(axis, q[part.name]) @ zero
        found[part.name] = Frame(origin, R, axis)
    return found


def holding_efforts(robot: RandomRobot, frames: dict[str, Frame], g: float = 9.81) -> dict[str, float]:
    """What holds each joint that moves against the weight of all that it carries [N m, N], by part."""
    carried = {part.name: [part] for part in robot.parts}
    for part in reversed(robot.parts):
        if part.parent in carried:
            carried[part.parent] += carried[part.name]
    efforts: dict[str, float] = {}
    for part in robot.parts:
        if part.kind not in MOVED:
            continue
        at = frames[part.name]
        heavy = [(one, one.mass) for one in carried[part.name] if one.mass]
        weights = [(center_of(one, frames), np.array([0.0, 0.0, -mass * g])) for one, mass in heavy]
        if part.kind == "prismatic":
            efforts[part.name] = -sum(float(at.axis @ weight) for _, weight in weights)
        else:
            efforts[part.name] = -sum(float(at.axis @ np.cross(x - at.origin, weight)) for x, weight in weights)
    return efforts


def center_of(part: Part, frames: dict[str, Frame]) -> Array:
    """The centre of mass of a link in the world [m]."""
    frame = frames[part.name]
    return frame.origin + frame.R @ part.center


def inertia_of(part: Part, frames: dict[str, Frame]) -> Array:
    """The inertia of a link about its centre of mass, world axes [kg m^2]."""
    R = frames[part.name].R @ of_rpy(part.inertial_rpy)
    return R @ part.inertia @ R.T
