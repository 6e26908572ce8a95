"""Modes as a table, and in long form."""

from __future__ import annotations

import math

from heuncli.base.foreign_text import shown
from heuncli.base.joint_kinds import is_length
from heuncli.motion.linearisation.modes import SceneModes
from heuncli.motion.linearisation.oscillations import Mode
from heuncli.output.tables.mode_words import about, figures_of, notes
from heuncli.output.tables.page_width import fit
from heuncli.output.tables.text_table import WIDTH, TextColumn, TextTable, plain
from heuncli.version import VERSION

HEADING = "MODES  motions exp(growth t) cos(2π frequency t): damping ratio -growth/|growth + 2πi frequency|"
COLUMNS = (
    TextColumn("mode"), TextColumn("frequency Hz"), TextColumn("period s"), TextColumn("damping"),
    TextColumn("growth 1/s"), TextColumn("kind", "left"), TextColumn("what moves most (rad, m)", "left"),
)  # fmt: skip
CSV_COLUMNS = "mode,kind,name,quantity,component,unit,value"
ALMOST = 0.02  # of the largest: a smaller part of the other phase is not worth a table's room


def table(found: SceneModes) -> TextTable:
    """The modes, a row each; notes say what is unstable, and what nothing holds."""
    rows = tuple(row(k, mode, found) for k, mode in enumerate(found.modes))
    return TextTable(HEADING, COLUMNS, rows, tuple(notes(found)))


def page(found: SceneModes) -> list[tuple[str, str]]:
    """Label and text of the lines above the table."""
    state, *more = about(found)
    return [("heun", f"{VERSION}  {found.title}"), ("modes", state), *(("", line) for line in more)]


def write(found: SceneModes) -> str:
    """The page as text."""
    lines = page(found)
    head = "".join(f"{label.ljust(5)}  {shown(text)}\n" for label, text in lines)
    return head + ("\n" + "".join(plain(part, WIDTH) for part in fit(table(found), WIDTH)) if found.modes else "")


def row(k: int, mode: Mode, found: SceneModes) -> tuple[str, ...]:
    """A mode's cells: digits as far as its error lets them be."""
    return str(k + 1), *figures_of(mode), mode.kind, moving(k, found)


def moving(k: int, found: SceneModes) -> str:
    """The coordinates that move most, with their amplitudes."""
    shape = found.shapes[k]
    return ", ".join(f"{name} {amplitude(shape[name])}" for name in found.largest[k] if name in shape)


def amplitude(x: complex) -> str:
    """An amplitude relative to the largest, with its phase where that is neither along nor against it."""
    if abs(x.imag) <= ALMOST * abs(x):
        return f"{x.real:.3g}"
    return f"{abs(x):.3g}∠{math.degrees(math.atan2(x.imag, x.real)):.0f}°"


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
