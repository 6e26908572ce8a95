"""What single entries mean, for the rules and for resolve alike: attitudes, inertia, drives, instants, points.

All but body_axes take any document that could be read, also one in which a rule will find an error.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from decimal import Decimal
from typing import Any, Literal

from heuncli.base.errors import Finding
from heuncli.base.joint_kinds import RATES, TYPES, Kind
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_shapes as fs
from heuncli.scene.file_format import models as m
from heuncli.scene.file_format import turns
from heuncli.scene.file_format.fields import EndEntry

DEFAULT_SAMPLES = 201
# what a drive may prescribe: a coordinate, or its rate of change
DRIVEN_RATES = RATES | {"length": "speed"}
DRIVEN = tuple(dict.fromkeys((*DRIVEN_RATES, *DRIVEN_RATES.values())))
Limits = tuple[float | None, float | None]
ORIENTATIONS: dict[str, tuple[str, ...]] = {
    "axis": ("axis", "angle"),
    "quaternion": ("quaternion",),
    "rodrigues": ("rodrigues",),
    "euler": ("euler", "sequence"),
    "matrix": ("matrix",),
}


def body_axes(value: fs.Orientation) -> m.Matrix:
    """The rotation an orientation means. Raises Finding."""
    given = {key for keys in ORIENTATIONS.values() for key in keys if getattr(value, key) is not None}
    forms = [name for name, keys in ORIENTATIONS.items() if given & set(keys)]
    known = "{axis, angle}, {quaternion}, {rodrigues}, {euler, sequence} or {matrix}"
    if len(forms) != 1:
        what = f"an orientation by {' and '.join(forms)}" if forms else "an empty orientation"
        raise Finding("orientation", what, f"one of {known}")
    missing = [key for key in ORIENTATIONS[forms[0]] if key not in given]
    if missing:
        hint = (
            "sequence: zyx turns about z, then the new y, then the new x"
            if missing == ["sequence"]
            else f"one of {known}"
        )
        raise Finding("orientation", f"an orientation without {missing[0]}", hint)
    if value.axis is not None and value.angle is not None:
        if not any(value.axis):
            raise Finding("orientation", "the axis is [0, 0, 0], which is no direction", "[0, 0, 1] is the z axis")
        return turns.about(value.axis, value.angle)
    if value.quaternion is not None:
        return turns.of_unit_quaternion(value.quaternion)
    if value.rodrigues is not None:
        return turns.of_rodrigues(value.rodrigues)
    if value.euler is not None:
        return turns.of_euler(value.euler, value.sequence or "")
    assert value.matrix is not None
    return turns.of_matrix(value.matrix)


def tensor(owner: f.BodyEntry | f.PieceEntry) -> m.Matrix:
    """The inertia tensor about the centre of mass: moments on the diagonal, deviation moments negated beside it."""
    inertia = owner.inertia
    if isinstance(inertia, float):  # planar: a flat body with this moment about z
        return ((0.5 * inertia, 0.0, 0.0), (0.0, 0.5 * inertia, 0.0), (0.0, 0.0, inertia))
    rows: Any = inertia
    if isinstance(rows[0], tuple):
        a, b, c = rows
        off = (0.5 * (a[1] + b[0]), 0.5 * (a[2] + c[0]), 0.5 * (b[2] + c[1]))
        return ((a[0], off[0], off[1]), (off[0], b[1], off[2]), (off[1], off[2], c[2]))
    x, y, z = rows
    a, b, c = (-d if d != 0.0 else 0.0 for d in owner.deviation or (0.0, 0.0, 0.0))
    return ((x, c, b), (c, y, a), (b, a, z))


class Driven(NamedTuple):
    """What a drive prescribes: key, the coordinate or its rate, as a value in time, and the coordinate itself."""

    key: Literal["angle", "travel", "length", "rate", "speed"]
    value: Expression
    quantity: Literal["angle", "travel", "length"]

    @property
    def by_rate(self) -> bool:
        """Whether the value is the coordinate's rate of change."""
        return self.key != self.quantity


def driven_keys(kind: Kind) -> tuple[str, ...]:
    """The keys by which a joint of this kind may be driven."""
    return (*kind.drives, *(DRIVEN_RATES[quantity] for quantity in kind.drives))


def drive_of(drive: f.DriveEntry, joint_type: str | None) -> Driven | None:
    """What a drive prescribes that prescribes one thing; joint_type: of its joint, None: unknown."""
    given = [key for key in DRIVEN if getattr(drive, key) is not None]
    if len(given) != 1:
        return None
    key = given[0]
    value = getattr(drive, key)
    if key not in DRIVEN_RATES.values():
        return Driven(key, value, key)  # type: ignore[arg-type]
    kind = TYPES.get(joint_type or "")
    of = [quantity for quantity in (kind.drives if kind is not None else ()) if DRIVEN_RATES[quantity] == key]
    return Driven(key, value, of[0]) if of else None  # type: ignore[arg-type]


def limits_of(stop: f.StopEntry) -> tuple[Literal["angle", "travel", "length"], Limits] | None:
    """Quantity and limits of a stop that limits one coordinate."""
    given: list[tuple[Literal["angle", "travel", "length"], Limits | None]] = [
        ("angle", stop.angle), ("travel", stop.travel), ("length", stop.length)
    ]  # fmt: skip
    found = [(quantity, limits) for quantity, limits in given if limits is not None]
    return found[0] if len(found) == 1 else None


class Held(NamedTuple):
    """What a latch holds: a joint's coordinate, at a value, at limits of its stop (-1 lower, 1 upper), or anywhere."""

    joint: str
    quantity: Literal["angle", "travel", "length"]
    at: float | None
    sides: tuple[int, ...]


def held_of(latch: f.LatchEntry, document: f.Document) -> Held | None:
    """What a latch holds, of one that is in order."""
    stop = document.stops.get(latch.stop or "")
    if stop is not None:
        found = limits_of(stop)
        asked = {"lower": (-1,), "upper": (1,), None: (-1, 1)}[latch.limit]
        return (
            Held(stop.joint, found[0], None, tuple(s for s in asked if found[1][s > 0] is not None)) if found else None
        )
    joint = document.joints.get(latch.joint or "")
    kind = TYPES.get(joint.type) if joint is not None else None
    if latch.joint is None or kind is None or len(fit := limitable(kind)) != 1:
        return None
    return Held(latch.joint, fit[0], getattr(latch, fit[0], None), ())


def limitable(kind: Kind) -> tuple[Literal["angle", "travel", "length"], ...]:
    """The coordinates of a kind of joint that can be limited, or held."""
    return ("length",) if kind.keeps_distance else kind.coordinates


def type_of(document: f.Document) -> Literal["motion", "impulse", "state", "rest"]:
    """What is solved, by default what the rest of the scene asks for."""
    analysis = document.analysis
    if analysis.type is not None:
        return analysis.type
    if analysis.duration is not None or analysis.times is not None:
        return "motion"
    return "impulse" if document.impulses else "state"


MOST_SAMPLES = 3_000_000  # 100 MB while a spec is read; of the least of scenes results of 200 million numbers


def instants_of(document: f.Document) -> tuple[float, ...]:
    """The instants asked for, [s]; empty where they are in error."""
    analysis = document.analysis
    if type_of(document) != "motion":
        return (0.0,)
    if analysis.times is not None:
        return tuple(analysis.times)
    count = analysis.samples if analysis.samples is not None else DEFAULT_SAMPLES
    if analysis.duration is None or not math.isfinite(analysis.duration) or not 2 <= count <= MOST_SAMPLES:
        return ()
    return (*evenly(analysis.duration, count), analysis.duration)


def evenly(duration: float, count: int) -> Iterator[float]:
    """So many evenly spaced instants but the last, of the duration as it is written.

    Each is the double nearest to its fraction, so the second of 0, 0.1, 0.2, 0.3 is that of a blow at 0.1: 0.3 * 1 / 3
    is the double before it.
    """
    numerator, denominator = Decimal(repr(duration)).as_integer_ratio()
    return (numerator * i / (denominator * (count - 1)) for i in range(count - 1))


def span_of(analysis: f.AnalysisEntry) -> float:
    """How long the run lasts [s]; 0 where there is none."""
    if analysis.times:
        return max(analysis.times)
    return analysis.duration or 0.0


def end_of(reduce_to: str | EndEntry) -> EndEntry | None:
    """The point a section is reduced to, if it is one."""
    if isinstance(reduce_to, EndEntry):
        return reduce_to
    body, dot, point = reduce_to.partition(".")
    return EndEntry.model_construct(body=body, at=point) if dot else None


def point_in(body: f.BodyEntry, at: object) -> m.Vec | None:
    """A point given by coordinates or by name, in body axes."""
    return body.points.get(at) if isinstance(at, str) else at  # type: ignore[return-value]
