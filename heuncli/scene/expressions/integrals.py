"""Integrals over time, from 0: what a drive by its rate prescribes.

    value(t) = sums_i + h Σ w_k rate(knot_i + h x_k),  h = t - knot_i          Gauss and Legendre, 8 nodes
The knots are laid so that the rule is exact to rounding on any part of a piece: they stand at all jumps and kinks of
the rate, and a stretch is halved until both halves give what the whole does and until the bounds of the rate's second
derivative (kernel/enclosure.py) leave no room for anything between its nodes that would be felt. A constant rate is
integrated as it is written, r t. Behind the end of the rate's domain there is no integral, and none over a pole.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from heuncli.base import tolerances
from heuncli.base.errors import LimitError, Problem, SpecError
from heuncli.base.records import replace
from heuncli.kernel.choose import enclosure, expressions, jets
from heuncli.scene.expressions.discontinuities import discontinuities, one_sided_limits
from heuncli.scene.expressions.programs import CONST, INTEGRAL, OPS, VAR, Code, Expression

# Abramowitz and Stegun 25.4.30, n = 8, on [-1, 1]: nodes beside the middle, and their weights.
RULE = (
    (0.1834346424956498, 0.3626837833783620),
    (0.5255324099163290, 0.3137066458778873),
    (0.7966664774136267, 0.2223810344533745),
    (0.9602898564975363, 0.1012285362903763),
)
NODES = [0.5 + 0.5 * sign * x for sign in (-1.0, 1.0) for x, _ in RULE]
WEIGHTS = [0.5 * w for _ in range(2) for _, w in RULE]
assert len(NODES) == expressions.QUADRATURE
LOOKED_AT = 256  # equal parts of the run, at whose ends the size of a rate is estimated
BEYOND = 2.0**-20  # of the run: behind a pole a rate has values again there, behind the end of its domain none
MOST_PIECES = 1 << 16
STEADY: Code = (VAR, 0, CONST, 0, OPS["mul"], 0)  # r t


def integral(rate: Expression, last: float) -> Expression:
    """The integral of a rate in time alone from 0, for instants up to `last`.

    Raises LimitError where it has too many pieces, SpecError [not-computable] where there is a pole.
    """
    if rate.constant is not None:
        r = rate.constant
        code, constant = (STEADY, None) if r != 0.0 else ((CONST, 0), 0.0)
        return replace(rate, constant=constant, time_dependent=r != 0.0, code=code, constants=(r,), tables=())
    knots, sums = pieces_of(rate, last)
    return replace(
        rate,
        code=(INTEGRAL, len(rate.constants), len(sums), len(rate.code) // 2, *rate.code),
        constants=(*rate.constants, *NODES, *WEIGHTS, *knots, *sums),
    )  # fmt: skip


def begun_at(value: Expression, start: float) -> Expression:
    """An integral, or another value in time, and what is added to it: the start of what it is counted from."""
    if value.code[0] == INTEGRAL:
        pieces = value.code[2]
        sums = tuple(start + x for x in value.constants[-pieces:])
        return replace(value, constants=(*value.constants[:-pieces], *sums))
    constant = start + value.constant if value.constant is not None else None
    code = (*value.code, CONST, len(value.constants), OPS["add"], 0)
    return replace(value, constant=constant, code=code, constants=(*value.constants, start))


def pieces_of(rate: Expression, last: float) -> tuple[list[float], list[float]]:
    """The knots, one more than pieces, and the integral at the beginning of each piece; nan where there is none."""
    sides = one_sided_limits(discontinuities(rate, 0.0, last)) if last > 0.0 else []
    ends = [*(t for pair in sides for t in pair if 0.0 < t < last), last if last > 0.0 else 1.0]
    fine = Fineness(rate, last)
    knots, sums = [0.0], [0.0]
    lost = 0.0  # what rounding of the sum left out
    for end in ends:
        for b, part in fine.pieces(knots[-1], end):
            whole = sums[-1] + (part + lost)
            lost += part - (whole - sums[-1])
            knots.append(b)
            sums.append(whole)
            if len(sums) > MOST_PIECES:
                message = f"'{rate.source}' changes too often between 0 and {last:g} s to be integrated"
                raise LimitError(Problem("too-many-jumps", message, rate.location, "let the run be shorter"))
            if whole != whole:
                if math.isfinite(rate.value(b + last * BEYOND)):
                    raise SpecError(_no_integral(rate, b))
                return [*knots, max(last, b)], sums
    return knots, sums[:-1]


def _no_integral(rate: Expression, t: float) -> Problem:
    message = f"'{rate.source.strip()}' grows without bound at t = {t:.9g} s: there is no integral over it"
    return Problem("not-computable", message, rate.location, "keep the rate finite, or end the run before")


class Fineness:
    """The division of a run into pieces, on each of which the rule is exact to rounding."""

    def __init__(self, rate: Expression, last: float) -> None:
        self.rate, self.last = rate, last
        self.programs = rate.pack.expressions
        seen = rate.sample([last * i / LOOKED_AT for i in range(LOOKED_AT + 1)])
        self.size = last * max((abs(f) for f in seen if math.isfinite(f)), default=0.0)

    def pieces(self, begin: float, end: float) -> Iterator[tuple[float, float]]:
        """Ends of pieces and integrals over them, from left to right; nan and the rest where one has no end."""
        ahead = [end]
        while ahead:
            b = ahead[-1]
            part = self.integrated(begin, b)
            middle = begin + 0.5 * (b - begin)
            if part is None and begin < middle < b:
                ahead.append(middle)
                continue
            yield b, math.nan if part is None else part
            if part is None:
                return
            begin = ahead.pop()

    def integrated(self, a: float, b: float) -> float | None:
        """The integral over a stretch without jumps and kinks; None where the rule may miss some of it."""
        h, m = b - a, a + 0.5 * (b - a)
        if not a < m < b:
            return h * self.rate.value(a) if math.isfinite(self.rate.value(a)) else None
        nodes = [[begin + width * x for x in NODES] for begin, width in ((a, h), (a, m - a), (m, b - m))]
        seen = [self.rate.sample(part) for part in nodes]
        whole, left, right = (math.fsum(w * f for w, f in zip(WEIGHTS, part, strict=True)) for part in seen)
        halves = (m - a) * left + (b - m) * right
        allowed = tolerances.INTEGRATED * (h * max(map(abs, seen[0])) + self.size / 64.0) + h * self.rounding(m)
        if not abs(h * whole - halves) <= allowed:
            return None
        return halves if self.all_seen(a, b, [*nodes[1], *nodes[2]]) else None

    def rounding(self, t: float) -> float:
        """By how much rounding, of the instant, too, changes the rate about there."""
        begin, end = math.nextafter(t, -math.inf), math.nextafter(t, math.inf)
        low, high, *_ = self.bounds(begin, end)
        return high - low if math.isfinite(high - low) else 0.0

    def all_seen(self, a: float, b: float, nodes: Sequence[float]) -> bool:
        """Whether between nodes so near the rate can do nothing that would be felt.

        What bends beyond all that they show by c, between two of them, a tenth of the stretch apart, is c (h/10)²/16
        high at most, half of that in the mean, and may be so between any two. Where a stretch is so short that its
        bounds do not tell the branch, at a jump, they tell what that can come to.
        """
        low, high, *_, least, largest = self.bounds(a, math.nextafter(b, a))  # at b another branch may begin
        if (high - low) * (b - a) <= tolerances.UNSEEN_RATE * self.size / 64.0:
            return True
        if not math.isfinite(largest - least):
            return False
        bends = [jets.derivatives(self.programs, 0, self.rate.count, t)[2] for t in nodes]
        lowest, highest = min(bends), max(bends)
        beyond = max(largest - highest, lowest - least)
        felt = beyond * (0.1 * (b - a)) ** 2 / 32.0
        return beyond <= highest - lowest or felt * self.last <= tolerances.UNSEEN_RATE * self.size

    def bounds(self, begin: float, end: float) -> tuple[float, ...]:
        """Least and largest value, slope and bend of the rate over a stretch of time."""
        ranges = [(begin, end, 1.0, 1.0, 0.0, 0.0)]
        m = begin + 0.5 * (end - begin)
        middles = [(m, m, 1.0, 1.0, 0.0, 0.0)]
        found: tuple[float, ...] = enclosure.close_span_of(self.programs, 0, self.rate.count, ranges, middles)
        return found
