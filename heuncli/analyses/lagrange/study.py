"""Lagrange's equations of a spec's scene at an instant (no. 18 to 24 of the paper), and its impulses.
    e [q'] = h + H      (32)
An impulse meets the apparent inertia of the point where it acts.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from heuncli.analyses.lagrange.coordinates import (
    CoordinateChoice,
    choose_coordinates,
    compute_accelerations,
    compute_length,
    compute_rates,
    make_candidate_rows,
)
from heuncli.analyses.lagrange.equations import (
    DriveRows,
    Partials,
    VelocityTerms,
    compute_forces_by_cause,
    compute_section_forces,
    estimate_term_sizes,
    invert_inertia,
    make_drive_rows,
    make_partials,
    subtract_drive_efforts,
)
from heuncli.analyses.lagrange.freed_scene import Instant, make_instant
from heuncli.analyses.lagrange.results import ApparentInertia, ImpulseResults, LagrangeResults, SectionForces, get_units
from heuncli.analyses.lagrange.rodrigues import RODRIGUES_NAMES, compute_rodrigues_vector
from heuncli.analyses.lagrange.state_space import compute_state_space
from heuncli.base.errors import Problem, SolveError
from heuncli.base.joint_kinds import is_length
from heuncli.base.records import record
from heuncli.base.spelling import suggest
from heuncli.loads.kinetostatics.actions import Action, collect_applied_loads, list_whole_joint_actions
from heuncli.loads.kinetostatics.bodies import BodyStates, make_body_states
from heuncli.loads.kinetostatics.coordinates import evaluate_joint_coordinates
from heuncli.loads.kinetostatics.couplings import find_coupling_loads, list_coupling_actions, list_rope_actions
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.blocks import make_blocks
from heuncli.study.compose.impulses import Impulses
from heuncli.study.model.options import Options
from heuncli.study.model.setup import attach_locations
from heuncli.study.workflow import solve


def compute_impulses(
    spec: Spec,
    instant: Instant,
    drives: DriveRows,
    choice: CoordinateChoice,
    partials: Partials,
    epsilon: Array,
    eta: Array,
) -> tuple[ImpulseResults, ...]:
    """Return the impulses of an impulse analysis; empty for other analyses."""
    if spec.analysis.type != "impulse":
        return ()
    impulses = solve(spec, Options(reduce=False)).impulse_results
    count = 0 if impulses is None else len(impulses.jumps)
    return tuple(
        compute_impulse(impulses, k, instant, drives, choice, partials, epsilon, eta)
        for k in range(count)
        if impulses is not None
    )


def compute_impulse(
    impulses: Impulses,
    k: int,
    instant: Instant,
    drives: DriveRows,
    choice: CoordinateChoice,
    partials: Partials,
    epsilon: Array,
    eta: Array,
) -> ImpulseResults:
    """Return one impulse of the analysis."""
    recovery = impulses.recovery
    states = make_body_states(recovery.setup.scene.layout, recovery.solutions.select(np.array([k])))
    jumps = compute_accelerations(instant.freed_scene.layout, choice.names, states)[0]
    h = np.zeros(len(eta))
    for action in recovery.given_actions:
        for end, force, moment in action.iter_ends():
            h = (
                h
                + force[k] @ partials.point_partials(end.body, end.position[k])
                + moment[k] @ partials.turn_partials(end.body)
            )
    total = epsilon @ jumps
    drive_impulses = drives.project_on_drives(total - h)
    section_blocks = impulses.all_blocks["sections"]
    return ImpulseResults(
        t=impulses.jumps[k].time,
        h=h,
        drives=drive_impulses,
        jumps=jumps,
        reciprocal_energy=float(0.5 * h @ eta @ h),
        sections={
            cuts.name: compute_section_forces(section_blocks[cuts.name], k, partials, cuts.body)
            for cuts in instant.setup.cuts
        },
    )


IMMOBILE = 1e-12  # of the largest inverse inertia: below, the place does not move


def compute_apparent_inertias(
    instant: Instant, choice: CoordinateChoice, partials: Partials, epsilon: Array, eta: Array, requested: Sequence[str]
) -> tuple[ApparentInertia, ...]:
    """Return the apparent inertias along all coordinates, or at the requested places: coordinates, or
    POINT:nx,ny,nz.
    """
    inertias = {
        name: ApparentInertia(name, get_units(name).inertia, float(epsilon[i, i]), float(1.0 / eta[i, i]))
        for i, name in enumerate(choice.names)
    }
    if not requested:
        return tuple(inertias.values())
    return tuple(
        inertias[name] if name in inertias else compute_apparent_inertia(instant, choice, partials, eta, name)
        for name in requested
    )


def compute_apparent_inertia(
    instant: Instant, choice: CoordinateChoice, partials: Partials, eta: Array, name: str
) -> ApparentInertia:
    """Return the apparent inertia along a coordinate that was not chosen, or at a point. Raises SolveError if nothing
    moves there.
    """
    place, colon, direction = name.partition(":")
    if colon:
        row, unit = make_point_row(instant, partials, place, direction, name), "kg"
    else:
        rows = make_candidate_rows(instant.freed_scene.layout, instant.linear_equations)
        if name not in rows:
            hint = suggest(name, list(rows), "coordinates") or "or BODY.POINT:nx,ny,nz"
            raise SolveError(Problem("no-coordinate", f"--seen {name}: there is no such coordinate", hint=hint))
        row, unit = rows[name] @ choice.S, get_units(name).inertia
    inverse = float(row @ eta @ row)
    if inverse <= IMMOBILE * float(np.abs(eta).max()) * max(float(row @ row), IMMOBILE):
        message = f"--seen {name}: it cannot move there: the apparent inertia is infinite"
        raise SolveError(Problem("no-coordinate", message, hint="use another instant or another direction"))
    return ApparentInertia(name, unit, None, 1.0 / inverse)


def make_point_row(instant: Instant, partials: Partials, place: str, direction: str, option_text: str) -> Array:
    """Return the row (f,) of the velocity of a point along a direction."""
    mechanism = instant.freed_scene.layout.mechanism
    points = {
        f"{body.name}.{name}": (i, p) for i, body in enumerate(mechanism.bodies) for name, p in body.points.items()
    }
    if place not in points:
        hint = suggest(place, list(points), "points") or ""
        raise SolveError(Problem("no-coordinate", f"--seen {option_text}: there is no point {place}", hint=hint))
    n = np.array([float(word) for word in direction.split(",")])
    body, point = points[place]
    states = make_body_states(instant.freed_scene.layout, instant.freed_recovered)
    return np.asarray(n / np.sqrt(n @ n) @ partials.point_partials(body, states.point_position(body, point)[0]))


QUASI_VELOCITY_NOTE = (
    "{names}: rates are quasi-velocities (components of angular velocity and velocity along the world axes), "
    "for which Christoffel symbols and alpha are not defined"
)


@record
class LagrangeOptions:
    """Options of a Lagrange analysis: coordinates, places of apparent inertias, Christoffel symbols, a state space."""

    at: float | None = None
    coordinates: tuple[str, ...] = ()
    seen: tuple[str, ...] = ()
    christoffel: bool = False
    state_space: bool = False
    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    time_limit: float | None = None


def solve_lagrange(spec: Spec, options: LagrangeOptions) -> LagrangeResults:
    """Return Lagrange's equations of a spec's scene, in numbers. Raises SolveError."""
    with attach_locations(spec):
        instant = make_instant(spec, options.at, options.time_limit)
        return to_results(spec, instant, options)


def to_results(spec: Spec, instant: Instant, options: LagrangeOptions) -> LagrangeResults:
    """Return the results at an instant."""
    layout = instant.freed_scene.layout
    choice = choose_coordinates(
        instant.freed_scene.scene, instant.linear_equations, instant.freed_scene.driven_coordinates, options.coordinates
    )
    epsilon = symmetrise(choice.S.T @ instant.linear_equations.mass @ choice.S)
    eta = invert_inertia(choice.names, epsilon)
    partials = make_partials(layout, instant.linear_equations, choice.S)
    states = make_body_states(instant.setup.scene.layout, instant.driven_recovered, instant.setup.steady_spin_axes)
    q1 = compute_rates(layout, choice.names, states)[0]
    q2 = compute_accelerations(layout, choice.names, states)[0]
    terms = VelocityTerms(instant.freed_scene, choice, partials, epsilon, instant.t, instant.state, instant.holding)
    C = terms.compute_terms(q1[None, :])[0]
    freed_states = make_body_states(layout, instant.freed_recovered)
    applied_actions = list_applied_actions(layout, instant, states)
    k = compute_forces_by_cause(layout, partials, applied_actions)
    scale = estimate_term_sizes(layout, partials, [*applied_actions, *list_constraint_actions(instant)], states)
    scale = scale + np.abs(epsilon) @ np.abs(q2) + np.abs(C)
    total = sum(k.values(), np.zeros(len(q1)))
    drives = make_drive_rows(instant, choice)
    remainder = epsilon @ q2 + C - total
    Q = drives.project_on_drives(remainder)
    linear = compute_state_space(instant, choice, Q, options.inputs, options.outputs) if options.state_space else None
    gamma = terms.compute_christoffel_symbols() if options.christoffel and not any(choice.is_quasi_velocity) else None
    return LagrangeResults(
        energy=float(0.5 * q1 @ epsilon @ q1),
        title=spec.title,
        t=instant.t,
        instant_text=instant.heading,
        names=choice.names,
        is_driven=choice.is_driven,
        values=compute_values(instant, choice, freed_states),
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
        energies=split_energy(
            epsilon, q1, np.array(choice.is_driven), all(name in choice.names for name in drives.names)
        ),
        reciprocal_energy=float(0.5 * (epsilon @ q1) @ eta @ (epsilon @ q1)),
        scale=scale,
        residual=compute_residual(choice, *subtract_drive_efforts(instant, drives, remainder), scale),
        apparent_inertias=compute_apparent_inertias(instant, choice, partials, epsilon, eta, options.seen),
        sections=list_section_forces(instant, partials),
        partials=make_partials_block(instant, choice, partials),
        left_out=choice.left_out,
        notes=tuple(make_notes(choice)),
        state_space=linear,
        impulses=compute_impulses(spec, instant, drives, choice, partials, epsilon, eta),
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


def symmetrise(M: Array) -> Array:
    """Return the symmetric part of a matrix that is symmetric except for rounding."""
    return np.asarray(0.5 * (M + M.T))


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


def split_energy(epsilon: Array, q1: Array, is_driven: Array, is_split: bool) -> tuple[float, float, float]:
    """Return the free, mixed and driven parts of E; nan if the driven rates are not among the coordinates."""
    if not is_split:
        return np.nan, np.nan, np.nan
    a, b = np.where(is_driven, 0.0, q1), np.where(is_driven, q1, 0.0)
    return float(0.5 * a @ epsilon @ a), float(a @ epsilon @ b), float(0.5 * b @ epsilon @ b)


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


def make_partials_block(instant: Instant, choice: CoordinateChoice, partials: Partials) -> dict[str, Any]:
    """Return the partials of the velocities of named points, and of the bodies, (29) and (30)."""
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
