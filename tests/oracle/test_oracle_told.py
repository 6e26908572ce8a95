"""The same scene told otherwise is the same: turned, mirrored, other units, names, origins, ends; and written."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import yaml

from tests.oracle import transforms
from tests.oracle.checks import SEEDS, close, size_of, some_scene
from tests.oracle.read import start_state
from tests.oracle.scenes import misfit
from tests.oracle.solve import Solution, solve
from tests.oracle.tellings import TELLINGS, Telling
from tests.oracle.turns import random_rotation
from tests.oracle.values import to_yaml


def assert_same(told: Telling, found: Solution, other: Solution) -> None:
    """Reactions, foundation, accelerations and verdicts of `other` are those of `found`, as it tells them."""
    Q, det, size = told.Q, np.sign(np.linalg.det(told.Q)), size_of(found)
    assert (found.rank, found.rows) == (other.rank, other.rows)
    close(other.foundation_force / told.force, Q @ found.foundation_force, size)
    close(other.foundation_moment / told.moment, det * Q @ found.foundation_moment, size)
    for name, r in found.reactions.items():
        o = other.reactions[told.joints.get(name, name)]
        close(o.point / told.length, Q @ r.point)
        if r.unique[:3].all():
            close(o.force / told.force, Q @ r.force, size)
        if r.unique[3:6].all():
            close(o.moment / told.moment, det * Q @ r.moment, size)
        if r.unique[6]:
            unit = told.moment if r.weight[6] not in (0.0, 1.0) else told.force
            close(np.array(o.drive) / unit, np.array(r.drive), size)
        for c in np.eye(3):
            assert found.along(name, force=c)[1] == other.along(told.joints.get(name, name), force=Q @ c)[1]
            assert found.along(name, moment=c)[1] == other.along(told.joints.get(name, name), moment=Q @ c)[1]


@cache
def as_first_told(seed: int, t: float) -> Solution:
    return solve(*some_scene(seed), t)


WAYS = [way for way in TELLINGS if way != "other ends"]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.third
def test_told_otherwise(way: str, seed: int) -> None:
    scene, _ = some_scene(seed)
    told = TELLINGS[way](scene, np.random.default_rng(seed))
    start = start_state(told.scene)
    assert misfit(told.scene, start) < 1e-13 * told.length * max(1.0, told.length / told.time)
    for t in (0.0, 0.4) if way in ("turned", "mirrored") else (0.4,):
        found, other = as_first_told(seed, t), solve(told.scene, start, t * told.time)
        assert_same(told, found, other)
        if way in ("turned", "mirrored", "other origins"):
            continue
        for name, a in found.acceleration.items():
            there = told.bodies.get(name, name)
            close(other.acceleration[there] * told.time**2 / told.length, a, size_of(found))
            close(other.angular_acceleration[there] * told.time**2, found.angular_acceleration[name], size_of(found))


@pytest.mark.parametrize("seed", SEEDS)
def test_swapped(seed: int) -> None:
    scene, state = some_scene(seed, kinds=("ball", "pin", "weld", "rod"), loops=0, drives=2)
    found = solve(scene, state)
    for name, spec in scene["joints"].items():
        other = solve(transforms.swapped(scene, name), state)
        r, o = found.reactions[name], other.reactions[name]
        close(o.force, -r.force, size_of(found))
        close(o.moment, -r.moment, size_of(found))
        close(np.array(o.drive), np.array(r.drive), size_of(found))
        if spec["type"] != "rod":
            close(o.point, r.point)


def test_a_scene_written_and_read_is_the_same() -> None:
    """Every float by repr, every value in time as an expression that gives the same to rounding."""
    for seed in range(6):
        scene, _ = some_scene(seed, loops=1, drives=1)
        scene = transforms.turned(scene, random_rotation(np.random.default_rng(seed)))
        text = yaml.load(to_yaml(scene), Loader=yaml.BaseLoader)  # all scalars as text: `on` stays a word
        assert text.pop("heun") == "1"
        assert_written(text, scene)


def assert_written(text: object, value: object) -> None:
    if isinstance(value, dict):
        assert isinstance(text, dict) and list(text) == list(value)
        for key in value:
            assert_written(text[key], value[key])
    elif callable(value) or (isinstance(value, tuple) and value and callable(value[0])):
        f = value if callable(value) else value[0]
        assert isinstance(text, str)
        for t in (0.0, 0.7):
            assert eval(text, {"sin": np.sin, "t": t}) == pytest.approx(f(t), rel=1e-14, abs=1e-14)
    elif isinstance(value, list):
        assert isinstance(text, list) and len(text) == len(value)
        for a, b in zip(text, value, strict=True):
            assert_written(a, b)
    elif isinstance(value, float):
        assert isinstance(text, str) and float(text) == value
    else:
        assert text == value
