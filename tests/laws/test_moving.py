"""A scene moves as what is integrated in its place, whatever stands between their states.

Here the smaller scene is the scene itself from a start on which all pins are counted one turn further: its angles are
not the scene's, but all else is.
"""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.records import replace
from heuncli.motion.integration.integrated_scene import IntegratedScene
from heuncli.motion.integration.run.request import MotionTask
from heuncli.motion.integration.run.runner import Runner
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up

TURN = 2.0 * np.pi
SPECS = ("four_bar", "struck_door", "bouncing_ball", "friction", "lift", "punch")


def turned(layout: Layout, by: float) -> Array:
    """What is added to a state so that all its pins' angles are so much larger."""
    shift = np.zeros(layout.n_state)
    for freedom in layout.freedoms:
        if freedom.quantity == "angle" and freedom.q >= 0:
            shift[freedom.q] = by
    return shift


def elsewhere(runner: Runner) -> Runner:
    """A runner that integrates the scene a turn further."""
    layout = runner.layout
    shift = turned(layout, TURN)
    own = Runner(replace(layout, y0=layout.y0 + shift))
    return Runner(layout, IntegratedScene(own.layout, own.workspace, lambda t, y: y - shift, lambda t, y: y + shift))


@pytest.mark.parametrize("name", SPECS)
def test_states_blows_and_replays(name: str) -> None:
    setup = set_up(load(f"specs/{name}.yaml"), reduce=False)
    times = np.linspace(0.0, min(1.0, setup.spec.analysis.times[-1]), 11)
    between = 0.5 * (times[1:] + times[:-1])
    runs, replays = [], []
    for runner in (setup.runner, elsewhere(setup.runner)):
        runs.append(runner.run(MotionTask(times, 1e-12)))
        replays.append(runner.resample(runs[-1], between))
    here, there = runs
    assert len(here.impulse_events) == len(there.impulse_events)
    scale = max(1.0, float(np.abs(here.states).max()))
    assert there.states == pytest.approx(here.states, abs=1e-9 * scale)
    assert replays[1] == pytest.approx(replays[0], abs=1e-9 * scale)
    for one, other in zip(here.impulse_events, there.impulse_events, strict=True):
        assert other.time == pytest.approx(one.time, abs=1e-9)
        assert other.after_state == pytest.approx(one.after_state, abs=1e-8 * scale)
