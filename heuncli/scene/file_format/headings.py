"""Parse column headings with or without a unit after the name: n [rpm], F (kN), L/mm, s in mm, F_kN, case.

In brackets, anything is a unit. After a slash, a comma, "in", an underscore or a blank, a word is a unit only if it
cannot mean anything else: `x_min`, `force_in`, `x/l` and `p_bar` may also be a minimum, an input, a ratio, a mean.
"""

from __future__ import annotations

import re
from contextlib import suppress
from functools import lru_cache

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.units import HINTS, NAMES, NUMBER, SPELLINGS, UNITS, Dimension, correct_unit, parse_unit

SIMPLE_HEADING = re.compile(r"(?P<name>[^\[\]/]*?)\s*(?:\[(?P<in>[^\[\]]*)\]|/(?P<over>.*))?\Z", re.DOTALL)
IN_BRACKETS = re.compile(
    r"(?P<name>.*?)[\s_,/]*(?:\[(?P<square>[^\[\]]*)\]|\((?P<round>(?:[^()]|\([^()]*\))*)\))(?P<rest>[^()\[\]]*)\Z",
    re.DOTALL,
)
SEPARATOR = re.compile(r"\s*/\s*|\s*,\s*|\s+in\s+|\s+-\s+|\s*:\s*|_|\s+")  # separates a name from its unit
MAX_UNIT_WORDS = 2  # words of a unit after a name: N m
# Texts that mean "no unit".
NO_UNIT = frozenset({"", "-", "–", "1", "/", "none", "no unit", "dimensionless"})
# Ambiguous units: these are never accepted without x_unit or y_unit ...
TWO_MEANINGS = {
    "g": "a gram, or the acceleration of gravity",
    "G": "the acceleration of gravity, or gauss",
    "t": "a tonne, or the time",
    "lb": "pound mass (lb) or pound force (lbf)",
    **dict.fromkeys(("1/min", "min-1", "min^-1", "1/s", "s-1", "s^-1", "Hz"), "revolutions, or radians"),
}
# ... and these not after an underscore, a comma or a blank, where they may be part of the name.
ALSO_WORDS = frozenset({*TWO_MEANINGS, "min", "in", "rev", "turn", "bar", "us"})
SYMBOLS_OF_VOLUME = ("L/", "l/")  # L/mm is a length in mm
LONG_FORMS = {  # long names of units in headings, in lower case
    "secs": "s", "sek": "s", "sekunden": "s", "milliseconds": "ms", "millisecond": "ms", "microseconds": "us",
    "minutes": "min", "mins": "min", "hours": "h", "hrs": "h", "hr": "h", "meters": "m", "metres": "m",
    "millimeters": "mm", "millimetres": "mm", "millimeter": "mm", "millimetre": "mm", "centimeters": "cm",
    "centimetres": "cm", "centimeter": "cm", "centimetre": "cm", "kilometers": "km", "kilometres": "km",
    "inches": "in", "feet": "ft", "foot": "ft", "newtons": "N", "kilonewtons": "kN", "kilonewton": "kN",
    "kilograms": "kg", "grams": "g", "gram": "g", "pascal": "Pa", "pascals": "Pa", "kilopascal": "kPa",
    "megapascal": "MPa", "watt": "W", "watts": "W", "joule": "J", "joules": "J", "revolutions": "rev", "turns": "rev",
    "degs": "deg",
}  # fmt: skip
JOINED_UNITS = re.compile(r"(?<=[A-Za-z])[-.](?=[A-Za-z])")  # N-m, N.m
POUND_AMONG_OTHERS = re.compile(r"\blb\W|\Wlb\b")  # a ft-lb is a torque, a lb/ft^3 a density
MIN_CAPITALS = 3  # letters that a unit in capitals has at least: RPM, PSI; MM may mean another unit


class HeadingUnit(NamedTuple):
    """The unit that a heading states.

    name: the heading without the unit
    text: the unit as written
    size, dimension: in SI; None if the word is not a known unit, is ambiguous, or means no unit
    meanings: the possible meanings of an ambiguous word, else empty
    is_certain: whether the word is certainly meant as a unit, as in brackets
    """

    name: str
    text: str
    size: float | None
    dimension: Dimension | None
    meanings: str = ""
    is_certain: bool = True


def split_heading(text: str) -> tuple[str, str]:
    """Split a heading into name and unit; the unit is empty if there is none. A word in [] or after / counts as a
    unit.
    """
    unit = find_heading_unit(text)
    if unit is not None and unit.size is not None:
        return unit.name, unit.text
    parts = SIMPLE_HEADING.match(text)
    if parts is None or "(" in text:
        return text.strip(), ""
    return parts["name"].strip(), (parts["in"] or parts["over"] or "").strip()


def name_in_heading(text: str) -> str:
    """Return the name of a column without the unit in its heading."""
    unit = find_heading_unit(text)
    return unit.name if unit is not None else text.strip()


def name_before_letter(text: str) -> str:
    """Return the name of a column before an SI unit of one letter: t of `t / s`, which may also be a ratio.

    A heading that is a unit itself, as m/s, is its own name.
    """
    for joint in SEPARATOR.finditer(text):
        name, word = text[: joint.start()].strip(), text[joint.end() :].strip()
        if (
            joint[0].strip() in ("/", ",", "in")
            and len(word) == 1
            and name
            and parse_heading_unit(text.strip()) is None
        ):
            unit = parse_heading_unit(word)
            return name if unit is not None and unit[0] == 1.0 else text.strip()
    return text.strip()


@lru_cache(maxsize=1000)
def find_heading_unit(text: str) -> HeadingUnit | None:
    """Return the unit that a heading states, or None."""
    parts = IN_BRACKETS.match(text)
    if parts is not None:
        return _find_bracketed_unit(parts)
    whole = text.strip()
    if len(whole) > 1 and whole not in ALSO_WORDS and (unit := parse_heading_unit(whole)) is not None:
        if whole[1] != "/":
            return HeadingUnit(whole, whole, *unit)
        if unit[1] in NAMES and unit[1] != NUMBER and not whole.startswith(SYMBOLS_OF_VOLUME):
            denominator = parse_heading_unit(whole[2:])
            if denominator is None or denominator[0] == unit[0]:
                return None  # m/s: a unit, or m in s; both are in SI
            return HeadingUnit(whole, whole, None, None, f"the unit {whole}, or {whole[0]} in {whole[2:]}", False)
    candidates = (_find_trailing_unit(text[: joint.start()].strip(), joint[0].strip(), text[joint.end() :].strip())
             for joint in SEPARATOR.finditer(text))  # fmt: skip
    return next((unit for unit in candidates if unit is not None), None)


def _find_bracketed_unit(parts: re.Match[str]) -> HeadingUnit | None:
    """Return the unit in brackets if the brackets end the heading or hold a known unit."""
    name, word = parts["name"].strip(), (parts["square"] or parts["round"] or "").strip()
    if word.lower() in NO_UNIT:
        return HeadingUnit(name, word, 1.0, None)
    if word in TWO_MEANINGS:
        return HeadingUnit(name, word, None, None, TWO_MEANINGS[word])
    found = parse_heading_unit(word)
    if found is None:
        return HeadingUnit(name, word, None, None) if not parts["rest"].strip() else None
    return HeadingUnit(name, word, *found)


def _find_trailing_unit(name: str, separator: str, word: str) -> HeadingUnit | None:
    """Return the unit after a name, if the word is a unit or may be one.

    separator: the characters between name and word
    """
    if not name or not (word[:1].isalpha() or word[:1] in ("°", "(") or word in TWO_MEANINGS):
        return None  # "Load cell 1 / kN" is not in 1/kN
    if len(word.split()) > MAX_UNIT_WORDS:
        return None
    unit, is_joined = parse_heading_unit(word), separator in ("/", "in")
    is_letter = len(word) == 1 and word != "°"
    if is_letter and (not is_joined or (unit is not None and unit[0] == 1.0)):
        return None  # an index, as in F_t; or an SI unit, which changes nothing
    meanings = TWO_MEANINGS.get(word, "")
    if not meanings and ((word in ALSO_WORDS and not is_joined) or (is_letter and separator == "/")):
        meanings = f"the unit {word}, or a part of the name"
    if meanings:
        return HeadingUnit(name, word, None, None, meanings, is_certain=separator == "in") if separator else None
    if unit is not None:
        return HeadingUnit(name, word, *unit)
    return HeadingUnit(name, word, None, None, is_certain=False) if word in HINTS and separator else None


def parse_heading_unit(word: str) -> tuple[float, Dimension] | None:
    """Return SI size and dimension of a unit as headings spell it; None if it is not a unit or is ambiguous."""
    if POUND_AMONG_OTHERS.search(word):
        return None
    lower = word.lower()
    long_form = LONG_FORMS.get(lower) or SPELLINGS.get(lower)
    in_capitals = lower if len(word) >= MIN_CAPITALS and (lower in UNITS or word.title() in UNITS) else None
    for spelling in (
        SPELLINGS.get(word, word),
        correct_unit(word),
        long_form,
        in_capitals,
        JOINED_UNITS.sub("*", word),
    ):
        if spelling is None:
            continue
        with suppress(Finding):
            return parse_unit(spelling)
    return None
