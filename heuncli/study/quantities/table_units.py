"""Units that tables show in place of those of the results: MPa, and what `--units kN,mm,deg,rpm` asks for.

Results are SI throughout; a number is turned into the unit shown before its digits are counted, and its error with it.
What is asked for of forces and lengths holds of their products, too: with kN and mm moments are in kN·mm, velocities
in mm/s; with deg angular velocities are in deg/s. Each may be asked for by itself (kNm, m/s, rpm). Seconds stay.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple

Shown = tuple[str, float]  # a unit, and how many of it make one SI unit
STRESS: Mapping[str, Shown] = MappingProxyType({"Pa": ("MPa", 1e-6)})
# SI unit of results -> the units that it is made of, with their powers; seconds are told as they are.
DERIVED: Mapping[str, tuple[str, tuple[str, ...]]] = MappingProxyType({
    "N·m": ("{}·{}", ("N", "m")), "N·s": ("{}·s", ("N",)), "N·m·s": ("{}·{}·s", ("N", "m")),
    "m/s": ("{}/s", ("m",)), "m/s²": ("{}/s²", ("m",)), "rad/s": ("{}/s", ("rad",)), "rad/s²": ("{}/s²", ("rad",)),
})  # fmt: skip
SPELLED = {"Nm": "N·m", "kNm": "kN·m", "Nmm": "N·mm", "Ns": "N·s", "Nms": "N·m·s"}
KNOWN = (
    "such as --units kN,mm,deg,rpm; any unit of a length, angle, force, moment, stress, ... that heun explain format "
    "lists"
)


class Units(NamedTuple):
    """The units that tables show for SI units of the results, where these are others."""

    shown: Mapping[str, Shown] = STRESS

    def of(self, unit: str) -> Shown:
        """What stands for an SI unit, and how many of it are one."""
        return self.shown.get(unit, (unit, 1.0))


def asked(words: str) -> Units:
    """The units that `--units kN,mm,deg` asks for. Raises Finding."""
    own: dict[str, Shown] = {}
    for word in (part.strip() for part in words.split(",")):
        unit, size = quantity_of(word)
        if unit in own:
            raise Finding("bad-option", f"{own[unit][0]} and {word} stand for the same: {named(unit)}", "keep one")
        own[unit] = SPELLED.get(word, spelled(word)), size
    return Units({**STRESS, **{unit: shown for unit in DERIVED if (shown := derived(unit, own))}, **own})


def derived(unit: str, own: Mapping[str, Shown]) -> Shown | None:
    """What follows for a unit from those asked for; None where nothing does."""
    form, parts = DERIVED[unit]
    if not own.keys() & set(parts):
        return None
    shown, size = [], 1.0
    for part in parts:
        name, of_it = own.get(part, (part, 1.0))
        shown.append(name)
        size *= of_it
    return form.format(*shown), size


def quantity_of(word: str) -> tuple[str, float]:
    """The SI unit of the results that a unit stands for, and how many of it make one. Raises Finding."""
    from heuncli.base import units  # where units are asked for

    if not word:
        raise Finding("bad-option", "expected units, with commas between them", KNOWN)
    size, dimension = units.parse_unit(word)
    known = {
        units.LENGTH: "m", units.NUMBER: "rad", units.RATE: "rad/s", units.VELOCITY: "m/s", units.ACCELERATION: "m/s²",
        (0, 0, -2): "rad/s²", units.FORCE: "N", units.MOMENT: "J" if set("JW") & set(word) else "N·m",
        units.IMPULSE: "N·s", units.ANGULAR_IMPULSE: "N·m·s", units.PRESSURE: "Pa", units.POWER: "W",
    }  # fmt: skip
    if dimension == units.TIME:
        raise Finding("bad-option", f"{word}: instants stay in s", "as those of --at")
    if dimension not in known:
        raise Finding("bad-option", f"{word}: tables show no {units.describe(dimension).partition(' ')[2]}", KNOWN)
    return known[dimension], 1.0 / size


def named(unit: str) -> str:
    """What is measured in an SI unit, in words."""
    from heuncli.base import units

    return "an energy" if unit == "J" else units.describe(units.parse_unit(unit)[1])


def spelled(word: str) -> str:
    """A unit as tables write it."""
    for typed, written in (("**", "^"), ("*", "·"), (" ", "·"), ("^2", "²"), ("^3", "³")):
        word = word.replace(typed, written)
    return word
