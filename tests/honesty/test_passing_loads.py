"""What slides over a cut passes it whole: the joint and the loads in it stand on one side at every instant."""

from __future__ import annotations

import random

import numpy as np
import pytest

from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.queries.measure import MeasureRequest, measure_value
from heuncli.study.workflow import solve

AROUND = 1e-7  # s: so far before and behind a passage the loads are those of either side
CHANGE = 1e-4  # of the largest load, over that time


def scene(seed: int) -> str:
    """A beam pulled along a slider that turns, which passes a cut of it, all askew: places are rounded."""
    draw = random.Random(seed)
    axis = [draw.gauss(0, 1) for _ in range(3)]
    along = np.array([draw.gauss(0, 1) for _ in range(3)])
    along /= np.linalg.norm(along)
    cut, corner = (0.5 * along).tolist(), [draw.gauss(0, 1) for _ in range(3)]
    return f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  beam: {{mass: 5, center: [0, 0, 0], inertia: [1, 1, 1], points: {{O: [0, 0, 0]}}}}
  slider: {{mass: 2, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{c: {corner}, O: [0, 0, 0]}}}}
joints:
  pin: {{type: pin, from: ground.O, to: slider.O, axis: {axis}}}
  guide: {{type: slide, from: beam.O, to: slider.c, axis: {along.tolist()}, initial: {{travel: 0.1}}}}
drives: {{motor: {{joint: pin, angle: "{draw.uniform(0.5, 2)!r}*t"}}}}
forces:
  pull: {{type: torque, joint: guide, value: {draw.uniform(150, 300)!r}}}
  drag: {{type: damper, joint: guide, coefficient: {draw.uniform(1, 5)!r}}}
sections:
  cut: {{body: beam, at: {cut}, normal: {along.tolist()},
        piece: {{mass: 2, center: {along.tolist()}, inertia: [0, 0, 0]}}}}
analysis: {{duration: 0.5, samples: 6}}
"""


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.third
def test_extremes_are_those_of_either_side(seed: int) -> None:
    run = solve(load("beam.yaml", scene(seed)), Options(requested_reports=frozenset({"sections", "motion", "joints"})))
    places = {action.name: action.to_end.position for action in run.recovery.actions}
    assert np.array_equal(places["pull"], places["guide"]) and np.array_equal(places["drag"], places["guide"])
    travel = run.resample(np.linspace(0.0, 0.5, 5001)).coordinates["guide"]["travel"]
    k = int(np.argmax(travel > 0.5))
    assert 0 < k
    times = np.linspace(0.0, 0.5, 5001)
    low, high = times[k - 1], times[k]
    for _ in range(60):  # down to neighbouring instants
        middle = 0.5 * (low + high)
        over = run.resample(np.array([middle])).coordinates["guide"]["travel"][0] > 0.5
        low, high = (low, middle) if over else (middle, high)
    near = low + np.arange(-40, 41) * np.spacing(low)
    sides = run.resample(np.array([low - AROUND, *near, high + AROUND])).sections["cut"]
    for part in ("N", "Q1", "Q2", "M1", "M2", "T"):
        loads = sides[part]
        size = float(np.abs(sides["force"]).max()) if part[0] in "NQ" else float(np.abs(sides["moment"]).max())
        apart = np.minimum(np.abs(loads - loads[0]), np.abs(loads - loads[-1]))
        assert apart.max() <= CHANGE * size, part
        largest = measure_value(MeasureRequest("abs", f"sections.cut.{part}"), run).value
        dense = np.abs(run.resample(times).sections["cut"][part]).max()
        assert largest <= max(dense, np.abs(loads[[0, -1]]).max()) + 1e-3 * size
