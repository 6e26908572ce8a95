"""Integrate expressions over time, from 0: what a drive given by its rate prescribes.

    value(t) = sums_i + h Σ w_k rate(knot_i + h x_k),  h = t - knot_i          Gauss and Legendre, 8 nodes
The knots are chosen so that the rule is exact to rounding on any part of a piece. They stand at all jumps and kinks of
the rate, and an interval is halved until both halves give what the whole does, and until the bounds of the rate's
second derivative (kernel/enclosure.py) exclude any noticeable change between the nodes. A constant rate is integrated
in closed form, r t. Behind the end of the rate's domain there is no integral, and none over a pole.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from heuncli.base import tolerances
from heuncli.base.errors import LimitError, Problem, SpecError
from heuncli.base.records import replace
from heuncli.kernel.choose import enclosure, expressions, jets
from heuncli.scene.expressions.discontinuities import find_discontinuities, pair_adjacent_instants
from heuncli.scene.expressions.programs import CONST, INTEGRAL, OPS, VAR, Code, Expression

# Abramowitz and Stegun 25.4.30, n = 8, on [-1, 1]: positive nodes, and their weights.
RULE = (
    (0.1834346424956498, 0.3626837833783620),
    (0.5255324099163290, 0.3137066458778873),
    (0.7966664774136267, 0.2223810344533745),
    (0.9602898564975363, 0.1012285362903763),
)
NODES = [0.5 + 0.5 * sign * x for sign in (-1.0, 1.0) for x, _ in RULE]
WEIGHTS = [0.5 * w for _ in range(2) for _, w in RULE]
assert len(NODES) == expressions.QUADRATURE
SAMPLE_COUNT = 256  # equal parts of the run, at whose ends the size of a rate is estimated
PROBE_DISTANCE = 2.0**-20  # of the run: this far behind a pole the rate is finite again, behind its domain it is not
MAX_PIECES = 1 << 16
CONSTANT_RATE_CODE: Code = (VAR, 0, CONST, 0, OPS["mul"], 0)  # r t


def integrate_rate(rate: Expression, last: float) -> Expression:
    """Integrate a rate in time alone from 0, for instants up to `last`.

    Raises LimitError if there are too many pieces, SpecError [not-computable] if there is a pole.
    """
    if rate.constant is not None:
        r = rate.constant
        code, constant = (CONSTANT_RATE_CODE, None) if r != 0.0 else ((CONST, 0), 0.0)
        return replace(rate, constant=constant, time_dependent=r != 0.0, code=code, constants=(r,), tables=())
    knots, sums = divide_into_pieces(rate, last)
    return replace(
        rate,
        code=(INTEGRAL, len(rate.constants), len(sums), len(rate.code) // 2, *rate.code),
        constants=(*rate.constants, *NODES, *WEIGHTS, *knots, *sums),
    )  # fmt: skip


def add_start_value(value: Expression, start: float) -> Expression:
    """Add the start value to an integral, or to another value in time."""
    if value.code[0] == INTEGRAL:
        pieces = value.code[2]
        sums = tuple(start + x for x in value.constants[-pieces:])
        return replace(value, constants=(*value.constants[:-pieces], *sums))
    constant = start + value.constant if value.constant is not None else None
    code = (*value.code, CONST, len(value.constants), OPS["add"], 0)
    return replace(value, constant=constant, code=code, constants=(*value.constants, start))


def divide_into_pieces(rate: Expression, last: float) -> tuple[list[float], list[float]]:
    """Compute the knots, one more than pieces, and the integral at the beginning of each piece; nan where there is
    none.
    """
    adjacent_instants = pair_adjacent_instants(find_discontinuities(rate, 0.0, last)) if last > 0.0 else []
    ends = [*(t for pair in adjacent_instants for t in pair if 0.0 < t < last), last if last > 0.0 else 1.0]
    division = PieceDivision(rate, last)
    knots, sums = [0.0], [0.0]
    rounding_loss = 0.0  # rounding error of the sum so far
    for end in ends:
        for piece_end, part in division.iter_pieces(knots[-1], end):
            total = sums[-1] + (part + rounding_loss)
            rounding_loss += part - (total - sums[-1])
            knots.append(piece_end)
            sums.append(total)
            if len(sums) > MAX_PIECES:
                message = f"'{rate.source}' changes too often between 0 and {last:g} s and cannot be integrated"
                raise LimitError(Problem("too-many-jumps", message, rate.location, "use a shorter duration"))
            if total != total:
                if math.isfinite(rate.value(piece_end + last * PROBE_DISTANCE)):
                    raise SpecError(_pole_problem(rate, piece_end))
                return [*knots, max(last, piece_end)], sums
    return knots, sums[:-1]


def _pole_problem(rate: Expression, t: float) -> Problem:
    message = f"'{rate.source.strip()}' grows without bound at t = {t:.9g} s: its integral does not exist"
    return Problem("not-computable", message, rate.location, "keep the rate finite, or end the run earlier")


class PieceDivision:
    """Divides a run into pieces on each of which the rule is exact to rounding."""

    def __init__(self, rate: Expression, last: float) -> None:
        self.rate, self.last = rate, last
        self.programs = rate.pack.expressions
        seen = rate.sample([last * i / SAMPLE_COUNT for i in range(SAMPLE_COUNT + 1)])
        self.size = last * max((abs(f) for f in seen if math.isfinite(f)), default=0.0)

    def iter_pieces(self, begin: float, end: float) -> Iterator[tuple[float, float]]:
        """Yield the ends of pieces and the integrals over them, from left to right; nan for a piece that does not
        converge, and stop.
        """
        pending = [end]
        while pending:
            piece_end = pending[-1]
            part = self.integrate_interval(begin, piece_end)
            middle = begin + 0.5 * (piece_end - begin)
            if part is None and begin < middle < piece_end:
                pending.append(middle)
                continue
            yield piece_end, math.nan if part is None else part
            if part is None:
                return
            begin = pending.pop()

    def integrate_interval(self, a: float, b: float) -> float | None:
        """Integrate over an interval without jumps and kinks; None if the rule may miss something."""
        h, m = b - a, a + 0.5 * (b - a)
        if not a < m < b:
            return h * self.rate.value(a) if math.isfinite(self.rate.value(a)) else None
        nodes = [[begin + width * x for x in NODES] for begin, width in ((a, h), (a, m - a), (m, b - m))]
        values = [self.rate.sample(part) for part in nodes]
        whole, left, right = (math.fsum(w * f for w, f in zip(WEIGHTS, part, strict=True)) for part in values)
        halves = (m - a) * left + (b - m) * right
        tolerance = tolerances.INTEGRATED * (h * max(map(abs, values[0])) + self.size / 64.0) + h * self.rounding_error(
            m
        )
        if not abs(h * whole - halves) <= tolerance:
            return None
        return halves if self.is_resolved(a, b, [*nodes[1], *nodes[2]]) else None

    def rounding_error(self, t: float) -> float:
        """Return by how much rounding, also of the instant, changes the rate near t."""
        begin, end = math.nextafter(t, -math.inf), math.nextafter(t, math.inf)
        low, high, *_ = self.enclose(begin, end)
        return high - low if math.isfinite(high - low) else 0.0

    def is_resolved(self, a: float, b: float, nodes: Sequence[float]) -> bool:
        """Return whether the rate can do nothing noticeable between these nodes.

        If its second derivative exceeds the values at the nodes by c between two of them, a tenth of the interval
        apart, that makes a bump of height c (h/10)²/16 at most, half of that in the mean, and so perhaps between any
        two. If an interval is so short that its bounds cannot tell the branch, at a jump, they bound the effect
        instead.
        """
        low, high, *_, least, largest = self.enclose(a, math.nextafter(b, a))  # another branch may begin at b
        if (high - low) * (b - a) <= tolerances.UNSEEN_RATE * self.size / 64.0:
            return True
        if not math.isfinite(largest - least):
            return False
        curvatures = [jets.find_derivatives(self.programs, 0, self.rate.count, t)[2] for t in nodes]
        lowest, highest = min(curvatures), max(curvatures)
        excess = max(largest - highest, lowest - least)
        missed_area = excess * (0.1 * (b - a)) ** 2 / 32.0
        return excess <= highest - lowest or missed_area * self.last <= tolerances.UNSEEN_RATE * self.size

    def enclose(self, begin: float, end: float) -> tuple[float, ...]:
        """Return the least and largest value, slope and second derivative of the rate over an interval of time."""
        ranges = [(begin, end, 1.0, 1.0, 0.0, 0.0)]
        m = begin + 0.5 * (end - begin)
        middles = [(m, m, 1.0, 1.0, 0.0, 0.0)]
        found: tuple[float, ...] = enclosure.find_close_span(self.programs, 0, self.rate.count, ranges, middles)
        return found
