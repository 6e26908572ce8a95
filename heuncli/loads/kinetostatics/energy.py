"""Energy and its balance, and Heun's system vector B (44)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.loads.kinetostatics.actions import AppliedLoad
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.loads.kinetostatics.foundation import inertia_loads
from heuncli.loads.kinetostatics.reactions import JointLoads
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.mechanism.model import GROUND, Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Block
from heuncli.scene.shapes.rotations import cross_rows


def energy(layout: Layout, recovered: Recovered, states: BodyStates) -> Block:
    """Kinetic energy, potential energy (gravity from the world's origin, loads), work of all else, (n_t,) [J]."""
    mechanism = layout.mechanism
    m = np.array([b.mass for b in mechanism.bodies])
    inertia = np.array([b.inertia for b in mechanism.bodies])
    w = np.einsum("tnji,tnj->tni", states.R, states.omega)
    kinetic = 0.5 * np.einsum("n,tni,tni->t", m, states.v_centre, states.v_centre)
    kinetic = kinetic + 0.5 * np.einsum("tni,nij,tnj->t", w, inertia, w)
    potential = -np.einsum("n,tni,i->t", m, states.centre, mechanism.gravity)
    potential = potential + recovered.loads["potential"].sum(axis=1)
    work = recovered.states[:, layout.work_at] if layout.work_at >= 0 else np.zeros_like(kinetic)
    return {"kinetic": kinetic, "potential": potential, "work": work}


def system_vector(mechanism: Mechanism, states: BodyStates) -> Block:
    """B = m x_s. x x_s.. + (sigma.I sigma) sigma + T_s (sigma x sigma.), T_s = tr(I)/2 - I; (44) of any body.

    Its second part is that of the energy, 2 E sigma, the third the deviation G, which vanishes where the axis of the
    turn stays. manual/theory.md, "System vector".
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
    own = {key: {b.name: part[:, i] for i, b in enumerate(mechanism.bodies)} for key, part in parts.items()}
    return {"total": B.sum(axis=1)} | own


def power_imbalance(
    layout: Layout,
    states: BodyStates,
    loads: Sequence[AppliedLoad],
    joints: Sequence[JointLoads],
    couplings: Sequence[CouplingLoads],
    span: float,
) -> float:
    """The largest |P - d(T + V)/dt| over the instants, kept up for a time [J]: of a motion that is not integrated.

    P of loads and drives by the rates of the points and joints they act on, the rest by velocities and accelerations.
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
        if coupling.coupling.law is not None or coupling.coupling.stretched is not None:
            power = power + power_of_rope(states, coupling)
    return float(np.abs(power - gain).max(initial=0.0)) * span


def magnitude_of_work(mechanism: Mechanism, largest: Sequence[tuple[float, float]], size: float, span: float) -> float:
    """Work of the loads over the scene's size, and kinetic energy of crossing it in the run's time [J].

    largest: of each load its largest force [N] and moment [N m].
    """
    found = sum(body.mass for body in mechanism.bodies) * (size / span) ** 2 if span > 0.0 else 0.0
    for force, moment in largest:
        found += force * size + moment
    return found


def drive_rate(states: BodyStates, load: JointLoads) -> Array:
    """The rate of a driven coordinate as the bodies move, (n_t,)."""
    joint = load.joint
    assert joint.drive is not None
    if joint.drive.quantity == "angle":
        assert load.axis is not None
        omega = [states.omega[:, b] if b >= 0 else np.zeros_like(load.point) for b in (joint.a, joint.b)]
        return np.asarray(np.sum((omega[1] - omega[0]) * load.axis, axis=1))
    Q = states.point_position(joint.b, joint.q)
    if joint.drive.quantity == "travel":
        assert load.axis is not None
        at, along = Q, load.axis
    else:
        at = states.point_position(joint.a, joint.p)
        along = (Q - at) / np.maximum(np.sqrt(np.sum((Q - at) ** 2, axis=1)), tolerances.LEAST_EXTENT)[:, None]
    return np.asarray(np.sum((states.velocity(joint.b, Q) - states.velocity(joint.a, at)) * along, axis=1))


def power_of_rope(states: BodyStates, rope: CouplingLoads) -> Array:
    """What a rope that is drawn in gives to all bodies, as they move, (n_t,) [W]."""
    power = np.zeros(len(states.v_centre))
    for body, (place, force, moment) in rope.on_bodies().items():
        if body != GROUND:
            power = power + np.sum(force * states.velocity(body, place) + moment * states.omega[:, body], axis=1)
    return power


def energy_drift(change: float, largest: float, lift: float) -> float:
    """Change of kinetic + potential - work from the start, relative to the largest kinetic energy; 0 at rest.

    lift: the work of the weight over the scene's size, and of blows on what is free, by which rest is judged; all [J].
    """
    return change / largest if largest > tolerances.NO_ENERGY * lift else 0.0
