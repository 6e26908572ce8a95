"""What `heun check` is asked for: its options and arguments."""

from typing import Annotated, NamedTuple

from heuncli.cli.options import OUTPUT, QUIET, TIME_LIMIT_EACH, Option


class CheckRequest(NamedTuple):
    """Run specs, and folders of specs, against what they `expect`."""

    paths: Annotated[
        tuple[str, ...],
        Option((), "YAML files, and folders: every *.yaml below, but for folders named broken.", "PATH..."),
    ]
    format: Annotated[str | None, Option(("--format",), "How to write it. Default: table.", "table|json")] = None
    output: Annotated[str | None, OUTPUT] = None
    golden: Annotated[
        str | None, Option(("--golden",), "Compare with whole results kept there.", "DIR", later=True)
    ] = None
    update: Annotated[bool, Option(("--update",), "Write the kept results anew.", later=True)] = False
    junit: Annotated[str | None, Option(("--junit",), "Write a JUnit report.", "FILE", later=True)] = None
    time_limit_each: Annotated[float | None, TIME_LIMIT_EACH] = None
    quiet: Annotated[bool, QUIET] = False
