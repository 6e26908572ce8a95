"""Signs and sizes of loads: power by each joint's own rate, action and reaction, directions as in manual/signs.md."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracle.loads import Push, pushes
from tests.oracle.read import Placed, end, model, placed
from tests.oracle.rows import coordinates
from tests.oracle.scenes import random_scene
from tests.oracle.turns import Array

KINDS = ("pin", "slide", "cylinder", "ball", "universal", "line", "plane")


def with_load(kind: str, load: dict, seed: int = 1) -> tuple[dict, dict[str, Placed], list[Push]]:
    """Two bodies, the second on a joint of a kind called j_b1, with one load called `it`."""
    scene, state = random_scene(np.random.default_rng(seed), 2, kinds=(kind,), branching=0.0, roots=0.0, loads=())
    scene["forces"] = {"it": load}
    return scene, state, pushes(model(scene), state, 0.0)["it"]


def total_power(state: dict[str, Placed], parts: list[Push]) -> float:
    return sum(p.power(state) for p in parts)


def opposite(parts: list[Push]) -> None:
    """Action and reaction, moments too."""
    np.testing.assert_allclose(sum(p.force for p in parts), np.zeros(3), rtol=0, atol=1e-13)
    np.testing.assert_allclose(sum(p.about(np.ones(3)) for p in parts), np.zeros(3), rtol=0, atol=1e-13)


@pytest.mark.parametrize("kind", KINDS)
def test_a_damper_takes_its_coefficient_times_the_rate_squared(kind: str) -> None:
    scene, state, parts = with_load(kind, {"type": "damper", "joint": "j_b1", "coefficient": 0.7, "sliding": 0.4})
    opposite(parts)
    j = next(j for j in model(scene).joints if j.name == "j_b1")
    a, b = placed(state, j.a.body), placed(state, j.b.body)
    turning = b.rotation.T @ (b.angular_velocity - a.angular_velocity)
    sliding = b.speed(j.b.point) - a.speed(a.rotation.T @ (b.point(j.b.point) - a.position))
    coordinate = coordinates(j, state)
    squares = {
        "pin": 0.7 * coordinate.get("rate", 0.0) ** 2,
        "slide": 0.7 * coordinate.get("speed", 0.0) ** 2,
        "cylinder": 0.7 * coordinate.get("rate", 0.0) ** 2 + 0.4 * coordinate.get("speed", 0.0) ** 2,
        "ball": 0.7 * turning @ turning,
        "universal": 0.7 * turning @ turning,
        "line": 0.7 * sliding @ sliding,
        "plane": 0.7 * sliding @ sliding,
    }
    assert squares[kind] > 1e-3
    assert total_power(state, parts) == pytest.approx(-squares[kind], rel=1e-12)


@pytest.mark.parametrize(("kind", "key"), [("pin", "torque"), ("slide", "force")])
def test_friction_opposes(kind: str, key: str) -> None:
    scene, state, parts = with_load(kind, {"type": "friction", "joint": "j_b1", key: 2.0, "speed": 0.5})
    opposite(parts)
    rate = coordinates(model(scene).joints[1], state)["rate" if kind == "pin" else "speed"]
    assert total_power(state, parts) == pytest.approx(-2.0 * np.tanh(rate / 0.5) * rate, rel=1e-12)


@pytest.mark.parametrize("kind", ["pin", "slide"])
def test_a_torque_drives_its_coordinate(kind: str) -> None:
    """On `to` about or along the axis: its power is its value times the rate."""
    scene, state, parts = with_load(kind, {"type": "torque", "joint": "j_b1", "value": lambda t: 3.0})
    opposite(parts)
    joint = model(scene).joints[1]
    rate = coordinates(joint, state)["rate" if kind == "pin" else "speed"]
    assert total_power(state, parts) == pytest.approx(3.0 * rate, rel=1e-12)
    assert parts[0].body == joint.b.body


def line_of(scene: dict, state: dict[str, Placed], spec: dict) -> tuple[float, float]:
    """Length of the line between two ends and its rate."""
    a, b = end(scene, spec["from"]), end(scene, spec["to"])
    gap = placed(state, b.body).point(b.point) - placed(state, a.body).point(a.point)
    opening = placed(state, b.body).speed(b.point) - placed(state, a.body).speed(a.point)
    return float(np.linalg.norm(gap)), float(gap @ opening / np.linalg.norm(gap))


ENDS = {"from": {"body": "ground", "at": [0.1, 0.2, 0.3]}, "to": {"body": "b1", "at": [0.4, -0.5, 0.6]}}


def test_an_actuator_pushes_apart() -> None:
    spec = {"type": "actuator", **ENDS, "value": 2.0}
    scene, state, parts = with_load("ball", spec)
    opposite(parts)
    assert total_power(state, parts) == pytest.approx(2.0 * line_of(scene, state, spec)[1], rel=1e-12)


def test_a_spring_pulls_back_and_damps() -> None:
    spec = {"type": "spring", **ENDS, "stiffness": 5.0, "length": 0.2, "damping": 0.3}
    scene, state, parts = with_load("ball", spec)
    opposite(parts)
    length, rate = line_of(scene, state, spec)
    assert total_power(state, parts) == pytest.approx(-(5.0 * (length - 0.2) + 0.3 * rate) * rate, rel=1e-12)


@pytest.mark.parametrize("kind", ["force", "couple"])
@pytest.mark.parametrize("frame", ["world", "body"])
def test_a_vector_stands_in_its_frame(kind: str, frame: str) -> None:
    on = {"body": "b1", "at": [0.4, -0.5, 0.6]}
    spec = {"type": kind, "on": on, "vector": [1.0, lambda t: 2.0, 3.0], "frame": frame}
    _, state, parts = with_load("ball", spec)
    (push,) = parts
    acting: Array = push.force if kind == "force" else push.couple
    expected = state["b1"].rotation @ [1.0, 2.0, 3.0] if frame == "body" else [1.0, 2.0, 3.0]
    np.testing.assert_allclose(acting, expected, rtol=0, atol=1e-15)
    np.testing.assert_allclose(push.place, state["b1"].point(np.array([0.4, -0.5, 0.6])), rtol=0, atol=1e-15)


def test_weight_acts_at_the_centres() -> None:
    scene, state, _ = with_load("ball", {"type": "force", "on": {"body": "b1", "at": [0, 0, 0]}, "vector": [0, 0, 0]})
    read = model(scene)
    for push in pushes(read, state, 0.0)["gravity"]:
        m = read.masses[push.body]
        np.testing.assert_allclose(push.force, m.mass * read.gravity, rtol=1e-15)
        np.testing.assert_allclose(push.about(state[push.body].point(m.center)), np.zeros(3), rtol=0, atol=1e-14)
