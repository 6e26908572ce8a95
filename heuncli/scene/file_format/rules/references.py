"""References: every body, point and joint that is named exists."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from heuncli.base.nearest import did_you_mean
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_couplings as fc
from heuncli.scene.file_format import format_elastic as fe
from heuncli.scene.file_format.fields import EndEntry
from heuncli.scene.file_format.names import GROUND, mapping
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule
from heuncli.scene.file_format.semantics import end_of


def ends(draft: DraftDocument) -> Iterator[tuple[Path_, EndEntry]]:
    """Every end in the document with its path."""
    document = draft.document
    for name, joint in document.joints.items():
        yield ("joints", name, "from"), joint.from_
        yield ("joints", name, "to"), joint.to
    for name, load in document.forces.items():
        if isinstance(load, f.ForceEntry | f.CoupleEntry):
            yield ("forces", name, "on"), load.on
        elif isinstance(load, fe.BushingEntry | f.ActuatorEntry | f.SpringEntry):
            yield ("forces", name, "from"), load.from_
            yield ("forces", name, "to"), load.to
    for name, blow in document.impulses.items():
        if blow.on is not None:
            yield ("impulses", name, "on"), blow.on
    for name, coupling in document.couplings.items():
        for i, place in enumerate(coupling.through if isinstance(coupling, fc.RopeEntry) else ()):
            for key, end in (("point", place.point), ("sheave", place.sheave)):
                if end is not None:
                    yield ("couplings", name, "through", i, key), end
        if isinstance(coupling, fc.GearEntry | fc.CamEntry) and coupling.at is not None:
            yield ("couplings", name, "at"), coupling.at
    for name, wheel in document.rolling.items():
        if wheel.wheel is not None:
            yield ("rolling", name, "wheel"), wheel.wheel
        yield ("rolling", name, "on"), wheel.on
    for name, section in document.sections.items():
        end = end_of(section.reduce_to)
        if end is not None:
            yield ("sections", name, "reduce_to"), end
    about = document.foundation.about
    if isinstance(about, str):
        yield ("foundation", "about"), ground_end(about)
    yield from ends_unread(draft)


def ends_unread(draft: DraftDocument) -> Iterator[tuple[Path_, EndEntry]]:
    """Ends written as body.point in joints, forces and impulses in which something else is in error."""
    document = draft.document
    for block, read in (("joints", document.joints), ("forces", document.forces), ("impulses", document.impulses)):
        for name, data in draft.names.entries[block].items():
            for key in ("from", "to", "on") if name not in read else ():
                value = mapping(data).get(key)
                body, _, point = value.partition(".") if isinstance(value, str) else ("", "", "")
                if body and point and "." not in point:
                    yield (block, name, key), EndEntry.model_construct(body=body, at=point)


def ground_end(about: str) -> EndEntry:
    """'ground.O' or 'O' as an end."""
    body, dot, point = about.partition(".")
    return EndEntry.model_construct(body=body if dot else GROUND, at=point if dot else body)


def bodies_spoken_of(draft: DraftDocument) -> Iterator[tuple[Path_, str, bool]]:
    """Every mention of a body: path, name, whether the ground may stand there."""
    for path, end in ends(draft):
        may_be_ground = path[0] in STANDING or path[-1] in ("from", "to")
        yield path, end.body, may_be_ground
    for name, section in draft.document.sections.items():
        yield ("sections", name, "body"), section.body, False
    for name, load in draft.document.forces.items():
        if isinstance(load, f.DistributedEntry):
            yield ("forces", name, "on"), load.on, False
    for name, blow in draft.document.impulses.items():
        if blow.body is not None:
            yield ("impulses", name, "body"), blow.body, False
    for name, wheel in draft.document.rolling.items():
        if wheel.body is not None:
            yield ("rolling", name, "body"), wheel.body, True


STANDING = ("joints", "couplings", "rolling", "foundation", "sections")  # where the ground may be named
FIXED = frozenset({"world", "base", "frame", "earth", "fixed", "origin", "inertial"})  # the ground, elsewhere
BLOCK_OF = {GROUND: GROUND}  # of points: where they stand


@rule("unknown-body")
def unknown_body(draft: DraftDocument) -> Iterator[Violation]:
    """Bodies exist."""
    bodies = draft.names.entries["bodies"]
    with_ground = dict.fromkeys([*bodies, GROUND])  # gathered once, however many are unknown
    for path, body, may_be_ground in bodies_spoken_of(draft):
        if body not in with_ground:
            known = with_ground if may_be_ground else bodies
            hint = "what does not move is the ground: ground.O" if body.lower() in FIXED else None
            yield Violation(path, f"'{body}' is not a body", hint or did_you_mean(body, known, "bodies"))


@rule("ground-cannot")
def ground_cannot(draft: DraftDocument) -> Iterator[Violation]:
    """The ground carries no loads and has no sections; foundation.about is on the ground."""
    for path, body, may_be_ground in bodies_spoken_of(draft):
        if body == GROUND and not may_be_ground:
            what = "a section" if path[0] == "sections" else "an applied load"
            yield Violation(path, f"the ground cannot have {what}", "it does not move and has no mass: name a body")
        elif path[0] == "foundation" and body != GROUND:
            yield Violation(path, "M_s is taken about a fixed point", "name a point of the ground, or give [x, y, z]")


@rule("unknown-point")
def unknown_point(draft: DraftDocument) -> Iterator[Violation]:
    """Points exist."""
    points = draft.names.points
    for path, end in ends(draft):
        if isinstance(end.at, str) and end.body in points and end.at not in points[end.body]:
            if not points[end.body] and BLOCK_OF.get(end.body, "bodies") in draft.unread:
                continue  # they could not be read, which is told
            yield absent(path, end.body, end.at, points[end.body])
        elif end.at is None and not may_be_whole(draft, path) and end.body in points:
            yield Violation(path, "a point is missing", "write body.point, or {body: name, at: [x, y, z]}")
    for path, body, value in points_of_bodies(draft):
        if isinstance(value, str) and body in points and value not in points[body]:
            yield absent(path, body, value, points[body])


def points_of_bodies(draft: DraftDocument) -> Iterator[tuple[Path_, str, object]]:
    """Every point that is given, by name or by coordinates, of a body that is named beside it."""
    for name, section in draft.document.sections.items():
        for key, value in (("at", section.at), ("from", section.from_), ("to", section.to)):
            yield ("sections", name, key), section.body, value
    for name, load in draft.document.forces.items():
        if isinstance(load, f.DistributedEntry) and load.on != GROUND:
            for key, value in (("from", load.from_), ("to", load.to)):
                yield ("forces", name, key), load.on, value


def may_be_whole(draft: DraftDocument, path: Path_) -> bool:
    """Whether an end may be a body without a point: of a couple."""
    if path[0] == "impulses":
        return draft.document.impulses[str(path[1])].couple is not None
    return path[0] == "forces"


def absent(path: Path_, body: str, point: str, points: Collection[str]) -> Violation:
    """A point that its body does not have."""
    owner = "the ground" if body == GROUND else f"body {body}"
    own = point.removeprefix(f"{body}.")
    hint = f"the point alone: {own}" if own != point and own in points else None
    message = f"{owner} has no point '{point}'"
    return Violation(path, message, hint or did_you_mean(point, points, f"points of {body}"))


@rule("unknown-joint")
def unknown_joint(draft: DraftDocument) -> Iterator[Violation]:
    """Joints exist."""
    joints = draft.names.entries["joints"]
    document = draft.document
    naming = {
        "drives": document.drives, "forces": document.forces, "stops": document.stops, "latches": document.latches,
        "rolling": document.rolling,
    }  # fmt: skip
    for block, entries in naming.items():
        key = "axle" if block == "rolling" else "joint"
        for name, entry in entries.items():  # type: ignore[attr-defined]
            joint = getattr(entry, key, None)
            if joint is not None and joint not in joints:
                yield Violation((block, name, key), f"'{joint}' is not a joint", did_you_mean(joint, joints, "joints"))
