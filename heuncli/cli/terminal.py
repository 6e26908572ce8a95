"""Tables on a terminal: headings set off, and wide tables split into parts that fit. Impure: asks the terminal."""

from __future__ import annotations

import io
import sys
from collections.abc import Sequence

from heuncli.report.table import GAP, INDENT, Table, aligned, plain


def present() -> bool:
    """Whether standard output is a terminal."""
    return sys.stdout is not None and sys.stdout.isatty()


def write(tables: Sequence[Table]) -> list[str]:
    """The tables as text for the terminal at hand, in its width and with its colours (or none: NO_COLOR)."""
    from rich.console import Console
    from rich.text import Text

    console = Console(file=io.StringIO(), force_terminal=True, highlight=False)
    texts = []
    for table in tables:
        for part in fit(table, Console().width):
            lines = plain(part).splitlines()
            across = {row for row in part.rows if isinstance(row, str)}
            with console.capture() as captured:
                for number, line in enumerate(lines):
                    heads = number == 0 and bool(part.heading)
                    style = "bold" if heads else "cyan" if line in across else ""
                    console.print(Text(line, style=style), soft_wrap=True)
            texts.append(captured.get())
    return texts


def fit(table: Table, width: int) -> list[Table]:
    """The table in parts no wider than `width` if that can be; each repeats the leading columns of words."""
    if not table.columns:
        return [table]
    cells = aligned(table)
    widths = [max(map(len, column)) + len(GAP) for column in zip(*cells, strict=True)]
    lead = 1 + max((i for i, column in enumerate(table.columns[:3]) if column.align == "left"), default=0)
    room = width - len(INDENT) - sum(widths[:lead])
    parts: list[list[int]] = [[]]
    for place in range(lead, len(widths)):
        if parts[-1] and sum(widths[i] for i in (*parts[-1], place)) > room:
            parts.append([])
        parts[-1].append(place)
    if len(parts) == 1:
        return [table]
    tables = []
    for number, part in enumerate(parts):
        kept = [*range(lead), *part]
        rows = tuple(row if isinstance(row, str) else tuple(row[i] for i in kept) for row in table.rows)
        heading = table.heading if number == 0 else ""
        notes = table.notes if number == len(parts) - 1 else ()
        tables.append(Table(heading, tuple(table.columns[i] for i in kept), rows, notes))
    return tables
