"""Friction by what a joint carries: its derivative, its share, the plane's sweep, and what a run keeps."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from heuncli.base.errors import SolveError
from heuncli.multibody.response import make_workspace, tangent
from heuncli.multibody.tree.layout import Layout
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from tests.oracle.tellings import TELLINGS
from tests.oracle.values import to_yaml
from tests.shared.dual_tangent import dual_tangent
from tests.shared.retellings import same_results
from tests.shared.rubbing import rubbing_scene, rubs_of
from tests.shared.scenes import moving, near, solved

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


@pytest.mark.heavy
@pytest.mark.parametrize("method", ["DOP853", "Radau5", "Radau9", "DOPRI5"])
@pytest.mark.parametrize("space", ["planar", "spatial"])
@pytest.mark.third
def test_a_pendulum_in_its_journal(method: str, space: str) -> None:
    """By an equation solved for at every evaluation (Brent), and SciPy's integration; in the plane and in space."""
    r = solved(PENDULUM.replace("planar", space), method=method, tolerance=1e-9)
    wanted = pendulum_by_scipy(r.time)
    pivot = r.coordinates["pivot"]
    near([pivot["angle"], pivot["rate"]], wanted, 1.0, 2e-8)
    total = r.energy["kinetic"] + r.energy["potential"] - r.energy["work"]
    near(total, total[0], 2 * 9.81 * 0.7, 1e-8)


def laid_out(seed: int, loops: int, drives: int) -> Layout:
    """The first scene from a seed on, in tens, in which nothing that rubs is open."""
    for own in range(seed, 100, 10):
        scene, _ = rubbing_scene(own, loops, drives)
        try:
            s = set_up(load("scene.yaml", to_yaml({**scene, "analysis": {"duration": 1.0}})), method="DOP853")
        except SolveError as error:
            assert error.problems[0].code == "friction-open"
        else:
            return s.runner.integrated_scene.layout
    raise AssertionError("all open")


@pytest.mark.heavy
@pytest.mark.parametrize(("loops", "drives"), [(0, 0), (0, 1), (1, 0), (1, 1)])
@pytest.mark.parametrize("seed", range(4))
def test_its_derivative_is_that_of_dual_numbers(seed: int, loops: int, drives: int) -> None:
    layout = laid_out(seed, loops, drives)
    state = np.array(layout.y0)
    at = make_workspace(layout)
    at.configure_at(0.0, state)
    state, wanted = dual_tangent(layout, 0.0, state)
    found = tangent(at, 0.0, state)
    near(found, wanted, max(1.0, float(np.abs(wanted).max())), 1e-11)


CAUGHT = """
heun: 1
space: SPACE
gravity: [0, -9.81, 0]
ground: {points: {O: [0, 0, 0], A: [1.2, 0.3, 0]}}
bodies:
  bar: {mass: 2, center: [0, -0.5, 0], inertia: [0.2, 0.1, 0.2], points: {top: [0, 0, 0], end: [0, -1, 0]}}
  bob: {mass: 1, center: [0, -0.4, 0], inertia: [0.02, 0.02, 0.02], points: {top: [0, 0, 0]}}
joints:
  pivot: {type: pin, from: ground.O, to: bar.top, axis: [0, 0, 1], initial: {angle: 0.9, rate: 0}}
  elbow: {type: pin, from: bar.end, to: bob.top, axis: [0, 0, 1], initial: {angle: 0.3, rate: 0}}
  rope: {type: rod, from: ground.A, to: bar.end, length: 1.6, tension_only: true, restitution: 0}
stops: {limit: {joint: elbow, angle: [-0.6, 0.6], restitution: 0.2}}
forces:
  big: {type: friction, joint: pivot, coefficient: 0.3, radius: 50 mm, speed: 0.05}
  small: {type: friction, joint: elbow, coefficient: 0.3, radius: 30 mm, speed: 0.05}
analysis: {duration: 3, samples: 101}
"""


@pytest.mark.heavy
@pytest.mark.parametrize(("space", "method"), [("planar", "DOP853"), ("spatial", "DOP853"), ("planar", "Radau5")])
def test_a_rope_that_catches_presses_the_joints(space: str, method: str) -> None:
    """The law is met at every instant, the rope slack or taut; the energy that is missing is what rubs and strikes."""
    r = solved(CAUGHT.replace("SPACE", space), method=method)
    assert r.joints["rope"]["tension"].max() > 9.0
    for name, joint, arm in (("big", "pivot", 0.015), ("small", "elbow", 0.009)):
        pressed = np.linalg.norm(r.joints[joint]["force"], axis=1)
        wanted = -arm * pressed * np.tanh(r.forces[name]["rate"] / 0.05)
        near(r.forces[name]["value"], wanted, 1.0, 1e-13)
    total = r.energy["kinetic"] + r.energy["potential"] - r.energy["work"]
    near(total, total[0], 30.0, 1e-8)


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(6))
def test_its_share_is_its_own_value(seed: int) -> None:
    """The shares add up to all, and that of friction is what a torque of its value does alone."""
    scene, _ = rubbing_scene(seed)
    wanted = frozenset({"joints", "forces", "shares"})
    found = solved(scene, requested_reports=wanted)
    torques = {
        name: {"type": "torque", "joint": spec["joint"], "value": float(found.forces[name]["value"][0])}
        for name, spec in rubs_of(scene).items()
    }
    told = solved({**scene, "forces": scene["forces"] | torques}, requested_reports=wanted)
    for name, block in found.joints.items():
        size = max(1.0, float(np.abs(block["force"]).max()))
        near(sum(share["force"] for share in block["shares"].values()), block["force"], size)
        for cause in rubs_of(scene):
            near(block["shares"][cause]["force"], told.joints[name]["shares"][cause]["force"], size)


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("way", ["turned", "mirrored", "inches, pounds", "faster", "renamed", "other origins"])
@pytest.mark.third
def test_told_otherwise_it_is_the_same(way: str, seed: int) -> None:
    scene, _ = rubbing_scene(seed)
    times = np.array([0.0, 0.1, 0.25])
    other = TELLINGS[way](scene, np.random.default_rng(seed))
    first, second = solved(moving(scene, times, 1e-12)), solved(moving(other.scene, times * other.time, 1e-12))
    same_results(other, first, second, 1e-9)
