"""Rules about wheels: round about an axle, on a plane of another body, with valid numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.base import tolerances
from heuncli.scene.file_format.format_rolling import AXLES, RollingEntry, find_axle_direction, find_centre
from heuncli.scene.file_format.names import GROUND
from heuncli.scene.file_format.rotations import unit_vector
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule


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
            yield Violation(path, "a disc without an axle", hint, key=True)
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
