"""Write a document in the asked format, to a file or to standard output. Impure: writes, queries the terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from heuncli.app.cli import terminal
from heuncli.app.cli.output import emit
from heuncli.output.documents.as_text import PLAIN, TextStyle, iter_text, render_text
from heuncli.output.documents.document import OutputDocument, OutputTable

if TYPE_CHECKING:
    from heuncli.output.drawing.figure import Figure

TEXT_FORMS = ("table", "text")
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
    from heuncli.app.cli.rich_tables import render_rich  # 40 ms, only for a terminal

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
    from heuncli.app.cli.figure_options import render_text  # where a figure is drawn

    return render_text(figure, None, allows_colours=False)


def _find_writer(form: str) -> Callable[[OutputDocument], str]:
    """Return the writer of a format; each is imported where it is used."""
    if form == "json":
        from heuncli.output.documents.as_json import render_json as render
    elif form == "csv":
        from heuncli.output.documents.as_csv import render_csv as render
    elif form == "html":
        from heuncli.output.documents.as_html import render_html as render
    else:
        assert form == "markdown"
        from heuncli.output.documents.as_markdown import render_markdown as render
    return render
