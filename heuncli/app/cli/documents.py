"""Write a document in the asked format, to a file or to standard output. Impure: writes, queries the terminal."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Literal

from heuncli.app.cli import terminal
from heuncli.app.cli.output import emit
from heuncli.base.text_safety import escape
from heuncli.output.documents.as_text import PLAIN, TextStyle, align_cells, iter_text, render_text
from heuncli.output.documents.document import OutputDocument, OutputTable, is_governing

if TYPE_CHECKING:
    from heuncli.output.drawing.figure import Figure

TEXT_FORMS = ("table", "text")
GOVERNING, UNCLEAR, NOTE, HEADING = "bold red", "yellow", "dim", "bold"  # styles of rich
UNCLEAR_NOTES = ("indeterminate",)  # beginnings of notes that limit what the table says
UNLIMITED = PLAIN._replace(width=None)  # of what is searched by programs as well, line by line


def emit_document(
    document: OutputDocument, form: str, output: str | None, *, style: TextStyle = PLAIN, late: bool = False
) -> None:
    """Write the document.

    style: of text that does not go to a terminal
    late: write even after the time limit
    """
    emit(render_document(document, form, output, style), output, late=late)


def render_document(
    document: OutputDocument, form: str, output: str | None, style: TextStyle = PLAIN
) -> str | Iterable[str]:
    """Render the document in a format; as text fitted to the terminal if it goes there."""
    if form in TEXT_FORMS:
        to_terminal = output is None and terminal.is_terminal()
        return iter_text(document, make_terminal_style(style) if to_terminal else style)
    return _find_writer(form)(document)


def is_rich(form: str, output: str | None) -> bool:
    """Return whether the document goes to a terminal that shows colours."""
    return form in TEXT_FORMS and output is None and terminal.is_terminal() and terminal.supports_styles()


def render_rich_document(document: OutputDocument) -> list[str]:
    """Render a document for a terminal: heading, its first table set by rich, and the other parts."""
    style = make_terminal_style()
    first, *others = document.parts
    assert isinstance(first, OutputTable)
    pieces = [render_text(document._replace(parts=()), style), "\n", render_rich(first, style.width)]
    return [*pieces, "\n", *iter_text(OutputDocument(parts=others), style)] if others else pieces


def make_terminal_style(style: TextStyle = PLAIN) -> TextStyle:
    """Return the style of text for this terminal, with its width and its escape codes."""
    fitted = style._replace(width=terminal.find_width(), draw=_draw_on_terminal)
    if not terminal.supports_styles():
        return fitted
    return fitted._replace(codes=(terminal.BOLD, terminal.CYAN, terminal.END))


def _draw_on_terminal(figure: Figure) -> str:
    """Draw a figure in letters, without colours."""
    from heuncli.app.cli.figure_output import render_text  # where a figure is drawn

    return render_text(figure, None, allows_colours=False)


def _find_writer(form: str) -> Callable[[OutputDocument], str]:
    """Return the writer of a format; each is imported where it is used."""
    if form == "json":
        from heuncli.output.documents.as_data import render_json as render
    elif form == "csv":
        from heuncli.output.documents.as_data import render_csv as render
    elif form == "html":
        from heuncli.output.documents.as_html import render_html as render
    else:
        assert form == "markdown"
        from heuncli.output.documents.as_markdown import render_markdown as render
    return render


def render_rich(table: OutputTable, width: int | None) -> str:
    """Render the table with escape codes for a width in columns; it ends with a newline."""
    from rich import box  # 40 ms, only for a terminal
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

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
