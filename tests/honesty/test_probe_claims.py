"""What a probe claims against closed forms: rates of random chains of masses, dead centres of random slider-cranks."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

from heuncli.commands.probing.results import DEAD_CENTRE, Probe
from heuncli.commands.probing.study import probe
from heuncli.spec.load import load
from heuncli.study.model.options import Options


def probed(text: str) -> Probe:
    return probe(load("scene.yaml", text), Options())


def chain(seed: int) -> tuple[str, np.ndarray[tuple[int, int], np.dtype[np.float64]]]:
    """Masses on slides one behind the other with springs and dampers between, and the matrix of their state."""
    draw = random.Random(seed)
    n = draw.randint(1, 4)
    m = [10 ** draw.uniform(-1, 1) for _ in range(n)]
    k = [10 ** draw.uniform(0, 4) for _ in range(n)]
    c = [10 ** draw.uniform(-2, 2) for _ in range(n)]
    bodies, joints, forces = [], [], []
    before = "ground.O"
    for i in range(n):
        bodies.append(f"  b{i}: {{mass: {m[i]!r}, center: [0, 0, 0], inertia: [1, 1, 1], points: {{c: [0, 0, 0]}}}}")
        joints.append(f"  s{i}: {{type: slide, axis: [1, 0, 0], from: {before}, to: b{i}.c, initial: {{travel: 0.1}}}}")
        forces.append(f"  f{i}: {{type: torque, joint: s{i}, value: {-k[i]!r}*s{i}.travel - {c[i]!r}*s{i}.speed}}")
        before = f"b{i}.c"
    head = "heun: 1\nground: {points: {O: [0, 0, 0]}}\n"
    blocks = [("bodies", bodies), ("joints", joints), ("forces", forces)]
    text = head + "".join(f"{name}:\n" + "\n".join(rows) + "\n" for name, rows in blocks)
    # x_i = sum of the travels up to i; the force of a travel acts on both its ends
    to_places = np.tril(np.ones((n, n)))
    M = to_places.T @ np.diag(m) @ to_places
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, np.diag(k)), -np.linalg.solve(M, np.diag(c))]])
    return text + "analysis: {duration: 0.2, samples: 3}\n", A


@pytest.mark.parametrize("seed", range(24))
def test_the_rates_of_a_chain(seed: int) -> None:
    text, A = chain(seed)
    found, values = probed(text).stiffness, np.linalg.eigvals(A)
    assert found is not None
    largest = float(np.abs(values).max())
    assert found.decay == pytest.approx(float(-values.real.min()), abs=1e-7 * largest)
    assert found.oscillation == pytest.approx(float(np.abs(values.imag).max()), abs=1e-7 * largest)


@pytest.mark.parametrize("seed", range(16))
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
