"""Every worked example as a report: one solution, both forms; a page that nests, holds no script, and no nan."""

from __future__ import annotations

import re
from pathlib import Path
from typing import get_args

import pytest

from heuncli.app.commands.report.command import solve_report_cases
from heuncli.app.commands.report.request import ReportRequest
from heuncli.base.records import replace
from heuncli.output.client_report.contents import CHAPTERS, make_report
from heuncli.output.client_report.report_data import CHAPTER_NAMES, ReportData
from heuncli.output.documents.as_html import render_html
from heuncli.output.documents.as_markdown import render_markdown
from heuncli.scene.file_format.format import ReportChapter
from tests.shared.page_reader import OURS, PageReader

FOLDER = Path(__file__).parents[2] / "specs"
NAMES = [pytest.param(path.stem, marks=pytest.mark.heavy) for path in sorted(FOLDER.glob("*.yaml"))]
NO_NUMBER = re.compile(r"\b(nan|NaN|inf|Infinity|None)\b")
UNIT = re.compile(r"\[[^\]]+\]|\b[\d.]+ (mm|m|km|in|N|kN|MN|N·m|kN·m)\b")  # of an axis, a ring, a scale bar


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.sixth
def test_reports_of_all_examples(name: str) -> None:
    of = solve_report_cases(ReportRequest(spec=str(FOLDER / f"{name}.yaml"), quiet=True))
    of = replace(of, chapters=CHAPTER_NAMES)  # with those that are printed on request
    report = make_report(of)
    page, text = render_html(report), render_markdown(report)
    read = PageReader(page)
    assert read.tags <= OURS
    assert len(read.ids) == len(set(read.ids))
    assert all(link.removeprefix("#") in read.ids for link in read.links)
    assert not [attribute for _, attribute in read.attributes if attribute.startswith("on")]
    for written in (page.partition('id="spec"')[0].partition("</style>")[2], text.rpartition("\n## ")[0]):
        assert not NO_NUMBER.search(written)
    assert of.spec.title in read.by_tag["h1"][0]
    for figure in read.by_tag.get("figure", []):
        assert UNIT.search(figure)
    every_line_of_the_spec_is_there(of, read, text)
    assert all(outcome.has_passed for outcome in of.outcomes)  # as heun check finds, see tests/cli/test_specs.py


def test_every_chapter_has_its_name() -> None:
    assert set(CHAPTERS) == set(CHAPTER_NAMES) == set(get_args(ReportChapter))


def every_line_of_the_spec_is_there(of: ReportData, read: PageReader, text: str) -> None:
    lines = of.text.splitlines()
    assert read.by_tag["code"] == lines
    assert [line.split("  ", 1)[1] if "  " in line.strip() else "" for line in fenced_at_the_end(text)] == [
        line.rstrip() for line in lines
    ]


def fenced_at_the_end(text: str) -> list[str]:
    """The lines in the last fence, which are those of the spec."""
    inside = text.rstrip().rpartition("\n```")[0].rpartition("```text\n")[2]
    return inside.split("\n")
