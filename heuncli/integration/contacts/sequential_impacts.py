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

from heuncli import tolerances
from heuncli.errors import Problem, SolveError
from heuncli.integration.contacts.touching import Touching
from heuncli.records import record
from heuncli.results import Array, Indices, Mask

MOST_IMPACTS = 20_000  # of one group at one instant: a ball between a wall and a mass 4e7 times its own
SETTLING = 200  # plastic impacts in a row without a flight, behind which their limit is solved for

Solver = Callable[[Array, Array, Indices, Array], tuple[Array, Mask]]


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


class Gaps:
    """The gaps of contacts during a sequence, in any unit of length. Changes with every flight and impact."""

    def __init__(self, lengths: Array) -> None:
        """lengths (k,): what the unit of each contact's gap is of a length [m]."""
        self.gap = 1.0 / lengths
        self.widest = self.gap.copy()  # since the last impact: what rounding of the gap is measured by

    def next_impacts(self, rate: Array, closing: Indices) -> tuple[Indices, float]:
        """Which of the closing contacts are struck next, those within CONTACT_TOGETHER together; the time of flight."""
        speed = -rate[closing]
        time = self.gap[closing] / speed
        least = int(np.argmin(time))
        doubt = tolerances.CONTACT_TOGETHER * self.widest[closing] / speed
        return closing[time - time[least] <= doubt + doubt[least]], float(time[least])

    def fly(self, rate: Array, time: float, struck: Indices) -> None:
        """Let the gaps change up to an impact, of which those of the contacts struck there are zero."""
        self.gap = np.maximum(self.gap + rate * time, 0.0)
        self.widest = np.maximum(self.widest, self.gap)
        self.gap[struck] = self.widest[struck] = 0.0


def strike_in_sequence(
    touch: Touching, A: Array, start: Array, noise: Array, restitution: Array, moves: Mask, solve_impulses: Solver
) -> ImpactSequence:
    """Strike contacts one after another until none closes.

    touch: the contacts (k,); A (k, k): rates of opening by unit impulses; start (k,): rates of opening behind what is
    given; noise (k,): their rounding; moves (k,): whether an impulse moves anything; solve_impulses(A, v, own, e):
    impulses of contacts that close together, and which of them depend on the others. Raises EndlessImpacts.
    """
    v, total, gaps = start.copy(), np.zeros(len(start)), Gaps(touch.length)
    noise, fastest = noise.copy(), np.abs(start)
    depends, count = np.zeros(len(v), dtype=bool), np.zeros(len(v), dtype=int)
    settled: set[int] = set()  # plastic contacts struck since the last flight
    still = 0
    own_answer, sizes = np.diag(A), np.abs(A)
    felt = feels(A) & ~np.eye(len(v), dtype=bool)
    for _ in range(MOST_IMPACTS):
        closing = np.flatnonzero((v < -noise) & moves)
        if not len(closing):
            return ImpactSequence(total, v, depends, count, noise)
        struck, time = gaps.next_impacts(v, closing) if len(closing) > 1 else (closing, flight(gaps, v, closing))
        still = still + 1 if time == 0.0 and not restitution[struck].any() else 0
        settled = settled | set(struck.tolist()) if still else set()
        if still > SETTLING:
            struck, still = np.array(sorted(settled), dtype=int), 0
        gaps.fly(v, time, struck)
        if len(struck) == 1 or not felt[np.ix_(struck, struck)].any():
            z = -(1.0 + restitution[struck]) * v[struck] / own_answer[struck]
            rebound = -restitution[struck] * v[struck]
            v = v + A[:, struck] @ z
            v[struck] = rebound
            total[struck] += z
        else:
            e = np.where(v[struck] < 0.0, restitution[struck], 0.0)
            z, open_ = solve_impulses(A, v, struck, e)
            bears, rebound = z > 0.0, -e * v[struck]
            v = v + A[:, struck] @ z
            v[struck[bears]] = rebound[bears]
            total[struck] += z
            depends[struck[open_]] = True
        count[struck] += 1
        fastest = np.maximum(fastest, np.abs(v))
        rounding = np.maximum(tolerances.CONTACT_RATE * fastest, tolerances.EPS * (sizes @ total))
        noise = np.maximum(noise, rounding)
    raise EndlessImpacts(np.flatnonzero(count), int(np.argmax(count)))


def flight(gaps: Gaps, rate: Array, closing: Indices) -> float:
    """The time until the one contact that closes is struck."""
    return float(gaps.gap[closing[0]] / -rate[closing[0]])


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
