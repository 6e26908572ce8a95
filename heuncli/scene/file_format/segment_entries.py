"""One segment of a cam or a drive, as a user writes it, and what may be wrong with it alone.

A segment is a rise by a motion law, or a dwell. It ends at `to` (counted from the start of the first segment) or lasts
`for` so long; `rise` is the change of the coordinate, `at` its value at the end. A law with limits of rate and
acceleration needs neither `to` nor `for`: it takes the shortest time that its limits permit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from heuncli.base import units as u
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import suggest
from heuncli.scene.expressions.motion_laws import LIMITS
from heuncli.scene.expressions.motion_segments import LAW_NAMES
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format.entries import Entry, key
from heuncli.scene.file_format.fields import Angle, Either, Time

END_FIELDS = {"to": "to", "for": "for_", "dwell": "dwell"}  # key -> field
LIMIT_KEYS = ("rate", "acceleration", "jerk")  # the k-th limits the derivative of order k + 1


class SegmentEntry(Entry):
    """A part of a motion: a rise by a law, or a dwell."""

    rise: Either | None = None
    at: Either | None = None
    law: str | None = None


class CamSegmentEntry(SegmentEntry):
    """A segment over the angle of a cam disc [rad]."""

    to: Angle | None = None
    for_: Angle | None = key(alias="for", default=None)
    dwell: Angle | None = None


class DriveSegmentEntry(SegmentEntry):
    """A segment over time [s].

    rate, acceleration, jerk: limits, each in the unit of the coordinate per s, s² or s³
    """

    to: Time | None = None
    for_: Time | None = key(alias="for", default=None)
    dwell: Time | None = None
    rate: Either | None = None
    acceleration: Either | None = None
    jerk: Either | None = None


class SegmentProblem(NamedTuple):
    """A problem of a segment: its place below the cam or drive, message and hint."""

    place: tuple[str | int, ...]
    message: str
    hint: str


def read_constant(value: Expression | None) -> float:
    """Return the number of a segment's key, or 0 if the key is absent.

    It is never a function: the reader of the spec refuses time and coordinates there (fields.py DependentNumber).
    """
    if value is None:
        return 0.0
    assert value.constant is not None
    return value.constant


def has_limits(entry: SegmentEntry) -> bool:
    """Return whether limits determine the duration of a segment."""
    return any(getattr(entry, name, None) is not None for name in LIMIT_KEYS)


def find_rise(entry: SegmentEntry, value: float) -> float:
    """Return by how much a segment that begins at `value` changes the coordinate [m or rad]."""
    return read_constant(entry.rise) if entry.at is None else read_constant(entry.at) - value


def find_end_keys(entry: SegmentEntry) -> list[str]:
    """Find the keys by which a segment states its end."""
    return [name for name, field in END_FIELDS.items() if getattr(entry, field) is not None]


def iter_entry_problems(
    place: tuple[str | int, ...], entry: SegmentEntry, dimension: u.Dimension
) -> Iterator[SegmentProblem]:
    """Yield the problems of one segment of a coordinate of a dimension, whatever stands before it."""
    end_keys = find_end_keys(entry)
    limited = [name for name in LIMIT_KEYS if getattr(entry, name, None) is not None]
    changes = [name for name in ("rise", "at") if getattr(entry, name) is not None]
    if len(end_keys) != 1 and not (limited and not end_keys):
        message = f"the segment has {' and '.join(end_keys)}" if end_keys else "the segment has no end"
        yield SegmentProblem(place, message, "give one of: to (where it ends), for (how long it is), dwell")
        return
    if end_keys == ["dwell"]:
        for name in (*changes, *limited, *(["law"] if entry.law is not None else [])):
            yield SegmentProblem((*place, name), f"{name} given for a dwell", "a dwell has no other keys")
        return
    if len(changes) != 1:
        message = "both rise and at are given" if changes else "'rise' is missing"
        yield SegmentProblem(place, message, "rise: by how much it changes; or at: the value at its end; or dwell")
    values = {name: getattr(entry, name) for name in changes}
    yield from iter_wrong_dimensions(place, values, dict.fromkeys(changes, dimension))
    yield from _iter_law_problems(place, entry, end_keys, limited, dimension)


def _iter_law_problems(
    place: tuple[str | int, ...], entry: SegmentEntry, end_keys: list[str], limited: list[str], dimension: u.Dimension
) -> Iterator[SegmentProblem]:
    """Yield the problems of the law and the limits of a segment that is not a dwell."""
    known = f"one of {', '.join(LAW_NAMES)}"
    if entry.law is None:
        if entry.rise is None or entry.rise.constant != 0.0:
            yield SegmentProblem(place, "'law' is missing", known)
        return
    if entry.law not in LAW_NAMES:
        yield SegmentProblem((*place, "law"), f"unknown law '{entry.law}'", suggest(entry.law, LAW_NAMES, "laws"))
        return
    if entry.law == "scurve" and isinstance(entry, CamSegmentEntry):
        yield SegmentProblem((*place, "law"), "scurve is for drives alone", known)
        return
    needed = LIMITS.get(entry.law, ())
    if surplus := [name for name in limited if name not in needed]:
        message = f"{entry.law} takes no {surplus[0]}"
        yield SegmentProblem((*place, surplus[0]), message, "it fills its segment: leave it out")
        return
    if limited or entry.law == "scurve":
        missing = [name for name in needed if name not in limited]
        if missing:
            yield SegmentProblem(place, f"{entry.law} has no {missing[0]}", f"give {', '.join(needed)}")
        elif end_keys:
            message = f"{end_keys[0]} given, but the limits decide how long it takes"
            hint = "leave it out, and add a dwell; or use a law without limits"
            yield SegmentProblem((*place, end_keys[0]), message, hint)
    mass, length, time = dimension
    values = {name: getattr(entry, name) for name in limited}
    dimensions = {name: (mass, length, time - 1 - LIMIT_KEYS.index(name)) for name in limited}
    yield from iter_wrong_dimensions(place, values, dimensions)
    for name, value in values.items():
        if not read_constant(value) > 0.0:
            message = f"{name} must be greater than 0, but is {read_constant(value):.6g}"
            yield SegmentProblem((*place, name), message, "a motion backwards has a negative rise")


def iter_wrong_dimensions(
    place: tuple[str | int, ...], values: Mapping[str, Expression | None], dimensions: Mapping[str, u.Dimension]
) -> Iterator[SegmentProblem]:
    """Yield the values that have another dimension than expected; the key "" stands for the place itself."""
    for name, value in values.items():
        if value is not None and value.dimension not in (None, dimensions[name]):
            assert value.dimension is not None
            message = f"'{value.source.strip()}' is {u.describe(value.dimension)}, expected"
            message += f" {u.describe(dimensions[name])}"
            yield SegmentProblem(
                (*place, name) if name else place, message, f"the coordinate is in {u.si_unit(dimensions[name])}"
            )
