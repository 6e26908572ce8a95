"""A load or drive in time that is still but for a short pulse: no step passes over it, wherever its stages fall."""

from __future__ import annotations

import math

import pytest

from heuncli.study.queries.measure import find_peak
from tests.shared.pushed_block import pushed_block
from tests.shared.scenes import near, study


@pytest.mark.parametrize("width", [1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
def test_a_blow_sets_a_block_going(width: float) -> None:
    """The push's integral is the speed, whatever else is near: for exp(-(t/w)^2)/w the root of pi."""
    run = study(pushed_block(f"exp(-((t - 5.3)/{width!r})**2)/{width!r}")).results
    estimate = run.accuracy["estimate"]["motion"]
    near(run.coordinates["guide"]["speed"][-1], math.sqrt(math.pi), 1.0, 1e-9 + 10 * estimate)
    near(run.coordinates["guide"]["travel"][-1], 4.7 * math.sqrt(math.pi), 10.0, estimate)


@pytest.mark.parametrize(("value", "speed"), [
    ("500*(tanh(1e4*(t - 5.3)) - tanh(1e4*(t - 5.301)))", 1.0),
    ("1e3*exp(-((t - 5.3)/1e-3)**2) + 1e3*exp(-((t - 7.1)/1e-4)**2)", 1.1 * math.sqrt(math.pi)),
    ("1e-4/(1e-8 + (t - 5.3)**2)", math.atan(5.3e4) + math.atan(4.7e4)),
    ("3 + 1e3*exp(-((t - 5.3)/1e-3)**2)", 30 + math.sqrt(math.pi)),
    ("1e3*sin(2000*t)*exp(-((t - 5.3)/1e-3)**2)", math.sqrt(math.pi) * math.exp(-1) * math.sin(10600)),
])  # fmt: skip
def test_pulses_of_other_shapes(value: str, speed: float) -> None:
    near(study(pushed_block(value)).results.coordinates["guide"]["speed"][-1], speed, max(speed, 1.0), 1e-9)


def test_a_drive_that_jerks_once() -> None:
    """angle = exp(-((t - 5.3)/w)^2): the largest torque is I φ'' with φ'' = 4 exp(-3/2)/w^2."""
    run = study("""
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  disc: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}
joints:
  shaft: {type: pin, from: ground.O, to: disc.o, axis: [0, 0, 1]}
drives:
  motor: {joint: shaft, angle: "exp(-((t - 5.3)/0.01)**2)"}
analysis: {duration: 10, samples: 3}
""")
    found, at, *_ = find_peak(run, "joints.shaft.drive", "max")
    near(found, 4 * math.exp(-1.5) * 1e4, 1e4, 1e-6)
    near(abs(at - 5.3), 0.01 * math.sqrt(1.5), 0.01, 1e-3)


def test_a_smooth_load_costs_nothing() -> None:
    """Where the stages have seen what there is, the run is not made again."""
    run = study(pushed_block("sin(3*t) + t*(10 - t)/25"))
    assert run.history.jumps == ()
