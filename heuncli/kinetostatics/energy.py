"""Energy and its balance, and Heun's system vector B (44)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli import tolerances
from heuncli.integration.evaluator import Recovered
from heuncli.kinetostatics.actions import AppliedLoad
from heuncli.kinetostatics.bodies import BodyStates
from heuncli.mechanism.model import Mechanism, PairLoad
from heuncli.results import Array, Block
from heuncli.tree.layout import Layout


def energy(layout: Layout, recovered: Recovered, states: BodyStates, loads: Sequence[AppliedLoad]) -> Block:
    """Kinetic energy, potential energy (gravity from the world's origin, springs), work of all else, (n_t,) [J]."""
    mechanism = layout.mechanism
    m = np.array([b.mass for b in mechanism.bodies])
    inertia = np.array([b.inertia for b in mechanism.bodies])
    w = np.einsum("tnji,tnj->tni", states.R, states.omega)
    kinetic = 0.5 * np.einsum("n,tni,tni->t", m, states.v_centre, states.v_centre)
    kinetic = kinetic + 0.5 * np.einsum("tni,nij,tnj->t", w, inertia, w)
    potential = -np.einsum("n,tni,i->t", m, states.centre, mechanism.gravity)
    for applied in loads:
        load = applied.load
        if isinstance(load, PairLoad) and load.value is None:
            potential = potential + 0.5 * load.stiffness * np.square(applied.length - load.length)
    work = recovered.states[:, layout.work_at] if layout.work_at >= 0 else np.zeros_like(kinetic)
    return {"kinetic": kinetic, "potential": potential, "work": work}


def system_vector(mechanism: Mechanism, states: BodyStates) -> Block:
    """B = m x_s. x x_s.. + (sigma.I sigma) sigma + T_s (sigma x sigma.), T_s = tr(I)/2 - I; (44), theory.md 2h."""
    m = np.array([b.mass for b in mechanism.bodies])
    inertia = np.array([b.inertia for b in mechanism.bodies])
    w = np.einsum("tnji,tnj->tni", states.R, states.omega)
    u = np.einsum("tnji,tnj->tni", states.R, states.alpha)
    T = 0.5 * np.trace(inertia, axis1=1, axis2=2)[:, None, None] * np.eye(3) - inertia
    twice_e = np.einsum("tni,nij,tnj->tn", w, inertia, w)
    own: Array = twice_e[:, :, None] * w + np.einsum("nij,tnj->tni", T, np.cross(w, u))
    B = m[:, None] * np.cross(states.v_centre, states.a_centre) + np.einsum("tnij,tnj->tni", states.R, own)
    return {"total": B.sum(axis=1), "bodies": {b.name: B[:, i] for i, b in enumerate(mechanism.bodies)}}


def energy_drift(energy: Block, largest: float, lift: float) -> float:
    """Change of kinetic + potential - work from the start, relative to the largest kinetic energy; 0 at rest.

    largest: kinetic energy over the run [J], which instants asked for may not show; lift: the work of the weight over
    the scene's size, and of blows on what is free [J], by which rest is judged.
    """
    total = energy["kinetic"] + energy["potential"] - energy["work"]
    largest = max(largest, float(energy["kinetic"].max(initial=0.0)))
    return float(np.abs(total - total[0]).max(initial=0.0)) / largest if largest > tolerances.NO_ENERGY * lift else 0.0
