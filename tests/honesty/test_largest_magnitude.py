"""The largest magnitude is never negative, of what does not vary either: a state, a constant load."""

from __future__ import annotations

import pytest

from heuncli.output.tables import measure
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.queries.measure import measure_value
from heuncli.study.workflow import solve

HELD = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies: {weight: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {p: [0, 0, 0]}}}
joints: {guide: {type: slide, axis: [1, 0, 0], from: ground.O, to: weight.p, initial: {speed: -3}}}
"""
FORCE = 2 * 9.81


@pytest.mark.parametrize("analysis", ["{type: state}", "{times: [0.5]}", "{duration: 1, samples: 11}"])
@pytest.mark.parametrize(
    ("path", "size", "sign"),
    [
        ("joints.guide.force.z", FORCE, 1.0),
        ("foundation.force.z", FORCE, -1.0),
        ("coordinates.guide.speed", 3.0, -1.0),
    ],
)
def test_of_what_does_not_vary(analysis: str, path: str, size: float, sign: float) -> None:
    study = solve(load("held.yaml", f"{HELD}analysis: {analysis}\n"), Options())
    for words, expected in (("max abs", size), ("abs", size), ("max", sign * size), ("min", sign * size)):
        assert measure_value(measure.parse_measure(f"{words} {path}"), study).value == pytest.approx(expected), words
