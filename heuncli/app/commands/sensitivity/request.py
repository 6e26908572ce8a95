"""Options and arguments of `heun sensitivity`."""

from typing import Annotated

from heuncli.app.cli.options import CASE, FORMAT, OUTPUT, QUIET, SET, TIME_LIMIT, TOLERANCE, UNITS, Option
from heuncli.base.named_tuples import NamedTuple


class SensitivityRequest(NamedTuple):
    """Tell what measures hang on: their derivatives by parameters, and what tolerances make of them."""

    words: Annotated[
        tuple[str, ...],
        Option(
            (),
            "The scene's YAML file, and parameters or dotted keys. Default: all parameters that are given as numbers.",
            "SPEC NAME...",
            completes="spec",
        ),
    ]
    measure: Annotated[
        tuple[str, ...],
        Option(
            ("--measure",),
            "What hangs on them: 'max abs sections.middle.M1', 'final energy.kinetic'. May be repeated.",
            "WHAT",
            completes="measure",
        ),
    ] = ()
    spread: Annotated[
        str | None,
        Option(("--spread",), "Tolerances, each way: what of the measures they make together.", "NAME=VALUE,..."),
    ] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    tolerance: Annotated[float | None, TOLERANCE] = None
    format: Annotated[str | None, FORMAT] = None
    output: Annotated[str | None, OUTPUT] = None
    units: Annotated[str | None, UNITS] = None
    strict: Annotated[bool, Option(("--strict",), "Leave with 1 if a derivative is refused.")] = False
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
