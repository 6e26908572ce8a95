"""Latches: which of them hold at an instant of a run, and where.

    g = q - c = 0 from the catch on, both ways;   J (V+ - V-) = -g' where it catches, one more row of a blow's equations
A latch is out while its own condition is true and that of its release is not. Out, it catches what touches its stop's
limit and does not leave it, what comes through its value, or what it is to hold wherever that is. What is caught has no
rate behind the blow, whatever the restitution of the stop, and stays until the release becomes true. A coordinate that
one latch holds no other one catches.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.motion.integration.conditions import Conditions, coordinates_in
from heuncli.motion.integration.contacts.blows import RightSides
from heuncli.motion.integration.contacts.touching import Touching, terms_of_gap, unit_load
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.mechanism.model import Stop
from heuncli.multibody.tree.layout import Contact, Layout
from heuncli.results.results import Array, Mask

UNWATCHED = -1.0  # of a contact: a latch holds it at its limit, and it is not looked at (kernel/answers.py)


class Bolts(NamedTuple):
    """What the conditions say of each latch: whether it is out, is drawn back, and whether its value is passed."""

    out: tuple[bool, ...]
    back: tuple[bool, ...]
    passed: tuple[bool, ...]


def bolts(layout: Layout, truths: Sequence[float], before: Sequence[float] = ()) -> Bolts:
    """By whether the scene's conditions are true (1.0), and were just before."""
    number = {id(condition): k for k, condition in enumerate(layout.mechanism.conditions)}
    latches = [stop.latch for stop in layout.mechanism.stops if stop.latch is not None]
    when = [None if latch.when is None else number[id(latch.when)] for latch in latches]
    release = [None if latch.release is None else number[id(latch.release)] for latch in latches]
    passes = [None if latch.passes is None else number[id(latch.passes)] for latch in latches]
    return Bolts(
        tuple(k is None or truths[k] == 1.0 for k in when),
        tuple(k is not None and truths[k] == 1.0 for k in release),
        tuple(k is not None and len(before) > 0 and truths[k] != before[k] for k in passes),
    )


@record
class Catch:
    """A latch that catches: of the contacts, at which place of its coordinate, and at which rate that came."""

    contact: int
    at: float
    rate: float


class Latches:
    """The latches of a run: which hold, and how often each has caught. Changes with every instant met."""

    def __init__(self, layout: Layout, last: float) -> None:
        """last: the end of the run [s]."""
        self.layout, self.last = layout, last
        named = {stop.name: stop for stop in layout.mechanism.stops}
        self.stops: dict[int, Stop] = {i: named[layout.contacts[i].name] for i in layout.latches}
        # of the other limits and latches the coordinate that each holds
        self.coordinates = {
            i: (named[c.name].joint, named[c.name].quantity) for i, c in enumerate(layout.contacts) if c.name in named
        }
        self.limits: Mapping[str, Stop] = named
        self.conditions = Conditions(layout) if layout.latches else None
        self.holds: dict[int, float] = {}
        self.caught: dict[int, int] = dict.fromkeys(self.stops, 0)

    def freely(self, t: float, state: Array) -> Bolts:
        """What the conditions say at a state, by its numbers alone."""
        if self.conditions is None:
            return Bolts((), (), ())
        there = coordinates_in(self.layout, t, state)
        own = self.conditions
        return bolts(self.layout, [own.free(k, t, 0.0, there) for k in range(len(own.conditions))])

    def holding(self) -> Array:
        """What is told of the contacts where the latches that hold do so, and no others (Layout.all_open)."""
        found, n = self.layout.all_open, len(self.layout.contacts)
        for i, at in self.holds.items():
            found[i], found[n + self.layout.latches.index(i)] = 1.0, at
        return found

    @property
    def idle(self) -> list[str]:
        """Those that have not caught."""
        return [stop.name for i, stop in self.stops.items() if not self.caught[i]]

    def let_go(self, said: Bolts) -> list[str]:
        """Let those go that are drawn back; their names."""
        gone = [i for i, back in zip(self.stops, said.back, strict=True) if back and i in self.holds]
        for i in gone:
            del self.holds[i]
        return [self.layout.contacts[i].name for i in gone]

    def catch(self, said: Bolts, at: Recovered, touch: Touching) -> list[Catch]:
        """Catch what those come to that are out; at: the state, with all open that do not hold yet."""
        found = []
        for n, (i, stop) in enumerate(self.stops.items()):
            assert stop.latch is not None
            idle = i in self.holds or (self.caught[i] > 0 and not stop.latch.every)
            if idle or not said.out[n] or said.back[n] or self.is_held(i):
                continue
            rate, noise = motion_along(self.layout, at, self.layout.contacts[i], self.last)
            place = self.place(i, stop, at, touch, said.passed[n], abs(rate) <= noise)
            if place is None:
                continue
            self.holds[i] = place
            self.caught[i] += 1
            found.append(Catch(i, place, rate if abs(rate) > noise else 0.0))
        return found

    def is_held(self, i: int) -> bool:
        """Whether a latch holds the coordinate of a contact."""
        return self.coordinates.get(i) in {self.coordinates[k] for k in self.holds}

    def free_of(self, touch: Touching) -> Mask:
        """Which of the touching contacts no latch holds at their limit, (k,)."""
        return np.array([not self.is_held(i) for i in touch.which.tolist()], dtype=bool)

    def place(self, i: int, stop: Stop, at: Recovered, touch: Touching, passed: bool, still: bool) -> float | None:
        """Where a latch that is out catches at a state; None where it does not."""
        assert stop.latch is not None
        contact, latch = self.layout.contacts[i], stop.latch
        gap = float(at.rows["gap"][0, contact.row])  # of one that is open from its value, or from zero
        if latch.stop is not None:
            limits = self.limits[latch.stop]
            for k, other in enumerate(self.layout.contacts[j] for j in touch.which.tolist()):
                meant = not other.is_rope and other.name == latch.stop and other.sense in latch.sides
                if meant and touch.rate[k] <= touch.noise[k]:
                    return limits.high if other.sense > 0 else limits.low
            return None
        if latch.at is None:
            return gap
        near = tolerances.CONTACT_TOUCHES * terms_of_gap(self.layout, at.bodies[0], contact)
        return latch.at if passed or (still and abs(gap) <= near) else None


def motion_along(layout: Layout, at: Recovered, contact: Contact, last: float) -> tuple[float, float]:
    """The rate of the coordinate that a latch holds, and what rounding makes of it in a run up to `last`."""
    bodies = at.bodies[0]
    load = unit_load(layout, at, contact, way=1.0)
    rate = float(np.sum(load[:, :3] * bodies["omega"]) + np.sum(load[:, 3:] * bodies["v"]))
    sizes = np.linalg.norm(load[:, :3], axis=1) @ np.linalg.norm(bodies["omega"], axis=1)
    sizes += np.linalg.norm(load[:, 3:], axis=1) @ np.linalg.norm(bodies["v"], axis=1)
    reach = tolerances.KERNEL["touching"] * terms_of_gap(layout, bodies, contact)
    return rate, max(tolerances.CONTACT_RATE * float(sizes), reach / (last or 1.0))


def with_catches(layout: Layout, sides: RightSides, catches: Sequence[Catch]) -> RightSides:
    """The right sides of a blow with those of latches that catch: each brings its coordinate to rest."""
    own = [catch for catch in catches if catch.rate != 0.0]
    if not own:
        return sides
    loads, jumps = list(sides.loads), list(sides.jumps)
    for catch in own:
        jump = np.zeros(len(layout.freedoms) + len(layout.rows))
        jump[len(layout.freedoms) + layout.contacts[catch.contact].row] = -catch.rate
        loads.append(np.zeros((len(layout.place), 6)))
        jumps.append(jump)
    causes = tuple(layout.contacts[catch.contact].name for catch in own)
    return replace(sides, loads=loads, jumps=jumps, causes=(*sides.causes, *causes))


def work_of_catches(layout: Layout, catches: Sequence[Catch], multipliers: Array) -> float:
    """Work of the impulses of latches that catch [J], by the mean of the rates before and behind.

    multipliers (n, rows): of all columns of the blow.
    """
    whole = multipliers.sum(axis=0)
    return sum(0.5 * catch.rate * float(whole[layout.contacts[catch.contact].row]) for catch in catches)
