"""Twists by the freedoms of the tree: what the kernel's own velocities, closure rows and dual numbers say."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.analyses.motion_diagnostics.motion_events import MotionSearch
from heuncli.analyses.motion_diagnostics.twists import closure_rows, compute_twists, mass_matrix
from heuncli.loads.equilibrium.coordinates import make_coordinates
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.linearisation.linearise import linearise
from heuncli.multibody.response import jacobian
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import Setup, set_up
from tests.oracle.values import to_yaml
from tests.shared.coupled_scenes import coupled_scene
from tests.shared.folders import SPECS
from tests.shared.scenes import study

SCENES = ("bricard", "cardan", "crane", "double", "excavator", "lift", "slider_crank_pins", "spatial_crank", "swing")
COUPLED = ("belt_drive", "hoist_stop", "planetary", "screw_press", "tower_crane", "valve_train")
ROUNDED = 1e-13  # hundreds of roundings of sums whose terms are of the order of 1


def moving(name: str) -> tuple[Setup, Evaluation]:
    """A scene with rates at random, and the kernel's answers."""
    found = set_up(load(str(SPECS / f"{name}.yaml")), reduce=False)
    layout = found.scene.layout
    state = layout.y0.copy()
    rates = make_coordinates(layout).rates
    state[rates] += np.random.default_rng(1901).uniform(-1.0, 1.0, len(rates))
    return found, found.runner.evaluate(np.zeros(1), state[None])


@pytest.mark.parametrize("name", SCENES)
def test_velocities_are_twists_times_rates(name: str) -> None:
    found, at = moving(name)
    layout, bodies = found.scene.layout, at.bodies[0]
    own = compute_twists(layout, at)
    rates = np.zeros(layout.velocity_count)
    for k in np.flatnonzero(layout.bodies["ball"]):
        first = int(layout.bodies["velocity_at"][k])
        rates[first : first + 3] = bodies["omega"][k]
    rates[layout.tables["freedoms"]["velocity_at"]] = at.freedoms["u"][0]
    omega = np.einsum("bni,n->bi", own.turn[0], rates)
    v = np.einsum("bni,n->bi", own.shift[0], rates)
    size = max(1.0, float(np.abs(bodies["v"]).max()), float(np.abs(bodies["omega"]).max()))
    assert np.abs(omega - bodies["omega"]).max() <= ROUNDED * size
    arm = own.centre[0] - bodies["r"]
    assert np.abs(v - bodies["v"] - np.cross(bodies["omega"], arm)).max() <= ROUNDED * size


@pytest.mark.parametrize("name", (*SCENES, *COUPLED))
def test_closure_rows_are_the_kernels(name: str) -> None:
    """The kernel gives what is driven no entry."""
    found, at = moving(name)
    layout = found.scene.layout
    if not layout.rows:
        return
    J = closure_rows(compute_twists(layout, at), at)
    freedoms = layout.tables["freedoms"]
    J[:, :, freedoms["velocity_at"][freedoms["driven"] == 1]] = 0.0
    kernel = jacobian(found.runner.workspace, layout, at.times, at.states)
    whole = kernel.block(np.arange(len(layout.rows)), np.arange(layout.velocity_count))
    assert np.abs(J - whole).max() <= ROUNDED * max(1.0, float(np.abs(whole).max()))


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.third
def test_closure_rows_annul_the_velocities(seed: int) -> None:
    """Of gears, belts, screws, ropes, cams and joints along a motion, without open stops and driven lengths."""
    found = study(to_yaml({**coupled_scene(seed), "analysis": {"times": [0, 0.02, 0.05]}}), reduce=False)
    motion = MotionSearch(found)
    at, layout = motion.recover(motion.times[:: max(1, len(motion.times) // 6)]), motion.layout
    rates = np.zeros((len(at.times), layout.velocity_count))
    for k in np.flatnonzero(layout.bodies["ball"]):
        first = int(layout.bodies["velocity_at"][k])
        rates[:, first : first + 3] = at.bodies["omega"][:, k]
    rates[:, layout.tables["freedoms"]["velocity_at"]] = at.freedoms["u"]
    J = closure_rows(compute_twists(layout, at), at)
    counts = (at.rows["closed"] > 0.0) & (layout.tables["closures"]["program"]["count"] == 0)
    off = np.abs(np.einsum("tri,ti->tr", J, rates))[counts]
    size = np.einsum("tri,ti->tr", np.abs(J), np.abs(rates))[counts]
    assert len(size) and (np.abs(J).max(axis=2)[counts] > 0.0).all()
    assert (off <= 1e-9 * np.maximum(size, 1.0)).all()


@pytest.mark.parametrize("name", ["crane", "double", "spatial_crank", "swing"])
def test_the_mass_matrix_is_that_of_dual_numbers(name: str) -> None:
    found, at = moving(name)
    layout = found.scene.layout
    own = make_coordinates(layout).result_indices
    M = mass_matrix(compute_twists(layout, at))[0][np.ix_(own, own)]
    wanted = linearise(layout, 0.0, at.states[0]).mass
    assert np.abs(M - wanted).max() <= ROUNDED * float(np.abs(wanted).max())
