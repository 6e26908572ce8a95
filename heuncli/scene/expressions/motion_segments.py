"""Motions in segments, of cams and drives: each a rise by a motion law, or a dwell, one after the other.

Every piece of a law is a polynomial and a sine of the distance h from its begin, so the laws of motion_laws.py are
taken apart into such rows, without error:

    s = a0 + a1 h + ... + a7 h^7 + S sin(w h + p)

For a drive the rows become an expression in time, whose branches are the ends of the pieces; for a cam the pieces of
its lift over the disc's angle (kernel/paths.py). Laws that only segments have: Norton, Cam Design and Manufacturing
Handbook, chapter 3; VDI 2143.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterator, Sequence

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.expressions.codegen import CodeGenerator, Part
from heuncli.scene.expressions.dimensions import FREE
from heuncli.scene.expressions.motion_laws import (
    LAWS,
    PI,
    LawPart,
    Pieces,
    cos,
    iter_profile,
    reflect,
)
from heuncli.scene.expressions.programs import HOLD, KNOT, PERIODIC, VAR, Expression, Switch, TableFunction

# Laws from 0 to 1 that have jumps in acceleration or rate

SEGMENT_LAWS: dict[str, Pieces] = {
    **LAWS,
    "linear": [(1.0, lambda x: x)],
    "parabola": [(0.5, lambda x: 2.0 * x**2), (1.0, reflect(lambda x: 2.0 * x**2))],
    "harmonic": [(1.0, lambda x: 0.5 - 0.5 * cos(PI * x))],
    "trapezoid": [  # named by its rate, which rises, stays and falls for a third each
        (1.0 / 3.0, lambda x: 2.25 * x**2),
        (2.0 / 3.0, lambda x: 1.5 * x - 0.25),
        (1.0, reflect(lambda x: 2.25 * x**2)),
    ],
}
LAW_NAMES = (*SEGMENT_LAWS, "scurve")


class LawSegment(NamedTuple):
    """A segment: from `begin` to `end` [s or rad] the coordinate changes from `value` by `rise`; without a law it
    dwells.

    limits: of the rate, the acceleration and, of an S-curve, the jerk; empty for a law that fills the segment
    """

    begin: float
    end: float
    value: float
    rise: float
    law: str = ""
    limits: tuple[float, ...] = ()


class LawRow(NamedTuple):
    """A piece of a motion: the sum of coefficients[k] h^k and amplitude sin(frequency h + phase), h = x - begin."""

    begin: float
    coefficients: tuple[float, ...]
    amplitude: float = 0.0
    frequency: float = 0.0
    phase: float = 0.0

    def evaluate(self, x: float) -> tuple[float, float, float]:
        """Return value, first and second derivative."""
        h = x - self.begin
        value = slope = bend = 0.0
        for a in reversed(self.coefficients):
            bend = 2.0 * slope + h * bend
            slope = value + h * slope
            value = a + h * value
        angle = self.frequency * h + self.phase
        wave, change = self.amplitude * math.sin(angle), self.amplitude * self.frequency * math.cos(angle)
        return value + wave, slope + change, bend - self.frequency**2 * wave


class MotionRows(NamedTuple):
    """A motion in segments, as rows in ascending order; end: where the last one ends [s or rad]."""

    rows: tuple[LawRow, ...]
    end: float

    @property
    def knots(self) -> tuple[float, ...]:
        """The ends of the pieces, from the first begin to the last end."""
        return (*(row.begin for row in self.rows), self.end)


class LawTerms(LawPart):
    """A law taken apart: a polynomial in h and a sine.

    coefficients: of the polynomial, ascending
    wave: amplitude, frequency and phase of the sine
    """

    def __init__(self, coefficients: Sequence[float], wave: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> None:
        self.coefficients, self.wave = list(coefficients), wave

    def apply(self, name: str, *operands: LawPart | float, argument: int = 0) -> LawTerms:
        """Apply an operation to operands, which the laws only use where the result has this form again."""
        terms = [x if isinstance(x, LawTerms) else LawTerms([float(x)]) for x in operands]  # type: ignore[arg-type]
        first, last = terms[0], terms[-1]
        if name == "power":
            product = LawTerms([1.0])
            for _ in range(argument):
                product = multiply_terms(product, first)
            return product
        if name == "mul":
            return multiply_terms(first, last)
        if name in ("sin", "cos"):
            phase, frequency = (*first.coefficients, 0.0)[:2]
            return LawTerms([0.0], (1.0, frequency, phase + (0.5 * PI if name == "cos" else 0.0)))
        sign = -1.0 if name == "sub" else 1.0
        size = max(len(first.coefficients), len(last.coefficients))
        a, b = ([*x.coefficients, *[0.0] * (size - len(x.coefficients))] for x in (first, last))
        amplitude, frequency, phase = last.wave
        wave = first.wave if first.wave[0] else (sign * amplitude, frequency, phase)
        return LawTerms([x + sign * y for x, y in zip(a, b, strict=True)], wave)


def multiply_terms(a: LawTerms, b: LawTerms) -> LawTerms:
    """Return the product of two polynomials, or of a number and terms with a sine."""
    product = [0.0] * (len(a.coefficients) + len(b.coefficients) - 1)
    for i, x in enumerate(a.coefficients):
        for k, y in enumerate(b.coefficients):
            product[i + k] += x * y
    with_wave, other = (a, b) if a.wave[0] else (b, a)
    amplitude, frequency, phase = with_wave.wave
    return LawTerms(product, (amplitude * other.coefficients[0], frequency, phase))


# From segments to rows


def find_profile_duration(rise: float, limits: Sequence[float]) -> float:
    """Return how long a profile within limits takes [s]."""
    return max((end for end, _ in iter_profile(abs(rise), *limits)), default=0.0) if rise else 0.0


def make_rows(segments: Sequence[LawSegment]) -> MotionRows:
    """Make the rows of the pieces of segments, each of which begins where the one before it ends."""
    return MotionRows(tuple(row for segment in segments for row in iter_rows(segment)), segments[-1].end)


def iter_rows(segment: LawSegment) -> Iterator[LawRow]:
    """Yield the rows of a segment."""
    if not segment.law or segment.rise == 0.0:
        yield LawRow(segment.begin, (segment.value,))
        return
    if segment.limits:
        scale, size = 1.0, math.copysign(1.0, segment.rise)
        pieces: Pieces = [*iter_profile(abs(segment.rise), *segment.limits)]
    else:
        scale, size = segment.end - segment.begin, segment.rise
        pieces = SEGMENT_LAWS[segment.law]
    begin = 0.0
    for end, formula in pieces:
        terms = formula(LawTerms([begin, 1.0 / scale]))
        assert isinstance(terms, LawTerms)
        amplitude, frequency, phase = terms.wave
        coefficients = [size * x for x in terms.coefficients]
        coefficients[0] += segment.value
        yield LawRow(segment.begin + scale * begin, tuple(coefficients), size * amplitude, frequency, phase)
        begin = end


# Expressions


def make_drive_expression(motion: MotionRows, base: float, last: float, is_repeated: bool, text: str) -> Expression:
    """Make the expression in time: `base` before the first row, `last` after the last one.

    is_repeated: the rows begin again after their end, from the value that they reached
    text: what messages call it
    """
    codegen = CodeGenerator()
    t = codegen.make_time()._replace(measure=FREE)
    cycles = count_cycles(codegen, motion.end) if is_repeated else None
    if cycles is not None:
        t = (LawPart(codegen, t) - motion.end * cycles).part
    joined = codegen.make_number(last, FREE)
    rows = [(motion.rows[0].begin, codegen.make_number(base, FREE))]
    for row, end in zip(motion.rows, motion.knots[1:], strict=True):
        codegen.nodes = 0  # the limit is for what is written by hand
        rows.append((end, make_row_part(codegen, t, row)))
    for end, part in reversed(rows):
        codegen.nodes = 0
        is_before = codegen.make_operation("lt", t, codegen.make_number(end, FREE), text=text)
        joined = codegen.make_choice(is_before, part, joined, text)
    if cycles is not None:
        joined = (LawPart(codegen, joined) + (last - base) * cycles).part
    return codegen.make_expression(text, joined)


def count_cycles(codegen: CodeGenerator, duration: float) -> LawPart:
    """Return the number of whole cycles at a time: that of the piece of a periodic table of one piece."""
    knots = array("d", [0.0, duration])
    numbers = array("d", [duration, *knots, 0.0, 0.0, 0.0, 0.0])
    codegen.tables.append(TableFunction("cycles", 1, PERIODIC, numbers, knots, array("d", [0.0, 0.0])))
    code = (VAR, 0, KNOT, 0, 1, PERIODIC)
    codegen.switches.append(Switch(code, None))
    return LawPart(codegen, Part(code, frozenset({0}), measure=FREE))


def make_row_part(codegen: CodeGenerator, t: Part, row: LawRow) -> Part:
    """Return the part of a row."""
    h = LawPart(codegen, t) - row.begin
    total = LawPart(codegen, codegen.make_number(row.coefficients[-1], FREE))
    for a in reversed(row.coefficients[:-1]):
        total = a + h * total
    if row.amplitude:
        angle = h * row.frequency + row.phase
        total = total + row.amplitude * angle.apply("sin", angle)
    return total.part


def make_piece_number(knots: Sequence[float], period: float, shaft: str, text: str) -> Expression:
    """Make the expression that is the number of the piece of a lift at a disc's angle, and changes at its ends.

    knots: angles of the disc at the ends of the pieces; period: 0 for a lift that is open
    """
    count = len(knots) - 1
    numbers = array("d", [period, *knots, *[0.0] * (4 * count)])
    kind = PERIODIC if period else 0
    table = TableFunction(text, count, kind, numbers, array("d", knots), array("d", bytes(8 * len(knots))))
    return Expression(
        source=text, constant=None, uses=((shaft, "angle"),), code=(VAR, 1, HOLD, 0, KNOT, 0, count, kind),
        tables=(table,), held_branches=(text,),
    )  # fmt: skip
