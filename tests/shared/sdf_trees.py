"""The random robots of urdf_trees.py as SDF: poses as URDF has them, or relative to whatever comes.

Nothing of heun is used.
"""

from __future__ import annotations

from math import degrees

import numpy as np

from tests.oracle.turns import Array
from tests.shared.urdf_trees import MOVED, Part, RandomRobot, of_rpy, turn


def sdf_text(robot: RandomRobot) -> str:
    """The robot with the numbers of its URDF: each joint in its parent, each link in its joint."""
    links = [_link(robot.root, "")]
    joints: list[str] = []
    for part in robot.parts:
        pose = f'<pose relative_to="{part.parent}">{_row(part.xyz)} {_row(part.rpy)}</pose>'
        if part.mass is None:
            joints.append(f'<frame name="{part.name}" attached_to="{part.parent}">{pose}</frame>\n')
            continue
        links.append(_link(part, f'<pose relative_to="{part.joint}"/>'))
        joints.append(_joint(robot, part, pose, f"<xyz>{_row(part.axis)}</xyz>"))
    return f'<sdf version="1.11"><model name="random">\n{"".join(links)}{"".join(joints)}</model></sdf>\n'


def scattered_sdf_text(robot: RandomRobot, rng: np.random.Generator, model: Array) -> str:
    """The robot placed by `model` (4, 4) in a world whose gravity turns with it: its poses relative to anything, angles
    in degrees or as quaternions, joints beside the origins of their children, axes along other frames.
    """
    zero = poses_at_zero(robot)
    names = [robot.root.name]
    links = [_link(robot.root, _pose(np.eye(4), None, rng))]
    joints: list[str] = []
    for part in robot.parts:
        base = str(rng.choice([*names, "__model__"]))
        in_base = np.linalg.inv(zero.get(base, np.eye(4))) @ zero[part.name]
        is_default = base == "__model__" and part.mass is not None and rng.random() < 0.5  # a frame's is another
        pose = _pose(in_base, None if is_default else base, rng)
        names.append(part.name)
        if part.mass is None:
            links.append(f'<frame name="{part.name}" attached_to="{part.parent}">{pose}</frame>\n')
            continue
        links.append(_link(part, pose))
        n = part.axis / np.linalg.norm(part.axis)
        shift = np.eye(4)
        shift[:3, 3] = n * float(rng.normal())
        shift[:3, :3] = turn(rng.normal(size=3), float(rng.uniform(-3, 3)))
        frame = str(rng.choice([*names, "__model__"]))
        along = zero.get(frame, np.eye(4))[:3, :3].T @ zero[part.name][:3, :3] @ n
        pose = "" if rng.random() < 0.3 else _pose(shift, None if rng.random() < 0.5 else part.name, rng)
        axis = f'<xyz expressed_in="{frame}">{_row(along)}</xyz>'
        joints.append(_joint(robot, part, pose, axis))
    gravity = _row(model[:3, :3] @ np.array([0.0, 0.0, -9.81]))
    parts = [*links, *joints]
    order = rng.permutation(len(parts))
    first = [part for part in parts if part.startswith('<link name="base"')]
    text = "".join([*first, *(parts[k] for k in order if parts[k] not in first)])
    world = f'<gravity>{gravity}</gravity><model name="random">{_pose(model, None, rng)}\n{text}</model>'
    return f'<sdf version="1.11"><world name="w">{world}</world></sdf>\n'


def poses_at_zero(robot: RandomRobot) -> dict[str, Array]:
    """The poses (4, 4) of all links in the model with every joint at 0."""
    zero = {robot.root.name: np.eye(4)}
    for part in robot.parts:
        X = np.eye(4)
        X[:3, :3], X[:3, 3] = of_rpy(part.rpy), part.xyz
        zero[part.name] = zero[part.parent] @ X
    return zero


def _pose(X: Array, base: str | None, rng: np.random.Generator) -> str:
    """A pose in one of the three forms that SDF has."""
    relative = f' relative_to="{base}"' if base else ""
    R, place = X[:3, :3], _row(X[:3, 3])
    pitch = float(np.arctan2(-R[2, 0], np.hypot(R[0, 0], R[1, 0])))
    if np.hypot(R[0, 0], R[1, 0]) < 1e-9:
        angles = np.array([np.arctan2(-R[1, 2], R[1, 1]), pitch, 0.0])
    else:
        angles = np.array([np.arctan2(R[2, 1], R[2, 2]), pitch, np.arctan2(R[1, 0], R[0, 0])])
    form = int(rng.integers(3))
    if form == 0:
        return f"<pose{relative}>{place} {_row(angles)}</pose>"
    if form == 1:
        return f'<pose{relative} degrees="true">{place} {_row(np.array([*map(degrees, angles)]))}</pose>'
    half = angles / 2.0
    q = np.array([0.0, 0.0, 0.0, 1.0])
    for axis in (2, 1, 0):  # yaw, pitch, roll
        step = np.zeros(4)
        step[axis], step[3] = np.sin(half[axis]), np.cos(half[axis])
        q = _times(q, step)
    return f'<pose{relative} rotation_format="quat_xyzw">{place} {_row(q * 2.0)}</pose>'


def _times(p: Array, q: Array) -> Array:
    """The product of two quaternions x, y, z, w."""
    v = p[3] * q[:3] + q[3] * p[:3] + np.cross(p[:3], q[:3])
    return np.array([*v, p[3] * q[3] - p[:3] @ q[:3]])


def _link(part: Part, pose: str) -> str:
    xx, xy, xz, yy, yz, zz = part.inertia[np.triu_indices(3)].tolist()
    moments = {"ixx": xx, "ixy": xy, "ixz": xz, "iyy": yy, "iyz": yz, "izz": zz}
    inertia = "".join(f"<{tag}>{value!r}</{tag}>" for tag, value in moments.items())
    return (
        f'<link name="{part.name}">{pose}<inertial><pose>{_row(part.center)} {_row(part.inertial_rpy)}</pose>'
        f"<mass>{part.mass!r}</mass><inertia>{inertia}</inertia></inertial></link>\n"
    )


def _joint(robot: RandomRobot, part: Part, pose: str, axis: str) -> str:
    mimic = robot.mimics.get(part.name)
    follows = ""
    if mimic is not None:
        follows = (
            f'<mimic joint="to_{mimic[0]}"><multiplier>{mimic[1]!r}</multiplier><offset>{mimic[2]!r}</offset></mimic>'
        )
    turned = f"<axis>{axis}{follows}</axis>" if part.kind in MOVED else ""
    return (
        f'<joint name="{part.joint}" type="{part.kind}">{pose}<parent>{part.parent}</parent>'
        f"<child>{part.name}</child>{turned}</joint>\n"
    )


def _row(v: Array) -> str:
    return " ".join(repr(float(x)) for x in v)
