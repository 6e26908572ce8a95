"""Options and arguments of `heun lagrange`."""

from typing import Annotated

from heuncli.app.cli.options import CASE, OUTPUT, QUIET, SET, SPEC, TIME_LIMIT, UNITS, Option
from heuncli.base.named_tuples import NamedTuple


class LagrangeRequest(NamedTuple):
    """Lagrange's equations in numbers: the inertia at each coordinate, forces along it by cause, velocity terms."""

    spec: Annotated[str, SPEC]
    at: Annotated[
        float | None, Option(("--at",), "An instant of the motion [s]. Default: the start, or the pose at rest.", "T")
    ] = None
    over: Annotated[
        str | None,
        Option(
            ("--over",),
            "Over a range of a coordinate, where one motion is free: nothing is integrated.",
            "COORDINATE=FROM:TO/COUNT",
        ),
    ] = None
    coordinates: Annotated[
        str | None,
        Option(("--coordinates",), "The coordinates; rodrigues: of bodies on balls.", "NAME,..."),
    ] = None
    seen: Annotated[
        tuple[str, ...],
        Option(
            ("--seen",),
            "Where inertia is seen: coordinates, points in a direction.",
            "NAME|POINT:X,Y,Z,...",
        ),
    ] = ()
    christoffel: Annotated[bool, Option(("--christoffel",), "Christoffel symbols as well.")] = False
    state_space: Annotated[
        bool, Option(("--state-space",), "A, B, C, D of small motions about the state, for a controller.")
    ] = False
    inputs: Annotated[
        str | None, Option(("--inputs",), "Of the state space: forces by value, drives by acceleration.", "NAME,...")
    ] = None
    outputs: Annotated[
        str | None, Option(("--outputs",), "Of the state space: coordinates, their rates, points.", "NAME,...")
    ] = None
    only: Annotated[
        str | None,
        Option(("--only",), "Parts of tables and JSON: equations, mass, forces, sections and others.", "PART,..."),
    ] = None
    format: Annotated[
        str | None,
        Option(
            ("--format",), "How to write them. Default: by the name's end of -o FILE, else table.", "table|json|csv|m"
        ),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    units: Annotated[str | None, UNITS] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
