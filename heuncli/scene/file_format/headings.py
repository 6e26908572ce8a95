"""Headings of columns, with a unit behind the name or without: n [rpm], F (kN), L/mm, s in mm, F_kN, case.

A unit in brackets is one by its form. Behind a stroke, a comma, "in", an underscore or a blank it is one only if the
word can mean nothing else: `x_min`, `force_in`, `x/l` and `p_bar` may as well be a minimum, an input, a ratio, a mean.
"""

from __future__ import annotations

import re
from contextlib import suppress
from functools import lru_cache

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.units import HINTS, NAMES, NUMBER, SPELLINGS, UNITS, Dimension, parse_unit, spelled

HEAD = re.compile(r"(?P<name>[^\[\]/]*?)\s*(?:\[(?P<in>[^\[\]]*)\]|/(?P<over>.*))?\Z", re.DOTALL)
IN_BRACKETS = re.compile(
    r"(?P<name>.*?)[\s_,/]*(?:\[(?P<square>[^\[\]]*)\]|\((?P<round>(?:[^()]|\([^()]*\))*)\))(?P<rest>[^()\[\]]*)\Z",
    re.DOTALL,
)
JOINT = re.compile(r"\s*/\s*|\s*,\s*|\s+in\s+|\s+-\s+|\s*:\s*|_|\s+")  # between a name and the unit behind it
MOST_WORDS = 2  # of a unit behind a name: N m
# Signs for what has no unit.
NO_UNIT = frozenset({"", "-", "–", "1", "/", "none", "no unit", "dimensionless"})
# Units that mean something else as well: these are never taken for certain ...
TWO_MEANINGS = {
    "g": "a gram, or the acceleration of gravity",
    "G": "the acceleration of gravity, or gauss",
    "t": "a tonne, or the time",
    "lb": "a pound as a mass, or as a force (lbf)",
    **dict.fromkeys(("1/min", "min-1", "min^-1", "1/s", "s-1", "s^-1", "Hz"), "revolutions, or radians"),
}
# ... and these not behind an underscore, a comma or a blank, where they may be a part of the name.
ALSO_WORDS = frozenset({*TWO_MEANINGS, "min", "in", "rev", "turn", "bar", "us"})
SYMBOLS_OF_VOLUME = ("L/", "l/")  # L/mm is a length in mm
LONG_FORMS = {  # of units, as programs write them out in headings; looked up in lower case
    "secs": "s", "sek": "s", "sekunden": "s", "milliseconds": "ms", "millisecond": "ms", "microseconds": "us",
    "minutes": "min", "mins": "min", "hours": "h", "hrs": "h", "hr": "h", "meters": "m", "metres": "m",
    "millimeters": "mm", "millimetres": "mm", "millimeter": "mm", "millimetre": "mm", "centimeters": "cm",
    "centimetres": "cm", "centimeter": "cm", "centimetre": "cm", "kilometers": "km", "kilometres": "km",
    "inches": "in", "feet": "ft", "foot": "ft", "newtons": "N", "kilonewtons": "kN", "kilonewton": "kN",
    "kilograms": "kg", "grams": "g", "gram": "g", "pascal": "Pa", "pascals": "Pa", "kilopascal": "kPa",
    "megapascal": "MPa", "watt": "W", "watts": "W", "joule": "J", "joules": "J", "revolutions": "rev", "turns": "rev",
    "degs": "deg",
}  # fmt: skip
JOINED = re.compile(r"(?<=[A-Za-z])[-.](?=[A-Za-z])")  # N-m, N.m
POUND_AMONG_OTHERS = re.compile(r"\blb\W|\Wlb\b")  # a ft-lb is a torque, a lb/ft^3 a density
SHORTEST_CAPITALS = 3  # letters of a unit that is known in capitals, too: RPM, PSI; not MM, which may be another one


class HeadingUnit(NamedTuple):
    """What a heading says of its column's unit.

    name: the heading without it. text: the unit as it stands there. size in SI, dimension: None where the word is no
    unit that heun knows, has two meanings, or stands for none. meanings: of a word that has two, in words; else empty.
    is_certain: whether it is meant as a unit, as what stands in brackets.
    """

    name: str
    text: str
    size: float | None
    dimension: Dimension | None
    meanings: str = ""
    is_certain: bool = True


def heading(text: str) -> tuple[str, str]:
    """The name and the unit of a column; empty where there is none. What stands in [] or behind / is taken for one."""
    stated = unit_in_heading(text)
    if stated is not None and stated.size is not None:
        return stated.name, stated.text
    parts = HEAD.match(text)
    if parts is None or "(" in text:
        return text.strip(), ""
    return parts["name"].strip(), (parts["in"] or parts["over"] or "").strip()


def name_in_heading(text: str) -> str:
    """The name of a column without the unit that its heading states."""
    stated = unit_in_heading(text)
    return stated.name if stated is not None else text.strip()


@lru_cache(maxsize=1000)
def unit_in_heading(text: str) -> HeadingUnit | None:
    """The unit that a heading states; None where it states none."""
    parts = IN_BRACKETS.match(text)
    if parts is not None:
        return _in_brackets(parts)
    whole = text.strip()
    if len(whole) > 1 and whole not in ALSO_WORDS and (unit := parsed(whole)) is not None:
        if whole[1] != "/":
            return HeadingUnit(whole, whole, *unit)
        if unit[1] in NAMES and unit[1] != NUMBER and not whole.startswith(SYMBOLS_OF_VOLUME):
            below = parsed(whole[2:])
            if below is None or below[0] == unit[0]:
                return None  # m/s: in SI whichever of both it is
            return HeadingUnit(whole, whole, None, None, f"the unit {whole}, or {whole[0]} in {whole[2:]}", False)
    found = (_behind_name(text[: joint.start()].strip(), joint[0].strip(), text[joint.end() :].strip())
             for joint in JOINT.finditer(text))  # fmt: skip
    return next((unit for unit in found if unit is not None), None)


def _in_brackets(parts: re.Match[str]) -> HeadingUnit | None:
    """What stands in brackets, if it is the end of a heading or a unit that is known."""
    name, word = parts["name"].strip(), (parts["square"] or parts["round"] or "").strip()
    if word.lower() in NO_UNIT:
        return HeadingUnit(name, word, 1.0, None)
    if word in TWO_MEANINGS:
        return HeadingUnit(name, word, None, None, TWO_MEANINGS[word])
    found = parsed(word)
    if found is None:
        return HeadingUnit(name, word, None, None) if not parts["rest"].strip() else None
    return HeadingUnit(name, word, *found)


def _behind_name(name: str, joint: str, word: str) -> HeadingUnit | None:
    """What stands behind a name, if it is a unit or may be one. joint: what stands between them."""
    if not name or not (word[:1].isalpha() or word[:1] in ("°", "(") or word in TWO_MEANINGS):
        return None  # "Load cell 1 / kN" is not in 1/kN
    if len(word.split()) > MOST_WORDS:
        return None
    unit, is_joined = parsed(word), joint in ("/", "in")
    is_letter = len(word) == 1 and word != "°"
    if is_letter and (not is_joined or (unit is not None and unit[0] == 1.0)):
        return None  # an index, as in F_t, or in SI as without it
    meanings = TWO_MEANINGS.get(word, "")
    if not meanings and ((word in ALSO_WORDS and not is_joined) or (is_letter and joint == "/")):
        meanings = f"the unit {word}, or a part of the name"
    if meanings:
        return HeadingUnit(name, word, None, None, meanings, is_certain=joint == "in") if joint else None
    if unit is not None:
        return HeadingUnit(name, word, *unit)
    return HeadingUnit(name, word, None, None, is_certain=False) if word in HINTS and joint else None


def parsed(word: str) -> tuple[float, Dimension] | None:
    """Size in SI and dimension of a unit as headings write it; None where it is none, or one of two meanings."""
    if POUND_AMONG_OTHERS.search(word):
        return None
    lower = word.lower()
    long_form = LONG_FORMS.get(lower) or SPELLINGS.get(lower)
    in_capitals = lower if len(word) >= SHORTEST_CAPITALS and (lower in UNITS or word.title() in UNITS) else None
    for spelling in (SPELLINGS.get(word, word), spelled(word), long_form, in_capitals, JOINED.sub("*", word)):
        if spelling is None:
            continue
        with suppress(Finding):
            return parse_unit(spelling)
    return None
