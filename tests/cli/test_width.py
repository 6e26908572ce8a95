"""No table of any spec is wider than a page, unless by a name of the user's."""

from __future__ import annotations

from pathlib import Path

import pytest

from heuncli.app.cli.entry import enter
from heuncli.output.documents.as_text import DEFAULT_WIDTH

SPECS = sorted((Path(__file__).parents[2] / "specs").glob("*.yaml"))

EVERYTHING = "motion,points,foundation,joints,sections,forces,energy,impulses"


@pytest.mark.heavy
@pytest.mark.parametrize("spec", SPECS, ids=lambda path: path.stem)
@pytest.mark.sixth
def test_no_line_is_wider_than_a_page(spec: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert enter(["run", str(spec), "--by-cause", "--only", EVERYTHING]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines
    assert [line for line in lines if len(line) > DEFAULT_WIDTH] == []
