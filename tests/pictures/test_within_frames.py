"""Scenes and modes stay within their pictures, and are drawn at the size that they have."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from tests.shared.command import Heun
from tests.shared.folders import ROOT
from tests.shared.plotted import views_of

SCENES = [
    ("flywheel", "scene", "--view", "x"),  # its joint and its centre are one point but for rounding
    ("flywheel", "scene"),
    ("table", "modes"),  # its supports are far below what of it moves
]


@pytest.mark.parametrize("words", SCENES)
def test_all_that_is_drawn_lies_in_the_picture(heun: Heun, folder: Path, words: tuple[str, ...]) -> None:
    assert heun("plot", str(ROOT / "specs" / f"{words[0]}.yaml"), *words[1:], "-o", "drawn.svg").returncode == 0
    text = (folder / "drawn.svg").read_text()
    width, height = map(float, re.findall(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', text)[0])
    places = [pair.split(",") for points in re.findall(r'points="([^"]*)"', text) for pair in points.split()]
    at = np.array(places, dtype=np.float64)
    assert (at >= -1.0).all() and (at <= (width + 1.0, height + 1.0)).all()


def test_what_is_one_point_but_for_rounding_is_no_size(heun: Heun, folder: Path) -> None:
    spec = str(ROOT / "specs" / "flywheel.yaml")
    assert heun("plot", spec, "scene", "--view", "x", "-o", "drawn.svg").returncode == 0
    text = (folder / "drawn.svg").read_text()
    (view,) = views_of(text)
    (width,) = map(float, re.findall(r'viewBox="0 0 ([\d.]+) ', text))
    assert 0.6 < view.x.step * width < 1.8  # metres: twice the wheel's radius, and some room
