"""Options and arguments of `heun run`."""

from typing import Annotated

from heuncli.app.cli.options import (
    OUTPUT,
    QUIET,
    SET,
    SPEC,
    TIME_LIMIT,
    CaptionRequest,
    Option,
    SolverRequest,
    make_format_option,
)
from heuncli.base.named_tuples import NamedTuple

FORMATS = ("table", "json", "csv", "markdown")


class RunRequest(NamedTuple):
    """The options and arguments of `heun run`."""

    spec: Annotated[str, SPEC]
    format: Annotated[
        str | None,
        make_format_option(FORMATS),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    only: Annotated[
        str | None,
        Option(
            ("--only",),
            "Report only these: motion, points, foundation, joints, sections, forces, energy, impulses, events, "
            "shares; or entries: joints.NAME, foundation.axis, ...",
            "REPORT,...",
            completes="only",
        ),
    ] = None
    set: Annotated[tuple[str, ...], SET] = ()
    captions: CaptionRequest = CaptionRequest()
    case: Annotated[
        str | None,
        Option(
            ("--case",),
            "Solve this load case, or all with their envelope; --set is applied on top.",
            "NAME|all",
            completes="case",
        ),
    ] = None
    at: Annotated[
        str | None,
        Option(("--at",), "Show values at these times instead of the extremes: seconds, first, last.", "WHEN,..."),
    ] = None
    all: Annotated[bool, Option(("--all",), "Show every output time, and every cut of a series of cuts.")] = False
    summary: Annotated[
        bool, Option(("--summary",), "Show only the greatest load of each joint, coupling, load and section.")
    ] = False
    full: Annotated[
        bool, Option(("--full",), "Show every row of the summary and the tables, the method and its residual errors.")
    ] = False
    hardpoints: Annotated[
        bool,
        Option(("--hardpoints",), "Show position, force and moment of every joint and load at its greatest force."),
    ] = False
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
            "Count load spectra of these quantities over the motion: rainflow cycles, level crossings.",
            "PATH,...",
            completes="collective",
        ),
    ] = None
    slope: Annotated[
        str | None,
        Option(("--slope",), "Give damage-equivalent ranges for these slopes of the S-N (Wöhler) curve.", "M,..."),
    ] = None
    cycles: Annotated[
        float | None,
        Option(("--cycles",), "Number of cycles for the equivalent ranges. Default: one per repetition.", "N"),
    ] = None
    bins: Annotated[int | None, Option(("--bins",), "Number of bins for ranges and means. Default: 10.", "N")] = None
    repeat: Annotated[
        str | None,
        Option(("--repeat",), "Repeat the motion N times as a cycle, or indefinitely (closed).", "N|closed"),
    ] = None
    solver: SolverRequest = SolverRequest()
    by_cause: Annotated[
        bool, Option(("--by-cause",), "Split every load by cause: gravity, each force, drives, motion.")
    ] = False
    axes: Annotated[
        str | None,
        Option(
            ("--axes",),
            "Axes of joint loads: world, or those of one of the two (rotating) bodies; with --hardpoints any body.",
            "world|from|to|BODY",
        ),
    ] = None
    units: Annotated[
        str | None,
        Option(
            ("--units",), "Units of tables and --measure, such as kN,mm,deg,rpm; JSON and CSV stay in SI.", "UNIT,..."
        ),
    ] = None
    watch: Annotated[bool, Option(("--watch",), "Solve again at each save of the spec, until Ctrl-C.")] = False
    strict: Annotated[bool, Option(("--strict",), "Exit with 1 if there are warnings or indeterminate reactions.")] = (
        False
    )
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
    verbose: Annotated[
        bool,
        Option(("--verbose", "-v"), "Also show how the model was reduced; print the solving times on standard error."),
    ] = False
