"""Impacts one after another: the limit of equal, vanishing gaps in all contacts that touch at an instant.

    v_i -> -e_i v_i,   z_i = -(1 + e_i) v_i / A_ii,   v -> v + A[:, i] z_i,      A = W M^-1 W'
Between two impacts the gaps change by the rates of opening alone, for finite forces do nothing in no time. The contact
whose gap closes next is struck next, with its own restitution. Contacts that close together are struck together
(`solve_impulses`). An impact never adds energy: its work is z_i v_i (1 - e_i) / 2 <= 0.

Whether the sequence ends: with restitution 1 the rates move on a sphere (in the metric of the masses). Contacts that
lie as walls of a wedge are struck finitely often (Sinai 1978); in a cage without play there is no end. With less
restitution infinitely many impacts may end in a finite time, with rates that fall geometrically. So the sequence ends
where no rate of closing is above rounding, and is refused after MOST_IMPACTS.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record
from heuncli.motion.integration.contacts.touching import Touching
from heuncli.results.results import Array, Indices, Mask

MOST_IMPACTS = 20_000  # of one group at one instant: a ball between a wall and a mass 4e7 times its own
UNSOLVED = 0.1  # of a rate's rounding: what is left of it where contacts are solved for together
SETTLING = 200  # plastic impacts in a row without a flight, behind which their limit is solved for

Solver = Callable[[Array, Indices, Array, Array], tuple[Array, Mask]]


class EndlessImpacts(Exception):
    """A sequence of impacts does not end; own: which of the contacts take part, most: the one that is struck most."""

    def __init__(self, own: Indices, most: int) -> None:
        self.own, self.most = own, most


@record
class ImpactSequence:
    """What a sequence of impacts leaves of k contacts.

    impulses (k,): their sums; rate (k,): of opening behind all; depends (k,): closed by others that were struck
    together with it, so that their shares are not known; count (k,): how often each was struck; noise (k,): what
    rounding makes of the rates.
    """

    impulses: Array
    rate: Array
    depends: Mask
    count: Indices
    noise: Array


def feels(A: Array) -> Mask:
    """Whether the impulse of one contact changes the rate of the other, (k, k)."""
    size = np.sqrt(np.maximum(np.diag(A), 0.0))
    return np.asarray(np.abs(A) > tolerances.SUM_ROUNDING * size[:, None] * size)


class ContactRates:
    """Rates and gaps of contacts during a sequence; plain numbers, for a few contacts are struck thousands of times.

    v: rates of opening; gap: in any unit of length; widest: the gap's largest since the last impact, by which its
    rounding is measured; total: impulses; fastest, moved: the largest of each rate, and the sum of its changes, by
    which its rounding is measured. Changes with every flight and impact.
    """

    def __init__(self, start: Array, lengths: Array, A: Array) -> None:
        """start (k,): rates; lengths (k,): what the unit of each gap is of a length [m]; A (k, k)."""
        self.v: list[float] = start.tolist()
        self.gap: list[float] = (1.0 / lengths).tolist()
        self.widest = self.gap.copy()
        self.total, self.moved = [0.0] * len(start), [0.0] * len(start)
        self.fastest = [abs(v) for v in self.v]
        # contacts far off feel blows and impacts by rounding alone
        self.least: list[float] = (tolerances.SUM_ROUNDING * np.abs(start * lengths).max() / lengths).tolist()
        self.answers: list[list[float]] = A.T.tolist()
        self.places = range(len(start))

    def rounding(self, i: int) -> float:
        """What rounding makes of a rate."""
        return float(max(self.least[i], tolerances.SUM_ROUNDING * self.fastest[i], tolerances.EPS * self.moved[i]))

    def closing(self, movable: list[int]) -> list[int]:
        """Those that close."""
        return [i for i in movable if self.v[i] < 0.0 and self.v[i] < -self.rounding(i)]

    def next_impacts(self, closing: list[int]) -> tuple[list[int], float]:
        """Which of the closing contacts are struck next, those within CONTACT_TOGETHER together; the time of flight."""
        times = [self.gap[i] / -self.v[i] for i in closing]
        time = min(times)
        doubts = [tolerances.CONTACT_TOGETHER * self.widest[i] / -self.v[i] for i in closing]
        limit = time + doubts[times.index(time)]
        return [i for i, own, doubt in zip(closing, times, doubts, strict=True) if own <= limit + doubt], time

    def fly(self, time: float, struck: list[int]) -> None:
        """Let the gaps change up to an impact, of which those of the contacts struck there are zero."""
        if time > 0.0:
            self.gap = [max(gap + v * time, 0.0) for gap, v in zip(self.gap, self.v, strict=True)]
            self.widest = [max(widest, gap) for widest, gap in zip(self.widest, self.gap, strict=True)]
        for i in struck:
            self.gap[i] = self.widest[i] = 0.0

    def push(self, i: int, z: float) -> None:
        """Add an impulse of one contact to all rates."""
        self.total[i] += z
        for k, answer in zip(self.places, self.answers[i], strict=True):
            if answer:
                change = answer * z
                self.v[k] += change
                self.moved[k] += abs(change)
                self.fastest[k] = max(self.fastest[k], abs(self.v[k]))

    def strike(self, i: int, restitution: float) -> None:
        """Strike one contact as if it were alone."""
        rebound = -restitution * self.v[i]
        self.push(i, -(1.0 + restitution) * self.v[i] / self.answers[i][i])
        self.v[i] = rebound


def strike_in_sequence(
    touch: Touching, A: Array, start: Array, noise: Array, moves: Mask, restitution: Array, solve_impulses: Solver
) -> ImpactSequence:
    """Strike contacts one after another until none closes.

    touch: the contacts (k,); A (k, k): rates of opening by unit impulses; start (k,): rates of opening behind what is
    given; noise (k,): their rounding; moves (k,): whether an impulse moves anything; solve_impulses(v, own, e, noise):
    impulses of contacts that close together, and which of them depend on the others. Raises EndlessImpacts.
    """
    at = ContactRates(np.where(np.abs(start) <= noise, 0.0, start), touch.length, A)
    depends, count = np.zeros(len(start), dtype=bool), np.zeros(len(start), dtype=int)
    felt, e, movable = feels(A), restitution.tolist(), np.flatnonzero(moves).tolist()
    settled: set[int] = set()  # plastic contacts struck since the last flight
    still = 0
    for _ in range(MOST_IMPACTS):
        closing = at.closing(movable)
        if not closing:
            rounding = np.array([at.rounding(i) for i in at.places])
            return ImpactSequence(np.array(at.total), np.array(at.v), depends, count, np.maximum(noise, rounding))
        struck, time = at.next_impacts(closing)
        if time > 0.0 or any(e[i] for i in struck):
            still, settled = 0, set()
        else:
            still, settled = still + 1, settled | set(struck)
        if still > SETTLING:
            struck, still = sorted(settled), 0
        at.fly(time, struck)
        if any(felt[i, k] for i in struck for k in struck if i != k):
            own, v = np.array(struck, dtype=int), np.array(at.v)
            used = np.where(v[own] < 0.0, restitution[own], 0.0)
            z, open_ = solve_impulses(v, own, used, np.array([UNSOLVED * at.rounding(i) for i in struck]))
            for i, impulse in zip(struck, z.tolist(), strict=True):
                at.push(i, impulse)
            for i, impulse, rebound in zip(struck, z.tolist(), (-used * v[own]).tolist(), strict=True):
                if impulse > 0.0 or not z.any():  # or what is left of them is rounding
                    at.v[i] = rebound
            depends[own[open_]] = True
        else:
            for i in struck:
                at.strike(i, e[i])
        count[struck] += 1
    raise EndlessImpacts(np.flatnonzero(count), int(np.argmax(count)))


def independent(A: Array) -> Indices:
    """The contacts of a matrix of answers (k, k) that those before them leave an answer of their own, ascending."""
    size = np.sqrt(np.diag(A))
    left = A / (size[:, None] * size)
    found: list[int] = []
    for _ in range(len(A)):
        i = int(np.argmax(np.diag(left)))
        if left[i, i] <= tolerances.CONTACT_BASIS:
            break
        found.append(i)
        left = left - np.outer(left[:, i], left[i]) / left[i, i]
        left[i, :] = left[:, i] = 0.0
    return np.array(sorted(found), dtype=int)


def endless_impacts(t: float, names: list[str], name: str) -> SolveError:
    """The error of impacts without an end among the named contacts; name: of the one that is struck most."""
    message = (
        f"at t = {t:.9g} s the impacts of {', '.join(dict.fromkeys(names))} follow one another more than "
        f"{MOST_IMPACTS} times without an end"
    )
    hint = "restitution below 1 where contacts leave no play, or analysis: {impacts: simultaneous}"
    return SolveError(Problem("endless-impacts", message, hint=hint, about=name))
