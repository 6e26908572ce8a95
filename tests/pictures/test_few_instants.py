"""Runs of one instant, and of none before the horizon: what can be told is drawn, the rest refused in a line."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.shared.command import Heun
from tests.shared.folders import ROOT

DOUBLE = (ROOT / "specs" / "double.yaml").read_text().partition("\nanalysis:")[0]
PICTURES = [
    ("joints.pivot.force", "energy.kinetic"),
    ("energy.kinetic", "--x", "bodies.upper.center.z"),
    ("polar", "joints.pivot", "--view", "x"),
    ("scene",),
]


@pytest.fixture
def specs(folder: Path) -> Path:
    (folder / "late.yaml").write_text(f"{DOUBLE}\nanalysis: {{times: [1.5, 2], tolerance: 0.1}}\n")
    (folder / "one.yaml").write_text(f"{DOUBLE}\nanalysis: {{times: [0.2]}}\n")
    return folder


@pytest.mark.parametrize("words", PICTURES)
def test_beyond_the_horizon_nothing_is_drawn(words: tuple[str, ...], heun: Heun, specs: Path) -> None:
    done = heun("plot", "late.yaml", *words, "-o", "picture.svg", "--quiet")
    assert (done.returncode, done.stdout) == (2, "") and "no results are claimed" in done.stderr
    assert not (specs / "picture.svg").exists()


@pytest.mark.parametrize("words", [("-o", "page.html"), ("--glb", "moving.glb")])
def test_nor_shown(words: tuple[str, ...], heun: Heun, specs: Path) -> None:
    done = heun("show", "late.yaml", *words, "--quiet")
    assert (done.returncode, done.stdout) == (2, "") and "no results are claimed" in done.stderr
    assert not (specs / words[1]).exists()


def test_nor_reported(heun: Heun, specs: Path) -> None:
    done = heun("report", "late.yaml", "-o", "-", "--format", "md", "--quiet")
    assert done.returncode == 0 and "```text\n" not in done.stdout.partition("## 2")[0]
    assert "all output times are past the horizon" in done.stdout


@pytest.mark.parametrize("words", PICTURES)
def test_one_instant_of_a_motion(words: tuple[str, ...], heun: Heun, specs: Path) -> None:
    done = heun("plot", "one.yaml", *words, "-o", "picture.svg", "--quiet")
    assert done.returncode == (2 if words[0] == "polar" else 0)
    assert ("there is only one instant" in done.stderr) == (words[0] == "polar")


def test_a_page_of_one_instant_says_nothing_of_a_horizon(heun: Heun, specs: Path) -> None:
    done = heun("show", "one.yaml", "-o", "-", "--quiet")
    assert done.returncode == 0 and "No results are claimed after the start of this motion" not in done.stdout
