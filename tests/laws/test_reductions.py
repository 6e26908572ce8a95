"""A smaller scene moves as the larger one does: merged bodies, bodies that cannot move, spins that nothing changes.

At states on the way the points of all bodies that are left accelerate alike in both; run to the end, all that is told
is the same, with the same components open.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
import pytest

from heuncli.motion.integration.evaluator import Evaluation
from heuncli.motion.integration.integrated_scene import integrate_reduced
from heuncli.motion.integration.run.request import MotionTask
from heuncli.motion.integration.run.runner import Runner, make_runner
from heuncli.multibody.reduction import immobile_bodies, spins, welded_bodies
from heuncli.multibody.reduction.compose import ReducedScene, Reduction
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from tests.oracle.read import start_state
from tests.oracle.scenes import ALL_KINDS, LOADS, Maker
from tests.oracle.solve import solve as solved_by_oracle
from tests.oracle.values import to_yaml
from tests.shared.scenes import moving, near, study

TIMES = (0.0, 0.05, 0.12)
SEEDS = range(24)


def scene_of(make: Callable[[np.random.Generator], Maker], seed: int) -> dict[str, Any]:
    """A random scene that has accelerations, with a blow on the way."""
    rng = np.random.default_rng(seed)
    while True:
        maker = make(rng)
        maker.set_moving()
        maker.loads(LOADS if maker.masses != "thin" else ("force", "spring", "actuator"), True)
        scene = maker.scene
        try:
            if solved_by_oracle(scene, start_state(scene)).residual < 1e-9:
                break
        except RuntimeError:
            continue
    return moving({**scene, "impulses": {"blow": blow(maker, rng)}}, TIMES, 1e-10)


def blow(maker: Maker, rng: np.random.Generator) -> dict[str, Any]:
    """An impulse amid the run, in the axes of the world or of the body."""
    on = maker.some()
    frame = "body" if rng.random() < 0.5 else "world"
    return {"on": maker.end("blow", on, maker.spot(on)), "vector": rng.standard_normal(3).tolist(), "time": 0.07,
            "frame": frame}  # fmt: skip


def welds(rng: np.random.Generator) -> Maker:
    """Trees, free bodies and loops of which many joints are welds, some of the loops of welds alone."""
    maker = Maker(rng, "shapes" if rng.random() < 0.3 else "given")
    kinds = ("weld", "weld", "weld", "weld", *ALL_KINDS)
    for k in range(int(rng.integers(2, 7))):
        maker.body(f"b{k}", kinds, 0.5, 1.0 if k == 0 else 0.15, 0.2)
    for k in range(int(rng.integers(0, 3))):
        maker.closure(f"loop{k}", ("weld", "weld", "ball", "rod", "line", "plane", "pin"))
    return maker


def structures(rng: np.random.Generator) -> Maker:
    """One to three bodies held on the ground by more joints than they have freedoms, and a tree or loop on them."""
    maker = Maker(rng, "given")
    kinds = ("ball", "pin", "line", "plane", "slide", "rod", "universal")
    for k in range(int(rng.integers(1, 4))):
        maker.body(f"b{k}", kinds, 0.3, 1.0 if k == 0 else 0.3, 0.1)
    for k in range(int(rng.integers(3, 8))):
        maker.closure(f"loop{k}", ("rod", "rod", "ball", "line", "plane"))
    for k in range(int(rng.integers(1, 3))):
        maker.body(f"m{k}", ("ball", "pin", "plane", "cylinder", "universal"), 0.3, 0.0, 0.0)
    return maker


class Wires(Maker):
    """Cylinders, some thin as a hair, with all their joints and forces on the axis."""

    radii = (0.1, 1e-3, 3e-6)

    def mass(self) -> dict[str, Any]:
        given = super().mass()["shapes"][0]
        radius = float(self.rng.choice(self.radii))
        return {"shapes": [{**given, "type": "cylinder", "radius": radius}]}

    def load_force(self, in_time: bool) -> dict[str, Any]:
        return {**super().load_force(in_time), "frame": "world"}


class Rods(Wires):
    """Cylinders that the whole scene bears."""

    radii = (0.1, 3e-2)


def wires(rng: np.random.Generator, kind: type[Wires] = Wires) -> Maker:
    """Chains and loops of them on balls and rods."""
    maker = kind(rng, "thin")
    for k in range(int(rng.integers(1, 5))):
        maker.body(f"b{k}", ("ball", "ball", "rod"), 0.3, 1.0 if k == 0 else 0.2, 0.1)
    for k in range(int(rng.integers(0, 3))):  # between points of two axes, as long as they are apart
        a, b = (str(x) for x in rng.permutation([*maker.names, "ground"])[:2])
        maker.join(f"loop{k}", "rod", {}, a, maker.spot(a), b, maker.spot(b))
    return maker


FAMILIES = {
    "merged": (welds, welded_bodies.step),
    "held": (structures, immobile_bodies.step),
    "spins": (wires, spins.step),
}
CASES = [pytest.param(name, seed, marks=pytest.mark.heavy) for name in FAMILIES for seed in SEEDS]


@pytest.mark.parametrize(("name", "seed"), CASES)
def test_points_accelerate_alike(name: str, seed: int) -> None:
    """All that is left: bodies by their names, points of theirs; and a state comes back from where it was embedded."""
    make, step = FAMILIES[name]
    scene, runner = make_runner(set_up(load("scene.yaml", to_yaml(scene_of(make, seed))), reduce=False).scene)
    found = step(scene)
    if not isinstance(found, Reduction):
        pytest.skip("nothing to leave out here")
    left, own = make_runner(found.scene)
    run = Runner(scene.layout, integrate_reduced(own, ReducedScene((found,), ()))).run(
        MotionTask(np.array(TIMES), 1e-8)
    )
    states = np.array([found.restrict(t, state) for t, state in zip(TIMES, run.states, strict=True)])
    large, small = runner.evaluate(run.times, run.states), own.evaluate(run.times, states)
    assert large.gap.max() <= 1e-9 * runner.layout.size
    near(found.embed(run.times, states), run.states, max(1.0, float(np.abs(run.states).max())), 1e-12)
    begin = found.embed(np.zeros(1), left.layout.y0[None, :])[0]
    near(begin, scene.layout.y0, max(1.0, float(np.abs(begin).max())), 1e-9)
    free = spins.find_constant_spins(scene) if name == "spins" else {}
    for i, body in enumerate(left.mechanism.bodies):
        j = next(n for n, b in enumerate(scene.mechanism.bodies) if b.name == body.name)
        center = scene.mechanism.bodies[j].center
        marks = [center, center + free[j].axis] if j in free else [center, *(center + np.eye(3))]
        for mark in marks:
            here, there = at(small, left.layout, i, mark), at(large, scene.layout, j, mark)
            for one, other in zip(here, there, strict=True):
                near(one, other, max(1.0, float(np.abs(here[2]).max())), 1e-7)


def at(found: Evaluation, layout: Layout, body: int, point: Array) -> tuple[Array, Array, Array]:
    """Place, velocity and acceleration (less that of gravity) of a body's point."""
    rows = found.bodies[:, layout.place[body]]
    arm = rows["R"] @ (point - layout.reference[layout.place[body]])
    swept = np.cross(rows["omega"], arm)
    a = rows["a"] + np.cross(rows["alpha"], arm) + np.cross(rows["omega"], swept)
    return rows["r"] + arm, rows["v"] + swept, a


@pytest.mark.parametrize(("name", "seed"), CASES[::3])
@pytest.mark.third
def test_all_that_is_told_is_the_same(name: str, seed: int) -> None:
    """Motion, reactions, foundation and blows of both runs, and which components are open."""
    make = partial(wires, kind=Rods) if name == "spins" else FAMILIES[name][0]
    scene = scene_of(make, seed)
    reduced, whole = study(scene), study(scene, reduce=False)
    if reduced.setup.reduction is None or not reduced.setup.reduction.steps:
        pytest.skip("nothing to leave out here")
    known = {"angular_acceleration"} if name == "spins" else set()  # a wire's own: rounding over its inertia
    for block in ("bodies", "joints", "foundation", "energy"):
        same(getattr(reduced.results, block), getattr(whole.results, block), known)
    for one, other in zip(reduced.results.impulses, whole.results.impulses, strict=True):
        same(one, other, known | {"bodies"})


def same(one: Any, other: Any, known: set[str]) -> None:
    """Two blocks alike, number by number; NaN, open, in the same places."""
    if isinstance(one, Mapping):
        assert one.keys() == other.keys()
        for key in one.keys() - known:
            same(one[key], other[key], known)
    elif isinstance(one, list):
        assert len(one) == len(other)
        for a, b in zip(one, other, strict=True):
            same(a, b, known)
    elif isinstance(one, np.ndarray | float):
        a, b = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
        assert np.array_equal(np.isnan(a), np.isnan(b))
        near(np.nan_to_num(a), np.nan_to_num(b), max(1.0, float(np.abs(np.nan_to_num(b)).max(initial=0.0))), 1e-6)
    else:
        assert one == other
