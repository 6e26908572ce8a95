"""Words for modes in tables and figures: reference state, numbers, what is unstable or free."""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.base.named_tuples import NamedTuple
from heuncli.motion.linearisation.oscillations import Mode, SceneModes
from heuncli.study.quantities.digits import choose_style, format_error

STATE_PHRASES = {"rest": "about the rest position", "state": "about the start"}
FRAME_PHRASE = ", in the frame of the steady motion"
HELD_DRIVES_PHRASE = ", with drives fixed in place"
SOFT_GROWTH = 1e-3  # [1/s]: a bound is shown if it allows motions faster than one or two hours


def describe_modes(scene_modes: SceneModes) -> list[str]:
    """Return sentences that say about which state the scene oscillates, and whether that state is stable."""
    frame = FRAME_PHRASE if scene_modes.is_steady else HELD_DRIVES_PHRASE if scene_modes.has_held_drives else ""
    lines = [f"small oscillations {STATE_PHRASES[scene_modes.reference]}{frame}"]
    if scene_modes.omitted_paths:
        lines.append(f"without {', '.join(map(describe_excluded, scene_modes.omitted_paths))}")
    if scene_modes.sticking_paths:
        lines.append(f"held by friction: {', '.join(scene_modes.sticking_paths)}")
    if not scene_modes.modes:
        return [*lines, "0 degrees of freedom, so no modes"]
    unstable = any(mode.growth > 0.0 for mode in scene_modes.modes)
    has_free = any(mode.kind == "free" for mode in scene_modes.modes)
    return [*lines, "unstable" if unstable else "stable, except for unrestrained motions" if has_free else "stable"]


def describe_coordinate(name: str) -> str:
    """Describe a coordinate by its axis: `tub.z` becomes `tub: rotation about z`, others keep their name."""
    owner, _, quantity = name.rpartition(".")
    if quantity in ("x", "y", "z"):
        return f"{owner}: rotation about {quantity}"
    return f"{owner}: displacement along {quantity[1]}" if quantity in ("dx", "dy", "dz") else name


def describe_excluded(entry: str) -> str:
    """Describe an entry that was left out or is held fixed."""
    return f"motion of {entry}, fixed at its start" if entry.startswith("drives.") else entry


class ModeTexts(NamedTuple):
    """The numbers of a mode as texts, with the digits that its error leaves; empty if there is none."""

    frequency: str
    period: str
    damping: str
    growth: str


def format_mode(mode: Mode) -> ModeTexts:
    """Format the numbers of a mode: frequency [Hz], period [s], damping ratio, growth [1/s]."""
    hertz = mode.error / (2.0 * math.pi)
    frequency = choose_style(mode.frequency, hertz).write(mode.frequency) if mode.frequency else "0"
    seconds = 1.0 / mode.frequency if mode.frequency else 0.0
    period = choose_style(seconds, hertz * seconds**2).write(seconds) if seconds else ""
    growth = choose_style(abs(mode.growth), mode.error).write(mode.growth) if mode.growth else "0"
    size = abs(mode.eigenvalue)
    damping = choose_style(abs(mode.damping), mode.error / size).write(mode.damping) if size and mode.damping else "0"
    if mode.kind == "free":
        damping = ""
    return ModeTexts(frequency, period, damping, growth)


def iter_notes(scene_modes: SceneModes) -> Iterator[str]:
    """Yield sentences on what is unstable and what is free."""
    for k, mode in enumerate(scene_modes.modes):
        names = ", ".join(map(describe_coordinate, scene_modes.largest[k]))
        if mode.kind == "free":
            bound = format_error(mode.error / (2.0 * math.pi))
            stiffness_note = f" that can be resolved next to the stiff parts: below {bound} Hz"
            yield f"free: {names}: no restoring force{stiffness_note if mode.error > SOFT_GROWTH else ''}"
        elif mode.growth > 0.0:
            yield f"unstable: mode {k + 1}, {names}: grows by a factor of e every {1.0 / mode.growth:.3g} s"
