"""Tables on a terminal: headings set off, and wide tables split into parts that fit. Impure: asks the terminal."""

from __future__ import annotations

import io
import sys
from collections.abc import Sequence

from heuncli.report.fit import fit
from heuncli.report.table import Table, plain, wrapped


def present() -> bool:
    """Whether standard output is a terminal."""
    return sys.stdout is not None and sys.stdout.isatty()


def write(tables: Sequence[Table]) -> list[str]:
    """The tables as text for the terminal at hand, in its width and with its colours (or none: NO_COLOR)."""
    from rich.console import Console
    from rich.text import Text

    console = Console(file=io.StringIO(), force_terminal=True, highlight=False)
    texts, width = [], Console().width
    for table in tables:
        for part in fit(table, width):
            lines = plain(part, width).splitlines()
            across = {line for row in part.rows if isinstance(row, str) for line in wrapped(row, width)}
            with console.capture() as captured:
                for number, line in enumerate(lines):
                    heads = bool(part.heading) and number < len(wrapped(part.heading, width))
                    style = "bold" if heads else "cyan" if line in across else ""
                    console.print(Text(line, style=style), soft_wrap=True)
            texts.append(captured.get())
    return texts
