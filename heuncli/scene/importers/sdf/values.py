"""Read the values of an SDF, which stand as texts of elements: <mass>1.5</mass>.

A value is read as an attribute of its own name, so that numbers, their ranges and their faults are those of URDF.
"""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.xml_elements import XmlElement

TRUE_WORDS, FALSE_WORDS = ("true", "1"), ("false", "0")
BOOLEAN_HINT = "write true or false"


def as_attribute(part: XmlElement) -> XmlElement:
    """Return an element whose attribute of its own name is its text."""
    return XmlElement(part.tag, {part.tag: part.text}, [], part.line, part.column)


def read_values(
    part: XmlElement, path: str, fields: UrdfFields, count: int, is_length: bool = False
) -> list[float] | None:
    """Return the numbers in an element; None, and a problem, if they are wrong.

    is_length: lengths or angles, of which rounding of CAD programs is read as 0
    """
    parse = fields.parse_length if is_length else None
    return fields.read_numbers(as_attribute(part), part.tag, path, count, None, parse)


def read_child_number(
    element: XmlElement, tag: str, path: str, fields: UrdfFields, default: float | None
) -> float | None:
    """Return the number of a child element; its default where there is none; None if it is wrong."""
    part = fields.find_child(element, tag, path)
    if part is None:
        return default
    found = read_values(part, path, fields, 1)
    return None if found is None else found[0]


def read_moments(element: XmlElement, tags: Sequence[str], path: str, fields: UrdfFields) -> list[float | None]:
    """Return the moments of inertia [kg m^2]; SDF's default is 1 for those about the axes, 0 for the products."""
    moments: list[float | None] = []
    for tag in tags:
        part = fields.find_child(element, tag, path)
        default = 1.0 if tag[1] == tag[2] else 0.0
        moments.append(default if part is None else fields.read_moment(as_attribute(part), tag, path))
    return moments


def read_child_word(element: XmlElement, tag: str, path: str, fields: UrdfFields) -> str | None:
    """Return the text of a child element that must be there; None, and a problem, if it is not."""
    part = fields.find_child(element, tag, path)
    if part is not None and part.text:
        return part.text
    what = "is missing" if part is None else "is empty"
    fields.report("import-missing", part or element, path, f"<{tag}> {what}", f"write <{tag}>...</{tag}>")
    return None


def read_child_flag(element: XmlElement, tag: str, path: str, fields: UrdfFields, default: bool) -> bool:
    """Return whether a child element says true; its default where there is none."""
    part = fields.find_child(element, tag, path)
    if part is None or not part.text:
        return default
    return _read_flag(part.text, part, f"<{tag}>", path, fields)


def read_attribute_flag(part: XmlElement, name: str, path: str, fields: UrdfFields) -> bool:
    """Return whether an attribute says true."""
    text = part.attributes.get(name)
    return False if text is None else _read_flag(text.strip(), part, name, path, fields)


def _read_flag(text: str, part: XmlElement, name: str, path: str, fields: UrdfFields) -> bool:
    if text.lower() not in (*TRUE_WORDS, *FALSE_WORDS):
        fields.report("import-number", part, path, f"{name} is '{text}'", BOOLEAN_HINT)
    return text.lower() in TRUE_WORDS
