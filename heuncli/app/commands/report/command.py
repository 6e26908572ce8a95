"""`heun report`: solve every load case of a spec, and write a report for a client."""

from __future__ import annotations

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.output import emit
from heuncli.app.cli.solving import require_choice
from heuncli.app.cli.target import require_writable
from heuncli.app.commands.report.cases import solve_report_cases
from heuncli.app.commands.report.request import FORMATS, PAPERS, ReportRequest
from heuncli.base.errors import Problem
from heuncli.base.files import STDOUT

ENDINGS = {".html": "html", ".htm": "html", ".pdf": "pdf", ".md": "md"}
FAILED = 1


def main(request: ReportRequest) -> int:
    """Run the command; returns the exit code: 1 if an expectation of the spec is not met."""
    form = choose_form(request)
    require_choice("--paper", request.paper or PAPERS[0], PAPERS)
    require_other_file(request.output, [request.spec])
    if form == "pdf":
        from heuncli.app.commands.report.printing import find_printer

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
            from heuncli.app.commands.report.printing import write_pdf

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
