"""Options and arguments of `heun check`."""

from typing import Annotated

from heuncli.app.cli.options import NO_REDUCE, OUTPUT, QUIET, TIME_LIMIT_EACH, Option
from heuncli.base.named_tuples import NamedTuple

FORMATS = ("table", "json", "markdown", "github")


class CheckRequest(NamedTuple):
    """The options and arguments of `heun check`."""

    paths: Annotated[
        tuple[str, ...],
        Option(
            (),
            "YAML files, and folders (every *.yaml in them, except in folders named broken).",
            "PATH...",
            completes="spec",
        ),
    ] = ()
    references: Annotated[
        bool, Option(("--references",), "Compare published cases with their published results; PATH then names cases.")
    ] = False
    format: Annotated[str | None, Option(("--format",), "Output format. Default: table.", "|".join(FORMATS))] = None
    output: Annotated[str | None, OUTPUT] = None
    golden: Annotated[
        str | None, Option(("--golden",), "Compare the results with the golden files in this folder.", "DIR")
    ] = None
    golden_tolerance: Annotated[
        float | None,
        Option(
            ("--golden-tolerance",),
            "Allowed difference relative to the largest value of its kind, in place of the stated errors.",
            "FRACTION",
        ),
    ] = None
    update: Annotated[bool, Option(("--update",), "Rewrite golden files whose results changed.")] = False
    force: Annotated[bool, Option(("--force",), "Allow --update where CI is set.")] = False
    strict: Annotated[bool, Option(("--strict",), "Fail if a spec has no golden file, or a golden file no spec.")] = (
        False
    )
    junit: Annotated[str | None, Option(("--junit",), "Also write a JUnit report.", "FILE")] = None
    jobs: Annotated[
        int | None,
        Option(("--jobs", "-j"), "Number of processes. Default: one per processor for eight or more specs.", "N"),
    ] = None
    select: Annotated[
        str | None, Option(("-k",), "Check only specs with this text in their path or title.", "TEXT")
    ] = None
    first: Annotated[bool, Option(("-x",), "Stop at the first spec that fails.")] = False
    durations: Annotated[int | None, Option(("--durations",), "List the N slowest specs.", "N")] = None
    no_reduce: Annotated[bool, NO_REDUCE] = False
    time_limit_each: Annotated[float | None, TIME_LIMIT_EACH] = None
    quiet: Annotated[bool, QUIET] = False
