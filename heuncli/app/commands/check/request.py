"""Options and arguments of `heun check`."""

from typing import Annotated

from heuncli.app.cli.options import NO_REDUCE, OUTPUT, QUIET, TIME_LIMIT_EACH, Option
from heuncli.base.named_tuples import NamedTuple

FORMATS = ("table", "json", "markdown", "github")


class CheckRequest(NamedTuple):
    """Run specs, and folders of specs, against what they `expect`, and against numbers that were kept.

    With --references: the cases that others published, against what they printed.
    """

    paths: Annotated[
        tuple[str, ...],
        Option(
            (),
            "YAML files, and folders: every *.yaml below, but for folders named broken.",
            "PATH...",
            completes="spec",
        ),
    ] = ()
    references: Annotated[
        bool, Option(("--references",), "Hold published cases against what was printed; PATH: names of some.")
    ] = False
    format: Annotated[str | None, Option(("--format",), "How to write it. Default: table.", "|".join(FORMATS))] = None
    output: Annotated[str | None, OUTPUT] = None
    golden: Annotated[str | None, Option(("--golden",), "Hold the numbers against those kept there.", "DIR")] = None
    golden_tolerance: Annotated[
        float | None,
        Option(("--golden-tolerance",), "How far they may differ, of the largest of a kind; not the errors.", "SHARE"),
    ] = None
    update: Annotated[bool, Option(("--update",), "Write the files anew whose numbers are others.")] = False
    force: Annotated[bool, Option(("--force",), "Write them where CI is set, too.")] = False
    strict: Annotated[bool, Option(("--strict",), "Fail if a spec has no golden file, or a file no spec.")] = False
    junit: Annotated[str | None, Option(("--junit",), "Write a JUnit report there, too.", "FILE")] = None
    jobs: Annotated[
        int | None, Option(("--jobs", "-j"), "At once. Default: one a processor, from eight specs on.", "N")
    ] = None
    select: Annotated[str | None, Option(("-k",), "Only specs with this in their path or title.", "TEXT")] = None
    first: Annotated[bool, Option(("-x",), "End at the first spec that fails.")] = False
    durations: Annotated[int | None, Option(("--durations",), "List that many of the slowest.", "N")] = None
    no_reduce: Annotated[bool, NO_REDUCE] = False
    time_limit_each: Annotated[float | None, TIME_LIMIT_EACH] = None
    quiet: Annotated[bool, QUIET] = False
