"""The modes of a scene are how it moves: started a little along a mode's shape, a run follows exp(l t) for a while."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from heuncli.analyses.modes.reference_state import find_state, require_time_independent
from heuncli.base.errors import SolveError
from heuncli.motion.integration.methods.explicit import DOP853
from heuncli.motion.integration.run.request import MotionTask
from heuncli.motion.linearisation.displacements import displace
from heuncli.motion.linearisation.oscillations import Mode, find_modes
from heuncli.motion.linearisation.reduced_equations import find_massless_spins
from heuncli.motion.linearisation.steady_motion import LinearisedState, continue_motion
from heuncli.multibody.tree.layout import rate_indices
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from tests.oracle.values import to_yaml
from tests.shared.folders import ROOT
from tests.shared.governors import porter, spindle

SMALL = 1e-5  # of turns, of the size, and of both a second: what is not linear is smaller by this once more
SPECS = sorted(path.name for path in (ROOT / "specs").glob("*.yaml"))


def started(here: LinearisedState, x: Array, rate: Array) -> Array:
    """The state displaced along x, at its own rates changed by `rate`."""
    return displace(here.layout, here.linear.state, x, rate)


def moved(here: LinearisedState, state: Array, y0: Array) -> Array:
    """How far the freedoms of a state are from those of another: small turns of balls, and differences."""
    layout = here.layout
    place = rate_indices(layout)
    order = {u: k for k, u in enumerate(place[place >= 0].tolist())}
    out = np.zeros(len(order))
    for freedom in layout.tables["freedoms"]:
        if not freedom["driven"]:
            out[order[int(freedom["u_at"])]] = state[freedom["q_at"]] - y0[freedom["q_at"]]
    for body in layout.bodies[layout.bodies["ball"] == 1]:
        own = slice(int(body["attitude_at"]), int(body["attitude_at"]) + 4)
        (w, *v), (a, *b) = state[own], y0[own]
        # the vector part of q q0*, twice: the small turn from q0 to q
        turn = 2.0 * (a * np.array(v) - w * np.array(b) - np.cross(v, b))
        first = order[int(body["rate_at"])]
        out[first : first + 3] = turn
    return out


@pytest.mark.heavy
@pytest.mark.parametrize("name", SPECS)
@pytest.mark.sixth
def test_a_run_follows_its_modes(name: str) -> None:
    """Of all specs at rest: a quarter of a period, or until exp(l t) has grown or died by a third."""
    setup = set_up(load(ROOT / "specs" / name), reduce=False)
    try:
        require_time_independent(setup)
        here, *_ = find_state(setup)
    except SolveError:
        pytest.skip("neither at rest nor steady")
    if here.layout.has_laws or here.linear.omega.any() or here.linear.velocities.any():
        pytest.skip("is driven, or moves")
    for mode in find_modes(here.system, here.indifferent):
        if mode.kind != "free":
            follow(here, mode)


def follow(here: LinearisedState, mode: Mode) -> None:
    """A run from a little along a mode against its exponential."""
    value = mode.eigenvalue
    amplitude = SMALL / max(1.0, abs(value))
    x = mode.shape * (amplitude / np.abs(here.weights * mode.shape).max())
    start = started(here, x.real, (value * x).real)
    until = 0.3 / abs(value.real) if value.imag == 0.0 else 0.25 / mode.frequency
    times = np.array([0.0, 0.5, 1.0]) * until
    run = here.runner.run(MotionTask(times, 1e-13, method=DOP853, start=start))
    for t, state in zip(run.times, run.states, strict=True):
        wanted = (np.exp(value * t) * x).real
        off = here.weights * (moved(here, state, here.linear.state) - wanted)
        assert np.abs(without_idle(here, off)).max() <= 1e2 * SMALL * amplitude


def without_idle(here: LinearisedState, off: Array) -> Array:
    """Differences by the weights, less those along spins that no inertia resists: a motion does not determine them."""
    spins = [
        here.weights * (here.linear.tangent @ spin.tangent) for spin in find_massless_spins(here.scene, here.linear)
    ]
    if not spins:
        return off
    idle = np.array(spins).T
    return np.asarray(off - idle @ np.linalg.lstsq(idle, off, rcond=None)[0])


def top(spin: float) -> dict[str, Any]:
    """One that sleeps: upright, and fast enough."""
    body = {"mass": 1.2, "center": [0, 0, 0.1], "inertia": [0.008, 0.008, 0.003], "points": {"tip": [0, 0, 0]}}
    return {
        "gravity": [0, 0, -9.81],
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {"top": {**body, "angular_velocity": [0, 0, spin]}},
        "joints": {"tip": {"type": "ball", "from": "ground.O", "to": "top.tip"}},
    }


STEADY = {
    "top": top(150.0), "slow top": top(20.0), "governor": porter(20.0)[0],
    "arm": spindle("pin", math.sqrt(9.81 / math.cos(0.7)), 0.7),
    "ball": spindle("ball", math.sqrt(9.81 / math.cos(0.7)), 0.7),
}  # fmt: skip


@pytest.mark.heavy
@pytest.mark.parametrize("name", STEADY)
def test_a_steady_run_follows_its_modes(name: str) -> None:
    """Beside a motion that goes on steadily another one, seen by what turns along: exp(l t), rates to fit."""
    here, *_ = find_state(set_up(load("scene.yaml", to_yaml(STEADY[name])), reduce=False))
    system = here.system
    for mode in find_modes(system, here.indifferent):
        if mode.kind == "free":
            continue
        value = mode.eigenvalue
        xi = system.tangent.T @ system.mass @ mode.shape
        rate = system.tangent @ (value * xi - system.A11 @ xi) + system.drift @ xi
        amplitude = SMALL / np.abs(np.concatenate([here.weights * mode.shape, here.weights * rate])).max()
        times = np.array([0.0, 0.5, 1.0]) * 0.3 / abs(value)
        start = displace(here.layout, here.linear.state, amplitude * mode.shape.real, amplitude * rate.real)
        runs = [here.runner.run(MotionTask(times, 1e-13, method=DOP853, start=y)) for y in (start, here.linear.state)]
        for t, state, beside in zip(times, runs[0].states, runs[1].states, strict=True):
            wanted = (amplitude * np.exp(value * t) * mode.shape).real
            found = continue_motion(here, t)[1].T @ moved(here, state, beside)
            # in the mass matrix's measure: spins of points, which have no inertia, go as they like
            off = np.abs(system.tangent.T @ system.mass @ (found - wanted)).max()
            assert off <= 1e2 * SMALL * amplitude * np.abs(xi).max()
