"""Compute the energy and its balance, Heun's system vector B (44), and the residual of d'Alembert's principle.

The residual is recomputed for every body from the reported loads and motion:

    r = Σ k + m g − m ẍ,   R = Σ [(x − x_s) × k + couples] − (I σ̇ + σ × I σ)     about the centre of mass

k: applied forces, joints and drives on the body. The residual is relative to the body's largest load, including the
inertia loads of its pieces: a rotor that spins about its centre has no others. A body that an instant or an impulse
reaches by rounding alone has no load of its own: there the residual is relative to the smallest load that rounding of
the instant's largest one leaves certain.

Rounding of a number is relative to the magnitudes of the terms that it is a sum of. The inertia loads of a body's
pieces may be large where their resultant vanishes, as in a rotor that spins about its centre. Over the mass points m at
r from the centre of mass, by Cauchy and Schwarz,

    Σ m |σ × (σ × r)| ≤ |σ| √(m σ·I σ),   Σ m |σ̇ × r| ≤ √(m σ̇·I σ̇)

Their moments are at most that times the radius of gyration.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.loads.kinetostatics.actions import Action, AppliedLoad
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.couplings import CouplingLoads
from heuncli.loads.kinetostatics.foundation import find_inertia_loads, find_inertia_rows
from heuncli.loads.kinetostatics.reactions import JointLoads
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Block, Magnitudes
from heuncli.scene.shapes.rotations import cross_components, cross_rows, instants_first, quadratic_form, squared_lengths


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


def find_power_imbalance(
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
    ma, spin = find_inertia_loads(mechanism, states)
    weight = np.array([b.mass for b in mechanism.bodies])[:, None] * mechanism.gravity
    gain = np.einsum("tni,tni->t", states.v_centre, ma - weight) + np.einsum("tni,tni->t", states.omega, spin)
    power = np.zeros(len(gain))
    for load in loads:
        power = power + load.power
    for joint in joints:
        if joint.drive is not None and joint.joint.drive is not None:
            power = power + joint.drive * find_drive_rate(states, joint)
    for coupling in couplings:
        if coupling.coupling.law is not None or coupling.coupling.stretched_row is not None:
            power = power + find_rope_power(states, coupling)
    return float(np.abs(power - gain).max(initial=0.0)) * span


def find_work_scale(mechanism: Mechanism, largest: Sequence[tuple[float, float]], size: float, span: float) -> float:
    """Return work of the loads over the scene's size, plus kinetic energy of crossing it in the run's time [J].

    largest: of each load its largest force [N] and moment [N m]
    """
    scale = sum(body.mass for body in mechanism.bodies) * (size / span) ** 2 if span > 0.0 else 0.0
    for force, moment in largest:
        scale += force * size + moment
    return scale


def find_drive_rate(states: BodyStates, load: JointLoads) -> Array:
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


def find_rope_power(states: BodyStates, rope: CouplingLoads) -> Array:
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


# Balance

CHUNK = 100_000  # instants times actions summed together


def balance_residual(
    mechanism: Mechanism, states: BodyStates, inertia: Array, actions: Sequence[Action], size: float
) -> float:
    """Return the largest residual of any body, relative to its largest load; moments are divided by `size` [m].

    inertia: the largest inertia load of each body (`find_inertia_scale`)

    The rounding of the instant's largest load, summed over the bodies, stays below UNBALANCED, however small a body's
    own load.
    """
    ma, spin = find_inertia_rows(mechanism, states)
    weight = np.array([b.mass for b in mechanism.bodies])[:, None] * mechanism.gravity
    force, moment = weight[..., None] - ma, -spin
    largest = inertia.T.copy()

    ends_with_loads = [(end, F, M) for action in actions for end, F, M in action.iter_ends() if end.body != GROUND]
    batch_size = max(1, CHUNK // max(len(inertia), 1))
    for first in range(0, len(ends_with_loads), batch_size):
        ends, forces, moments = zip(*ends_with_loads[first : first + batch_size], strict=True)
        F, M, position = (stack_vectors(x) for x in (forces, moments, [end.position for end in ends]))
        about_centre = M + cross_components(position - states.component_rows("centre")[[end.body for end in ends]], F)
        action_sizes = np.maximum(np.abs(F).max(axis=1), np.abs(M).max(axis=1) / size)
        for k, body in enumerate(end.body for end in ends):
            force[body] += F[k]
            moment[body] += about_centre[k]
            np.maximum(largest[body], action_sizes[k], out=largest[body])
    if mechanism.planar:
        force, moment = force * np.array([[1.0], [1.0], [0.0]]), moment * np.array([[0.0], [0.0], [1.0]])
    residual = np.maximum(np.sqrt(squared_lengths(force)), np.sqrt(squared_lengths(moment)) / size)
    rounding = tolerances.SUM_ROUNDING * len(mechanism.bodies) * largest.max(axis=0, initial=0.0)
    scale = np.maximum(largest, rounding / tolerances.UNBALANCED)
    scale[scale == 0.0] = 1.0
    return float((residual / scale).max(initial=0.0))


def stack_vectors(vectors: Sequence[Array]) -> Array:
    """Stack vectors of actions, (n_t, 3) each, by component, (k, 3, n_t)."""
    return np.ascontiguousarray(np.stack(vectors).transpose(0, 2, 1))


# Magnitudes


def find_inertia_scale(mechanism: Mechanism, states: BodyStates) -> Array:
    """Return the largest inertia load or weight of each body, including its pieces', (n_t, n) [N]."""
    m = np.array([body.mass for body in mechanism.bodies])
    w, u = states.turning
    spinning, turning = (_inertia_norm(mechanism, x) for x in (w, u))
    pieces = np.sqrt(m)[:, None] * (np.sqrt(squared_lengths(w)) * spinning + turning)
    whole = m[:, None] * np.sqrt(squared_lengths(states.component_rows("a_centre")))
    weight = m * float(np.sqrt(np.sum(np.square(mechanism.gravity))))
    return instants_first(np.maximum(np.maximum(pieces, whole), weight[:, None]))


def _inertia_norm(mechanism: Mechanism, x: Array) -> Array:
    """Return √(x·I x) of every body, (n, n_t), x in body axes by component."""
    inertia = np.array([body.inertia for body in mechanism.bodies])
    return np.asarray(np.sqrt(np.maximum(quadratic_form(x, inertia), 0.0)))


def find_magnitudes(
    mechanism: Mechanism, states: BodyStates, inertia: Array, actions: Sequence[Action], energy: Block, size: float
) -> Magnitudes:
    """Find the magnitudes at these instants; actions: of applied loads and of joints with their drives.

    inertia: the largest inertia load of each body (`find_inertia_scale`)
    energy: kinetic, potential, work; empty if not needed
    """
    g = float(np.sqrt(np.sum(np.square(mechanism.gravity))))
    mass, scale_mass = [body.mass for body in mechanism.bodies], mechanism.scale_masses.tolist()
    load_magnitudes = find_load_magnitudes(states, inertia, actions, size)
    force = load_magnitudes.by_unit["N"]
    load_acceleration = 0.0  # acceleration that an applied load alone would give
    for action in actions:
        if action.kind == "load" and (action.from_end is None or action.from_end.body != action.to_end.body):
            action_force = max(_largest(action.force), _largest(action.moment) / size)
            load_acceleration = max(
                load_acceleration,
                *(action_force / scale_mass[end.body] for end, *_ in action.iter_ends() if end.body != GROUND),
                0.0,
            )
    spin, v = _largest(states.omega), max(_largest(states.v_centre), size * _largest(states.omega))
    a = max(_largest(states.a_centre), size * spin**2, size * _largest(states.alpha))
    acceleration = max(g, load_acceleration, a)
    turning = acceleration / _min_gyration(mechanism, size)
    speed = max(v, float(np.sqrt(size * acceleration)))
    by_unit = {
        **load_magnitudes.by_unit,
        "m/s": speed, "m/s²": acceleration,
        "rad": 1.0, "rad/s": max(spin, float(np.sqrt(turning))), "rad/s²": turning,
        "W": force * speed,
        "J": max([sum(mass) * g * size, *map(_largest, energy.values())]),
    }  # fmt: skip
    return load_magnitudes._replace(by_unit=by_unit)


def find_load_magnitudes(states: BodyStates, inertia: Array, actions: Sequence[Action], size: float) -> Magnitudes:
    """Find only the magnitudes that errors of loads depend on: lengths, forces, moments."""
    action_forces = (max(_largest(action.force), _largest(action.moment) / size) for action in actions)
    force = max(_largest(inertia), *action_forces, 0.0)
    return Magnitudes({"m": size, "N": force, "N·m": force * size}, size, _largest(states.x), {})


def _min_gyration(mechanism: Mechanism, size: float) -> float:
    """Return the smallest radius of gyration of a body that is no point mass; the scene's size if there is none [m]."""
    masses = mechanism.scale_masses.tolist()
    squares = [
        float(np.trace(body.inertia)) / (2.0 * mass) for body, mass in zip(mechanism.bodies, masses, strict=True)
    ]
    return min((x**0.5 for x in squares if x > tolerances.POINT_MASS * size**2), default=size)


def _largest(values: Array) -> float:
    """Return the largest magnitude, without indeterminate values."""
    largest = float(np.abs(values).max(initial=0.0))
    return largest if largest == largest else float(np.nanmax(np.abs(values), initial=0.0))
