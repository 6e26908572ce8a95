"""Arguments of `heun new`."""

from typing import Annotated

from heuncli.app.cli.options import Option
from heuncli.base.named_tuples import NamedTuple


class NewRequest(NamedTuple):
    """Write a spec to start from; without arguments, list the kinds."""

    kind: Annotated[str | None, Option((), "Kind of machine: pendulum, crane, ...; or a published case.", "KIND")] = (
        None
    )
    file: Annotated[str | None, Option((), "Output file; - is standard output. Default: KIND.yaml.", "FILE")] = None
