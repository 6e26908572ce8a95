"""Blows that strike, and latches that catch or let go, by conditions: which at an instant that a run has reached.

The kernel ends a step where a branch of a condition turns, and stops there and where a piece begins. A condition that
was false, and is true as the branches stand, became true. A piece that begins takes its branches afresh from the state,
by whose rounding a margin that was just passed may lie on either side: where rounding leaves a branch open it stays as
it was held. If it goes the other way the kernel turns it at once.
"""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.named_tuples import NamedTuple
from heuncli.motion.integration.conditions import Conditions, Coordinates, coordinates_in
from heuncli.motion.integration.contacts.latches import Bolts, bolts
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

AT_ONCE = 4  # blows of a condition at one instant: more follow each other without end


class Due(NamedTuple):
    """Blows that are due at an instant, and what the conditions of latches say there, where there are any."""

    blows: tuple[int, ...]
    said: Bolts | None


class Triggers:
    """The blows and latches of a scene that hang on conditions. Remembers what was true, and which have struck.

    layout: of what is integrated. last: the end of the run [s].
    """

    def __init__(self, layout: Layout, last: float) -> None:
        self.layout, self.last = layout, last
        self.conditions = Conditions(layout)
        known = [id(condition) for condition in layout.mechanism.conditions]
        self.blows = layout.mechanism.blows
        self.numbers = {i: known.index(id(blow.when)) for i, blow in enumerate(self.blows) if blow.when is not None}
        self.was: list[float] = []
        self.begins: list[float] = []
        self.struck: dict[int, int] = dict.fromkeys(self.numbers, 0)
        self.latched = any(stop.latch is not None for stop in layout.mechanism.stops)
        self.said: Bolts | None = None  # of the latches, when it was looked at last
        self.left: list[float] | None = None  # the branches held at the end of the last piece
        self.since, self.at_once = -1.0, 0

    def leave(self) -> None:
        """A piece ends: the branches that are held there, between which and the next piece something may jump."""
        branches = self.layout.pack.expressions.branches()
        self.left = [branches[place] for place in self.conditions.places]

    def begin(self, t: float, state: Array) -> None:
        """A piece begins at t, in a state (n',) of what is integrated: what rounding leaves open stays as it was."""
        if self.left is None:
            return
        held, self.left = self.left, None
        there = coordinates_in(self.layout, t, state)
        behind = self.conditions.taken(t, there)
        beside = [self.conditions.taken(t, other) for other in self.beside(there)]
        branches = self.layout.pack.expressions.branches()
        for k, place in enumerate(self.conditions.places):
            branches[place] = behind[k] if all(other[k] == behind[k] for other in beside) else held[k]
        self.layout.pack.expressions.hold_branches(branches)

    def beside(self, there: Coordinates) -> Iterator[Coordinates]:
        """Coordinates as they may be but for rounding, one of those that conditions use moved at a time."""
        uses = {use for condition in self.conditions.conditions for use in condition.value.uses}
        least = tolerances.LEAST_RATE / self.last
        rates = max((abs(there[use][0]) for use in uses if is_rate(use[1])), default=0.0)
        for use in uses:
            length = 1.0 if use[1] in ("angle", "rate") else self.layout.size
            scale = max(rates, least * length) if is_rate(use[1]) else max(abs(there[use][0]), length)
            for way in (-tolerances.CONTACT_RATE * scale, tolerances.CONTACT_RATE * scale):
                q, u, a = there[use]
                yield {**there, use: (q + way, u, a)}

    def due(self, t: float, state: Array) -> Due | None:
        """The blows whose conditions became true at t; what is true at the start strikes nothing until it was false.

        Or what the conditions of latches say, where that is something else than before. Raises SolveError for too many
        blows at one instant.
        """
        branches = self.layout.pack.expressions.branches()
        now = self.conditions.held(t, branches, coordinates_in(self.layout, t, state))
        was, self.was = self.was, now
        said, before = bolts(self.layout, now, was), self.said
        self.said = said
        changed = self.latched and (before is None or any(said.passed) or before[:2] != said[:2])
        blows = self.blows_due(t, was, now)
        return Due(blows, said if self.latched else None) if blows or changed else None

    def blows_due(self, t: float, was: list[float], now: list[float]) -> tuple[int, ...]:
        """The blows whose conditions became true at t."""
        if t <= tolerances.SIDE_BY_SIDE * self.last:  # what turns by rounding of the start was so before
            self.begins = now
            return ()
        due = tuple(
            i
            for i, number in self.numbers.items()
            if was[number] == 0.0 and now[number] == 1.0 and (self.blows[i].every or not self.struck[i])
        )
        if due:
            self.count(t, due)
        return due

    def said_at_contact(self, t: float, state: Array) -> Bolts | None:
        """What the conditions of latches say where a contact closes or opens.

        One that becomes true by the rounding of the state is true there: so does one that names the stop's own limit.
        """
        if not self.latched:
            return None
        there = coordinates_in(self.layout, t, state)
        held = self.conditions.held(t, self.layout.pack.expressions.branches(), there)
        count = range(len(held))
        beside = [[self.conditions.free(k, t, 0.0, other) for k in count] for other in (there, *self.beside(there))]
        return bolts(self.layout, [max(truths) for truths in zip(held, *beside, strict=True)])

    def count(self, t: float, due: tuple[int, ...]) -> None:
        """Blows at an instant. Raises SolveError for too many at one."""
        self.at_once = self.at_once + 1 if t - self.since <= tolerances.KERNEL["least_step"] * self.last else 0
        self.since = t
        for i in due:
            self.struck[i] += 1
        if self.at_once > AT_ONCE * len(self.numbers):
            raise self.endless(t)

    def endless(self, t: float) -> SolveError:
        """The error of blows that follow each other at an instant, or ever faster up to it."""
        struck = [self.blows[i].name for i in self.numbers if self.struck[i]]
        names = " and ".join(f"impulses.{name}" for name in struck)
        message = f"at t = {t:.9g} s {names} strike without end: each blow makes a condition true again at once"
        hint = "leave room between conditions, as rate > 0.1 beside rate < -0.1; or let it strike the first time alone"
        return SolveError(Problem("endless-blows", message, hint=hint, about=f"impulses.{struck[-1]}"))

    def just_struck(self, t: float) -> bool:
        """Whether a blow is so near before t that others may follow it without end."""
        return 0.0 <= t - self.since <= tolerances.KERNEL["flurry"] * self.last

    @property
    def notes(self) -> tuple[str, ...]:
        """Which blows did not strike, and why."""
        told = []
        for i, number in self.numbers.items():
            when = self.blows[i].when
            if self.struck[i] or when is None:
                continue
            began = bool(self.begins) and self.begins[number] == 1.0
            why = "is true at the start, which strikes nothing, and did not become true again" if began else ""
            told.append(f"{self.blows[i].name} did not strike: {when.text} {why or 'did not become true'}")
        return tuple(told)


def is_rate(quantity: str) -> bool:
    """Whether it is a rate of a joint, or a velocity of a point, by its name in conditions."""
    return quantity in ("rate", "speed") or quantity.startswith("v")
