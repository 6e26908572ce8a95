"""What a probe claims against closed forms: rates of random chains of masses, dead centres of random slider-cranks."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

from heuncli.analyses.motion_diagnostics.results import DEAD_CENTRE, Probe
from heuncli.analyses.motion_diagnostics.study import probe
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from tests.shared.chains import chain


def probed(text: str) -> Probe:
    return probe(load("scene.yaml", text), Options())


@pytest.mark.parametrize("seed", range(24))
@pytest.mark.third
def test_the_rates_of_a_chain(seed: int) -> None:
    text, A = chain(seed, "{duration: 0.2, samples: 3}")
    found, values = probed(text).stiffness, np.linalg.eigvals(A)
    assert found is not None
    largest = float(np.abs(values).max())
    assert found.decay == pytest.approx(float(-values.real.min()), abs=1e-7 * largest)
    assert found.oscillation == pytest.approx(float(np.abs(values.imag).max()), abs=1e-7 * largest)


@pytest.mark.parametrize("seed", range(16))
@pytest.mark.third
def test_the_dead_centres_of_a_slider_crank(seed: int) -> None:
    """The bore, which passes beside the pin, stands where crank and rod are in line: sin(phi) (r +- l) = e."""
    draw = random.Random(seed)
    r, phase, rate = draw.uniform(0.05, 0.2), draw.uniform(0, 6), draw.uniform(5, 40)
    rod, beside = r * draw.uniform(2, 4), r * draw.uniform(-0.5, 0.5)
    duration = 2.2 * 2 * math.pi / rate
    x, y = r * math.cos(phase), r * math.sin(phase)
    tilt = math.asin((beside - y) / rod)
    reach = x + math.sqrt(rod**2 - (beside - y) ** 2)
    text = f"""
heun: 1
ground: {{points: {{O: [0, 0, 0], B: [0, {beside!r}, 0]}}}}
bodies:
  crank: {{mass: 1, center: [0, 0, 0], inertia: [1e-3, 1e-3, 1e-3], points: {{o: [0, 0, 0], a: [{r!r}, 0, 0]}}}}
  rod: {{mass: 1, center: [0, 0, 0], inertia: [1e-2, 1e-2, 1e-2], points: {{a: [0, 0, 0], b: [{rod!r}, 0, 0]}},
        near: {{position: [{x!r}, {y!r}, 0], orientation: {{axis: [0, 0, 1], angle: {tilt!r}}}}}}}
  piston: {{mass: 1, center: [0, 0, 0], inertia: [1e-3, 1e-3, 1e-3], points: {{b: [0, 0, 0]}},
           near: {{position: [{reach!r}, {beside!r}, 0]}}}}
joints:
  main: {{type: pin, axis: [0, 0, 1], from: ground.O, to: crank.o}}
  big: {{type: pin, axis: [0, 0, 1], from: crank.a, to: rod.a}}
  small: {{type: ball, from: rod.b, to: piston.b}}
  bore: {{type: slide, axis: [1, 0, 0], from: ground.B, to: piston.b}}
drives: {{d: {{joint: main, angle: "{phase!r} + {rate!r}*t"}}}}
analysis: {{duration: {duration!r}, samples: 4}}
"""
    events = probed(text).events
    told = [event.time for event in events if event.kind == DEAD_CENTRE and event.where.startswith("joints.bore")]
    angles = [math.asin(beside / (rod + r)), math.pi - math.asin(-beside / (rod - r))]
    turns = [(angle - phase) / rate + 2 * math.pi * k / rate for angle in angles for k in range(-3, 5)]
    assert told == pytest.approx(sorted(t for t in turns if 0.0 < t < duration), abs=1e-9 * duration)
