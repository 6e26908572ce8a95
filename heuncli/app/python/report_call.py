"""A call of `heuncli.report`: read its spec, solve the load cases, and write the report. Impure: files, programs."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence

from heuncli.app import reports
from heuncli.app.cli.options import PAPERS
from heuncli.app.cli.output import encode_text
from heuncli.app.cli.target import require_other_file, require_writable
from heuncli.app.python.arguments import SpecSource, resolve_source
from heuncli.app.python.locked_run import emit_warnings
from heuncli.base import files
from heuncli.base.errors import Problem, UsageError
from heuncli.base.named_tuples import NamedTuple
from heuncli.output.tables.run_description import collect_warnings
from heuncli.scene.file_format.load import load_with_cases
from heuncli.scene.file_format.parameters import Setting
from heuncli.scene.file_format.source import read_text
from heuncli.study.model.options import Options, require_choice
from heuncli.study.quantities.captions import set_captions
from heuncli.study.quantities.table_units import read_display_units
from heuncli.study.queries.study import Study


class ReportCall(NamedTuple):
    """The arguments of `heuncli.report`, each of its kind; settings: the parameters and the values of `set`."""

    spec: SpecSource | None
    text: str | None
    output: str
    format: str | None
    case: str | Sequence[str] | None
    settings: list[Setting]
    units: str | None
    chapters: str | Sequence[str] | None
    paper: str
    landscape: bool
    decimal_comma: bool
    imprint: Mapping[str, str | None]
    logo: str | os.PathLike[str] | None
    options: Options
    time_limit: float | None
    title: str | None
    labels: Mapping[str, str]


def write_called_report(call: ReportCall) -> bool:
    """Write the report; returns whether all expectations are met. Raises what `heuncli.report` does."""
    name, source = resolve_source(call.spec, call.text)
    if source is not None and not isinstance(source, str):
        message = "report: a report prints the text of its spec, and a mapping has none"
        raise UsageError(Problem("bad-option", message, hint="give a path, or text=YAML"))
    if call.output == files.STDOUT:
        raise UsageError(Problem("bad-option", "output -: expected a file name", hint="for example report.html"))
    require_writable(call.output, "output")
    form = reports.choose_form(call.output, call.format)
    paper = require_choice("paper", call.paper, PAPERS)
    specs = [name] if source is None else []
    require_other_file(call.output, specs, "output")
    printer = reports.find_printer() if form == "pdf" else None
    options = make_report_options(call)
    text = read_text(name) if source is None else source
    warnings: dict[str, None] = {}

    def record_warnings(study: Study, case: str) -> None:
        """Record the warnings of one case, with its name."""
        read, solved = collect_warnings(study.spec, study.results, study.later_warnings)
        place = f"case {case}: " if case else ""
        warnings.update(dict.fromkeys([*read, *(f"{place}{warning}" for warning in solved)]))

    data = reports.solve_cases(read_spec(call, name, text), options, lambda: call.time_limit, record_warnings)
    require_other_file(call.output, specs, "output")
    page = reports.render_report(data, form, paper, is_landscape=call.landscape, has_decimal_comma=call.decimal_comma)
    emit_warnings(warnings)
    files.write([encode_text(page) if printer is None else reports.print_pdf(page, printer)], call.output)
    return reports.has_met_expectations(data)


def make_report_options(call: ReportCall) -> reports.ReportOptions:
    """Convert the arguments of the call to the options of a report. Raises UsageError."""
    cases, chapters = split_names(call.case), split_names(call.chapters)
    return reports.ReportOptions(
        call.options,
        list(_iter_given_options(call)),
        read_display_units("units", call.units),
        cases,
        reports.parse_chapters(chapters or ()),
        call.imprint,
        None if call.logo is None else os.fspath(call.logo),
    )


def read_spec(call: ReportCall, name: str, text: str) -> reports.ReportedSpec:
    """Read the spec and its load cases, with their title and labels. Raises SpecError, UsageError."""
    spec_files = reports.DigestedFiles(name)
    scene, cases = load_with_cases(name, call.settings, not call.settings, text, spec_files)
    scene = set_captions(scene, call.title, call.labels.items())
    cases = {case: set_captions(case_scene, call.title, call.labels.items()) for case, case_scene in cases.items()}
    return reports.ReportedSpec(name, text, scene, cases, spec_files.digests)


def split_names(words: str | Sequence[str] | None) -> list[str] | None:
    """Return the names in a list or in a text with commas; None for None."""
    if words is None:
        return None
    return [name.strip() for name in (words.split(",") if isinstance(words, str) else words)]


def _iter_given_options(call: ReportCall) -> Iterator[str]:
    """Yield the arguments that change the numbers, in the words of the command line, which the report prints."""
    yield from (f"--set {setting.key}={setting.value}" for setting in call.settings)
    options = call.options
    for name, value in (("method", options.method), ("step", options.step), ("tolerance", options.tolerance)):
        if value is not None:
            yield f"--{name} {value}"
    yield from ["--no-reduce"] if not options.reduce else []
    yield from ["--least-norm"] if options.least_norm else []
