"""The shapes of small oscillations, read back from the drawing: a double pendulum's two modes, what is unstable."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as tree
from pathlib import Path

import numpy as np
import pytest

from tests.shared.command import Heun
from tests.shared.plotted import SVG, points_of, texts_of

SPECS = Path(__file__).parents[2] / "specs"
PENDULUM = """\
heun: 1
title: TITLE
space: planar
gravity: [0, -9.81, 0]
ground: {points: {O: [0, 0, 0]}}
bodies:
  upper: {mass: 1, center: [0, -1, 0], inertia: 0, points: {top: [0, 0, 0], end: [0, -1, 0]}}
  lower: {mass: 1, center: [0, -1, 0], inertia: 0, points: {top: [0, 0, 0], end: [0, -1, 0]}}
joints:
  hang: {type: pin, from: ground.O, to: upper.top}
  knee: {type: pin, from: upper.end, to: lower.top}
analysis: {type: rest}
"""


def displaced(name: str) -> list[np.ndarray]:
    """The lines of a body in the panels, the other way before the one way, (n, 2) each in pixels."""
    return [points_of(e) for e in tree.parse("drawn.svg").iter(f"{SVG}polyline") if e.findtext(f"{SVG}title") == name]


def test_a_double_pendulum_swings_in_its_two_shapes(heun: Heun, folder: Path) -> None:
    (folder / "two.yaml").write_text(PENDULUM)
    done = heun("plot", "two.yaml", "modes", "-o", "drawn.svg")
    assert (done.returncode, done.stderr) == (0, "")
    upper, lower = displaced("upper"), displaced("lower")
    assert len(upper) == len(lower) == 4  # two modes, each to both sides
    for k, ratio in enumerate((np.sqrt(2.0), -np.sqrt(2.0))):  # of the angles, of equal masses and lengths
        for one, two in zip(upper[2 * k : 2 * k + 2], lower[2 * k : 2 * k + 2], strict=True):
            turned = [float(np.ptp(line[:, 0]) * np.sign((line[-1] - line[0])[0] * (line[-1] - line[0])[1]))
                      for line in (one, two)]  # fmt: skip
            assert turned[1] / turned[0] == pytest.approx(ratio, rel=0.02)
            assert np.abs(one - two[0]).sum(axis=1).min() < 0.03 or np.abs(one - two[-1]).sum(axis=1).min() < 0.03
    words = texts_of((folder / "drawn.svg").read_text())
    hertz = [np.sqrt((2.0 + sign * np.sqrt(2.0)) * 9.81) / (2.0 * np.pi) for sign in (-1.0, 1.0)]
    titles = [word for word in words if word.startswith("mode ")]
    found = [float(re.search(r"([\d.]+) Hz, ζ = 0", title)[1]) for title in titles]  # type: ignore[index]
    assert found == pytest.approx(hertz, rel=1e-4)


def test_what_is_unstable_or_free_is_named(heun: Heun) -> None:
    heun("plot", str(SPECS / "flat_four_bar.yaml"), "modes", "-o", "drawn.svg")
    words = "\n".join(texts_of(Path("drawn.svg").read_text()))
    assert "mode 1: UNSTABLE, divergence, growth 3.431 1/s A" in " ".join(words.split()) and "\nunstable\n" in words
    assert "unstable: mode 1, A.angle, B.angle, C.angle: grows by a factor of e every 0.291 s" in words
    heun("plot", str(SPECS / "cart_pole.yaml"), "modes", "-o", "drawn.svg")
    words = "\n".join(texts_of(Path("drawn.svg").read_text()))
    assert "mode 1: free\nrail.travel" in words and "stable, except for unrestrained motions" in words


@pytest.mark.parametrize("name", ["wingnut", "governor"])
def test_modes_in_space_are_drawn(heun: Heun, name: str) -> None:
    spec = str(SPECS / f"{name}.yaml")
    done = heun("plot", spec, "modes", "-o", "drawn.svg")
    assert (done.returncode, done.stderr) == (0, "")
    text = Path("drawn.svg").read_text()
    assert not re.search(r"\b(nan|inf)\b", text)
    modes = json.loads(heun("modes", spec, "--format", "json").stdout)["modes"]
    titles = [word for word in texts_of(text) if word.startswith("mode ")]
    assert len(titles) == min(len(modes), 12)
    heun("plot", spec, "modes", "-o", "again.svg")
    assert Path("again.svg").read_text() == text
    lines = heun("plot", spec, "modes", "--width", "70").stdout.splitlines()
    assert max(map(len, lines)) <= 70


def test_what_excites_is_left_out(heun: Heun) -> None:
    heun("plot", str(SPECS / "laval.yaml"), "modes", "--without", "motor", "-o", "drawn.svg")
    words = "\n".join(texts_of(Path("drawn.svg").read_text()))
    assert "without motion of motor, fixed at its start" in words
    assert "mode 1: 25.13 Hz, ζ = 0.05000\nacross.travel" in words


def test_hostile_titles_and_what_has_no_modes(heun: Heun, folder: Path) -> None:
    (folder / "two.yaml").write_text(PENDULUM.replace("TITLE", json.dumps("<script>alert(1)</script> & \u202e")))
    assert heun("plot", "two.yaml", "modes", "-o", "drawn.svg").returncode == 0
    text = (folder / "drawn.svg").read_text()
    assert "<script" not in text and "\u202e" not in text and "<script>alert(1)</script>" in "".join(texts_of(text))
    for words, code, why in [
        ((str(SPECS / "slider_crank.yaml"), "modes"), 2, "0 degrees of freedom, so no modes"),
        (("two.yaml", "modes", "joints.hang"), 2, "draws the whole model"),
        (("two.yaml", "modes", "--view", "north"), 2, "--view north"),
        ((str(SPECS / "laval.yaml"), "modes"), 3, "no-rest-pose"),
    ]:
        done = heun("plot", *words, "-o", "other.svg")
        assert done.returncode == code and why in done.stderr, done.stderr
        assert not (folder / "other.svg").exists()
