"""Decide which frictions stick from an instant on, and which slip and where to: Coulomb's law as it is.

    at rest:  rate = 0 and |value| <= what it can hold,   or   value = -slip kinetic size and slip acceleration > 0

The frictions of one freedom are one group, which sticks or slips as a whole (friction_groups.py). Which states agree
with the motion is searched for in friction_search.py. The forms that friction may have are listed in the manual
(manual/format.md, "friction") and in scene/file_format/format_loads.py, FrictionEntry.

How a friction comes here, from the scene's text to the kernel and back:

    1. FrictionEntry             scene/file_format/format_loads.py: the keys of `type: friction`
    2. check_sticking_friction   scene/file_format/rules/loads.py: what may stick
    3. JointLoad.static          multibody/mechanism/loads.py: > 0 for friction that may stick; or ThreadLoad.static
    4. Mechanism.iter_sticking   multibody/mechanism/model.py: a StickingFriction for each coordinate that it holds
    5. _add_frictions            multibody/tree/closure_rows.py: a closure row and a Contact for each
    6. Layout.friction_contacts  multibody/tree/layout.py: which contacts those are; `open_contacts`: the states
    7. FrictionStates.decide     here, at each event: the states
    8. set_friction_mode         kernel/sticking.py: closes the row, or gives the load its sign
    9. measure_friction_margin   kernel/sticking.py: followed in each step, it causes the next event

With given sizes, static ones equal to kinetic, the accelerations are those of a convex problem and unique (Moreau 1988;
Brogliato, Nonsmooth Mechanics (2016), 5.5): then the first agreeing choice is the one.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.errors import Problem, SolveError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import join_names
from heuncli.motion.integration.contacts.friction_groups import (
    FrictionGroup,
    FrictionPlaces,
    PlaceResponse,
    has_fixed_transmissions,
    make_groups,
    measure_response,
)
from heuncli.motion.integration.contacts.friction_search import FrictionQuestion, StateSearch
from heuncli.motion.integration.contacts.latches import measure_coordinate_rate
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.results.results import Array, Mask

UNPROVED = (
    "{} sticks at t = {:.6g} s; that it could slip as well is not excluded, because 1 N of friction causes 1 N of "
    "further friction or more"
)
SHARED = "{} stick as one: how they share what holds the machine is indeterminate"


class PlaceStates(NamedTuple):
    """The states of the k places where friction may stick; a place is one coordinate that one friction may hold.

    sticks (k,): whether each sticks
    coordinate_or_sign (k,): its coordinate if it sticks, else the sign of its slip
    groups: the groups of several places that stick as one
    """

    sticks: Mask
    coordinate_or_sign: Array
    groups: tuple[FrictionGroup, ...]


class FrictionEvent(NamedTuple):
    """Where friction is decided anew.

    t, state: the instant [s] and the state from there on
    contact_states: those that stops and latches have from there on
    row: closure row of the contact that caused the event, None if no contact did
    is_struck: whether an impulse came before the state
    """

    t: float
    state: Array
    contact_states: Array
    row: int | None
    is_struck: bool


class FrictionStates:
    """The states of the frictions of a run that may stick: the present ones, and those before the present event.

    Changes with every event.
    """

    def __init__(self, evaluator: Evaluator, end_time: float) -> None:
        self.evaluator, self.layout, self.end_time = evaluator, evaluator.layout, end_time
        self.places = FrictionPlaces(evaluator)
        k = len(self.places.indices)
        self.present = self.earlier = PlaceStates(np.zeros(k, dtype=bool), np.zeros(k), ())

    def add_to(self, contact_states: Array) -> Array:
        """Return contact states with those of the friction."""
        present = self.present
        return self.places.set_states(contact_states, present.sticks, present.coordinate_or_sign, present.groups)

    def begin_event(self) -> None:
        """Take the present states as those before an event."""
        self.earlier = self.present

    def decide(self, event: FrictionEvent) -> list[str]:
        """Decide what sticks and slips from a state on; return sentences on what changes."""
        places, released_states = self.places, self.places.release_all(event.contact_states)
        released_results = places.evaluate(event.t, event.state, released_states)
        response = measure_response(self.evaluator, places.contacts, released_states, released_results)
        search = StateSearch(places, self.make_question(event, released_results, response))
        choice = search.find_choice() if search.groups else ()
        unproved = search.find_unproved(choice)
        chosen_states = search.with_choice(choice)
        groups = search.list_sticking(choice)
        if groups and not has_fixed_transmissions(
            self.evaluator, places.contacts, chosen_states, released_states, released_results, groups, self.end_time
        ):
            raise search.indeterminate_error(choice)
        sticks = np.array(chosen_states[places.indices] > 0.0, dtype=bool)
        self.present = PlaceStates(sticks, chosen_states[self.layout.friction_slice], groups)
        return self.describe_changes(event.t) + [UNPROVED.format(name, event.t) for name in unproved]

    def make_question(
        self, event: FrictionEvent, released_results: Evaluation, response: PlaceResponse
    ) -> FrictionQuestion:
        """Collect what is known of the places before the search.

        released_results: the results while no friction sticks or acts
        """
        places = self.places
        stuck, coordinate_or_sign = self.earlier.sticks & (not event.is_struck), self.earlier.coordinate_or_sign
        slip, is_at_rest = self.find_slips(released_results, response, stuck, event.row)
        at_rest = np.flatnonzero(is_at_rest).tolist()
        can_join = np.full(len(places.indices), places.is_given)  # no friction depends on how it shares
        groups = make_groups(response, at_rest, can_join, self.earlier.groups)
        broken_loose, earlier_slips = None, {}
        for n, group in enumerate(groups):
            is_event = places.has_row(group, event.row)
            if is_event and stuck[group.leader] and broken_loose is None:
                broken_loose = n
            sign = find_common_sign(group, coordinate_or_sign)
            if not (is_event or event.is_struck or stuck[list(group.members)].any()) and sign:
                earlier_slips[n] = sign
        coordinates = np.where(stuck, coordinate_or_sign, released_results.rows["gap"][0, places.rows])
        return FrictionQuestion(
            event.t, event.state, event.contact_states, groups, slip, coordinates, broken_loose, earlier_slips, response
        )

    def describe_changes(self, t: float) -> list[str]:
        """Return sentences on what begins to stick or to slip."""
        sentences = [
            f"{name} {'sticks' if now else 'slips'} from t = {t:.6g} s"
            for name, then, now in zip(self.places.names, self.earlier.sticks, self.present.sticks, strict=True)
            if now != then
        ]
        known = [group.members for group in self.earlier.groups]
        return sentences + [
            SHARED.format(join_names([self.places.names[k] for k in group.members]))
            for group in self.present.groups
            if group.members not in known
        ]

    def find_slips(
        self, released_results: Evaluation, response: PlaceResponse, stuck: Mask, row: int | None
    ) -> tuple[Array, Mask]:
        """Return the sign of the slip of each place (k,), and which are at rest, to rounding.

        What moves only with a place at rest is at rest where its rate is that of its leader, which an event has located
        to the rounding of an instant.
        """
        measured = [
            measure_coordinate_rate(self.layout, released_results, contact, self.end_time)
            for contact in self.places.contacts
        ]
        rate, noise = np.array(measured).reshape(-1, 2).T
        rested = stuck | (np.array(self.places.rows) == row) | (np.abs(rate) <= noise)
        is_at_rest = rested.copy()
        for k in np.flatnonzero(~rested):
            for leader in np.flatnonzero(rested & response.moves):
                if not response.moves[k] or not response.is_proportional(int(k), int(leader)):
                    continue
                transmission = response.find_transmission(int(k), int(leader))
                allowed = noise[k] + abs(transmission) * noise[leader]
                is_at_rest[k] |= abs(rate[k] - transmission * rate[leader]) <= allowed
        return np.where(is_at_rest, 0.0, np.sign(rate)), is_at_rest

    def unsettled_error(self, t: float) -> SolveError:
        """Make the error of frictions and touching contacts that change each other without end."""
        message = (
            f"at t = {t:.9g} s whether {join_names(self.places.names)} sticks depends on what touches, and changes it"
        )
        hint = "give the friction as a torque or force, or smoothed: speed"
        return SolveError(Problem("friction-undecided", message, hint=hint, entry_path=self.places.names[0]))


def find_common_sign(group: FrictionGroup, coordinate_or_sign: Array) -> int:
    """Return the sign of the leader's slip if all members slipped with it, 0 if not; signs (k,): before the event."""
    signs = {
        int(np.sign(coordinate_or_sign[k]) * np.sign(transmission))
        for k, transmission in zip(group.members, group.transmissions, strict=True)
    }
    return signs.pop() if len(signs) == 1 else 0


def read_places(evaluator: Evaluator, t: float, state: Array) -> Array:
    """Return the coordinates (k,) that sticking friction holds, at a state."""
    layout = evaluator.layout
    released_results = evaluator.evaluate(np.array([t]), state[None, :], holding=layout.open_contacts)
    return np.asarray(released_results.rows["gap"][0, [layout.contacts[i].row for i in layout.friction_contacts]])
