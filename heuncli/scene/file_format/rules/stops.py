"""Rules about stops and ropes that catch: limits of an existing coordinate, start within them, valid restitution.

Rules about latches: they hold an existing coordinate, which nothing else holds, at a position it can reach.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator

from heuncli.base import tolerances
from heuncli.base.joint_kinds import TYPES, JointKind, format_kind_names, propose_pins
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import suggest
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_couplings as fc
from heuncli.scene.file_format import format_joints as fj
from heuncli.scene.file_format.names import CAUSE_NAMES
from heuncli.scene.file_format.rules import paths
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule
from heuncli.scene.file_format.semantics import (
    HeldCoordinate,
    Limits,
    find_driven_coordinate,
    find_held_coordinate,
    find_limits,
    limitable_coordinates,
)

# Stops

LIMIT_KEYS = ("angle", "travel", "length")


class LimitedCoordinate(NamedTuple):
    """A stop that can be checked: its name, its joint's name and kind, the coordinate and its limits."""

    name: str
    joint: str
    kind: JointKind
    quantity: str
    limits: Limits


def iter_limited_coordinates(draft: DraftDocument) -> Iterator[LimitedCoordinate]:
    """Yield the stops of one coordinate that their joints have."""
    for name, stop in draft.document.stops.items():
        kind = TYPES.get(draft.names.joints.get(stop.joint, ""))
        limits = find_limits(stop)
        if kind is not None and limits is not None and limits[0] in limitable_coordinates(kind):
            yield LimitedCoordinate(name, stop.joint, kind, *limits)


@rule("stop-form")
def check_stop_form(draft: DraftDocument) -> Iterator[Violation]:
    """A stop limits one coordinate that its joint has, on one side at least, to a range that is not empty."""
    for name, stop in draft.document.stops.items():
        path = ("stops", name)
        quantities = [key for key in LIMIT_KEYS if getattr(stop, key) is not None]
        kind = TYPES.get(draft.names.joints.get(stop.joint, ""))
        allowed_keys = limitable_coordinates(kind) if kind is not None else LIMIT_KEYS
        if len(quantities) != 1:
            description = " and ".join(quantities) if quantities else "nothing"
            hint = (
                f"a {kind.name} has {' and '.join(allowed_keys)}"
                if kind and allowed_keys
                else f"give one of {', '.join(LIMIT_KEYS)}"
            )
            yield Violation(path, f"the stop limits {description}", hint, key=True)
            continue
        limits_path = (*path, quantities[0])
        if quantities[0] not in allowed_keys:
            assert kind is not None
            kinds_text = format_kind_names([kind for kind in TYPES.values() if limitable_coordinates(kind)], "and")
            hint = f"a {kind.name} has {' and '.join(allowed_keys)}" if allowed_keys else f"stops limit {kinds_text}"
            hint = propose_pins(kind, hint)
            yield Violation(limits_path, f"a {kind.name} has no {quantities[0]} to limit", hint, key=True)
            continue
        low, high = getattr(stop, quantities[0])
        if low is None and high is None:
            yield Violation(
                limits_path, "the stop has no limit", "null means no limit: give at least one, as in [null, 0.2]"
            )
        elif low is not None and high is not None and not low < high:
            message = f"the limits {low:g} and {high:g} leave no range between them"
            yield Violation(limits_path, message, "give the lower limit first")


@rule("stop-joint")
def check_stop_joint(draft: DraftDocument) -> Iterator[Violation]:
    """What a stop limits is neither driven nor fixed, and no other stop limits it on that side."""
    driven = find_driven_coordinates(draft)
    taken: dict[tuple[str, str, int], str] = {}
    for name, joint, _, quantity, limits in iter_limited_coordinates(draft):
        path = ("stops", name)
        if (joint, quantity) in driven:
            message = f"{joint}.{quantity} is driven by {driven[joint, quantity]}: a stop cannot limit it"
            yield Violation((*path, quantity), message, "drive something else, or leave the stop out", key=True)
        rod = draft.document.joints.get(joint)
        fixing_keys = [key for key in ("length", "tension_only") if getattr(rod, key, None)]
        if quantity == "length" and fixing_keys:
            message = f"the rod {joint} gives {fixing_keys[0]}, but between the limits of a stop its length is free"
            hint = "for a rope that catches use tension_only and restitution, without a stop"
            yield Violation((*path, "joint"), message, f"leave {fixing_keys[0]} out; {hint}")
        for side, limit in enumerate(limits):
            other = taken.setdefault((joint, quantity, side), name) if limit is not None else name
            if other != name:
                message = f"{joint}.{quantity} is already limited from {('below', 'above')[side]} by {other}"
                yield Violation((*path, quantity, side), message, "one stop per side")


def find_driven_coordinates(draft: DraftDocument) -> dict[tuple[str, str], str]:
    """Return the drives by joint and coordinate."""
    drives_by_coordinate: dict[tuple[str, str], str] = {}
    for name, drive in draft.document.drives.items():
        driven = find_driven_coordinate(drive, draft.names.joints.get(drive.joint))
        if driven is not None:
            drives_by_coordinate[drive.joint, driven.quantity] = name
    return drives_by_coordinate


@rule("stop-start")
def check_stop_start(draft: DraftDocument) -> Iterator[Violation]:
    """A prescribed start value lies within the limits."""
    for name, joint, _, quantity, limits in iter_limited_coordinates(draft):
        start_value = getattr(getattr(draft.document.joints.get(joint), "initial", None), quantity, None)
        for limit, is_past in zip(limits, (float.__lt__, float.__gt__), strict=True):
            if start_value is not None and limit is not None and is_outside(start_value, limit, is_past):
                message = f"{quantity} starts at {start_value:.9g}, beyond the limit {limit:.9g} of the stop {name}"
                yield Violation(("joints", joint, "initial", quantity), message, "start within the limits")


def is_outside(value: float, limit: float, is_past: Callable[[float, float], bool]) -> bool:
    """Whether a value is past a limit, not merely at it.

    is_past: compares value and limit
    """
    return is_past(value, limit) and abs(value - limit) > tolerances.AT_LIMIT * max(abs(limit), 1.0)


@rule("restitution")
def check_restitution(draft: DraftDocument) -> Iterator[Violation]:
    """A restitution is between 0 and 1, and only what may go slack or lift off has one."""
    hint = "0: no rebound, 1: full rebound"
    for name, stop in draft.document.stops.items():
        if not 0.0 <= stop.restitution <= 1.0:
            message = f"restitution {stop.restitution:g} is not between 0 and 1"
            yield Violation(("stops", name, "restitution"), message, hint)
    for name, joint in draft.document.joints.items():
        path = ("joints", name, "restitution")
        if not isinstance(joint, fj.RodJoint) or joint.restitution is None:
            continue
        if not joint.tension_only:
            message = "restitution given, but this rod carries tension and compression: it has no impacts"
            yield Violation(path, message, "for a rope add tension_only: true; for limits use stops", key=True)
        if not 0.0 <= joint.restitution <= 1.0:
            yield Violation(path, f"restitution {joint.restitution:g} is not between 0 and 1", hint)
    yield from paths.check_path_restitution(draft)


def list_impact_joints(draft: DraftDocument) -> list[str]:
    """List the joints that open and close with impacts: ropes, and curves that push on one side."""
    opening = fj.RodJoint | fj.CurveJoint
    return [n for n, j in draft.document.joints.items() if isinstance(j, opening) and j.restitution is not None]


def has_load(coupling: fc.ScrewEntry | fc.RopeEntry) -> bool:
    """Whether a coupling is also a load under its name: an elastic rope, or a thread with friction."""
    return getattr(coupling, "stiffness", None) is not None or getattr(coupling, "friction", None) is not None


@rule("shared-name")
def check_shared_name(draft: DraftDocument) -> Iterator[Violation]:
    """What has impacts shares its name with nothing next to it in the results."""
    entries = draft.names.entries
    joints, couplings = list_impact_joints(draft), draft.document.couplings
    impact_couplings = [
        name for name, coupling in couplings.items() if getattr(coupling, "restitution", None) is not None
    ]
    load_couplings = [
        name
        for name, coupling in couplings.items()
        if isinstance(coupling, fc.ScrewEntry | fc.RopeEntry) and has_load(coupling)
    ]
    names_by_block: dict[str, dict[str, Collection[str]]] = {
        "impulses": {"joints": joints, "couplings": impact_couplings, "drives": entries["drives"]},
        "stops": {block: entries[block] for block in ("joints", "forces", "drives", "impulses")}
        | {"couplings": impact_couplings},
        "latches": {block: entries[block] for block in ("joints", "forces", "drives", "impulses", "stops", "events")}
        | {"couplings": impact_couplings},
        "rolling": {block: entries[block] for block in ("couplings", "forces", "drives", "stops", "latches")},
        "forces": {"couplings": load_couplings},
    }
    if impact_couplings:
        names_by_block["joints"] = {"couplings": [name for name in impact_couplings if name in joints]}
    for name in CAUSE_NAMES.intersection(joints):
        hint = f"call it {name}_1, for example"
        yield Violation(
            ("joints", name),
            f"'{name}' is reserved: it is a cause in the results, and this joint has impacts",
            hint,
            key=True,
        )
    for block, others in names_by_block.items():
        for name in entries[block]:
            for other, names in others.items():
                if name in names:
                    message = f"'{name}' is already used: {other}.{name} has the same name in the results"
                    yield Violation((block, name), message, f"call it {name}_1, for example", key=True)


# Latches

POSITION_KEYS = ("angle", "travel")
LIMIT_INDEX = {"lower": 0, "upper": 1}


@rule("unknown-stop")
def check_unknown_stop(draft: DraftDocument) -> Iterator[Violation]:
    """The stop of a latch exists."""
    stops = draft.names.entries["stops"]
    for name, latch in draft.document.latches.items():
        if latch.stop is not None and latch.stop not in stops:
            yield Violation(
                ("latches", name, "stop"), f"'{latch.stop}' is not a stop", suggest(latch.stop, stops, "stops")
            )


@rule("latch-form")
def check_latch_form(draft: DraftDocument) -> Iterator[Violation]:
    """A latch holds at a stop, or holds the single coordinate of a joint at a position or where it is."""
    for name, latch in draft.document.latches.items():
        path = ("latches", name)
        if (latch.stop is None) == (latch.joint is None):
            description = "both a stop and a joint" if latch.stop is not None else "neither a stop nor a joint"
            hint = (
                "give stop: NAME to catch at its limit; or joint: NAME to catch at an angle, at a travel or where it is"
            )
            yield Violation(path, f"the latch gives {description}", hint, key=True)
        elif latch.stop is not None:
            yield from check_latch_at_stop(draft, name, latch)
        elif latch.limit is not None:
            yield Violation(
                (*path, "limit"), "limit is given without a stop", "add stop: NAME, whose limit it is", key=True
            )
        else:
            yield from check_latch_at_joint(draft, name, latch)
        if latch.every and latch.release is None:
            hint = "add release: a condition such as handle.angle > 0.1; without it the latch never releases"
            yield Violation((*path, "every"), "'every' is given without 'release'", hint, key=True)


def check_latch_at_stop(draft: DraftDocument, name: str, latch: f.LatchEntry) -> Iterator[Violation]:
    """Yield what is wrong with a latch at a stop."""
    for key in POSITION_KEYS:
        if getattr(latch, key) is not None:
            message = f"the latch at the stop {latch.stop} holds at its limit and takes no {key}"
            yield Violation(("latches", name, key), message, "leave one of them out", key=True)
    stop = draft.document.stops.get(latch.stop or "")
    limits = find_limits(stop) if stop is not None else None
    if latch.limit is not None and limits is not None and limits[1][LIMIT_INDEX[latch.limit]] is None:
        message = f"the stop {latch.stop} has no {latch.limit} limit"
        yield Violation(("latches", name, "limit"), message, "leave limit out, or give the other one")


def check_latch_at_joint(draft: DraftDocument, name: str, latch: f.LatchEntry) -> Iterator[Violation]:
    """Yield what is wrong with a latch at a joint."""
    path, joint = ("latches", name), latch.joint or ""
    kind = TYPES.get(draft.names.joints.get(joint, ""))
    if kind is None:
        return
    coordinates = limitable_coordinates(kind)
    given_keys = [key for key in POSITION_KEYS if getattr(latch, key) is not None]
    if len(coordinates) != 1:
        owner_text = (
            f"a {kind.name} has {' and '.join(coordinates)}" if coordinates else f"a {kind.name} has no coordinate"
        )
        hint = (
            f"define a stop for the coordinate to hold, and give it: {name}: {{stop: NAME}}"
            if coordinates
            else "a pin, slide or rod has one"
        )
        yield Violation((*path, "joint"), f"{owner_text}: a latch holds one", hint)
        return
    for key in given_keys:
        if key not in coordinates:
            yield Violation(
                (*path, key), f"a {kind.name} has no {key} to hold", f"a {kind.name} has {coordinates[0]}", key=True
            )


@rule("latch-joint")
def check_latch_joint(draft: DraftDocument) -> Iterator[Violation]:
    """What a latch holds is neither driven nor fixed, lies within the limits of stops, and no other latch holds it
    there.
    """
    driven = find_driven_coordinates(draft)
    taken: dict[tuple[str, str, float | None, int], str] = {}
    for name, latch in draft.document.latches.items():
        coordinate = find_held_coordinate(latch, draft.document)
        if coordinate is None:
            continue
        path = ("latches", name)
        where = (*path, "stop" if latch.stop is not None else "joint")
        coordinate_path = f"{coordinate.joint}.{coordinate.quantity}"
        if (coordinate.joint, coordinate.quantity) in driven:
            drive_name = driven[coordinate.joint, coordinate.quantity]
            hint = "keep the drive constant instead, or latch another coordinate"
            yield Violation(where, f"{coordinate_path} is driven by {drive_name}: no latch can hold it", hint)
        rod = draft.document.joints.get(coordinate.joint)
        fixing_keys = [key for key in ("length", "tension_only") if getattr(rod, key, None)]
        if latch.stop is None and coordinate.quantity == "length" and fixing_keys:
            message = f"the rod {coordinate.joint} gives {fixing_keys[0]}, but until a latch catches its length is free"
            yield Violation(where, message, f"leave {fixing_keys[0]} out")
        yield from check_latch_within_stops(draft, name, coordinate)
        for side in coordinate.sides or ((0,) if coordinate.position is not None else ()):
            other = taken.setdefault((coordinate.joint, coordinate.quantity, coordinate.position, side), name)
            if other != name:
                message = f"{coordinate_path} is already held there by {other}"
                yield Violation(where, message, "one latch per position: join their conditions with 'or'")


def check_latch_within_stops(draft: DraftDocument, name: str, coordinate: HeldCoordinate) -> Iterator[Violation]:
    """Yield a violation if stops keep the coordinate from reaching the latch's position."""
    for stop, joint, _, quantity, limits in iter_limited_coordinates(draft):
        if coordinate.position is None or (joint, quantity) != (coordinate.joint, coordinate.quantity):
            continue
        for limit, is_past in zip(limits, (float.__lt__, float.__gt__), strict=True):
            if limit is not None and is_outside(coordinate.position, limit, is_past):
                message = (
                    f"{quantity} never reaches {coordinate.position:.9g}: the stop {stop} limits it at {limit:.9g}"
                )
                yield Violation(("latches", name, quantity), message, f"to catch at that limit write {{stop: {stop}}}")
