"""`heun report`: solve every load case of a spec, and write a report for a client, as a page or as PDF.

PDF is printed by the first program found: Chromium or Chrome, WeasyPrint, wkhtmltopdf. Impure: runs programs.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from heuncli.app.cli import timeout
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.output import emit
from heuncli.app.cli.solving import require_choice
from heuncli.app.cli.target import require_other_file, require_writable
from heuncli.app.commands.report.cases import solve_report_cases
from heuncli.app.commands.report.request import FORMATS, PAPERS, ReportRequest
from heuncli.base import files
from heuncli.base.errors import OutputError, Problem
from heuncli.base.files import STDOUT
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.programs import BROWSERS, find_program, list_browser_options, run_program

ENDINGS = {".html": "html", ".htm": "html", ".pdf": "pdf", ".md": "md"}
FAILED = 1


def main(request: ReportRequest) -> int:
    """Run the command; returns the exit code: 1 if an expectation of the spec is not met."""
    form = choose_form(request)
    require_choice("--paper", request.paper or PAPERS[0], PAPERS)
    require_other_file(request.output, [request.spec])
    if form == "pdf":
        printer = find_printer()
    data = solve_report_cases(request)
    require_other_file(request.output, [request.spec])
    from heuncli.output.client_report.contents import make_report, make_sheet
    from heuncli.output.documents.as_html import render_html
    from heuncli.output.documents.decimal_comma import write_decimal_comma

    report = make_report(data)
    if request.decimal_comma:
        report = write_decimal_comma(report)
    if form == "md":
        from heuncli.output.documents.as_markdown import render_markdown

        emit(render_markdown(report), request.output)
    else:
        page = render_html(report, make_sheet(data, request.paper or PAPERS[0], is_landscape=request.landscape))
        if form == "html":
            emit(page, request.output)
        else:
            assert request.output is not None
            write_pdf(page, printer, request.output)
    return 0 if all(outcome.has_passed for outcome in data.outcomes) else FAILED


def choose_form(request: ReportRequest) -> str:
    """Return the format of the report, before any work. Raises UsageError, OutputError."""
    output = request.output
    if output is None:
        hint = "for example -o report.pdf, -o report.html, or -o - for standard output"
        raise UsageError(Problem("bad-option", "report: no output file is given", hint=hint))
    if output != STDOUT:
        require_writable(output)
    if request.format is not None:
        form = require_choice("--format", request.format, FORMATS)
        if form == "pdf" and output == STDOUT:
            raise UsageError(Problem("bad-option", "-o -: a PDF needs a file", hint="for example -o report.pdf"))
        return form
    ending = output[output.rfind(".") :].lower() if "." in output.rpartition("/")[2] else ""
    if output == STDOUT or ending in ENDINGS:
        return ENDINGS.get(ending, FORMATS[0])
    hint = f"accepted: {', '.join(ENDINGS)}; with --format {'|'.join(FORMATS)} any name is accepted"
    raise UsageError(Problem("bad-option", f"-o {output}: unknown file extension", hint=hint))


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
