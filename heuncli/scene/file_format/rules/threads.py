"""What rubs in threads: by one number, of a size that friction has, under a name of its own among the loads."""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.scene.file_format.format_couplings import ScrewEntry, ThreadFrictionEntry
from heuncli.scene.file_format.rules.bodies import FULL
from heuncli.scene.file_format.rules.registry import DraftDocument, Violation, rule


@rule("thread-friction")
def thread_friction(draft: DraftDocument) -> Iterator[Violation]:
    """A coefficient or an efficiency, a mean radius, a rate at which it is full; no force has the thread's name."""
    for name, screw in draft.document.couplings.items():
        if not isinstance(screw, ScrewEntry) or screw.friction is None:
            continue
        path = ("couplings", name)
        for key, message, hint in wrong(screw.friction):
            yield Violation((*path, "friction", *([key] if key else [])), message, hint)
        if name in draft.names.entries["forces"]:
            message = f"{name} is the name of a force, too, and the thread's friction has it among the loads"
            yield Violation(path, message, "give one of them another name", key=True)


def wrong(rubs: ThreadFrictionEntry) -> Iterator[tuple[str, str, str]]:
    """What is wrong with the numbers: the key, or none; the message, a hint."""
    if (rubs.coefficient is None) == (rubs.efficiency is None):
        what = "neither coefficient nor efficiency" if rubs.coefficient is None else "coefficient and efficiency"
        yield "", f"{what} given", "coefficient: 0.12 of the flanks, or efficiency: 0.4 of turning into thrust"
    if rubs.coefficient is not None and rubs.coefficient < 0.0:
        yield "coefficient", f"coefficient must not be negative, but is {rubs.coefficient:g}", "as 0.12"
    if rubs.efficiency is not None and not 0.0 < rubs.efficiency <= 1.0:
        yield "efficiency", f"an efficiency of {rubs.efficiency:g}", "a number above 0 and up to 1, as 0.4"
    if rubs.efficiency is not None and rubs.flank_angle != 0.0:
        yield "flank_angle", "flank_angle with an efficiency, which tells all of the loss", "leave it out"
    if not rubs.radius > 0.0:
        yield "radius", f"a radius of {rubs.radius:g} m", "half the mean diameter of the thread, above 0"
    if not 0.0 <= rubs.flank_angle <= math.radians(60.0):
        told = f"{math.degrees(rubs.flank_angle):.4g} deg"
        yield "flank_angle", f"{told} is no angle of a flank", "half the thread's own: 15 deg of Tr, 30 deg of M"
    if not rubs.speed > 0.0:
        yield "speed", f"speed must be more than 0, not {rubs.speed:g}", FULL
