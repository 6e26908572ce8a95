"""Rules about latches: they hold an existing coordinate, which nothing else holds, at a position it can reach."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base.joint_kinds import TYPES
from heuncli.base.spelling import suggest
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule
from heuncli.scene.file_format.rules.stops import find_driven_coordinates, is_outside, iter_limited_coordinates
from heuncli.scene.file_format.semantics import HeldCoordinate, find_held_coordinate, find_limits, limitable_coordinates

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
            yield Violation((*path, "limit"), "a limit without a stop", "add stop: NAME, whose limit it is", key=True)
        else:
            yield from check_latch_at_joint(draft, name, latch)
        if latch.every and latch.release is None:
            hint = "add release: a condition such as handle.angle > 0.1; without it the latch never releases"
            yield Violation((*path, "every"), "'every' without 'release'", hint, key=True)


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
