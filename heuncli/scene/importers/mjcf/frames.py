"""Which bodies of MuJoCo's are one body of a spec, and where they stand with every joint at its zero.

A body without joints is fixed to its parent. What has a mass stays a body of its own, on a weld, whose load is told.
What has none is a frame: its points are its parent's. A moving body without mass, which MuJoCo takes where bodies fixed
to it have some, is one with them. What does not move belongs to the ground.

    R_WB  attitude of a body at the zero: R_WP R(body_quat), P its parent
    p_OB  from the origin of the body that it is part of (O), to its own, in axes along the world's
"""

from __future__ import annotations

import math
from typing import Any

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import Matrix, Vec
from heuncli.scene.file_format.turns import IDENTITY, of_quaternion
from heuncli.scene.importers.attitudes import after, shifted, turned, turned_tensor

LEAST_MASS = 1e-15  # MuJoCo's own mjMINVAL: what moves has more
NOWHERE: Vec = (0.0, 0.0, 0.0)


class BodyFrames(NamedTuple):
    """Of each of MuJoCo's bodies: the body that it is part of (0: the ground), its attitude, its origin there."""

    owners: tuple[int, ...]
    attitudes: tuple[Matrix, ...]
    origins: tuple[Vec, ...]

    def place(self, body: int, point: Any) -> Vec:
        """A point of a body, given in the body's own axes: in those of the body that it is part of."""
        return shifted(self.origins[body], turned(self.attitudes[body], vec(point)))

    def direction(self, body: int, axis: Any) -> Vec:
        """A direction of a body."""
        return turned(self.attitudes[body], vec(axis))

    def parts(self, owner: int) -> list[int]:
        """The bodies that are part of one."""
        return [body for body, its in enumerate(self.owners) if its == owner]


def frames_of(model: Any) -> BodyFrames:
    """The frames of a compiled model. Parents stand before their children in it."""
    owners, attitudes, origins = [0], [IDENTITY], [NOWHERE]
    for body in range(1, int(model.nbody)):
        parent = int(model.body_parentid[body])
        attitude = after(attitudes[parent], rotation(model.body_quat[body]))
        holder = owners[parent]
        jointless = not model.body_jntnum[body]
        light = float(model.body_mass[body]) < LEAST_MASS or float(model.body_mass[holder]) < LEAST_MASS
        if jointless and (holder == 0 or light):
            owners.append(holder)
            origins.append(shifted(origins[parent], turned(attitudes[parent], vec(model.body_pos[body]))))
        else:
            owners.append(body)
            origins.append(NOWHERE)
        attitudes.append(attitude)
    return BodyFrames(tuple(owners), tuple(attitudes), tuple(origins))


def rotation(quaternion: Any) -> Matrix:
    """The turn of a quaternion w, x, y, z; exact where it is one by right angles."""
    w, x, y, z = (float(q) for q in quaternion)
    return after(IDENTITY, of_quaternion((w, x, y, z)))


def vec(values: Any) -> Vec:
    """Three numbers."""
    x, y, z = (float(value) + 0.0 for value in values)
    return x, y, z


class PartMass(NamedTuple):
    """Mass [kg], centre of mass [m], inertia about it [kg m^2]; in the body's axes of a spec."""

    mass: float
    center: Vec
    inertia: Matrix


def mass_properties(model: Any, frames: BodyFrames, owner: int) -> PartMass:
    """Of a body with all that is part of it.

    I = sum of I_k + m_k (|d_k|^2 1 - d_k d_k^T), d_k from the common centre to that of part k.
    """
    parts = [_own(model, frames, body) for body in frames.parts(owner) if model.body_mass[body] > 0.0]
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


def _own(model: Any, frames: BodyFrames, body: int) -> PartMass:
    """Of a body by itself: MuJoCo keeps principal moments, and the attitude of their axes in the body."""
    A1, A2, A3 = vec(model.body_inertia[body])
    R = after(frames.attitudes[body], rotation(model.body_iquat[body]))
    center = frames.place(body, model.body_ipos[body])
    principal: Matrix = ((A1, 0.0, 0.0), (0.0, A2, 0.0), (0.0, 0.0, A3))
    return PartMass(float(model.body_mass[body]), center, turned_tensor(R, principal))
