"""A machine described by another program's file: its parts, its names, the options of the import, and its comments.

Readers fill it in, spec_text.py writes it.

One convention serves all formats. With every joint at the file's own zero, the axes of all bodies are parallel to the
world's, and each body keeps the origin that the file gives it. So no body needs an orientation, and a pin angle, which
is 0 where the axes of its two bodies agree, is 0 where the file's angle is 0. This holds in every pose, however deep
the tree. The reader rotates what a file gives in the axes of a part (centre of mass, inertia, points, joint axes) into
these axes, by the attitude of the part at that zero (attitudes.py).

All numbers are SI. A remark is one comment line for the reader of the spec: the name in the file, data that a spec
cannot hold, a repair. It may hold foreign text; the writer escapes it.

`ModelReader.options` says which options of `heun import` a format supports.

A spec name is a letter, then letters, digits and _, unique and not reserved. A valid name, in any script, stays as it
is. In others, invalid characters become _, and a number is appended where two names would be equal.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from heuncli.base.errors import Finding, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.expressions.scope import RESERVED
from heuncli.scene.file_format.labels import LABEL, check_plain_text
from heuncli.scene.file_format.loads import Matrix
from heuncli.scene.file_format.models import Vec
from heuncli.scene.file_format.names import CAUSE_NAMES, GROUND, is_name
from heuncli.scene.file_format.source import WORD_VALUES

# Description

# The value of a key of a spec: a number, a word or expression, true or false, None (null), tuples and mappings of
# these.
SpecValue = Any
LEFT_OUT_CODE = "import-left-out"  # problem code of a feature without a counterpart in a spec
EMPTY_MAPPING: Mapping[str, Any] = MappingProxyType({})


class DescribedPoint(NamedTuple):
    """A named point of a body or of the ground; its place is given in the body's axes [m]."""

    name: str
    place: Vec
    remark: str = ""


class DescribedEntry(NamedTuple):
    """An entry of a block (joint, drive, stop, force, coupling), or a shape, which has no name. Its keys are those of a
    spec.

    `{"type": "pin", "from": "ground.base", "to": "arm.base", "axis": (0.0, 0.0, 1.0)}`
    """

    name: str
    keys: Mapping[str, SpecValue]
    remark: str = ""


class DescribedParameter(NamedTuple):
    """A parameter with its value as a spec has it: a number, or a text such as `0 deg`."""

    name: str
    value: float | str
    remark: str = ""


class DescribedBody(NamedTuple):
    """A rigid body, with mass properties or with shapes.

    mass: [kg]; None with shapes
    center: centre of mass [m]; None with shapes
    inertia: about the centre of mass [kg m^2]; None with shapes
    start: the given part of its start pose, keys as in a spec: position, orientation, near
    notes: remarks on the keys `mass`, `center`, `inertia`, `shapes`
    """

    name: str
    mass: float | None
    center: Vec | None
    inertia: Matrix | None
    points: tuple[DescribedPoint, ...]
    shapes: tuple[DescribedEntry, ...] = ()
    start: Mapping[str, SpecValue] = EMPTY_MAPPING
    remark: str = ""
    notes: Mapping[str, str] = EMPTY_MAPPING


class DescribedMachine(NamedTuple):
    """A whole machine and its origin.

    form: the format of the file, such as `URDF`
    file: the name of the file
    sha256: the hash of its bytes
    header_lines: lines at the head of the spec
    remarks: general remarks by block name (`parameters`, `bodies`, ...)
    left_out: features of the file that the spec cannot hold, as problems with their locations. They become warnings
    (errors with --strict) and comments at the head of the spec.
    """

    title: str
    form: str
    file: str
    sha256: str
    gravity: Vec
    bodies: tuple[DescribedBody, ...]
    ground: tuple[DescribedPoint, ...] = ()
    parameters: tuple[DescribedParameter, ...] = ()
    joints: tuple[DescribedEntry, ...] = ()
    drives: tuple[DescribedEntry, ...] = ()
    forces: tuple[DescribedEntry, ...] = ()
    stops: tuple[DescribedEntry, ...] = ()
    couplings: tuple[DescribedEntry, ...] = ()
    analysis: Mapping[str, SpecValue] = EMPTY_MAPPING
    header_lines: tuple[str, ...] = ()
    remarks: Mapping[str, str] = EMPTY_MAPPING
    left_out: tuple[Problem, ...] = ()


# Import options


class ImportOptions(NamedTuple):
    """The options of one import.

    free: leave the joints free instead of holding them by drives
    base_free: let the root move instead of fixing it to the ground
    limits: turn joint limits into stops
    density: density of the shapes of links without inertia [kg/m^3]
    repair: the faults to repair, names from `ModelReader.repairs`
    keyframe: the pose in the file to start from
    model: the name of the model in a file with several
    """

    free: bool = False
    base_free: bool = False
    limits: bool = False
    density: float | None = None
    repair: frozenset[str] = frozenset()
    keyframe: str | None = None
    model: str | None = None


# Names

MAX_NAME_LENGTH = 80  # characters; longer names are unreadable in tables
INVALID_CHARACTERS = re.compile(r"\W+")
# Names that no entry may have, in any block, as a joint's name is also used for its parameter and its drive.
RESERVED_WORDS = RESERVED | CAUSE_NAMES | {GROUND, *(word for word in WORD_VALUES if word)}
NUMBER_WORDS = frozenset({"inf", "infinity", "nan"})  # words that float() accepts, in upper or lower case


class Namer:
    """Assigns unique names within one scope: the bodies, the joints, or the points of one body."""

    def __init__(self, kind: str) -> None:
        """kind: the word used where a text yields no valid name: `link`, `joint`"""
        self.kind = kind
        self.used_names: set[str] = set()
        self.count: dict[str, int] = {}

    def assign(self, original: str) -> str:
        """Assign a name like the original that is not assigned yet."""
        base = name = clean_name(original, self.kind)
        while name in self.used_names:
            self.count[base] = self.count.get(base, 1) + 1
            name = f"{base}_{self.count[base]}"
        self.used_names.add(name)
        return name


def assign_names(kind: str, originals: Sequence[str]) -> list[str]:
    """Assign unique names in order. Originals that are valid names stay as they are, even if another is cleaned to the
    same name.
    """
    namer = Namer(kind)
    unchanged = {text for text in originals if clean_name(text, kind) == text}
    namer.used_names |= unchanged
    names: list[str] = []
    for text in originals:
        names.append(text if text in unchanged else namer.assign(text))
        unchanged.discard(text)  # only the first of two equal names keeps it
    return names


def clean_name(original: str, kind: str) -> str:
    """Turn a text into a valid spec name."""
    # NFKC unifies letters that look alike, as in Python's names and in expressions
    text = INVALID_CHARACTERS.sub("_", unicodedata.normalize("NFKC", original)).strip("_")[:MAX_NAME_LENGTH]
    if not is_name(text):  # it begins with a digit, is empty, or still holds an invalid character
        text = f"{kind}_{''.join(letter for letter in text if is_name(f'a{letter}'))}".rstrip("_")
    return f"{text}_1" if text in RESERVED_WORDS or text.lower() in NUMBER_WORDS else text


def format_original_name(kind: str, name: str, original: str) -> str:
    """Make the remark for an entry that is renamed: `link "panda-link1"`. Empty if the name is the file's."""
    return "" if name == original else f'{kind} "{original}"'


def make_label(name: str, original: str) -> dict[str, SpecValue]:
    """Return the key `label` with the name in the file for an entry that is renamed; none for what no label can be."""
    if name == original:
        return {}
    try:
        return {LABEL: check_plain_text(original)}
    except Finding:
        return {}


# Usage comments


def explain_motion(parameter: str, example_value: str, *, free: bool, at_rest: bool) -> tuple[str, ...]:
    """Return comment lines on how to move the joints.

    parameter: the parameter of the first joint
    example_value: a value for it
    at_rest: whether free joints start at rest
    """
    pose = f'--set {parameter}="{example_value}"'
    if free:
        start = "start at rest" if at_rest else "start"
        return (f"The joints are free, and {start} at the values of their parameters ({pose}).",)
    return (
        f"Drives hold the joints at the values of their parameters ({pose}); their loads are reported as drive.",
        "For a motion, replace the parameter in a drive by a function of time: 0.5*sin(2*t).",
    )
