"""Events of contacts: what is struck at an instant of a run, by which impulses, and what is held from there on.

touching.py finds the contacts that touch, latches.py what catches and lets go, restitution.py the impulses, resting.py
the contacts that stay closed.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record, replace
from heuncli.motion.integration.contacts.blows import (
    BlowResult,
    GivenBlow,
    Jump,
    RightSides,
    jump_of,
    met_freely,
    right_sides,
    state_behind,
)
from heuncli.motion.integration.contacts.latches import UNWATCHED, Bolts, Catch, Latches, with_catches, work_of_catches
from heuncli.motion.integration.contacts.resting import rests, short_flights, undecided_by_friction
from heuncli.motion.integration.contacts.restitution import Struck, feeling, strikes, undecided
from heuncli.motion.integration.contacts.sequential_impacts import EndlessImpacts, endless_impacts, independent
from heuncli.motion.integration.contacts.shared_impulses import (
    LoadedContact,
    SharedImpulse,
    find_shared_impulses,
    held_contacts,
    listed,
    loaded,
)
from heuncli.motion.integration.contacts.touching import Touching, answerable, answers, touching
from heuncli.motion.integration.evaluator import Evaluator, Recovered
from heuncli.multibody.response import Blows as Answered
from heuncli.multibody.response import Columns, blows
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.file_format.models import SIMULTANEOUS

AT_ONCE = 16  # events at one instant, and four a contact: more follow each other without end


@record
class Pressed:
    """The touching contacts, and what they answer.

    A (k, k): the rates of opening that unit impulses make (restitution.py); moves (k,): whether one that bears moves
    anything; rates (k,): those of opening that given impulses and drives add.
    """

    touch: Touching
    A: Array
    moves: Mask
    rates: Array


@record
class ContactOutcome:
    """The impulses, which contacts are held, which rest because they would never be seen to leave; the state behind.

    columns: of what is given, and of the touching contacts by their impulses; work: of all [J].
    """

    struck: Struck
    holding: Array
    at_rest: Mask
    columns: Columns
    after: Array
    work: float


def held_at(evaluator: Evaluator, t: float, state: Array) -> Array:
    """The contacts that are closed at a state, behind the blow that it may be."""
    contacts = Contacts(evaluator, t)
    contacts.meet(GivenBlow(t, t, (), {}), state, t, None)
    return contacts.holding


def require_energy(jump: Jump, terms: float) -> None:
    """Raise SolveError where the energies before and behind a blow and the work of its impulses do not add up.

    terms: what the impulses would bring alone, which joints and others may take back.
    """
    before, after = jump.kinetic
    size = max(before, after, abs(jump.work), tolerances.UNBALANCED * terms)
    if not abs(after - before - jump.work) <= tolerances.UNBALANCED * size:
        message = f"at t = {jump.time:.9g} s the energies of the blow on {', '.join(jump.names)} do not add up"
        raise SolveError(
            Problem("blow-unbalanced", message, None, "a singular pose, or contacts that hardly differ", jump.names[0])
        )


def require_smooth(layout: Layout, given: GivenBlow, closed: Mask) -> None:
    """Raise SolveError for a rope that may go slack, and is taut where the rate of its length jumps."""
    for k, contact in enumerate(layout.contacts):
        if closed[k] and contact.is_rope and contact.joint in given.drives:
            first, then = given.drives[contact.joint]
            message = (
                f"at t = {given.after:.9g} s the rate of the length of {contact.name} jumps from {first:.6g} to "
                f"{then:.6g} m/s while it is taut: as it may go slack, how it leaves that jump is not solved"
            )
            hint = (
                "lead the rate over in a short time, as max(t - 0.2, 0)**2; or leave out restitution: it holds through"
            )
            raise SolveError(Problem("rope-jerked", message, None, hint, layout.mechanism.owner(contact.joint)))


def require_caught(evaluator: Evaluator, sides: RightSides, found: Answered, catches: list[Catch], t: float) -> None:
    """Raise SolveError for latches that catch what cannot come to rest: drives and joints prescribe its rate."""
    may_stay = float(evaluator.may_stay(sides.still.gap)[0])
    own = [catch for catch in catches if catch.rate != 0.0]
    first = len(sides.loads) - len(own)
    for k, catch in enumerate(own):
        if not found.unmet[first + k] <= may_stay:
            contact = evaluator.layout.contacts[catch.contact]
            joint = evaluator.layout.mechanism.joints[contact.joint].name
            message = (
                f"at t = {t:.9g} s {contact.name} catches the joint {joint}, which drives or other latches move on"
            )
            hint = "let the drive stand still there, release the other latch before, or catch later: when"
            raise SolveError(Problem("latch-contradicts", message, None, hint, f"latches.{contact.name}"))


@record
class Unrefined:
    """Impulses as the contacts' problem gives them, and the columns of unit impulses.

    basis: the contacts that bear and are solved for by their rates; others: those of a sequence whose impulses stay,
    for their rates follow from those of the basis.
    """

    touch: Touching
    struck: Struck
    units: Columns
    basis: Indices
    others: Indices


class Contacts:
    """The contacts of one run: which are closed, and what is to be told of them. Changes with every instant met."""

    def __init__(self, evaluator: Evaluator, last: float) -> None:
        self.evaluator, self.last = evaluator, last
        self.layout = evaluator.layout
        self.holding = self.layout.all_open
        self.latches = Latches(self.layout, last)
        self.strikes: dict[str, int] = {}
        self.notes: dict[str, None] = {}
        self.since, self.at_once = -1.0, 0

    def count(self, t: float) -> None:
        """An event at an instant. Raises SolveError for too many at one."""
        near = tolerances.KERNEL["least_step"] * self.last
        self.at_once = self.at_once + 1 if t - self.since <= near else 0
        self.since = t
        if self.at_once > AT_ONCE + 4 * len(self.layout.contacts):
            raise undecided(t, max(self.strikes, key=lambda name: self.strikes[name], default=""))

    def meet(
        self, given: GivenBlow, state: Array, time: float, row: int | None, said: Bolts | None = None
    ) -> Jump | None:
        """The blow at an instant, where there is one.

        row: of the contact that closed or opened there; said: what the conditions of latches say there, by the state's
        own numbers where it is not told.
        """
        latches, closed = self.latches, self.holding > 0.0
        require_smooth(self.layout, given, closed)
        said = said or latches.freely(given.before, state)
        released = latches.let_go(said)
        sides = right_sides(self.evaluator, given, state, latches.holding())
        touch = touching(self.layout, sides.still, closed, row, self.last)
        catches = latches.catch(said, sides.still, touch)
        free = latches.free_of(touch)
        unwatched, touch = touch.which[~free], touch.some(free)
        sides = with_catches(self.layout, sides, catches)
        found, pressed = self.pose(given, sides, touch)
        require_caught(self.evaluator, sides, found, catches, given.before)
        outcome = self.solve(given, sides, found.columns, pressed, catches)
        self.holding = latches.holding()
        self.holding[touch.which] = outcome.holding
        self.holding[unwatched] = UNWATCHED
        shared = self.shared(pressed, outcome, catches)
        self.tell(time, touch, outcome, shared)
        self.tell_latches(time, released, catches)
        bears, n = np.flatnonzero(outcome.struck.impulses), len(sides.loads)
        if not len(bears) and not n:
            return None
        causes = (*sides.causes, *(self.layout.contacts[i].name for i in touch.which[bears]))
        shown = np.array([*range(n), *(n + bears)], dtype=int)
        found = Answered(outcome.columns.at(shown), found.unmet[shown], found.idle)
        sides = replace(sides, still=self.shown(sides.still, pressed, outcome.struck))
        struck = tuple(self.layout.contacts[i].name for i in touch.which[outcome.struck.closed])
        struck += tuple(self.layout.contacts[catch.contact].name for catch in catches if catch.rate != 0.0)
        blow = BlowResult(time, found, causes, outcome.after, outcome.work, self.holding.copy(), struck, shared)
        jump = jump_of(self.evaluator, given, sides, blow)
        terms = 0.5 * float(outcome.struck.impulses**2 @ np.diag(pressed.A)) + met_freely(self.layout, sides.impulses)
        require_energy(jump, terms)
        return jump

    def pose(self, given: GivenBlow, sides: RightSides, touch: Touching) -> tuple[Answered, Pressed]:
        """The columns of what is given and of each contact that touches, and the problem they make."""
        self.evaluator.workspace.hold(self.latches.holding())
        n, n_u = len(sides.loads), len(self.layout.freedoms) + len(self.layout.rows)
        loads = np.array([*sides.loads, *touch.loads]).reshape(-1, len(self.layout.place), 6)
        jumps = np.array([*sides.jumps, *([np.zeros(n_u)] * len(touch.which))]).reshape(-1, n_u)
        found = blows(self.evaluator.workspace, given.before, sides.still.states[0], loads, jumps)
        rates = answers(touch, found.columns.bodies)
        A = 0.5 * (rates[:, n:] + rates[:, n:].T)
        return found, Pressed(touch, A, answerable(self.layout, touch, A), rates[:, :n].sum(axis=1))

    def solve(
        self, given: GivenBlow, sides: RightSides, units: Columns, pressed: Pressed, catches: list[Catch]
    ) -> ContactOutcome:
        """Impulses, then who rests; a rebound too short to be seen is none."""
        touch, open_ = pressed.touch, self.latches.holding()
        at_rest = np.zeros(len(touch.which), dtype=bool)
        while True:
            struck = self.strike(given.after, pressed, at_rest)
            columns = self.scaled(units, touch, struck.impulses)
            after, work = state_behind(self.layout, given, sides, columns)
            then = self.evaluator.recovered(np.array([given.after]), after[None, :], holding=open_)
            holding, acceleration = rests(touch, pressed.A, pressed.moves, struck.rate, then, self.layout)
            instant = tolerances.SHORTEST_FLIGHT * self.last
            short = short_flights(touch, struck.rate, acceleration, instant) & ~at_rest & pressed.moves
            if not short.any():
                break
            at_rest = at_rest | short
        if self.layout.mechanism.rubbing:
            self.require_decided(given.after, after, pressed, holding, struck.rate)
        if struck.impulses.any():
            bears = np.flatnonzero(struck.impulses)
            own = np.arange(len(bears))
            if self.layout.mechanism.impacts != SIMULTANEOUS:
                own = independent(pressed.A[np.ix_(bears, bears)])
            unrefined = Unrefined(touch, struck, units, bears[own], np.delete(bears, own))
            struck, columns, whole = self.refined(given, sides, unrefined)
            after, work = state_behind(self.layout, given, sides, whole)
        work += float(struck.impulses @ (0.5 * (touch.rate + struck.rate)))
        work += work_of_catches(self.layout, catches, columns.multipliers)
        self.bring_to_rest(sides.still.states[0], after)
        return ContactOutcome(struck, holding, at_rest, columns, after, work)

    def strike(self, t: float, pressed: Pressed, at_rest: Mask) -> Struck:
        """The impulses of the contacts; at_rest: those that stay. Raises SolveError for impacts without an end."""
        touch = pressed.touch
        try:
            return strikes(touch, pressed.A, pressed.moves, pressed.rates, at_rest, self.layout.mechanism.impacts)
        except EndlessImpacts as endless:
            own = [self.layout.contacts[i].name for i in touch.which.tolist()]
            raise endless_impacts(t, [own[k] for k in endless.own.tolist()], own[endless.most]) from None

    def shared(self, pressed: Pressed, outcome: ContactOutcome, catches: list[Catch]) -> tuple[SharedImpulse, ...]:
        """The contacts of which a model says how they share the blow: those that bear, latches that catch, others."""
        struck, which = outcome.struck, pressed.touch.which
        own, n = np.flatnonzero(struck.closed), len(outcome.columns.multipliers) - len(which)
        contacts = [
            LoadedContact(
                contact.name, contact.row, n + int(k), impacts=int(struck.count[k]), settled=bool(struck.settled[k])
            )
            for k, contact in ((k, self.layout.contacts[which[k]]) for k in own)
        ]
        caught = [self.layout.contacts[catch.contact] for catch in catches if catch.rate != 0.0]
        first = n - len(caught)
        contacts += [
            LoadedContact(contact.name, contact.row, first + k, is_held=True) for k, contact in enumerate(caught)
        ]
        contacts += loaded(held_contacts(self.layout), outcome.columns.multipliers)
        felt = np.zeros((len(contacts), len(contacts)), dtype=bool)
        for group in feeling(pressed.A):  # also over contacts that bear nothing, which is a matter of the model, too
            members = np.isin(own, group)
            felt[: len(own), : len(own)] |= members[:, None] & members
        return tuple(find_shared_impulses(contacts, felt, outcome.columns.multipliers))

    def require_decided(self, t: float, after: Array, pressed: Pressed, holding: Array, rate: Array) -> None:
        """Raise SolveError where friction by what joints carry makes other contacts bear than those that are held."""
        touch, held = pressed.touch, self.latches.holding()
        held[touch.which] = holding
        at = self.evaluator.recovered(np.array([t]), after[None, :], holding=held)
        wrong = undecided_by_friction(touch, pressed.A, holding, rate, at, self.layout)
        if wrong.any():
            names = ", ".join(self.layout.contacts[i].name for i in touch.which[wrong])
            message = (
                f"at t = {t:.9g} s friction by what joints carry decides whether {names} bears, and changes as it does"
            )
            hint = "friction of a given size, or contacts that are not touched there together"
            raise SolveError(Problem("friction-not-unique", message, hint=hint))

    def refined(self, given: GivenBlow, sides: RightSides, found: Unrefined) -> tuple[Struck, Columns, Columns]:
        """The impulses and columns, and all in one, with the digits that A loses between very unequal masses.

        With the rates behind known, what bears is held and answered by the factors of the closures, in one column; what
        the columns of the contacts lack of it goes to the last of them.
        """
        touch, struck, n = found.touch, found.struck, len(sides.loads)
        own, others = found.basis, found.others
        contacts = [self.layout.contacts[i] for i in touch.which[own].tolist()]
        rows, sense = [c.row for c in contacts], np.array([c.sense for c in contacts])
        load = np.sum([np.zeros((len(self.layout.place), 6)), *sides.loads], axis=0)
        load = load + np.einsum("k,kbi->bi", struck.impulses[others], touch.loads[others])
        jump = np.sum([np.zeros(len(self.layout.freedoms) + len(self.layout.rows)), *sides.jumps], axis=0)
        jump[len(self.layout.freedoms) + np.array(rows)] -= sense * (struck.rate - touch.rate)[own]
        holding = self.latches.holding()
        holding[touch.which[own]] = 1.0
        self.evaluator.workspace.hold(holding)
        whole = blows(self.evaluator.workspace, given.before, sides.still.states[0], load[None], jump[None]).columns
        impulses = struck.impulses.copy()
        impulses[own] = -sense * whole.multipliers[0, rows]
        columns = self.scaled(found.units, touch, impulses)
        for k in others.tolist():  # which the one column has as given loads
            contact = self.layout.contacts[touch.which[k]]
            whole.multipliers[0, contact.row] -= contact.sense * impulses[k]
        total, last = columns.sum(), n + int(own[-1])
        for part in ("bodies", "freedoms"):
            table, right, summed = (getattr(x, part) for x in (columns, whole, total))
            for name in table.dtype.names or ():
                table[name][last] += right[name][0] - summed[name]
        columns.multipliers[last] += whole.multipliers[0] - total.multipliers
        return replace(struck, impulses=impulses), columns, whole

    def bring_to_rest(self, before: Array, after: Array) -> None:
        """Rates behind a blow that are rounding of those before are none, in place: what stands still has no motion."""
        for group in self.layout.tables["groups"]:
            rates = slice(group["rates"], group["end"])
            if group["rates"] < group["end"] and group["coordinates"] < group["rates"]:
                largest = np.abs(before[rates] * self.layout.weights[rates]).max()
                if np.abs(after[rates] * self.layout.weights[rates]).max() <= tolerances.SUM_ROUNDING * largest:
                    after[rates] = 0.0

    def scaled(self, units: Columns, touch: Touching, impulses: Array) -> Columns:
        """The columns of what is given, and those of the contacts by their impulses, each with its own multiplier."""
        n = len(units.multipliers) - len(impulses)
        factors = np.concatenate([np.ones(n), impulses])

        def by(table: Table) -> Table:
            out = table.copy()
            for name in table.dtype.names or ():
                out[name] = table[name] * factors.reshape(-1, *([1] * (table[name].ndim - 1)))
            return out

        multipliers = units.multipliers * factors[:, None]
        for k, i in enumerate(touch.which.tolist()):
            contact = self.layout.contacts[i]
            multipliers[n + k, contact.row] -= contact.sense * impulses[k]
        return Columns(by(units.bodies), by(units.freedoms), multipliers)

    def shown(self, still: Recovered, pressed: Pressed, struck: Struck) -> Recovered:
        """The answers before the blow, with the contacts that take part in it: what they leave open is then seen.

        A sequence determines the impulses of contacts that others could replace; these leave nothing open.
        """
        touch, rows, closed = pressed.touch, still.rows.copy(), self.latches.holding()
        own = struck.closed
        if self.layout.mechanism.impacts != SIMULTANEOUS:
            bears = np.flatnonzero(struck.impulses)
            own = struck.depends.copy()
            own[bears[independent(pressed.A[np.ix_(bears, bears)])]] = True
        closed[touch.which] = own
        if np.array_equal(self.layout.closed(closed), still.holding[0]):
            return still
        chosen = self.evaluator.recovered(still.times, still.states, holding=closed).rows
        for name in ("chosen", "closed"):
            rows[name] = chosen[name]
        return replace(still, rows=rows)

    def tell(self, t: float, touch: Touching, outcome: ContactOutcome, shared: tuple[SharedImpulse, ...]) -> None:
        """Put down what is worth a sentence."""
        own = [self.layout.contacts[i] for i in touch.which.tolist()]
        struck = [own[k] for k in np.flatnonzero(outcome.struck.closed & (touch.rate < 0.0))]
        for contact in struck:
            self.strikes[contact.name] = self.strikes.get(contact.name, 0) + 1
        at = f"at t = {t:.6g} s"
        if len(struck) > 1 and not shared:
            names = listed([contact.name for contact in struck])
            self.notes[f"{at} {names} are struck at once, and do not load each other"] = None
        for k in np.flatnonzero(outcome.at_rest):
            name = own[k].name
            count = self.strikes.get(name, 0)
            if not count:
                continue
            self.notes[f"{name} rests {at}, after {count} strikes: further ones are too small to be seen"] = None

    def tell_latches(self, t: float, released: list[str], catches: list[Catch]) -> None:
        """Put down what latches catch, and what they let go."""
        for name in released:
            self.notes[f"{name} lets go at t = {t:.6g} s"] = None
        for catch in catches:
            self.notes[f"{self.layout.contacts[catch.contact].name} catches at t = {t:.6g} s"] = None
