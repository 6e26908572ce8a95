"""Loads that balance among themselves, made by hand: they are all that is open; nothing called certain feels them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest

from heuncli.results.results import Results
from tests.oracle.published import beam, bricard, four_bar
from tests.oracle.read import GROUND, model
from tests.oracle.turns import Array
from tests.shared.doubles import SEEDS, redundant_scene
from tests.shared.open_components import sums
from tests.shared.redundant_supports import SQUARE, door, table
from tests.shared.scenes import moving, near, solved


class Screw(NamedTuple):
    """A force with its moment about the origin, that passes through all joints of a ring."""

    force: tuple[float, float, float]
    moment: tuple[float, float, float]


Hand = dict[str, Array]  # of each joint force and moment ON `to` about the `to` point


def forces(**of: tuple[float, float, float]) -> Callable[[Results], Hand]:
    return lambda found: {name: np.array([*of[name], 0, 0, 0]) for name in found.joints}


def around(screw: Screw, reverse: str) -> Callable[[Results], Hand]:
    """`reverse`: the joint that is told against the sense of the ring."""

    def make(found: Results) -> Hand:
        F, M = np.array(screw.force), np.array(screw.moment)
        at = {name: block["point"][0] for name, block in found.joints.items()}
        sign = {name: -1 if name == reverse else 1 for name in at}
        return {name: sign[name] * np.concatenate([F, M - np.cross(p, F)]) for name, p in at.items()}

    return make


BAR = four_bar(1.0, 0.0, 1.0, (1, 2, 1, 2), (0.7, 0.0, 0.7))
PARALLEL = [Screw((0, 0, 1), (0, 0, 0)), Screw((0, 0, 0), (1, 0, 0)), Screw((0, 0, 0), (0, 1, 0))]
MADE: dict[str, tuple[dict[str, Any], list[Callable[[Results], Hand]]]] = {
    "door": (door(), [forces(top=(0, 0, 1), bottom=(0, 0, -1))]),
    "beam": (beam(), [forces(a=(0, 0, 2), b=(0, 0, -3), c=(0, 0, 1))]),  # by levers, at 0, 1 and 3
    "table": (table(SQUARE), [forces(A=(0, 0, 1), B=(0, 0, -1), C=(0, 0, 1), D=(0, 0, -1))]),
    "four hinges": (BAR, [around(s, "D") for s in PARALLEL]),
    # no moment about any hinge: M0.y = 0, (M0 - P1 x F).z = 0, and so on round
    "bricard": (bricard(), [around(Screw((1, 1, 1), (-1, 0, 1)), "P5")]),
}


def plain_and_by_hand(name: str) -> tuple[dict[str, Any], Results, list[Hand]]:
    scene, makers = MADE[name]
    found = solved(scene)
    return scene, found, [make(found) for make in makers]


@pytest.mark.parametrize("name", MADE)
def test_made_by_hand_they_balance(name: str) -> None:
    """On every body, about any point; and hinges do not carry about their axes, feet only upright."""
    scene, found, hands = plain_and_by_hand(name)
    for hand in hands:
        on: dict[str, Array] = {}
        for j in model(scene).joints:
            F, M = hand[j.name][:3], hand[j.name][3:]
            whole = np.concatenate([F, M + np.cross(found.joints[j.name]["point"][0], F)])
            for body, sign in ((j.a.body, -1), (j.b.body, 1)):
                on[body] = on.get(body, np.zeros(6)) + sign * whole
            if j.kind == "pin":
                R = np.eye(3) if j.a.body == GROUND else found.bodies[j.a.body]["rotation"][0]
                near(M @ R @ j.axis, 0.0, 1.0, 1e-14)
            if j.kind == "plane":
                near(np.cross(F, j.axis), 0.0, 1.0, 1e-14)
            if j.kind in ("ball", "plane"):
                assert not M.any()
        for body in scene["bodies"]:
            near(on[body], 0.0, 1.0, 1e-14)


@pytest.mark.parametrize("name", MADE)
def test_all_that_is_open_and_nothing_else(name: str) -> None:
    """As many as are redundant; open is just what one of them has a share in, and in certain sums they cancel."""
    _, found, hands = plain_and_by_hand(name)
    assert found.model["redundant"] == len(hands)
    for joint, block in found.joints.items():
        touched = np.any([np.abs(hand[joint]) > 1e-12 for hand in hands], axis=0)
        assert np.isnan(np.concatenate([block["force"][0], block["moment"][0]])).tolist() == touched.tolist(), joint
    assert sums(found)
    for terms, _ in sums(found):
        for hand in hands:
            near(sum(factor * component(hand, path) for path, factor in terms.items()), 0.0, 1.0, 1e-12)


@pytest.mark.parametrize("name", MADE)
def test_superposed_nothing_certain_changes(name: str) -> None:
    """A split with a thousand newtons of it added, against what was said without any split."""
    scene, found, hands = plain_and_by_hand(name)
    split = solved(scene, least_norm=True)
    for hand in hands:
        loaded = {n: np.concatenate([b["force"][0], b["moment"][0]]) + 1e3 * hand[n] for n, b in split.joints.items()}
        for joint, block in found.joints.items():
            told = np.concatenate([block["force"][0], block["moment"][0]])
            certain = ~np.isnan(told)
            near(loaded[joint][certain], told[certain], 1e3, 1e-13)
        for terms, value in sums(found):
            near(sum(factor * component(loaded, path) for path, factor in terms.items()), value, 1e3, 1e-12)


def component(wrenches: Hand, path: str) -> float:
    _, joint, part, c = path.split(".")
    return float(wrenches[joint][{"force": 0, "moment": 3}[part] + "xyz".index(c)])


@pytest.mark.parametrize("seed", SEEDS[::9])
@pytest.mark.third
def test_whichever_split_what_is_certain_stays(seed: int) -> None:
    """Two splits by any stiffness differ by self-stresses: in what was open, and in nothing else."""
    scene, rng = redundant_scene(seed)[1], np.random.default_rng(seed)
    found = solved(scene)
    splits = []
    for _ in range(2):
        joints = {}
        for name, j in scene["joints"].items():
            k = {part: rng.uniform(0.1, 10, 3).tolist() for part in ("force", "moment")}
            joints[name] = {**j, "stiffness": k}
        splits.append(solved({**scene, "joints": joints}))
    F = max(float(np.nanmax(np.abs(b["force"]))) for s in splits for b in s.joints.values())
    apart = 0.0
    for name, block in found.joints.items():
        for part in ("force", "moment"):
            values = [s.joints[name][part][0] for s in splits]
            certain = ~np.isnan(block[part][0])
            assert not np.isnan(values).any()
            for value in values:
                near(value[certain], block[part][0][certain], F)
            apart = max(apart, float(np.abs(values[0] - values[1]).max()))
    assert apart > 1e-3 * F
    for terms, value in sums(found):
        for s in splits:
            told = {n: np.concatenate([b["force"][0], b["moment"][0]]) for n, b in s.joints.items()}
            near(sum(f * component(told, path) for path, f in terms.items()), value, F * sum(map(abs, terms.values())))


@pytest.mark.parametrize("seed", SEEDS[:40:9])
def test_a_stiffness_does_not_move_anything(seed: int) -> None:
    scene = redundant_scene(seed)[1]
    joints = {n: {**j, "stiffness": 1e6} for n, j in scene["joints"].items()}
    first, second = (solved(moving(s, (0.0, 0.05), 1e-10)).bodies for s in (scene, {**scene, "joints": joints}))
    for name, body in first.items():
        for key, values in body.items():
            assert np.array_equal(values, second[name][key]), (name, key)
