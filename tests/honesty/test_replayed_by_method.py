"""Every method of the kernel's: which instants are asked for, and what ran before, changes no bit of a run.

By steps of their own (Gauss), by dense output or by stages: at instants that nobody asked for a run is what it would
have been, had they been asked for. Trees and loops at random, events, contacts, ropes, stiff scenes.
"""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.base.method_rows import METHODS
from heuncli.motion.integration.integrated_scene import find_discontinuities
from heuncli.motion.integration.methods.method import Method, load_method_by_name
from heuncli.motion.integration.run.request import MotionTask
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from tests.bench.honesty import told
from tests.bench.stiff import STIFF_SCENES
from tests.honesty.chaotic import chaotic_scene
from tests.oracle.values import to_yaml
from tests.shared.event_scenes import EVENTS
from tests.shared.folders import SPECS

pytestmark = pytest.mark.heavy  # with the compiled kernel, which has the same bits

NAMES = [row.name for row in METHODS if row.kind != "SciPy"]
COUNT = 150  # given steps of a run
SOME = 20  # steps that are looked into
LONG = ("Verner98", "friction of 1e-6")  # three seconds; other explicit methods run the scene, too
STIFF = {name: STIFF_SCENES[name] for name in ("friction of 1e-6", "wire, damped")}
SCENES = {
    **EVENTS, **STIFF, "gas": (SPECS / "compressor.yaml").read_text(),
    **{f"chaotic {seed}": to_yaml(chaotic_scene(seed)[1]) for seed in (0, 2, 3)},
    **{f"random {seed}": to_yaml(told(seed).scene) for seed in (0, 1, 3, 6)},
}  # fmt: skip
ENDS_SOONER = ("half-turn", "stages-unsolved", "not-a-number", "closure-lost")  # of a coarse step, or of a chart


@cache
def runner_of(scene: str) -> tuple[Runner, float]:
    """What integrates a scene, and the end of its run."""
    setup = set_up(load("scene.yaml", SCENES[scene]))
    return setup.runner, min(float(setup.spec.analysis.times[-1]), 2.0)


def run_of(scene: str, method: Method, times: Array, *, keeping: bool = False) -> Trajectory:
    """A coarse run, whose steps are long; keeping: the polynomials of those that made one."""
    runner, end = runner_of(scene)
    jumps = find_discontinuities(runner.layout.mechanism, end)
    local = end / COUNT if method.has_fixed_step else 1e-5
    return runner.run(MotionTask(times, local, discontinuities=jumps, method=method, stores_polynomials=keeping))


def looked_at(run: Trajectory) -> Array:
    """Ends of steps, instants within them and beside their ends, and the end of the run."""
    ends, begins = run.ends, np.concatenate([[0.0], run.ends[:-1]])
    chosen = np.unique(np.linspace(0, len(ends) - 1, SOME).astype(int))
    inner = begins[chosen, None] + (ends - begins)[chosen, None] * np.array([0.13, 0.5, 0.98, 1.0])
    beside = np.nextafter(ends[chosen], [[-np.inf], [np.inf]])
    times = np.unique(np.concatenate([inner.ravel(), beside.ravel(), run.times]))
    return times[times <= run.times[-1]]


@pytest.mark.parametrize(("name", "scene"), [pair for pair in product(NAMES, SCENES) if pair != LONG])
@pytest.mark.sixth
def test_other_instants_are_the_runs_own(name: str, scene: str) -> None:
    runner, end = runner_of(scene)
    method = load_method_by_name(name)
    try:
        run = run_of(scene, method, np.array([0.0, end]))
    except SolveError as error:
        assert error.problems[0].code in ENDS_SOONER
        return
    times = looked_at(run)
    whole = times if run.pushing_rope is None else np.append(times[:-1], end)  # a rope ends it there again
    direct = run_of(scene, method, whole)
    assert direct.ends.tolist() == run.ends.tolist()
    assert np.array_equal(direct.times, times)
    shown, alone = runner.resample(run, times), runner.resample(run, times[::7])
    assert np.array_equal(shown, direct.states)
    assert np.array_equal(alone, direct.states[::7])
    keeps = run_of(scene, method, np.append(run.times[:-1], end) if run.pushing_rope else run.times, keeping=True)
    sampled = run_of(scene, method, whole[::2] if len(whole) % 2 else np.append(whole[:-1:2], end), keeping=True)
    for kept in (keeps, sampled):  # none of whose steps made a polynomial of its own, but for events; some of whose did
        assert kept.ends.tolist() == run.ends.tolist()
        assert np.array_equal(runner.resample(kept, times), direct.states)
        assert np.array_equal(runner.resample(kept, times), direct.states)  # by what was done again, too


def test_a_run_hangs_on_no_other() -> None:
    """What an actuator was seen to do, to rounding, is forgotten with the run: the first has the bits of the last."""
    setup = set_up(load("compressor.yaml", SCENES["gas"]))
    end = float(setup.spec.analysis.times[-1])
    runs = [setup.runner.run(MotionTask([0.0, end], end / 4000, method=load_method_by_name("Euler"))) for _ in range(2)]
    assert runs[0].ends.tolist() == runs[1].ends.tolist()
    assert np.array_equal(runs[0].states, runs[1].states)


def test_polynomials_of_very_long_runs_are_let_go(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beyond their room none are kept: steps are done again, with the same bits."""
    runner, end = runner_of("chaotic 0")
    asked = np.linspace(0.0, end, 301)
    kept = run_of("chaotic 0", load_method_by_name("DOP853"), asked, keeping=True)
    monkeypatch.setattr("heuncli.motion.integration.run.progress.MAX_POLYNOMIAL_NUMBERS", 10)
    left = run_of("chaotic 0", load_method_by_name("DOP853"), asked, keeping=True)
    assert kept.polynomials is not None and kept.polynomials.spans[:, 0].any()
    assert left.polynomials is None
    times = looked_at(kept)
    assert np.array_equal(runner.resample(left, times), runner.resample(kept, times))
