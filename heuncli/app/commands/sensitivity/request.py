"""Options and arguments of `heun sensitivity`."""

from typing import Annotated

from heuncli.app.cli.options import CASE, FORMAT, OUTPUT, QUIET, SET, TIME_LIMIT, TOLERANCE, UNITS, Option
from heuncli.base.named_tuples import NamedTuple


class SensitivityRequest(NamedTuple):
    """Show how results depend on parameters."""

    words: Annotated[
        tuple[str, ...],
        Option(
            (),
            "YAML file of the spec, and parameters or dotted keys. Default: all parameters given as numbers.",
            "SPEC NAME...",
            completes="spec",
        ),
    ]
    measure: Annotated[
        tuple[str, ...],
        Option(
            ("--measure",),
            "Result to differentiate: 'max abs sections.middle.M1', 'final energy.kinetic'. May be repeated.",
            "WHAT",
            completes="measure",
        ),
    ] = ()
    spread: Annotated[
        str | None,
        Option(
            ("--spread",), "Tolerances (±) of parameters; show their combined effect on the results.", "NAME=VALUE,..."
        ),
    ] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    tolerance: Annotated[float | None, TOLERANCE] = None
    format: Annotated[str | None, FORMAT] = None
    output: Annotated[str | None, OUTPUT] = None
    units: Annotated[str | None, UNITS] = None
    jobs: Annotated[
        int | None, Option(("--jobs", "-j"), "Number of processes; each solves the variants of one parameter.", "N")
    ] = None
    strict: Annotated[bool, Option(("--strict",), "Exit with 1 if a derivative cannot be given.")] = False
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
