"""Drives and loads put together from pieces: what holds at the joint of two pieces alone does not stop a run."""

from __future__ import annotations

import numpy as np
import pytest

from tests.shared.scenes import near, solved, study

SCENE = """
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  b: {{mass: 2, center: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{o: [0, 0, 0], end: [1, 0, 0]}}}}
joints: {{A: {{type: pin, from: ground.O, to: b.o, axis: [0, 0, 1]}}}}
{more}
analysis: {{times: [0, 0.25, 0.5, 0.75, 1]}}
"""
T = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
SMOOTH = {
    "sign(t-0.5)*(t-0.5)**3": abs(T - 0.5) ** 3,
    "max(t-0.5,0)**2 + max(0,t-0.5)**2": 2 * np.maximum(T - 0.5, 0) ** 2,
    "min(t-0.5,0)**3 + max(t-0.5,0)**2": np.minimum(T - 0.5, 0) ** 3 + np.maximum(T - 0.5, 0) ** 2,
    "0.5*min(t,0.5)**2 + 0.5*max(t-0.5,0)": 0.5 * np.minimum(T, 0.5) ** 2 + 0.5 * np.maximum(T - 0.5, 0),
    "t**2*sign(t)": T**2,
    "sign(t-2)*t**2": -(T**2),
    "t**2*sign(t-0.5)*0": 0 * T,
}


@pytest.mark.parametrize("angle", SMOOTH)
def test_pieces_that_fit(angle: str) -> None:
    """The motion is the drive's, and so is the work: the change of the kinetic energy 1/2 0.6 rate^2."""
    found = solved(SCENE.format(more=f'drives: {{d: {{joint: A, angle: "{angle}"}}}}'))
    near(found.coordinates["A"]["angle"], SMOOTH[angle], 1.0, 1e-14)
    rate = found.bodies["b"]["angular_velocity"][:, 2]
    near(found.energy["work"], 0.3 * (rate**2 - rate[0] ** 2), 1.0, 1e-9)


KINKED = {  # the rates before and after t = 0.5
    "sign(t-0.5)*(t-0.5)": (-1.0, 1.0), "t*abs(t-0.5)": (-0.5, 0.5), "max(t-0.5,0) + max(0,t-0.5)**2": (0.0, 1.0),
}  # fmt: skip


@pytest.mark.parametrize("angle", KINKED)
def test_pieces_whose_rates_do_not_fit(angle: str) -> None:
    """A blow of the drive: J times the jump about the pin, m times that of the centre on it; J = 0.6, m = 2."""
    found = solved(SCENE.format(more=f'drives: {{d: {{joint: A, angle: "{angle}"}}}}'))
    before, after = KINKED[angle]
    (blow,) = found.impulses
    assert blow["time"] == 0.5
    assert blow["names"] == ["d"]
    near(blow["bodies"]["b"]["angular_velocity_jump"], [0.0, 0.0, after - before], 1.0, 1e-12)
    near(blow["joints"]["A"]["drive"], 0.6 * (after - before), 1.0, 1e-12)
    near(np.sum(blow["joints"]["A"]["force"] ** 2), (after - before) ** 2, 1.0, 1e-12)
    near(blow["energy_jump"], 0.3 * (after**2 - before**2), 1.0, 1e-12)
    near(found.coordinates["A"]["rate"][2], after, 1.0, 1e-12)
    near(np.ptp(found.energy["kinetic"] - found.energy["work"]), 0.0, 1.0, 1e-9)


def test_a_load_that_is_zero_at_one_instant() -> None:
    """sign(t - 0.5), told as what comes after its zero: beside a drive, and free on 0.1 + 2/4 kg m^2."""
    couple = 'forces: {f: {type: couple, on: b, vector: [0, 0, "sign(t-0.5)"]}}'
    driven = solved(SCENE.format(more=f"drives: {{d: {{joint: A, angle: t}}}}\n{couple}"))
    near(driven.joints["A"]["drive"], [1.0, 1.0, -1.0, -1.0, -1.0], 1.0, 1e-12)
    free = solved(SCENE.format(more=couple))
    first, late = np.minimum(T, 0.5), np.maximum(T - 0.5, 0.0)
    near(free.coordinates["A"]["angle"], (-(first**2) / 2 - 0.5 * late + late**2 / 2) / 0.6, 1.0, 1e-9)


@pytest.mark.parametrize("angle", ["t**4*sign(t)", "t*sign(t)", "sign(sin(10*t))*sin(10*t)**4"])
def test_what_holds_at_the_start_alone(angle: str) -> None:
    """sign(t) is zero at t = 0 and there only: no jump of the run."""
    found = study(SCENE.format(more=f'drives: {{d: {{joint: A, angle: "{angle}"}}}}'))
    wanted = {"t**4*sign(t)": T**4, "t*sign(t)": T}.get(angle, np.sign(np.sin(10 * T)) * np.sin(10 * T) ** 4)
    near(found.results.coordinates["A"]["angle"], wanted, 1.0, 1e-14)
    assert np.diff(found.search_times).min() > 1e-300
