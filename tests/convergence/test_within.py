"""Other instants of a run already done: its own steps again, whatever lies between, and however few were kept."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from heuncli.integration import runner as motion
from tests.shared.scenes import near, study

SPECS = Path(__file__).parents[2] / "specs"
JUMPS = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {b: {mass: 1, center: [0, 0, 0], inertia: [0.1, 0.2, 0.25], points: {end: [1, 0, 0]}}}
joints: {A: {type: pin, from: ground.O, to: b.end, axis: [0, 0, 1]}}
forces: {push: {type: torque, joint: A, value: "2*step(t - 0.31) - step(t - 0.72)"}}
analysis: {duration: 1, samples: 51}
"""


def scene(name: str) -> str:
    text, *_ = (SPECS / f"{name}.yaml").read_text(encoding="utf-8").partition("\nexpect:")
    return text


SCENES = {"jumps": JUMPS, **{name: scene(name) for name in ("double", "four_bar", "flat_four_bar", "engine")}}
NAMES = [pytest.param(name, marks=pytest.mark.heavy) if name == "engine" else name for name in SCENES]


@pytest.mark.parametrize("kept", [20_000_000, 200])
@pytest.mark.parametrize("name", NAMES)
def test_the_asked_instants_again(name: str, kept: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same states to rounding: at all asked instants, at a few far apart, at one."""
    monkeypatch.setattr(motion, "KEPT", kept)
    monkeypatch.chdir(SPECS)
    s = study(SCENES[name])
    assert s.history.checked is not None
    run = s.history.checked.run
    assert len(run.kept) <= max(2, kept // s.setup.scene.layout.n_state)
    wanted = s.setup.runner.recovered(run.times, run.states).bodies
    for pick in (slice(None), slice(0, None, 37), slice(-1, None), slice(0, 1)):
        times = run.times[pick]
        again = s.setup.runner.recovered(times, s.setup.runner.resample(run, times)).bodies
        # through a flat pose rounding is magnified, by as much as the tolerance of the run allows
        tolerance = 1e-10 if name == "flat_four_bar" else 1e-12
        for name in ("R", "r"):
            near(again[name], wanted[name][pick], s.setup.scene.layout.size, tolerance)
        fastest = max(float(np.abs(wanted[name]).max()) for name in ("omega", "v"))
        for name in ("omega", "v"):
            near(again[name], wanted[name][pick], fastest, 10 * tolerance)


def test_a_singular_pose_between_does_no_harm() -> None:
    """The instants next to a flat pose, where a run begun there could not go on."""
    s = study(SCENES["flat_four_bar"])
    assert s.history.checked is not None
    ends = s.history.checked.run.ends
    flat = 1.2152618
    times = np.sort(np.concatenate([flat + np.array([-1e-3, -1e-6, -1e-9, 0.0, 1e-9, 1e-6]), ends[20:25]]))
    found = s.resample(times)
    tip = found.points["left.top"]["position"]
    near(np.sum(tip * tip, axis=1), np.ones(len(times)), 1.0, 1e-12)
    near(found.points["right.top"]["position"] - tip, np.tile([1.0, 0.0, 0.0], (len(times), 1)), 1.0, 1e-8)
