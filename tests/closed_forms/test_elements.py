"""Machine elements, a spec each in the folder elements: run without a warning, they are as they expect."""

from __future__ import annotations

from pathlib import Path

import pytest

from heuncli.app.cli.entry import enter

SPECS = sorted((Path(__file__).parent / "elements").glob("*.yaml"))


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.stem)
@pytest.mark.third
def test_a_spec_is_as_it_expects(spec: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert enter(["run", str(spec), "--strict"]) == 0
    assert enter(["check", str(spec)]) == 0
    assert capsys.readouterr().err == ""


def test_they_are_found() -> None:
    assert len(SPECS) >= 11
