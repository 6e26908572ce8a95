"""Rules about couplings: of joints that exist and have the coordinates that are coupled.

Rules about friction in threads: one number, of a plausible size, under a name that is free among the loads.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.base.joint_kinds import TYPES, format_kind_names
from heuncli.base.spelling import suggest
from heuncli.scene.file_format import format_couplings as f
from heuncli.scene.file_format.format_couplings import (
    BeltEntry,
    DifferentialEntry,
    GearEntry,
    RatioEntry,
    ScrewEntry,
    ThreadFrictionEntry,
)
from heuncli.scene.file_format.format_loads import FrictionEntry
from heuncli.scene.file_format.rules.bodies import FULL_FRICTION_HINT
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule

# Couplings

COUNTS = {"gear": (2,), "belt": (2,), "screw": (1, 2), "differential": (3,)}  # joints of a type


@rule("coupled-joint")
def check_coupled_joint(draft: DraftDocument) -> Iterator[Violation]:
    """Couplings name joints with coordinates, each once."""
    joints = draft.names.joints
    for name, coupling in draft.document.couplings.items():
        coupled_words = [] if isinstance(coupling, f.RopeEntry) else coupling.of
        for i, word in enumerate(coupled_words):
            path = ("couplings", name, "of", i)
            joint, _, quantity = word.partition(".")
            if joint not in joints:
                yield Violation(path, f"'{joint}' is not a joint", suggest(joint, joints, "joints") or "")
                continue
            kind = TYPES.get(joints[joint])
            if kind is not None and (not kind.coordinates or kind.follows_path):
                kinds_text = format_kind_names(
                    [kind for kind in TYPES.values() if kind.coordinates and not kind.follows_path], "and"
                )
                if kind.follows_path:
                    yield Violation(
                        path, f"the travel of a {kind.name} cannot be coupled", f"couplings act on {kinds_text}"
                    )
                    continue
                yield Violation(path, f"a {kind.name} has no coordinate", f"couplings act on {kinds_text}")
            elif kind is not None and quantity and quantity not in kind.coordinates:
                yield Violation(path, f"a {kind.name} has no {quantity}", f"it has {' and '.join(kind.coordinates)}")
            if word in coupled_words[:i]:
                yield Violation(path, f"{word} is given twice", "name another joint")


@rule("coupling-count")
def check_coupling_count(draft: DraftDocument) -> Iterator[Violation]:
    """Every type of coupling has its number of joints."""
    for name, coupling in draft.document.couplings.items():
        if not isinstance(coupling, GearEntry | BeltEntry | ScrewEntry | DifferentialEntry):
            continue
        counts, coupled_joints = COUNTS[coupling.type], coupling.of
        if len(coupled_joints) not in counts:
            counts_text = " or ".join(map(str, counts))
            plural = "" if len(coupled_joints) == 1 else "s"
            listed = f": {', '.join(coupled_joints)}" if coupled_joints else ""
            message = f"found {len(coupled_joints)} joint{plural}{listed}"
            yield Violation(
                ("couplings", name, "of"),
                message,
                f"a {coupling.type} needs {counts_text} joint{'s' if counts[-1] > 1 else ''}",
            )


@rule("gear-ratio")
def check_gear_ratio(draft: DraftDocument) -> Iterator[Violation]:
    """Gears have a ratio or teeth, none of them zero, and angles that teeth can have."""
    for name, gear in draft.document.couplings.items():
        if not isinstance(gear, GearEntry):
            continue
        path = ("couplings", name)
        if gear.ratio is not None and gear.teeth is not None:
            yield Violation((*path, "teeth"), "ratio and teeth are both given", "keep one of them", key=True)
        if gear.ratio == 0.0:
            yield Violation((*path, "ratio"), "a ratio of zero locks the first gear", "give another ratio")
        if gear.teeth is not None and (len(gear.teeth) != 2 or any(z < 1.0 for z in gear.teeth)):
            hint = "give the teeth of both gears, first gear first; for a ring gear add internal: true"
            teeth_text = ", ".join(f"{z:g}" for z in gear.teeth)
            yield Violation((*path, "teeth"), f"teeth must be two numbers of at least 1, found {teeth_text}", hint)
        if gear.internal and gear.teeth is None and gear.ratio is None:
            yield Violation((*path, "internal"), "internal is given without teeth", "give teeth, too", key=True)
        for key, limit in (("pressure_angle", 60.0), ("helix", 80.0)):
            angle = math.degrees(getattr(gear, key))
            low = 0.0 if key == "pressure_angle" else -limit
            if not low <= angle <= limit:
                yield Violation(
                    (*path, key), f"{angle:.4g} deg is not a possible {key}", f"give {low:g} to {limit:g} deg"
                )


@rule("flanks-rub")
def check_friction_with_teeth(draft: DraftDocument) -> Iterator[Violation]:
    """Friction by a coefficient needs gears without a pressure angle: it ignores the radial part of tooth forces."""
    forces = draft.document.forces.values()
    if not any(isinstance(load, FrictionEntry) and load.coefficient is not None for load in forces):
        return
    for name, gear in draft.document.couplings.items():
        if isinstance(gear, GearEntry) and gear.pressure_angle != 0.0:
            message = "friction given by a coefficient does not yet account for the separating force of gear teeth"
            hint = "set pressure_angle: 0 to neglect this force, or give the friction as a torque"
            yield Violation(("couplings", name), message, hint, key=True)


@rule("belt-name")
def check_belt_name(draft: DraftDocument) -> Iterator[Violation]:
    """A belt's name is free for the load of its pretension, and the name of its slack event is free."""
    for name, belt in draft.document.couplings.items():
        if not isinstance(belt, BeltEntry):
            continue
        if name in draft.names.entries["forces"]:
            message = (
                f"{name} is also the name of a force; the belt's pretension is listed as a load under the same name"
            )
            yield Violation(("couplings", name), message, "give one of them another name", key=True)
        event = f"{name}_pushes"
        if event in draft.document.analysis.events:
            message = f"'{event}' is reserved: the belt's own event has this name"
            yield Violation(("analysis", "events", event), message, "give one of them another name", key=True)


@rule("coupling-sizes")
def check_coupling_sizes(draft: DraftDocument) -> Iterator[Violation]:
    """Leads are not zero, radii are positive, pretensions are not negative, differentials move all three shafts."""
    for name, coupling in draft.document.couplings.items():
        path = ("couplings", name)
        if isinstance(coupling, ScrewEntry) and coupling.lead == 0.0:
            yield Violation((*path, "lead"), "the lead must not be 0", "give the travel per revolution")
        if isinstance(coupling, BeltEntry):
            if len(coupling.radii) != 2 or any(r <= 0.0 for r in coupling.radii):
                radii_text = ", ".join(f"{r:g}" for r in coupling.radii)
                yield Violation(
                    (*path, "radii"),
                    f"radii must be two lengths above 0, found {radii_text} m",
                    "give one for each pulley",
                )
            if coupling.pretension < 0.0:
                yield Violation(
                    (*path, "pretension"), "pretension must not be negative", "give the tension of each strand"
                )
        if isinstance(coupling, DifferentialEntry) and coupling.ratio in (0.0, 1.0):
            message = f"a ratio of {coupling.ratio:g} leaves one of the three shafts free"
            yield Violation((*path, "ratio"), message, "for equal wheels write -1; for other relations use type: ratio")


@rule("coupling-terms")
def check_coupling_terms(draft: DraftDocument) -> Iterator[Violation]:
    """A linear relation has give at least two joints, and one factor for each, none of them zero."""
    for name, coupling in draft.document.couplings.items():
        if not isinstance(coupling, RatioEntry):
            continue
        if len(coupling.factors) != len(coupling.of) or len(coupling.of) < 2:
            joint_count, factor_count = len(coupling.of), len(coupling.factors)
            joints, factors = ("" if n == 1 else "s" for n in (joint_count, factor_count))
            message = f"found {joint_count} joint{joints} and {factor_count} factor{factors}"
            yield Violation(
                ("couplings", name, "factors"), message, "give at least two joints, and one factor for each"
            )
        for i, factor in enumerate(coupling.factors):
            if factor == 0.0:
                hint = "leave the joint out, or give its factor"
                yield Violation(("couplings", name, "factors", i), "a factor of zero couples nothing", hint)


@rule("rope-way")
def check_rope_places(draft: DraftDocument) -> Iterator[Violation]:
    """A rope has two places at least; each is a point, or a sheave with a radius and perhaps an axis and a side."""
    for name, rope in draft.document.couplings.items():
        if not isinstance(rope, f.RopeEntry):
            continue
        path = ("couplings", name, "through")
        if len(rope.through) < 2:
            yield Violation(path, f"a rope needs at least two places, found {len(rope.through)}", "give its two ends")
        for i, place in enumerate(rope.through):
            for message, hint in find_place_errors(place):
                yield Violation((*path, i), message, hint)


def find_place_errors(place: f.PassageEntry) -> Iterator[tuple[str, str]]:
    """Yield what is wrong with one place of a rope: message and hint."""
    if (place.point is None) == (place.sheave is None):
        yield "give either a point or a sheave", "write body.point, or {sheave: body.point, radius: 0.3}"
    elif place.sheave is not None and (place.radius is None or not place.radius > 0.0):
        yield "the sheave has no radius", "add radius: 0.3; for a point the rope slides through write body.point"
    elif place.point is not None:
        keys = [key for key in ("radius", "axis", "side", "slip") if key in place.model_fields_set]
        if keys:
            yield (
                f"{keys[0]} given for a point without a sheave",
                "for a sheave write {sheave: body.point, radius: 0.3}",
            )


@rule("rope-bounds")
def check_rope_bounds(draft: DraftDocument) -> Iterator[Violation]:
    """A rope has a positive length in time alone; restitution is for one that only pulls, from 0 to 1."""
    for name, rope in draft.document.couplings.items():
        if not isinstance(rope, f.RopeEntry):
            continue
        path = ("couplings", name)
        length = None if rope.length is None else rope.length.constant
        if rope.length is not None and rope.length.uses:
            joint, coordinate = rope.length.uses[0]
            yield Violation(
                (*path, "length"), f"a rope's length may depend on time alone, not on {joint}.{coordinate}", "use t"
            )
        if length is not None and not length > 0.0:
            yield Violation(
                (*path, "length"),
                f"length must be greater than 0, but is {length:g} m",
                "leave it out for the length as assembled",
            )
        if rope.length is not None and any(place.slip == "none" for place in rope.through):
            message = "a length is given for a rope that does not slip on a sheave"
            yield Violation(
                (*path, "length"),
                message,
                "leave it out: the wound length is not known; to wind the rope, drive the drum's pin",
            )
        yield from check_rope_tension(name, rope)
        yield from check_rope_elasticity(name, rope)
        if rope.restitution is None:
            continue
        if not 0.0 <= rope.restitution <= 1.0:
            message = f"restitution {rope.restitution:g} is not between 0 and 1"
            yield Violation((*path, "restitution"), message, "0: it stays taut, 1: full rebound")
        if not rope.tension_only:
            message = "restitution given, but this rope never goes slack: it has no impacts"
            yield Violation((*path, "restitution"), message, "add tension_only: true")


def check_rope_tension(name: str, rope: f.RopeEntry) -> Iterator[Violation]:
    """Yield what is wrong with a rope of given tension, whose length is whatever it has to be."""
    if rope.tension is None:
        return
    path = ("couplings", name)
    given = [key for key in ("length", "stiffness", "damping", "restitution") if getattr(rope, key) is not None]
    for key in given + ["tension_only"] * rope.tension_only:
        message = f"{key} is given for a rope of given tension, whose length is free"
        yield Violation((*path, key), message, f"leave {key} or the tension out", key=True)
    if any(place.slip == "none" for place in rope.through):
        message = "a rope of given tension cannot be fixed to a sheave"
        yield Violation((*path, "tension"), message, "use slip: free, or put a torque on the drum instead")
    if rope.tension.constant is not None and rope.tension.constant < 0.0:
        message = f"tension must not be below 0, but is {rope.tension.constant:g} N"
        yield Violation((*path, "tension"), message, "a rope only pulls")


def check_rope_elasticity(name: str, rope: f.RopeEntry) -> Iterator[Violation]:
    """Yield what is wrong with the elasticity of a rope."""
    path = ("couplings", name)
    if rope.stiffness is None:
        if rope.damping is not None:
            yield Violation((*path, "damping"), "damping of an inextensible rope", "add stiffness: 4e5 N/m")
        return
    if not rope.stiffness > 0.0:
        message = f"stiffness must be greater than 0, but is {rope.stiffness:g} N/m"
        yield Violation(
            (*path, "stiffness"), message, "EA/length of the whole rope; leave it out for an inextensible rope"
        )
    if rope.damping is not None and rope.damping < 0.0:
        yield Violation((*path, "damping"), f"damping {rope.damping:g} N·s/m is below 0", "give 0 or a positive value")
    if rope.restitution is not None:
        message = "restitution of a rope that stretches, which has no impacts"
        yield Violation((*path, "restitution"), message, "with tension_only: true alone it goes slack and catches")
    if any(place.slip == "none" for place in rope.through):
        message = "a rope that stretches cannot be fixed to a sheave: its strain where it winds on is unknown"
        hint = "use slip: free, leave out the stiffness, or use two ropes, each ending at a point of the rim"
        yield Violation((*path, "stiffness"), message, hint)


# Threads


@rule("thread-friction")
def check_thread_friction(draft: DraftDocument) -> Iterator[Violation]:
    """Thread friction has a coefficient or an efficiency, a mean radius and a speed; no force has the thread's name."""
    for name, screw in draft.document.couplings.items():
        if not isinstance(screw, ScrewEntry) or screw.friction is None:
            continue
        path = ("couplings", name)
        for key, message, hint in find_friction_errors(screw.friction):
            yield Violation((*path, "friction", *([key] if key else [])), message, hint)
        if name in draft.names.entries["forces"]:
            message = (
                f"{name} is also the name of a force, but the thread's friction is listed under it among the loads"
            )
            yield Violation(path, message, "give one of them another name", key=True)


def find_friction_errors(friction: ThreadFrictionEntry) -> Iterator[tuple[str, str, str]]:
    """Yield what is wrong with the numbers: the key or an empty text, the message, a hint."""
    if (friction.coefficient is None) == (friction.efficiency is None):
        what = (
            "neither coefficient nor efficiency is"
            if friction.coefficient is None
            else "both coefficient and efficiency are"
        )
        yield "", f"{what} given", "give coefficient: 0.12 (of the flanks) or efficiency: 0.4 (rotation to thrust)"
    if friction.coefficient is not None and friction.coefficient < 0.0:
        yield "coefficient", f"coefficient must not be negative, but is {friction.coefficient:g}", "for example 0.12"
    if friction.efficiency is not None and not 0.0 < friction.efficiency <= 1.0:
        yield "efficiency", f"efficiency must be above 0 and at most 1, not {friction.efficiency:g}", "for example 0.4"
    if friction.efficiency is not None and friction.flank_angle != 0.0:
        yield "flank_angle", "flank_angle given with an efficiency, which already includes all losses", "leave it out"
    if not friction.radius > 0.0:
        yield (
            "radius",
            f"radius must be greater than 0, but is {friction.radius:g} m",
            "half the mean diameter of the thread",
        )
    if not 0.0 <= friction.flank_angle <= math.radians(60.0):
        angle_text = f"{math.degrees(friction.flank_angle):.4g} deg"
        yield (
            "flank_angle",
            f"{angle_text} is not a possible flank angle",
            "half the thread angle: 15 deg for Tr, 30 deg for M",
        )
    if friction.static is not None and friction.speed is not None:
        message = "static is for friction that sticks, and with a speed it is smoothed and does not"
        yield "static", message, "leave out speed, or static"
    elif friction.static is not None and friction.coefficient is None:
        yield "static", "static is given with an efficiency", "give coefficient in place of efficiency, or leave it out"
    elif friction.static is not None and friction.static < (friction.coefficient or 0.0):
        message = f"static, {friction.static:g}, is below the kinetic friction, {friction.coefficient:g}"
        yield "static", message, "what sticks holds at least as much: give the larger number here"
    if friction.speed is not None and not friction.speed > 0.0:
        yield "speed", f"speed must be greater than 0, but is {friction.speed:g}", FULL_FRICTION_HINT
