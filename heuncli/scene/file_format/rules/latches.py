"""Latches: they hold a coordinate that there is, that nothing else holds, at a place to which it can come."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.base.joint_kinds import TYPES
from heuncli.base.nearest import did_you_mean
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule
from heuncli.scene.file_format.rules.stops import driven_coordinates, limited, outside
from heuncli.scene.file_format.semantics import Held, held_of, limitable, limits_of

VALUES = ("angle", "travel")
SIDES = {"lower": 0, "upper": 1}


@rule("unknown-stop")
def unknown_stop(draft: DraftDocument) -> Iterator[Violation]:
    """The stop of a latch exists."""
    stops = draft.names.entries["stops"]
    for name, latch in draft.document.latches.items():
        if latch.stop is not None and latch.stop not in stops:
            yield Violation(
                ("latches", name, "stop"), f"'{latch.stop}' is not a stop", did_you_mean(latch.stop, stops, "stops")
            )


@rule("latch-form")
def latch_form(draft: DraftDocument) -> Iterator[Violation]:
    """A latch holds at a stop, or a joint's one coordinate: at a value that is met, or where it is."""
    for name, latch in draft.document.latches.items():
        path = ("latches", name)
        if (latch.stop is None) == (latch.joint is None):
            what = "both a stop and a joint" if latch.stop is not None else "neither a stop nor a joint"
            hint = "stop: NAME, at whose limit it catches; or joint: NAME, at an angle or travel or where it is"
            yield Violation(path, f"the latch names {what}", hint, key=True)
        elif latch.stop is not None:
            yield from at_a_stop(draft, name, latch)
        elif latch.limit is not None:
            yield Violation((*path, "limit"), "a limit without a stop", "stop: NAME, whose limit it is", key=True)
        else:
            yield from at_a_joint(draft, name, latch)
        if latch.every and latch.release is None:
            hint = "release: a condition, as handle.angle > 0.1; without one it holds for ever, and catches once"
            yield Violation((*path, "every"), "'every' without 'release'", hint, key=True)


def at_a_stop(draft: DraftDocument, name: str, latch: f.LatchEntry) -> Iterator[Violation]:
    """What is wrong with a latch at a stop."""
    for key in VALUES:
        if getattr(latch, key) is not None:
            message = f"the latch at the stop {latch.stop} holds at its limit, not at an {key} of its own"
            yield Violation(("latches", name, key), message, "leave one of them out", key=True)
    stop = draft.document.stops.get(latch.stop or "")
    found = limits_of(stop) if stop is not None else None
    if latch.limit is not None and found is not None and found[1][SIDES[latch.limit]] is None:
        message = f"the stop {latch.stop} has no {latch.limit} limit"
        yield Violation(("latches", name, "limit"), message, "leave limit out, or name the other")


def at_a_joint(draft: DraftDocument, name: str, latch: f.LatchEntry) -> Iterator[Violation]:
    """What is wrong with a latch of a joint."""
    path, joint = ("latches", name), latch.joint or ""
    kind = TYPES.get(draft.names.joints.get(joint, ""))
    if kind is None:
        return
    fit = limitable(kind)
    given = [key for key in VALUES if getattr(latch, key) is not None]
    if len(fit) != 1:
        has = f"a {kind.name} has {' and '.join(fit)}" if fit else f"a {kind.name} has no coordinate"
        hint = (
            f"a stop limits the one that is meant, and the latch names it: {name}: {{stop: NAME}}"
            if fit
            else "a pin, slide or rod has one"
        )
        yield Violation((*path, "joint"), f"{has}: a latch holds one", hint)
        return
    for key in given:
        if key not in fit:
            yield Violation(
                (*path, key), f"a {kind.name} has no {key} to be held", f"a {kind.name} has {fit[0]}", key=True
            )


@rule("latch-joint")
def latch_joint(draft: DraftDocument) -> Iterator[Violation]:
    """What a latch holds is neither driven nor given, within the limits of stops, and held there by no other latch."""
    driven = driven_coordinates(draft)
    taken: dict[tuple[str, str, float | None, int], str] = {}
    for name, latch in draft.document.latches.items():
        held = held_of(latch, draft.document)
        if held is None:
            continue
        path = ("latches", name)
        where = (*path, "stop" if latch.stop is not None else "joint")
        what = f"{held.joint}.{held.quantity}"
        if (held.joint, held.quantity) in driven:
            by = driven[held.joint, held.quantity]
            hint = "let the drive's law stand still there, or hold another coordinate"
            yield Violation(where, f"{what} is driven by {by}: no latch can hold it", hint)
        rod = draft.document.joints.get(held.joint)
        fixed = [key for key in ("length", "tension_only") if getattr(rod, key, None)]
        if latch.stop is None and held.quantity == "length" and fixed:
            message = f"the rod {held.joint} gives {fixed[0]}, but until a latch catches its length is free"
            yield Violation(where, message, f"leave {fixed[0]} out")
        yield from beyond_stops(draft, name, held)
        for side in held.sides or ((0,) if held.at is not None else ()):
            other = taken.setdefault((held.joint, held.quantity, held.at, side), name)
            if other != name:
                message = f"{what} is held there by {other} already"
                yield Violation(where, message, "one latch a place: join their conditions by 'or'")


def beyond_stops(draft: DraftDocument, name: str, held: Held) -> Iterator[Violation]:
    """A value that stops do not let the coordinate come to."""
    for stop, joint, _, quantity, limits in limited(draft):
        if held.at is None or (joint, quantity) != (held.joint, held.quantity):
            continue
        for limit, beyond in zip(limits, (float.__lt__, float.__gt__), strict=True):
            if limit is not None and outside(held.at, limit, beyond):
                message = f"{quantity} comes to {held.at:.9g} nowhere: the stop {stop} ends at {limit:.9g}"
                yield Violation(("latches", name, quantity), message, f"a latch at that limit: {{stop: {stop}}}")
