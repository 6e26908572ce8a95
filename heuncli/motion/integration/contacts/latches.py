"""Decide which latches hold at an instant of a run, and where.

    g = q - c = 0 from the catch on, both ways;   J (V+ - V-) = -g' where it catches, one more impulse equation

A latch is extended while its own condition is true and that of its release is not. Then it catches a joint that touches
its stop's limit and does not leave it, one that passes its value, or one that it is to hold wherever it is. After the
impulse, what is caught has no rate, whatever the restitution of the stop, and it stays until the release becomes true.
No second latch catches a coordinate that one latch holds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record, replace
from heuncli.motion.integration.conditions import Conditions, read_coordinates
from heuncli.motion.integration.contacts.impulses import RightSides
from heuncli.motion.integration.contacts.touching import TouchingContacts, find_gap_term_size, make_unit_load
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.model import Stop
from heuncli.multibody.tree.layout import Contact, Layout
from heuncli.results.results import Array, Mask

UNWATCHED = -1.0  # a contact that a latch holds at its limit, so that it is not watched (kernel/solutions.py)


class LatchCondition(NamedTuple):
    """What the conditions of a latch say: whether it is extended, is drawn back, and whether its value is passed."""

    is_extended: bool
    is_drawn_back: bool
    is_value_passed: bool


def evaluate_latches(
    layout: Layout, truths: Sequence[float], truths_before: Sequence[float] = ()
) -> tuple[LatchCondition, ...]:
    """Evaluate the condition of each latch from the truth of the scene's conditions (1.0), now and just before."""
    numbers = {id(condition): k for k, condition in enumerate(layout.mechanism.conditions)}
    latches = [stop.latch for stop in layout.mechanism.stops if stop.latch is not None]
    conditions = []
    for latch in latches:
        when, release, passes = (
            None if condition is None else numbers[id(condition)]
            for condition in (latch.when, latch.release, latch.passes)
        )
        conditions.append(
            LatchCondition(
                is_extended=when is None or truths[when] == 1.0,
                is_drawn_back=release is not None and truths[release] == 1.0,
                is_value_passed=passes is not None
                and len(truths_before) > 0
                and truths[passes] != truths_before[passes],
            )
        )
    return tuple(conditions)


@record
class LatchCatch:
    """A latch that catches: the number of its contact, the value of its coordinate there, and the rate before."""

    contact: int
    value: float
    rate: float


class Latches:
    """The latches of a run: which hold, and how often each has caught. Changes with every event."""

    def __init__(self, layout: Layout, end_time: float) -> None:
        """end_time: of the run [s]."""
        self.layout, self.end_time = layout, end_time
        named = {stop.name: stop for stop in layout.mechanism.stops}
        self.latch_stops: dict[int, Stop] = {i: named[layout.contacts[i].name] for i in layout.latches}
        # the coordinate of each limit and latch
        self.coordinates = {
            i: (named[c.name].joint, named[c.name].quantity) for i, c in enumerate(layout.contacts) if c.name in named
        }
        self.stops_by_name: Mapping[str, Stop] = named
        self.conditions = Conditions(layout) if layout.latches else None
        self.held_values: dict[int, float] = {}
        self.catch_counts: dict[int, int] = dict.fromkeys(self.latch_stops, 0)

    def evaluate_conditions(self, t: float, state: Array) -> tuple[LatchCondition, ...]:
        """Evaluate the conditions at a state, from its numbers alone."""
        if self.conditions is None:
            return ()
        coordinates = read_coordinates(self.layout, t, state)
        conditions = self.conditions
        return evaluate_latches(
            self.layout, [conditions.evaluate_free(k, t, 0.0, coordinates) for k in range(len(conditions.conditions))]
        )

    def make_states(self) -> Array:
        """Return the states of all contacts where only the latches that hold do so (Layout.open_contacts)."""
        contact_states, n = self.layout.open_contacts, len(self.layout.contacts)
        for i, value in self.held_values.items():
            contact_states[i], contact_states[n + self.layout.latches.index(i)] = 1.0, value
        return contact_states

    @property
    def unused_names(self) -> list[str]:
        """Names of the latches that have not caught."""
        return [stop.name for i, stop in self.latch_stops.items() if not self.catch_counts[i]]

    def release(self, latch_conditions: Sequence[LatchCondition]) -> list[str]:
        """Release the latches that are drawn back; return their names."""
        released = [
            i
            for i, condition in zip(self.latch_stops, latch_conditions, strict=True)
            if condition.is_drawn_back and i in self.held_values
        ]
        for i in released:
            del self.held_values[i]
        return [self.layout.contacts[i].name for i in released]

    def catch(
        self, latch_conditions: Sequence[LatchCondition], evaluation: Evaluation, touching: TouchingContacts
    ) -> list[LatchCatch]:
        """Catch what the extended latches can catch; evaluation: the state with all open that do not hold yet."""
        catches = []
        for (i, stop), condition in zip(self.latch_stops.items(), latch_conditions, strict=True):
            assert stop.latch is not None
            is_inactive = i in self.held_values or (self.catch_counts[i] > 0 and not stop.latch.every)
            if is_inactive or not condition.is_extended or condition.is_drawn_back or self.is_held(i):
                continue
            rate, noise = measure_coordinate_rate(self.layout, evaluation, self.layout.contacts[i], self.end_time)
            place = self.find_catch_value(i, stop, evaluation, touching, condition.is_value_passed, abs(rate) <= noise)
            if place is None:
                continue
            self.held_values[i] = place
            self.catch_counts[i] += 1
            catches.append(LatchCatch(i, place, rate if abs(rate) > noise else 0.0))
        return catches

    def is_held(self, i: int) -> bool:
        """Return whether a latch holds the coordinate of a contact."""
        return self.coordinates.get(i) in {self.coordinates[k] for k in self.held_values}

    def find_unheld_contacts(self, touching: TouchingContacts) -> Mask:
        """Return which of the touching contacts no latch holds at their limit, (k,)."""
        return np.array([not self.is_held(i) for i in touching.indices.tolist()], dtype=bool)

    def find_catch_value(
        self,
        i: int,
        stop: Stop,
        evaluation: Evaluation,
        touching: TouchingContacts,
        is_passed: bool,
        is_still: bool,
    ) -> float | None:
        """Return the value at which an extended latch catches at a state; None if it does not catch."""
        assert stop.latch is not None
        contact, latch = self.layout.contacts[i], stop.latch
        # the coordinate less the value at which an open latch would hold; the coordinate itself if it has none
        gap = float(evaluation.rows["gap"][0, contact.row])
        if latch.stop is not None:
            stop_caught = self.stops_by_name[latch.stop]
            for k, other in enumerate(self.layout.contacts[j] for j in touching.indices.tolist()):
                is_limit = not other.is_rope and other.name == latch.stop and other.sense in latch.sides
                if is_limit and touching.rate[k] <= touching.noise[k]:
                    return stop_caught.high if other.sense > 0 else stop_caught.low
            return None
        if latch.position is None:
            return gap
        near = tolerances.CONTACT_TOUCHES * find_gap_term_size(self.layout, evaluation.bodies[0], contact)
        return latch.position if is_passed or (is_still and abs(gap) <= near) else None


def measure_coordinate_rate(
    layout: Layout, evaluation: Evaluation, contact: Contact, end_time: float
) -> tuple[float, float]:
    """Return the rate of the coordinate that a latch holds, and its rounding error in a run up to `end_time`."""
    bodies = evaluation.bodies[0]
    unit_loads = make_unit_load(layout, evaluation, contact, multiplier=1.0)
    rate = float(np.sum(unit_loads[:, :3] * bodies["omega"]) + np.sum(unit_loads[:, 3:] * bodies["v"]))
    sizes = np.linalg.norm(unit_loads[:, :3], axis=1) @ np.linalg.norm(bodies["omega"], axis=1)
    sizes += np.linalg.norm(unit_loads[:, 3:], axis=1) @ np.linalg.norm(bodies["v"], axis=1)
    reach = tolerances.KERNEL["touching"] * find_gap_term_size(layout, bodies, contact)
    return rate, max(tolerances.CONTACT_RATE * float(sizes), reach / (end_time or 1.0))


def add_catches(layout: Layout, sides: RightSides, catches: Sequence[LatchCatch]) -> RightSides:
    """Add to the right sides of an impulse those of latches that catch: each brings its coordinate to rest."""
    moving_catches = [catch for catch in catches if catch.rate != 0.0]
    if not moving_catches:
        return sides
    loads, jumps = list(sides.loads), list(sides.jumps)
    for catch in moving_catches:
        jump = np.zeros(len(layout.freedoms) + len(layout.rows))
        jump[len(layout.freedoms) + layout.contacts[catch.contact].row] = -catch.rate
        loads.append(np.zeros((len(layout.place), 6)))
        jumps.append(jump)
    causes = tuple(layout.contacts[catch.contact].name for catch in moving_catches)
    return replace(sides, loads=loads, jumps=jumps, causes=(*sides.causes, *causes))


def compute_catch_work(layout: Layout, catches: Sequence[LatchCatch], multipliers: Array) -> float:
    """Return the work of the impulses of latches that catch [J], with the mean of the rates before and after.

    multipliers (n, rows): of all columns of the impulse
    """
    total = multipliers.sum(axis=0)
    return sum(0.5 * catch.rate * float(total[layout.contacts[catch.contact].row]) for catch in catches)
