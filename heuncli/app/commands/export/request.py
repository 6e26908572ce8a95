"""Options and arguments of `heun export`."""

from typing import Annotated

from heuncli.app.cli.options import (
    CASE,
    LABEL,
    LEAST_NORM,
    METHOD,
    NO_REDUCE,
    QUIET,
    SET,
    SPEC,
    STEP,
    TIME_LIMIT,
    TITLE,
    TOLERANCE,
    Option,
)
from heuncli.base.named_tuples import NamedTuple

WHAT = ("loads",)
FORMATS = ("csv", "json", "ansys", "nastran", "calculix", "abaqus")


class ExportRequest(NamedTuple):
    """Write self-balanced load cases of a body for a stress analysis."""

    what: Annotated[str, Option((), "What to export: loads.", "loads")]
    spec: Annotated[str, SPEC]
    body: Annotated[
        str | None, Option(("--body",), "Body to export. Default: the only one.", "NAME", completes="body")
    ] = None
    at: Annotated[
        str | None,
        Option(
            ("--at",),
            "Instants, one load case each: a time, first, last, peak:PATH (largest magnitude), max:PATH, min:PATH, "
            "impulse:NAME or impulse:NUMBER. Default: the instant of a state, rest or impulse analysis.",
            "WHEN,...",
        ),
    ] = None
    format: Annotated[
        str | None,
        Option(("--format",), "Output format. Default: from the extension of -o FILE, else csv.", "|".join(FORMATS)),
    ] = None
    output: Annotated[
        str | None,
        Option(("--output", "-o"), "Output file, written atomically: .csv, .json, .bdf, .mac, .inp.", "FILE"),
    ] = None
    units: Annotated[
        str | None,
        Option(
            ("--units",), "Consistent units of force, length and mass, such as N,mm,t. Default: N,m,kg.", "UNIT,..."
        ),
    ] = None
    first_node: Annotated[
        int | None, Option(("--first-node",), "Number of the first node of a deck. Default: 1001.", "NUMBER")
    ] = None
    elements: Annotated[
        str | None,
        Option(
            ("--elements",),
            "Name of the element set in your mesh that holds the whole body, for decks. Default: BODY.",
            "NAME",
        ),
    ] = None
    mesh: Annotated[
        str | None,
        Option(
            ("--mesh",),
            "Solid mesh of the body for CalculiX; its nodes carry the inertia load of the angular acceleration.",
            "FILE",
        ),
    ] = None
    blow_over: Annotated[
        float | None,
        Option(("--blow-over",), "Convert impulses to mean loads over this duration; required for decks.", "SECONDS"),
    ] = None
    case: Annotated[str | None, CASE] = None
    set: Annotated[tuple[str, ...], SET] = ()
    title: Annotated[str | None, TITLE] = None
    label: Annotated[tuple[str, ...], LABEL] = ()
    method: Annotated[str | None, METHOD] = None
    step: Annotated[float | None, STEP] = None
    tolerance: Annotated[float | None, TOLERANCE] = None
    no_reduce: Annotated[bool, NO_REDUCE] = False
    least_norm: Annotated[bool, LEAST_NORM] = False
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
