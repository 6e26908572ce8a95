"""Scenes with machine elements of which less than the whole moves: the numbers of the whole, and a reason where not."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.multibody.reduction.compose import ReducedScene
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from tests.oracle.values import to_yaml
from tests.shared.coupled_in_a_plane import ELEMENTS, coupled_flat
from tests.shared.coupled_scenes import ELEMENTS as IN_SPACE
from tests.shared.coupled_scenes import coupled_scene
from tests.shared.reduced import pair, same
from tests.shared.scenes import moving
from tests.shared.split_bodies import split

TIMES = (0.0, 0.1, 0.2)
WAYS = ("drawn", "welded", "declared")


@pytest.mark.heavy  # families at random: with the compiled kernel, which has the same bits
@pytest.mark.parametrize("kind", ELEMENTS)
@pytest.mark.third
def test_in_a_plane(kind: str) -> None:
    """Every kind, on what cannot leave the plane and on what could, between bodies that are one, declared planar."""
    at = list(ELEMENTS).index(kind)
    for seed, how in enumerate(WAYS, start=3 * at):
        both = pair(load(f"{kind} {seed}", to_yaml(moving(coupled_flat(seed, (kind,), how), TIMES, 1e-10))))
        same(both)
        assert any(sentence.startswith("solved in the plane") for sentence in both.told)
        reduced = both.small.setup.reduction
        assert how != "welded" or (reduced is not None and len(reduced.explanations + reduced.exceptions) > 1)


@pytest.mark.heavy
@pytest.mark.parametrize("kind", IN_SPACE)
@pytest.mark.third
def test_between_bodies_that_are_one(kind: str) -> None:
    """In space, every kind: what a coupling looks at is a part of what moves."""
    seed = 40 + list(IN_SPACE).index(kind)
    scene = split(coupled_scene(seed, (kind,)), np.random.default_rng(seed))
    for coupling in scene.get("couplings", {}).values():
        coupling.pop("friction", None)  # a thread that rubs is moved as it is given
    both = pair(load(f"{kind} {seed}", to_yaml(scene)))
    same(both)
    assert any("one body" in sentence for sentence in both.told)


SCENE = """\
heun: 1
gravity: [0, -9.81, 0]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  frame:
    mass: 3
    center: [0, 0, 0]
    inertia: [0.2, 0.3, 0.4]
    points: {{o: [-0.4, 0.1, 0], a: [0, 0, 0], b: [0.3, 0, 0], s: [0.1, 0.2, 0.1], p: [0, -1, {p}]}}
  one: {{mass: 1, center: [0, 0, 0], inertia: [0.01, 0.01, 0.02], points: {{c: [0, 0, 0]}}}}
  two: {{mass: 1, center: [0, 0, 0], inertia: [0.01, 0.01, 0.02], points: {{c: [0, 0, 0]}}}}
joints:
  hang: {{type: {hang}, from: ground.O, to: frame.o{about}}}
  first: {{type: pin, from: frame.a, to: one.c, axis: [0, 0, 1]}}
  second: {{type: {second}, from: frame.b, to: two.c, axis: {axis}}}
{tail}
analysis: {{duration: 0.2, samples: 3}}
"""
GEAR = "couplings: {{m: {{type: gear, of: [first, second], teeth: [20, 40]{more}}}}}"
RATIO = "couplings: {m: {type: ratio, of: [first, second], factors: [1, 2]}}"
ROPE = "couplings: {m: {type: rope, through: [ground.O, frame.p, two.c]}}"


def scene(tail: str, hang: str = "ball", second: str = "pin", axis: str = "[0, 0, 1]", p: float = 0.0) -> ReducedScene:
    """What is left out of a frame with two wheels, nothing integrated."""
    about = "" if hang == "ball" else ", axis: [0, 0, 1]"
    text = SCENE.format(tail=tail, hang=hang, second=second, axis=axis, about=about, p=p)
    found = set_up(load("scene.yaml", text)).reduction
    assert found is not None
    return found


def gear(more: str = "") -> str:
    return GEAR.format(more=more)


NOT_FLAT = {  # of a frame on a ball, and what is told
    "teeth that push along the axes": (scene, (gear(", helix: 0.01"),), "couplings.m points out of the plane"),
    "a rope's point beside it": (scene, (ROPE, "ball", "pin", "[0, 0, 1]", 1e-9), "a point of couplings.m is 1e-09"),
    "a turn that the plane has not": (
        scene, (RATIO, "pin", "pin", "[1, 0, 0]"), "couplings.m uses second.angle, an out-of-plane coordinate"
    ),
    "a shift that the plane has not": (
        scene, ("couplings: {m: {type: screw, of: [second], lead: 0.1}}", "pin", "cylinder"),
        "couplings.m uses second.travel, an out-of-plane coordinate",
    ),
}  # fmt: skip


def in_plane(found: ReducedScene) -> bool:
    return any(sentence.startswith("solved in the plane") for sentence in found.explanations)


@pytest.mark.parametrize("name", NOT_FLAT)
def test_flat_but_for(name: str) -> None:
    make, given, why = NOT_FLAT[name]
    found = make(*given)
    assert not in_plane(found)
    assert any(why in sentence for sentence in found.exceptions), found.exceptions


BEVEL = """\
heun: 1
gravity: [0, -9.81, 0]
ground: {points: {A: [0.1, 0, 0], B: [0, 0.1, 0]}}
bodies:
  one: {mass: 1, center: [0, 0, 0], inertia: [0.02, 0.01, 0.01], points: {c: [0, 0, 0]}}
  two: {mass: 1, center: [0, 0, 0], inertia: [0.01, 0.02, 0.01], points: {c: [0, 0, 0]}}
joints:
  first: {type: pin, from: ground.A, to: one.c, axis: [1, 0, 0], initial: {rate: 10}}
  second: {type: pin, from: ground.B, to: two.c, axis: [0, 1, 0]}
couplings: {m: {type: gear, of: [first, second], teeth: [20, 20]}}
analysis: {duration: 0.2, samples: 3}
"""


def test_a_scene_in_space_tells_which_coupling_makes_it_one() -> None:
    """Its joints alone would leave it in a plane across either axis."""
    found = set_up(load("scene.yaml", BEVEL)).reduction
    assert found is not None
    assert not found.explanations
    assert found.exceptions == (
        "not solved in the plane normal to x: couplings.m uses second.angle, an out-of-plane coordinate",
    )


def test_what_the_drives_leave_nothing_free_of_is_not_made_smaller() -> None:
    """Nothing is integrated; but where a method is asked for, and then in the plane."""
    driven = SCENE.format(
        tail=gear() + "\ndrives: {m: {joint: first, angle: t}, n: {joint: hang, angle: 2*t}}", hang="pin", second="pin",
        axis="[0, 0, 1]", about=", axis: [0, 0, 1]", p=0.0,
    )  # fmt: skip
    assert set_up(load("scene.yaml", driven)).reduction is None
    asked = set_up(load("scene.yaml", driven), "DOP853").reduction
    assert asked is not None
    assert in_plane(asked)


FLAT = {
    "spur gears": (gear(), "ball"),
    "teeth that push along the axes of what cannot tilt": (gear(", helix: 0.3, pressure_angle: 0.35"), "pin"),
    "a rope": (ROPE, "ball"),
}  # fmt: skip


@pytest.mark.parametrize("name", FLAT)
def test_flat(name: str) -> None:
    assert in_plane(scene(*FLAT[name]))
