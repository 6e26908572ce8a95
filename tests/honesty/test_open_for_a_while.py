"""The largest of a run is no number where the quantity is open for a while: there it may be any."""

from __future__ import annotations

import math

import pytest

from heuncli.analyses.variants.evaluation import measure_study
from heuncli.output.tables import measure
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.queries.measure import measure_value
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve

# A block slides until a stop and a rope hold it at the same instant: from then on both together bear the force.
HELD_TWICE = """\
heun: 1
ground: {points: {O: [0, 0, 0], Q: [-1, 0, 0]}}
bodies: {block: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {p: [0, 0, 0]}}}
joints:
  guide: {type: slide, from: ground.O, to: block.p, axis: [1, 0, 0]}
  rope: {type: rod, from: ground.Q, to: block.p, length: 1.1, tension_only: true, restitution: 0}
stops: {buffer: {joint: guide, travel: [null, 0.1], restitution: 0}}
forces: {push: {type: force, on: block.p, vector: [10, 0, 0]}}
analysis: {duration: 1, samples: 11}
"""
CAUGHT = math.sqrt(2.0 * 0.1 / 10.0)


@pytest.fixture(scope="module")
def study() -> Study:
    return solve(load("held.yaml", HELD_TWICE), Options())


@pytest.mark.parametrize("how", ["max", "min", "max abs"])
@pytest.mark.parametrize("path", ["stops.buffer.force", "joints.rope.tension"])
def test_what_is_open_for_a_while_has_no_extreme(study: Study, how: str, path: str) -> None:
    asked = measure.parse_measure(f"{how} {path}")
    found = measure_value(asked, study)
    assert math.isnan(found.value)
    assert found.time == pytest.approx(CAUGHT, abs=0.1)
    assert measure.format_measures([asked], study, "table") == "open\n"
    answer = measure_study(asked, study)
    assert (answer.value, answer.word) == (None, "open")


def test_what_is_never_open_has_its_extreme(study: Study) -> None:
    assert measure_value(measure.parse_measure("max foundation.force.x"), study).value == pytest.approx(10.0)
    assert measure_value(measure.parse_measure("max coordinates.guide.travel"), study).value == pytest.approx(0.1)
    assert measure_value(measure.parse_measure("at 0.1 stops.buffer.force"), study).value == 0.0
