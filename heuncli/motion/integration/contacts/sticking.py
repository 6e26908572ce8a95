"""Decide which frictions stick from an instant on, and which slip and where to: Coulomb's law as it is.

    at rest:  rate = 0 and |value| <= what it can hold,   or   value = -slip kinetic size and slip acceleration > 0

Every choice of a state for each place at rest is a motion of its own, which the kernel solves with all its couplings:
those whose results agree with it are possible. What can stick does: of several possible ones the one is taken in which
all those stick that stick in any other. What has just reached what it can hold must slip, the way that it was pushed.
Several that differ otherwise, or none, are errors, as is a sticking friction that others could replace.

With given sizes, static ones equal to kinetic, the accelerations are those of a convex problem and unique (Moreau 1988;
Brogliato, Nonsmooth Mechanics (2016), 5.5): then the first agreeing choice is the one.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.named_tuples import NamedTuple
from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.contacts.contact_problem import make_jamming_problem
from heuncli.motion.integration.contacts.latches import find_latch_rate
from heuncli.motion.integration.contacts.restitution import find_coupled_groups
from heuncli.motion.integration.contacts.shared_impulses import join_names
from heuncli.motion.integration.contacts.touching import unit_load
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.multibody.response import solve_impulses
from heuncli.results.results import Array

STICKS = 0  # states of a place: it sticks, or slips towards 1 or -1
MAX_ENUMERATED = 5  # places at rest of which all 3^5 = 243 choices are tried
Choice = tuple[int, ...]  # a state for each place at rest


class StateTrial(NamedTuple):
    """The motion with a choice: whether its results agree with it, and what to try instead where they do not.

    replaceable: the sticking frictions could be replaced by others, so that their values are indeterminate
    jam: what the kernel found of friction by a coefficient: its outcome and row; None if it found one solution
    """

    agrees: bool
    better: Choice
    accelerations: Array
    replaceable: bool
    jam: tuple[int, int] | None


UNPROVED = (
    "{} sticks at t = {:.6g} s; that it could slip as well is not excluded, because 1 N of friction causes 1 N of "
    "further friction or more"
)


class FrictionStates:
    """The places of a run where friction may stick, and the state of each. Changes with every event.

    presses (k,): whether the joint's own load tells its size; has_one_size: static friction is kinetic everywhere
    is_given: no friction depends on a load; is_convex: so that one choice agrees at most
    sticks (k,): whether each sticks; place (k,): its coordinate then, else the sign of its slip
    """

    def __init__(self, evaluator: Evaluator, last: float) -> None:
        self.evaluator, self.layout, self.last = evaluator, evaluator.layout, last
        self.indices = list(self.layout.sticking)
        self.contacts = [self.layout.contacts[i] for i in self.indices]
        self.rows = [contact.row for contact in self.contacts]
        self.load_rows = [contact.load_row for contact in self.contacts]
        self.names = [contact.name for contact in self.contacts]
        self.sticks = np.zeros(len(self.indices), dtype=bool)
        self.place = np.zeros(len(self.indices))
        self.earlier = self.sticks, self.place  # before the event
        loads = self.layout.tables["loads"][self.load_rows]
        self.presses = loads["normal_force_kind"] != kernel.GIVEN
        self.has_one_size = bool((loads["breakaway"] == loads["coefficient"]).all())
        self.is_given = not self.layout.mechanism.joint_friction
        self.is_convex = self.is_given and self.has_one_size

    def add_to(self, holding: Array) -> Array:
        """Return contact states with those of the friction."""
        return self.set_states(holding, self.sticks, self.place)

    def set_states(self, holding: Array, sticks: Array, place: Array) -> Array:
        """Return contact states in which friction sticks at a place, or slips with its sign."""
        holding = holding.copy()
        if self.indices:
            holding[self.indices] = sticks
            holding[len(holding) - len(self.indices) :] = place
        return holding

    def begin_event(self) -> None:
        """Take the present states as those before an event."""
        self.earlier = self.sticks, self.place

    def decide(self, t: float, state: Array, holding: Array, row: int | None, is_struck: bool) -> list[str]:
        """Decide what sticks and slips from a state on; return sentences on what changes.

        holding: contact states with those that stops and latches have from here on
        row: of the contact that caused the event; is_struck: an impulse came before the state
        """
        none = np.zeros(len(self.indices))
        opened = self.evaluate(t, state, self.set_states(holding, none, none))
        slip, at_rest = np.zeros(len(self.indices)), []
        before, place = self.earlier
        broken, stuck = None, before & ~is_struck
        for k, contact in enumerate(self.contacts):
            rate, noise = find_latch_rate(self.layout, opened, contact, self.last)
            if stuck[k] or contact.row == row or abs(rate) <= noise:
                at_rest.append(k)
                broken = k if contact.row == row and stuck[k] else broken
            else:
                slip[k] = np.sign(rate)
        coordinates = np.where(stuck, place, opened.rows["gap"][0, self.rows])
        search = StateSearch(self, t, state, holding, at_rest, slip, coordinates, broken, opened)
        choice = search.find_choice() if at_rest else ()
        unproved = search.find_unproved(choice)
        sticks = np.zeros(len(self.indices), dtype=bool)
        for k, chosen in zip(at_rest, choice, strict=True):
            sticks[k], slip[k] = chosen == STICKS, chosen
        self.sticks, self.place = sticks, np.where(sticks, coordinates, slip)
        return [
            f"{name} {'sticks' if now else 'slips'} from t = {t:.6g} s"
            for name, then, now in zip(self.names, before, sticks, strict=True)
            if now != then
        ] + [UNPROVED.format(name, t) for name in unproved]

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
    return np.asarray(opened.rows["gap"][0, [layout.contacts[i].row for i in layout.sticking]])


class StateSearch:
    """The search for the choice at an instant; used for one call of `FrictionStates.decide`.

    at_rest: places without a rate; slip (n,): signs of the others' rates; coordinates (n,): where each would stick
    broken: the place that has reached what it can hold; None: none has
    opened: the results with all of them open and without their loads
    """

    def __init__(
        self,
        friction: FrictionStates,
        t: float,
        state: Array,
        holding: Array,
        at_rest: list[int],
        slip: Array,
        coordinates: Array,
        broken: int | None,
        opened: Evaluation,
    ) -> None:
        self.friction, self.t, self.state, self.holding = friction, t, state, holding
        self.at_rest, self.slip, self.coordinates = at_rest, slip, coordinates
        self.broken = None if broken is None else at_rest.index(broken)
        self.trials: dict[Choice, StateTrial] = {}
        self.noise = self.find_noise(opened)
        self.pushed = self.find_push()

    def find_noise(self, opened: Evaluation) -> Array:
        """Return the rounding of the accelerations (n,) of the places, from those of all loads and weights."""
        layout = self.friction.layout
        units = np.array([unit_load(layout, opened, contact, 1.0) for contact in self.friction.contacts])
        jumps = np.zeros((len(units), len(layout.freedoms) + len(layout.rows)))
        none = np.zeros(len(self.slip))
        self.friction.evaluator.workspace.hold(
            layout.closed_contacts(self.friction.set_states(self.holding, none, none))
        )
        columns = solve_impulses(self.friction.evaluator.workspace, self.t, self.state, units, jumps).columns.bodies
        motion = np.concatenate([columns["alpha"], columns["a"]], axis=2)
        response = np.einsum("kbi,cbi->kc", units, motion)
        self.response = 0.5 * (response + response.T)[np.ix_(self.at_rest, self.at_rest)]
        weights = float(layout.bodies["mass"].sum() * np.abs(layout.mechanism.gravity).sum())
        loads = np.abs(opened.loads["force"][0]).sum() + np.abs(opened.loads["moment"][0]).sum() / layout.size
        closures = layout.tables["closures"][self.friction.rows]
        own = np.abs(np.diag(response))
        effect = own * closures["weight"] * (weights + float(loads))
        noise = np.asarray(tolerances.CONTACT_ACCELERATION * (opened.rows["terms"][0, self.friction.rows] + effect))
        self.slack = 2.0 * noise / np.where(own > 0.0, own, np.inf)
        return noise

    def find_push(self) -> int:
        """Return the way in which the broken friction is pushed: against its value while all stick; 0: none is."""
        if self.broken is None:
            return 0
        friction = self.friction
        before = friction.evaluate(self.t, self.state, self.with_choice((STICKS,) * len(self.at_rest)))
        value = float(before.loads["value"][0, friction.load_rows[self.at_rest[self.broken]]])
        return -1 if value > 0.0 else 1

    def with_choice(self, choice: Choice) -> Array:
        """Return the contact states of a choice."""
        sticks, place = np.zeros(len(self.slip), dtype=bool), self.slip.copy()
        for k, chosen in zip(self.at_rest, choice, strict=True):
            sticks[k] = chosen == STICKS
            place[k] = self.coordinates[k] if chosen == STICKS else chosen
        return self.friction.set_states(self.holding, sticks, place)

    def find_choice(self) -> Choice:
        """Return the choice that agrees with its own results; raise SolveError if that is not one."""
        found, everything = self.find_by_steps(), list(range(len(self.at_rest)))
        if found is None:
            found = self.find_among(everything, (STICKS,) * len(everything))
        elif not self.friction.is_convex:
            for group in find_coupled_groups(self.response) if self.friction.is_given else [everything]:
                members = [int(n) for n in group]
                if any(found[n] != STICKS and n != self.broken for n in members):
                    found = self.find_among(members, found)
        if self.trials[found].replaceable:
            raise self.indeterminate_error(found)
        return found

    def find_unproved(self, choice: Choice) -> list[str]:
        """Return the places that stick although their own feedback leaves open whether they could slip as well."""
        names: list[str] = []
        if self.friction.is_given:
            return names
        for n, k in enumerate(self.at_rest):
            others = [(*choice[:n], slip, *choice[n + 1 :]) for slip in (1, -1)]
            if choice[n] == STICKS and any(self.solve_trial(other).jam is not None for other in others):
                names.append(self.friction.names[k])
        return names

    def find_by_steps(self) -> Choice | None:
        """Return an agreeing choice, from all that stick on, by changing what does not agree; None if that repeats."""
        choice = tuple(self.pushed if k == self.broken else STICKS for k in range(len(self.at_rest)))
        while choice not in self.trials:
            trial = self.solve_trial(choice)
            if trial.agrees:
                return choice
            choice = trial.better
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
            differs = any(x == STICKS != y for x, y in zip(other, most, strict=True)) or (
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
            self.trials[choice] = self.compare(choice)
        return self.trials[choice]

    def compare(self, choice: Choice) -> StateTrial:
        """Compare the results of a choice with it."""
        friction = self.friction
        evaluation = friction.evaluate(self.t, self.state, self.with_choice(choice))
        rows, loads = evaluation.rows[0][friction.rows], evaluation.loads[0][friction.load_rows]
        noise = self.noise + tolerances.CONTACT_ACCELERATION * rows["terms"]
        is_met = bool(evaluation.residual[0] <= evaluation.allowed_residual[0])
        better = list(choice)
        for n, k in enumerate(self.at_rest):
            acceleration, value, reserve = (
                float(x[k]) for x in (rows["acceleration"], loads["value"], loads["reserve"])
            )
            if choice[n] == STICKS:
                # what more would only accelerate by rounding
                allowed = tolerances.KERNEL["friction_rounding"] * (2.0 * abs(value) + abs(reserve)) + self.slack[k]
                if not (is_met and reserve >= -allowed):
                    better[n] = -1 if value > 0.0 else 1
            elif n == self.broken:
                if not choice[n] * acceleration >= -noise[k]:
                    better[n] = -choice[n]
            elif not choice[n] * acceleration > noise[k]:
                better[n] = STICKS
        jam = next(
            (
                (int(loads["span"][k]), friction.load_rows[k])
                for k in range(len(loads))
                if friction.presses[k] and loads["span"][k] != kernel.FOUND
            ),
            None,
        )
        agrees = tuple(better) == choice and jam is None and bool(np.isfinite(rows["acceleration"]).all())
        return StateTrial(agrees, tuple(better), rows["acceleration"].copy(), self.is_replaceable(evaluation), jam)

    def is_replaceable(self, evaluation: Evaluation) -> bool:
        """Whether a friction that sticks depends on other constraints."""
        if not evaluation.rows["closed"][0, self.friction.rows].any():
            return False
        holding = evaluation.holding[0].copy()
        holding[self.friction.indices] = 0.0
        opened = self.friction.evaluate(self.t, self.state, holding)
        return int(evaluation.dependent_count[0]) > int(opened.dependent_count[0])

    def undecided_error(self, why: str) -> SolveError:
        """Make the error of places whose states do not follow from the laws."""
        names = join_names([self.friction.names[k] for k in self.at_rest])
        message = f"at t = {self.t:.9g} s whether {names} sticks or slips cannot be decided: {why}"
        hint = "give the friction as a torque or force, in fewer joints, or smoothed: speed"
        return SolveError(Problem("friction-undecided", message, hint=hint, entry_path=self.first_path))

    def indeterminate_error(self, choice: Choice) -> SolveError:
        """Make the error of sticking frictions that share a load in a way that nothing determines."""
        sticking = [self.friction.names[k] for k, chosen in zip(self.at_rest, choice, strict=True) if chosen == STICKS]
        message = f"at t = {self.t:.9g} s {join_names(sticking)}"
        if len(sticking) > 1:
            message += " stick, and how they share what holds the machine is indeterminate"
        else:
            message += " sticks where a drive, a stop or other joints hold it as well: its value is indeterminate"
        hint = (
            "let friction stick in as many joints as can move independently, without a drive; smooth the others: speed"
        )
        return SolveError(Problem("friction-indeterminate", message, hint=hint, entry_path=self.first_path))

    def jamming_error(self, outcome: int, row: int) -> SolveError:
        """Make the error of friction by a coefficient that has no solution, or two."""
        return SolveError(make_jamming_problem(self.friction.layout.mechanism, outcome, row, self.t))

    @property
    def first_path(self) -> str:
        """The path of the first of the places at rest."""
        return self.friction.names[self.at_rest[0]]
