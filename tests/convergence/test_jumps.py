"""Jumps and kinks in time are met exactly: a flywheel with a damper under torques that switch, against its closed form.

I w. = M(t) - c w,  M = a + b s on each piece, s the time since its start:
w = (w0 - A) exp(-k s) + A + B s,   k = c/I,  B = b/(I k),  A = a/(I k) - B/k
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest

from heuncli.results.results import Array, Results
from tests.shared.bars import HEAD
from tests.shared.scenes import near, solved, study

I, C = 0.5, 0.3
Pieces = Sequence[tuple[float, float, float]]  # start, torque there, its slope


def exact(pieces: Pieces, times: Array, rate: float = 2.0) -> tuple[Array, Array]:
    """Angle and rate at the times, from angle 0."""
    k, angle = C / I, 0.0
    angles, rates = [], []
    ends = [start for start, _, _ in pieces[1:]] + [math.inf]
    for (start, a, b), end in zip(pieces, ends, strict=True):
        B = b / (I * k)
        A = a / (I * k) - B / k

        def at(s: float, w0: float = rate, x0: float = angle, A: float = A, B: float = B) -> tuple[float, float]:
            fall = math.exp(-k * s)
            return x0 + (w0 - A) * (1 - fall) / k + A * s + B * s * s / 2, (w0 - A) * fall + A + B * s

        for t in times[(times >= start) & (times < end)].tolist():
            x, w = at(t - start)
            angles.append(x)
            rates.append(w)
        if end < math.inf:
            angle, rate = at(end - start)
    return np.array(angles), np.array(rates)


def flywheel(torque: str, times: Sequence[float], tables: str = "") -> Results:
    return solved(scene(torque, times, tables))


def scene(torque: str, times: Sequence[float], tables: str = "") -> str:
    """A flywheel under a torque in time and a damper."""
    return (
        HEAD
        + f"""
{tables}
bodies:
  wheel: {{mass: 3, center: [0, 0, 0], inertia: [0.3, 0.3, {I}], points: {{hub: [0, 0, 0]}}}}
joints:
  shaft: {{type: pin, from: ground.O, to: wheel.hub, axis: [0, 0, 1], initial: {{angle: 0, rate: 2}}}}
forces:
  motor: {{type: torque, joint: shaft, value: "{torque}"}}
  drag: {{type: damper, joint: shaft, coefficient: {C}}}
analysis: {{times: {[float(t) for t in times]}, tolerance: 1e-13}}
"""
    )


def compare(found: Results, pieces: Pieces, tolerance: float = 1e-12) -> None:
    angle, rate = exact(pieces, found.time)
    size = max(1.0, float(np.abs(angle).max()), float(np.abs(rate).max()))
    near(found.coordinates["shaft"]["angle"], angle, size, tolerance)
    near(found.coordinates["shaft"]["rate"], rate, size, tolerance)


def test_one_step() -> None:
    """Also asked at the jump itself, where the torque is already the new one, and right beside it."""
    jump = 0.7371
    times = [0.0, 0.5, math.nextafter(jump, 0.0), jump, math.nextafter(jump, 1.0), 0.9, 2.0]
    found = flywheel(f"3*step(t - {jump})", times)
    compare(found, [(0.0, 0.0, 0.0), (jump, 3.0, 0.0)])
    assert found.forces["motor"]["value"].tolist() == [0.0, 0.0, 0.0, 3.0, 3.0, 3.0, 3.0]


def test_a_short_pulse_between_two_long_steps() -> None:
    """A pulse of 1 ms that no step length would have found."""
    found = flywheel("5000*(step(t - 1.2) - step(t - 1.201))", np.linspace(0, 3, 13))
    compare(found, [(0.0, 0.0, 0.0), (1.2, 5000.0, 0.0), (1.201, 0.0, 0.0)])


def test_a_train_of_pulses() -> None:
    """On while the sine is not negative: 20 jumps."""
    found = flywheel("2*step(sin(4*pi*t))", np.linspace(0, 5, 101))
    compare(found, [(k / 4, 2.0 * ((k + 1) % 2), 0.0) for k in range(21)])
    assert found.work["steps"] < 21 * 12  # some steps a piece, not a thousand about each jump


def test_kinks() -> None:
    """abs, min, max and a conditional."""
    found = flywheel("abs(2*t - 1) + min(t, 0.25) + (1 if t > 1.5 else 0)", np.linspace(0, 2, 41))
    compare(found, [(0.0, 1.0, -1.0), (0.25, 0.75, -2.0), (0.5, 0.25, 2.0), (1.5, 3.25, 2.0)])


def test_a_table() -> None:
    """Linear between its knots, held outside."""
    knots, values = [0.0, 0.3, 0.31, 0.8, 1.5], [0.0, 2.0, -1.0, 4.0, 0.5]
    tables = f"tables: {{load: {{x: {knots}, y: {values}, outside: hold}}}}"
    found = flywheel("table(load, t)", np.linspace(0, 2, 41), tables)
    slopes = [(b - a) / (q - p) for p, q, a, b in zip(knots, knots[1:], values, values[1:], strict=False)]
    compare(found, [*zip(knots, values, slopes, strict=False), (1.5, 0.5, 0.0)])


def test_a_periodic_table() -> None:
    """A saw tooth: rises over 0.4 s, falls over 0.1 s."""
    tables = "tables: {saw: {x: [0, 0.4, 0.5], y: [0, 2, 0], period: 0.5}}"
    found = flywheel("table(saw, t)", np.linspace(0, 2, 41), tables)
    pieces = [(0.5 * k + s, a, b) for k in range(4) for s, a, b in ((0.0, 0.0, 5.0), (0.4, 2.0, -20.0))]
    compare(found, pieces)


@pytest.mark.parametrize("jump", [1e-9, 0.5, 2.0 - 1e-12])
def test_jumps_at_the_rim_of_the_run(jump: float) -> None:
    found = flywheel(f"1 - 2*step(t - {jump!r})", [0.0, 1.0, 2.0])
    compare(found, [(0.0, 1.0, 0.0), (jump, -1.0, 0.0)])


@pytest.mark.parametrize("together", [True, False])
def test_other_instants_of_the_same_run(together: bool) -> None:
    """resample: many instants by one run more, few from the nearest known state; jumps are met all the same."""
    run = study(scene("2*step(sin(4*pi*t))", np.linspace(0, 5, 11)))
    pieces = [(k / 4, 2.0 * ((k + 1) % 2), 0.0) for k in range(21)]
    times = np.sort(np.random.default_rng(0).uniform(0, 5, 200 if together else 9))
    for some in [times] if together else times[:, None]:
        found = run.resample(some)
        assert np.array_equal(found.time, some)
        compare(found, pieces)
    again, asked = run.resample(run.history.times), run.results
    near(again.coordinates["shaft"]["angle"], asked.coordinates["shaft"]["angle"], 10.0, 1e-13)


def test_energy_over_jumps() -> None:
    """Kinetic energy less the work of torque and damper stays over all jumps."""
    found = flywheel("2*step(sin(4*pi*t))", np.linspace(0, 5, 11))
    total = found.energy["kinetic"] - found.energy["work"]
    near(total, total[0], float(found.energy["kinetic"].max()), 1e-12)
