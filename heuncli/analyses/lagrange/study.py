"""Lagrange's equations of a spec's scene at an instant (no. 18 to 24 of the paper), and its impulses."""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.analyses.lagrange.coordinate_rates import (
    RODRIGUES_NAMES,
    compute_accelerations,
    compute_length,
    compute_rates,
    compute_rodrigues_vector,
)
from heuncli.analyses.lagrange.coordinates import CoordinateChoice, choose_coordinates
from heuncli.analyses.lagrange.equations import (
    InstantEquations,
    Partials,
    VelocityTerms,
    compute_forces_by_cause,
    estimate_term_sizes,
    make_drive_rows,
    make_instant_equations,
    subtract_drive_efforts,
)
from heuncli.analyses.lagrange.freed_scene import Instant, make_instant
from heuncli.analyses.lagrange.responses import compute_apparent_inertias, compute_impulses, compute_section_forces
from heuncli.analyses.lagrange.results import LagrangeResults, SectionForces
from heuncli.analyses.lagrange.state_space import compute_state_space
from heuncli.base.joint_kinds import is_length
from heuncli.base.records import record
from heuncli.loads.kinetostatics.actions import Action, collect_applied_loads, list_whole_joint_actions
from heuncli.loads.kinetostatics.bodies import BodyStates, make_body_states
from heuncli.loads.kinetostatics.coordinates import evaluate_joint_coordinates
from heuncli.loads.kinetostatics.couplings import find_coupling_loads, list_coupling_actions, list_rope_actions
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.blocks import make_blocks
from heuncli.study.model.setup import attach_locations

QUASI_VELOCITY_NOTE = (
    "{names}: rates are quasi-velocities (components of angular velocity and velocity along the world axes), "
    "for which Christoffel symbols and alpha are not defined"
)


@record
class LagrangeOptions:
    """Options of a Lagrange analysis: coordinates, places of apparent inertias, Christoffel symbols, a state space."""

    at: float | None = None
    coordinates: tuple[str, ...] = ()
    seen: tuple[str, ...] = ()  # places whose apparent inertias are computed
    christoffel: bool = False
    state_space: bool = False
    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    time_limit: float | None = None


def solve_lagrange(spec: Spec, options: LagrangeOptions) -> LagrangeResults:
    """Return Lagrange's equations of a spec's scene, in numbers. Raises SolveError."""
    with attach_locations(spec):
        instant = make_instant(spec, options.at, options.time_limit)
        return compute_results(spec, instant, options)


def compute_results(spec: Spec, instant: Instant, options: LagrangeOptions) -> LagrangeResults:
    """Return the results at an instant."""
    layout = instant.freed_scene.layout
    choice = choose_coordinates(
        instant.freed_scene.scene, instant.linear_equations, instant.freed_scene.driven_coordinates, options.coordinates
    )
    equations = make_instant_equations(instant, choice)
    epsilon, eta, partials = equations.epsilon, equations.eta, equations.partials
    states = make_body_states(instant.setup.scene.layout, instant.driven_recovered, instant.setup.steady_spin_axes)
    rates = compute_rates(layout, choice.names, states)[0]
    accelerations = compute_accelerations(layout, choice.names, states)[0]
    terms = VelocityTerms(instant.freed_scene, choice, partials, epsilon, instant.t, instant.state, instant.holding)
    C = terms.compute_terms(rates[None, :])[0]
    freed_states = make_body_states(layout, instant.freed_recovered)
    applied_actions = list_applied_actions(layout, instant, states)
    forces = compute_forces_by_cause(layout, partials, applied_actions)
    term_sizes = estimate_term_sizes(layout, partials, [*applied_actions, *list_constraint_actions(instant)], states)
    term_sizes = term_sizes + np.abs(epsilon) @ np.abs(accelerations) + np.abs(C)
    drives = make_drive_rows(instant, choice)
    remainder = epsilon @ accelerations + C - sum(forces.values(), np.zeros(len(rates)))
    Q = drives.project_on_drives(remainder)
    linear = compute_state_space(instant, choice, Q, options.inputs, options.outputs) if options.state_space else None
    gamma = terms.compute_christoffel_symbols() if options.christoffel and not any(choice.is_quasi_velocity) else None
    are_drives_chosen = all(name in choice.names for name in drives.names)
    return LagrangeResults(
        title=spec.title,
        t=instant.t,
        instant_text=instant.heading,
        names=choice.names,
        is_driven=choice.is_driven,
        values=compute_values(instant, choice, freed_states),
        rates=rates,
        accelerations=accelerations,
        epsilon=epsilon,
        eta=eta,
        momenta=epsilon @ rates,
        forces=forces,
        drives=Q,
        coriolis=C,
        coriolis_matrix=terms.coriolis_matrix(rates),
        gamma=gamma,
        alpha=None if gamma is None else -np.einsum("ij,jlk->ilk", eta, gamma),
        energy=float(0.5 * rates @ epsilon @ rates),
        energies=split_energy(epsilon, rates, np.array(choice.is_driven), are_drives_chosen),
        reciprocal_energy=float(0.5 * (epsilon @ rates) @ eta @ (epsilon @ rates)),
        scale=term_sizes,
        residual=compute_residual(choice, *subtract_drive_efforts(instant, drives, remainder), term_sizes),
        apparent_inertias=compute_apparent_inertias(equations, options.seen),
        sections=list_section_forces(instant, partials),
        partials=make_partials_block(equations),
        left_out=choice.left_out,
        notes=tuple(make_notes(choice)),
        state_space=linear,
        impulses=compute_impulses(spec, equations, drives),
    )


def list_applied_actions(layout: Layout, instant: Instant, states: BodyStates) -> list[Action]:
    """Return the applied loads as they act with the drives: friction depends on the reactions of that scene."""
    applied = [load.action for load in collect_applied_loads(layout.mechanism, states, instant.driven_recovered)]
    return applied + list_rope_actions(find_coupling_loads(layout, instant.driven_recovered, states))


def list_constraint_actions(instant: Instant) -> list[Action]:
    """Return the constraint forces of joints and couplings."""
    constraint_couplings = [loads for loads in instant.recovery.couplings if loads.coupling.stretched_row is None]
    return [
        *list_whole_joint_actions(instant.recovery.kernel_joint_loads),
        *list_coupling_actions(constraint_couplings),
    ]


def compute_values(instant: Instant, choice: CoordinateChoice, states: BodyStates) -> Array:
    """Return the values of the coordinates, (f,); nan for quasi-velocities."""
    block = evaluate_joint_coordinates(instant.freed_scene.layout, instant.freed_recovered, states)
    values = []
    for name in choice.names:
        owner, _, quantity = name.rpartition(".")
        if quantity == "length":
            values.append(compute_length(instant.freed_scene.layout, states, owner))
        else:
            values.append(
                float(block[owner][quantity][0])
                if quantity in block.get(owner, {})
                else compute_body_value(instant, states, name)
            )
    return np.array(values)


def compute_body_value(instant: Instant, states: BodyStates, name: str) -> float:
    """Return a component of a body's Rodrigues vector, or of its centre's position; nan for a quasi-velocity."""
    owner, _, quantity = name.rpartition(".")
    bodies = [body.name for body in instant.freed_scene.layout.mechanism.bodies]
    if owner not in bodies:
        return np.nan
    body, axis = bodies.index(owner), "xyz".index(quantity[-1])
    if quantity in RODRIGUES_NAMES:
        return float(compute_rodrigues_vector(states.R[0, body], owner)[axis])
    return float(states.centre[0, body, axis]) if quantity.startswith("d") else np.nan


def split_energy(epsilon: Array, rates: Array, is_driven: Array, are_drives_chosen: bool) -> tuple[float, float, float]:
    """Return the free, mixed and driven parts of E; nan if the driven rates are not among the coordinates."""
    if not are_drives_chosen:
        return np.nan, np.nan, np.nan
    free, driven = np.where(is_driven, 0.0, rates), np.where(is_driven, rates, 0.0)
    return float(0.5 * free @ epsilon @ free), float(free @ epsilon @ driven), float(0.5 * driven @ epsilon @ driven)


def compute_residual(choice: CoordinateChoice, remainder: Array, is_known: Array, scale: Array) -> float:
    """Return the remainder of the equations where it is known, relative to the largest terms."""
    is_length_coordinate = np.array([is_length(name) for name in choice.names])
    largest_terms = np.where(
        is_length_coordinate,
        scale[is_length_coordinate].max(initial=0.0),
        scale[~is_length_coordinate].max(initial=0.0),
    )
    relative_remainder = np.abs(remainder[is_known]) / np.maximum(largest_terms[is_known], np.finfo(float).tiny)
    return float(relative_remainder.max(initial=0.0))


def list_section_forces(instant: Instant, partials: Partials) -> dict[str, SectionForces]:
    """Return s'_i of each section: what the piece beyond the cut exerts on the rest."""
    if not instant.setup.cuts:
        return {}
    block = make_blocks(instant.recovery, {"sections"})["sections"]
    return {cuts.name: compute_section_forces(block[cuts.name], 0, partials, cuts.body) for cuts in instant.setup.cuts}


def make_partials_block(equations: InstantEquations) -> dict[str, Any]:
    """Return the partials of the velocities of named points, and of the bodies, (29) and (30)."""
    instant, partials = equations.instant, equations.partials
    mechanism = instant.freed_scene.layout.mechanism
    states = make_body_states(instant.freed_scene.layout, instant.freed_recovered)
    block: dict[str, Any] = {"points": {}, "bodies": {}}
    for i, body in enumerate(mechanism.bodies):
        block["bodies"][body.name] = {"turn": partials.turn[i].tolist(), "shift": partials.shift[i].tolist()}
        for name, place in body.points.items():
            position = states.point_position(i, place)[0]
            block["points"][f"{body.name}.{name}"] = partials.point_partials(i, position).tolist()
    return block


def make_notes(choice: CoordinateChoice) -> list[str]:
    """Return the sentences below the tables."""
    notes = []
    quasi = [name for name, is_quasi in zip(choice.names, choice.is_quasi_velocity, strict=True) if is_quasi]
    if quasi:
        notes.append(QUASI_VELOCITY_NOTE.format(names=", ".join(quasi)))
    notes += [f"{name}: a spin without inertia is left out of the motion" for name in choice.left_out]
    return notes
