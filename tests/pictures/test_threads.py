"""The thread of a screw as it is drawn: it moves the nut as the lead says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from heuncli.output.machine_geometry.elements import make_threads
from heuncli.scene.file_format.load import load

SCENE = """heun: 1
ground: {points: {A: [0, 0, 0], B: [0.2, 0, 0.5]}}
bodies:
  spindle: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}
  nut: {mass: 1, center: [0.2, 0, 0.5], inertia: [1, 1, 1], points: {o: [0.2, 0, 0.5]}}
joints:
  spin: {type: pin, from: ground.A, to: spindle.o, axis: [0, 0, 1]}
  guide: {type: slide, from: ground.B, to: nut.o, axis: [0, 0, 1]}
couplings: {thread: {type: screw, of: [spin, guide], lead: 0.05}}
analysis: {duration: 1}
"""
OTHER_WAY = SCENE.replace("to: nut.o, axis: [0, 0, 1]", "to: nut.o, axis: [0, 0, -1]")
TURNED_ROUND = SCENE.replace("from: ground.A, to: spindle.o", "from: spindle.o, to: ground.A")
CYLINDER = SCENE.replace("of: [spin, guide]", "of: [spin]").replace("type: pin", "type: cylinder")


def climb(line: np.ndarray) -> float:
    """How far a helix about z climbs in a turn."""
    angle = np.unwrap(np.arctan2(line[:, 1], line[:, 0]))
    return float(2.0 * np.pi * np.polyfit(angle, line[:, 2], 1)[0])


@pytest.mark.parametrize(
    ("scene", "pitch", "ends"),
    [
        (SCENE, -0.05, (0.0, 0.5)),  # a turn by +360 deg brings what lies 50 mm lower under the nut's angle
        (OTHER_WAY, 0.05, (0.0, 0.5)),
        (TURNED_ROUND, 0.05, (0.0, 0.5)),  # the spindle turns back as the joint's angle grows
        (CYLINDER, 0.05, (-0.15, 0.15)),  # its nut stands still, and is at its bearing
        (SCENE.replace("lead: 0.05", "lead: 0.001"), -0.5 / 24, (0.0, 0.5)),  # too fine to be seen
    ],
    ids=["spindle", "axes apart", "from the spindle", "cylinder", "fine"],
)
def test_a_thread_moves_its_nut(tmp_path: Path, scene: str, pitch: float, ends: tuple[float, float]) -> None:
    (tmp_path / "a.yaml").write_text(scene)
    ((body, (line,)),) = make_threads(load(tmp_path / "a.yaml")).items()
    assert body == "spindle" and (line[0, 2], line[-1, 2]) == pytest.approx(ends)
    assert climb(line) == pytest.approx(pitch)
    assert np.ptp(np.hypot(line[:, 0], line[:, 1])) < 1e-12
