"""Display units of tables in place of SI units: MPa by default, and those of `--units kN,mm,deg,rpm`.

Results are SI throughout; a number and its error are converted before its digits are counted. Units of forces and
lengths also apply to their products: with kN and mm moments are in kN·mm, velocities in mm/s; with deg angular
velocities are in deg/s. Each of these can be chosen separately (kNm, m/s, rpm). Seconds stay. In figures and in the
report for a client a unit that nobody chose follows from the size of the number: mm or m, N, kN or MN.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from heuncli.base.errors import Finding, Problem, UsageError
from heuncli.base.named_tuples import NamedTuple

DisplayUnit = tuple[str, float]  # a unit, and how many of it make one SI unit
STRESS: Mapping[str, DisplayUnit] = MappingProxyType({"Pa": ("MPa", 1e-6)})
# SI unit of results -> its format, and the units that it is made of; seconds are not converted.
DERIVED: Mapping[str, tuple[str, tuple[str, ...]]] = MappingProxyType({
    "N·m": ("{}·{}", ("N", "m")), "N·s": ("{}·s", ("N",)), "N·m·s": ("{}·{}·s", ("N", "m")),
    "m/s": ("{}/s", ("m",)), "m/s²": ("{}/s²", ("m",)), "rad/s": ("{}/s", ("rad",)), "rad/s²": ("{}/s²", ("rad",)),
})  # fmt: skip
SHOWN = {"m", "rad", "N", "Pa", "W", *DERIVED}  # SI units of what tables show
SPELLINGS = {"Nm": "N·m", "kNm": "kN·m", "Nmm": "N·mm", "Ns": "N·s", "Nms": "N·m·s"}
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
HINT = (
    "for example --units kN,mm,deg,rpm; any unit of a length, angle, force, moment, stress, ... that heun explain "
    "format lists"
)


class Units(NamedTuple):
    """The display units of tables for SI units of the results, where these differ."""

    display_units: Mapping[str, DisplayUnit] = STRESS

    def find(self, unit: str) -> DisplayUnit:
        """Return the display unit of an SI unit, and how many of it make one."""
        return self.display_units.get(unit, (unit, 1.0))

    def is_chosen(self, unit: str) -> bool:
        """Return whether the user chose the display unit of an SI unit, or one from which it is derived."""
        return unit in self.display_units and self.display_units[unit] != STRESS.get(unit)


def choose_prefix(unit: str, scale: float) -> tuple[str, float]:
    """Return the largest display unit in which `scale` (SI) is at least 1, and how many of it make one SI unit."""
    fitting = [row for row in PREFIXES[unit] if row[1] * scale >= FULL_UNIT]
    return fitting[-1] if fitting else PREFIXES[unit][0]


def parse_units(words: str) -> Units:
    """Parse the display units of `--units kN,mm,deg`. Raises Finding."""
    chosen_units: dict[str, DisplayUnit] = {}
    for word in (part.strip() for part in words.split(",")):
        unit, per_si = find_si_unit(word)
        if unit in chosen_units:
            raise Finding(
                "bad-option",
                f"{chosen_units[unit][0]} and {word} are units of the same quantity: {describe_unit(unit)}",
                "give only one",
            )
        chosen_units[unit] = SPELLINGS.get(word, spell_unit(word)), per_si
    return Units(
        {**STRESS, **{unit: shown for unit in DERIVED if (shown := derive_unit(unit, chosen_units))}, **chosen_units}
    )


def derive_unit(unit: str, chosen_units: Mapping[str, DisplayUnit]) -> DisplayUnit | None:
    """Derive the display unit of an SI unit from the chosen ones; None if none of these applies."""
    form, parts = DERIVED[unit]
    if not chosen_units.keys() & set(parts):
        return None
    names, per_si = [], 1.0
    for part in parts:
        name, factor = chosen_units.get(part, (part, 1.0))
        names.append(name)
        per_si *= factor
    return form.format(*names), per_si


def find_si_unit(word: str) -> tuple[str, float]:
    """Return the SI unit of the results that a unit replaces, and how many of it make one. Raises Finding."""
    from heuncli.base import units  # where units are asked for

    if not word:
        raise Finding("bad-option", "expected units, with commas between them", HINT)
    size, dimension = units.parse_unit(word)
    if dimension == units.TIME:
        raise Finding("bad-option", f"{word}: times stay in s", "as for --at")
    if dimension == units.MOMENT and set("JW") & set(word):
        return "J", 1.0 / size
    unit = spell_unit(units.si_unit(dimension))
    if unit not in SHOWN:
        raise Finding("bad-option", f"{word}: tables show no {units.describe(dimension).partition(' ')[2]}", HINT)
    return unit, 1.0 / size


def describe_unit(unit: str) -> str:
    """Say what is measured in an SI unit, in words."""
    from heuncli.base import units

    return "an energy" if unit == "J" else units.describe(units.parse_unit(unit)[1])


def spell_unit(word: str) -> str:
    """Return a unit as tables write it."""
    for typed, written in (("**", "^"), ("*", "·"), (" ", "·"), ("^2", "²"), ("^3", "³")):
        word = word.replace(typed, written)
    return word


def read_display_units(option: str, words: str | None) -> Units:
    """Return the display units that replace SI units, from words such as `kN,mm`. Raises UsageError."""
    if words is None:
        return Units()
    try:
        return parse_units(words)
    except Finding as finding:
        raise UsageError(Problem("bad-option", f"{option} {words}: {finding.message}", hint=finding.hint)) from None
