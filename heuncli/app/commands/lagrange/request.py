"""Options and arguments of `heun lagrange`."""

from typing import Annotated

from heuncli.app.cli.options import CASE, OUTPUT, QUIET, SET, SPEC, TIME_LIMIT, UNITS, Option
from heuncli.base.named_tuples import NamedTuple


class LagrangeRequest(NamedTuple):
    """Evaluate Lagrange's equations: effective inertia, generalised forces by cause, velocity terms."""

    spec: Annotated[str, SPEC]
    at: Annotated[
        float | None, Option(("--at",), "Instant of the motion [s]. Default: the start, or the rest position.", "T")
    ] = None
    over: Annotated[
        str | None,
        Option(
            ("--over",),
            "Evaluate over a range of a coordinate, for 1 degree of freedom; nothing is integrated.",
            "COORDINATE=FROM:TO/COUNT",
        ),
    ] = None
    coordinates: Annotated[
        str | None,
        Option(
            ("--coordinates",),
            "Generalised coordinates; rodrigues: Rodrigues parameters for bodies on ball joints.",
            "NAME,...",
        ),
    ] = None
    seen: Annotated[
        tuple[str, ...],
        Option(
            ("--seen",),
            "Where to show the effective inertia: coordinates, or points in a direction.",
            "NAME|POINT:X,Y,Z,...",
        ),
    ] = ()
    christoffel: Annotated[bool, Option(("--christoffel",), "Also show the Christoffel symbols.")] = False
    state_space: Annotated[
        bool, Option(("--state-space",), "Show A, B, C, D of small motions about the state, for controller design.")
    ] = False
    inputs: Annotated[
        str | None, Option(("--inputs",), "State-space inputs: forces by value, drives by acceleration.", "NAME,...")
    ] = None
    outputs: Annotated[
        str | None, Option(("--outputs",), "State-space outputs: coordinates, their rates, points.", "NAME,...")
    ] = None
    only: Annotated[
        str | None,
        Option(("--only",), "Show only these parts: equations, mass, forces, sections and others.", "PART,..."),
    ] = None
    format: Annotated[
        str | None,
        Option(("--format",), "Output format. Default: from the extension of -o FILE, else table.", "table|json|csv|m"),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    units: Annotated[str | None, UNITS] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
