"""Search for the states in which frictions stick or slip at an instant, so that the motion agrees with them.

A choice gives each group at rest a state: it sticks, or slips in one direction. The kernel solves the motion of a
choice with all its couplings. A choice is possible if its results agree with it.

    1. A friction that has just reached its limit slips, in the direction in which it was pushed.
    2. One that slipped before, too slow yet to show it, slips on unless it would turn back.
    3. Of several possible choices that one is taken in which every place sticks that sticks in any of them.
    4. Errors: no possible choice, two that differ otherwise, a sticking friction whose value others could take over.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.base.spelling import join_names
from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.contacts.complementarity import find_coupled_groups
from heuncli.motion.integration.contacts.friction_groups import FrictionGroup, FrictionPlaces, PlaceResponse
from heuncli.motion.integration.diagnosis.ambiguous_laws import make_jamming_problem
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.results.results import Array

STICKS = 0  # states of a group: it sticks, or its leader slips towards 1 or -1
MAX_ENUMERATED = 5  # groups at rest of which all 3^5 = 243 choices are tried
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


@record
class FrictionQuestion:
    """What is known where the states of friction are to be decided, of n places.

    t, state, contact_states: the instant [s], the state there, and the contact states that stops and latches have
    groups: of the places at rest
    slip (n,): signs of the others' rates
    coordinates (n,): where each would stick
    broken_loose: the group that caused the event, as it can hold no longer; None: none did
    earlier_slips: groups that slipped before and are too slow yet to show it: their number, and the sign of their slip
    response: of all places, without their loads
    """

    t: float
    state: Array
    contact_states: Array
    groups: list[FrictionGroup]
    slip: Array
    coordinates: Array
    broken_loose: int | None
    earlier_slips: dict[int, int]
    response: PlaceResponse


class StateSearch:
    """The search for the choice at an instant; used for one call of `FrictionStates.decide` (sticking.py)."""

    def __init__(self, places: FrictionPlaces, question: FrictionQuestion) -> None:
        self.places, self.t, self.state = places, question.t, question.state
        self.contact_states, response = question.contact_states, question.response
        self.groups, self.slip, self.coordinates = question.groups, question.slip, question.coordinates
        self.broken_loose, self.earlier_slips = question.broken_loose, question.earlier_slips
        self.leaders = [group.leader for group in self.groups]
        self.trials: dict[Choice, StateTrial] = {}
        self.noise, self.slack = response.noise, response.slack
        self.response = response.response[np.ix_(self.leaders, self.leaders)]
        self.pushed = self.find_push()

    def find_push(self) -> int:
        """Return how the friction that broke loose is pushed: against its value while all stick; 0: none."""
        if self.broken_loose is None:
            return 0
        places = self.places
        before = places.evaluate(self.t, self.state, self.with_choice((STICKS,) * len(self.groups)))
        value = self.groups[self.broken_loose].sum_at_leader(before.loads["value"][0, places.load_rows])
        return -1 if value > 0.0 else 1

    def with_choice(self, choice: Choice) -> Array:
        """Return the contact states of a choice."""
        sticks, coordinate_or_sign = np.zeros(len(self.slip), dtype=bool), self.slip.copy()
        for group, chosen in zip(self.groups, choice, strict=True):
            for k, transmission in zip(group.members, group.transmissions, strict=True):
                sticks[k] = chosen == STICKS
                coordinate_or_sign[k] = self.coordinates[k] if chosen == STICKS else chosen * np.sign(transmission)
        return self.places.set_states(self.contact_states, sticks, coordinate_or_sign, self.list_sticking(choice))

    def list_sticking(self, choice: Choice) -> tuple[FrictionGroup, ...]:
        """Return the groups of several places that stick in a choice."""
        pairs = zip(self.groups, choice, strict=True)
        return tuple(group for group, chosen in pairs if chosen == STICKS and len(group.members) > 1)

    def find_choice(self) -> Choice:
        """Return the choice that agrees with its own results; raise SolveError if there is none, or more
        than one.
        """
        found, everything = self.find_by_steps(), list(range(len(self.groups)))
        if found is None:
            found = self.find_among(everything, (STICKS,) * len(everything))
        elif not self.places.is_convex:
            for group in find_coupled_groups(self.response) if self.places.is_given else [everything]:
                members = [int(n) for n in group]
                if any(found[n] != STICKS and not self.goes_on_slipping(n, found) for n in members):
                    found = self.find_among(members, found)
        if self.trials[found].is_replaceable:
            raise self.indeterminate_error(found)
        return found

    def find_unproved(self, choice: Choice) -> list[str]:
        """Return the places that stick although their own feedback leaves open whether they could slip as well."""
        names: list[str] = []
        if self.places.is_given:
            return names
        for n, k in enumerate(self.leaders):
            others = [(*choice[:n], slip, *choice[n + 1 :]) for slip in (1, -1)]
            if choice[n] == STICKS and any(self.solve_trial(other).jam is not None for other in others):
                names.append(self.places.names[k])
        return names

    def find_by_steps(self) -> Choice | None:
        """Start from the states before the event and change what disagrees, until all agrees; return None if a choice
        repeats.
        """
        choice = tuple(
            self.pushed if n == self.broken_loose else self.earlier_slips.get(n, STICKS)
            for n in range(len(self.groups))
        )
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
        # rule 3 of this module
        most = max(found, key=lambda other: other.count(STICKS))
        for other in found:
            # Rule 4: two that differ otherwise are an error. Another choice contradicts this one if something sticks in
            # it that slips here, or, where it has a different slip, if static friction is kinetic (the motion then is
            # unique) or nothing sticks here.
            differs = any(x == STICKS and y != STICKS for x, y in zip(other, most, strict=True)) or (
                other != most and (self.places.has_one_size or STICKS not in most)
            )
            scale = np.abs(self.trials[most].accelerations).max(initial=0.0)
            gap = np.abs(self.trials[other].accelerations - self.trials[most].accelerations).max(initial=0.0)
            if differs and gap > tolerances.CONTACT_ACCELERATION * scale:
                raise self.undecided_error("several choices of them agree with the motions that they lead to")
        return most

    def list_choices(self, members: list[int], choice: Choice) -> Iterator[Choice]:
        """Yield all choices for some members: what broke loose slips as it is pushed, what slipped before goes on."""
        is_fixed = [n not in members or self.goes_on_slipping(n, choice) for n in range(len(choice))]
        options = [(state,) if fixed else (STICKS, 1, -1) for state, fixed in zip(choice, is_fixed, strict=True)]
        if self.broken_loose is not None:
            options[self.broken_loose] = (self.pushed,)
        return itertools.product(*options)

    def goes_on_slipping(self, n: int, choice: Choice) -> bool:
        """Return whether in a choice a group slips on as it did before, or as it is pushed."""
        return n == self.broken_loose or (n in self.earlier_slips and choice[n] == self.earlier_slips[n])

    def solve_trial(self, choice: Choice) -> StateTrial:
        """Solve the motion of a choice and compare it with that."""
        if choice not in self.trials:
            self.trials[choice] = self.compare_results(choice)
        return self.trials[choice]

    def compare_results(self, choice: Choice) -> StateTrial:
        """Compare the results of a choice with it."""
        places = self.places
        evaluation = places.evaluate(self.t, self.state, self.with_choice(choice))
        rows, loads = evaluation.rows[0][places.rows], evaluation.loads[0][places.load_rows]
        noise = self.noise + tolerances.CONTACT_ACCELERATION * rows["terms"]
        is_met = bool(evaluation.residual[0] <= evaluation.allowed_residual[0])
        next_states = list(choice)
        for n, (group, k) in enumerate(zip(self.groups, self.leaders, strict=True)):
            acceleration, reserve = float(rows["acceleration"][k]), float(loads["reserve"][k])
            value = group.sum_at_leader(loads["value"])
            if choice[n] == STICKS:
                # slack: friction that would change the acceleration by its rounding only
                allowed = tolerances.KERNEL["friction_rounding"] * (2.0 * abs(value) + abs(reserve)) + self.slack[k]
                if not (is_met and reserve >= -allowed):
                    next_states[n] = -1 if value > 0.0 else 1
            elif n == self.broken_loose:  # rule 1: it slips as it was pushed, or the other way
                if not choice[n] * acceleration >= -noise[k]:
                    next_states[n] = -choice[n]
            elif choice[n] == self.earlier_slips.get(n):  # rule 2: it slips on unless it would turn back
                if not choice[n] * acceleration >= -noise[k]:
                    next_states[n] = STICKS
            elif not choice[n] * acceleration > noise[k]:
                next_states[n] = STICKS
        jam = next(
            (
                (int(loads["friction_outcome"][k]), places.load_rows[k])
                for k in range(len(loads))
                if places.presses[k] and loads["friction_outcome"][k] != kernel.FOUND
            ),
            None,
        )
        agrees = tuple(next_states) == choice and jam is None and bool(np.isfinite(rows["acceleration"]).all())
        return StateTrial(
            agrees, tuple(next_states), rows["acceleration"].copy(), self.is_replaceable(evaluation, choice), jam
        )

    def is_replaceable(self, evaluation: Evaluation, choice: Choice) -> bool:
        """Return whether a friction that sticks depends on other constraints than those of its group."""
        if not evaluation.rows["closed"][0, self.places.rows].any():
            return False
        contact_states = evaluation.holding[0].copy()
        contact_states[self.places.indices] = 0.0
        opened = self.places.evaluate(self.t, self.state, contact_states)
        in_groups = sum(len(group.members) - 1 for group in self.list_sticking(choice))
        return int(evaluation.dependent_count[0]) != int(opened.dependent_count[0]) + in_groups

    def undecided_error(self, why: str) -> SolveError:
        """Make the error of places whose states do not follow from the laws."""
        names = join_names([self.places.names[k] for group in self.groups for k in group.members])
        message = f"at t = {self.t:.9g} s whether {names} sticks or slips cannot be decided: {why}"
        hint = "give the friction as a torque or force, in fewer joints, or smoothed: speed"
        return SolveError(Problem("friction-undecided", message, hint=hint, entry_path=self.first_path))

    def indeterminate_error(self, choice: Choice) -> SolveError:
        """Make the error of sticking frictions that share a load in a way that nothing determines."""
        pairs = zip(self.groups, choice, strict=True)
        sticking = [self.places.names[k] for group, chosen in pairs if chosen == STICKS for k in group.members]
        message = f"at t = {self.t:.9g} s {join_names(sticking)}"
        joints = self.places.layout.mechanism.joints
        held = [self.places.contacts[k].joint for group in self.groups for k in group.members]
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
        return SolveError(make_jamming_problem(self.places.layout.mechanism, outcome, row, self.t))

    @property
    def first_path(self) -> str:
        """The path of the first of the places at rest."""
        return self.places.names[self.leaders[0]]
