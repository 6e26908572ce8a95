"""Compute the energy and its balance, and Heun's system vector B (44)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.loads.kinetostatics.actions import AppliedLoad
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.loads.kinetostatics.foundation import inertia_loads
from heuncli.loads.kinetostatics.reactions import JointLoads
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Block
from heuncli.scene.shapes.rotations import cross_rows


def energy_block(layout: Layout, evaluation: Evaluation, states: BodyStates) -> Block:
    """Return kinetic energy, potential energy (gravity from the world's origin, loads), work of all else, (n_t,)
    [J].
    """
    mechanism = layout.mechanism
    m = np.array([b.mass for b in mechanism.bodies])
    inertia = np.array([b.inertia for b in mechanism.bodies])
    w = np.einsum("tnji,tnj->tni", states.R, states.omega)
    kinetic = 0.5 * np.einsum("n,tni,tni->t", m, states.v_centre, states.v_centre)
    kinetic = kinetic + 0.5 * np.einsum("tni,nij,tnj->t", w, inertia, w)
    potential = -np.einsum("n,tni,i->t", m, states.centre, mechanism.gravity)
    potential = potential + evaluation.loads["potential"].sum(axis=1)
    work = evaluation.states[:, layout.work_at] if layout.work_at >= 0 else np.zeros_like(kinetic)
    return {"kinetic": kinetic, "potential": potential, "work": work}


def system_vector(mechanism: Mechanism, states: BodyStates) -> Block:
    """Return B = m x_s. x x_s.. + (sigma.I sigma) sigma + T_s (sigma x sigma.), T_s = tr(I)/2 - I; (44) of any body.

    Its second part is that of the energy, 2 E sigma, the third the deviation G, which vanishes where the axis of
    rotation is fixed. manual/theory.md, "System vector".
    """
    m = np.array([b.mass for b in mechanism.bodies])
    inertia = np.array([b.inertia for b in mechanism.bodies])
    w = np.einsum("tnji,tnj->tni", states.R, states.omega)
    u = np.einsum("tnji,tnj->tni", states.R, states.alpha)
    T = 0.5 * np.trace(inertia, axis1=1, axis2=2)[:, None, None] * np.eye(3) - inertia
    twice_e = np.einsum("tni,nij,tnj->tn", w, inertia, w)
    by_energy = twice_e[:, :, None] * states.omega
    G = np.einsum("tnij,njk,tnk->tni", states.R, T, cross_rows(w, u))
    B = m[:, None] * cross_rows(states.v_centre, states.a_centre) + by_energy + G
    parts = {"bodies": B, "energy_part": by_energy, "deviation_part": G}
    by_body = {key: {b.name: part[:, i] for i, b in enumerate(mechanism.bodies)} for key, part in parts.items()}
    return {"total": B.sum(axis=1)} | by_body


def power_imbalance(
    layout: Layout,
    states: BodyStates,
    loads: Sequence[AppliedLoad],
    joints: Sequence[JointLoads],
    couplings: Sequence[CouplingLoads],
    span: float,
) -> float:
    """Return the largest |P - d(T + V)/dt| over the instants, times `span` [J], for a motion that is not integrated.

    P of loads and drives follows from the rates of the points and joints they act on, the rest from velocities and
    accelerations.
    """
    mechanism = layout.mechanism
    ma, spin = inertia_loads(mechanism, states)
    weight = np.array([b.mass for b in mechanism.bodies])[:, None] * mechanism.gravity
    gain = np.einsum("tni,tni->t", states.v_centre, ma - weight) + np.einsum("tni,tni->t", states.omega, spin)
    power = np.zeros(len(gain))
    for load in loads:
        power = power + load.power
    for joint in joints:
        if joint.drive is not None and joint.joint.drive is not None:
            power = power + joint.drive * drive_rate(states, joint)
    for coupling in couplings:
        if coupling.coupling.law is not None or coupling.coupling.stretched_row is not None:
            power = power + rope_power(states, coupling)
    return float(np.abs(power - gain).max(initial=0.0)) * span


def work_scale(mechanism: Mechanism, largest: Sequence[tuple[float, float]], size: float, span: float) -> float:
    """Return work of the loads over the scene's size, plus kinetic energy of crossing it in the run's time [J].

    largest: of each load its largest force [N] and moment [N m]
    """
    scale = sum(body.mass for body in mechanism.bodies) * (size / span) ** 2 if span > 0.0 else 0.0
    for force, moment in largest:
        scale += force * size + moment
    return scale


def drive_rate(states: BodyStates, load: JointLoads) -> Array:
    """Return the rate of a driven coordinate from the motion of the bodies, (n_t,)."""
    joint = load.joint
    assert joint.drive is not None
    if joint.drive.quantity == "angle":
        assert load.axis is not None
        omega = [states.omega[:, b] if b >= 0 else np.zeros_like(load.point) for b in (joint.a, joint.b)]
        return np.asarray(np.sum((omega[1] - omega[0]) * load.axis, axis=1))
    Q = states.point_position(joint.b, joint.q)
    if joint.drive.quantity == "travel":
        assert load.axis is not None
        from_position, direction = Q, load.axis
    else:
        from_position = states.point_position(joint.a, joint.p)
        direction = (Q - from_position) / np.maximum(
            np.sqrt(np.sum((Q - from_position) ** 2, axis=1)), tolerances.LEAST_EXTENT
        )[:, None]
    return np.asarray(
        np.sum((states.point_velocity(joint.b, Q) - states.point_velocity(joint.a, from_position)) * direction, axis=1)
    )


def rope_power(states: BodyStates, rope: CouplingLoads) -> Array:
    """Return the power that a rope that is drawn in gives to all bodies, (n_t,) [W]."""
    power = np.zeros(len(states.v_centre))
    for body, (place, force, moment) in rope.body_loads().items():
        if body != GROUND:
            power = power + np.sum(force * states.point_velocity(body, place) + moment * states.omega[:, body], axis=1)
    return power


def energy_drift(change: float, largest: float, lift: float) -> float:
    """Return the change of kinetic + potential - work since the start, relative to the largest kinetic energy; 0 at
    rest.

    lift: the work of the weight over the scene's size, and of impulses on free bodies, the threshold for rest; all [J]
    """
    return change / largest if largest > tolerances.NO_ENERGY * lift else 0.0
