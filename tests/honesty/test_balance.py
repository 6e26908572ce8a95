"""d'Alembert's balance of bodies that a blow reaches by rounding alone, and of those it reaches by little."""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import pytest

from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.loads.kinetostatics.balance import find_balance_residual
from tests.shared.scenes import study

Array = np.ndarray[Any, np.dtype[np.float64]]
REACHED = ("pin", "slide", "ball")


def pressed_on_stops(seed: int, bodies: tuple[int, int]) -> dict[str, Any]:
    """A chain on pins and slides, of any size and mass: its first joints stand at stops, one of its bars is struck.

    What stops hold does not move, but for rounding: what hangs on it is reached by that.
    """
    draw = random.Random(seed)
    length, mass = 10 ** draw.uniform(-3, 3), 10 ** draw.uniform(-3, 3)
    count = draw.randint(*bodies)
    stopped = draw.randint(1, count - 1)
    scene: dict[str, Any] = {"ground": {"points": {"O": [0, 0, 0]}}, "bodies": {}, "joints": {}, "stops": {}}
    end, place = "ground.O", np.zeros(3)
    for k in range(count):
        bar = length * draw.uniform(0.3, 2) * direction(draw)
        m = mass * 10 ** draw.uniform(-2, 2)
        inertia = m / 12 * (1.05 * (bar @ bar) * np.eye(3) - np.outer(bar, bar))
        points = {"a": [0, 0, 0], "e": bar.tolist(), "p": (draw.uniform(0.2, 0.8) * bar).tolist()}
        scene["bodies"][f"b{k}"] = {"mass": m, "center": (0.4 * bar).tolist(), "inertia": inertia.tolist()}
        scene["bodies"][f"b{k}"] |= {"points": points, "position": place.tolist()}
        kind = draw.choice(REACHED[:2] if k < stopped else REACHED)
        joint = {"type": kind, "from": end, "to": f"b{k}.a"}
        scene["joints"][f"j{k}"] = joint if kind == "ball" else {**joint, "axis": direction(draw).tolist()}
        if k < stopped:
            limits = {"angle": [0, 1]} if kind == "pin" else {"travel": [0, length]}
            scene["stops"][f"s{k}"] = {"joint": f"j{k}", **limits}
        end, place = f"b{k}.e", place + bar
    struck = f"b{draw.randint(0, stopped - 1)}.p"
    blow = mass * length * 10 ** draw.uniform(0, 4) * direction(draw)
    scene["impulses"] = {"blow": {"on": struck, "vector": blow.tolist(), "time": 0}}
    return {**scene, "analysis": {"type": "impulse"}}


def direction(draw: random.Random) -> Array:
    """A unit vector."""
    v = np.array([draw.gauss(0, 1) for _ in range(3)])
    return np.asarray(v / np.linalg.norm(v))


@pytest.mark.parametrize("bodies", [(2, 5), (8, 12)])
@pytest.mark.third
def test_what_rounding_alone_reaches_is_no_false_alarm(bodies: tuple[int, int]) -> None:
    for seed in range(30):
        found = study(pressed_on_stops(seed, bodies)).results
        assert not [line for line in found.warnings if "balance" in line], seed
        assert found.accuracy["balance_residual"] <= tolerances.UNBALANCED


CART = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  heavy: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {O: [0, 0, 0]}}
  light: {mass: %s, center: [0, 0, 0], inertia: [1, 1, 1], points: {O: [0, 0, 0]}}
joints:
  rail: {type: slide, from: ground.O, to: heavy.O, axis: [1, 0, 0]}
  link: {type: slide, from: heavy.O, to: light.O, axis: [0, 1, 0]}
forces: {push: {type: force, on: heavy.O, vector: [1, 0, 0]}}
"""


@pytest.mark.parametrize(("part", "alarm"), [(1e-13, True), (1e-17, False)])
def test_a_small_load_that_is_missing_is_seen_down_to_rounding_of_the_largest(part: float, alarm: bool) -> None:
    """A light body is set going by `part` of the largest load, and the joint that does so is left out."""
    recovery = study(CART % part).recovery
    actions = [
        replace(action, force=0 * action.force, moment=0 * action.moment) if action.name == "link" else action
        for action in recovery.actions
    ]
    residual = find_balance_residual(
        recovery.setup.scene.mechanism, recovery.states, recovery.inertia, actions, recovery.setup.scene.layout.size
    )
    assert (residual > tolerances.UNBALANCED) == alarm
