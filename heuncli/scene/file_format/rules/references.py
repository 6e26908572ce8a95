"""Rules about references: every body, point and joint that is named exists.

Rules about names: their form, and reserved names.

Refuse, with a location, what the format knows but this version does not solve.

One row per feature; to lift a refusal, delete its row.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator

from heuncli.base.spelling import suggest
from heuncli.scene.file_format import format_couplings as fc
from heuncli.scene.file_format import format_loads as fl
from heuncli.scene.file_format.fields import EndEntry
from heuncli.scene.file_format.names import GROUND, NAMED_BLOCKS, RESERVED_NAMES, as_mapping, is_name
from heuncli.scene.file_format.rules.registry import DraftDocument, Path_, Violation, rule
from heuncli.scene.file_format.semantics import find_reduction_end

# References


def iter_ends(draft: DraftDocument) -> Iterator[tuple[Path_, EndEntry]]:
    """Yield every end in the document with its path."""
    document = draft.document
    for name, joint in document.joints.items():
        yield ("joints", name, "from"), joint.from_
        yield ("joints", name, "to"), joint.to
    for name, load in document.forces.items():
        if isinstance(load, fl.ForceEntry | fl.CoupleEntry):
            yield ("forces", name, "on"), load.on
        elif isinstance(load, fl.PairEntry):
            yield ("forces", name, "from"), load.from_
            yield ("forces", name, "to"), load.to
    for name, impulse in document.impulses.items():
        if impulse.on is not None:
            yield ("impulses", name, "on"), impulse.on
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
        end = find_reduction_end(section.reduce_to)
        if end is not None:
            yield ("sections", name, "reduce_to"), end
    for name, sensor in document.sensors.items():
        if sensor.point is not None:
            yield ("sensors", name, "point"), sensor.point
    reference_point = document.foundation.about
    if isinstance(reference_point, str):
        yield ("foundation", "about"), parse_ground_end(reference_point)
    yield from iter_unread_ends(draft)


def iter_unread_ends(draft: DraftDocument) -> Iterator[tuple[Path_, EndEntry]]:
    """Yield ends written as body.point in joints, forces and impulses that could not be read."""
    document = draft.document
    for block, read_entries in (
        ("joints", document.joints),
        ("forces", document.forces),
        ("impulses", document.impulses),
    ):
        for name, data in draft.names.entries[block].items():
            for key in ("from", "to", "on") if name not in read_entries else ():
                value = as_mapping(data).get(key)
                body, _, point = value.partition(".") if isinstance(value, str) else ("", "", "")
                if body and point and "." not in point:
                    yield (block, name, key), EndEntry.model_construct(body=body, at=point)


def parse_ground_end(point_name: str) -> EndEntry:
    """Return 'ground.O' or 'O' as an end."""
    body, dot, point = point_name.partition(".")
    return EndEntry.model_construct(body=body if dot else GROUND, at=point if dot else body)


def iter_body_references(draft: DraftDocument) -> Iterator[tuple[Path_, str, bool]]:
    """Yield every reference to a body: path, name, and whether the ground is allowed there."""
    for path, end in iter_ends(draft):
        may_be_ground = path[0] in GROUND_BLOCKS or path[-1] in ("from", "to")
        yield path, end.body, may_be_ground
    for name, section in draft.document.sections.items():
        yield ("sections", name, "body"), section.body, False
    for name, sensor in draft.document.sensors.items():
        yield ("sensors", name, "axes"), sensor.axes, True
    for name, load in draft.document.forces.items():
        if isinstance(load, fl.DistributedEntry):
            yield ("forces", name, "on"), load.on, False
    for name, impulse in draft.document.impulses.items():
        if impulse.body is not None:
            yield ("impulses", name, "body"), impulse.body, False
    for name, wheel in draft.document.rolling.items():
        if wheel.body is not None:
            yield ("rolling", name, "body"), wheel.body, True


GROUND_BLOCKS = (
    "joints",
    "couplings",
    "rolling",
    "foundation",
    "sections",
    "sensors",
)  # blocks in which an end may be on the ground
GROUND_SYNONYMS = frozenset({"world", "base", "frame", "earth", "fixed", "origin", "inertial"})  # synonyms of ground
POINT_BLOCKS = {GROUND: GROUND}  # owner of points -> block that holds it, if not bodies


@rule("unknown-body")
def check_unknown_body(draft: DraftDocument) -> Iterator[Violation]:
    """Bodies exist."""
    bodies = draft.names.entries["bodies"]
    with_ground = dict.fromkeys([*bodies, GROUND])  # built once, even if many are unknown
    for path, body, may_be_ground in iter_body_references(draft):
        if body not in with_ground:
            allowed = with_ground if may_be_ground else bodies
            hint = "the fixed frame is called ground: ground.O" if body.lower() in GROUND_SYNONYMS else None
            yield Violation(path, f"'{body}' is not a body", hint or suggest(body, allowed, "bodies"))


@rule("ground-cannot")
def check_ground_use(draft: DraftDocument) -> Iterator[Violation]:
    """The ground has no loads and no sections; foundation.about is on the ground."""
    for path, body, may_be_ground in iter_body_references(draft):
        if body == GROUND and not may_be_ground:
            thing = "a section" if path[0] == "sections" else "an applied load"
            yield Violation(
                path, f"the ground cannot have {thing}", "the ground does not move and has no mass: name a body"
            )
        elif path[0] == "foundation" and body != GROUND:
            yield Violation(
                path, "the foundation's moment needs a fixed point", "give a point of the ground, or [x, y, z]"
            )


@rule("unknown-point")
def check_unknown_point(draft: DraftDocument) -> Iterator[Violation]:
    """Points exist."""
    points = draft.names.points
    for path, end in iter_ends(draft):
        if isinstance(end.at, str) and end.body in points and end.at not in points[end.body]:
            if not points[end.body] and POINT_BLOCKS.get(end.body, "bodies") in draft.unread:
                continue  # they could not be read, which is reported
            yield missing_point_violation(path, end.body, end.at, points[end.body])
        elif end.at is None and not may_omit_point(draft, path) and end.body in points:
            yield Violation(path, "a point is missing", "write body.point, or {body: name, at: [x, y, z]}")
    for path, body, value in iter_body_points(draft):
        if isinstance(value, str) and body in points and value not in points[body]:
            yield missing_point_violation(path, body, value, points[body])


def iter_body_points(draft: DraftDocument) -> Iterator[tuple[Path_, str, object]]:
    """Yield every point, by name or by coordinates, that belongs to a body named next to it."""
    for name, section in draft.document.sections.items():
        for key, value in (("at", section.at), ("from", section.from_), ("to", section.to)):
            yield ("sections", name, key), section.body, value
    for name, load in draft.document.forces.items():
        if isinstance(load, fl.DistributedEntry) and load.on != GROUND:
            for key, value in (("from", load.from_), ("to", load.to)):
                yield ("forces", name, key), load.on, value


def may_omit_point(draft: DraftDocument, path: Path_) -> bool:
    """Whether an end may be a body without a point, as for a couple."""
    if path[0] == "impulses":
        return draft.document.impulses[str(path[1])].couple is not None
    return path[0] == "forces"


def missing_point_violation(path: Path_, body: str, point: str, points: Collection[str]) -> Violation:
    """Make the violation for a point that its body does not have."""
    owner = "the ground" if body == GROUND else f"body {body}"
    short_name = point.removeprefix(f"{body}.")
    hint = f"write the point only: {short_name}" if short_name != point and short_name in points else None
    message = f"{owner} has no point '{point}'"
    return Violation(path, message, hint or suggest(point, points, f"points of {body}"))


@rule("unknown-joint")
def check_unknown_joint(draft: DraftDocument) -> Iterator[Violation]:
    """Joints exist."""
    joints = draft.names.entries["joints"]
    document = draft.document
    entries_by_block = {
        "drives": document.drives, "forces": document.forces, "stops": document.stops, "latches": document.latches,
        "rolling": document.rolling,
    }  # fmt: skip
    for block, entries in entries_by_block.items():
        key = "axle" if block == "rolling" else "joint"
        for name, entry in entries.items():  # type: ignore[attr-defined]
            joint = getattr(entry, key, None)
            if joint is not None and joint not in joints:
                yield Violation((block, name, key), f"'{joint}' is not a joint", suggest(joint, joints, "joints"))


# Naming


@rule("bad-name")
def check_name_form(draft: DraftDocument) -> Iterator[Violation]:
    """A name is a letter, then letters, digits and _."""
    hint = "a name starts with a letter and contains only letters, digits and _"
    for block in NAMED_BLOCKS:
        for name in draft.names.entries[block]:
            if not is_name(name):
                yield Violation((block, name), f"'{name}' is not a valid name", hint, key=True)
    for body, points in draft.names.points.items():
        for name in points:
            if not is_name(name):
                path = ("ground",) if body == "ground" else ("bodies", body)
                yield Violation((*path, "points", name), f"'{name}' is not a valid name", hint, key=True)


@rule("reserved-name")
def check_reserved_name(draft: DraftDocument) -> Iterator[Violation]:
    """Names with a meaning of their own are not used for entries."""
    for block, reserved in RESERVED_NAMES.items():
        for name in draft.names.entries[block]:
            if name in reserved:
                meaning = (
                    "the ground"
                    if name == "ground"
                    else "a built-in name of expressions"
                    if block != "forces"
                    else "a cause in the results"
                )
                yield Violation(
                    (block, name), f"'{name}' is reserved: it is {meaning}", f"call it {name}_1, for example", key=True
                )


# Not yet

PathFinder = Callable[[DraftDocument], Iterable[Path_]]


def iter_stop_friction(draft: DraftDocument) -> Iterator[Path_]:
    """Yield the friction of stops at impacts."""
    for name, stop in draft.document.stops.items():
        if stop.friction is not None:
            yield "stops", name, "friction"


NOT_YET: tuple[tuple[str, PathFinder], ...] = (("friction at impacts", iter_stop_friction),)


@rule("not-yet", may_be_consequence=False)
def check_not_yet(draft: DraftDocument) -> Iterator[Violation]:
    """Refuse the features of the table."""
    for feature, find_paths in NOT_YET:
        for path in find_paths(draft):
            yield Violation(
                path,
                f"not available yet: {feature}",
                "leave it out: planned for a later version",
                key=path[-1] != "type",
            )
