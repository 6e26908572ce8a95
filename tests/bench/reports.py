"""The time and the size of `heun report`: of an engine, of a car in its load cases, of a crane with sections."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from heuncli.app.commands.report.command import solve_report_cases
from heuncli.app.commands.report.request import ReportRequest
from heuncli.output.client_report.contents import make_report
from heuncli.output.documents.as_html import render_html
from heuncli.output.documents.as_markdown import render_markdown

SPECS = Path(__file__).parents[2] / "specs"
NAMES = ("engine", "axle_loads", "crane_load")


def reports(median_ms: Callable[[Callable[[], Any], int], float]) -> None:
    """Print them; median_ms: of a call that is repeated so often [ms]."""
    for name in NAMES:
        request = ReportRequest(spec=str(SPECS / f"{name}.yaml"), quiet=True)
        took = median_ms(lambda request=request: render_html(make_report(solve_report_cases(request))), 5)  # type: ignore[misc]
        report = make_report(solve_report_cases(request))
        sizes = len(render_html(report)) / 1e3, len(render_markdown(report)) / 1e3
        print(f"report {name:12} {took:6.0f} ms; page {sizes[0]:.0f} kB, markdown {sizes[1]:.0f} kB")
