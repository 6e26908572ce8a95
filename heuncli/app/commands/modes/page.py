"""Render modes as a table, and in long form."""

from __future__ import annotations

import math

from heuncli.base.joint_kinds import is_length
from heuncli.base.text_safety import escape
from heuncli.motion.linearisation.oscillations import Mode, SceneModes
from heuncli.output.tables.mode_words import describe_modes, format_mode, iter_notes
from heuncli.output.tables.page_width import split_to_width
from heuncli.output.tables.text_table import DEFAULT_WIDTH, TextColumn, TextTable, format_plain
from heuncli.version import VERSION

HEADING = "MODES  motion exp(growth·t) cos(2π·frequency·t); damping ratio = -growth / |growth + 2πi·frequency|"
COLUMNS = (
    TextColumn("mode"), TextColumn("frequency Hz"), TextColumn("period s"), TextColumn("damping"),
    TextColumn("growth 1/s"), TextColumn("kind", "left"), TextColumn("largest amplitudes (rad, m)", "left"),
)  # fmt: skip
CSV_COLUMNS = "mode,kind,name,quantity,component,unit,value"
PHASE_TOLERANCE = 0.02  # relative; a smaller out-of-phase part is not shown


def make_table(scene_modes: SceneModes) -> TextTable:
    """Make the table of the modes, one row each; notes name unstable modes and free directions."""
    rows = tuple(make_row(k, mode, scene_modes) for k, mode in enumerate(scene_modes.modes))
    return TextTable(HEADING, COLUMNS, rows, tuple(iter_notes(scene_modes)))


def format_heading(scene_modes: SceneModes) -> list[tuple[str, str]]:
    """Return label and text of the lines above the table."""
    state, *further_lines = describe_modes(scene_modes)
    return [("heun", f"{VERSION}  {scene_modes.title}"), ("modes", state), *(("", line) for line in further_lines)]


def render_page(scene_modes: SceneModes) -> str:
    """Render the page as text."""
    lines = format_heading(scene_modes)
    head = "".join(f"{label.ljust(5)}  {escape(text)}\n" for label, text in lines)
    return head + (
        "\n"
        + "".join(format_plain(part, DEFAULT_WIDTH) for part in split_to_width(make_table(scene_modes), DEFAULT_WIDTH))
        if scene_modes.modes
        else ""
    )


def make_row(k: int, mode: Mode, scene_modes: SceneModes) -> tuple[str, ...]:
    """Make the cells of a mode, with as many digits as its error allows."""
    return str(k + 1), *format_mode(mode), mode.kind, format_shape(k, scene_modes)


def format_shape(k: int, scene_modes: SceneModes) -> str:
    """Format the coordinates that move most, with their amplitudes."""
    shape = scene_modes.shapes[k]
    return ", ".join(f"{name} {format_amplitude(shape[name])}" for name in scene_modes.largest[k] if name in shape)


def format_amplitude(x: complex) -> str:
    """Format an amplitude relative to the largest, with its phase if that is neither 0° nor 180°."""
    if abs(x.imag) <= PHASE_TOLERANCE * abs(x):
        return f"{x.real:.3g}"
    return f"{abs(x):.3g}∠{math.degrees(math.atan2(x.imag, x.real)):.0f}°"


def to_csv(scene_modes: SceneModes) -> str:
    """Return the modes in long form, one number per line."""
    lines = [CSV_COLUMNS]
    for k, (mode, shape) in enumerate(zip(scene_modes.modes, scene_modes.shapes, strict=True)):
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
