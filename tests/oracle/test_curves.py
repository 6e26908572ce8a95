"""Random scenes with a point on a path, or a roller beside one, against the independent solution."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from heuncli.multibody.mechanism.model import Joint
from tests.oracle.curves import seen
from tests.oracle.read import GROUND, Placed, placed
from tests.oracle.rows import assemble, velocities
from tests.oracle.scenes import Maker
from tests.oracle.turns import random_rotation
from tests.shared import checks
from tests.shared.coupled_scenes import coupled_scene
from tests.shared.scenes import near
from tests.shared.seeds import spared
from tests.shared.trees import ABOUT, Case, case

ALL = spared(range(6), frozenset({0, 1}))
HUNG = ("pin", "ball", "slide", "universal")


def path_scene(seed: int) -> dict[str, Any]:
    """A runner on a path of a body or the ground, of odd numbers a roller beside it; bodies on it, and loads."""
    rng = np.random.default_rng(seed)
    maker, roller = Maker(rng, "given"), bool(seed % 2)
    base = GROUND
    if seed % 3:
        maker.body("base", HUNG, 0.0, 1.0, 0.0)
        base = "base"
    Q, s = random_rotation(rng), np.linspace(-6.0, 6.0, 25)
    way = Q @ np.array([s, 0.4 * np.sin(s), 0.0 * s if roller else 0.3 * np.cos(0.7 * s)])
    maker.scene["tables"] = {
        f"w{a}": {"x": s.tolist(), "y": y.tolist(), "interpolation": "cubic"} for a, y in zip("xyz", way, strict=True)
    }
    spline, first, n = CubicSpline(s, way.T), float(rng.uniform(-1, 1)), float(rng.choice([-1.0, 1.0])) * Q[:, 2]
    slope, radius = spline(first, 1), 0.6 if roller else 0.0
    at = spline(first) + radius * np.cross(n, slope) / np.linalg.norm(slope)
    p, A, R = rng.uniform(-1, 1, 3), placed(maker.state, base), random_rotation(rng)
    maker.scene["bodies"]["runner"] = {**maker.mass(), "points": {}}
    maker.names.append("runner")
    q = maker.spot("runner")
    maker.place("runner", Placed(A.point(p + at) - R @ q, R, np.zeros(3), np.zeros(3)))
    beside = {"radius": radius, "normal": n.tolist()} if roller else {}
    maker.join("j_runner", "curve", {"x": "wx", "y": "wy", "z": "wz"} | beside, base, p, "runner", q)
    maker.body("hung", HUNG, 0.0, 0.0, 0.0)
    maker.set_moving()
    maker.loads(("force", "couple", "spring"), True)
    return maker.scene


@cache
def running(seed: int) -> Case:
    """A random scene's run, with the oracle's answer at every instant."""
    return case({**path_scene(seed), "foundation": {"about": ABOUT.tolist()}})


@pytest.mark.parametrize("seed", ALL)
def test_motion_and_loads_of_what_runs_along_a_path(seed: int) -> None:
    """Accelerations of all bodies and reactions of joints; travel, and where a roller touches."""
    c = running(seed)
    checks.same_accelerations(c)
    checks.same_reactions(c)
    (own,) = (j for j in c.read.joints if j.track is not None)
    for k, state in enumerate(c.states):
        A, B = placed(state, own.a.body), placed(state, own.b.body)
        x, _ = seen(A, own.a.point, B.point(own.b.point), B.speed(own.b.point))
        assert own.track is not None
        s = own.track.stand(x)
        near(c.found.coordinates["j_runner"]["travel"][k], s, c.length)
        r = own.track.spline(s)
        near(np.linalg.norm(x - r), 0.6 if seed % 2 else 0.0, c.length)
        if seed % 2:
            near(c.found.joints["j_runner"]["contact_point"][k], A.point(own.a.point + r), c.length)
        rows = assemble(c.read, state, 0.0)
        near(rows.J @ velocities(c.read, state), np.zeros(len(rows.J)), 10.0, 1e-10)
    accuracy = c.study.results.accuracy
    assert accuracy["energy_drift"] <= 1e-8
    assert accuracy["balance_residual"] <= 1e-10


@pytest.mark.parametrize("seed", spared(range(3), frozenset({0})))
def test_a_body_with_two_points_on_paths(seed: int) -> None:
    """One of the two closes a loop: everything is as the other solution has it."""
    scene = coupled_scene(seed, ("tracks",))
    scene["forces"] = {k: v for k, v in scene.get("forces", {}).items() if v["type"] not in ("motor", "bushing")}
    without = ("latches", "impulses", "sections")
    c = case({k: v for k, v in scene.items() if k not in without} | {"foundation": {"about": ABOUT.tolist()}})
    assert any(joint.path is not None for joint in cut_joints(c))
    checks.same_accelerations(c)
    checks.same_reactions(c)
    checks.same_foundation(c)
    for name, told in c.found.coordinates.items():
        (own,) = (j for j in c.read.joints if j.name == name)
        for k, state in enumerate(c.states if own.track is not None else ()):
            A, B = placed(state, own.a.body), placed(state, own.b.body)
            x, v = seen(A, own.a.point, B.point(own.b.point), B.speed(own.b.point))
            assert own.track is not None
            s, radius = own.track.stand(x), scene["joints"][name].get("radius", 0.0)
            near(told["travel"][k], s, c.length)
            if not radius:
                slope = own.track.spline(s, 1)
                near(told["speed"][k], float(v @ slope) / float(slope @ slope), 1.0, 1e-8)


def cut_joints(c: Case) -> list[Joint]:
    """The joints that close loops."""
    layout = c.study.setup.scene.layout
    return [layout.mechanism.joints[k] for k in layout.spanning.cut]
