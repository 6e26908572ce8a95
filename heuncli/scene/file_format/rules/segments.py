"""Rules about the segments of drives and cams: each has an end and a law, and those of a cam make a revolution."""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.base import tolerances
from heuncli.base.joint_kinds import TYPES
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.format_couplings import CamEntry
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule
from heuncli.scene.file_format.rules.rolling import iter_cams
from heuncli.scene.file_format.segment_entries import SegmentProblem
from heuncli.scene.file_format.segments import QUANTITY_DIMENSIONS, SegmentMotion, read_segments
from heuncli.scene.file_format.semantics import read_drive_segments


@rule("segments")
def check_segments(draft: DraftDocument) -> Iterator[Violation]:
    """Segments follow each other, each with an end, a rise and a law or as a dwell; a cam's close after a turn."""
    for name, drive in draft.document.drives.items():
        for problem in iter_drive_problems(drive, draft.names.joints.get(drive.joint)):
            yield Violation(("drives", name, *problem.place), problem.message, problem.hint)
    for name, cam in iter_cams(draft):
        for problem in iter_lift_problems(draft, cam):
            yield Violation(("couplings", name, *problem.place), problem.message, problem.hint)


def iter_drive_problems(drive: f.DriveEntry, joint_type: str | None) -> Iterator[SegmentProblem]:
    """Yield what is wrong with the segments of a drive."""
    if drive.segments is None:
        for key in ("base", "repeat"):
            if getattr(drive, key):
                yield SegmentProblem((key,), f"{key} given without segments", f"{key} belongs to segments")
        return
    motion = read_drive_segments(drive, joint_type)
    if motion is not None:  # other rules report a joint that cannot be driven
        yield from motion.problems


def iter_lift_problems(draft: DraftDocument, cam: CamEntry) -> Iterator[SegmentProblem]:
    """Yield what is wrong with the segments of a cam."""
    if cam.segments is None or cam.lift is not None:
        key, other = ("lift", "segments") if cam.segments is not None else ("base", "a lift")
        if cam.segments is not None or cam.base is not None:
            yield SegmentProblem((key,), f"both {key} and {other} are given", "give lift, or segments and base")
        return
    follower = draft.document.joints.get(cam.of[1]) if len(cam.of) == 2 else None
    kind = None if follower is None else TYPES[follower.type]
    if kind is None or not kind.coordinates:
        return  # other rules report it
    motion = read_segments(cam.segments, cam.base, QUANTITY_DIMENSIONS[kind.coordinates[0]])
    yield from motion.problems or iter_cam_problems(motion)


def iter_cam_problems(motion: SegmentMotion) -> Iterator[SegmentProblem]:
    """Yield why segments are not a cam: they are not one revolution, the lift does not close, or its slope jumps."""
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
