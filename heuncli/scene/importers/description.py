"""A machine described by another program's file, in the terms of a spec. Readers fill it in, spec_text.py writes it.

One convention serves all formats. With every joint at the file's own zero, the axes of all bodies are parallel to the
world's, and each body keeps the origin that the file gives it. So no body needs an orientation, and a pin angle, which
is 0 where the axes of its two bodies agree, is 0 where the file's angle is 0. This holds in every pose, however deep
the tree. The reader rotates what a file gives in the axes of a part (centre of mass, inertia, points, joint axes) into
these axes, by the attitude of the part at that zero (attitudes.py).

All numbers are SI. A remark is one comment line for the reader of the spec: the name in the file, data that a spec
cannot hold, a repair. It may hold foreign text; the writer escapes it.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import Matrix, Vec

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
