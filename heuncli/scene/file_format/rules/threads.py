"""Rules about friction in threads: one number, of a plausible size, under a name that is free among the loads."""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.scene.file_format.format_couplings import ScrewEntry, ThreadFrictionEntry
from heuncli.scene.file_format.rules.bodies import FULL_FRICTION_HINT
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule


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
    if not friction.speed > 0.0:
        yield "speed", f"speed must be greater than 0, but is {friction.speed:g}", FULL_FRICTION_HINT
