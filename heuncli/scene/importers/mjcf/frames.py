"""Merge MuJoCo's bodies into bodies of a spec, and place them with every joint at zero.

A body without joints is fixed to its parent. If it has a mass, it stays a body of its own on a weld, so that the load
there is reported. If it has none, it is a frame, and its points belong to its parent. A moving body without mass, which
MuJoCo accepts if bodies fixed to it have some, is merged with them. What does not move belongs to the ground.

    R_WB  attitude of a body at the zero: R_WP R(body_quat), P its parent
    p_OB  from the origin of the body that it is part of (O), to its own, in axes along the world's
"""

from __future__ import annotations

import math
from typing import Any

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import Matrix, Vec
from heuncli.scene.file_format.rotations import IDENTITY, rotation_from_quaternion
from heuncli.scene.importers.attitudes import add_vectors, compose_rotations, rotate_tensor, rotate_vector

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
        """Transform a point from a body's own axes to those of the body that it is part of."""
        return add_vectors(self.origins[body], rotate_vector(self.attitudes[body], to_vec(point)))

    def transform_direction(self, body: int, axis: Any) -> Vec:
        """Transform a direction from a body's own axes to those of the body that it is part of."""
        return rotate_vector(self.attitudes[body], to_vec(axis))

    def find_parts(self, owner: int) -> list[int]:
        """List the bodies that are part of one."""
        return [body for body, body_owner in enumerate(self.owners) if body_owner == owner]


def compute_frames(model: Any) -> BodyFrames:
    """Compute the frames of a compiled model, in which parents precede their children."""
    owners, attitudes, origins = [0], [IDENTITY], [ORIGIN]
    for body in range(1, int(model.nbody)):
        parent = int(model.body_parentid[body])
        attitude = compose_rotations(attitudes[parent], exact_rotation_from_quaternion(model.body_quat[body]))
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


def exact_rotation_from_quaternion(quaternion: Any) -> Matrix:
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


def mass_properties(model: Any, frames: BodyFrames, owner: int) -> PartMass:
    """Compute the mass properties of a body with all that is part of it.

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
    R = compose_rotations(frames.attitudes[body], exact_rotation_from_quaternion(model.body_iquat[body]))
    center = frames.transform_point(body, model.body_ipos[body])
    principal: Matrix = ((A1, 0.0, 0.0), (0.0, A2, 0.0), (0.0, 0.0, A3))
    return PartMass(float(model.body_mass[body]), center, rotate_tensor(R, principal))
