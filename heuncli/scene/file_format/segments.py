"""Segments of cams and drives, as users write them, and the motions that they describe.

Each has an end (`to`, or `for` how long), or is a dwell; a rise is by how much the coordinate changes, `at` what it is
at the end. A profile within limits takes as long as it needs.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from heuncli.base import tolerances
from heuncli.base import units as u
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import suggest
from heuncli.scene.expressions.motion_laws import LIMITS
from heuncli.scene.expressions.motion_segments import (
    LAW_NAMES,
    LawSegment,
    MotionRows,
    find_profile_duration,
    make_drive_expression,
    make_rows,
)
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format.entries import Entry, key
from heuncli.scene.file_format.fields import Angle, Either, Time

# Format segments

END_FIELDS = {"to": "to", "for": "for_", "dwell": "dwell"}
LIMIT_KEYS = ("rate", "acceleration", "jerk")
MAX_SEGMENTS = 1000


class SegmentEntry(Entry):
    """A part of a motion, by a law or a dwell."""

    rise: Either | None = None
    at: Either | None = None
    law: str | None = None


class CamSegmentEntry(SegmentEntry):
    """A segment over the angle of a disc."""

    to: Angle | None = None
    for_: Angle | None = key(alias="for", default=None)
    dwell: Angle | None = None


class DriveSegmentEntry(SegmentEntry):
    """A segment over the time."""

    to: Time | None = None
    for_: Time | None = key(alias="for", default=None)
    dwell: Time | None = None
    rate: Either | None = None
    acceleration: Either | None = None
    jerk: Either | None = None


# Read segments


class SegmentProblem(NamedTuple):
    """What is wrong with segments: place below the entry that has them, message and hint."""

    place: tuple[str | int, ...]
    message: str
    hint: str


class SegmentMotion(NamedTuple):
    """Segments one after the other from 0 on, and what is wrong with them; base: the coordinate before them."""

    segments: tuple[LawSegment, ...]
    base: float
    problems: tuple[SegmentProblem, ...]

    @property
    def last(self) -> float:
        """The coordinate after the last segment."""
        return self.segments[-1].value + self.segments[-1].rise

    def make_rows(self) -> MotionRows:
        """Make the rows of the pieces."""
        return make_rows(self.segments)

    def make_expression(self, is_repeated: bool) -> Expression:
        """Make the expression of a drive in time."""
        parts = [f"{x.law} by {x.rise:.6g} to {x.end:.6g} s" if x.law else f"dwell to {x.end:.6g} s"
                 for x in self.segments]  # fmt: skip
        text = ", ".join(parts[:6]) + (", ..." if len(parts) > 6 else "") + (", repeated" if is_repeated else "")
        return make_drive_expression(self.make_rows(), self.base, self.last, is_repeated, text)


def read_segments(entries: Sequence[SegmentEntry], base: Expression | None, dimension: u.Dimension) -> SegmentMotion:
    """Read the segments of a coordinate of a dimension; each that is wrong counts as if it were not there."""
    problems: list[SegmentProblem] = []
    segments: list[LawSegment] = []
    if not 0 < len(entries) <= MAX_SEGMENTS:
        message = f"{len(entries)} segments; there may be 1 to {MAX_SEGMENTS}"
        problems.append(SegmentProblem(("segments",), message, "for example [{to: 0.5 s, rise: 20 mm, law: cycloid}]"))
    problems += _iter_wrong_dimensions(("base",), {"": base}, {"": dimension})
    x, value = 0.0, _read_constant(base)
    start = value
    for i, entry in enumerate(entries[:MAX_SEGMENTS]):
        found = [*_iter_entry_problems(("segments", i), entry, dimension)]
        segment = None if found else _make_segment(entry, x, value)
        if segment is not None and not segment.end > x:
            found = [_describe_backwards(i, entry, x)]
        problems += found
        if segment is not None and not found:
            segments.append(segment)
            x, value = segment.end, segment.value + segment.rise
    return SegmentMotion(tuple(segments), start, tuple(problems))


def _read_constant(value: Expression | None) -> float:
    """Return the number of a constant, 0 if there is none."""
    return 0.0 if value is None or value.constant is None else value.constant


def _make_segment(entry: SegmentEntry, begin: float, value: float) -> LawSegment:
    """Make the segment of an entry without problems of its own."""
    to, duration, dwell = (getattr(entry, name) for name in ("to", "for_", "dwell"))
    if dwell is not None:
        return LawSegment(begin, begin + dwell, value, 0.0)
    rise = (
        entry.at.constant - value
        if entry.at is not None and entry.at.constant is not None
        else _read_constant(entry.rise)
    )
    limits = tuple(
        _read_constant(getattr(entry, name)) for name in LIMITS.get(entry.law or "", ()) if _is_limited(entry)
    )
    if limits:
        duration = find_profile_duration(rise, limits)
    end = to if to is not None else begin + duration
    return LawSegment(begin, end, value, rise, (entry.law or "") if rise else "", limits)


def _is_limited(entry: SegmentEntry) -> bool:
    """Return whether a segment is a profile within limits, which decide how long it takes."""
    return any(getattr(entry, name, None) is not None for name in LIMIT_KEYS)


def _iter_entry_problems(place: tuple[str | int, ...], entry: SegmentEntry, dimension: u.Dimension,
                         ) -> Iterator[SegmentProblem]:  # fmt: skip
    """Yield what is wrong with one segment by itself."""
    end_keys = [
        name for name in ("to", "for", "dwell") if getattr(entry, "for_" if name == "for" else name) is not None
    ]
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
    yield from _iter_wrong_dimensions(place, values, dict.fromkeys(changes, dimension))
    yield from _iter_law_problems(place, entry, end_keys, limited, dimension)


def _iter_law_problems(
    place: tuple[str | int, ...], entry: SegmentEntry, end_keys: list[str], limited: list[str], dimension: u.Dimension
) -> Iterator[SegmentProblem]:
    """Yield what is wrong with the law of a segment that is no dwell."""
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
    x, y, z = dimension
    values = {name: getattr(entry, name) for name in limited}
    yield from _iter_wrong_dimensions(place, values, {name: (x, y, z - 1 - LIMIT_KEYS.index(name)) for name in limited})
    for name, value in values.items():
        if not _read_constant(value) > 0.0:
            message = f"{name} must be greater than 0, but is {_read_constant(value):.6g}"
            yield SegmentProblem((*place, name), message, "a motion backwards has a negative rise")


def _iter_wrong_dimensions(
    place: tuple[str | int, ...], values: dict[str, Expression | None], dimensions: dict[str, u.Dimension]
) -> Iterator[SegmentProblem]:
    """Yield the values of another dimension; a key "" stands for the place itself."""
    for name, value in values.items():
        if value is not None and value.dimension not in (None, dimensions[name]):
            assert value.dimension is not None
            message = f"'{value.source.strip()}' is {u.describe(value.dimension)}, expected"
            message += f" {u.describe(dimensions[name])}"
            yield SegmentProblem(
                (*place, name) if name else place, message, f"the coordinate is in {u.si_unit(dimensions[name])}"
            )


def _describe_backwards(i: int, entry: SegmentEntry, x: float) -> SegmentProblem:
    """Describe a segment that does not end after it begins, at x."""
    name = next((name for name in ("to", "for", "dwell") if getattr(entry, name.replace("for", "for_")) is not None),
                "rise")  # fmt: skip
    factor, unit = (math.degrees(1.0), "deg") if isinstance(entry, CamSegmentEntry) else (1.0, "s")
    if name == "to":
        message = (
            f"the segment ends at {factor * getattr(entry, name):.6g} {unit}, but begins at {factor * x:.6g} {unit}"
        )
        return SegmentProblem(
            ("segments", i, name), message, "to: counts from the first segment on; for: from this one"
        )
    return SegmentProblem(("segments", i, name), "the segment takes no time", "it must be longer than 0")


# Cams


def iter_cam_problems(motion: SegmentMotion) -> Iterator[SegmentProblem]:
    """Yield why segments over a disc's angle are no cam: they leave a gap, or their rate jumps."""
    end, place = motion.segments[-1].end, ("segments",)
    gap = math.degrees(math.tau - end)
    if abs(end - math.tau) > tolerances.TABLE_ENDS * math.tau:
        what = f"{gap:.6g} deg are missing" if gap > 0.0 else f"{-gap:.6g} deg too many"
        message = f"the segments are {math.degrees(end):.6g} deg long, not one revolution: {what}"
        yield SegmentProblem(place, message, f"add {{dwell: {gap:.6g} deg}}" if gap > 0.0 else "shorten a segment")
        return
    size = max(abs(x.rise) for x in motion.segments)
    rest = motion.last - motion.base
    if abs(rest) > tolerances.TABLE_ENDS * size:
        message = f"after one revolution the lift has changed by {rest:.6g} (SI), so it does not close"
        yield SegmentProblem(place, message, f"the rises must sum up to 0: at: {motion.base:.6g} in the last one")
        return
    rows = motion.make_rows()
    ends = [row.evaluate(x)[1] for row, x in zip(rows.rows, rows.knots[1:], strict=True)]
    fastest = max(abs(x.rise) / (x.end - x.begin) for x in motion.segments)
    for k, row in enumerate(rows.rows):
        jump = row.evaluate(row.begin)[1] - ends[k - 1]
        if abs(jump) > tolerances.TABLE_ENDS * fastest:
            message = f"at {math.degrees(row.begin):.6g} deg the slope of the lift jumps by {jump:.6g} per rad"
            yield SegmentProblem(place, message, "it would strike its follower: use a law that begins and ends at rest")
            return


def close_revolution(motion: SegmentMotion) -> MotionRows:
    """Return the rows of a cam, which end after exactly one revolution."""
    return motion.make_rows()._replace(end=math.tau)


QUANTITY_DIMENSIONS: dict[str, u.Dimension] = {"angle": u.ANGLE, "travel": u.LENGTH, "length": u.LENGTH}
