"""The stiffness of a spatial closed chain against differences of the oracle's accelerations, and so its frequencies.

A plate on three links, ball to ball, which spin: three loops in space, at rest by symmetry. The oracle knows bodies in
absolute coordinates and joints as rows, neither trees nor dual numbers; of the program it takes the closed poses alone.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from heuncli.analyses.modes.reference_state import find_state
from heuncli.loads.kinetostatics.bodies import make_body_states
from heuncli.motion.linearisation.displacements import displace
from heuncli.motion.linearisation.steady_motion import LinearisedState
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from tests.oracle.read import Placed, model
from tests.oracle.solve import solve
from tests.oracle.values import to_yaml

STEP = 1e-3  # of turns and of the size; the error of two extrapolated differences is of its fourth power
CORNERS = {name: [math.cos(2.0 * math.pi * k / 3.0), math.sin(2.0 * math.pi * k / 3.0)] for k, name in enumerate("ABC")}


def plate() -> dict[str, Any]:
    """A plate of 3 kg on three links of 0.4 kg, with a spring in its middle that pushes up."""
    link = {"mass": 0.4, "center": [0, 0, -0.4], "inertia": [0.03, 0.02, 0.015],
            "points": {"a": [0, 0, 0], "b": [0, 0, -0.9]}}  # fmt: skip
    return {
        "gravity": [0, 0, -9.81],
        "ground": {"points": {**{n: [*at, 0] for n, at in CORNERS.items()}, "O": [0, 0, -2.5]}},
        "bodies": {
            "plate": {"mass": 3.0, "center": [0, 0, -1.0], "inertia": [0.5, 0.7, 1.1],
                      "points": {**{n: [*at, -0.9] for n, at in CORNERS.items()}, "m": [0, 0, -0.9]}},
            **{n.lower(): {**link, "position": [*at, 0]} for n, at in CORNERS.items()},
        },
        "joints": {
            **{f"up{n}": {"type": "ball", "from": f"ground.{n}", "to": f"{n.lower()}.a"} for n in CORNERS},
            **{f"low{n}": {"type": "ball", "from": f"{n.lower()}.b", "to": f"plate.{n}"} for n in CORNERS},
        },
        "forces": {"s": {"type": "spring", "from": "ground.O", "to": "plate.m", "stiffness": 20.0, "length": 2.0}},
    }  # fmt: skip


def inertia_loads(here: LinearisedState, scene: dict[str, Any], along: Array) -> Array:
    """What the oracle's accelerations, at rest a little along a displacement, do along the reduced motions, (f,)."""
    layout, bodies = here.layout, here.layout.mechanism.bodies
    state = displace(layout, here.linear.state, along)
    recovered = here.runner.evaluate(np.array([here.t]), state[None, :], holding=here.holding)
    at = make_body_states(layout, recovered)
    still = np.zeros(3)
    placed = {b.name: Placed(at.x[0, i], at.R[0, i], still, still) for i, b in enumerate(bodies)}
    answer = solve(model(scene), placed)
    total = np.zeros(here.system.count)
    for i, body in enumerate(bodies):
        twist = here.linear.twists[layout.place[i]] @ here.system.tangent
        R = here.linear.attitudes[layout.place[i]]
        total += twist[3:].T @ (body.mass * answer.acceleration[body.name])
        total += twist[:3].T @ (R @ body.inertia @ R.T @ answer.angular_acceleration[body.name])
    return total


def test_a_spatial_loop() -> None:
    scene = plate()
    setup = set_up(load("scene.yaml", to_yaml(scene)), reduce=False)
    here, *_ = find_state(setup)
    scale = np.abs(here.weights[:, None] * here.system.tangent).max(axis=0)
    T = here.system.tangent / scale
    K = np.zeros((here.system.count, here.system.count))
    for k in range(here.system.count):
        coarse, fine = (
            (inertia_loads(here, scene, h * T[:, k]) - inertia_loads(here, scene, -h * T[:, k])) / (2.0 * h)
            for h in (2.0 * STEP, STEP)
        )
        K[:, k] = -scale[k] * (4.0 * fine - coarse) / 3.0
    assert here.system.count == 6  # three of the plate, and the links' spins
    near = np.abs(K - here.system.stiffness).max()
    assert near <= 1e-8 * np.abs(here.system.stiffness).max()
