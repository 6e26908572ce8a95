"""Read numbers and words from elements of a URDF, and collect what is wrong with them, with locations."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Iterator, Sequence

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SourceLocation
from heuncli.base.spelling import suggest
from heuncli.base.units import is_in_range, range_error
from heuncli.scene.file_format.models import Vec
from heuncli.scene.importers.attitudes import RIGHT_ANGLE_ERROR
from heuncli.scene.importers.xml_elements import XACRO_HINT, XmlElement

NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?\Z")
NOT_FINITE = re.compile(r"[+-]?(?:nan|inf(?:inity)?)\Z", re.IGNORECASE)
COUNT_TEXTS = {1: "a number", 3: "three numbers", 6: "six numbers", 7: "seven numbers"}
SIMILARITY_THRESHOLD = 0.8  # difflib ratio: uppr is a typo of upper, gear_velocity none of velocity
CANCELLATION_ERROR = (
    1e-20  # [m, rad] smaller values are rounding of CAD programs; times a mass, their squares would underflow
)
NEARLY_RIGHT_ANGLE = 1e-3  # [rad] 1.57 is closer to a right angle than this; angles that are meant differently are not


class UrdfFields:
    """Reads the elements of one file. Errors are added to `problems`, and reading goes on."""

    def __init__(self, file: str, repair_right_angles: bool = False) -> None:
        """repair_right_angles: read angles that are nearly right angles as right angles"""
        self.file, self.repair_right_angles = file, repair_right_angles
        self.problems: list[Problem] = []
        self.left_out: list[Problem] = []  # features without a counterpart in a spec
        self.nearly_right_angled: dict[str, None] = {}  # paths of elements with nearly right angles
        self.turned_axes: dict[str, None] = {}  # joints whose axis has an rpy other than 0
        self.links_without_inertia: dict[str, None] = {}  # links with mass 0 whose inertia is left out

    def read_angles(self, rpy: Vec, path: str) -> Vec:
        """Return angles [rad]. Nearly right angles are recorded, and made right angles if that repair is on."""
        roll, pitch, yaw = (self._read_angle(angle, path) for angle in rpy)
        return roll, pitch, yaw

    def _read_angle(self, angle: float, path: str) -> float:
        right_angle = round(angle / (math.pi / 2.0)) * (math.pi / 2.0)
        if not RIGHT_ANGLE_ERROR < abs(angle - right_angle) < NEARLY_RIGHT_ANGLE:
            return angle
        self.nearly_right_angled[path] = None
        return right_angle if self.repair_right_angles else angle

    def make_problem(self, code: str, element: XmlElement, path: str, message: str, hint: str) -> Problem:
        """Make a problem at the start of an element. path: the part to which it belongs, such as `link arm`."""
        return Problem(code, message, SourceLocation(self.file, element.line, element.column, path), hint)

    def report(self, code: str, element: XmlElement, path: str, message: str, hint: str) -> None:
        """Add a problem."""
        self.problems.append(self.make_problem(code, element, path, message, hint))

    def find_child(self, element: XmlElement, tag: str, path: str) -> XmlElement | None:
        """Return the child element of a tag that may occur once."""
        children = element.find_all(tag)
        if len(children) > 1:
            message = f"<{tag}> occurs {len(children)} times, first in line {children[0].line}"
            self.report("import-twice", children[1], path, message, "keep one of them")
        return children[0] if children else None

    def report_unknown_attributes(self, element: XmlElement, path: str, *names: str) -> None:
        """Report attributes that are not read: they might change the meaning of the others."""
        for name in element.attributes:
            if name not in names and ":" not in name:  # with a prefix it belongs to another program
                message = f"<{element.tag}> has an unknown attribute {name}"
                hint = f"known attributes: {', '.join(names)}"
                self.report("import-attribute", element, path, message, hint)

    def report_unknown_parts(self, element: XmlElement, path: str, *tags: str) -> None:
        """Report child elements that are not read: each might change the meaning of the element."""
        for part in element.children:
            if part.tag not in tags and ":" not in part.tag:  # with a prefix it is of another program
                message = f"<{element.tag}> has an unknown part <{part.tag}>"
                self.report("import-part", part, path, message, suggest(part.tag, tags, "parts"))

    def report_misspelt(self, element: XmlElement, path: str, *names: str) -> None:
        """Report attributes that resemble a known one that is missing. Other attributes belong to other programs."""
        for name, suggestion in find_misspelt(element.attributes, names):
            message = f"<{element.tag}> has an unknown attribute {name}"
            self.report("import-attribute", element, path, message, f"did you mean {suggestion}?")

    def read_word(self, element: XmlElement, name: str, path: str) -> str | None:
        """Return the text of an attribute that must be present and not empty."""
        text = element.attributes.get(name)
        if text is None or not text.strip():
            what = "is missing" if text is None else "is empty"
            message = f"the attribute {name} of <{element.tag}> {what}"
            self.report("import-missing", element, path, message, f'write <{element.tag} {name}="...">')
            return None
        return text

    def read_number(self, element: XmlElement, name: str, path: str, default: float | None = None) -> float | None:
        """Return the number of an attribute; None if it is wrong, or missing without a default."""
        found = self.read_numbers(element, name, path, 1, None if default is None else (default,))
        return None if found is None else found[0]

    def read_moment(self, element: XmlElement, name: str, path: str) -> float | None:
        """Return a moment of inertia. Anything below LEAST_MAGNITUDE is 0."""
        found = self.read_numbers(element, name, path, 1, None, self._parse_moment)
        return None if found is None else found[0]

    def read_vector(self, element: XmlElement | None, name: str, path: str, default: Vec) -> Vec | None:
        """Return the three numbers of an attribute; None if they are wrong. Anything below CANCELLATION_ERROR is 0."""
        if element is None:
            return default
        found = self.read_numbers(element, name, path, 3, default, self.parse_length)
        return None if found is None else (found[0], found[1], found[2])

    def read_numbers(
        self,
        element: XmlElement,
        name: str,
        path: str,
        count: int,
        default: Sequence[float] | None,
        parse: Callable[[XmlElement, str, str, str], float | None] | None = None,
    ) -> list[float] | None:
        """Return the numbers of an attribute, each parsed by `parse`; None if they are wrong, or missing without a
        default.
        """
        text = element.attributes.get(name)
        if text is None:
            if default is not None:
                return list(default)
            self.read_word(element, name, path)
            return None
        words = text.split()
        if len(words) != count:
            message = f'{name}="{text}" of <{element.tag}>: expected {COUNT_TEXTS[count]}, found {len(words)}'
            self.report("import-number", element, path, message, suggest_number_fix(text))
            return None
        values = [(parse or self.parse_number)(element, name, path, word) for word in words]
        return None if None in values else [parse for parse in values if parse is not None]

    def parse_number(self, element: XmlElement, name: str, path: str, word: str) -> float | None:
        """Parse one word; None, and a problem, if it is no number that heun can compute with."""
        if not NUMBER.match(word):
            what = "not a finite number" if NOT_FINITE.match(word) else "not a number"
            message = f'{name}="{element.attributes[name]}" of <{element.tag}>: {word} is {what}'
            self.report("import-number", element, path, message, suggest_number_fix(word))
            return None
        value = float(word)
        if not math.isfinite(value) or not is_in_range(value):
            found = range_error(value)
            message = f"{name} of <{element.tag}>: {found.message}"
            self.report("import-number", element, path, message, found.hint)
            return None
        return value

    def parse_length(self, element: XmlElement, name: str, path: str, word: str) -> float | None:
        """Parse a length, an angle or a component of a direction."""
        is_tiny = NUMBER.match(word) is not None and abs(float(word)) < CANCELLATION_ERROR
        return 0.0 if is_tiny else self.parse_number(element, name, path, word)

    def _parse_moment(self, element: XmlElement, name: str, path: str, word: str) -> float | None:
        is_tiny = NUMBER.match(word) is not None and abs(float(word)) < tolerances.LEAST_MAGNITUDE
        return 0.0 if is_tiny else self.parse_number(element, name, path, word)


def find_misspelt(names: Collection[str], known_names: Collection[str]) -> Iterator[tuple[str, str]]:
    """Yield each unknown name with the known name that it resembles, unless that is present, too."""
    others = [name for name in names if name not in known_names]
    if not others:
        return
    from difflib import get_close_matches  # few files need it

    for name in others:
        for suggestion in get_close_matches(name, known_names, 1, SIMILARITY_THRESHOLD):
            if suggestion not in names:
                yield name, suggestion


def suggest_number_fix(text: str) -> str:
    """Suggest what to do about a text that is no number."""
    if "${" in text or "$(" in text:
        return XACRO_HINT
    if NOT_FINITE.match(text):
        return "the exporting program may have divided by 0: correct the value in its source"
    if "," in text:
        return "separate numbers by spaces and use decimal points: 0.1 0 0"
    return "write plain numbers in SI units, e.g. 0.1 or 1e-3"
