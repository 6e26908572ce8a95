"""Axes that point the other way, and starts along paths, where a formula or the law of the rim tells the right sign."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from tests.shared.scenes import near, solved

G = 9.81


def winch(space: str, sense: float, side: str) -> dict[str, Any]:
    """A drum of 0.1 m that turns at 3 rad/s about its axis, on which a load of 10 kg hangs at x = -0.1 or 0.1."""
    x = -0.1 if side == "right" else 0.1
    sheave = {"sheave": "drum.hub", "radius": 0.1, "slip": "none", "side": side}
    return {
        "space": space, "gravity": [0, -G, 0], "ground": {"points": {"O": [0, 2, 0], "g": [x, 0, 0]}},
        "bodies": {
            "drum": {"mass": 5, "center": [0, 0, 0], "inertia": [0.1, 0.1, 0.1], "points": {"hub": [0, 0, 0]}},
            "load": {"mass": 10, "center": [0, 0, 0], "inertia": [1, 1, 1], "points": {"top": [0, 0, 0]}},
        },
        "joints": {
            "axle": {"type": "pin", "from": "ground.O", "to": "drum.hub", "axis": [0, 0, sense]},
            "rail": {"type": "slide", "from": "ground.g", "to": "load.top", "axis": [0, 1, 0]},
        },
        "couplings": {"rope": {"type": "rope", "through": ["load.top", sheave]}},
        "drives": {"m": {"joint": "axle", "rate": 3}}, "analysis": {"times": [0, 0.1, 0.3], "tolerance": 1e-12},
    }  # fmt: skip


@pytest.mark.parametrize("ends", ["as they are", "exchanged"])
@pytest.mark.parametrize("space", ["planar", "spatial"])
@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("side", ["left", "right"])
def test_a_drum_draws_its_load_as_its_rim_goes(space: str, sense: float, side: str, ends: str) -> None:
    """The load's velocity is omega x r, its travel the integral of that, the drive's power the rise of energy."""
    scene = winch(space, sense, side)
    axle = scene["joints"]["axle"]
    if ends == "exchanged":
        axle["from"], axle["to"] = axle["to"], axle["from"]
    if space == "spatial":  # `left` is told by the axis of the sheave, in a plane z
        scene["couplings"]["rope"]["through"][1]["axis"] = [0, 0, 1]
    found = solved(scene)
    omega, x = found.bodies["drum"]["angular_velocity"], -0.1 if side == "right" else 0.1
    rim = float(omega[0, 2]) * x
    near(abs(rim), 0.3, 1.0, 1e-12)
    near(found.bodies["load"]["velocity"][:, 1], np.full(3, rim), 1.0, 1e-10)
    near(found.coordinates["rail"]["travel"], rim * found.time, 1.0, 1e-10)
    near(found.joints["axle"]["drive"] * found.coordinates["axle"]["rate"], np.full(3, 10 * G * rim), 30.0, 1e-10)
    near(found.energy["work"], 10 * G * rim * found.time, 30.0, 1e-10)


M, m, J, R = 900.0, 700.0, 60.0, 0.4
RISES = (M - m) * G / (M + m + J / R**2)


def elevator(space: str, sense: float) -> dict[str, Any]:
    """A cage, its counterweight, and a sheave that turns with the rope."""
    bodies = {"sheave": (150.0, J, "hub"), "cage": (M, 500.0, "top"), "weight": (m, 100.0, "top")}
    return {
        "space": space, "gravity": [0, -G, 0],
        "ground": {"points": {"O": [0, 12, 0], "a": [-R, 0, 0], "b": [R, 8, 0]}},
        "bodies": {name: {"mass": mass, "center": [0, 0, 0], "inertia": [inertia] * 3, "points": {point: [0, 0, 0]}}
                   for name, (mass, inertia, point) in bodies.items()},
        "joints": {
            "axle": {"type": "pin", "from": "ground.O", "to": "sheave.hub", "axis": [0, 0, sense]},
            "rails": {"type": "slide", "from": "ground.a", "to": "cage.top", "axis": [0, 1, 0]},
            "guide": {"type": "slide", "from": "ground.b", "to": "weight.top", "axis": [0, 1, 0]},
        },
        "couplings": {"hoist": {"type": "rope", "through": [
            "cage.top", {"sheave": "sheave.hub", "radius": R, "slip": "none"}, "weight.top"]}},
        "analysis": {"times": [0, 1]},
    }  # fmt: skip


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_an_elevator_moves_whichever_way_its_axle_points(sense: float) -> None:
    """a = (M - m) g / (M + m + J/R^2)."""
    found = solved(elevator("planar", sense))
    near(found.coordinates["rails"]["travel"][1], -RISES / 2.0, 1.0, 1e-8)
    near(found.couplings["hoist"]["tension"][1], M * (G - RISES), M * G, 1e-8)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_two_pins_at_a_sheave_may_point_opposite_ways(sense: float) -> None:
    """A wheel in a pin of its own stands on the sheave's axis: nothing changes; but `left` is not told by such pins."""
    scene = {**elevator("spatial", 1.0), "analysis": {"type": "state"}}
    scene["bodies"]["wheel"] = {"mass": 1, "center": [0, 0, 0], "inertia": [1, 1, 1], "points": {"o": [0, 0, 0]}}
    scene["joints"]["beside"] = {"type": "pin", "from": "sheave.hub", "to": "wheel.o", "axis": [0, 0, sense]}
    near(solved(scene).coordinates["rails"]["acceleration"], -RISES, G, 1e-12)
    scene["couplings"]["hoist"]["through"][1]["side"] = "right"
    if sense < 0.0:
        with pytest.raises(SolveError, match="opposite directions"):
            solved(scene)
    else:
        near(solved(scene).coordinates["rails"]["acceleration"], -RISES, G, 1e-12)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_speed_that_is_held_along_a_path_stays_where_a_coupling_asks_for_rates(sense: float) -> None:
    """The wheel alone is set turning; the bead keeps the speed along its wire, and the wire the rate that it has."""
    s = np.linspace(-3.0, 3.0, 13)
    body = {"mass": 1, "center": [0.1, 0, 0], "inertia": [1, 1, 1]}
    found = solved({
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {
            "wire": {**body, "points": {"o": [0, 0, 0], "p": [0.3, 0, 0]}},
            "bead": {**body, "points": {"c": [0, 0, 0]}},
            "wheel": {**body, "points": {"o": [0, 0, 0]}},
        },
        "joints": {
            "hang": {"type": "pin", "from": "ground.O", "to": "wire.o", "axis": [0, 0, 1], "initial": {"rate": 0.8}},
            "own": {"type": "pin", "from": "wire.p", "to": "wheel.o", "axis": [0, 0, sense]},
            "along": {"type": "curve", "from": "wire.o", "to": "bead.c", "x": "x", "y": "y",
                      "initial": {"travel": 0.5, "speed": -0.4}},
        },
        "tables": {"x": {"x": s.tolist(), "y": (2.0 * s).tolist(), "interpolation": "cubic"},
                   "y": {"x": s.tolist(), "y": np.sin(s).tolist(), "interpolation": "cubic"}},
        "couplings": {"tie": {"type": "ratio", "of": ["hang", "own"], "factors": [1, 2]}},
        "analysis": {"type": "state"},
    })  # fmt: skip
    told = [found.coordinates[name][key][0] for name, key in (("hang", "rate"), ("own", "rate"), ("along", "speed"))]
    near(told, [0.8, -0.4, -0.4], 1.0, 1e-12)
    assert math.isclose(found.coordinates["along"]["travel"][0], 0.5, abs_tol=1e-12)
