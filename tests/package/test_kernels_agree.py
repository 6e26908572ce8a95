"""The compiled kernel and the plain one give the same bits: trees, closed chains, tables, drives, machine elements."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from heuncli.kernel.form import KERNEL
from tests.oracle.values import to_yaml
from tests.shared.coupled_scenes import ELEMENTS, coupled_scene
from tests.shared.event_scenes import EVENTS
from tests.shared.folders import SPECS
from tests.shared.kernel_answers import Asked, here, plain_kernel
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
needs_both = pytest.mark.skipif(KERNEL == "pure", reason="there is no compiled kernel to compare with")


@pytest.fixture(scope="module")
def plain() -> Iterator[Asked]:
    with plain_kernel() as asked:
        yield asked


@needs_both
@pytest.mark.parametrize("scene", SCENES)
def test_same_bits(scene: str, plain: Asked) -> None:
    text, *_ = (SPECS / f"{scene}.yaml").read_text(encoding="utf-8").partition("\nexpect:")  # other instants than these
    compiled, told = (kernel("results", text, SCENES[scene]) for kernel in (here, plain))
    assert (compiled["work"].pop("kernel"), told["work"].pop("kernel")) == ("compiled", "pure")
    assert compiled == told


@needs_both
@pytest.mark.parametrize("scene", [*EVENTS, 0, 6])
def test_same_bits_with_events(scene: str | int, plain: Asked) -> None:
    text = flat_scene(scene) if isinstance(scene, int) else EVENTS[scene]
    compiled, told = (kernel("results", text, []) for kernel in (here, plain))
    assert (compiled["work"].pop("kernel"), told["work"].pop("kernel")) == ("compiled", "pure")
    assert compiled == told


@needs_both
@pytest.mark.parametrize("method", ["DOP853-rodrigues", "DOP853-recentred"])
def test_same_bits_in_charts_of_attitudes(method: str, plain: Asked) -> None:
    """A body that flies, and is caught by a rope: balls, a closure, a blow."""
    text = EVENTS["catches"].replace("duration: 2", f"duration: 1, method: {method}")
    settings = ["bodies.ball.angular_velocity=[1, 2, 0.5]"]
    compiled, told = (kernel("results", text, settings) for kernel in (here, plain))
    assert (compiled["work"].pop("kernel"), told["work"].pop("kernel")) == ("compiled", "pure")
    assert compiled == told
    assert compiled["model"]["method"] == method


@needs_both
@pytest.mark.parametrize("scene", ["crane", "four_bar", "engine", "cardan", "bricard", "lift", "hammered_four_bar"])
def test_same_bits_of_the_one_linear_map(scene: str, plain: Asked) -> None:
    compiled, told = (kernel("linear_map", scene) for kernel in (here, plain))
    assert compiled == told
    assert all(np.any(told[name]) for name in ("jacobian", "carried"))


@needs_both
@pytest.mark.parametrize("part", range(3))
def test_same_bits_of_machine_elements(part: int, plain: Asked) -> None:
    """A third of their kinds in a random scene: steps, a blow where it has one, and the parts of the linear map."""
    scene = coupled_scene(3, tuple(ELEMENTS)[part::3])
    for blow in scene.get("impulses", {}).values():
        blow["time"] = 0.0005
    text = to_yaml({**scene, "analysis": {"times": [0, 0.001], "tolerance": 1e-3}})
    compiled, told = (kernel("results", text, []) for kernel in (here, plain))
    assert (compiled["work"].pop("kernel"), told["work"].pop("kernel")) == ("compiled", "pure")
    assert compiled == told
    assert here("linear_map", "elements", text) == plain("linear_map", "elements", text)


@needs_both
@pytest.mark.parametrize("scene", ["double", "flat_four_bar", "four_bar", "bricard"])
def test_same_bits_between_the_samples(scene: str, plain: Asked) -> None:
    """The steps done again, through a flat pose, too."""
    compiled, told = (kernel("within_steps", scene, "auto") for kernel in (here, plain))
    assert compiled == told
    assert any(told[1]) == (scene == "flat_four_bar")


@needs_both
@pytest.mark.parametrize(
    ("scene", "method"),
    [
        ("double", "Radau9"),
        ("friction", "Radau5"),
        pytest.param("door_closer", "Radau5", marks=pytest.mark.long),
        pytest.param("drawer", "Radau5", marks=pytest.mark.long),
    ],
)
def test_same_bits_by_collocation(scene: str, method: str, plain: Asked) -> None:
    """Dense equations, real and complex, Newton's iteration, and its steps done again."""
    assert here("within_steps", scene, method) == plain("within_steps", scene, method)
