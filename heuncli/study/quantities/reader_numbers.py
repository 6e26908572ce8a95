"""Numbers for a reader: four significant digits of a family's largest, a unit by size, an error only where it shows.

Tables of `heun run` show as many digits as are certain (study/quantities/digits.py). Summaries, reports, pictures and
pages show what a reader compares: 24.39 kN.
"""

from __future__ import annotations

import math

from heuncli.base.named_tuples import NamedTuple
from heuncli.study.quantities.digits import OPEN, UNKNOWN
from heuncli.study.quantities.table_units import Units

DIGITS = 4
# SI unit -> the units that replace it by size, each with how many of it make one; the first is the smallest.
PREFIXES: dict[str, tuple[tuple[str, float], ...]] = {
    "N": (("N", 1.0), ("kN", 1e-3), ("MN", 1e-6)),
    "N·m": (("N·m", 1.0), ("kN·m", 1e-3), ("MN·m", 1e-6)),
    "Pa": (("Pa", 1.0), ("kPa", 1e-3), ("MPa", 1e-6)),
    "m": (("mm", 1e3), ("m", 1.0)),
    "W": (("W", 1.0), ("kW", 1e-3), ("MW", 1e-6)),
    "J": (("J", 1.0), ("kJ", 1e-3), ("MJ", 1e-6)),
}
FULL_UNIT = 1.0  # the smallest size at which a unit is used


class ReaderStyle(NamedTuple):
    """How the numbers of one family are written for a reader.

    unit: display unit; size: how many of it make one SI unit
    decimals: of fixed numbers
    error: of the numbers, in the display unit
    """

    unit: str
    size: float
    decimals: int
    error: float = 0.0

    def write(self, value: float) -> str:
        """Format an SI number in the display unit, with U+2212 as minus; 0 below the last decimal."""
        shown = self.size * value
        if math.isnan(shown):
            return OPEN
        if abs(shown) < 0.5 * 10.0**-self.decimals:
            return "0"
        if self.error >= abs(shown):
            return UNKNOWN
        return f"{shown:.{max(self.decimals, 0)}f}".replace("-", "−")

    def write_with_error(self, value: float) -> str:
        """Format an SI number, and its error where this reaches the last decimal."""
        text = self.write(value)
        if self.error < 0.5 * 10.0**-self.decimals or text in (OPEN, UNKNOWN, "0"):
            return text
        return f"{text} ± {self.error:.{max(self.decimals, 0)}f}"


def choose_reader_style(unit: str, scale: float, units: Units, error: float = 0.0) -> ReaderStyle:
    """Choose how a family of numbers is written.

    unit: SI unit; scale: the largest magnitude, SI; error: of the numbers, SI
    units: a unit that the user chose stays; another is chosen by size
    """
    shown_unit, size = units.find(unit)
    if unit in PREFIXES and not units.is_chosen(unit):
        shown_unit, size = choose_prefix(unit, scale)
    shown = size * scale
    digits = DIGITS - 1 - math.floor(math.log10(shown)) if math.isfinite(shown) and shown > 0.0 else 0
    return ReaderStyle(shown_unit, size, max(digits, 0), size * error)


def choose_prefix(unit: str, scale: float) -> tuple[str, float]:
    """Return the largest display unit in which `scale` (SI) is at least 1, and how many of it make one SI unit."""
    fitting = [row for row in PREFIXES[unit] if row[1] * scale >= FULL_UNIT]
    return fitting[-1] if fitting else PREFIXES[unit][0]
