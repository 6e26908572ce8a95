"""Find the impulses and latches that conditions trigger at the instant that a run has reached.

The kernel ends a step where a branch of a condition changes, and stops there and where a piece begins. A condition that
was false and is true with the present branches became true. A piece takes its branches from its first state. Rounding
of that state may put a margin that was just passed on either side; a branch that is uncertain by rounding keeps its
value. If it goes the other way, the kernel changes it at once.
"""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.named_tuples import NamedTuple
from heuncli.motion.integration.conditions import Conditions, Coordinates, read_coordinates
from heuncli.motion.integration.contacts.latches import LatchCondition, evaluate_latches
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

MAX_SIMULTANEOUS = 4  # impulses of a condition at one instant; more count as endless


class DueTriggers(NamedTuple):
    """The impulses that are due at an instant, and the values of the latches' conditions there."""

    blows: tuple[int, ...]
    latch_conditions: tuple[LatchCondition, ...] | None


class Triggers:
    """The impulses and latches of a scene that depend on conditions. Remembers what was true, and which were applied.

    layout: of the integrated scene
    last: the end of the run [s]
    """

    def __init__(self, layout: Layout, last: float) -> None:
        self.layout, self.last = layout, last
        self.conditions = Conditions(layout)
        known = [id(condition) for condition in layout.mechanism.conditions]
        self.blows = layout.mechanism.impulses
        self.numbers = {i: known.index(id(blow.when)) for i, blow in enumerate(self.blows) if blow.when is not None}
        self.previous_truths: list[float] = []
        self.truths_at_start: list[float] = []
        self.strike_counts: dict[int, int] = dict.fromkeys(self.numbers, 0)
        self.has_latches = any(stop.latch is not None for stop in layout.mechanism.stops)
        self.latch_conditions: tuple[LatchCondition, ...] | None = None  # of the latches, at the last evaluation
        self.branches_left: list[float] | None = None  # the branches held at the end of the last piece
        self.last_event_time, self.simultaneous_count = -1.0, 0

    def end_piece(self) -> None:
        """Record the branches held at the end of a piece; before the next piece something may jump."""
        branches = self.layout.pack.expressions.branches()
        self.branches_left = [branches[place] for place in self.conditions.places]

    def begin_piece(self, t: float, state: Array) -> None:
        """Begin a piece at t, in an integrated state (n',): branches that are uncertain by rounding keep their
        values.
        """
        if self.branches_left is None:
            return
        held_branches, self.branches_left = self.branches_left, None
        coordinates = read_coordinates(self.layout, t, state)
        present_branches = self.conditions.take_branches(t, coordinates)
        perturbed_branches = [self.conditions.take_branches(t, other) for other in self.iter_perturbed(coordinates)]
        branches = self.layout.pack.expressions.branches()
        for k, place in enumerate(self.conditions.places):
            branches[place] = (
                present_branches[k]
                if all(other[k] == present_branches[k] for other in perturbed_branches)
                else held_branches[k]
            )
        self.layout.pack.expressions.hold_branches(branches)

    def iter_perturbed(self, coordinates: Coordinates) -> Iterator[Coordinates]:
        """Yield coordinates perturbed by rounding, one of those that conditions use at a time."""
        uses = {use for condition in self.conditions.conditions for use in condition.value.uses}
        least = tolerances.LEAST_RATE / self.last
        rates = max((abs(coordinates[use][0]) for use in uses if is_rate(use[1])), default=0.0)
        for use in uses:
            length = 1.0 if use[1] in ("angle", "rate") else self.layout.size
            scale = max(rates, least * length) if is_rate(use[1]) else max(abs(coordinates[use][0]), length)
            for change in (-tolerances.CONTACT_RATE * scale, tolerances.CONTACT_RATE * scale):
                q, u, a = coordinates[use]
                yield {**coordinates, use: (q + change, u, a)}

    def find_due(self, t: float, state: Array) -> DueTriggers | None:
        """Return the impulses whose conditions became true at t, or changed conditions of latches, or None.

        A condition that is true at the start triggers nothing until it was false. Raises SolveError for too many
        impulses at one instant.
        """
        branches = self.layout.pack.expressions.branches()
        truths = self.conditions.evaluate_held(t, branches, read_coordinates(self.layout, t, state))
        previous_truths, self.previous_truths = self.previous_truths, truths
        latch_conditions = evaluate_latches(self.layout, truths, previous_truths)
        previous_conditions, self.latch_conditions = self.latch_conditions, latch_conditions
        has_changed = self.has_latches and (
            previous_conditions is None
            or any(now.is_value_passed for now in latch_conditions)
            or any(
                (now.is_extended, now.is_drawn_back) != (before.is_extended, before.is_drawn_back)
                for now, before in zip(latch_conditions, previous_conditions, strict=True)
            )
        )
        blows = self.find_due_impulses(t, previous_truths, truths)
        return DueTriggers(blows, latch_conditions if self.has_latches else None) if blows or has_changed else None

    def find_due_impulses(self, t: float, previous_truths: list[float], truths: list[float]) -> tuple[int, ...]:
        """Return the impulses whose conditions became true at t."""
        if t <= tolerances.SIDE_BY_SIDE * self.last:  # a change within rounding of the start does not count
            self.truths_at_start = truths
            return ()
        due = tuple(
            i
            for i, number in self.numbers.items()
            if previous_truths[number] == 0.0
            and truths[number] == 1.0
            and (self.blows[i].every or not self.strike_counts[i])
        )
        if due:
            self.count_impulses(t, due)
        return due

    def evaluate_latches_at_contact(self, t: float, state: Array) -> tuple[LatchCondition, ...] | None:
        """Return the conditions of latches where a contact closes or opens.

        A condition that rounding of the state makes true counts as true: such is one that names the stop's own limit.
        """
        if not self.has_latches:
            return None
        coordinates = read_coordinates(self.layout, t, state)
        truths_held = self.conditions.evaluate_held(t, self.layout.pack.expressions.branches(), coordinates)
        count = range(len(truths_held))
        perturbed_truths = [
            [self.conditions.evaluate_free(k, t, 0.0, other) for k in count]
            for other in (coordinates, *self.iter_perturbed(coordinates))
        ]
        return evaluate_latches(
            self.layout, [max(truths) for truths in zip(truths_held, *perturbed_truths, strict=True)]
        )

    def count_impulses(self, t: float, impulses: tuple[int, ...]) -> None:
        """Count impulses at an instant. Raises SolveError for too many at one instant."""
        self.simultaneous_count = (
            self.simultaneous_count + 1
            if t - self.last_event_time <= tolerances.KERNEL["least_step"] * self.last
            else 0
        )
        self.last_event_time = t
        for i in impulses:
            self.strike_counts[i] += 1
        if self.simultaneous_count > MAX_SIMULTANEOUS * len(self.numbers):
            raise self.make_endless_error(t)

    def make_endless_error(self, t: float) -> SolveError:
        """Make the error of impulses that follow each other endlessly at an instant, or ever faster up to it."""
        impulse_names = [self.blows[i].name for i in self.numbers if self.strike_counts[i]]
        names = " and ".join(f"impulses.{name}" for name in impulse_names)
        verb = "repeats" if len(impulse_names) == 1 else "repeat"
        message = f"at t = {t:.9g} s {names} {verb} endlessly: each impulse makes a condition true again at once"
        hint = "separate the conditions, as rate > 0.1 and rate < -0.1; or let the impulse act only the first time"
        return SolveError(Problem("endless-blows", message, hint=hint, entry_path=f"impulses.{impulse_names[-1]}"))

    def has_just_struck(self, t: float) -> bool:
        """Return whether an impulse is so close before t that others may follow it endlessly."""
        return 0.0 <= t - self.last_event_time <= tolerances.KERNEL["flurry"] * self.last

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences on which impulses were not applied, and why."""
        sentences = []
        for i, number in self.numbers.items():
            when = self.blows[i].when
            if self.strike_counts[i] or when is None:
                continue
            is_true_at_start = bool(self.truths_at_start) and self.truths_at_start[number] == 1.0
            why = (
                "is true at the start, which does not trigger it, and did not become true again"
                if is_true_at_start
                else ""
            )
            sentences.append(f"{self.blows[i].name} did not act: {when.text} {why or 'did not become true'}")
        return tuple(sentences)


def is_rate(quantity: str) -> bool:
    """Return whether a quantity in conditions is a rate of a joint, or a velocity of a point."""
    return quantity in ("rate", "speed") or quantity.startswith("v")
