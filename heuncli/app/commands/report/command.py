"""`heun report`: solve every load case of a spec, and write a report for a client."""

from __future__ import annotations

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.output import emit
from heuncli.app.cli.solving import require_choice
from heuncli.app.cli.target import require_writable
from heuncli.app.commands.report.cases import solve_report_cases
from heuncli.app.commands.report.request import FORMATS, ReportRequest
from heuncli.base.errors import Problem
from heuncli.base.files import STDOUT

ENDINGS = {".html": "html", ".htm": "html", ".md": "md"}
PRINT = "write x.html, open it in a browser and print it: it is laid out for A4"
FAILED = 1


def main(request: ReportRequest) -> int:
    """Run the command; returns the exit code: 1 if an expectation of the spec is not met."""
    form = choose_form(request)
    require_other_file(request.output, [request.spec])
    data = solve_report_cases(request)
    require_other_file(request.output, [request.spec])
    from heuncli.output.client_report.contents import make_report

    report = make_report(data)
    if form == "html":
        from heuncli.output.documents.as_html import render_html as written
    else:
        from heuncli.output.documents.as_markdown import render_markdown as written
    emit(written(report), request.output)
    return 0 if all(outcome.has_passed for outcome in data.outcomes) else FAILED


def choose_form(request: ReportRequest) -> str:
    """Return the format of the report, before any work. Raises UsageError, OutputError."""
    output = request.output
    if output is None:
        hint = "for example -o report.html, or -o - for standard output"
        raise UsageError(Problem("bad-option", "heun report: no output file is given", hint=hint))
    if output != STDOUT:
        require_writable(output)
    if request.format is not None:
        return require_choice("--format", request.format, FORMATS)
    ending = output[output.rfind(".") :].lower() if "." in output.rpartition("/")[2] else ""
    if output == STDOUT or ending in ENDINGS:
        return ENDINGS.get(ending, FORMATS[0])
    if ending == ".pdf":
        raise UsageError(Problem("bad-option", f"-o {output}: a report is not written as PDF", hint=PRINT))
    hint = f"accepted: {', '.join(ENDINGS)}; with --format {'|'.join(FORMATS)} any name is accepted"
    raise UsageError(Problem("bad-option", f"-o {output}: unknown file extension", hint=hint))
