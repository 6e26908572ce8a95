"""Options and arguments of `heun report`."""

from typing import Annotated

from heuncli.app.cli.options import (
    PAPERS,
    QUIET,
    REPORT_FORMATS,
    SET,
    SPEC,
    TIME_LIMIT,
    CaptionRequest,
    Option,
    SolverRequest,
)
from heuncli.base.named_tuples import NamedTuple


class ReportRequest(NamedTuple):
    """The options and arguments of `heun report`."""

    spec: Annotated[str, SPEC]
    output: Annotated[
        str | None,
        Option(
            ("--output", "-o"), "Output file, written atomically: x.html, x.pdf, x.md; - is standard output.", "FILE"
        ),
    ] = None
    format: Annotated[
        str | None,
        Option(
            ("--format",), "Output format. Default: from the extension of -o FILE, else html.", "|".join(REPORT_FORMATS)
        ),
    ] = None
    date: Annotated[str | None, Option(("--date",), "Date in the title block. Default: none.", "TEXT")] = None
    author: Annotated[str | None, Option(("--author",), "Author of the report.", "TEXT")] = None
    project: Annotated[str | None, Option(("--project",), "Name of the project.", "TEXT")] = None
    company: Annotated[str | None, Option(("--company",), "Company above the title.", "TEXT")] = None
    part: Annotated[str | None, Option(("--part",), "Part or drawing number.", "TEXT")] = None
    revision: Annotated[str | None, Option(("--revision",), "Revision of the report.", "TEXT")] = None
    logo: Annotated[str | None, Option(("--logo",), "Logo above the title: a PNG or SVG file.", "FILE")] = None
    chapters: Annotated[
        str | None,
        Option(
            ("--chapters",),
            "Chapters after the first page, in this order. Default: all but machine and spec.",
            "NAME,...",
        ),
    ] = None
    paper: Annotated[str | None, Option(("--paper",), "Paper size. Default: a4.", "|".join(PAPERS))] = None
    landscape: Annotated[bool, Option(("--landscape",), "Print in landscape format.")] = False
    decimal_comma: Annotated[bool, Option(("--decimal-comma",), "Write numbers with a decimal comma.")] = False
    case: Annotated[
        str | None,
        Option(("--case",), "Report only these load cases. Default: all.", "NAME,...", completes="case"),
    ] = None
    units: Annotated[str | None, Option(("--units",), "Units of loads, such as kN,mm,deg,rpm.", "UNIT,...")] = None
    set: Annotated[tuple[str, ...], SET] = ()
    captions: CaptionRequest = CaptionRequest()
    solver: SolverRequest = SolverRequest()
    time_limit: Annotated[float | None, TIME_LIMIT] = None
    quiet: Annotated[bool, QUIET] = False
