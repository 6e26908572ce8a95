"""Segments one after another, as a motion: of a drive over time, of a cam's lift over the angle of its disc.

A motion is a list of `LawSegment`s from 0 on, each beginning where the one before it ends. Nothing is sampled: every
law consists of pieces that are a polynomial plus a sine of the distance from the piece's start (motion_segments.py), so
value, rate and acceleration are exact to rounding, and only the ends of pieces are knots of the integration.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from heuncli.base import units as u
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.expressions.motion_laws import LIMITS
from heuncli.scene.expressions.motion_segments import (
    LawSegment,
    MotionRows,
    find_profile_duration,
    make_drive_expression,
    make_rows,
)
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format.segment_entries import (
    END_FIELDS,
    CamSegmentEntry,
    SegmentEntry,
    SegmentProblem,
    find_end_keys,
    find_rise,
    has_limits,
    iter_entry_problems,
    iter_wrong_dimensions,
    read_constant,
)

MAX_SEGMENTS = 1000
MAX_DESCRIBED = 6  # segments that the description of a drive lists
QUANTITY_DIMENSIONS: dict[str, u.Dimension] = {"angle": u.ANGLE, "travel": u.LENGTH, "length": u.LENGTH}


class SegmentMotion(NamedTuple):
    """A motion from 0 on, and the problems of its segments.

    segments: those without problems; their begin and end are [s] or [rad], value and rise [m] or [rad]
    base: value of the coordinate before the first segment [m or rad]
    """

    segments: tuple[LawSegment, ...]
    base: float
    problems: tuple[SegmentProblem, ...]

    @property
    def last(self) -> float:
        """The value of the coordinate after the last segment [m or rad]."""
        return self.segments[-1].value + self.segments[-1].rise

    def make_rows(self) -> MotionRows:
        """Make the pieces, each a polynomial plus a sine."""
        return make_rows(self.segments)

    def make_expression(self, is_repeated: bool) -> Expression:
        """Make the expression of a drive in time; is_repeated: it starts again after the last segment."""
        shown = [
            f"{x.law} by {x.rise:.6g} to {x.end:.6g} s" if x.law else f"dwell to {x.end:.6g} s"
            for x in self.segments[:MAX_DESCRIBED]
        ]
        shown += ["..."] * (len(self.segments) > MAX_DESCRIBED) + ["repeated"] * is_repeated
        text = ", ".join(shown)
        return make_drive_expression(self.make_rows(), self.base, self.last, is_repeated, text)


def read_segments(entries: Sequence[SegmentEntry], base: Expression | None, dimension: u.Dimension) -> SegmentMotion:
    """Read the segments of a coordinate; one that has a problem is left out, so that the others are checked, too.

    base: the coordinate before the first segment, 0 if None
    """
    problems: list[SegmentProblem] = []
    segments: list[LawSegment] = []
    if not 0 < len(entries) <= MAX_SEGMENTS:
        message = f"{len(entries)} segments; there may be 1 to {MAX_SEGMENTS}"
        problems.append(SegmentProblem(("segments",), message, "for example [{to: 0.5 s, rise: 20 mm, law: cycloid}]"))
    problems += iter_wrong_dimensions(("base",), {"": base}, {"": dimension})
    begin, value = 0.0, read_constant(base)
    for i, entry in enumerate(entries[:MAX_SEGMENTS]):
        found = [*iter_entry_problems(("segments", i), entry, dimension)]
        segment = None if found else _make_segment(entry, begin, value)
        if segment is not None and not segment.end > begin:
            found = [_describe_empty_segment(i, entry, begin)]
        problems += found
        if segment is not None and not found:
            segments.append(segment)
            begin, value = segment.end, segment.value + segment.rise
    return SegmentMotion(tuple(segments), read_constant(base), tuple(problems))


def _make_segment(entry: SegmentEntry, begin: float, value: float) -> LawSegment:
    """Make the segment of an entry that has no problems, from `begin` [s or rad] and `value` on."""
    to, duration, dwell = (getattr(entry, name) for name in ("to", "for_", "dwell"))
    if dwell is not None:
        return LawSegment(begin, begin + dwell, value, 0.0)
    rise = find_rise(entry, value)
    limits = tuple(read_constant(getattr(entry, name)) for name in LIMITS.get(entry.law or "", ()) if has_limits(entry))
    if limits:
        duration = find_profile_duration(rise, limits)
    end = to if to is not None else begin + duration
    return LawSegment(begin, end, value, rise, (entry.law or "") if rise else "", limits)


def _describe_empty_segment(i: int, entry: SegmentEntry, begin: float) -> SegmentProblem:
    """Describe the problem of a segment that does not end after it begins [s or rad]."""
    name = next(iter(find_end_keys(entry)), "rise")
    factor, unit = (math.degrees(1.0), "deg") if isinstance(entry, CamSegmentEntry) else (1.0, "s")
    if name == "to":
        end = getattr(entry, END_FIELDS[name])
        message = f"the segment ends at {factor * end:.6g} {unit}, but begins at {factor * begin:.6g} {unit}"
        hint = "to: counts from the first segment on; for: from this one"
        return SegmentProblem(("segments", i, name), message, hint)
    return SegmentProblem(("segments", i, name), "the segment takes no time", "it must be longer than 0")


def close_revolution(motion: SegmentMotion) -> MotionRows:
    """Make the pieces of a cam's lift, whose end is set to exactly one revolution; rounding may have missed it."""
    return motion.make_rows()._replace(end=math.tau)
