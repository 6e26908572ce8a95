"""Decide which frictions stick from an instant on, and which slip and where to: Coulomb's law as it is.

    at rest:  rate = 0 and |value| <= what it can hold,   or   value = -slip kinetic size and slip acceleration > 0

A choice gives each place at rest a state: it sticks, or slips in one direction. The kernel solves the motion of a
choice with all its couplings. A choice is possible if its results agree with it.

    - A friction that has just reached its limit slips, in the direction in which it was pushed.
    - Of several possible choices that one is taken in which every place sticks that sticks in any of them.
    - Errors are: no possible choice, two that differ otherwise, a sticking friction whose value others could take over.
    - The frictions of one freedom are one place, which sticks or slips as a whole (friction_groups.py).

How a friction comes here, from the scene's text to the kernel and back:

    1. FrictionEntry             scene/file_format/format_loads.py: the keys of `type: friction`
    2. check_sticking_friction   scene/file_format/rules/loads.py: what may stick
    3. JointLoad.static          multibody/mechanism/loads.py: > 0 for friction that may stick; or ThreadLoad.static
    4. Mechanism.iter_sticking   multibody/mechanism/model.py: a StickingFriction for each coordinate that it holds
    5. _add_frictions            multibody/tree/closure_rows.py: a closure row and a Contact for each
    6. Layout.friction_contacts  multibody/tree/layout.py: which contacts those are; `open_contacts`: the states
    7. FrictionStates.decide     here, at each event: the states
    8. set_friction_mode         kernel/sticking.py: closes the row, or gives the load its sign
    9. friction_margin           kernel/sticking.py: followed in each step, it causes the next event

With given sizes, static ones equal to kinetic, the accelerations are those of a convex problem and unique (Moreau 1988;
Brogliato, Nonsmooth Mechanics (2016), 5.5): then the first agreeing choice is the one.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.named_tuples import NamedTuple
from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.contacts.contact_problem import make_jamming_problem
from heuncli.motion.integration.contacts.friction_groups import (
    FrictionGroup,
    PlaceResponse,
    has_fixed_transmissions,
    list_group_numbers,
    make_groups,
    measure_response,
)
from heuncli.motion.integration.contacts.latches import measure_coordinate_rate
from heuncli.motion.integration.contacts.restitution import find_coupled_groups
from heuncli.motion.integration.contacts.shared_impulses import join_names
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.results.results import Array, Mask

STICKS = 0  # states of a place: it sticks, or slips towards 1 or -1
MAX_ENUMERATED = 5  # places at rest of which all 3^5 = 243 choices are tried
Choice = tuple[int, ...]  # a state for each group at rest


class StateTrial(NamedTuple):
    """The motion with a choice: whether its results agree with it, and what to try instead where they do not.

    is_replaceable: the sticking frictions could be replaced by others, so that their values are indeterminate
    jam: what the kernel found of friction by a coefficient: its outcome and row; None if it found one solution
    """

    agrees: bool
    next_choice: Choice
    accelerations: Array
    is_replaceable: bool
    jam: tuple[int, int] | None


UNPROVED = (
    "{} sticks at t = {:.6g} s; that it could slip as well is not excluded, because 1 N of friction causes 1 N of "
    "further friction or more"
)
SHARED = "{} stick as one: how they share what holds the machine is indeterminate"


class FrictionStates:
    """The places of a run where friction may stick, and the state of each. Changes with every event.

    presses (k,): whether the joint's own load tells its size; has_one_size: static friction is kinetic everywhere
    is_given: no friction depends on a load; is_convex: so that one choice agrees at most
    sticks (k,): whether each sticks; coordinate_or_sign (k,): its coordinate then, else the sign of its slip
    groups: those of several places that stick as one
    """

    def __init__(self, evaluator: Evaluator, last: float) -> None:
        self.evaluator, self.layout, self.last = evaluator, evaluator.layout, last
        self.indices = list(self.layout.friction_contacts)
        self.contacts = [self.layout.contacts[i] for i in self.indices]
        self.rows = [contact.row for contact in self.contacts]
        self.load_rows = [contact.load_row for contact in self.contacts]
        self.names = [contact.name for contact in self.contacts]
        self.sticks = np.zeros(len(self.indices), dtype=bool)
        self.coordinate_or_sign = np.zeros(len(self.indices))
        self.groups: tuple[FrictionGroup, ...] = ()
        # before the event
        self.earlier: tuple[Mask, Array, tuple[FrictionGroup, ...]] = self.sticks, self.coordinate_or_sign, self.groups
        loads = self.layout.tables["loads"][self.load_rows]
        self.presses = loads["normal_force_kind"] != kernel.GIVEN
        self.has_one_size = bool((loads["breakaway"] == loads["coefficient"]).all())
        self.is_given = not self.layout.mechanism.joint_friction
        self.is_convex = self.is_given and self.has_one_size

    def add_to(self, holding: Array) -> Array:
        """Return contact states with those of the friction."""
        return self.set_states(holding, self.sticks, self.coordinate_or_sign, self.groups)

    def set_states(
        self, holding: Array, sticks: Array, coordinate_or_sign: Array, groups: Sequence[FrictionGroup] = ()
    ) -> Array:
        """Return contact states in which friction sticks at a coordinate, in groups, or slips with a sign."""
        holding, n = holding.copy(), len(self.indices)
        if n:
            holding[self.indices] = sticks
            holding[len(holding) - 3 * n : len(holding) - 2 * n] = coordinate_or_sign
            holding[len(holding) - 2 * n :] = list_group_numbers(groups, self.indices)
        return holding

    def release_all(self, holding: Array) -> Array:
        """Return contact states in which no friction sticks or acts."""
        none = np.zeros(len(self.indices))
        return self.set_states(holding, none, none)

    def begin_event(self) -> None:
        """Take the present states as those before an event."""
        self.earlier = self.sticks, self.coordinate_or_sign, self.groups

    def decide(self, t: float, state: Array, holding: Array, row: int | None, is_struck: bool) -> list[str]:
        """Decide what sticks and slips from a state on; return sentences on what changes.

        holding: contact states with those that stops and latches have from here on
        row: of the contact that caused the event; is_struck: an impulse came before the state
        """
        opened = self.evaluate(t, state, self.release_all(holding))
        response = measure_response(self.evaluator, self.contacts, self.release_all(holding), opened)
        before, coordinate_or_sign, held_groups = self.earlier
        stuck = before & (not is_struck)
        slip, is_at_rest = self.find_slips(opened, response, stuck, row)
        at_rest = np.flatnonzero(is_at_rest).tolist()
        groups = make_groups(response, at_rest, self.find_joinable(), held_groups)
        broken = next((n for n, group in enumerate(groups) if stuck[group.leader] and self.has_row(group, row)), None)
        coordinates = np.where(stuck, coordinate_or_sign, opened.rows["gap"][0, self.rows])
        search = StateSearch(self, t, state, holding, groups, slip, coordinates, broken, response)
        choice = search.find_choice() if groups else ()
        unproved = search.find_unproved(choice)
        held_contacts = search.with_choice(choice)
        self.groups = search.list_sticking(choice)
        if self.groups and not has_fixed_transmissions(
            self.evaluator, self.contacts, held_contacts, self.release_all(holding), opened, self.groups, self.last
        ):
            raise search.indeterminate_error(choice)
        self.sticks = np.array(held_contacts[self.indices] > 0.0, dtype=bool)
        self.coordinate_or_sign = held_contacts[len(held_contacts) - 3 * len(self.indices) :][: len(self.indices)]
        sentences = [
            f"{name} {'sticks' if now else 'slips'} from t = {t:.6g} s"
            for name, then, now in zip(self.names, before, self.sticks, strict=True)
            if now != then
        ]
        for group in self.groups:
            if group.members not in [earlier.members for earlier in held_groups]:
                sentences.append(SHARED.format(join_names([self.names[k] for k in group.members])))
        return sentences + [UNPROVED.format(name, t) for name in unproved]

    def has_row(self, group: FrictionGroup, row: int | None) -> bool:
        """Return whether a closure row is that of a member of a group."""
        return any(self.rows[k] == row for k in group.members)

    def find_joinable(self) -> Mask:
        """Return which places (k,) may stick in a group: all if no friction depends on how it shares."""
        return np.full(len(self.indices), self.is_given)

    def find_slips(
        self, opened: Evaluation, response: PlaceResponse, stuck: Mask, row: int | None
    ) -> tuple[Array, Mask]:
        """Return the sign of the slip of each place (k,), and which are at rest, to rounding.

        What moves only with a place at rest is at rest where its rate is that of its leader, which an event has located
        to the rounding of an instant.
        """
        measured = [measure_coordinate_rate(self.layout, opened, contact, self.last) for contact in self.contacts]
        rate, noise = np.array(measured).reshape(-1, 2).T
        rested = stuck | (np.array(self.rows) == row) | (np.abs(rate) <= noise)
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
        message = f"at t = {t:.9g} s whether {join_names(self.names)} sticks depends on what touches, and changes it"
        hint = "give the friction as a torque or force, or smoothed: speed"
        return SolveError(Problem("friction-undecided", message, hint=hint, entry_path=self.names[0]))

    def evaluate(self, t: float, state: Array, holding: Array) -> Evaluation:
        """Evaluate a state with given contact states."""
        return self.evaluator.evaluate(np.array([t]), state[None, :], holding=holding)


def read_places(evaluator: Evaluator, t: float, state: Array) -> Array:
    """Return the coordinates (k,) that sticking friction holds, at a state."""
    layout = evaluator.layout
    opened = evaluator.evaluate(np.array([t]), state[None, :], holding=layout.open_contacts)
    return np.asarray(opened.rows["gap"][0, [layout.contacts[i].row for i in layout.friction_contacts]])


class StateSearch:
    """The search for the choice at an instant; used for one call of `FrictionStates.decide`.

    groups: places without a rate; slip (n,): signs of the others' rates; coordinates (n,): where each would stick
    broken: the group that has reached what it can hold; None: none has
    response: of all places, without their loads
    """

    def __init__(
        self,
        friction: FrictionStates,
        t: float,
        state: Array,
        holding: Array,
        groups: list[FrictionGroup],
        slip: Array,
        coordinates: Array,
        broken: int | None,
        response: PlaceResponse,
    ) -> None:
        self.friction, self.t, self.state, self.holding = friction, t, state, holding
        self.groups, self.slip, self.coordinates, self.broken = groups, slip, coordinates, broken
        self.leaders = [group.leader for group in groups]
        self.trials: dict[Choice, StateTrial] = {}
        self.noise, self.slack = response.noise, response.slack
        self.response = response.response[np.ix_(self.leaders, self.leaders)]
        self.pushed = self.find_push()

    def find_push(self) -> int:
        """Return the way in which the broken friction is pushed: against its value while all stick; 0: none is."""
        if self.broken is None:
            return 0
        friction = self.friction
        before = friction.evaluate(self.t, self.state, self.with_choice((STICKS,) * len(self.groups)))
        value = self.groups[self.broken].sum_at_leader(before.loads["value"][0, friction.load_rows])
        return -1 if value > 0.0 else 1

    def with_choice(self, choice: Choice) -> Array:
        """Return the contact states of a choice."""
        sticks, coordinate_or_sign = np.zeros(len(self.slip), dtype=bool), self.slip.copy()
        for group, chosen in zip(self.groups, choice, strict=True):
            for k, transmission in zip(group.members, group.transmissions, strict=True):
                sticks[k] = chosen == STICKS
                coordinate_or_sign[k] = self.coordinates[k] if chosen == STICKS else chosen * np.sign(transmission)
        return self.friction.set_states(self.holding, sticks, coordinate_or_sign, self.list_sticking(choice))

    def list_sticking(self, choice: Choice) -> tuple[FrictionGroup, ...]:
        """Return the groups of several places that stick in a choice."""
        pairs = zip(self.groups, choice, strict=True)
        return tuple(group for group, chosen in pairs if chosen == STICKS and len(group.members) > 1)

    def find_choice(self) -> Choice:
        """Return the choice that agrees with its own results; raise SolveError if that is not one."""
        found, everything = self.find_by_steps(), list(range(len(self.groups)))
        if found is None:
            found = self.find_among(everything, (STICKS,) * len(everything))
        elif not self.friction.is_convex:
            for group in find_coupled_groups(self.response) if self.friction.is_given else [everything]:
                members = [int(n) for n in group]
                if any(found[n] != STICKS and n != self.broken for n in members):
                    found = self.find_among(members, found)
        if self.trials[found].is_replaceable:
            raise self.indeterminate_error(found)
        return found

    def find_unproved(self, choice: Choice) -> list[str]:
        """Return the places that stick although their own feedback leaves open whether they could slip as well."""
        names: list[str] = []
        if self.friction.is_given:
            return names
        for n, k in enumerate(self.leaders):
            others = [(*choice[:n], slip, *choice[n + 1 :]) for slip in (1, -1)]
            if choice[n] == STICKS and any(self.solve_trial(other).jam is not None for other in others):
                names.append(self.friction.names[k])
        return names

    def find_by_steps(self) -> Choice | None:
        """Return an agreeing choice, from all that stick on, by changing what does not agree; None if that repeats."""
        choice = tuple(self.pushed if n == self.broken else STICKS for n in range(len(self.groups)))
        while choice not in self.trials:
            trial = self.solve_trial(choice)
            if trial.agrees:
                return choice
            choice = trial.next_choice
        return None

    def find_among(self, members: list[int], choice: Choice) -> Choice:
        """Return the agreeing choice in which everything sticks that does in any other, of all for some members."""
        if len(members) > MAX_ENUMERATED:
            raise self.undecided_error(f"more than {MAX_ENUMERATED} of them are at rest and move each other")
        found = [other for other in self.list_choices(members, choice) if self.solve_trial(other).agrees]
        if not found:
            jams = [trial.jam for trial in self.trials.values() if trial.jam is not None]
            if jams:
                raise self.jamming_error(*jams[0])
            raise self.undecided_error("no choice of them agrees with the motion that it leads to")
        most = max(found, key=lambda other: other.count(STICKS))
        for other in found:
            differs = any(x == STICKS and y != STICKS for x, y in zip(other, most, strict=True)) or (
                other != most and (self.friction.has_one_size or STICKS not in most)
            )
            scale = np.abs(self.trials[most].accelerations).max(initial=0.0)
            gap = np.abs(self.trials[other].accelerations - self.trials[most].accelerations).max(initial=0.0)
            if differs and gap > tolerances.CONTACT_ACCELERATION * scale:
                raise self.undecided_error("several choices of them agree with the motions that they lead to")
        return most

    def list_choices(self, members: list[int], choice: Choice) -> Iterator[Choice]:
        """Yield all choices for some members; what is broken slips as it is pushed."""
        options = [(STICKS, 1, -1) if n in members else (state,) for n, state in enumerate(choice)]
        if self.broken is not None:
            options[self.broken] = (self.pushed,)
        return itertools.product(*options)

    def solve_trial(self, choice: Choice) -> StateTrial:
        """Solve the motion of a choice and compare it with that."""
        if choice not in self.trials:
            self.trials[choice] = self.compare_results(choice)
        return self.trials[choice]

    def compare_results(self, choice: Choice) -> StateTrial:
        """Compare the results of a choice with it."""
        friction = self.friction
        evaluation = friction.evaluate(self.t, self.state, self.with_choice(choice))
        rows, loads = evaluation.rows[0][friction.rows], evaluation.loads[0][friction.load_rows]
        noise = self.noise + tolerances.CONTACT_ACCELERATION * rows["terms"]
        is_met = bool(evaluation.residual[0] <= evaluation.allowed_residual[0])
        next_states = list(choice)
        for n, (group, k) in enumerate(zip(self.groups, self.leaders, strict=True)):
            acceleration, reserve = float(rows["acceleration"][k]), float(loads["reserve"][k])
            value = group.sum_at_leader(loads["value"])
            if choice[n] == STICKS:
                # what more would only accelerate by rounding
                allowed = tolerances.KERNEL["friction_rounding"] * (2.0 * abs(value) + abs(reserve)) + self.slack[k]
                if not (is_met and reserve >= -allowed):
                    next_states[n] = -1 if value > 0.0 else 1
            elif n == self.broken:
                if not choice[n] * acceleration >= -noise[k]:
                    next_states[n] = -choice[n]
            elif not choice[n] * acceleration > noise[k]:
                next_states[n] = STICKS
        jam = next(
            (
                (int(loads["span"][k]), friction.load_rows[k])
                for k in range(len(loads))
                if friction.presses[k] and loads["span"][k] != kernel.FOUND
            ),
            None,
        )
        agrees = tuple(next_states) == choice and jam is None and bool(np.isfinite(rows["acceleration"]).all())
        return StateTrial(
            agrees, tuple(next_states), rows["acceleration"].copy(), self.is_replaceable(evaluation, choice), jam
        )

    def is_replaceable(self, evaluation: Evaluation, choice: Choice) -> bool:
        """Return whether a friction that sticks depends on other constraints than those of its group."""
        if not evaluation.rows["closed"][0, self.friction.rows].any():
            return False
        holding = evaluation.holding[0].copy()
        holding[self.friction.indices] = 0.0
        opened = self.friction.evaluate(self.t, self.state, holding)
        in_groups = sum(len(group.members) - 1 for group in self.list_sticking(choice))
        return int(evaluation.dependent_count[0]) != int(opened.dependent_count[0]) + in_groups

    def undecided_error(self, why: str) -> SolveError:
        """Make the error of places whose states do not follow from the laws."""
        names = join_names([self.friction.names[k] for group in self.groups for k in group.members])
        message = f"at t = {self.t:.9g} s whether {names} sticks or slips cannot be decided: {why}"
        hint = "give the friction as a torque or force, in fewer joints, or smoothed: speed"
        return SolveError(Problem("friction-undecided", message, hint=hint, entry_path=self.first_path))

    def indeterminate_error(self, choice: Choice) -> SolveError:
        """Make the error of sticking frictions that share a load in a way that nothing determines."""
        pairs = zip(self.groups, choice, strict=True)
        sticking = [self.friction.names[k] for group, chosen in pairs if chosen == STICKS for k in group.members]
        message = f"at t = {self.t:.9g} s {join_names(sticking)}"
        joints = self.friction.layout.mechanism.joints
        held = [self.friction.contacts[k].joint for group in self.groups for k in group.members]
        drives = [joint.drive.name for k in held if k < len(joints) and (joint := joints[k]).drive is not None]
        if len(sticking) > 1:
            message += " stick, and how they share what holds the machine is indeterminate"
        else:
            what = f"drives.{drives[0]}" if drives else "a drive, a stop or other joints"
            message += f" sticks where {what} holds it as well: its value is indeterminate"
        hint = (
            "give each as a torque or force: on one degree of freedom they stick as one; with a drive or stop smooth "
            "it: speed"
        )
        return SolveError(Problem("friction-indeterminate", message, hint=hint, entry_path=self.first_path))

    def jamming_error(self, outcome: int, row: int) -> SolveError:
        """Make the error of friction by a coefficient that has no solution, or two."""
        return SolveError(make_jamming_problem(self.friction.layout.mechanism, outcome, row, self.t))

    @property
    def first_path(self) -> str:
        """The path of the first of the places at rest."""
        return self.friction.names[self.leaders[0]]
