"""A check run that takes the very steps of the run it checks: in phase with jumps of a load, which end every step.

x'' = -w^2 x + f on a slide, f = 0 up to the first jump, then 1 and -1 by turns: known piece by piece. Both runs take
one step a piece, whatever their tolerance, and err alike; their difference would be rounding, 1e-15.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.motion.integration.check import runs
from tests.shared.scenes import study

CASES = [(10, 10), (10, 14), (10, 20), (20, 20), (20, 28), (30, 40)]  # w [1/s], jumps a second
LOOSE = 1e-4


def text(w: int, jumps: int) -> str:
    return f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{block: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{p: [0, 0, 0]}}}}}}
joints: {{guide: {{type: slide, from: ground.O, to: block.p, axis: [1, 0, 0], initial: {{travel: 0, speed: 0}}}}}}
forces:
  push:
    {{type: torque, joint: guide, value: "-{w**2}*guide.travel + (sign(sin({jumps}*pi*t)) if t > 1/{jumps} else 0)"}}
analysis: {{duration: 1, samples: 11, tolerance: {LOOSE}}}
"""


def travel(w: int, jumps: int, t: float) -> float:
    """Swings about f / w^2, piece by piece."""
    x, v, begin = 0.0, 0.0, 0.0
    for k in range(jumps):
        end = min((k + 1) / jumps, t)
        rest = (0.0 if k == 0 else 1.0 if k % 2 == 0 else -1.0) / w**2
        c, s = math.cos(w * (end - begin)), math.sin(w * (end - begin))
        x, v, begin = rest + (x - rest) * c + v / w * s, v * c - (x - rest) * w * s, end
    return x


@pytest.mark.parametrize(("w", "jumps"), CASES)
def test_what_is_told_is_no_less_than_the_error(w: int, jumps: int, monkeypatch: pytest.MonkeyPatch) -> None:
    s = study(text(w, jumps), method="DOP853")
    found = s.results
    assert found.work["steps"] == jumps
    travels = found.coordinates["guide"]["travel"]
    off = max(abs(x - travel(w, jumps, t)) for t, x in zip(found.time.tolist(), travels.tolist(), strict=True))
    off /= s.setup.runner.layout.size
    assert off > 1e-12  # more than rounding
    assert off <= found.accuracy["estimate"]["motion"] <= LOOSE
    monkeypatch.setattr(runs, "has_shared_steps", lambda *_: False)  # by the difference of the two alone
    assert study(text(w, jumps), method="DOP853").results.accuracy["estimate"]["motion"] < 1e-3 * off


def test_a_run_that_ends_at_its_start_shares_no_step() -> None:
    """As where a rope would have to push at once, in a start moved by rounding alone."""
    assert not runs.has_shared_steps(np.array([0.1, 0.2]), np.zeros(0))


WIDE = """
heun: 1
gravity: [0, 0, -9.81]
parameters: {out: 12 + 6*sin(4*deg), w: sqrt(9.81*tan(4*deg)/out)}
ground: {points: {mast: [0, 0, 0]}}
bodies:
  jib: {shapes: [{type: box, center: [6, 0, 0], size: [12, 0.2, 0.3], mass: 900}],
    points: {root: [0, 0, 0], tip: [12, 1.229e-14, 0]}}
  load: {shapes: [{type: sphere, center: [0, 0, 0], radius: 1.432e17, mass: 2000}], points: {hook: [0, 0, 0]},
    position: [out, 0, -6*cos(4*deg)], velocity: [0, w*out, 0]}
joints:
  slew: {type: pin, from: ground.mast, to: jib.root, axis: [0, 0, 1], initial: {angle: 0, rate: w}}
  rope: {type: rod, from: jib.tip, to: load.hook, length: 6, tension_only: true}
analysis: {duration: 2*pi/w, samples: 101}
"""


def test_beside_a_run_that_ends_at_its_start_nothing_is_claimed() -> None:
    """Rounding decides whether the rope pulls a load of 1.4e17 m: one of the runs has no steps."""
    assert study(WIDE).results.accuracy["horizon"] == 0.0
