"""The compiled kernel and the plain one give the same bits: trees, closed chains, tables, drives."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

from heuncli.kernel.form import KERNEL
from tests.shared.event_scenes import EVENTS
from tests.shared.folders import SPECS
from tests.shared.planar_scenes import flat_scene

SCENES = {
    "double": ("analysis.duration=0.3", "analysis.samples=7"),
    "top": ("analysis.duration=0.05", "analysis.samples=4"),
    "four_bar": ("analysis.duration=0.1", "analysis.samples=4"),
    "engine": ("analysis.duration=0.002", "analysis.samples=4"),
    "cardan": ("analysis.duration=0.05", "analysis.samples=4"),
    "lift": ("analysis.duration=0.1", "analysis.samples=4"),
    "punch": ("analysis.duration=1", "analysis.samples=4"),
    "drawer": ("analysis.duration=0.1", "analysis.samples=4"),
    "cart": ("analysis.duration=0.1", "analysis.samples=4"),
}


def found(scene: str, settings: tuple[str, ...], kernel: str) -> dict[str, Any]:
    text, *_ = (SPECS / f"{scene}.yaml").read_text(encoding="utf-8").partition("\nexpect:")  # other instants than these
    return results_of(text, settings, kernel)


def results_of(text: str, settings: tuple[str, ...], kernel: str) -> dict[str, Any]:
    command = [sys.executable, "-m", "heuncli", "run", "-", "--format", "json"]
    command += [word for setting in settings for word in ("--set", setting)]
    environment = {**os.environ, "HEUN_KERNEL": kernel, "PYTHONPATH": str(SPECS.parent)}
    done = subprocess.run(command, input=text, capture_output=True, text=True, cwd=SPECS, env=environment, check=True)
    read: dict[str, Any] = json.loads(done.stdout)
    return read


@pytest.mark.skipif(KERNEL == "pure", reason="there is no compiled kernel to compare with")
@pytest.mark.parametrize("scene", SCENES)
def test_same_bits(scene: str) -> None:
    compiled, plain = (found(scene, SCENES[scene], kernel) for kernel in ("compiled", "pure"))
    assert (compiled["work"].pop("kernel"), plain["work"].pop("kernel")) == ("compiled", "pure")
    for results in (compiled, plain):
        del results["work"]["seconds"]
    assert compiled == plain


@pytest.mark.skipif(KERNEL == "pure", reason="there is no compiled kernel to compare with")
@pytest.mark.parametrize("scene", [*EVENTS, 0, 6])
def test_same_bits_with_events(scene: str | int) -> None:
    text = flat_scene(scene) if isinstance(scene, int) else EVENTS[scene]
    compiled, plain = (results_of(text, (), kernel) for kernel in ("compiled", "pure"))
    for results in (compiled, plain):
        del results["work"]["seconds"], results["work"]["kernel"]
    assert compiled == plain


@pytest.mark.skipif(KERNEL == "pure", reason="there is no compiled kernel to compare with")
@pytest.mark.parametrize("method", ["DOP853-rodrigues", "DOP853-recentred"])
def test_same_bits_in_charts_of_attitudes(method: str) -> None:
    """A body that flies, and is caught by a rope: balls, a closure, a blow."""
    text = EVENTS["catches"].replace("duration: 2", f"duration: 1, method: {method}")
    compiled, plain = (results_of(text, ("bodies.ball.angular_velocity=[1, 2, 0.5]",), k) for k in ("compiled", "pure"))
    for results in (compiled, plain):
        del results["work"]["seconds"], results["work"]["kernel"]
    assert compiled == plain
    assert compiled["model"]["method"] == method


MAPS = """
import json, sys
import numpy as np
from heuncli.response import carried, columns, jacobian, tangent
from heuncli.spec.load import load
from heuncli.study.model.setup import set_up
setup = set_up(load(sys.argv[1]))
layout, runner = setup.scene.layout, setup.runner
found = runner.recovered(np.zeros(2), np.array([layout.y0, layout.y0]))
at = runner.workspace, found.times, found.states
multipliers = np.sin(1.0 + np.arange(2 * 3 * len(layout.rows))).reshape(2, 3, -1)
loads = np.cos(np.arange(2 * 6 * len(layout.place))).reshape(2, -1, 6)
answers = columns(at[0], 0.0, found.states[0], loads, np.array([True, False]))
print(json.dumps({
    "jacobian": jacobian(at[0], layout, *at[1:]).entries.tolist(),
    "carried": carried(*at, multipliers, len(layout.place)).tolist(),
    "columns": [answers.bodies.tolist(), answers.multipliers.tolist()],
    "tangent": tangent(at[0], 0.0, found.states[0]).tolist(),
}, default=list))
"""


@pytest.mark.skipif(KERNEL == "pure", reason="there is no compiled kernel to compare with")
@pytest.mark.parametrize("scene", ["crane", "four_bar", "engine", "cardan", "bricard", "lift", "hammered_four_bar"])
def test_same_bits_of_the_one_linear_map(scene: str) -> None:
    told = {}
    for kernel in ("compiled", "pure"):
        command = [sys.executable, "-c", MAPS, str(SPECS / f"{scene}.yaml")]
        environment = {**os.environ, "HEUN_KERNEL": kernel, "PYTHONPATH": str(SPECS.parent)}
        done = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
        told[kernel] = json.loads(done.stdout)
    assert told["compiled"] == told["pure"]
    assert all(np.any(told["pure"][name]) for name in ("jacobian", "carried"))


WITHIN = """
import json, sys
import numpy as np
from heuncli.integration.methods.registry import method_of
from heuncli.integration.run.request import MotionTask
from heuncli.spec.load import load
from heuncli.study.model.setup import set_up
setup = set_up(load(sys.argv[1]))
method = setup.method if sys.argv[2] == "auto" else method_of(sys.argv[2])
run = setup.runner.trajectory(MotionTask(np.linspace(0.0, 0.8, 3), 1e-6, method=method))
times = np.unique(np.concatenate([np.linspace(0.0, 0.8, 17), run.ends, np.nextafter(run.ends[:-1], 1.0)]))
states = setup.runner.resample(run, times)
found = setup.runner.recovered(times, states)
print(json.dumps([run.ends.tolist(), run.settled.tolist(), states.tolist(), found.bodies.tolist(), found.rows.tolist()],
                 default=list))
"""


@pytest.mark.skipif(KERNEL == "pure", reason="there is no compiled kernel to compare with")
@pytest.mark.parametrize("scene", ["double", "flat_four_bar", "four_bar", "bricard"])
def test_same_bits_between_the_samples(scene: str) -> None:
    """The steps done again, through a flat pose, too."""
    told = {kernel: within(scene, "auto", kernel) for kernel in ("compiled", "pure")}
    assert told["compiled"] == told["pure"]
    assert any(told["pure"][1]) == (scene == "flat_four_bar")


@pytest.mark.skipif(KERNEL == "pure", reason="there is no compiled kernel to compare with")
@pytest.mark.parametrize(
    ("scene", "method"), [("double", "Radau9"), ("friction", "Radau5"), ("door_closer", "Radau5"), ("drawer", "Radau5")]
)
def test_same_bits_by_collocation(scene: str, method: str) -> None:
    """Dense equations, real and complex, Newton's iteration, and its steps done again."""
    assert within(scene, method, "compiled") == within(scene, method, "pure")


def within(scene: str, method: str, kernel: str) -> Any:
    command = [sys.executable, "-c", WITHIN, str(SPECS / f"{scene}.yaml"), method]
    environment = {**os.environ, "HEUN_KERNEL": kernel, "PYTHONPATH": str(SPECS.parent)}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
    return json.loads(done.stdout)
