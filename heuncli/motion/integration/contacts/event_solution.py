"""Solve a contact event: the impulses of what is struck, the state after them, and the contacts that rest there.

restitution.py gives the impulses from the matrix A of the contact problem, which loses digits between very unequal
masses. So these impulses tell only which rates the bearing contacts have afterwards. With those rates as closures one
more column of the whole mechanism gives the impulses to all digits (`refine_impulses`).
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record, replace
from heuncli.motion.integration.contacts.contact_problem import (
    ContactOutcome,
    ContactProblem,
    EventSetting,
    require_yielding,
)
from heuncli.motion.integration.contacts.impulses import find_state_after
from heuncli.motion.integration.contacts.latches import compute_catch_work
from heuncli.motion.integration.contacts.restitution import (
    ContactImpulses,
    estimate_acceleration_noise,
    find_contradicted,
    find_resting,
    is_short_flight,
    solve_contact_impulses,
)
from heuncli.motion.integration.contacts.sequential_impacts import (
    EndlessImpacts,
    find_independent,
    make_endless_impacts_error,
)
from heuncli.motion.integration.contacts.touching import TouchingContacts
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.multibody.response import Columns, solve_impulses
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.file_format.models import SIMULTANEOUS


@record
class UnrefinedImpulses:
    """Impulses as the contact problem gives them.

    basis: the bearing contacts that are solved for by their rates
    others: those of a sequence whose impulses stay, because their rates follow from those of the basis
    """

    impulses: ContactImpulses
    basis: Indices
    others: Indices


def solve_event(evaluator: Evaluator, event: EventSetting, open_states: Array) -> ContactOutcome:
    """Solve for the impulses, then for the contacts that stay closed; a rebound too short to be seen does not count.

    open_states: contact states in which all touching contacts are open, and latches and friction are as they are
    """
    layout, problem, touching = evaluator.layout, event.problem, event.problem.touching
    t = event.given_impulse.after_time
    at_rest = np.zeros(len(touching.indices), dtype=bool)
    while True:
        impulses = solve_from_problem(layout, t, problem, at_rest)
        columns = scale_columns(layout, event.units.columns, touching, impulses.impulses)
        after_state, work = find_state_after(layout, event.given_impulse, event.sides, columns)
        after_evaluation = evaluator.evaluate(np.array([t]), after_state[None, :], holding=open_states)
        touching_states, acceleration = find_resting(
            touching, problem.A, problem.moves, impulses.rate, after_evaluation, layout
        )
        noise = estimate_acceleration_noise(layout, touching, problem.A, after_evaluation)
        require_yielding(layout, problem, np.where(impulses.rate == 0.0, acceleration, 0.0), noise, t)
        is_short = is_short_flight(touching, impulses.rate, acceleration, event.shortest_flight)
        is_short &= ~at_rest & problem.moves
        if not is_short.any():
            break
        at_rest = at_rest | is_short
    if layout.mechanism.joint_friction or layout.friction_contacts:
        contact_states = open_states.copy()
        contact_states[touching.indices] = touching_states
        require_decided(evaluator, event, after_state, contact_states, impulses.rate)
    if impulses.impulses.any():
        impulses, columns, total = refine_impulses(evaluator, event, choose_basis(layout, problem, impulses))
        after_state, work = find_state_after(layout, event.given_impulse, event.sides, total)
    work += float(impulses.impulses @ (0.5 * (touching.rate + impulses.rate)))
    work += compute_catch_work(layout, event.catches, columns.multipliers)
    stop_rounded_motion(layout, event.sides.still.states[0], after_state)
    return ContactOutcome(impulses, touching_states, at_rest, columns, after_state, work)


def solve_from_problem(layout: Layout, t: float, problem: ContactProblem, at_rest: Mask) -> ContactImpulses:
    """Solve for the impulses of the contacts from the matrix of their problem.

    at_rest (k,): contacts that stay closed, whatever their restitution. Raises SolveError for endless impacts.
    """
    impacts = layout.mechanism.impacts
    try:
        return solve_contact_impulses(problem.touching, problem.A, problem.moves, problem.rates, at_rest, impacts)
    except EndlessImpacts as endless:
        names = [layout.contacts[i].name for i in problem.touching.indices.tolist()]
        raise make_endless_impacts_error(t, names, endless, impacts) from None


def require_decided(
    evaluator: Evaluator, event: EventSetting, after_state: Array, contact_states: Array, rate: Array
) -> None:
    """Raise SolveError where load-dependent joint friction makes other contacts bear than those that are held.

    contact_states: of all contacts after the impulses; rate (k,): rates of opening there
    """
    touching, layout, t = event.problem.touching, evaluator.layout, event.given_impulse.after_time
    evaluation = evaluator.evaluate(np.array([t]), after_state[None, :], holding=contact_states)
    touching_states = contact_states[touching.indices]
    is_wrong = find_contradicted(touching, event.problem.A, touching_states, rate, evaluation, layout)
    if is_wrong.any():
        names = ", ".join(layout.contacts[i].name for i in touching.indices[is_wrong])
        message = f"at t = {t:.9g} s whether {names} carries load depends on joint friction, and changes it"
        hint = "use a constant friction, or contacts that do not touch there at the same time"
        raise SolveError(Problem("friction-not-unique", message, hint=hint))


# Refinement


def choose_basis(layout: Layout, problem: ContactProblem, impulses: ContactImpulses) -> UnrefinedImpulses:
    """Choose the bearing contacts that are solved for by their rates: of a sequence only independent ones."""
    bearing = np.flatnonzero(impulses.impulses)
    basis = np.arange(len(bearing))
    if layout.mechanism.impacts != SIMULTANEOUS:
        basis = find_independent(problem.A[np.ix_(bearing, bearing)])
    return UnrefinedImpulses(impulses, bearing[basis], np.delete(bearing, basis))


def refine_impulses(
    evaluator: Evaluator, event: EventSetting, unrefined: UnrefinedImpulses
) -> tuple[ContactImpulses, Columns, Columns]:
    """Recompute impulses and columns with the digits that A loses between very unequal masses; also return their sum.

    M dV = H + sum of z_k W_k' over others + J' Lambda,    J dV = jumps, with W_i dV = v+_i - v-_i of the basis

    The rates v+ after the impulse are known: so the contacts of the basis are held like closures, and one column gives
    their impulses z_i = -sense Lambda_i. What the columns of the contacts lack of it goes to the last of them.
    """
    layout, touching, basis = evaluator.layout, event.problem.touching, unrefined.basis
    exact_sum = solve_basis(evaluator, event, unrefined)
    contacts = [layout.contacts[i] for i in touching.indices[basis].tolist()]
    impulses = unrefined.impulses.impulses.copy()
    impulses[basis] = -np.array([c.sense for c in contacts]) * exact_sum.multipliers[0, [c.row for c in contacts]]
    columns = scale_columns(layout, event.units.columns, touching, impulses)
    for k in unrefined.others.tolist():  # these are given loads in the one column
        contact = layout.contacts[touching.indices[k]]
        exact_sum.multipliers[0, contact.row] -= contact.sense * impulses[k]
    distribute_remainder(columns, exact_sum, len(event.sides.loads) + int(basis[-1]))
    return replace(unrefined.impulses, impulses=impulses), columns, exact_sum


def solve_basis(evaluator: Evaluator, event: EventSetting, unrefined: UnrefinedImpulses) -> Columns:
    """Solve the one column of what is given with the contacts of the basis held, whose rates after it are known."""
    layout, sides, touching = evaluator.layout, event.sides, event.problem.touching
    basis, others = unrefined.basis, unrefined.others
    contacts = [layout.contacts[i] for i in touching.indices[basis].tolist()]
    rows, sense = [c.row for c in contacts], np.array([c.sense for c in contacts])
    load = np.sum([np.zeros((len(layout.place), 6)), *sides.loads], axis=0)
    load = load + np.einsum("k,kbi->bi", unrefined.impulses.impulses[others], touching.loads[others])
    jump = np.sum([np.zeros(len(layout.freedoms) + len(layout.rows)), *sides.jumps], axis=0)
    jump[len(layout.freedoms) + np.array(rows)] -= sense * (unrefined.impulses.rate - touching.rate)[basis]
    contact_states = event.latch_states.copy()
    contact_states[touching.indices[basis]] = 1.0
    evaluator.workspace.hold(contact_states)
    state = sides.still.states[0]
    return solve_impulses(evaluator.workspace, event.given_impulse.before_time, state, load[None], jump[None]).columns


# Columns


def scale_columns(layout: Layout, units: Columns, touching: TouchingContacts, impulses: Array) -> Columns:
    """Return the columns of what is given and those of the contacts times their impulses, each with its own
    multiplier.
    """
    n = len(units.multipliers) - len(impulses)
    factors = np.concatenate([np.ones(n), impulses])

    def scale_table(table: Table) -> Table:
        out = table.copy()
        for name in table.dtype.names or ():
            out[name] = table[name] * factors.reshape(-1, *([1] * (table[name].ndim - 1)))
        return out

    multipliers = units.multipliers * factors[:, None]
    for k, i in enumerate(touching.indices.tolist()):
        contact = layout.contacts[i]
        multipliers[n + k, contact.row] -= contact.sense * impulses[k]
    return Columns(scale_table(units.bodies), scale_table(units.freedoms), multipliers)


def distribute_remainder(columns: Columns, exact_sum: Columns, place: int) -> None:
    """Add to the column at a place, in place, what the sum of all columns lacks of an exact one.

    column += exact sum - sum of all columns
    """
    total = columns.sum()
    for part in ("bodies", "freedoms"):
        table, right, summed = (getattr(x, part) for x in (columns, exact_sum, total))
        for name in table.dtype.names or ():
            table[name][place] += right[name][0] - summed[name]
    columns.multipliers[place] += exact_sum.multipliers[0] - total.multipliers


def stop_rounded_motion(layout: Layout, before_state: Array, after_state: Array) -> None:
    """Set rates after an impulse to zero, in place, where they are rounding of those before: what stands still has
    no motion.
    """
    for group in layout.tables["groups"]:
        rates = slice(group["rates"], group["end"])
        if group["rates"] < group["end"] and group["coordinates"] < group["rates"]:
            largest = np.abs(before_state[rates] * layout.weights[rates]).max()
            if np.abs(after_state[rates] * layout.weights[rates]).max() <= tolerances.SUM_ROUNDING * largest:
                after_state[rates] = 0.0
