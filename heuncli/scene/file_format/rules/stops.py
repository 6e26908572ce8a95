"""Stops and ropes that catch: limits of a coordinate that there is, reached from within, struck without friction."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator

from heuncli.base import tolerances
from heuncli.base.joint_kinds import TYPES, Kind, named
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_couplings as fc
from heuncli.scene.file_format.names import CAUSES
from heuncli.scene.file_format.rules import paths
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule
from heuncli.scene.file_format.semantics import Limits, drive_of, limitable, limits_of

LIMITED = ("angle", "travel", "length")


class Limited(NamedTuple):
    """A stop that can be judged: its name, its joint's name and kind, the coordinate and its limits."""

    name: str
    joint: str
    kind: Kind
    quantity: str
    limits: Limits


def limited(draft: DraftDocument) -> Iterator[Limited]:
    """Stops of one coordinate that their joints have."""
    for name, stop in draft.document.stops.items():
        kind = TYPES.get(draft.names.joints.get(stop.joint, ""))
        given = limits_of(stop)
        if kind is not None and given is not None and given[0] in limitable(kind):
            yield Limited(name, stop.joint, kind, *given)


@rule("stop-form")
def stop_form(draft: DraftDocument) -> Iterator[Violation]:
    """A stop limits one coordinate, which its joint has, on one side at least and to a range that is not empty."""
    for name, stop in draft.document.stops.items():
        path = ("stops", name)
        quantities = [key for key in LIMITED if getattr(stop, key) is not None]
        kind = TYPES.get(draft.names.joints.get(stop.joint, ""))
        fit = limitable(kind) if kind is not None else LIMITED
        if len(quantities) != 1:
            what = " and ".join(quantities) if quantities else "nothing"
            hint = f"a {kind.name} has {' and '.join(fit)}" if kind and fit else f"one of {', '.join(LIMITED)}"
            yield Violation(path, f"the stop limits {what}", hint, key=True)
            continue
        where = (*path, quantities[0])
        if quantities[0] not in fit:
            assert kind is not None
            able = named([kind for kind in TYPES.values() if limitable(kind)], "and")
            hint = f"a {kind.name} has {' and '.join(fit)}" if fit else f"stops limit {able}"
            yield Violation(where, f"a {kind.name} has no {quantities[0]} to be limited", hint, key=True)
            continue
        low, high = getattr(stop, quantities[0])
        if low is None and high is None:
            yield Violation(where, "a stop without a limit", "null is no limit: [null, 0.2] has one")
        elif low is not None and high is not None and not low < high:
            message = f"the limits {low:g} and {high:g} leave no way between them"
            yield Violation(where, message, "the lower limit stands first")


@rule("stop-joint")
def stop_joint(draft: DraftDocument) -> Iterator[Violation]:
    """What a stop limits is neither driven nor given, and no other stop stands on that side of it."""
    driven = driven_coordinates(draft)
    taken: dict[tuple[str, str, int], str] = {}
    for name, joint, _, quantity, limits in limited(draft):
        path = ("stops", name)
        if (joint, quantity) in driven:
            message = f"{joint}.{quantity} is driven by {driven[joint, quantity]}: no stop can hold it"
            yield Violation((*path, quantity), message, "drive something else, or leave the stop out", key=True)
        rod = draft.document.joints.get(joint)
        given = [key for key in ("length", "tension_only") if getattr(rod, key, None)]
        if quantity == "length" and given:
            message = f"the rod {joint} gives {given[0]}, but between the limits of a stop its length is free"
            hint = "a rope that catches: tension_only and restitution, without a stop"
            yield Violation((*path, "joint"), message, f"leave {given[0]} out, or {hint}")
        for side, limit in enumerate(limits):
            other = taken.setdefault((joint, quantity, side), name) if limit is not None else name
            if other != name:
                message = f"{joint}.{quantity} is limited from {('below', 'above')[side]} by {other} already"
                yield Violation((*path, quantity, side), message, "one stop a side")


def driven_coordinates(draft: DraftDocument) -> dict[tuple[str, str], str]:
    """The drives by what they drive: a joint and its coordinate."""
    found: dict[tuple[str, str], str] = {}
    for name, drive in draft.document.drives.items():
        prescribed = drive_of(drive, draft.names.joints.get(drive.joint))
        if prescribed is not None:
            found[drive.joint, prescribed.quantity] = name
    return found


@rule("stop-start")
def stop_start(draft: DraftDocument) -> Iterator[Violation]:
    """A held start value lies within the limits."""
    for name, joint, _, quantity, limits in limited(draft):
        held = getattr(getattr(draft.document.joints.get(joint), "initial", None), quantity, None)
        for limit, beyond in zip(limits, (float.__lt__, float.__gt__), strict=True):
            if held is not None and limit is not None and outside(held, limit, beyond):
                message = f"{quantity} is held at {held:.9g}, beyond the limit {limit:.9g} of the stop {name}"
                yield Violation(("joints", joint, "initial", quantity), message, "start within the limits")


def outside(value: float, limit: float, beyond: Callable[[float, float], bool]) -> bool:
    """Whether a value is beyond a limit, not merely at it."""
    return beyond(value, limit) and abs(value - limit) > tolerances.AT_LIMIT * max(abs(limit), 1.0)


@rule("restitution")
def restitution(draft: DraftDocument) -> Iterator[Violation]:
    """A strike gives back between nothing and all of the speed, and only what may go slack is ever struck."""
    hint = "0: no rebound, 1: all of it"
    for name, stop in draft.document.stops.items():
        if not 0.0 <= stop.restitution <= 1.0:
            message = f"restitution {stop.restitution:g} is not between 0 and 1"
            yield Violation(("stops", name, "restitution"), message, hint)
    for name, joint in draft.document.joints.items():
        path = ("joints", name, "restitution")
        if not isinstance(joint, f.RodJoint) or joint.restitution is None:
            continue
        if not joint.tension_only:
            message = "restitution of a rod that holds both ways, and so is never struck"
            yield Violation(path, message, "a rope: tension_only: true; between limits: stops", key=True)
        if not 0.0 <= joint.restitution <= 1.0:
            yield Violation(path, f"restitution {joint.restitution:g} is not between 0 and 1", hint)
    yield from paths.struck(draft)


def struck_joints(draft: DraftDocument) -> list[str]:
    """The joints that open and close with blows: ropes, and curves that press on one side."""
    opening = f.RodJoint | f.CurveJoint
    return [n for n, j in draft.document.joints.items() if isinstance(j, opening) and j.restitution is not None]


def has_load(coupling: fc.ScrewEntry | fc.RopeEntry) -> bool:
    """Whether a coupling is a load by its name: a rope that stretches, a thread that rubs."""
    return getattr(coupling, "stiffness", None) is not None or getattr(coupling, "friction", None) is not None


@rule("shared-name")
def shared_name(draft: DraftDocument) -> Iterator[Violation]:
    """What strikes, and what stands beside it in the results, is told by its name."""
    entries = draft.names.entries
    joints, couplings = struck_joints(draft), draft.document.couplings
    struck = [name for name, own in couplings.items() if getattr(own, "restitution", None) is not None]
    loads = [name for name, own in couplings.items() if isinstance(own, fc.ScrewEntry | fc.RopeEntry) and has_load(own)]
    beside: dict[str, dict[str, Collection[str]]] = {
        "impulses": {"joints": joints, "couplings": struck, "drives": entries["drives"]},
        "stops": {block: entries[block] for block in ("joints", "forces", "drives", "impulses")}
        | {"couplings": struck},
        "latches": {block: entries[block] for block in ("joints", "forces", "drives", "impulses", "stops", "events")}
        | {"couplings": struck},
        "rolling": {block: entries[block] for block in ("couplings", "forces", "drives", "stops", "latches")},
        "forces": {"couplings": loads},
    }
    if struck:
        beside["joints"] = {"couplings": [name for name in struck if name in joints]}
    for name in CAUSES.intersection(joints):
        hint = f"call it {name}_1, say"
        yield Violation(
            ("joints", name), f"'{name}' is taken: it is a cause of its own, and this strikes", hint, key=True
        )
    for block, others in beside.items():
        for name in entries[block]:
            for other, names in others.items():
                if name in names:
                    message = f"'{name}' is taken: {other}.{name} stands beside it in the results"
                    yield Violation((block, name), message, f"call it {name}_1, say", key=True)
