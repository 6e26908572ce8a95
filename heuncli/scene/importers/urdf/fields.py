"""What elements of a URDF hold: numbers, words, and what is wrong with them, gathered with its places."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Iterator, Sequence

from heuncli.base.errors import Problem, SourceLocation
from heuncli.base.nearest import did_you_mean
from heuncli.base.number_range import is_in_range, out_of_range
from heuncli.scene.file_format.models import Vec
from heuncli.scene.importers.attitudes import RIGHT
from heuncli.scene.importers.xml_elements import XACRO, XmlElement

NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?\Z")
NOT_FINITE = re.compile(r"[+-]?(?:nan|inf(?:inity)?)\Z", re.IGNORECASE)
COUNTS = {1: "a number", 3: "three numbers"}
ALIKE = 0.8  # share of letters: uppr is meant as upper, gear_velocity not as velocity
CANCELLED = 1e-20  # [m, rad] less is what CAD programs leave of what cancels out; a mass times its square is no number
NEARLY_RIGHT = 1e-3  # [rad] 1.57 is nearer to a right angle, and what is meant to be another is farther


class UrdfFields:
    """Reads elements of one file; what is wrong with them is added to `problems`, and reading goes on."""

    def __init__(self, file: str, to_right: bool = False) -> None:
        """to_right: angles that are nearly right ones are taken for right ones."""
        self.file, self.to_right = file, to_right
        self.problems: list[Problem] = []
        self.left_out: list[Problem] = []  # what has no counterpart
        self.nearly_right: dict[str, None] = {}  # whose angles are
        self.emptied: dict[str, None] = {}  # links of no mass whose inertia is left out

    def angles(self, rpy: Vec, path: str) -> Vec:
        """Angles [rad]; those that are nearly right ones are noted, and taken for right ones if that was asked for."""
        roll, pitch, yaw = (self._angle(angle, path) for angle in rpy)
        return roll, pitch, yaw

    def _angle(self, angle: float, path: str) -> float:
        right = round(angle / (math.pi / 2.0)) * (math.pi / 2.0)
        if not RIGHT < abs(angle - right) < NEARLY_RIGHT:
            return angle
        self.nearly_right[path] = None
        return right if self.to_right else angle

    def problem(self, code: str, element: XmlElement, path: str, message: str, hint: str) -> Problem:
        """A problem at the start of an element; path: whose it is, such as `link arm`."""
        return Problem(code, message, SourceLocation(self.file, element.line, element.column, path), hint)

    def report(self, code: str, element: XmlElement, path: str, message: str, hint: str) -> None:
        """Add a problem."""
        self.problems.append(self.problem(code, element, path, message, hint))

    def one(self, element: XmlElement, tag: str, path: str) -> XmlElement | None:
        """The element of a tag that may stand in it once."""
        found = element.all(tag)
        if len(found) > 1:
            message = f"<{tag}> is given {len(found)} times, first in line {found[0].line}"
            self.report("import-twice", found[1], path, message, "keep one of them")
        return found[0] if found else None

    def known(self, element: XmlElement, path: str, *names: str) -> None:
        """Report attributes that are not read: they would say something of the number beside them."""
        for name in element.attributes:
            if name not in names and ":" not in name:  # with a prefix it is of another program
                message = f"<{element.tag}> has the attribute {name}, which is not read"
                hint = f"read are: {', '.join(names)}"
                self.report("import-attribute", element, path, message, hint)

    def known_parts(self, element: XmlElement, path: str, *tags: str) -> None:
        """Report elements in it that are not read: each would say something of it."""
        for part in element.inner:
            if part.tag not in tags and ":" not in part.tag:  # with a prefix it is of another program
                message = f"<{element.tag}> has a part <{part.tag}>, which is not read"
                self.report("import-part", part, path, message, did_you_mean(part.tag, tags, "parts"))

    def misspelt(self, element: XmlElement, path: str, *names: str) -> None:
        """Report attributes that are like one that is read, and not there: others are of other programs."""
        for name, meant in alike(element.attributes, names):
            message = f"<{element.tag}> has the attribute {name}, which is not read"
            self.report("import-attribute", element, path, message, f"did you mean {meant}?")

    def word(self, element: XmlElement, name: str, path: str) -> str | None:
        """The text of an attribute that must be there and hold something."""
        text = element.attributes.get(name)
        if text is None or not text.strip():
            what = "is missing" if text is None else "is empty"
            message = f"the attribute {name} of <{element.tag}> {what}"
            self.report("import-missing", element, path, message, f'as <{element.tag} {name}="...">')
            return None
        return text

    def number(self, element: XmlElement, name: str, path: str, default: float | None = None) -> float | None:
        """The number of an attribute; None where it is wrong, or missing without a default."""
        found = self.numbers(element, name, path, 1, None if default is None else (default,))
        return None if found is None else found[0]

    def vector(self, element: XmlElement | None, name: str, path: str, default: Vec) -> Vec | None:
        """The three numbers of an attribute; None where they are wrong. What is less than CANCELLED is 0."""
        if element is None:
            return default
        found = self.numbers(element, name, path, 3, default, self._length)
        return None if found is None else (found[0], found[1], found[2])

    def numbers(
        self,
        element: XmlElement,
        name: str,
        path: str,
        count: int,
        default: Sequence[float] | None,
        value: Callable[[XmlElement, str, str, str], float | None] | None = None,
    ) -> list[float] | None:
        """The numbers of an attribute, each by `value`; None where they are wrong, or missing without a default."""
        text = element.attributes.get(name)
        if text is None:
            if default is not None:
                return list(default)
            self.word(element, name, path)
            return None
        words = text.split()
        if len(words) != count:
            message = f'{name}="{text}" of <{element.tag}>: expected {COUNTS[count]}, found {len(words)}'
            self.report("import-number", element, path, message, hint_for(text))
            return None
        values = [(value or self.value)(element, name, path, word) for word in words]
        return None if None in values else [value for value in values if value is not None]

    def value(self, element: XmlElement, name: str, path: str, word: str) -> float | None:
        """The value of one word; None, and a problem, where it is no number that can be computed with."""
        if not NUMBER.match(word):
            what = "not a finite number" if NOT_FINITE.match(word) else "not a number"
            message = f'{name}="{element.attributes[name]}" of <{element.tag}>: {word} is {what}'
            self.report("import-number", element, path, message, hint_for(word))
            return None
        value = float(word)
        if not math.isfinite(value) or not is_in_range(value):
            found = out_of_range(value)
            message = f"{name} of <{element.tag}>: {found.message}"
            self.report("import-number", element, path, message, found.hint)
            return None
        return value

    def _length(self, element: XmlElement, name: str, path: str, word: str) -> float | None:
        """A length, an angle or part of a direction."""
        tiny = NUMBER.match(word) is not None and abs(float(word)) < CANCELLED
        return 0.0 if tiny else self.value(element, name, path, word)


def alike(given: Collection[str], known: Collection[str]) -> Iterator[tuple[str, str]]:
    """What is given and not known, with the known name that it is like, if that is not given, too."""
    others = [name for name in given if name not in known]
    if not others:
        return
    from difflib import get_close_matches  # which few files need

    for name in others:
        for meant in get_close_matches(name, known, 1, ALIKE):
            if meant not in given:
                yield name, meant


def hint_for(text: str) -> str:
    """What to do about what is no number."""
    if "${" in text or "$(" in text:
        return XACRO
    if NOT_FINITE.match(text):
        return "the program that wrote it divided by 0: its source needs the number"
    if "," in text:
        return "numbers stand apart by spaces, with points in them: 0.1 0 0"
    return "plain numbers in SI units, as 0.1 or 1e-3"
