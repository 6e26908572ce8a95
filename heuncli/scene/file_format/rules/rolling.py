"""Rules about wheels: round about an axle, on a plane of another body, with valid numbers.

Rules about cams: a disc on a pin, a follower on a slide or pin of the same body, axes that fit, and a periodic
lift.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.base import tolerances
from heuncli.scene.expressions.programs import TableFunction
from heuncli.scene.file_format import format_joints as fj
from heuncli.scene.file_format.format_couplings import AXLES, CamEntry, RollingEntry, find_axle_direction, find_centre
from heuncli.scene.file_format.names import GROUND
from heuncli.scene.file_format.rotations import unit_vector
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule

# Rolling


@rule("wheel-form")
def check_wheel_form(draft: DraftDocument) -> Iterator[Violation]:
    """A disc has an axle, a sphere has none; a wheel rolls on a plane of another body."""
    planar = draft.document.head.space == "planar"
    for name, wheel in draft.document.rolling.items():
        path = ("rolling", name)
        yield from check_wheel_reference(path, wheel, draft)
        if wheel.wheel is None and find_centre(wheel, draft.document.joints) is None:
            continue  # the missing reference is reported elsewhere
        if (
            wheel.shape == "disc"
            and find_axle_direction(wheel, draft.document.joints) is None
            and wheel.axle is None
            and not planar
        ):
            hint = "add axis: its axle in body axes, for example [0, 1, 0]; for a ball write shape: sphere"
            yield Violation(path, "the disc has no axle", hint, key=True)
        for key in ("axis", "slides") if wheel.shape == "sphere" else ():
            if getattr(wheel, key) is not None:
                yield Violation((*path, key), f"{key} given for a sphere", "leave it out, or leave shape out", key=True)
        body = wheel.body if wheel.wheel is None else wheel.wheel.body
        if body == wheel.on.body:
            message, hint = (
                f"wheel and on are both on {body}",
                "a wheel rolls on another body, or on the ground",
            )
            yield Violation((*path, "on"), message, hint)
        elif body == GROUND:
            yield Violation(
                (*path, "wheel" if wheel.body is None else "body"),
                "the ground does not roll",
                "the wheel must be a body; the plane may be on the ground",
            )
        if wheel.friction is not None and wheel.friction < 0.0:
            message = f"friction must not be negative, but is {wheel.friction:g}"
            yield Violation(
                (*path, "friction"), message, "give a number such as 0.8, or leave it out for rolling without slip"
            )
        for event in (f"{name}_lifts", f"{name}_slips"):
            if event in draft.document.analysis.events:
                message = f"'{event}' is reserved: the wheel's own event has this name"
                yield Violation(("analysis", "events", event), message, "give one of them another name", key=True)
        if planar:
            yield from check_wheel_planar(path, wheel)


def check_wheel_reference(path: tuple[str, str], wheel: RollingEntry, draft: DraftDocument) -> Iterator[Violation]:
    """A wheel is given by a point of a body and a disc's axis, or by a body and the pin in which it turns."""
    if wheel.wheel is not None:
        for key in ("body", "axle"):
            if getattr(wheel, key) is not None:
                hint = "give wheel and axis, or body and axle: the pin in which it rotates"
                yield Violation((*path, key), f"wheel and {key} are both given", hint, key=True)
        return
    if wheel.body is None and wheel.axle is None:
        yield Violation(
            path, "'wheel' is missing", "give its centre: body.point; or body: and axle: (its pin)", key=True
        )
    for key, other in (("body", "axle"), ("axle", "body")):
        if getattr(wheel, key) is None and getattr(wheel, other) is not None:
            hint = (
                "add axle: the pin in which it rotates"
                if key == "axle"
                else "add body: the one of the pin's two bodies that is the wheel"
            )
            yield Violation(path, f"'{key}' is missing, but '{other}' is given", hint, key=True)
    joint = draft.document.joints.get(wheel.axle or "")
    if joint is not None and joint.type not in AXLES:
        hint = f"give a joint of type {' or '.join(AXLES)}; or give wheel: body.point and axis:"
        yield Violation(
            (*path, "axle"), f"{wheel.axle} is of type {joint.type}, which has no single axis of rotation", hint
        )
    elif joint is not None and wheel.body is not None and find_centre(wheel, draft.document.joints) is None:
        hint = f"{joint.from_.body} or {joint.to.body}"
        yield Violation((*path, "body"), f"{wheel.body} is not at the joint {wheel.axle}", hint)
    for key in ("axis",) if wheel.axle is not None and wheel.axis is not None else ():
        yield Violation((*path, key), f"axle and {key} are both given", "leave it out: the axle has an axis", key=True)


def check_wheel_planar(path: tuple[str, str], wheel: RollingEntry) -> Iterator[Violation]:
    """In a planar scene wheels turn about z and roll on lines, without sliding along them."""
    for key, is_along_z in (("axis", True), ("normal", False)):
        direction = getattr(wheel, key)
        if direction is None or direction == (0.0, 0.0, 0.0):
            continue
        x, y, z = unit_vector(direction)
        if (math.hypot(x, y) if is_along_z else abs(z)) > tolerances.PARALLEL:
            requirement = "must be the z axis" if is_along_z else "must lie in the xy plane"
            hint = "for a spatial model declare space: spatial"
            yield Violation((*path, key), f"in a planar model the {key} of a wheel {requirement}", hint)
    if wheel.slides is not None:
        message = "in a planar model a wheel that slides along its track only keeps its distance"
        yield Violation((*path, "slides"), message, "use a joint of type plane instead", key=True)


# Cams

PERIODIC = 2  # a table's kind (scene/expressions/programs.py)
CONTACTS = {
    "roller": ("radius", "the radius of the roller"),
    "flat": ("normal", "the normal of the face, axes of the follower"),
}


def iter_cams(draft: DraftDocument) -> Iterator[tuple[str, CamEntry]]:
    """Yield every cam with its name."""
    for name, coupling in draft.document.couplings.items():
        if isinstance(coupling, CamEntry):
            yield name, coupling


@rule("cam-joints")
def check_cam_joints(draft: DraftDocument) -> Iterator[Violation]:
    """A cam couples a pin with a slide or pin whose `from` is the same body; the follower's point is on the
    follower.
    """
    for name, cam in iter_cams(draft):
        path = ("couplings", name, "of")
        if len(cam.of) != 2:
            yield Violation(
                path, f"expected two joints, found {len(cam.of)}", "of: [the disc's pin, the follower's slide or pin]"
            )
            continue
        joints = [draft.document.joints.get(joint) for joint in cam.of]
        shaft, follower = joints
        if shaft is not None and not isinstance(shaft, fj.PinJoint):
            yield Violation((*path, 0), f"{cam.of[0]} is not a pin", "the disc rotates on a pin: of: [shaft, follower]")
        if follower is not None and not isinstance(follower, fj.PinJoint | fj.SlideJoint):
            yield Violation(
                (*path, 1), f"{cam.of[1]} is neither a pin nor a slide", "a follower moves on a pin or a slide"
            )
        if not isinstance(shaft, fj.PinJoint) or not isinstance(follower, fj.PinJoint | fj.SlideJoint):
            continue
        if shaft.from_.body != follower.from_.body:
            message = f"{cam.of[0]} is from {shaft.from_.body}, but {cam.of[1]} from {follower.from_.body}"
            yield Violation(
                path,
                message,
                "in both joints, from must be the body that carries disc and follower: swap from and to in one",
            )
        elif shaft.to.body == follower.to.body:
            yield Violation(path, f"disc and follower are both {shaft.to.body}", "the follower must be another body")
        elif not are_aligned(shaft.axis, follower.axis, isinstance(follower, fj.PinJoint)):
            relation = "parallel" if isinstance(follower, fj.PinJoint) else "perpendicular"
            message = f"the axis of joint {cam.of[1]} is not {relation} to that of joint {cam.of[0]}"
            yield Violation(path, message, "a follower must move perpendicular to the disc's axis")
        if cam.at.body != follower.to.body:
            message = f"the point is on {cam.at.body}, but the follower is {follower.to.body}"
            yield Violation(("couplings", name, "at"), message, "give the roller's centre, or a point of the face")


def are_aligned(first: tuple[float, float, float], second: tuple[float, float, float], parallel: bool) -> bool:
    """Whether two directions are parallel or, with parallel=False, perpendicular."""
    size = math.hypot(*first) * math.hypot(*second)
    inner = sum(x * y for x, y in zip(first, second, strict=True))
    cross = math.hypot(
        first[1] * second[2] - first[2] * second[1],
        first[2] * second[0] - first[0] * second[2],
        first[0] * second[1] - first[1] * second[0],
    )
    return (cross if parallel else abs(inner)) <= tolerances.TYPED_AXES * size


@rule("cam-contact")
def check_cam_contact(draft: DraftDocument) -> Iterator[Violation]:
    """A roller has a radius, a flat face a normal, a point neither; a follower guided on both sides never lifts."""
    for name, cam in iter_cams(draft):
        path = ("couplings", name)
        for contact, (key, meaning) in CONTACTS.items():
            is_given = getattr(cam, key) is not None
            if is_given and contact != cam.contact:
                yield Violation(
                    (*path, key), f"a {cam.contact} has no {key}", f"leave it out, or write contact: {contact}"
                )
            elif not is_given and contact == cam.contact:
                yield Violation((*path, "contact"), f"contact: {contact} needs a {key}", f"add {key}: {meaning}")
        if cam.radius is not None and cam.radius <= 0.0:
            yield Violation(
                (*path, "radius"),
                f"radius must be greater than 0, but is {cam.radius:g}",
                "without a roller write contact: point",
            )
        if cam.normal == (0.0, 0.0, 0.0):
            yield Violation((*path, "normal"), "normal is [0, 0, 0], which has no direction", "for example [0, 0, 1]")
        if cam.restitution is not None and not 0.0 <= cam.restitution <= 1.0:
            yield Violation(
                (*path, "restitution"),
                f"restitution {cam.restitution:g} is not between 0 and 1",
                "0: no rebound, 1: full rebound",
            )
        if cam.restitution is not None and cam.two_sided:
            hint = "leave out one of the two"
            yield Violation(
                (*path, "restitution"),
                "restitution given, but this follower is guided on both sides: it has no impacts",
                hint,
            )


@rule("cam-lift")
def check_cam_lift(draft: DraftDocument) -> Iterator[Violation]:
    """The lift continues smoothly over a turn: its period is one turn or a whole part of one; or it covers part of a
    turn.
    """
    for name, cam in iter_cams(draft):
        if cam.lift is None:
            continue
        if cam.lift.kind != PERIODIC:
            yield from check_partial_lift(draft, name, cam, cam.lift)
            continue
        period = cam.lift.numbers[0]
        turns = math.tau / period if period > 0.0 else 0.0
        if not (period > 0.0 and abs(turns - round(turns)) <= tolerances.TABLE_ENDS and round(turns) >= 1):
            message = (
                f"the period of table {cam.lift.name}, {math.degrees(period):.6g} deg, does not divide one revolution"
            )
            yield Violation(
                ("couplings", name, "lift"), message, "period: 360 deg, or 360 deg divided by a whole number"
            )


def check_partial_lift(draft: DraftDocument, name: str, cam: CamEntry, lift: TableFunction) -> Iterator[Violation]:
    """Yield what is wrong with a lift over part of a turn: at most one turn, and a prescribed start angle lies within
    it.
    """
    first, last = lift.x[0], lift.x[-1]
    if last - first > math.tau * (1.0 + tolerances.TABLE_ENDS):
        message = f"table {lift.name} covers {math.degrees(last - first):.6g} deg, more than one revolution"
        yield Violation(("couplings", name, "lift"), message, "period: 360 deg, or fewer points")
        return
    shaft = draft.document.joints.get(cam.of[0]) if cam.of else None
    start_angle = shaft.initial.angle if isinstance(shaft, fj.PinJoint) and shaft.initial is not None else None
    if start_angle is not None and not first + cam.phase <= start_angle <= last + cam.phase:
        covered = f"{math.degrees(first + cam.phase):.6g} to {math.degrees(last + cam.phase):.6g} deg"
        message = f"angle {math.degrees(start_angle):.6g} deg is outside the lift of cam {name}, which covers {covered}"
        hint = "start the disc within the lift, or give the lift a period"
        yield Violation(("joints", cam.of[0], "initial", "angle"), message, hint)
