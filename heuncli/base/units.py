"""Units, the size in SI and the dimension of "12 mm" and "7850 kg/m^3", and the range of magnitudes that heun accepts.

A dimension is the exponents of (kg, m, s). Angles are numbers: rad = 1, so that N m/rad is N m and rpm an angular
velocity. Hz is left out on purpose: as a rate half of the readers would take it for rad/s.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache
from math import inf, pi
from typing import TYPE_CHECKING

from heuncli.base import tolerances
from heuncli.base.errors import Finding
from heuncli.base.spelling import find_similar

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Mask = NDArray[np.bool_]

Dimension = tuple[int, int, int]

NUMBER: Dimension = (0, 0, 0)
MASS: Dimension = (1, 0, 0)
LENGTH: Dimension = (0, 1, 0)
TIME: Dimension = (0, 0, 1)
AREA: Dimension = (0, 2, 0)
VOLUME: Dimension = (0, 3, 0)
AREA_MOMENT: Dimension = (0, 4, 0)
RATE: Dimension = (0, 0, -1)
VELOCITY: Dimension = (0, 1, -1)
ACCELERATION: Dimension = (0, 1, -2)
INERTIA: Dimension = (1, 2, 0)
DENSITY: Dimension = (1, -3, 0)
LINE_DENSITY: Dimension = (1, -1, 0)
FORCE: Dimension = (1, 1, -2)
MOMENT: Dimension = (1, 2, -2)
IMPULSE: Dimension = (1, 1, -1)
ANGULAR_IMPULSE: Dimension = (1, 2, -1)
STIFFNESS: Dimension = (1, 0, -2)
DAMPING: Dimension = (1, 0, -1)
PRESSURE: Dimension = (1, -1, -2)
POWER: Dimension = (1, 2, -3)
ANGLE = NUMBER
LINE_FORCE = STIFFNESS
TURNING_STIFFNESS = MOMENT
TURNING_DAMPING = ANGULAR_IMPULSE

NAMES: dict[Dimension, tuple[str, str]] = {  # what a value of the dimension is called, and its SI unit
    NUMBER: ("an angle or a plain number", "rad"),
    MASS: ("a mass", "kg"),
    LENGTH: ("a length", "m"),
    TIME: ("a time", "s"),
    AREA: ("an area", "m^2"),
    VOLUME: ("a volume", "m^3"),
    AREA_MOMENT: ("a second moment of area", "m^4"),
    RATE: ("an angular velocity", "rad/s"),
    VELOCITY: ("a velocity", "m/s"),
    ACCELERATION: ("an acceleration", "m/s^2"),
    INERTIA: ("a moment of inertia", "kg*m^2"),
    DENSITY: ("a density", "kg/m^3"),
    LINE_DENSITY: ("a mass per length", "kg/m"),
    FORCE: ("a force", "N"),
    MOMENT: ("a moment", "N*m"),
    IMPULSE: ("an impulse", "N*s"),
    ANGULAR_IMPULSE: ("a moment of an impulse", "N*m*s"),
    STIFFNESS: ("a stiffness or force per length", "N/m"),
    DAMPING: ("a damping coefficient", "N*s/m"),
    PRESSURE: ("a pressure", "Pa"),
    POWER: ("a power", "W"),
    (0, 0, -2): ("an angular acceleration", "rad/s^2"),
}

POUND = 0.45359237  # kg, international pound, by definition (1959)
STANDARD_GRAVITY = 9.80665  # m/s^2, by definition (CGPM 1901)

UNITS: dict[str, tuple[float, Dimension]] = {
    "kg": (1.0, MASS),
    "g": (1e-3, MASS),
    "mg": (1e-6, MASS),
    "tonne": (1e3, MASS),
    "lb": (POUND, MASS),
    "m": (1.0, LENGTH),
    "km": (1e3, LENGTH),
    "dm": (1e-1, LENGTH),
    "cm": (1e-2, LENGTH),
    "mm": (1e-3, LENGTH),
    "um": (1e-6, LENGTH),
    "in": (0.0254, LENGTH),
    "ft": (0.3048, LENGTH),
    "l": (1e-3, VOLUME),
    "s": (1.0, TIME),
    "ms": (1e-3, TIME),
    "us": (1e-6, TIME),
    "min": (60.0, TIME),
    "h": (3600.0, TIME),
    "rad": (1.0, NUMBER),
    "mrad": (1e-3, NUMBER),
    "deg": (pi / 180.0, NUMBER),
    "rev": (2.0 * pi, NUMBER),
    "rpm": (2.0 * pi / 60.0, RATE),
    "N": (1.0, FORCE),
    "mN": (1e-3, FORCE),
    "daN": (1e1, FORCE),
    "kN": (1e3, FORCE),
    "MN": (1e6, FORCE),
    "gf": (1e-3 * STANDARD_GRAVITY, FORCE),
    "kgf": (STANDARD_GRAVITY, FORCE),
    "lbf": (POUND * STANDARD_GRAVITY, FORCE),
    "Nm": (1.0, MOMENT),
    "kNm": (1e3, MOMENT),
    "Nmm": (1e-3, MOMENT),
    "Ns": (1.0, IMPULSE),
    "Nms": (1.0, ANGULAR_IMPULSE),
    "J": (1.0, MOMENT),
    "kJ": (1e3, MOMENT),
    "W": (1.0, POWER),
    "kW": (1e3, POWER),
    "Pa": (1.0, PRESSURE),
    "hPa": (1e2, PRESSURE),
    "kPa": (1e3, PRESSURE),
    "MPa": (1e6, PRESSURE),
    "GPa": (1e9, PRESSURE),
    "mbar": (1e2, PRESSURE),
    "bar": (1e5, PRESSURE),
    "psi": (POUND * STANDARD_GRAVITY / 0.0254**2, PRESSURE),
}
SPELLINGS = {
    "°": "deg", "degree": "deg", "degrees": "deg", "radian": "rad", "radians": "rad", "µm": "um", "μm": "um",
    "µs": "us", "μs": "us", "sec": "s", "second": "s", "seconds": "s", "minute": "min", "hour": "h", "meter": "m",
    "metre": "m", "inch": "in", "U/min": "rpm", "L": "l", "newton": "N", "kilogram": "kg", "turn": "rev",
    "kp": "kgf",
}  # fmt: skip
HINTS = {
    "Hz": "as an angular velocity write 2*pi*50 for 50 revolutions per second, or 3000 rpm",
    "t": "a thousand kilograms are '1 tonne'; t is the time: write 2*t for a multiple of it",
    "grad": "write degrees as deg",
    "Grad": "write degrees as deg",
}

TOKEN = re.compile(r"\s*(?:(\*\*|[*·⋅×/^()])|([+-]?\d+)|([^\W\d_²³⁴]+|°)|([²³⁴]))")
SUPERSCRIPTS = {"²": 2, "³": 3, "⁴": 4}


def describe(dimension: Dimension) -> str:
    """Describe a dimension in words, such as 'a length', or by its SI unit where no word is known."""
    if dimension in NAMES:
        return NAMES[dimension][0]
    return f"a quantity in {si_unit(dimension)}"


def si_unit(dimension: Dimension) -> str:
    """Return the SI unit of a dimension, as it may be written in a spec."""
    if dimension in NAMES:
        return NAMES[dimension][1]
    powers = [(base, power) for base, power in zip(("kg", "m", "s"), dimension, strict=True) if power]
    return "*".join(base if power == 1 else f"{base}^{power}" for base, power in powers)


def canonical_symbol(symbol: str) -> str:
    """Return the canonical symbol of a unit: deg for degrees; unknown spellings are returned unchanged."""
    return SPELLINGS.get(symbol, symbol)


def unit_place_hint(symbol: str) -> str | None:
    """Return the hint where a unit stands in an expression; None if the word is no unit."""
    return f"a unit stands right after a number: 20 {symbol}" if canonical_symbol(symbol) in UNITS else None


def correct_unit(unit: str) -> str | None:
    """Return a unit such as kgm2, kg*m2, g/cm3 or kgm^2 in the accepted spelling; None if there is none, or it is
    unchanged.
    """
    powers = re.sub(r"(?<=[^\W\d])([2-4])(?!\w)", r"^\1", re.sub(r"\bkgm(?=\b|\d)", "kg*m", unit))
    try:
        parse_unit(powers)
    except Finding:
        return None
    return powers if powers != unit else None


@lru_cache(maxsize=1000)
def parse_unit(text: str) -> tuple[float, Dimension]:
    """Return the size in SI and the dimension of a unit such as 'kg/m^3', 'N m', 'N/(m/s)'. Raises Finding."""
    reader = _UnitReader(text)
    try:
        size, dimension = reader.read_product()
        if not 0.0 < size < inf:
            raise ArithmeticError
    except ArithmeticError:  # powers of powers: larger or smaller than any double
        hint = "write the power as a small whole number, as in m^2"
        raise Finding("unknown-unit", f"'{text}' is not a unit: its size is out of number range", hint) from None
    if reader.token is not None:
        raise Finding("unknown-unit", f"'{text}' is not a unit: unexpected '{reader.token}'", FORM)
    return size, dimension


FORM = "units are joined by *, / or a space, with whole powers: kg/m^3, N*m, N/(m/s)"


class _UnitReader:
    """Reads a unit from left to right: factors with whole powers, joined by *, / or a space."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = self.iter_tokens(text)
        self.depth = 0
        self.advance()

    def iter_tokens(self, text: str) -> Iterator[str]:
        """Yield the tokens of a unit. Raises Finding."""
        position, text = 0, text.rstrip()
        while position < len(text):
            match = TOKEN.match(text, position)
            if match is None:
                message = f"'{text}' is not a unit: unexpected '{text[position:].strip()[0]}'"
                raise Finding("unknown-unit", message, FORM)
            position = match.end()
            yield match[0].strip()

    def advance(self) -> None:
        """Go to the next token."""
        self.token = next(self.tokens, None)

    def read_product(self) -> tuple[float, Dimension]:
        """Read factors up to the end or a closing parenthesis."""
        size, dimension = self.read_power()
        while self.token is not None and self.token != ")":
            sign = 1
            if self.token in ("*", "·", "⋅", "×", "/"):
                sign = -1 if self.token == "/" else 1
                self.advance()
            factor, other = self.read_power()
            size = size * factor if sign == 1 else size / factor
            dimension = (dimension[0] + sign * other[0], dimension[1] + sign * other[1], dimension[2] + sign * other[2])
        return size, dimension

    def read_power(self) -> tuple[float, Dimension]:
        """Read a factor and its power."""
        size, dimension = self.read_factor()
        exponent = 1
        if self.token in ("^", "**"):
            self.advance()
            if self.token is None or not self.token.lstrip("+-").isdecimal() or len(self.token) > 2:
                message = f"'{self.text}' is not a unit: a power must be a small whole number"
                raise Finding("unknown-unit", message, "as in m^2")
            exponent = int(self.token)
            self.advance()
        elif self.token in SUPERSCRIPTS:
            exponent = SUPERSCRIPTS[self.token]
            self.advance()
        elif self.token is not None and self.token.lstrip("+-").isdecimal():
            raise Finding(
                "unknown-unit", f"'{self.text}' is not a unit: unexpected '{self.token}'", "write a power as m^2"
            )
        return size**exponent, (dimension[0] * exponent, dimension[1] * exponent, dimension[2] * exponent)

    def read_factor(self) -> tuple[float, Dimension]:
        """Read a symbol, 1, or a product in parentheses."""
        token = self.token
        self.advance()
        if token == "(" and self.depth < 8:
            self.depth += 1
            size, dimension = self.read_product()
            if self.token != ")":
                raise Finding("unknown-unit", f"'{self.text}' is not a unit: a parenthesis is not closed", FORM)
            self.advance()
            self.depth -= 1
            return size, dimension
        if token == "1":  # as in 1/s
            return 1.0, NUMBER
        symbol = SPELLINGS.get(token or "", token)
        if symbol in UNITS:
            return UNITS[symbol]
        if token is None:
            raise Finding("unknown-unit", f"'{self.text}' is not a unit: it ends too early", FORM)
        if not token[0].isalpha():
            raise Finding("unknown-unit", f"'{self.text}' is not a unit: unexpected '{token}'", FORM)
        raise Finding("unknown-unit", f"'{token}' is not a unit", HINTS.get(token) or suggest_unit(token))


def suggest_unit(symbol: str) -> str:
    """Return a hint that names the most similar unit, or the common ones."""
    similar = find_similar(symbol, UNITS, SPELLINGS)
    if similar is not None:
        return f"did you mean {canonical_symbol(similar)}?"
    return (
        "known units: kg, g, m, mm, s, ms, rad, deg, rpm, N, kN, Pa, bar, ... and products such as N*m, kg/m^3, m/s^2"
    )


ACCEPTED = f"0, or {tolerances.LEAST_MAGNITUDE:.0e} to {tolerances.MOST_MAGNITUDE:.0e} in SI units".replace("+", "")
TOO_SMALL = "check its unit; for zero write 0"
TOO_LARGE = "check its unit; for no limit leave the entry out"


def is_in_range(value: float) -> bool:
    """Return whether a number is 0 or of a magnitude that arithmetic can handle; nan and inf are not."""
    return value == 0.0 or tolerances.LEAST_MAGNITUDE <= abs(value) <= tolerances.MOST_MAGNITUDE


def are_in_range(values: Array) -> Mask:
    """Return where `is_in_range` holds, as an array of the same shape."""
    sizes = abs(values)
    fits: Mask = (values == 0.0) | ((sizes >= tolerances.LEAST_MAGNITUDE) & (sizes <= tolerances.MOST_MAGNITUDE))
    return fits


def range_error(value: float, what: str = "") -> Finding:
    """Return the error for a number out of range; what: the name of a computed number that is not written in the
    spec.
    """
    is_small = abs(value) < 1.0
    subject = f"{what} is {value:g}, " if what else f"{value:g} is "
    message = f"{subject}too {'small' if is_small else 'large'} for the computation; accepted: {ACCEPTED}"
    return Finding("magnitude", message, TOO_SMALL if is_small else TOO_LARGE)
