"""A scene in which nothing can move, run over a time: its state has no numbers, and its loads act all the same."""

from __future__ import annotations

from math import sin

import numpy as np
import pytest

from tests.shared.scenes import solved, study

BAR = """\
heun: 1
gravity: [0, 0, -10]
ground: {points: {O: [0, 0, 0]}}
bodies:
  bar: {shapes: [{type: rod, from: [0, 0, 0], to: [2, 0, 0], mass: 3}], points: {a: [0, 0, 0], b: [2, 0, 0]}}
joints:
  foot: {type: JOINT, from: ground.O, to: bar.a}
MORE
sections:
  root: {body: bar, at: a, normal: [1, 0, 0], side: beyond}
analysis: {duration: 1.5, samples: 4}
"""
PUSH = 'forces: {push: {type: force, on: bar.b, vector: [0, 0, "6*sin(2*t)"]}}'
HELD = "drives: {hold: {joint: foot, angle: 0}}"
TRUSS = """\
heun: 1
space: planar
gravity: [0, -10, 0]
ground: {points: {A: [0, 0, 0], B: [2, 0, 0]}}
bodies:
  l: {mass: 1, center: [0.5, 0.5, 0], inertia: 0.1, points: {a: [0, 0, 0], b: [1, 1, 0]}}
  r: {mass: 1, center: [1.5, 0.5, 0], inertia: 0.1, points: {a: [2, 0, 0], b: [1, 1, 0]}}
joints:
  left: {type: pin, from: ground.A, to: l.a}
  right: {type: pin, from: ground.B, to: r.a}
  apex: {type: pin, from: l.b, to: r.b}
MORE
analysis: {duration: 1.5, samples: 4}
"""


@pytest.mark.parametrize(("joint", "more", "load"), [
    ("weld", "", lambda t: 0.0),
    ("weld", PUSH, lambda t: 6.0 * sin(2.0 * t)),
    ("'pin', axis: [0, 1, 0]", HELD, lambda t: 0.0),
    ("'pin', axis: [0, 1, 0]", f"{HELD}\n{PUSH}", lambda t: 6.0 * sin(2.0 * t)),
])  # fmt: skip
def test_a_welded_bar_carries_its_loads_at_every_instant(joint, more, load) -> None:  # type: ignore[no-untyped-def]
    found = solved(BAR.replace("JOINT", joint).replace("MORE", more))
    assert found.time.tolist() == [0.0, 0.5, 1.0, 1.5]
    push = np.array([load(t) for t in found.time])
    assert np.abs(found.joints["foot"]["force"][:, 2] - (30.0 - push)).max() < 1e-12
    assert np.abs(found.sections["root"]["Q2"] + (30.0 - push)).max() < 1e-12
    assert np.abs(found.sections["root"]["M1"] - (30.0 - 2.0 * push)).max() < 1e-12
    assert np.abs(found.foundation["force"][:, 2] + (30.0 - push)).max() < 1e-12
    assert not found.energy["work"].any() and not found.energy["kinetic"].any()
    assert found.accuracy["estimate"]["motion"] < 1e-14


@pytest.mark.parametrize("more", ["", 'forces: {push: {type: force, on: l.b, vector: ["5*sin(2*t)", 0, 0]}}'])
def test_a_truss_in_time(more: str) -> None:
    """Each half hangs by half its weight in the apex; what pushes there goes into both feet alike."""
    found = solved(TRUSS.replace("MORE", more))
    push = 5.0 * np.sin(2.0 * found.time) if more else np.zeros(4)
    assert np.abs(found.joints["left"]["force"][:, 1] - (10.0 - 0.5 * push)).max() < 1e-12
    assert np.abs(found.joints["left"]["force"][:, 0] - (5.0 - 0.5 * push)).max() < 1e-12


def test_between_the_instants_and_over_them() -> None:
    """Other instants and extremes of what never moves."""
    run = study(BAR.replace("JOINT", "weld").replace("MORE", ""))
    between = run.resample(np.array([0.1, 0.7]))
    assert between.joints["foot"]["force"][:, 2].tolist() == [30.0, 30.0]
    assert np.abs(between.bodies["bar"]["position"]).max() == 0.0
    assert len(run.search_times) > 4
