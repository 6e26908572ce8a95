"""Options and arguments of `heun run`."""

from typing import Annotated

from heuncli.app.cli.options import (
    LEAST_NORM,
    METHOD,
    NO_REDUCE,
    OUTPUT,
    QUIET,
    SET,
    SPEC,
    STEP,
    TIME_LIMIT,
    TOLERANCE,
    Option,
)
from heuncli.base.named_tuples import NamedTuple

FORMATS = ("table", "json", "csv", "markdown")


class RunRequest(NamedTuple):
    """Solve a scene and report its loads and motion."""

    spec: Annotated[str, SPEC]
    format: Annotated[
        str | None,
        Option(
            ("--format",),
            "How to write the results. Default: by the name's end of -o FILE, else table.",
            "|".join(FORMATS),
        ),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    only: Annotated[
        str | None,
        Option(
            ("--only",),
            "Only these: motion, points, foundation, joints, sections, forces, energy, impulses, events, shares; or "
            "entries: joints.NAME, foundation.axis, ...",
            "REPORT,...",
            completes="only",
        ),
    ] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[
        str | None,
        Option(
            ("--case",),
            "In a load case, or in all with their envelope; --set goes on top.",
            "NAME|all",
            completes="case",
        ),
    ] = None
    at: Annotated[
        str | None, Option(("--at",), "Show these instants instead of the extremes; first, last.", "WHEN,...")
    ] = None
    all: Annotated[bool, Option(("--all",), "Show every instant, and every cut of a run of cuts.")] = False
    measure: Annotated[
        tuple[str, ...],
        Option(
            ("--measure",),
            "Print one number: 'max abs sections.middle.M1', 'final energy.kinetic', 'at 0.5 PATH'. May be repeated.",
            "WHAT",
            completes="measure",
        ),
    ] = ()
    collective: Annotated[
        str | None,
        Option(
            ("--collective",),
            "Load collectives of these numbers over the motion: rainflow cycles, level crossings.",
            "PATH,...",
            completes="collective",
        ),
    ] = None
    slope: Annotated[
        str | None, Option(("--slope",), "Damage-equivalent ranges for these slopes of Wöhler lines.", "M,...")
    ] = None
    cycles: Annotated[
        float | None,
        Option(("--cycles",), "Of how many cycles equivalent ranges are. Default: one each time.", "N"),
    ] = None
    bins: Annotated[int | None, Option(("--bins",), "Classes of ranges and means. Default: 10.", "N")] = None
    repeat: Annotated[
        str | None,
        Option(("--repeat",), "The motion is a cycle that is run through N times, or (closed) for ever.", "N|closed"),
    ] = None
    method: Annotated[str | None, METHOD] = None
    step: Annotated[float | None, STEP] = None
    tolerance: Annotated[float | None, TOLERANCE] = None
    no_reduce: Annotated[bool, NO_REDUCE] = False
    least_norm: Annotated[bool, LEAST_NORM] = False
    by_cause: Annotated[
        bool, Option(("--by-cause",), "Split every load by its causes: gravity, each force, drives, motion.")
    ] = False
    axes: Annotated[
        str | None,
        Option(("--axes",), "Joint loads in the axes of the one or the other body, as it turns.", "world|from|to"),
    ] = None
    units: Annotated[
        str | None,
        Option(
            ("--units",), "Units of tables and --measure, such as kN,mm,deg,rpm; JSON and CSV stay in SI.", "UNIT,..."
        ),
    ] = None
    watch: Annotated[bool, Option(("--watch",), "Again at each save of the spec, until Ctrl-C.")] = False
    strict: Annotated[bool, Option(("--strict",), "Leave with 1 if there are warnings or open reactions.")] = False
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
    verbose: Annotated[
        bool, Option(("--verbose", "-v"), "Also what was made smaller; on standard error where the time went.")
    ] = False
