"""`heun modes`: compute small oscillations about the pose at rest."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated

from heuncli.analyses.modes.study import compute_spec_modes, exclude_entries
from heuncli.app.cli.documents import emit_document
from heuncli.app.cli.options import CASE, FORMAT, FORMATS, OUTPUT, QUIET, SET, SPEC, TIME_LIMIT, WITHOUT
from heuncli.app.cli.solving import find_excluded, load_spec, print_warnings
from heuncli.app.cli.target import choose_format, require_other_file
from heuncli.base.joint_kinds import is_length
from heuncli.base.named_tuples import NamedTuple
from heuncli.motion.linearisation.oscillations import Mode, SceneModes
from heuncli.output.documents.as_data import make_columns
from heuncli.output.documents.document import Cell, OutputColumn, OutputDocument, OutputTable
from heuncli.output.tables.mode_words import describe_modes, format_mode, iter_notes


class ModesRequest(NamedTuple):
    """The options and arguments of `heun modes`."""

    spec: Annotated[str, SPEC]
    format: Annotated[str | None, FORMAT] = None
    output: Annotated[str | None, OUTPUT] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    without: Annotated[tuple[str, ...], WITHOUT] = ()
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False


def main(request: ModesRequest) -> int:
    """Run the command; returns the exit code."""
    require_other_file(request.output, [request.spec])
    form = choose_format(request.format, request.output, FORMATS)
    spec = load_spec(request)
    entries = find_excluded(spec, request.without)
    require_other_file(request.output, [request.spec])
    scene_modes = compute_spec_modes(exclude_entries(spec, entries), entries)
    emit_document(make_document(scene_modes), form, request.output)
    print_warnings(spec, None, request.quiet)
    return 0


HEADING = "MODES  motion exp(growth·t) cos(2π·frequency·t); damping ratio = -growth / |growth + 2πi·frequency|"
COLUMNS = (
    OutputColumn("mode"), OutputColumn("frequency Hz"), OutputColumn("period s"), OutputColumn("damping"),
    OutputColumn("growth 1/s"), OutputColumn("kind", "text"), OutputColumn("largest amplitudes (rad, m)", "text"),
)  # fmt: skip
CSV_COLUMNS = make_columns("mode kind name quantity component unit value")
PHASE_TOLERANCE = 0.02  # relative; a smaller out-of-phase part is not shown


def make_table(scene_modes: SceneModes) -> OutputTable:
    """Make the table of the modes, one row each; notes name unstable modes and free directions."""
    rows = tuple(make_row(k, mode, scene_modes) for k, mode in enumerate(scene_modes.modes))
    return OutputTable(HEADING, COLUMNS, rows, tuple(iter_notes(scene_modes)))


def make_document(scene_modes: SceneModes) -> OutputDocument:
    """Make the document: the state about which the modes are, their table, and all numbers in long form."""
    state, *further_lines = describe_modes(scene_modes)
    facts = [("modes", state), *(("", line) for line in further_lines)]
    tables = [make_table(scene_modes)] if scene_modes.modes else []
    return OutputDocument(
        scene_modes.title,
        facts,
        tables,
        scene_modes.to_block,
        lambda: OutputTable("", CSV_COLUMNS, list(iter_records(scene_modes))),
    )


def make_row(k: int, mode: Mode, scene_modes: SceneModes) -> tuple[Cell, ...]:
    """Make the cells of a mode, with as many digits as its error allows."""
    return k + 1, *format_mode(mode), mode.kind, format_shape(k, scene_modes)


def format_shape(k: int, scene_modes: SceneModes) -> str:
    """Format the coordinates that move most, with their amplitudes."""
    shape = scene_modes.shapes[k]
    return ", ".join(f"{name} {format_amplitude(shape[name])}" for name in scene_modes.largest[k] if name in shape)


def format_amplitude(x: complex) -> str:
    """Format an amplitude relative to the largest, with its phase if that is neither 0° nor 180°."""
    if abs(x.imag) <= PHASE_TOLERANCE * abs(x):
        return f"{x.real:.3g}"
    return f"{abs(x):.3g}∠{math.degrees(math.atan2(x.imag, x.real)):.0f}°"


def iter_records(scene_modes: SceneModes) -> Iterator[tuple[Cell, ...]]:
    """Yield the modes in long form, one number per row."""
    for k, (mode, shape) in enumerate(zip(scene_modes.modes, scene_modes.shapes, strict=True), 1):
        for quantity, unit, value in (
            ("frequency", "Hz", mode.frequency), ("damping", "1", mode.damping), ("growth", "1/s", mode.growth),
            ("error", "1/s", mode.error),
        ):  # fmt: skip
            yield k, mode.kind, "", quantity, "", unit, value
        for name, x in shape.items():
            unit = "m" if is_length(name) else "rad"
            for part, value in (("re", x.real), ("im", x.imag)):
                yield k, mode.kind, name, "shape", part, unit, value
