"""Options and arguments of `heun tune`."""

from typing import Annotated

from heuncli.app.cli.options import CASE, NO_REDUCE, OUTPUT, QUIET, SET, TOLERANCE, UNITS, Option
from heuncli.base.named_tuples import NamedTuple

FORMATS = ("table", "json")


class TuneRequest(NamedTuple):
    """Find the values of parameters for which a measure is least, or greatest, within limits on others."""

    words: Annotated[
        tuple[str, ...],
        Option(
            (),
            "The scene's YAML file, and what is varied between which bounds: m=0:3kg, r=20:60mm.",
            "SPEC NAME=LOW:HIGH...",
            completes="spec",
        ),
    ]
    minimise: Annotated[
        str | None,
        Option(("--minimise",), "What is to be least: 'max foundation.force'.", "WHAT", completes="measure"),
    ] = None
    maximise: Annotated[
        str | None,
        Option(("--maximise",), "What is to be greatest: 'min joints.main.axial'.", "WHAT", completes="measure"),
    ] = None
    subject_to: Annotated[
        tuple[str, ...],
        Option(
            ("--subject-to",),
            "What is to hold: 'max abs sections.web.M2 < 40 N*m'. May be repeated.",
            "CONDITION",
            completes="measure",
        ),
    ] = ()
    evaluations: Annotated[
        int | None,
        Option(("--evaluations",), "At most so many variants. Default: 200, and 200 for each variable.", "N"),
    ] = None
    precision: Annotated[
        float | None,
        Option(("--precision",), "Look for no gain below that share of what it ranges over. Default: 1e-6.", "SHARE"),
    ] = None
    seed: Annotated[
        int | None, Option(("--seed",), "Of what is drawn: the same seed, the same variants. Default: 0.", "N")
    ] = None
    format: Annotated[
        str | None,
        Option(
            ("--format",),
            "How to write the result. Default: by the name's end of -o FILE, else table.",
            "|".join(FORMATS),
        ),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    history: Annotated[
        str | None, Option(("--history",), "Write all variants there, too, in their order: history.csv.", "FILE")
    ] = None
    set: Annotated[tuple[str, ...], SET] = ()
    case: Annotated[str | None, CASE] = None
    tolerance: Annotated[float | None, TOLERANCE] = None
    no_reduce: Annotated[bool, NO_REDUCE] = False
    units: Annotated[str | None, UNITS] = None
    jobs: Annotated[
        int | None, Option(("--jobs", "-j"), "Variants at once, where they do not hang on each other.", "N")
    ] = None
    strict: Annotated[
        bool, Option(("--strict",), "Leave with 1 if it did not converge, or nothing keeps all limits.")
    ] = False
    time_limit: Annotated[
        float | None, Option(("--time-limit",), "End the search after that long, and tell the best so far.", "SECONDS")
    ] = None
    quiet: Annotated[bool, QUIET] = False
