"""The Lagrange side of a spec's scene at an instant (no. 18 to 24 of the paper)."""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.analyses.lagrange import rodrigues
from heuncli.analyses.lagrange.blows import blows
from heuncli.analyses.lagrange.coordinates import Chosen, accelerations, chosen, length_of, rates
from heuncli.analyses.lagrange.drives import drive_rows, left_by_reactions
from heuncli.analyses.lagrange.equations import (
    Partials,
    VelocityTerms,
    forces_by_cause,
    partials_of,
    reciprocal,
    size_of_terms,
)
from heuncli.analyses.lagrange.instant import Instant, instant_of
from heuncli.analyses.lagrange.results import LagrangeResults, SectionForces
from heuncli.analyses.lagrange.section_forces import section_forces
from heuncli.analyses.lagrange.seen import seen
from heuncli.analyses.lagrange.state_space import state_space
from heuncli.base.joint_kinds import is_length
from heuncli.base.records import record
from heuncli.loads.kinetostatics.actions import Action, applied_loads, whole_joint_actions
from heuncli.loads.kinetostatics.bodies import BodyStates, body_states
from heuncli.loads.kinetostatics.coordinates import coordinates
from heuncli.loads.kinetostatics.couplings import coupling_actions, coupling_loads, rope_actions
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.blocks import blocks as blocks_of
from heuncli.study.model.error_places import placed

QUASI = (
    "{names}: rates without coordinates, components of angular velocity and of velocity along the world's axes: "
    "Christoffel symbols and alpha are not defined for them"
)


@record
class LagrangeQuestion:
    """What is asked for beside the equations: coordinates, places at which inertia is seen, Christoffel symbols."""

    at: float | None = None
    coordinates: tuple[str, ...] = ()
    seen: tuple[str, ...] = ()
    christoffel: bool = False
    state_space: bool = False
    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    time_limit: float | None = None


def lagrange(spec: Spec, asked: LagrangeQuestion) -> LagrangeResults:
    """Lagrange's equations of a spec's scene, in numbers. Raises SolveError."""
    with placed(spec):
        at = instant_of(spec, asked.at, asked.time_limit)
        return told(spec, at, asked)


def told(spec: Spec, at: Instant, asked: LagrangeQuestion) -> LagrangeResults:
    """The results at an instant."""
    layout = at.freed.layout
    by = chosen(at.freed.scene, at.found, at.freed.driven, asked.coordinates)
    epsilon = symmetric(by.S.T @ at.found.mass @ by.S)
    eta = reciprocal(by.names, epsilon)
    partials = partials_of(layout, at.found, by.S)
    states = body_states(at.setup.scene.layout, at.there, at.setup.steady)
    q1, q2 = (move(layout, by.names, states)[0] for move in (rates, accelerations))
    terms = VelocityTerms(at.freed, by, partials, epsilon, at.t, at.state, at.holding)
    C = terms.at(q1[None, :])[0]
    here = body_states(layout, at.here)
    applied = applied_in(layout, at, states)
    k = forces_by_cause(layout, partials, applied)
    scale = size_of_terms(layout, partials, [*applied, *holding(at)], states)
    scale = scale + np.abs(epsilon) @ np.abs(q2) + np.abs(C)
    total = sum(k.values(), np.zeros(len(q1)))
    drives = drive_rows(at, by)
    left = epsilon @ q2 + C - total
    Q = drives.along(left)
    linear = state_space(at, by, Q, asked.inputs, asked.outputs) if asked.state_space else None
    gamma = terms.christoffel() if asked.christoffel and not any(by.quasi) else None
    return LagrangeResults(
        energy=float(0.5 * q1 @ epsilon @ q1),
        title=spec.title,
        t=at.t,
        at=at.words,
        names=by.names,
        driven=by.driven,
        values=values_of(at, by, here),
        rates=q1,
        accelerations=q2,
        epsilon=epsilon,
        eta=eta,
        momenta=epsilon @ q1,
        forces=k,
        drives=Q,
        coriolis=C,
        coriolis_matrix=terms.coriolis_matrix(q1),
        gamma=gamma,
        alpha=None if gamma is None else -np.einsum("ij,jlk->ilk", eta, gamma),
        energies=energies(epsilon, q1, np.array(by.driven), all(name in by.names for name in drives.names)),
        reciprocal_energy=float(0.5 * (epsilon @ q1) @ eta @ (epsilon @ q1)),
        scale=scale,
        residual=residual(by, *left_by_reactions(at, drives, left), scale),
        seen=seen(at, by, partials, epsilon, eta, asked.seen),
        sections=sections(at, partials),
        partials=partials_block(at, by, partials),
        left_out=by.left_out,
        notes=tuple(notes(by)),
        state_space=linear,
        blows=blows(spec, at, drives, by, partials, epsilon, eta),
    )


def applied_in(layout: Layout, at: Instant, states: BodyStates) -> list[Action]:
    """What acts by laws, as it does with the drives: friction hangs on what the joint carries then."""
    applied = [load.action for load in applied_loads(layout.mechanism, states, at.there)]
    return applied + rope_actions(coupling_loads(layout, at.there, states))


def holding(at: Instant) -> list[Action]:
    """What joints and couplings exert by what they hold."""
    held = [own for own in at.recovery.couplings if own.coupling.stretched is None]
    return [*whole_joint_actions(at.recovery.unsplit), *coupling_actions(held)]


def symmetric(M: Array) -> Array:
    """Of a matrix that is, to rounding."""
    return np.asarray(0.5 * (M + M.T))


def values_of(at: Instant, by: Chosen, here: BodyStates) -> Array:
    """The coordinates themselves, (f,); not a number of quasi-velocities."""
    block = coordinates(at.freed.layout, at.here, here)
    found = []
    for name in by.names:
        owner, _, quantity = name.rpartition(".")
        if quantity == "length":
            found.append(length_of(at.freed.layout, here, owner))
        else:
            found.append(
                float(block[owner][quantity][0]) if quantity in block.get(owner, {}) else of_body(at, here, name)
            )
    return np.array(found)


def of_body(at: Instant, here: BodyStates, name: str) -> float:
    """A component of a body's Rodrigues vector, or of the place of its centre; not a number of a quasi-velocity."""
    owner, _, quantity = name.rpartition(".")
    bodies = [body.name for body in at.freed.layout.mechanism.bodies]
    if owner not in bodies:
        return np.nan
    body, axis = bodies.index(owner), "xyz".index(quantity[-1])
    if quantity in rodrigues.NAMES:
        return float(rodrigues.vector(here.R[0, body], owner)[axis])
    return float(here.centre[0, body, axis]) if quantity.startswith("d") else np.nan


def energies(epsilon: Array, q1: Array, driven: Array, is_split: bool) -> tuple[float, float, float]:
    """The parts of E: of the free rates, of both, of the driven ones; nan where these are no coordinates."""
    if not is_split:
        return np.nan, np.nan, np.nan
    a, b = np.where(driven, 0.0, q1), np.where(driven, q1, 0.0)
    return float(0.5 * a @ epsilon @ a), float(a @ epsilon @ b), float(0.5 * b @ epsilon @ b)


def residual(by: Chosen, left: Array, known: Array, scale: Array) -> float:
    """What the equations leave where it is known, of the largest of the parts that they are sums of."""
    lengths = np.array([is_length(name) for name in by.names])
    most = np.where(lengths, scale[lengths].max(initial=0.0), scale[~lengths].max(initial=0.0))
    off = np.abs(left[known]) / np.maximum(most[known], np.finfo(float).tiny)
    return float(off.max(initial=0.0))


def sections(at: Instant, partials: Partials) -> dict[str, SectionForces]:
    """s'_i of each section: what the piece beyond the cut exerts on the rest."""
    if not at.setup.cuts:
        return {}
    block = blocks_of(at.recovery, {"sections"})["sections"]
    return {cuts.name: section_forces(block[cuts.name], 0, partials, cuts.body) for cuts in at.setup.cuts}


def partials_block(at: Instant, by: Chosen, partials: Partials) -> dict[str, Any]:
    """What the rates make of the velocities of named points, and of the bodies, (29) and (30)."""
    mechanism = at.freed.layout.mechanism
    states = body_states(at.freed.layout, at.here)
    found: dict[str, Any] = {"points": {}, "bodies": {}}
    for i, body in enumerate(mechanism.bodies):
        found["bodies"][body.name] = {"turn": partials.turn[i].tolist(), "shift": partials.shift[i].tolist()}
        for name, place in body.points.items():
            position = states.point_position(i, place)[0]
            found["points"][f"{body.name}.{name}"] = partials.at(i, position).tolist()
    return found


def notes(by: Chosen) -> list[str]:
    """Sentences below the tables."""
    found = []
    quasi = [name for name, is_quasi in zip(by.names, by.quasi, strict=True) if is_quasi]
    if quasi:
        found.append(QUASI.format(names=", ".join(quasi)))
    found += [f"{name}: a spin without inertia is no part of the motion" for name in by.left_out]
    return found
