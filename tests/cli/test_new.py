"""`heun new`: every starter runs, holds what it expects, has a section, and is never written over anything."""

from __future__ import annotations

from pathlib import Path

import pytest

from heuncli.analyses.published.cases import list_names
from heuncli.app.commands.new import list_kinds
from heuncli.scene.file_format.load import load
from tests.shared.command import Heun

KINDS = (
    "crane",
    "engine",
    "four_bar",
    "pendulum",
    "robot",
    "rotor",
    "slider_crank",
    "struck_rod",
    "suspension",
    "truss",
)


def test_the_kinds_are_listed(heun: Heun) -> None:
    assert tuple(list_kinds()) == KINDS
    lines = heun("new").stdout.splitlines()
    gap = lines.index("")
    assert [line.split()[0] for line in lines[:gap]] == [*KINDS]
    assert "heun check --references" in lines[gap + 1]
    assert [line.split()[0] for line in lines[gap + 2 :]] == [*list_names()]
    assert not {*KINDS} & {*list_names()}
    assert max(map(len, lines)) <= 120


@pytest.mark.heavy
@pytest.mark.parametrize("kind", KINDS)
def test_a_starter_runs_and_holds_what_it_expects(heun: Heun, folder: Path, kind: str) -> None:
    assert heun("new", kind).returncode == 0
    spec = load(str(folder / f"{kind}.yaml"))
    assert (len(spec.sections) > 0, len(spec.expect) > 0, spec.warnings) == (True, True, ())
    run = heun("run", f"{kind}.yaml", "--strict")
    assert (run.returncode, run.stderr) == (0, "")
    assert heun("check", f"{kind}.yaml").returncode == 0
    text = (folder / f"{kind}.yaml").read_text()
    assert "\n# Question  " in text and "\n# Answer    " in text and f"\n# Look at   heun run {kind}.yaml" in text
    assert text.startswith("# yaml-language-server: $schema=heun.schema.json\n")
    assert max(map(len, text.splitlines())) <= 120


def test_nothing_is_written_over(heun: Heun, folder: Path) -> None:
    (folder / "pendulum.yaml").write_text("mine")
    (folder / "link.yaml").symlink_to(folder / "nowhere.yaml")
    (folder / "below").mkdir()
    for name in ("pendulum.yaml", "link.yaml", "below"):
        done = heun("new", "pendulum", name)
        assert (done.returncode, "this file exists" in done.stderr) == (2, True), name
    assert (folder / "pendulum.yaml").read_text() == "mine"
    assert not (folder / "nowhere.yaml").exists()
    assert heun("new", "pendulum", "nosuch/a.yaml").returncode == 5


def test_to_standard_output_and_by_another_name(heun: Heun, folder: Path) -> None:
    assert (
        heun("new", "truss", "-").stdout
        == heun("new", "truss", "mine.yaml").stdout + (folder / "mine.yaml").read_text()
    )
    done = heun("new", "enigne")
    assert (done.returncode, "did you mean engine?" in done.stderr) == (2, True)
