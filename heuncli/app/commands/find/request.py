"""Options and arguments of `heun find`."""

from typing import Annotated

from heuncli.app.cli.options import CASE, FORMAT, OUTPUT, QUIET, SET, SPEC, TIME_LIMIT, TOLERANCE, UNITS, Option
from heuncli.base.named_tuples import NamedTuple


class FindRequest(NamedTuple):
    """Find every value of a parameter at which a result equals a value, or where it is below or above."""

    spec: Annotated[str, SPEC]
    unknown: Annotated[
        str, Option((), "Parameter or dotted key, and the ends of its interval: n=500:6000rpm.", "NAME=A:B")
    ]
    condition: Annotated[
        str,
        Option(
            (), "A measure, =, <, <=, > or >=, and a value with its unit: 'max joints.main.force = 10 kN'.", "CONDITION"
        ),
    ]
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    scan: Annotated[
        int | None,
        Option(
            ("--scan",),
            "Number of values solved first. Default: 7; more values find crossings that lie closer together.",
            "N",
        ),
    ] = None
    evaluations: Annotated[int | None, Option(("--evaluations",), "Maximum number of variants. Default: 300.", "N")] = (
        None
    )
    tolerance: Annotated[float | None, TOLERANCE] = None
    format: Annotated[str | None, FORMAT] = None
    output: Annotated[str | None, OUTPUT] = None
    units: Annotated[str | None, UNITS] = None
    strict: Annotated[
        bool,
        Option(("--strict",), "Exit with 1 if the condition is met nowhere, or part of the interval is not solved."),
    ] = False
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
