"""`heun report`: read, solve every load case, and write what a client gets."""

from __future__ import annotations

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.guard import require_other_file
from heuncli.app.cli.output import emit
from heuncli.app.cli.solving import choice
from heuncli.app.cli.target import require_room
from heuncli.app.commands.reporting.cases import reported
from heuncli.app.commands.reporting.request import FORMATS, ReportRequest
from heuncli.base.errors import Problem
from heuncli.base.files import STDOUT

ENDINGS = {".html": "html", ".htm": "html", ".md": "md"}
PRINT = "write x.html, open it in a browser and print it: it is laid out for A4"
FAILED = 1


def main(request: ReportRequest) -> int:
    """Run the command; returns the exit code: 1 where what the spec expects does not hold."""
    form = form_of(request)
    require_other_file(request.output, [request.spec])
    of = reported(request)
    require_other_file(request.output, [request.spec])
    from heuncli.output.client_report.contents import report_of

    report = report_of(of)
    if form == "html":
        from heuncli.output.client_report.as_html import as_html as written
    else:
        from heuncli.output.client_report.as_markdown import as_markdown as written
    emit(written(report), request.output)
    return 0 if all(outcome.passed for outcome in of.outcomes) else FAILED


def form_of(request: ReportRequest) -> str:
    """The form that is asked for, before any work. Raises UsageError, OutputError."""
    output = request.output
    if output is None:
        hint = "such as -o report.html, or -o - for standard output"
        raise UsageError(Problem("bad-option", "heun report: where it is to be written is not said", hint=hint))
    if output != STDOUT:
        require_room(output)
    if request.format is not None:
        return choice("--format", request.format, FORMATS)
    ending = output[output.rfind(".") :].lower() if "." in output.rpartition("/")[2] else ""
    if output == STDOUT or ending in ENDINGS:
        return ENDINGS.get(ending, FORMATS[0])
    if ending == ".pdf":
        raise UsageError(Problem("bad-option", f"-o {output}: a report is not written as PDF", hint=PRINT))
    hint = f"known endings: {', '.join(ENDINGS)}; with --format {'|'.join(FORMATS)} any name will do"
    raise UsageError(Problem("bad-option", f"-o {output}: no report is known by that ending", hint=hint))
