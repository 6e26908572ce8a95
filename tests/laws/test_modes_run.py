"""The modes of a scene are how it moves: started a little along a mode's shape, a run follows exp(l t) for a while."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from heuncli.errors import SolveError
from heuncli.integration.methods import DOP853
from heuncli.linearisation.displace import displaced
from heuncli.linearisation.oscillations import Mode, oscillations
from heuncli.linearisation.steady import Looked
from heuncli.results import Array
from heuncli.spec.load import load
from heuncli.study.modes import require_no_time, state_of
from heuncli.study.setup import set_up
from heuncli.tree.layout import places_of_rates

ROOT = Path(__file__).parents[2]
SMALL = 1e-5  # of turns, of the size, and of both a second: what is not linear is smaller by this once more
SPECS = sorted(path.name for path in (ROOT / "specs").glob("*.yaml"))


def started(here: Looked, x: Array, rate: Array) -> Array:
    """The state displaced along x, at its own rates changed by `rate`."""
    return displaced(here.layout, here.found.state, x, rate)


def moved(here: Looked, state: Array) -> Array:
    """How far the freedoms of a state are from those of the pose: small turns of balls, and differences."""
    layout, y0 = here.layout, here.found.state
    place = places_of_rates(layout)
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
def test_a_run_follows_its_modes(name: str) -> None:
    """Of all specs at rest: a quarter of a period, or until exp(l t) has grown or died by a third."""
    setup = set_up(load(ROOT / "specs" / name), reduce=False)
    try:
        require_no_time(setup)
        here, _ = state_of(setup)
    except SolveError:
        pytest.skip("neither at rest nor steady")
    if here.layout.driven or here.found.omega.any() or here.found.velocities.any():
        pytest.skip("is driven, or moves")
    for mode in oscillations(here.system):
        if mode.kind != "free":
            follow(here, mode)


def follow(here: Looked, mode: Mode) -> None:
    """A run from a little along a mode against its exponential."""
    value = mode.eigenvalue
    amplitude = SMALL / max(1.0, abs(value))
    x = mode.shape * (amplitude / np.abs(here.weights * mode.shape).max())
    start = started(here, x.real, (value * x).real)
    until = 0.3 / abs(value.real) if value.imag == 0.0 else 0.25 / mode.frequency
    times = np.array([0.0, 0.5, 1.0]) * until
    run = here.runner.trajectory(times, 1e-13, method=DOP853, start=start)
    for t, state in zip(run.times, run.states, strict=True):
        wanted = (np.exp(value * t) * x).real
        assert np.abs(here.weights * (moved(here, state) - wanted)).max() <= 1e2 * SMALL * amplitude
