"""A machine as another program's file describes it, in the words of a spec: what readers fill, and spec_text.py writes.

One convention serves all formats. With every joint at the file's own zero, the axes of all bodies stand along the
world's; each body's origin stays where the file has it. So no body needs an orientation, and the angle of a pin, which
is 0 where the axes of its two bodies agree, is 0 where the file's is: in every pose, however deep the tree. What a file
gives in the axes of a part (centre of mass, inertia, points, axes of joints) its reader turns into these axes by the
attitude of the part at that zero (attitudes.py).

All numbers are SI. A remark is a line for whoever reads the spec: what it was called, what the file says that a spec
has no word for, what was repaired. It may hold foreign text; the writer makes it safe.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.models import Matrix, Vec

# What may stand behind a key of a spec: a number, a word or expression, true or false, None (null), tuples and mappings
# of these.
Value = Any
LEFT_OUT = "import-left-out"  # the code of what has no counterpart in a spec
NOTHING: Mapping[str, Any] = MappingProxyType({})


class DescribedPoint(NamedTuple):
    """A named point of a body, or of the ground: in the axes of the body [m]."""

    name: str
    place: Vec
    remark: str = ""


class DescribedEntry(NamedTuple):
    """An entry of a block (a joint, drive, stop, force, coupling), or a shape, without a name: keys as a spec has them.

    `{"type": "pin", "from": "ground.base", "to": "arm.base", "axis": (0.0, 0.0, 1.0)}`
    """

    name: str
    keys: Mapping[str, Value]
    remark: str = ""


class DescribedParameter(NamedTuple):
    """A parameter, with its value as a spec has it: a number, or a text such as `0 deg`."""

    name: str
    value: float | str
    remark: str = ""


class DescribedBody(NamedTuple):
    """A rigid body: mass [kg], centre of mass [m], inertia about it [kg m^2]; or shapes, and then none of the three.

    start: what of its pose is given, keys as a spec has them: position, orientation, near. notes: remarks beside the
    keys `mass`, `center`, `inertia`, `shapes`.
    """

    name: str
    mass: float | None
    center: Vec | None
    inertia: Matrix | None
    points: tuple[DescribedPoint, ...]
    shapes: tuple[DescribedEntry, ...] = ()
    start: Mapping[str, Value] = NOTHING
    remark: str = ""
    notes: Mapping[str, str] = NOTHING


class DescribedMachine(NamedTuple):
    """A whole machine, and where it comes from.

    form: what the file is: `URDF`; file: its name; sha256: of its bytes. told: lines at the head of the spec, behind
    that of its origin. remarks: beside the names of blocks (`parameters`, `bodies`, ...), what holds for all of it.
    left_out: what the file asks for and the spec does not say, as problems with their places: warnings, or under
    --strict an error, and comments at the head of the spec.
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
    analysis: Mapping[str, Value] = NOTHING
    told: tuple[str, ...] = ()
    remarks: Mapping[str, str] = NOTHING
    left_out: tuple[Problem, ...] = ()
