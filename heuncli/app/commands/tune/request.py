"""Options and arguments of `heun tune`."""

from typing import Annotated

from heuncli.app.cli.options import CASE, NO_REDUCE, OUTPUT, QUIET, SET, TOLERANCE, UNITS, Option
from heuncli.base.named_tuples import NamedTuple

FORMATS = ("table", "json")


class TuneRequest(NamedTuple):
    """Find the parameter values that minimise or maximise a result, within limits on other results."""

    words: Annotated[
        tuple[str, ...],
        Option(
            (),
            "YAML file of the spec, and the varied parameters with their bounds: m=0:3kg, r=20:60mm.",
            "SPEC NAME=LOW:HIGH...",
            completes="spec",
        ),
    ]
    minimise: Annotated[
        str | None,
        Option(("--minimise",), "Result to minimise: 'max foundation.force'.", "WHAT", completes="measure"),
    ] = None
    maximise: Annotated[
        str | None,
        Option(("--maximise",), "Result to maximise: 'min joints.main.axial'.", "WHAT", completes="measure"),
    ] = None
    subject_to: Annotated[
        tuple[str, ...],
        Option(
            ("--subject-to",),
            "Limit on a result: 'max abs sections.web.M2 < 40 N*m'. May be repeated.",
            "CONDITION",
            completes="measure",
        ),
    ] = ()
    evaluations: Annotated[
        int | None,
        Option(("--evaluations",), "Maximum number of variants. Default: 200 plus 200 per variable.", "N"),
    ] = None
    precision: Annotated[
        float | None,
        Option(
            ("--precision",),
            "Smallest improvement to search for, relative to the range of the result. Default: 1e-6.",
            "FRACTION",
        ),
    ] = None
    seed: Annotated[
        int | None, Option(("--seed",), "Random seed; the same seed gives the same variants. Default: 0.", "N")
    ] = None
    format: Annotated[
        str | None,
        Option(
            ("--format",),
            "Output format. Default: from the extension of -o FILE, else table.",
            "|".join(FORMATS),
        ),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    history: Annotated[str | None, Option(("--history",), "Also write all variants in order: history.csv.", "FILE")] = (
        None
    )
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    tolerance: Annotated[float | None, TOLERANCE] = None
    no_reduce: Annotated[bool, NO_REDUCE] = False
    units: Annotated[str | None, UNITS] = None
    jobs: Annotated[
        int | None, Option(("--jobs", "-j"), "Number of variants solved in parallel, where they are independent.", "N")
    ] = None
    strict: Annotated[
        bool, Option(("--strict",), "Exit with 1 if the search did not converge, or no variant meets all limits.")
    ] = False
    time_limit: Annotated[
        float | None,
        Option(("--time-limit",), "Stop the search after this time and report the best result so far.", "SECONDS"),
    ] = None
    quiet: Annotated[bool, QUIET] = False
