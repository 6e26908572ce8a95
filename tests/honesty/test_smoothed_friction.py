"""An extreme where smoothed friction is not at its value says so, wherever it is told; beyond, nothing does."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import pytest

from heuncli.study.compose.warnings import compute_full_friction_rate
from tests.shared.command import Heun

SLEDGE = """
heun: 1
title: A sledge starts against friction
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  sledge: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}
joints:
  guide: {type: slide, from: ground.O, to: sledge.o, axis: [1, 0, 0], initial: {travel: 0, speed: BEGIN}}
forces:
  pull: {type: force, on: sledge.o, vector: ["8.35 - t", 0, 0]}
  rub: {type: friction, joint: guide, FORCE, speed: 0.001}
analysis: {duration: 1, samples: 11}
"""
SIZES = ("force: 2.95", "coefficient: 0.15036")
MEASURE = "max coordinates.guide.acceleration"


@pytest.mark.parametrize("size", SIZES)
def test_a_start_from_rest_says_that_friction_is_nothing_there(heun: Heun, folder: Path, size: str) -> None:
    """Without friction 8.35/2 m/s² at t = 0; with all of it 2.70."""
    (folder / "s.yaml").write_text(SLEDGE.replace("FORCE", size).replace("BEGIN", "0"))
    done = heun("run", "s.yaml", "--measure", MEASURE)
    assert float(done.stdout) == pytest.approx(4.175, rel=1e-12)
    assert "smoothed friction rub is at 0 % of its full value" in done.stderr
    told = json.loads(heun("run", "s.yaml", "--measure", MEASURE, "--format", "json").stdout)
    assert "rub" in told["notes"][0]
    table = heun("run", "s.yaml", "--only", "motion").stdout
    assert re.search(r"4\.1750*†", table)
    assert "† smoothed friction (rub) is below its full value here" in table
    result = json.loads(heun("run", "s.yaml", "--format", "json").stdout)
    assert any("at 1 of 11 samples" in note for note in result["model"]["notes"])
    report = heun("report", "s.yaml", "--format", "md", "-o", "-").stdout
    assert "† smoothed friction (rub)" in report
    drawn = heun("plot", "s.yaml", "coordinates.guide.acceleration").stdout
    assert "the maximum of coordinates.guide.acceleration at t = 0 s" in " ".join(drawn.split())


@pytest.mark.parametrize(("share", "marked"), [(0.9, True), (1.1, False)])
def test_either_side_of_the_rate_from_which_on_friction_is_full(
    heun: Heun, folder: Path, share: float, marked: bool
) -> None:
    (folder / "s.yaml").write_text(
        SLEDGE.replace("FORCE", SIZES[0]).replace("BEGIN", repr(share * 0.001 * compute_full_friction_rate()))
    )
    done = heun("run", "s.yaml", "--measure", MEASURE)
    assert ("smoothed friction" in done.stderr) is marked
    friction = 2.95 * math.tanh(share * compute_full_friction_rate())
    assert float(done.stdout) == pytest.approx((8.35 - friction) / 2.0, rel=1e-12)
    assert ("†" in heun("run", "s.yaml", "--only", "motion").stdout) is marked
    assert heun("run", "s.yaml", "--measure", "max coordinates.guide.speed").stderr == "unit: m/s\n"
