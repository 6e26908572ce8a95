"""Modes as a table, and in long form."""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.foreign_text import shown
from heuncli.joint_kinds import is_length
from heuncli.linearisation.modes import SceneModes
from heuncli.linearisation.oscillations import Mode
from heuncli.report.digits import rough, style
from heuncli.report.page_width import fit
from heuncli.report.text_table import WIDTH, TextColumn, TextTable, plain
from heuncli.version import VERSION

ABOUT = {"rest": "about the rest pose", "state": "about the start"}
FRAME = ", as seen by what moves steadily there"
HELD = ", its drives held where they are"
HEADING = "MODES  motions exp(growth t) cos(2π frequency t): damping ratio -growth/|growth + 2πi frequency|"
COLUMNS = (
    TextColumn("mode"), TextColumn("frequency Hz"), TextColumn("period s"), TextColumn("damping"),
    TextColumn("growth 1/s"), TextColumn("kind", "left"), TextColumn("what moves most (rad, m)", "left"),
)  # fmt: skip
CSV_COLUMNS = "mode,kind,name,quantity,component,unit,value"
SOFT = 1e-3  # [1/s]: a bound on what is free is told if it leaves motions that take less than an hour or two
ALMOST = 0.02  # of the largest: a smaller part of the other phase is not worth a table's room


def table(found: SceneModes) -> TextTable:
    """The modes, a row each; notes say what is unstable, and what nothing holds."""
    rows = tuple(row(k, mode, found) for k, mode in enumerate(found.modes))
    return TextTable(HEADING, COLUMNS, rows, tuple(notes(found)))


def page(found: SceneModes) -> list[tuple[str, str]]:
    """Label and text of the lines above the table."""
    frame = FRAME if found.steady else HELD if found.held else ""
    lines = [("heun", f"{VERSION}  {found.title}"), ("modes", f"small oscillations {ABOUT[found.at]}{frame}")]
    if found.without:
        lines.append(("", f"without {', '.join(map(left_out, found.without))}"))
    if not found.modes:
        return [*lines, ("", "nothing is free to oscillate")]
    unstable = any(mode.growth > 0.0 for mode in found.modes)
    loose = any(mode.kind == "free" for mode in found.modes)
    return [*lines, ("", "unstable" if unstable else "stable, but for what nothing holds" if loose else "stable")]


def left_out(entry: str) -> str:
    """An entry that was left out, or is held, in words."""
    return f"{entry}'s motion, held where it starts" if entry.startswith("drives.") else entry


def write(found: SceneModes) -> str:
    """The page as text."""
    lines = page(found)
    head = "".join(f"{label.ljust(5)}  {shown(text)}\n" for label, text in lines)
    return head + ("\n" + "".join(plain(part, WIDTH) for part in fit(table(found), WIDTH)) if found.modes else "")


def row(k: int, mode: Mode, found: SceneModes) -> tuple[str, ...]:
    """A mode's cells: digits as far as its error lets them be."""
    hertz = mode.error / (2.0 * math.pi)
    frequency = style(mode.frequency, hertz).write(mode.frequency) if mode.frequency else "0"
    seconds = 1.0 / mode.frequency if mode.frequency else 0.0
    period = style(seconds, hertz * seconds**2).write(seconds) if seconds else ""
    growth = style(abs(mode.growth), mode.error).write(mode.growth) if mode.growth else "0"
    size = abs(mode.eigenvalue)
    damping = style(abs(mode.damping), mode.error / size).write(mode.damping) if size and mode.damping else "0"
    if mode.kind == "free":
        damping = ""
    return str(k + 1), frequency, period, damping, growth, mode.kind, moving(k, found)


def moving(k: int, found: SceneModes) -> str:
    """The coordinates that move most, with their amplitudes."""
    shape = found.shapes[k]
    return ", ".join(f"{name} {amplitude(shape[name])}" for name in found.largest[k] if name in shape)


def amplitude(x: complex) -> str:
    """An amplitude relative to the largest, with its phase where that is neither along nor against it."""
    if abs(x.imag) <= ALMOST * abs(x):
        return f"{x.real:.3g}"
    return f"{abs(x):.3g}∠{math.degrees(math.atan2(x.imag, x.real)):.0f}°"


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


def to_csv(found: SceneModes) -> str:
    """The modes in long form, a line a number."""
    lines = [CSV_COLUMNS]
    for k, (mode, shape) in enumerate(zip(found.modes, found.shapes, strict=True)):
        for quantity, unit, value in (
            ("frequency", "Hz", mode.frequency), ("damping", "1", mode.damping), ("growth", "1/s", mode.growth),
            ("error", "1/s", mode.error),
        ):  # fmt: skip
            lines.append(f"{k + 1},{mode.kind},,{quantity},,{unit},{value!r}")
        for name, x in shape.items():
            unit = "m" if is_length(name) else "rad"
            for part, value in (("re", x.real), ("im", x.imag)):
                lines.append(f"{k + 1},{mode.kind},{name},shape,{part},{unit},{value!r}")
    return "\n".join(lines) + "\n"
