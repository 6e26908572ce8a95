"""Friction by what a joint carries: its derivative, its share, the plane's sweep, and what a run keeps."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from heuncli.response import tangent, workspace_of
from heuncli.spec.load import load
from heuncli.study.model.setup import set_up
from tests.oracle.values import to_yaml
from tests.shared.dual_tangent import dual_tangent
from tests.shared.rubbing import rubbing_scene, rubs_of
from tests.shared.scenes import near, solved

PENDULUM = """
heun: 1
space: planar
gravity: [0, -9.81, 0]
ground: {points: {O: [0, 0, 0]}}
bodies: {bob: {mass: 2, center: [0, -0.7, 0], inertia: [0.1, 0.1, 0.1], points: {top: [0, 0, 0]}}}
joints: {pivot: {type: pin, from: ground.O, to: bob.top, axis: [0, 0, 1], initial: {angle: 1.2, rate: 0}}}
forces: {journal: {type: friction, joint: pivot, coefficient: 0.3, radius: 0.2, speed: 0.3}}
analysis: {duration: 4, samples: 41}
"""


def pendulum_by_scipy(times: np.ndarray) -> np.ndarray:
    """theta, theta' of the same pendulum: what presses is the root of one equation at every evaluation."""
    m, c, J, g = 2.0, 0.7, 0.1 + 2.0 * 0.7**2, 9.81

    def accelerated(t: float, y: np.ndarray) -> list[float]:
        th, w = y
        slip = 0.3 * 0.2 * np.tanh(w / 0.3)
        out, along = np.array([np.sin(th), -np.cos(th)]), np.array([np.cos(th), np.sin(th)])

        def acceleration(N: float) -> float:
            return float((-m * g * c * np.sin(th) - slip * N) / J)

        def missing(N: float) -> float:
            F = m * (c * (acceleration(N) * along - w * w * out) + np.array([0.0, g]))
            return float(np.hypot(*F) - N)

        return [w, acceleration(brentq(missing, 0.0, 1e4, xtol=1e-13, rtol=1e-14))]

    found = solve_ivp(accelerated, (0.0, times[-1]), [1.2, 0.0], "DOP853", times, rtol=1e-12, atol=1e-13)
    return np.asarray(found.y)


@pytest.mark.parametrize("method", ["DOP853", "Radau5", "Radau9", "DOPRI5"])
@pytest.mark.parametrize("space", ["planar", "spatial"])
def test_a_pendulum_in_its_journal(method: str, space: str) -> None:
    """By an equation solved for at every evaluation (Brent), and SciPy's integration; in the plane and in space."""
    r = solved(PENDULUM.replace("planar", space), method=method, tolerance=1e-9)
    wanted = pendulum_by_scipy(r.time)
    pivot = r.coordinates["pivot"]
    near([pivot["angle"], pivot["rate"]], wanted, 1.0, 2e-8)
    total = r.energy["kinetic"] + r.energy["potential"] - r.energy["work"]
    near(total, total[0], 2 * 9.81 * 0.7, 1e-8)


@pytest.mark.heavy
@pytest.mark.parametrize(("loops", "drives"), [(0, 0), (0, 1), (1, 0), (1, 1)])
@pytest.mark.parametrize("seed", range(4))
def test_its_derivative_is_that_of_dual_numbers(seed: int, loops: int, drives: int) -> None:
    scene, _ = rubbing_scene(seed, loops, drives)
    s = set_up(load("scene.yaml", to_yaml({**scene, "analysis": {"duration": 1.0}})), method="DOP853")
    layout = s.runner.moving.layout
    state = np.array(layout.y0)
    at = workspace_of(layout)
    at.configure_at(0.0, state)
    state, wanted = dual_tangent(layout, 0.0, state)
    found = tangent(at, 0.0, state)
    near(found, wanted, max(1.0, float(np.abs(wanted).max())), 1e-11)


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(6))
def test_its_share_is_its_own_value(seed: int) -> None:
    """The shares add up to all, and that of friction is what a torque of its value does alone."""
    scene, _ = rubbing_scene(seed)
    wanted = frozenset({"joints", "forces", "shares"})
    found = solved(scene, wanted=wanted)
    torques = {
        name: {"type": "torque", "joint": spec["joint"], "value": float(found.forces[name]["value"][0])}
        for name, spec in rubs_of(scene).items()
    }
    told = solved({**scene, "forces": scene["forces"] | torques}, wanted=wanted)
    for name, block in found.joints.items():
        size = max(1.0, float(np.abs(block["force"]).max()))
        near(sum(share["force"] for share in block["shares"].values()), block["force"], size)
        for cause in rubs_of(scene):
            near(block["shares"][cause]["force"], told.joints[name]["shares"][cause]["force"], size)
