"""What is held twice hangs on no load: counted without any it is the same, and so are the self-stresses of a pose."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.records import replace
from heuncli.loads.kinetostatics.bodies import make_body_states
from heuncli.loads.redundancy.count import count_self_stresses, count_without_loads
from heuncli.loads.redundancy.self_stress import (
    find_margins,
    find_self_stress,
    find_stress_of_poses,
    make_stress_poses,
)
from heuncli.motion.integration.run.runner import make_runner
from heuncli.multibody.mechanism.build import build, make_forms
from heuncli.multibody.tree.layout import remove_loads
from heuncli.multibody.tree.prepare import prepare
from heuncli.scene.file_format.load import load
from tests.shared.bits import bits
from tests.shared.folders import SPECS

# closed chains with forces, spread ones, torques, dampers, actuators, drives, laws in coordinates, a contact
LOADED = (
    "axle_loads", "bouncing_ball", "bricard", "cardan", "compressor", "crane_load", "crankshaft", "engine", "governor",
    "overhang", "press", "table",
)  # fmt: skip


@pytest.mark.parametrize("name", LOADED)
def test_loads_have_no_say_in_what_is_held_twice(name: str) -> None:
    spec = load(SPECS / f"{name}.yaml")
    scene, runner = make_runner(prepare(build(spec, make_forms(spec))))
    drives = tuple(joint.drive.value for joint in scene.mechanism.joints if joint.drive is not None)
    bare = count_without_loads(remove_loads(scene.layout), drives, runner.start_holding)
    assert [*bits(bare)] == [*bits(count_self_stresses(runner))]


def test_self_stresses_are_taken_over_at_the_same_pose_alone() -> None:
    spec = load(SPECS / "bricard.yaml")
    scene, runner = make_runner(prepare(build(spec, make_forms(spec))))
    known = count_self_stresses(runner).start_stress
    assert known is not None
    here = runner.evaluate(np.zeros(1), scene.layout.y0[None, :])
    states = make_body_states(scene.layout, here)
    found = find_self_stress(runner, here, states, known)
    assert found is known.stress
    assert [*bits(found)] == [*bits(find_self_stress(runner, here, states))]
    moved = scene.layout.y0.copy()
    moved[0] += 1e-6
    there = runner.evaluate(np.zeros(1), moved[None, :])
    assert find_self_stress(runner, there, make_body_states(scene.layout, there), known) is not known.stress
    later = runner.evaluate(np.ones(1), scene.layout.y0[None, :])
    assert find_self_stress(runner, later, make_body_states(scene.layout, later), known) is not known.stress


@pytest.mark.parametrize("name", ["engine", "excavator"])
def test_where_all_rows_are_independent_nothing_is_decomposed(name: str) -> None:
    """The decomposition finds the same: no self-stress; its singular values are found when they are asked for."""
    spec = load(SPECS / f"{name}.yaml")
    scene, runner = make_runner(prepare(build(spec, make_forms(spec))))
    here = runner.evaluate(np.zeros(1), scene.layout.y0[None, :])
    states = make_body_states(scene.layout, here)
    found, full = (
        find_self_stress(runner, here, states),
        find_stress_of_poses(runner, make_stress_poses(runner.layout, here, states)),
    )
    assert found is not None and found.margins is None and full.margins is not None
    assert [*bits(replace(full, margins=None))] == [*bits(found)]
    assert [*bits(full.margins)] == [*bits(find_margins(runner, here, states))]
    assert full.margins.smallest_kept.min() > 0.0
