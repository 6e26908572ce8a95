"""Motion laws of cams and servo drives, as pieces of other operations of an expression.

A law is a row of pieces, each with its end and its formula; between pieces the expression has branches as those of
`a if c else b`. So values, derivatives, bounds and events are those of any expression, in either kernel.

    f(x) from 0 to 1 over x = 0 to 1, 0 before, 1 after     Norton, Cam Design and Manufacturing Handbook; VDI 2143
    s(t) from 0 to the distance, at rest before and after   the shortest motion within the limits; where it is too short
                                                            to reach one of them, that part of the profile is left out
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

from heuncli.base.errors import Finding
from heuncli.base.units import NUMBER, TIME, Dimension, describe
from heuncli.scene.expressions.codegen import CodeGenerator, Part
from heuncli.scene.expressions.dimensions import FREE, MeasuredDimension, function_dimension

TAU, PI = math.tau, math.pi
MAX_ARGUMENT = 100  # operations of an argument, because each piece has it several times


class LawPart:
    """A part of an expression to calculate with; numbers become constants of the expression."""

    def __init__(self, codegen: CodeGenerator, part: Part) -> None:
        self.codegen, self.part = codegen, part

    def apply(self, name: str, *operands: LawPart | float, argument: int = 0) -> LawPart:
        """Apply an operation to operands."""
        parts = [
            operand.part if isinstance(operand, LawPart) else self.codegen.make_number(operand, FREE)
            for operand in operands
        ]
        return LawPart(self.codegen, self.codegen.make_operation(name, *parts, argument=argument))

    def __add__(self, other: LawPart | float) -> LawPart:
        return self.apply("add", self, other)

    def __sub__(self, other: LawPart | float) -> LawPart:
        return self.apply("sub", self, other)

    def __rsub__(self, other: float) -> LawPart:
        return self.apply("sub", other, self)

    def __mul__(self, other: LawPart | float) -> LawPart:
        return self.apply("mul", self, other)

    __radd__, __rmul__ = __add__, __mul__

    def __pow__(self, n: int) -> LawPart:
        return self.apply("power", self, argument=n)


def sin(x: LawPart) -> LawPart:
    """Return the sine."""
    return x.apply("sin", x)


def cos(x: LawPart) -> LawPart:
    """Return the cosine."""
    return x.apply("cos", x)


Formula = Callable[[LawPart], LawPart]
Pieces = Sequence[tuple[float, Formula]]  # the end of each piece, and the value in it

# Laws from 0 to 1

MODSINE_DIVISOR = 4.0 + PI  # divides the modified sine so that its rise is 1
MODTRAP_ACCELERATION = 8.0 * PI / (2.0 + PI)  # largest acceleration of the modified trapezoid
V1 = MODTRAP_ACCELERATION / (4.0 * PI)  # its velocity at x = 1/8
S1 = MODTRAP_ACCELERATION / (4.0 * PI) * (0.125 - 0.25 / PI)  # its value there
V2, S2 = V1 + MODTRAP_ACCELERATION / 4.0, S1 + V1 / 4.0 + MODTRAP_ACCELERATION / 32.0  # at 3/8


def reflect(formula: Formula) -> Formula:
    """Return the second half of a law that is symmetrical about its middle."""
    return lambda x: 1.0 - formula(1.0 - x)


def start_modified_trapezoid(x: LawPart) -> LawPart:
    """Return the value while the acceleration rises as a quarter of a sine."""
    return V1 * (x - sin(4.0 * PI * x) * (0.25 / PI))


def accelerate_modified_trapezoid(x: LawPart) -> LawPart:
    """Return the value while the acceleration is constant."""
    return S1 + (x - 0.125) * (V1 + 0.5 * MODTRAP_ACCELERATION * (x - 0.125))


def release_modified_trapezoid(x: LawPart) -> LawPart:
    """Return the value while the acceleration falls as half a cosine, through the middle."""
    cosine = cos(4.0 * PI * (x - 0.375))
    return S2 + V2 * (x - 0.375) + MODTRAP_ACCELERATION / (16.0 * PI**2) * (1.0 - cosine)


LAWS: dict[str, Pieces] = {
    "cycloid": [(1.0, lambda x: x - sin(TAU * x) * (1.0 / TAU))],
    "modsine": [
        (0.125, lambda x: (PI * x - 0.25 * sin(4.0 * PI * x)) * (1.0 / MODSINE_DIVISOR)),
        (0.875, lambda x: (2.0 + PI * x - 2.25 * cos(4.0 * PI / 3.0 * x - PI / 6.0)) * (1.0 / MODSINE_DIVISOR)),
        (1.0, reflect(lambda x: (PI * x - 0.25 * sin(4.0 * PI * x)) * (1.0 / MODSINE_DIVISOR))),
    ],
    "modtrap": [
        (0.125, start_modified_trapezoid),
        (0.375, accelerate_modified_trapezoid),
        (0.625, release_modified_trapezoid),
        (0.875, reflect(accelerate_modified_trapezoid)),
        (1.0, reflect(start_modified_trapezoid)),
    ],
    "poly345": [(1.0, lambda x: x**3 * (10.0 + x * (6.0 * x - 15.0)))],
    "poly4567": [(1.0, lambda x: x**4 * (35.0 + x * (x * (70.0 - 20.0 * x) - 84.0)))],
}

# Profiles within limits

LIMITS = {"scurve": ("rate", "acceleration", "jerk"), "trapezoid": ("rate", "acceleration")}
ARGUMENTS = {**dict.fromkeys(LAWS, 1), **{name: 2 + len(limits) for name, limits in LIMITS.items()}}
TEXTS = {name: f"{name}(t, distance, {', '.join(limits)})" for name, limits in LIMITS.items()}


def divide_profile(
    distance: float, rate: float, acceleration: float, jerk: float = math.inf
) -> tuple[float, float, float, float]:
    """Return the duration of the jerk, of the whole acceleration, of the cruise [s], and the largest rate.

    The distance is positive; with an infinite jerk the acceleration is constant at once.
    """
    ramp = acceleration / jerk
    if rate < acceleration * ramp:  # the acceleration is not reached
        ramp = math.sqrt(rate / jerk)
        rise = 2.0 * ramp
    else:
        rise = rate / acceleration + ramp
    if distance >= rate * rise:
        return ramp, rise, distance / rate - rise, rate
    ramp = acceleration / jerk  # the rate is not reached
    if distance >= 2.0 * acceleration * ramp**2:
        rise = 0.5 * ramp + math.sqrt(0.25 * ramp**2 + distance / acceleration)
        return ramp, rise, 0.0, acceleration * (rise - ramp)
    ramp = math.cbrt(0.5 * distance / jerk)
    return ramp, 2.0 * ramp, 0.0, jerk * ramp**2


def iter_profile(
    distance: float, rate: float, acceleration: float, jerk: float = math.inf
) -> Iterator[tuple[float, Formula]]:
    """Yield the pieces of a profile over a positive distance; those without duration are left out."""
    ramp, rise, cruise, top = divide_profile(distance, rate, acceleration, jerk)
    steady = top / (rise - ramp)  # the acceleration between the ramps
    whole = 2.0 * rise + cruise

    def ramp_up(t: LawPart) -> LawPart:
        return jerk / 6.0 * t**3

    def accelerate(t: LawPart) -> LawPart:
        return steady * ramp**2 / 6.0 + 0.5 * steady * t * (t - ramp)

    def ramp_down(t: LawPart) -> LawPart:
        return 0.5 * top * rise - top * (rise - t) + jerk / 6.0 * (rise - t) ** 3

    first_half = [(ramp, ramp_up), (rise - ramp, accelerate), (rise, ramp_down)]
    if not ramp:
        first_half = [(rise, accelerate)]
    elif not rise - ramp > ramp:
        first_half = [first_half[0], first_half[2]]
    yield from first_half
    if cruise > 0.0:
        yield rise + cruise, lambda t: 0.5 * top * rise + top * (t - rise)
    ends = [whole, *(whole - end for end, _ in first_half)]
    for k in reversed(range(len(first_half))):
        yield ends[k], lambda t, formula=first_half[k][1]: distance - formula(whole - t)  # type: ignore[misc]


# Parts of expressions


def make_motion_law(codegen: CodeGenerator, name: str, parts: Sequence[Part], text: str) -> Part:
    """Return the part of a law or profile. text: as it is written. Raises Finding [wrong-dimension, function-arguments,
    expression-limit].
    """
    if name in LAWS:
        measure = function_dimension(name, parts[0].measure)
        return join_pieces(codegen, parts[0], LAWS[name], 1.0, text)._replace(measure=measure)
    distance, *limits = (require_constant(name, k, part) for k, part in enumerate(parts[1:]))
    measure = find_profile_dimension(name, parts)
    sign = math.copysign(1.0, distance)
    pieces = [
        (end, lambda t, formula=formula: sign * formula(t))
        for end, formula in (iter_profile(abs(distance), *limits) if distance else ())
    ]
    return join_pieces(codegen, parts[0], pieces, distance, text)._replace(measure=measure)


def require_constant(name: str, k: int, part: Part) -> float:
    """Return the distance (k = 0) or a limit of a profile, which must be positive. Raises Finding
    [function-arguments].
    """
    word = ("distance", *LIMITS[name])[k]
    if part.constant is None:
        message = f"the {word} of {name}() changes with time"
        raise Finding("function-arguments", message, f"use numbers and parameters: {TEXTS[name]}")
    if k and not 0.0 < part.constant < math.inf:
        message = f"the {word} of {name}() must be positive, not {part.constant:.9g}"
        raise Finding("function-arguments", message, f"a motion backwards has a negative distance: {TEXTS[name]}")
    return part.constant


def find_profile_dimension(name: str, parts: Sequence[Part]) -> MeasuredDimension:
    """Return the dimension of a profile, that of its distance. Raises Finding [wrong-dimension]."""
    time, distance, *limits = (part.measure for part in parts)
    if time.kind == "known" and time.dimension != TIME:
        raise Finding("wrong-dimension", f"takes {name} at {describe(time.dimension)}", f"write {TEXTS[name]}")
    known = [(distance, 0), *((limit, k + 1) for k, limit in enumerate(limits))]
    lengths = [
        (part.dimension[0], part.dimension[1], part.dimension[2] + k) for part, k in known if part.kind == "known"
    ]
    for word, (part, k) in zip(("distance", *LIMITS[name]), known, strict=True):
        x, y, z = lengths[0] if lengths else NUMBER
        expected: Dimension = (x, y, z - k)
        if part.kind == "known" and part.dimension != expected:
            message = f"takes {name} with {describe(part.dimension)} as the {word} over {describe(lengths[0])}"
            raise Finding("wrong-dimension", message, f"write {TEXTS[name]}")
    return MeasuredDimension("known", lengths[0], moving=True) if lengths and lengths[0] != NUMBER else FREE


def join_pieces(codegen: CodeGenerator, x: Part, pieces: Pieces, last: float, text: str) -> Part:
    """Return 0 for x < 0, then each piece up to its end, then `last`. Raises Finding [expression-limit]."""
    if len(x.code) > 2 * MAX_ARGUMENT:
        message = f"'{text}': its argument takes more than {MAX_ARGUMENT} operations, which each piece would repeat"
        raise Finding("expression-limit", message, "simplify the argument; laws within laws are rarely meant")
    x = x._replace(measure=FREE)
    variable = LawPart(codegen, x)
    joined = codegen.make_number(last, FREE)
    ends = [0.0, *(end for end, _ in pieces)]
    values = [codegen.make_number(0.0, FREE), *(formula(variable).part for _, formula in pieces)]
    for end, value in reversed(list(zip(ends, values, strict=True))):
        is_before = codegen.make_operation("lt", x, codegen.make_number(end, FREE), text=text)
        joined = codegen.make_choice(is_before, value, joined, text)
    return joined
