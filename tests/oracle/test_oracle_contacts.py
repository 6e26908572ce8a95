"""The oracle's contacts against closed cases: a ball on the floor, two of a row, a row that touches."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracle.contacts import rest, strike
from tests.oracle.read import start_state
from tests.oracle.totals import kinetic_energy

BALL = {"mass": 2.0, "center": [0, 0, 0], "inertia": [0.1, 0.1, 0.1], "points": {"c": [0, 0, 0]}}


def ball(speed: float, e: float) -> dict:
    return {"gravity": [0, 0, -9.81], "ground": {"points": {"O": [0, 0, 0]}},
            "bodies": {"b": {**BALL, "position": [0, 0, 0], "velocity": [0, 0, speed],
                             "orientation": {"matrix": np.eye(3).tolist()}}},
            "joints": {"guide": {"type": "slide", "from": "ground.O", "to": "b.c", "axis": [0, 0, 1]}},
            "stops": {"floor": {"joint": "guide", "travel": [0.0, None], "restitution": e}}}  # fmt: skip


@pytest.mark.parametrize("e", [0.0, 0.4, 1.0])
def test_a_ball(e: float) -> None:
    s = ball(-3.0, e)
    (met,) = strike(s, start_state(s))
    assert met.after["b"].velocity[2] == pytest.approx(3.0 * e)
    assert met.pushes == {"floor": pytest.approx(2.0 * 3.0 * (1 + e))}
    assert met.solution.foundation_force[2] == pytest.approx(-6.0 * (1 + e))
    s = ball(0.0, e)
    (met,) = rest(s, start_state(s))
    assert met.pushes == {"floor": pytest.approx(2.0 * 9.81)}
    s["gravity"] = [0, 0, 1.0]
    (met,) = rest(s, start_state(s))
    assert met.pushes == {} and met.solution.acceleration["b"][2] == pytest.approx(1.0)


def row(n: int, speed: float, e: float, spacing: float = 0.2) -> dict:
    """n balls on ropes of 1 m, touching, the first one moving towards the others."""
    bodies, joints, stops = {}, {}, {}
    points = {f"A{k}": [spacing * k, 0, 1.0] for k in range(n)}
    for k in range(n):
        bodies[f"b{k}"] = {**BALL, "position": [spacing * k, 0, 0], "velocity": [speed if k == 0 else 0.0, 0, 0],
                           "orientation": {"matrix": np.eye(3).tolist()}}  # fmt: skip
        joints[f"rope{k}"] = {"type": "rod", "from": f"ground.A{k}", "to": f"b{k}.c", "length": 1.0,
                              "tension_only": True, "restitution": 0.0}  # fmt: skip
        if k:
            joints[f"gap{k}"] = {"type": "rod", "from": f"b{k - 1}.c", "to": f"b{k}.c"}
            stops[f"touch{k}"] = {"joint": f"gap{k}", "length": [spacing, None], "restitution": e}
    return {"gravity": [0, 0, -9.81], "ground": {"points": points}, "bodies": bodies, "joints": joints, "stops": stops}


@pytest.mark.parametrize("n", [2, 3, 4])
def test_a_row_of_balls(n: int) -> None:
    """Newton's law for all at once: the others go together, the energy stays at e = 1."""
    s = row(n, 3.0, 1.0)
    before = start_state(s)
    (met,) = strike(s, before)
    others = 2 * 3.0 / n
    speeds = [met.after[f"b{k}"].velocity[0] for k in range(n)]
    np.testing.assert_allclose(speeds, [others - 3.0, *[others] * (n - 1)], atol=1e-12)
    assert kinetic_energy(s, met.after) == pytest.approx(kinetic_energy(s, before), rel=1e-12)
    (dull,) = strike(row(n, 3.0, 0.0), before)
    np.testing.assert_allclose([dull.after[f"b{k}"].velocity[0] for k in range(n)], 3.0 / n, atol=1e-12)


def test_hanging_at_rest() -> None:
    s = row(2, 0.0, 0.5)
    (met,) = rest(s, start_state(s))  # the ropes bear the weights, the balls do not push each other
    assert met.pushes["rope0"] == pytest.approx(2 * 9.81) and met.pushes.get("touch1", 0.0) == pytest.approx(0.0)
