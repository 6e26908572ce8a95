"""How modes are told in tables and pictures alike: about which state, in which figures, what is unstable or free."""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.base.named_tuples import NamedTuple
from heuncli.motion.linearisation.modes import SceneModes
from heuncli.motion.linearisation.oscillations import Mode
from heuncli.study.quantities.digits import rough, style

ABOUT = {"rest": "about the rest pose", "state": "about the start"}
FRAME = ", as seen by what moves steadily there"
HELD = ", its drives held where they are"
SOFT = 1e-3  # [1/s]: a bound on what is free is told if it leaves motions that take less than an hour or two


def about(found: SceneModes) -> list[str]:
    """Sentences on what oscillates about which state, and whether it is stable."""
    frame = FRAME if found.steady else HELD if found.held else ""
    lines = [f"small oscillations {ABOUT[found.at]}{frame}"]
    if found.without:
        lines.append(f"without {', '.join(map(left_out, found.without))}")
    if not found.modes:
        return [*lines, "nothing is free to oscillate"]
    unstable = any(mode.growth > 0.0 for mode in found.modes)
    loose = any(mode.kind == "free" for mode in found.modes)
    return [*lines, "unstable" if unstable else "stable, but for what nothing holds" if loose else "stable"]


def left_out(entry: str) -> str:
    """An entry that was left out, or is held, in words."""
    return f"{entry}'s motion, held where it starts" if entry.startswith("drives.") else entry


class ModeFigures(NamedTuple):
    """A mode's numbers as texts, with as many digits as its error lets be; empty where there is none."""

    frequency: str
    period: str
    damping: str
    growth: str


def figures_of(mode: Mode) -> ModeFigures:
    """A mode's numbers: frequency [Hz], period [s], damping ratio, growth [1/s]."""
    hertz = mode.error / (2.0 * math.pi)
    frequency = style(mode.frequency, hertz).write(mode.frequency) if mode.frequency else "0"
    seconds = 1.0 / mode.frequency if mode.frequency else 0.0
    period = style(seconds, hertz * seconds**2).write(seconds) if seconds else ""
    growth = style(abs(mode.growth), mode.error).write(mode.growth) if mode.growth else "0"
    size = abs(mode.eigenvalue)
    damping = style(abs(mode.damping), mode.error / size).write(mode.damping) if size and mode.damping else "0"
    if mode.kind == "free":
        damping = ""
    return ModeFigures(frequency, period, damping, growth)


def notes(found: SceneModes) -> Iterator[str]:
    """Sentences on what is unstable and what is free."""
    for k, mode in enumerate(found.modes):
        names = ", ".join(found.largest[k])
        if mode.kind == "free":
            bound = rough(mode.error / (2.0 * math.pi))
            beside = f", or too softly to tell it beside what is so stiff: less than {bound} Hz"
            yield f"free: {names}: nothing holds it{beside if mode.error > SOFT else ''}"
        elif mode.growth > 0.0:
            yield f"unstable: mode {k + 1}, {names}: e times as large after every {1.0 / mode.growth:.3g} s"
