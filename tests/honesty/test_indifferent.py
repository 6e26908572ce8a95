"""What nothing holds is told so, and what something holds is not, however softly: by rest poses and modes alike.

Scenes of parts whose motions are known (indifferent.py), as drawn, in other units, typed with three digits.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.analyses.modes.study import compute_spec_modes
from heuncli.scene.file_format.load import load
from tests.honesty.indifferent import PARTS, TYPED, Bench, law, spring_arm, turntable
from tests.oracle.values import to_yaml
from tests.shared.scenes import near, solved

SCENES = 8  # of each way of writing: thousands by raising it
WAYS: dict[str, dict[str, Any]] = {
    "plane": {},
    "space": {"space": True},
    "mm and t": {"metre": 1e-3, "kilogram": 1e3},
    "three digits": {"digits": 3},
}


def text_of(bench: Bench) -> str:
    scene = bench.scene()
    del scene["heun"]
    return to_yaml(scene)


def told(bench: Bench) -> tuple[bool, bool, int]:
    """Whether a rest pose is told to be held in something, indifferent in something, and how many modes are free."""
    text = text_of(bench)
    sentences = solved(text).model["rest"]
    assert not any("first order" in sentence for sentence in sentences), sentences
    free = sum(mode.kind == "free" for mode in compute_spec_modes(load("scene.yaml", text)).modes)
    begun = {sentence.split()[0].strip(":") for sentence in sentences}
    return bool(begun & {"stable", "unstable"}), "indifferent" in begun, free


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(SCENES))
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.third
def test_the_null_space_is_told(way: str, seed: int) -> None:
    bench = Bench(seed, **WAYS[way])
    pool = TYPED if way == "three digits" else PARTS
    for k in range(int(bench.rng.integers(1, 4))):
        part = pool[int(bench.rng.integers(len(pool)))]
        part(bench, np.array([4.0 * k, bench.drawn(-1.0, 1.0), bench.drawn(-1.0, 1.0)]))
    assert told(bench) == (bench.held > 0, bench.free > 0, bench.free)


@pytest.mark.heavy
@pytest.mark.parametrize("off", [1e-3, -1e-3, 1e-6, 1e-9, -1e-9, 1e-11])
def test_what_nearly_cancels_is_told_by_its_own_eigenvalue(off: float) -> None:
    """Beside what cancels, and what is 1e8 times as stiff: its rounding is that of its own terms."""
    bench = Bench(3)
    wanted = spring_arm(bench, np.zeros(3), off)
    turntable(bench, np.array([4.0, 0.0, 0.0]))
    body = bench.body(1.0, [0.0, 0.0, 0.0], np.array([8.0, 0.0, 0.0]))
    joint = bench.joint("pin", bench.on_ground(np.array([8.0, 0.0, 0.0])), f"{body}.a")
    bench.force(type="turn_spring", joint=joint, stiffness=1e8)
    text = text_of(bench)
    first, second = solved(text).model["rest"]
    assert first.startswith("stable" if off > 0.0 else "unstable") and second.startswith("indifferent: joints.j1,")
    values = [mode.eigenvalue for mode in compute_spec_modes(load("scene.yaml", text)).modes if mode.kind != "free"]
    near((-(min(values, key=abs) ** 2)).real, wanted, abs(wanted), max(1e-13 / abs(off), 1e-9))


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(4))
def test_what_nothing_pushes_stays_as_drawn(seed: int) -> None:
    """Also where rounding leaves a stiffness: a step along it would lead anywhere."""
    bench = Bench(seed, space=True)
    spring_arm(bench, np.zeros(3))
    law(bench, np.array([4.0, 0.0, 0.0]))
    for of in solved(text_of(bench)).coordinates.values():
        near(of["angle"], [0.0], 1.0, 1e-13)


def test_a_joint_that_is_held_by_itself_and_free_in_step() -> None:
    """Two pins in line and a spring on q + 2 r: one motion of the two is indifferent, told with its proportion."""
    bench = Bench(0)
    wheel = bench.body(1.0, [0.0, 0.0, 0.0], np.zeros(3))
    other = bench.body(1.0, [0.0, 0.0, 0.0], np.zeros(3))
    bench.joint("pin", bench.on_ground(np.zeros(3)), f"{wheel}.a")
    bench.joint("pin", f"{wheel}.a", f"{other}.a")
    for joint, k in (("j0", 3.0), ("j1", 6.0)):
        bench.force(type="torque", joint=joint, value=f"-{k}*(j0.angle + 2*j1.angle)")
    first, second = solved(text_of(bench)).model["rest"]
    assert first.startswith("stable except where indifferent: smallest eigenvalue") and "/inertia 15 1/s²" in first
    assert second.startswith("indifferent: joints.j0 and joints.j1 moved together as 1 : -0.5, without restoring force")
    assert "(joints.j1 alone is restored)" in second


@pytest.mark.parametrize(("thrust", "on_edge"), [(19.0, False), (20.0, True), (21.0, False)])
def test_a_follower_force_at_the_edge(thrust: float, on_edge: bool) -> None:
    """Two bars in line on a free carriage, pushed along the last one: at twice the stiffness of their springs by 1 m
    M^-1 K has a double eigenvalue 0 with one vector; below all swings, beyond a motion leaves the line."""
    bar = {
        "mass": 1.0,
        "center": [0.5, 0, 0],
        "inertia": [0.01, 0.08, 0.08],
        "points": {"a": [0, 0, 0], "e": [1, 0, 0]},
    }
    cart = {"mass": 1.0, "center": [0, 0, 0], "inertia": [1, 1, 1], "points": {"a": [0, 0, 0]}}
    scene = {
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {"c": cart, "p": bar, "q": {**bar, "position": [1, 0, 0]}},
        "joints": {
            "r": {"type": "slide", "axis": [0, 0, 1], "from": "ground.O", "to": "c.a"},
            "u": {"type": "pin", "axis": [0, 1, 0], "from": "c.a", "to": "p.a"},
            "v": {"type": "pin", "axis": [0, 1, 0], "from": "p.e", "to": "q.a"},
        },
        "forces": {
            "s": {"type": "turn_spring", "joint": "u", "stiffness": 10.0},
            "w": {"type": "turn_spring", "joint": "v", "stiffness": 10.0},
            "f": {"type": "force", "on": "q.e", "vector": [-thrust, 0, 0], "frame": "body"},
        },
        "analysis": {"type": "rest"},
    }
    sentences = solved(scene).model["rest"]
    assert sentences[0].startswith("unstable" if thrust > 20.0 else "stable except where indifferent")
    assert sentences[1].startswith("indifferent: joints.r,")
    assert any("at the limit of stability: joints.u and joints.v" in sentence for sentence in sentences) == on_edge
    free = [mode for mode in compute_spec_modes(load("scene.yaml", to_yaml(scene))).modes if mode.kind == "free"]
    assert len(free) == 1 + on_edge
