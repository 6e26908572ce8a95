"""No silent wrong number between clearly dependent and clearly not: 300 random scenes that are nearly held twice.

Whatever the condition, a run is refused, or says what hangs on it (a warning, an open component), or its numbers are
right within the error it states.
"""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.errors import HeunError
from heuncli.results.results import Results
from tests.honesty.faults import faults
from tests.honesty.near_redundant import hinged_scene, near_scene
from tests.shared.exact import solution
from tests.shared.scenes import study
from tests.shared.seeds import spared

pytestmark = pytest.mark.heavy  # a family at random: with the compiled kernel, which has the same bits

SCENES, HINGES = 240, 60
IDEAL = 3e-9  # below, hinges may count as in line: RANK, and what a length in the scene may be beside its size


@pytest.mark.parametrize("seed", spared(range(SCENES), range(80)))
@pytest.mark.third
def test_right_or_marked(seed: int) -> None:
    family, near, (scene, rates) = near_scene(seed)
    try:
        run = study(scene)
    except HeunError as error:
        assert error.problems[0].code
        return
    if not marked(run.results):
        wrong = faults(run, scene, solution(scene, rates))
        assert not wrong, f"{family} {near:.1e}: {wrong[0]}"


def marked(found: Results) -> bool:
    """Whether a warning, or an open component, says that something hangs on how near the scene is."""
    return bool(found.warnings) or any(block["open"] for block in found.joints.values())


@pytest.mark.parametrize("seed", spared(range(HINGES), range(20)))
def test_hinges_out_of_line(seed: int) -> None:
    """As written nothing moves; so near to one axis that nobody could tell, the ideal drawing's answer is as good.

    What is not told: a given rate that was deleted, a reaction that is neither drawing's.
    """
    family, near, hinged = hinged_scene(seed)
    try:
        run = study(hinged.scene)
    except HeunError as error:
        assert error.problems[0].code
        return
    found = run.results
    if found.warnings:
        return
    for name, rate in hinged.rates.items():
        told = found.bodies[name]["angular_velocity"][:, 2]
        assert np.abs(told - rate).max() <= 10 * near, f"{family} {near:.1e}: {rate} rad/s became {told}"
    frozen = not found.model["freedoms"]
    assert frozen or near <= IDEAL, f"{family} {near:.1e}: moves as if in line"
    scene = hinged.scene if frozen else hinged.ideal
    wrong = faults(run, scene, solution(scene, {} if frozen else hinged.rates), 0.0 if frozen else 10 * near)
    assert not wrong, f"{family} {near:.1e}: {wrong[0]}"
