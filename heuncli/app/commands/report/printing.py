"""Print a page of HTML as PDF with the first program found: Chromium or Chrome, WeasyPrint, wkhtmltopdf.

The program gets a file in a temporary folder and no network: Chromium resolves no names, and the page itself forbids
all sources (Content-Security-Policy). Impure: runs a program, writes.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from heuncli.app.cli import timeout
from heuncli.base import files
from heuncli.base.errors import OutputError, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.programs import BROWSERS, find_program, list_browser_options, run_program

MAX_SECONDS = 90.0  # of a program, unless --time-limit leaves less
PRINT_OPTIONS = ("--no-pdf-header-footer", "--print-to-pdf={pdf}", "{page}")  # of a browser
OTHERS = {
    ("weasyprint",): ("{page}", "{pdf}"),
    ("wkhtmltopdf",): ("--quiet", "--disable-javascript", "--enable-local-file-access", "{page}", "{pdf}"),
}
HINT = (
    "install Chromium or Chrome, WeasyPrint (pip install weasyprint) or wkhtmltopdf, and have it on PATH; or write "
    "-o report.html, open it in a browser and print it: it is laid out for paper"
)


class Printer(NamedTuple):
    """A program that prints PDF: its path, and the patterns of its options."""

    path: str
    options: tuple[str, ...]


def find_printer() -> Printer:
    """Find a program that prints PDF. Raises OutputError."""
    for names, options in ((BROWSERS, (*list_browser_options(), *PRINT_OPTIONS)), *OTHERS.items()):
        path = find_program(names)
        if path is not None:
            return Printer(path, options)
    raise OutputError(Problem("no-pdf-printer", "no program that writes PDF was found on PATH", hint=HINT))


def write_pdf(page: str, printer: Printer, output: str) -> None:
    """Print a page to a file, which is written whole or not at all. Raises OutputError."""
    with tempfile.TemporaryDirectory(prefix="heun-", ignore_cleanup_errors=True) as folder:
        source, target = Path(folder, "report.html"), Path(folder, "report.pdf")
        source.write_text(page, encoding="utf-8")
        places = {"folder": folder, "pdf": str(target), "page": source.as_uri()}
        command = [printer.path, *(option.format(**places) for option in printer.options)]
        _, message = run_program(command, folder, timeout.limit_seconds(MAX_SECONDS))
        content = target.read_bytes() if target.is_file() else b""
    if not content.startswith(b"%PDF"):
        text = f"{printer.path} has written no PDF{f': {message}' if message else ''}"
        raise OutputError(Problem("no-pdf-printer", text, hint=HINT))
    timeout.disarm()
    files.write([content], output)
