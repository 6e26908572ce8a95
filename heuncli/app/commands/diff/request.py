"""Options and arguments of `heun diff`."""

from typing import Annotated

from heuncli.app.cli.options import OUTPUT, QUIET, TIME_LIMIT_EACH, Option
from heuncli.base.named_tuples import NamedTuple

FORMATS = ("table", "json", "markdown", "github")


class DiffRequest(NamedTuple):
    """Show what changed by more than the stated errors between two specs, golden files or JSON results."""

    before: Annotated[
        str, Option((), "A spec, a golden file, or a result of heun run --format json.", "A", completes="spec")
    ]
    after: Annotated[str, Option((), "The changed version, likewise.", "B", completes="spec")]
    format: Annotated[str | None, Option(("--format",), "Output format. Default: table.", "|".join(FORMATS))] = None
    output: Annotated[str | None, OUTPUT] = None
    exit_code: Annotated[bool, Option(("--exit-code",), "Exit with 1 if anything changed.")] = False
    time_limit_each: Annotated[float | None, TIME_LIMIT_EACH] = None
    quiet: Annotated[bool, QUIET] = False
