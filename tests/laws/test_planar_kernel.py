"""Flat scenes through the kernel's planar path and through the spatial one: the same numbers, to rounding.

The same layout runs both ways: what differs is `flat` alone. Loads across the plane are the spatial path's own.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from heuncli.base.records import replace
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.integration.run.request import MotionTask
from heuncli.motion.integration.run.runner import Runner
from heuncli.multibody.response import (
    Columns,
    Jacobian,
    jacobian,
    multiplier_joint_loads,
    solve_columns,
    solve_impulses,
)
from heuncli.multibody.tree.prepare import prepare
from heuncli.multibody.tree.tables import Table, moves_in_plane
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import build_with_cuts, set_up
from tests.shared.planar_scenes import flat_scene
from tests.shared.scenes import near

# rods, ropes, lines, welds, slides, free bodies, drives of all kinds, stops; 14: a light end of a lever, pivot 4e-5
SEEDS = (0, 6, 14)
MORE = [2, 5, *range(7, 10), *range(11, 14), *range(17, 31)]
ROUNDING = 1e-12  # of the largest of a field; of what the closures amplify, by the root of the pivot
LANDING = 1e-4  # of the run: shorter steps only meet an event


class Both:
    """A scene on both paths, with states of its motion on its closures."""

    def __init__(self, seed: int) -> None:
        spec = load("scene.yaml", flat_scene(seed))
        layout = set_up(spec).scene.layout
        assert layout.flat
        self.plane, self.space = Runner(layout), Runner(replace(layout, flat=False))
        self.times = np.array(spec.analysis.times)
        self.run = self.plane.run(MotionTask(self.times, 1e-6))
        self.found = self.plane.evaluate(self.times, self.run.states)
        self.states = self.found.states
        self.allowed = ROUNDING / float(np.sqrt(self.found.pivot.min()))
        self.rng = np.random.default_rng(seed)

    @property
    def bodies(self) -> int:
        return len(self.plane.layout.place)


@cache
def both(seed: int) -> Both:
    return Both(seed)


def in_the_plane(name: str, values: Array) -> Array:
    """A field without what loads joints across the plane."""
    if name == "joint_moment":
        return values[..., 2]
    return values[..., :2] if name == "joint_force" else values


def same(plane: Table, space: Table, allowed: float) -> None:
    """Tables field by field, each against its largest."""
    for name in plane.dtype.names or ():
        wanted = in_the_plane(name, space[name])
        near(in_the_plane(name, plane[name]), wanted, max(1.0, float(np.abs(wanted).max(initial=0.0))), allowed)


def same_columns(plane: Columns, space: Columns, allowed: float) -> None:
    same(plane.bodies, space.bodies, allowed)
    same(plane.freedoms, space.freedoms, allowed)
    near(plane.multipliers, space.multipliers, max(1.0, float(np.abs(space.multipliers).max(initial=0.0))), allowed)


heavy = pytest.mark.parametrize("seed", [*SEEDS, *(pytest.param(seed, marks=pytest.mark.heavy) for seed in MORE)])
some = pytest.mark.parametrize("seed", SEEDS)


@heavy
@pytest.mark.third
def test_states(seed: int) -> None:
    """Motion, loads, reactions in the plane, multipliers, drives, gaps; with a column a cause."""
    scene = both(seed)
    plane, space = (r.evaluate(scene.times, scene.states, causes=True) for r in (scene.plane, scene.space))
    for name in ("bodies", "freedoms", "loads", "rows"):
        same(getattr(plane, name), getattr(space, name), scene.allowed)
    assert plane.causes is not None and space.causes is not None
    same_columns(plane.causes, space.causes, scene.allowed)
    np.testing.assert_allclose(plane.pivot, space.pivot, rtol=1e-9)
    np.testing.assert_array_equal(plane.massless_count, space.massless_count)
    nothing_across(plane)


def nothing_across(found: Evaluation) -> None:
    """What there is none of is zero, not rounding."""
    for name in ("omega", "alpha", "joint_moment"):
        assert not found.bodies[name][..., :2].any()
    for name in ("v", "a", "joint_force"):
        assert not found.bodies[name][..., 2].any()


@heavy
def test_runs(seed: int) -> None:
    """The same motion, the same stops and blows, as many steps but for a hair.

    Those that land on a strike do not count: whether a strike is met by one or three of them rounding decides.
    """
    scene = both(seed)
    space = scene.space.run(MotionTask(scene.times, 1e-6))
    near(scene.run.states, space.states, max(1.0, float(np.abs(space.states).max())), 1e-7)
    plane_steps, space_steps = (
        np.count_nonzero(np.diff(run.ends, prepend=0.0) > LANDING * scene.times[-1]) for run in (scene.run, space)
    )
    assert abs(plane_steps - space_steps) <= 0.1 * space_steps


@some
def test_columns_and_blows(seed: int) -> None:
    """Single loads, and what all loads across the plane do: nothing."""
    scene = both(seed)
    loads = scene.rng.uniform(-1.0, 1.0, (3, scene.bodies, 6))
    loads[2, :, [2, 3, 4]] = 0.0
    t, y = float(scene.times[-1]), scene.states[-1]
    flags = np.array([False, True, False])
    plane, space = (solve_columns(r.workspace, t, y, loads, flags) for r in (scene.plane, scene.space))
    same_columns(plane, space, scene.allowed)
    near(plane.bodies["alpha"][2], 0.0, 1.0, scene.allowed)
    near(plane.bodies["a"][2], 0.0, 1.0, scene.allowed)
    layout = scene.plane.layout
    driven = np.append(layout.tables["freedoms"]["driven"] > 0, layout.tables["closures"]["program"]["count"] > 0)
    jumps = scene.rng.uniform(-1.0, 1.0, (3, len(driven))) * driven
    jumped, wanted = (solve_impulses(r.workspace, t, y, loads, jumps) for r in (scene.plane, scene.space))
    same_columns(jumped.columns, wanted.columns, scene.allowed)
    assert jumped.unmet.max() <= scene.allowed


@some
def test_jacobians_and_self_stress(seed: int) -> None:
    """The rows on the freedoms; the joint loads in the plane that multipliers leave in the tree."""
    scene = both(seed)
    layout = scene.plane.layout
    at = scene.times, scene.states
    paths = scene.plane.workspace, scene.space.workspace
    pair: list[Jacobian] = [jacobian(workspace, layout, *at) for workspace in paths]
    near(pair[0].entries, pair[1].entries, max(1.0, float(np.abs(pair[1].entries).max(initial=0.0))), ROUNDING)
    given = scene.rng.uniform(-1.0, 1.0, (len(scene.times), 2, len(layout.rows)))
    held, wanted = (multiplier_joint_loads(workspace, *at, given, scene.bodies) for workspace in paths)
    near(held[..., 2:5], wanted[..., 2:5], max(1.0, float(np.abs(wanted).max(initial=0.0))), ROUNDING)


def test_a_scene_is_flat_only_if_it_is_declared() -> None:
    """A spatial scene that moves in the plane has loads across it, which that path does not find."""
    text = flat_scene(6)
    planar = set_up(load("scene.yaml", text)).scene.layout
    pendulum = "bodies: {bar: {mass: 1, center: [1, 0, 0], inertia: [1, 1, 1]}}\njoints: {pin: {type: pin, %s}}"
    ends = "from: {body: ground, at: [0, 0, 0]}, to: {body: bar, at: [0, 0, 0]}, axis: [0, 0, 1]"
    spatial = set_up(load("scene.yaml", "heun: 1\n" + pendulum % ends)).scene.layout
    assert moves_in_plane(spatial.tables["bodies"], spatial.tables["freedoms"])
    assert not spatial.flat
    tilted = planar.tables["bodies"].copy()
    assert moves_in_plane(tilted, planar.tables["freedoms"])
    tilted["frame"]["xz"][0] = 1e-300
    assert not moves_in_plane(tilted, planar.tables["freedoms"])
    shifted = planar.tables["freedoms"].copy()
    shifted["direction"]["z"][0] *= 0.5
    assert not moves_in_plane(planar.tables["bodies"], shifted)


WEIGHTLESS = """
heun: 1
space: planar
bodies:
  arm: {{mass: 1, center: [0, 0, 0], inertia: {inertia}}}
  block: {{mass: 2, center: [0, 0, 0], inertia: 0, position: [{x}, {y}, 0]}}
joints:
  pin: {{type: pin, from: {{body: ground, at: [0, 0, 0]}}, to: {{body: arm, at: [0, 0, 0]}}}}
  guide:
    {{type: slide, from: {{body: arm, at: [{x}, {y}, 0]}}, to: {{body: block, at: [0, 0, 0]}}, axis: [-{y}, {x}, 0]}}
"""


@pytest.mark.parametrize(("inertia", "idle"), [(0.0, 1), (1e-9, 0)])
def test_what_rounding_leaves_of_an_inertia_is_none(inertia: float, idle: int) -> None:
    """A block that slides across its arm takes its whole mass out of the arm's turn: no inertia, or the arm's own."""
    for angle in np.linspace(0.1, 1.4, 12).tolist():
        x, y = 3.0 * np.cos(angle), 3.0 * np.sin(angle)
        mechanism, _ = build_with_cuts(load("scene.yaml", WEIGHTLESS.format(inertia=inertia, x=x, y=y)))
        layout = prepare(mechanism).layout  # before any inertia is lent
        assert layout.flat
        for runner in (Runner(layout), Runner(replace(layout, flat=False))):
            assert runner.evaluate(np.zeros(1), layout.y0[None]).massless_count[0] == idle
