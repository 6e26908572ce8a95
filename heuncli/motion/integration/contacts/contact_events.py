"""Handle contact events: what is struck at an instant of a run, by which impulses, and what is held from then on.

touching.py finds the contacts that touch, latches.py what catches and releases, restitution.py the impulses and the
contacts that stay closed, impulse_columns.py the columns of impulses, contact_problem.py the errors, contact_notes.py
the sentences.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import replace
from heuncli.motion.integration.contacts.complementarity import find_coupled_groups
from heuncli.motion.integration.contacts.contact_notes import ContactNotes
from heuncli.motion.integration.contacts.contact_problem import (
    ContactOutcome,
    ContactProblem,
    UnrefinedImpulses,
    require_caught,
    require_energy,
    require_smooth,
    require_yielding,
)
from heuncli.motion.integration.contacts.impulse_columns import (
    bring_to_rest,
    distribute_remainder,
    scale_columns,
)
from heuncli.motion.integration.contacts.impulses import (
    SINGLE_INSTANT,
    GivenImpulse,
    ImpulseEvent,
    ImpulseResult,
    RightSides,
    compute_free_impulse_energy,
    find_state_after,
    make_impulse_event,
    make_right_sides,
)
from heuncli.motion.integration.contacts.latches import (
    UNWATCHED,
    LatchCatch,
    LatchConditions,
    Latches,
    add_catches,
    compute_catch_work,
)
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
from heuncli.motion.integration.contacts.shared_impulses import (
    LoadedContact,
    SharedImpulse,
    find_shared_impulses,
    list_bilateral_contacts,
    select_loaded,
)
from heuncli.motion.integration.contacts.sticking import FrictionStates
from heuncli.motion.integration.contacts.touching import (
    TouchingContacts,
    can_move_bodies,
    find_opening_rates,
    find_touching,
)
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.multibody.response import Columns, ImpulseColumns, solve_impulses
from heuncli.multibody.tree.layout import CLOSED_BY_OTHERS
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.file_format.models import SIMULTANEOUS

MAX_FRICTION_CHANGES = 8  # of friction that sticks beside touching contacts, which both depend on each other


def find_held_contacts(evaluator: Evaluator, t: float, state: Array) -> Array:
    """Return the contacts that are closed at a state, after the impulse that may happen there.

    There is no run: rounding counts as it does in one of a second.
    """
    contacts = Contacts(evaluator, SINGLE_INSTANT)
    contacts.handle_event(GivenImpulse(t, t, (), {}), state, t, None)
    return contacts.contact_states


class Contacts:
    """The contacts of one run: which are closed, and the notes on them. Changes with every event.

    contact_states: of all contacts; then for each latch and friction where it holds, or the sign of its slip; then for
    each friction the contact of its group's leader, counted from 1, and its transmission (Layout.open_contacts). It is
    what `holding` is elsewhere.
    """

    def __init__(self, evaluator: Evaluator, end_time: float) -> None:
        self.evaluator, self.end_time = evaluator, end_time
        self.layout = evaluator.layout
        self.contact_states = self.layout.open_contacts
        self.latches = Latches(self.layout, end_time)
        self.friction = FrictionStates(evaluator, end_time)
        self.notes = ContactNotes(self.layout, end_time)

    def handle_event(
        self,
        given_impulse: GivenImpulse,
        state: Array,
        time: float,
        row: int | None,
        latch_conditions: LatchConditions | None = None,
    ) -> ImpulseEvent | None:
        """Handle an event and return the impulse that it causes, if any. The order of the steps matters:

        1. What is closed, without what opens: a taut rope whose prescribed rate jumps is refused.
        2. Latches release first, so that what they held is free in all that follows.
        3. The right sides and the touching contacts are those of the state with the remaining latches holding.
        4. Latches catch what touches; a limit at which one holds is no contact any more.
        5. The contact problem has one column for each cause, those of catches included, and one for each contact.
        6. Catches and contacts that drives contradict are refused before anything is solved for them.
        7. The impulses are solved; what rests is decided in the state after them, then what sticks, until both agree.
        8. Notes and the event follow from the outcome; its energy balance is checked last.

        row: closure row of the contact that closed or opened there
        latch_conditions: the conditions of latches there; by default evaluated at the state
        """
        latches = self.latches
        is_closed = (self.contact_states > 0.0) & ~self.find_opening_redundant(row)
        require_smooth(self.layout, given_impulse, is_closed)
        latch_conditions = latch_conditions or latches.evaluate_conditions(given_impulse.before_time, state)
        released = latches.release(latch_conditions)
        sides = make_right_sides(self.evaluator, given_impulse, state, latches.make_states())
        contacts_touching = find_touching(self.layout, sides.still, is_closed, row, self.end_time)
        catches = latches.catch(latch_conditions, sides.still, contacts_touching)
        is_free = latches.find_unheld_contacts(contacts_touching)
        unwatched, contacts_touching = contacts_touching.indices[~is_free], contacts_touching.select(is_free)
        sides = add_catches(self.layout, sides, catches)
        solution, problem = self.make_problem(given_impulse, sides, contacts_touching)
        require_caught(self.evaluator, sides, solution, catches, given_impulse.before_time)
        rates = contacts_touching.rate + problem.rates
        require_yielding(self.layout, problem, rates, contacts_touching.noise, given_impulse.before_time)
        outcome = self.find_outcome(given_impulse, sides, solution.columns, problem, catches, unwatched, row)
        shared_impulses = self.find_shared(problem, outcome, catches)
        self.notes.add_notes(time, contacts_touching, outcome, shared_impulses)
        self.notes.add_latch_notes(time, released, catches)
        if not outcome.impulses.impulses.any() and not sides.loads:
            return None
        result = self.make_result(time, sides, solution, problem, outcome, catches, shared_impulses)
        sides = replace(sides, still=self.add_active_contacts(sides.still, problem, outcome.impulses))
        event = make_impulse_event(self.evaluator, given_impulse, sides, result)
        energy_scale = 0.5 * float(outcome.impulses.impulses**2 @ np.diag(problem.A))
        require_energy(event, energy_scale + compute_free_impulse_energy(self.layout, sides.impulses))
        return event

    def make_result(
        self,
        time: float,
        sides: RightSides,
        solution: ImpulseColumns,
        problem: ContactProblem,
        outcome: ContactOutcome,
        catches: list[LatchCatch],
        shared_impulses: tuple[SharedImpulse, ...],
    ) -> ImpulseResult:
        """Make the result of an event: what is given and what bears, each with its column, and the state after it."""
        which, impulses, n = problem.touching.indices, outcome.impulses, len(sides.loads)
        bearing = np.flatnonzero(impulses.impulses)
        causes = (*sides.causes, *(self.layout.contacts[i].name for i in which[bearing]))
        used_columns = np.array([*range(n), *(n + bearing)], dtype=int)
        columns = outcome.columns.select(used_columns)
        struck_names = tuple(self.layout.contacts[i].name for i in which[impulses.takes_part])
        struck_names += tuple(self.layout.contacts[catch.contact].name for catch in catches if catch.rate != 0.0)
        return ImpulseResult(
            time,
            ImpulseColumns(columns, solution.unmet[used_columns], solution.massless_count),
            causes,
            outcome.after_state,
            outcome.work,
            self.contact_states.copy(),
            struck_names,
            shared_impulses,
        )

    def find_outcome(
        self,
        given_impulse: GivenImpulse,
        sides: RightSides,
        units: Columns,
        problem: ContactProblem,
        catches: list[LatchCatch],
        unwatched: Indices,
        row: int | None,
    ) -> ContactOutcome:
        """Solve for the impulses and for what is held from then on, and store that.

        Contacts that rest are decided with the friction there is, then the friction with them: again, where that
        changes. unwatched: contacts that a latch holds at their limits
        """
        self.friction.begin_event()
        for _ in range(MAX_FRICTION_CHANGES):
            outcome = self.solve_event(given_impulse, sides, units, problem, catches)
            self.contact_states = self.friction.add_to(self.latches.make_states())
            self.contact_states[problem.touching.indices] = outcome.contact_states
            self.contact_states[unwatched] = UNWATCHED
            if not self.friction.places.indices:
                return outcome
            before, is_struck = self.contact_states.copy(), bool(sides.loads) or bool(outcome.impulses.impulses.any())
            sentences = self.friction.decide(given_impulse.after_time, outcome.after_state, before, row, is_struck)
            self.contact_states = self.friction.add_to(before)
            if not len(outcome.contact_states) or np.array_equal(before, self.contact_states):
                self.notes.add(sentences)
                return outcome
        raise self.friction.unsettled_error(given_impulse.after_time)

    def find_opening_redundant(self, row: int | None) -> Mask:
        """Mark the contact (contacts,) that redundant others held closed and whose gap, now beyond rounding, opens."""
        is_left = np.zeros(len(self.contact_states), dtype=bool)
        for k, contact in enumerate(self.layout.contacts):
            is_left[k] = contact.row == row and self.contact_states[k] == CLOSED_BY_OTHERS
        return is_left

    def make_problem(
        self, given_impulse: GivenImpulse, sides: RightSides, contacts_touching: TouchingContacts
    ) -> tuple[ImpulseColumns, ContactProblem]:
        """Compute the columns of what is given and of each touching contact, and the contact problem they make."""
        self.evaluator.workspace.hold(self.latches.make_states())
        n, n_u = len(sides.loads), len(self.layout.freedoms) + len(self.layout.rows)
        loads = np.array([*sides.loads, *contacts_touching.loads]).reshape(-1, len(self.layout.place), 6)
        jumps = np.array([*sides.jumps, *([np.zeros(n_u)] * len(contacts_touching.indices))]).reshape(-1, n_u)
        solution = solve_impulses(
            self.evaluator.workspace, given_impulse.before_time, sides.still.states[0], loads, jumps
        )
        rates = find_opening_rates(contacts_touching, solution.columns.bodies)
        A = 0.5 * (rates[:, n:] + rates[:, n:].T)
        return solution, ContactProblem(
            contacts_touching, A, can_move_bodies(self.layout, contacts_touching, A), rates[:, :n].sum(axis=1)
        )

    def solve_event(
        self,
        given_impulse: GivenImpulse,
        sides: RightSides,
        units: Columns,
        problem: ContactProblem,
        catches: list[LatchCatch],
    ) -> ContactOutcome:
        """Solve for the impulses, then for the contacts that stay closed; a rebound too short to be seen does not
        count.
        """
        contacts_touching, open_states = problem.touching, self.friction.add_to(self.latches.make_states())
        at_rest = np.zeros(len(contacts_touching.indices), dtype=bool)
        while True:
            impulses = self.solve_impulses(given_impulse.after_time, problem, at_rest)
            columns = scale_columns(self.layout, units, contacts_touching, impulses.impulses)
            after_state, work = find_state_after(self.layout, given_impulse, sides, columns)
            after_evaluation = self.evaluator.evaluate(
                np.array([given_impulse.after_time]), after_state[None, :], holding=open_states
            )
            contact_states, acceleration = find_resting(
                contacts_touching, problem.A, problem.moves, impulses.rate, after_evaluation, self.layout
            )
            noise = estimate_acceleration_noise(self.layout, contacts_touching, problem.A, after_evaluation)
            is_still = impulses.rate == 0.0
            require_yielding(
                self.layout, problem, np.where(is_still, acceleration, 0.0), noise, given_impulse.after_time
            )
            shortest_time = tolerances.SHORTEST_FLIGHT * self.end_time
            is_short = (
                is_short_flight(contacts_touching, impulses.rate, acceleration, shortest_time)
                & ~at_rest
                & problem.moves
            )
            if not is_short.any():
                break
            at_rest = at_rest | is_short
        if self.layout.mechanism.joint_friction or self.friction.places.indices:
            self.require_decided(given_impulse.after_time, after_state, problem, contact_states, impulses.rate)
        if impulses.impulses.any():
            bearing = np.flatnonzero(impulses.impulses)
            basis = np.arange(len(bearing))
            if self.layout.mechanism.impacts != SIMULTANEOUS:
                basis = find_independent(problem.A[np.ix_(bearing, bearing)])
            unrefined = UnrefinedImpulses(contacts_touching, impulses, units, bearing[basis], np.delete(bearing, basis))
            impulses, columns, total = self.refine_impulses(given_impulse, sides, unrefined)
            after_state, work = find_state_after(self.layout, given_impulse, sides, total)
        work += float(impulses.impulses @ (0.5 * (contacts_touching.rate + impulses.rate)))
        work += compute_catch_work(self.layout, catches, columns.multipliers)
        bring_to_rest(self.layout, sides.still.states[0], after_state)
        return ContactOutcome(impulses, contact_states, at_rest, columns, after_state, work)

    def solve_impulses(self, t: float, problem: ContactProblem, at_rest: Mask) -> ContactImpulses:
        """Solve for the impulses of the contacts; at_rest: those that stay closed. Raises SolveError for endless
        impacts.
        """
        contacts_touching = problem.touching
        try:
            return solve_contact_impulses(
                contacts_touching, problem.A, problem.moves, problem.rates, at_rest, self.layout.mechanism.impacts
            )
        except EndlessImpacts as endless:
            names = [self.layout.contacts[i].name for i in contacts_touching.indices.tolist()]
            raise make_endless_impacts_error(t, names, endless, self.layout.mechanism.impacts) from None

    def find_shared(
        self, problem: ContactProblem, outcome: ContactOutcome, catches: list[LatchCatch]
    ) -> tuple[SharedImpulse, ...]:
        """Find the contacts for which a model says how they share the impulse: bearing ones, catching latches, and
        others.
        """
        impulses, which = outcome.impulses, problem.touching.indices
        taking_part, n = np.flatnonzero(impulses.takes_part), len(outcome.columns.multipliers) - len(which)
        contacts = [
            LoadedContact(
                contact.name,
                contact.row,
                n + int(k),
                impacts=int(impulses.count[k]),
                comes_to_rest=bool(impulses.comes_to_rest[k]),
            )
            for k, contact in ((k, self.layout.contacts[which[k]]) for k in taking_part)
        ]
        catching_contacts = [self.layout.contacts[catch.contact] for catch in catches if catch.rate != 0.0]
        first = n - len(catching_contacts)
        contacts += [
            LoadedContact(contact.name, contact.row, first + k, is_held=True)
            for k, contact in enumerate(catching_contacts)
        ]
        contacts += select_loaded(list_bilateral_contacts(self.layout), outcome.columns.multipliers)
        is_coupled = np.zeros((len(contacts), len(contacts)), dtype=bool)
        # also through contacts that bear nothing, which depends on the model, too
        for group in find_coupled_groups(problem.A):
            members = np.isin(taking_part, group)
            is_coupled[: len(taking_part), : len(taking_part)] |= members[:, None] & members
        return tuple(find_shared_impulses(contacts, is_coupled, outcome.columns.multipliers))

    def require_decided(
        self, t: float, after_state: Array, problem: ContactProblem, contact_states: Array, rate: Array
    ) -> None:
        """Raise SolveError where load-dependent joint friction makes other contacts bear than those that are held."""
        contacts_touching, all_states = problem.touching, self.friction.add_to(self.latches.make_states())
        all_states[contacts_touching.indices] = contact_states
        evaluation = self.evaluator.evaluate(np.array([t]), after_state[None, :], holding=all_states)
        is_wrong = find_contradicted(contacts_touching, problem.A, contact_states, rate, evaluation, self.layout)
        if is_wrong.any():
            names = ", ".join(self.layout.contacts[i].name for i in contacts_touching.indices[is_wrong])
            message = f"at t = {t:.9g} s whether {names} carries load depends on joint friction, and changes it"
            hint = "use a constant friction, or contacts that do not touch there at the same time"
            raise SolveError(Problem("friction-not-unique", message, hint=hint))

    def refine_impulses(
        self, given_impulse: GivenImpulse, sides: RightSides, unrefined_impulses: UnrefinedImpulses
    ) -> tuple[ContactImpulses, Columns, Columns]:
        """Recompute impulses and columns with the digits that A loses between very unequal masses; also return their
        sum.

        M dV = H + sum of z_k W_k' over others + J' Lambda,    J dV = jumps, with W_i dV = v+_i - v-_i of the basis

        The rates v+ after the impulse are known: so the contacts of the basis are held like closures, and one column
        gives their impulses z_i = -sense Lambda_i. What the columns of the contacts lack of it goes to the last of
        them.
        """
        contacts_touching, solution = unrefined_impulses.touching, unrefined_impulses.impulses
        basis, others = unrefined_impulses.basis, unrefined_impulses.others
        exact_sum = self.solve_basis(given_impulse, sides, unrefined_impulses)
        contacts = [self.layout.contacts[i] for i in contacts_touching.indices[basis].tolist()]
        impulses = solution.impulses.copy()
        impulses[basis] = -np.array([c.sense for c in contacts]) * exact_sum.multipliers[0, [c.row for c in contacts]]
        columns = scale_columns(self.layout, unrefined_impulses.units, contacts_touching, impulses)
        for k in others.tolist():  # these are given loads in the one column
            contact = self.layout.contacts[contacts_touching.indices[k]]
            exact_sum.multipliers[0, contact.row] -= contact.sense * impulses[k]
        distribute_remainder(columns, exact_sum, len(sides.loads) + int(basis[-1]))
        return replace(solution, impulses=impulses), columns, exact_sum

    def solve_basis(
        self, given_impulse: GivenImpulse, sides: RightSides, unrefined_impulses: UnrefinedImpulses
    ) -> Columns:
        """Solve the one column of what is given with the contacts of the basis held, whose rates after it are known."""
        contacts_touching, solution = unrefined_impulses.touching, unrefined_impulses.impulses
        basis, others = unrefined_impulses.basis, unrefined_impulses.others
        contacts = [self.layout.contacts[i] for i in contacts_touching.indices[basis].tolist()]
        rows, sense = [c.row for c in contacts], np.array([c.sense for c in contacts])
        load = np.sum([np.zeros((len(self.layout.place), 6)), *sides.loads], axis=0)
        load = load + np.einsum("k,kbi->bi", solution.impulses[others], contacts_touching.loads[others])
        jump = np.sum([np.zeros(len(self.layout.freedoms) + len(self.layout.rows)), *sides.jumps], axis=0)
        jump[len(self.layout.freedoms) + np.array(rows)] -= sense * (solution.rate - contacts_touching.rate)[basis]
        contact_states = self.latches.make_states()
        contact_states[contacts_touching.indices[basis]] = 1.0
        self.evaluator.workspace.hold(contact_states)
        return solve_impulses(
            self.evaluator.workspace, given_impulse.before_time, sides.still.states[0], load[None], jump[None]
        ).columns

    def add_active_contacts(self, still: Evaluation, problem: ContactProblem, impulses: ContactImpulses) -> Evaluation:
        """Return the results before the impulse, with the contacts that take part in it, so that indeterminate shares
        are found.

        A sequence determines the impulses of contacts that others could replace; these leave nothing indeterminate.
        """
        contacts_touching, rows, contact_states = problem.touching, still.rows.copy(), self.latches.make_states()
        is_active = impulses.takes_part
        if self.layout.mechanism.impacts != SIMULTANEOUS:
            bearing = np.flatnonzero(impulses.impulses)
            is_active = impulses.depends.copy()
            is_active[bearing[find_independent(problem.A[np.ix_(bearing, bearing)])]] = True
        contact_states[contacts_touching.indices] = is_active
        if np.array_equal(self.layout.closed_contacts(contact_states), still.holding[0]):
            return still
        active_rows = self.evaluator.evaluate(still.times, still.states, holding=contact_states).rows
        for name in ("chosen", "closed"):
            rows[name] = active_rows[name]
        return replace(still, rows=rows)
