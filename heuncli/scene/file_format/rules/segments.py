"""Rules about the segments of drives and cams: each has an end and a law, and those of a cam make a revolution."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base.joint_kinds import TYPES
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.format_couplings import CamEntry
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule
from heuncli.scene.file_format.rules.rolling import iter_cams
from heuncli.scene.file_format.segments import (
    QUANTITY_DIMENSIONS,
    SegmentProblem,
    iter_cam_problems,
    read_segments,
)
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
