"""Pitch lines of racks: through the place where the wheel meets them, along their way, in their body's axes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from heuncli.scenery.pitch_lines import pitch_lines
from heuncli.spec.load import load

SCENE = """heun: 1
ground: {points: {O: [0, 0, 0], G: [0, -0.05, 0]}}
bodies:
  pinion: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}
  rack: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {g: [0.1, 0.2, 0.3]}TURNED}
joints:
  pin: {type: pin, from: ground.O, to: pinion.c, axis: [0, 0, 1]}
  way: {type: slide, from: ground.G, to: rack.g, axis: [1, 0, 0]}
couplings: {teeth: {type: gear, of: [pin, way], ratio: 25}}
analysis: {duration: 1}
"""


@pytest.mark.parametrize("turned", ["", ", orientation: {axis: [0, 0, 1], angle: 90 deg}"])
def test_a_racks_line_touches_the_wheels_circle(tmp_path: Path, turned: str) -> None:
    (tmp_path / "a.yaml").write_text(SCENE.replace("TURNED", turned))
    lines, strands = pitch_lines(load(tmp_path / "a.yaml"))
    (circle,), (line,) = lines["pinion"], lines["rack"]
    radius = 1.0 / 25.0
    assert not strands and np.allclose(np.linalg.norm(circle, axis=1), radius)
    R = np.array([(0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)]) if turned else np.eye(3)
    there = (line - [0.1, 0.2, 0.3]) @ R.T + [0.0, -0.05, 0.0]
    assert np.allclose(there, [(-np.pi * radius, -radius, 0.0), (np.pi * radius, -radius, 0.0)])
