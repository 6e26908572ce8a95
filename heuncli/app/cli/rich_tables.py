"""Set a table by rich, for a terminal: it fits the width, and governing values are coloured."""

from __future__ import annotations

import io
from typing import Literal

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from heuncli.base.text_safety import escape
from heuncli.output.documents.document import OutputTable, is_governing
from heuncli.output.documents.text_table import align_cells

GOVERNING, UNCLEAR, NOTE, HEADING = "bold red", "yellow", "dim", "bold"
UNCLEAR_NOTES = ("indeterminate",)  # beginnings of notes that limit what the table says


def render_rich(table: OutputTable, width: int | None) -> str:
    """Render the table with escape codes for a width in columns; it ends with a newline."""
    heading, _, explanation = table.heading.partition("  ")
    target = io.StringIO()
    console = Console(file=target, width=width, force_terminal=True, highlight=False, legacy_windows=False)
    console.print(Text.assemble((escape(heading), HEADING), "  ", (escape(explanation), NOTE)))
    _, *texts = align_cells(table)
    if texts:
        setting = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 1, 0, 0))
        for column, cells in zip(table.columns, zip(*texts, strict=True), strict=True):
            narrowest = max(map(len, cells)) if column.is_number else None  # of a number only the head is wrapped
            justify: Literal["left", "right"] = "right" if column.is_number else "left"
            title = escape(column.title).replace(" [", "\n[")  # the unit below the name
            setting.add_column(Text(title), justify=justify, min_width=narrowest)
        rows = [row for row in table.rows if not isinstance(row, str)]
        for row, cells in zip(rows, texts, strict=True):
            setting.add_row(
                *(
                    Text(text, style=GOVERNING if is_governing(cell) else "")
                    for cell, text in zip(row, cells, strict=True)
                )
            )
        console.print(setting)
    for note in table.notes:
        console.print(Text(escape(note), style=UNCLEAR if note.startswith(UNCLEAR_NOTES) else NOTE))
    return target.getvalue()
