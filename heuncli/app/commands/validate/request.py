"""Options and arguments of `heun validate`."""

from typing import Annotated

from heuncli.app.cli.options import TIME_LIMIT_EACH, Option
from heuncli.base.named_tuples import NamedTuple


class ValidateRequest(NamedTuple):
    """Read specs and report every error of every file."""

    specs: Annotated[tuple[str, ...], Option((), "YAML files; - reads standard input.", "SPEC...", completes="spec")]
    time_limit_each: Annotated[float | None, TIME_LIMIT_EACH] = None
    quiet: Annotated[bool, Option(("--quiet", "-q"), "Print only errors.")] = False
