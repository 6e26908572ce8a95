"""What Pinocchio says of a robot that is moved as asked: loads, accelerations, masses, momentum; world axes.

Imports pinocchio where it is asked, not before: a third of a second.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from heuncli.results.results import Array

Pair = tuple[Array, Array]


@dataclass(frozen=True, eq=False)
class Asked:
    """Coordinates and rates of the joints by the file's names; accelerations of those that are driven.

    The others are pushed by `efforts`, or by nothing. bases: of joints of several freedoms, coordinates and rates as
    Pinocchio has them.
    """

    q: Mapping[str, float]
    v: Mapping[str, float]
    a: Mapping[str, float]
    bases: Mapping[str, Pair] = field(default_factory=dict)
    efforts: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Carried:
    """What a joint transmits to its child, its effort along the axis included; moment about the child's origin.

    effort: along or about the axis; axis: in the world, of what moves along it `slides`; zeros where it has several.
    """

    origin: Array
    force: Array
    moment: Array
    effort: float
    axis: Array
    slides: bool
    acceleration: float


@dataclass(frozen=True, eq=False)
class LinkMotion:
    """Where a link is: its origin, its attitude against that with every joint at zero, and their rates."""

    position: Array
    rotation: Array
    velocity: Array
    angular_velocity: Array


@dataclass(frozen=True, eq=False)
class Answer:
    """The joints of one freedom, and those of several, by their names; links; of all of it mass, centre and so on.

    What stands on the ground counts.
    """

    joints: dict[str, Carried]
    bases: dict[str, Carried]
    links: dict[str, LinkMotion]
    mass: float
    center: Array
    momentum: Array
    moment_of_momentum: Array
    kinetic: float
    potential: float


class Robot:
    """A robot as Pinocchio reads it: on a fixed base, or on one that floats."""

    def __init__(self, text: str, *, base_free: bool = False, gravity: float = -9.81) -> None:
        import pinocchio as pin

        root = (pin.JointModelFreeFlyer(),) if base_free else ()
        self.model: Any = pin.buildModelFromXML(text, *root)
        self.model.gravity.linear = np.array([0.0, 0.0, gravity])
        self.gravity = gravity

    def drawn(self, seed: int, size: tuple[float, float, float] = (2.0, 3.0, 10.0)) -> Asked:
        """A state and accelerations, drawn."""
        rng = np.random.default_rng(seed)
        single: dict[str, list[float]] = {}
        bases: dict[str, Pair] = {}
        for name, joint in self._joints():
            if joint.nv == 1:
                single[name] = [float(s * rng.uniform(-1, 1)) for s in size]
            elif joint.nv > 1:
                q = rng.uniform(-1, 1, joint.nq)
                turn = slice(joint.nq - {6: 4, 3: 2}[joint.nv], None)  # a quaternion, or cosine and sine
                q[turn] /= np.linalg.norm(q[turn])
                bases[name] = q, rng.uniform(-1, 1, joint.nv)
        q_, v_, a_ = ({name: values[k] for name, values in single.items()} for k in range(3))
        return Asked(q_, v_, a_, bases)

    def answer(self, asked: Asked) -> Answer:
        """What becomes of the state."""
        import pinocchio as pin

        model, data = self.model, self.model.createData()
        zero = pin.neutral(model)
        pin.framesForwardKinematics(model, data, zero)
        attitudes = [frame.rotation.copy() for frame in data.oMf]
        q, v = zero.copy(), np.zeros(model.nv)
        self._place(asked, q, v)
        a = self._accelerations(data, asked, q, v)
        efforts = np.array(pin.rnea(model, data, q, v, a))
        wrenches = [data.f[number].copy() for number in range(model.njoints)]
        pin.forwardKinematics(model, data, q, v)
        pin.updateFramePlacements(model, data)
        links = self._links(data, attitudes)
        carried = {
            model.names[number]: self._carried(data, number, efforts, wrenches[number], a)
            for number in range(1, model.njoints)
        }
        one = {name for name, joint in self._joints() if joint.nv == 1}
        pin.computeCentroidalMomentum(model, data, q, v)
        center, momentum = np.array(pin.centerOfMass(model, data, q)), np.array(data.hg.linear)
        moved, stands = float(pin.computeTotalMass(model)), model.inertias[0]
        mass = moved + stands.mass
        middle = (moved * center + stands.mass * stands.lever) / mass
        return Answer(
            {name: joint for name, joint in carried.items() if name in one},
            {name: joint for name, joint in carried.items() if name not in one},
            links, mass, middle, momentum, np.array(data.hg.angular) + np.cross(center, momentum),
            float(pin.computeKineticEnergy(model, data, q, v)), -self.gravity * mass * float(middle[2]),
        )  # fmt: skip

    def _joints(self) -> list[tuple[str, Any]]:
        """All but the first, which is none."""
        return [*zip(self.model.names, self.model.joints, strict=True)][1:]

    def _place(self, asked: Asked, q: Array, v: Array) -> None:
        """Coordinates and rates as Pinocchio has them; of a continuous joint (cos, sin)."""
        for name, joint in self._joints():
            of_q, of_v = slice(joint.idx_q, joint.idx_q + joint.nq), slice(joint.idx_v, joint.idx_v + joint.nv)
            if name in asked.bases:
                q[of_q], v[of_v] = asked.bases[name]
            elif joint.nv == 1:
                x = asked.q[name]
                q[of_q], v[of_v] = x if joint.nq == 1 else (np.cos(x), np.sin(x)), asked.v[name]

    def _accelerations(self, data: Any, asked: Asked, q: Array, v: Array) -> Array:
        """Those asked for; the others from the equations of motion with no effort there, by aba where all are free."""
        import pinocchio as pin

        model = self.model
        if not asked.a:
            pushed = np.zeros(model.nv)
            for name, effort in asked.efforts.items():
                pushed[model.joints[model.getJointId(name)].idx_v] = effort
            return np.array(pin.aba(model, data, q, v, pushed))
        a, driven = np.zeros(model.nv), np.zeros(model.nv, dtype=bool)
        for name, value in asked.a.items():
            joint = model.joints[model.getJointId(name)]
            a[joint.idx_v], driven[joint.idx_v] = value, True
        if not driven.all():
            upper = np.triu(np.array(pin.crba(model, data, q)))
            M, h = upper + np.triu(upper, 1).T, np.array(pin.nonLinearEffects(model, data, q, v))
            a[~driven] = np.linalg.solve(M[~driven][:, ~driven], -(h[~driven] + M[~driven][:, driven] @ a[driven]))
        return a

    def _carried(self, data: Any, number: int, efforts: Array, wrench: Any, a: Array) -> Carried:
        """What a joint transmits, turned from its own axes into the world's."""
        where, joint = data.oMi[number], self.model.joints[number]
        origin, force, moment = np.array(where.translation), where.rotation @ wrench.linear, wrench.angular
        moment = where.rotation @ moment
        if joint.nv > 1:
            return Carried(origin, force, moment, 0.0, np.zeros(3), False, 0.0)
        twist = np.ravel(data.joints[number].S)  # the free direction in the joint's axes: linear, then angular half
        slides = bool(np.any(twist[:3]))
        axis = where.rotation @ (twist[:3] if slides else twist[3:])
        return Carried(origin, force, moment, float(efforts[joint.idx_v]), axis, slides, float(a[joint.idx_v]))

    def _links(self, data: Any, attitudes: list[Array]) -> dict[str, LinkMotion]:
        import pinocchio as pin

        found: dict[str, LinkMotion] = {}
        for number, frame in enumerate(self.model.frames):
            if frame.type == pin.FrameType.BODY:
                where = data.oMf[number]
                rate = pin.getFrameVelocity(self.model, data, number, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
                turned = where.rotation @ attitudes[number].T
                found[frame.name] = LinkMotion(
                    np.array(where.translation), turned, np.array(rate.linear), np.array(rate.angular)
                )
        return found


def holding_with_mimics(text: str, seed: int, leaders: Collection[str]) -> dict[str, tuple[float, float]] | None:
    """Positions drawn for the joints that follow none, and what holds each with all that follow it; None: not read."""
    import pinocchio as pin

    try:
        model = pin.buildModelFromXML(text, True)
    except ValueError:
        return None
    rng = np.random.default_rng(seed)
    places = {name: float(rng.uniform(-1, 1)) for name in leaders}
    q = pin.neutral(model)
    for name, position in places.items():
        q[model.joints[model.getJointId(name)].idx_q] = position
    efforts = pin.rnea(model, model.createData(), q, np.zeros(model.nv), np.zeros(model.nv))
    return {name: (at, float(efforts[model.joints[model.getJointId(name)].idx_v])) for name, at in places.items()}
