"""The bodies, joints and named points of a spec, of those of MuJoCo's tree.

MuJoCo stacks several joints on one body, such as a hip of three hinges. A spec has a body between any two joints, so a
carrier is put there: a point mass of CARRIER times the mass that it carries. That is below the rounding of any sum it
enters, so results are those without it, and the joints in between can have drives, springs and stops. A body with a
free joint (`freejoint`) has no joint in the spec, and one without joints has a weld.

Bodies are placed with every joint at zero. A body without joints is fixed to its parent. If it has a mass, it stays a
body of its own on a weld, so that the load there is reported. If it has none, it is a frame, and its points belong to
its parent. A moving body without mass, which MuJoCo accepts if bodies fixed to it have some, is merged with them. What
does not move belongs to the ground.

    R_WB  attitude of a body at the zero: R_WP R(body_quat), P its parent
    p_OB  from the origin of the body that it is part of (O), to its own, in axes along the world's
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.loads import Matrix
from heuncli.scene.file_format.models import Vec
from heuncli.scene.file_format.rotations import IDENTITY, rotation_from_quaternion
from heuncli.scene.importers.attitudes import add_vectors, compose_rotations, rotate_tensor, rotate_vector
from heuncli.scene.importers.description import DescribedPoint, Namer, assign_names
from heuncli.scene.importers.mjcf.compiled_model import CompiledModel

# Frames

MIN_MASS = 1e-15  # MuJoCo's own mjMINVAL: moving bodies have more
ORIGIN: Vec = (0.0, 0.0, 0.0)


class BodyFrames(NamedTuple):
    """For each of MuJoCo's bodies: the body that it is part of (0: the ground), its attitude, and its origin in that
    body.
    """

    owners: tuple[int, ...]
    attitudes: tuple[Matrix, ...]
    origins: tuple[Vec, ...]

    def transform_point(self, body: int, point: Any) -> Vec:
        """Transform a point from a body's axes to those of its compound body."""
        return add_vectors(self.origins[body], rotate_vector(self.attitudes[body], to_vec(point)))

    def transform_direction(self, body: int, axis: Any) -> Vec:
        """Transform a direction from a body's axes to those of its compound body."""
        return rotate_vector(self.attitudes[body], to_vec(axis))

    def find_parts(self, owner: int) -> list[int]:
        """List the parts of a compound body."""
        return [body for body, body_owner in enumerate(self.owners) if body_owner == owner]


def compute_frames(model: Any) -> BodyFrames:
    """Compute the frames of a compiled model, in which parents precede their children."""
    owners, attitudes, origins = [0], [IDENTITY], [ORIGIN]
    for body in range(1, int(model.nbody)):
        parent = int(model.body_parentid[body])
        attitude = compose_rotations(attitudes[parent], make_exact_rotation(model.body_quat[body]))
        parent_owner = owners[parent]
        jointless = not model.body_jntnum[body]
        is_massless = float(model.body_mass[body]) < MIN_MASS or float(model.body_mass[parent_owner]) < MIN_MASS
        if jointless and (parent_owner == 0 or is_massless):
            owners.append(parent_owner)
            origins.append(add_vectors(origins[parent], rotate_vector(attitudes[parent], to_vec(model.body_pos[body]))))
        else:
            owners.append(body)
            origins.append(ORIGIN)
        attitudes.append(attitude)
    return BodyFrames(tuple(owners), tuple(attitudes), tuple(origins))


def make_exact_rotation(quaternion: Any) -> Matrix:
    """Make the rotation matrix of a quaternion w, x, y, z; exact for rotations by right angles."""
    w, x, y, z = (float(q) for q in quaternion)
    return compose_rotations(IDENTITY, rotation_from_quaternion((w, x, y, z)))


def to_vec(values: Any) -> Vec:
    """Convert three numbers to a vector of floats."""
    x, y, z = (float(value) + 0.0 for value in values)
    return x, y, z


class PartMass(NamedTuple):
    """Mass [kg], centre of mass [m] and inertia about it [kg m^2] of a part, in the axes of its body in the spec."""

    mass: float
    center: Vec
    inertia: Matrix


def compute_mass_properties(model: Any, frames: BodyFrames, owner: int) -> PartMass:
    """Compute the mass properties of a body together with its parts.

    I = sum of I_k + m_k (|d_k|^2 1 - d_k d_k^T), d_k from the common centre to that of part k.
    """
    parts = [
        _part_mass_properties(model, frames, body) for body in frames.find_parts(owner) if model.body_mass[body] > 0.0
    ]
    if len(parts) == 1:
        return parts[0]
    mass = math.fsum(part.mass for part in parts)
    x, y, z = (math.fsum(part.mass * part.center[i] for part in parts) / mass for i in range(3))
    total = [[0.0] * 3 for _ in range(3)]
    for part in parts:
        d = [a - b for a, b in zip(part.center, (x, y, z), strict=True)]
        square = math.fsum(a * a for a in d)
        for i in range(3):
            for j in range(3):
                total[i][j] += part.inertia[i][j] + part.mass * ((square if i == j else 0.0) - d[i] * d[j])
    return PartMass(mass, (x, y, z), tuple(map(tuple, total)))  # type: ignore[arg-type]


def _part_mass_properties(model: Any, frames: BodyFrames, body: int) -> PartMass:
    """Compute the mass properties of one part. MuJoCo stores principal moments, and the attitude of their axes in the
    body.
    """
    A1, A2, A3 = to_vec(model.body_inertia[body])
    R = compose_rotations(frames.attitudes[body], make_exact_rotation(model.body_iquat[body]))
    center = frames.transform_point(body, model.body_ipos[body])
    principal: Matrix = ((A1, 0.0, 0.0), (0.0, A2, 0.0), (0.0, 0.0, A3))
    return PartMass(float(model.body_mass[body]), center, rotate_tensor(R, principal))


# Tree

CARRIER_MASS_RATIO = 1e-20
GROUND = "ground"
JOINT_TYPES = {"mjJNT_BALL": "ball", "mjJNT_SLIDE": "slide", "mjJNT_HINGE": "pin"}
FREE = "free"
COORDINATE_KEYS = {"pin": "angle", "slide": "travel"}
RATE_KEYS = {"pin": "rate", "slide": "speed"}


class TreeJoint(NamedTuple):
    """A joint of the tree, from one body of the spec to the next.

    joint: its number in MuJoCo; None for a weld
    kind: its type in a spec, or FREE
    body: the body of MuJoCo in whose axes its place and axis are given
    """

    joint: int | None
    kind: str
    body: int
    name: str
    parent: str
    child: str


class JointTree(NamedTuple):
    """The bodies of the spec, and the joints that carry them.

    names: the spec's names of those bodies of MuJoCo that are bodies of the spec (0: the ground)
    originals: their names in MuJoCo
    carriers: the bodies between stacked joints, each with the MuJoCo body that it carries
    """

    names: dict[int, str]
    originals: dict[int, str]
    carriers: dict[str, int]  # the bodies between stacked joints, and the body that they carry
    steps: tuple[TreeJoint, ...]

    @property
    def step_by_joint(self) -> dict[int, TreeJoint]:
        """Return the steps by joint number."""
        return {step.joint: step for step in self.steps if step.joint is not None}


def build_tree(compiled: CompiledModel, frames: BodyFrames) -> JointTree:
    """Build the joint tree of a model."""
    owners = sorted(set(frames.owners) - {0})
    originals = {body: compiled.name("body", body) or f"body_{body}" for body in owners}
    joints = {body: _find_joints(compiled, body) for body in owners}
    joint_originals = {
        joint: _find_joint_name(compiled, originals[body], joint, body_joints)
        for body, body_joints in joints.items()
        for joint, _ in body_joints
    }
    welded = [body for body in owners if not joints[body]]
    names = assign_names("joint", [*joint_originals.values(), *(f"{originals[body]}_weld" for body in welded)])
    joint_names = dict(zip(joint_originals, names, strict=False))
    weld_names = dict(zip(welded, names[len(joint_originals) :], strict=True))
    carriers = [(joint, body) for body in owners for joint, _ in joints[body][:-1]]
    body_names = assign_names(
        "body", [*originals.values(), *(f"{joint_names[joint]}_carrier" for joint, _ in carriers)]
    )
    name_by_body = {0: GROUND, **dict(zip(owners, body_names, strict=False))}
    carrier_names = dict(zip((joint for joint, _ in carriers), body_names[len(owners) :], strict=True))

    def steps() -> Iterator[TreeJoint]:
        for body in owners:
            at = name_by_body[frames.owners[int(compiled.model.body_parentid[body])]]
            for joint, kind in joints[body]:
                child = carrier_names.get(joint, name_by_body[body])
                yield TreeJoint(joint, kind, body, joint_names[joint], at, child)
                at = child
            if body in weld_names:
                yield TreeJoint(None, "weld", body, weld_names[body], at, name_by_body[body])

    return JointTree(name_by_body, originals, {carrier_names[joint]: body for joint, body in carriers}, tuple(steps()))


def _find_joints(compiled: CompiledModel, body: int) -> list[tuple[int, str]]:
    """List the joints of a body and their types, the one nearest to its parent first."""
    kinds = {int(getattr(compiled.mujoco.mjtJoint, word)): kind for word, kind in JOINT_TYPES.items()}
    first = int(compiled.model.body_jntadr[body])
    return [
        (k, kinds.get(int(compiled.model.jnt_type[k]), FREE))
        for k in range(first, first + int(compiled.model.body_jntnum[body]))
    ]


def _find_joint_name(compiled: CompiledModel, body: str, joint: int, body_joints: list[tuple[int, str]]) -> str:
    """Return a joint's name; without one, that of its body, with a number if there are several."""
    position = [number for number, _ in body_joints].index(joint) + 1
    return compiled.name("joint", joint) or (f"{body}_{position}" if len(body_joints) > 1 else body)


# Points


class BodyPoints:
    """Points by body, in the order in which they are added."""

    def __init__(self) -> None:
        self.namers: dict[str, Namer] = {}
        self.points: dict[str, list[DescribedPoint]] = {}

    def add(self, body: str, original: str, place: Vec, remark: str = "") -> str:
        """Add a point and return its end, `body.point`. original: its name, if that is still free."""
        name = self.namers.setdefault(body, Namer("point")).assign(original)
        self.points.setdefault(body, []).append(DescribedPoint(name, place, remark))
        return f"{body}.{name}"

    def get_points(self, body: str) -> tuple[DescribedPoint, ...]:
        """Return the points of a body."""
        return tuple(self.points.get(body, ()))
