"""The same scene told otherwise is the same: turned, mirrored, other units, names, origins, ends; and written."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import yaml

from tests.oracle import transforms
from tests.oracle.checks import SEEDS, close, size_of, some_scene
from tests.oracle.read import start_state
from tests.oracle.scenes import misfit
from tests.oracle.solve import Solution, solve
from tests.oracle.turns import Array, random_rotation
from tests.oracle.values import to_yaml


def assert_same(found: Solution, other: Solution, Q: Array, force: float = 1.0, moment: float = 1.0,
                length: float = 1.0, joints: dict[str, str] | None = None) -> None:
    """Reactions, foundation and verdicts of `other` are those of `found`, turned by Q and scaled."""
    det = np.sign(np.linalg.det(Q))
    size = size_of(found)
    assert (found.rank, found.rows) == (other.rank, other.rows)
    close(other.foundation_force / force, Q @ found.foundation_force, size)
    close(other.foundation_moment / moment, det * Q @ found.foundation_moment, size)
    for name, r in found.reactions.items():
        o = other.reactions[(joints or {}).get(name, name)]
        close(o.point / length, Q @ r.point)
        if r.unique[:3].all():
            close(o.force / force, Q @ r.force, size)
        if r.unique[3:6].all():
            close(o.moment / moment, det * Q @ r.moment, size)
        if r.unique[6]:
            close(np.array(o.drive) / (moment if r.weight[6] not in (0.0, 1.0) else force), np.array(r.drive), size)
        for c in np.eye(3):
            assert found.along(name, force=c)[1] == other.along((joints or {}).get(name, name), force=Q @ c)[1]
            assert found.along(name, moment=c)[1] == other.along((joints or {}).get(name, name), moment=Q @ c)[1]


@pytest.mark.parametrize(("seed", "mirror"), list(itertools.product(SEEDS, (False, True))))
def test_turned_and_mirrored(seed: int, mirror: bool) -> None:
    scene, state = some_scene(seed)
    Q = random_rotation(np.random.default_rng(seed)) @ np.diag([1, 1, -1.0 if mirror else 1.0])
    other = transforms.turned(scene, Q)
    assert misfit(other, start_state(other)) < 1e-13
    for t in (0.0, 0.4):
        assert_same(solve(scene, state, t), solve(other, start_state(other), t), Q)


@pytest.mark.parametrize("seed", SEEDS)
def test_other_units(seed: int) -> None:
    scene, state = some_scene(seed)
    length, mass, time = 39.37, 2.2, 0.1
    other = transforms.units_changed(scene, length, mass, time)
    found, seen = solve(scene, state, 0.3), solve(other, start_state(other), 0.3 * time)
    assert_same(found, seen, np.eye(3), mass * length / time**2, mass * length**2 / time**2, length)
    for name, a in found.acceleration.items():
        close(seen.acceleration[name] * time**2 / length, a, size_of(found))


@pytest.mark.parametrize("seed", SEEDS)
def test_faster(seed: int) -> None:
    """Heun: forces c² times, rates c times: every reaction c² times."""
    scene, state = some_scene(seed)
    other = transforms.faster(scene, 3.0)
    assert_same(solve(scene, state), solve(other, start_state(other)), np.eye(3), 9.0, 9.0)


@pytest.mark.parametrize("seed", SEEDS)
def test_renamed(seed: int) -> None:
    scene, state = some_scene(seed)
    other, bodies, joints = transforms.renamed(scene, np.random.default_rng(seed))
    found, seen = solve(scene, state), solve(other, start_state(other))
    assert_same(found, seen, np.eye(3), joints=joints)
    for name, a in found.angular_acceleration.items():
        close(seen.angular_acceleration[bodies[name]], a, size_of(found))


@pytest.mark.parametrize("seed", SEEDS)
def test_origin_moved(seed: int) -> None:
    scene, state = some_scene(seed)
    other = scene
    for name in scene["bodies"]:
        other = transforms.origin_moved(other, name, np.random.default_rng(seed).standard_normal(3))
    assert_same(solve(scene, state), solve(other, start_state(other)), np.eye(3))


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
