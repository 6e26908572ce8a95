"""A state space foretells how a scene answers small inputs: SciPy's simulation of it against runs, to second order."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.signal import lsim

from tests.shared.lagrange import told
from tests.shared.scenes import solved

# a trolley between springs, a load that hangs from it, and a tail on that
CRANE = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  trolley: {{mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {{c: [0, 0, 0]}}}}
  load:
    shapes: [{{type: rod, from: [0, 0, 0], to: [0, 0, -1.2], mass: 0.7}}]
    points: {{o: [0, 0, 0], e: [0, 0, -1.2]}}
  tail:
    shapes: [{{type: rod, from: [0, 0, 0], to: [0, 0, -0.4], mass: 0.3}}]
    points: {{o: [0, 0, 0], e: [0, 0, -0.4]}}
joints:
  rail: {{type: slide, axis: [1, 0, 0], from: ground.O, to: trolley.c}}
  hinge: {{type: pin, axis: [0, -1, 0], from: trolley.c, to: load.o}}
  tail: {{type: pin, axis: [0, -1, 0], from: load.e, to: tail.o}}
forces:
  centre: {{type: torque, joint: rail, value: -30*rail.travel}}
  push: {{type: torque, joint: rail, value: "{push}"}}
  turn: {{type: torque, joint: tail, value: "{turn}"}}
  rub: {{type: damper, joint: hinge, coefficient: 0.3}}
{drive}
analysis: {{duration: 3, samples: 301, tolerance: 1e-11}}
"""
LAWS = {"push": "sin(3*t)", "turn": "0.2*cos(2*t)*t"}
TIMES = np.linspace(0.0, 3.0, 301)


def run(small: float, drive: str = "") -> Any:
    laws = {name: f"{small}*({law})" for name, law in LAWS.items()}
    return solved(CRANE.format(drive=drive, **laws))


def foretold(drive: str, inputs: tuple[str, ...], u: list[Any], outputs: tuple[str, ...]) -> Any:
    linear = told(
        CRANE.format(push="0", turn="0", drive=drive), state_space=True, inputs=inputs, outputs=outputs
    ).state_space
    assert linear is not None
    assert not linear.offset.any()
    return lsim((linear.A, linear.B, linear.C, linear.D), np.array(u).T, TIMES)[1].T


@pytest.mark.parametrize("small", [1e-2, 1e-3])
def test_small_forces(small: float) -> None:
    """Between samples SciPy takes the inputs as straight: that costs 1e-4 of them, what is not linear the square."""
    u = [np.sin(3 * TIMES), 0.2 * np.cos(2 * TIMES) * TIMES]
    travel, angle, speed, place = foretold(
        "", ("push", "turn"), u, ("rail.travel", "tail.angle", "hinge.rate", "tail.e.x")
    )
    found = run(small)
    for ours, theirs in (
        (travel, found.coordinates["rail"]["travel"]), (angle, found.coordinates["tail"]["angle"]),
        (speed, found.coordinates["hinge"]["rate"]), (place, found.points["tail.e"]["position"][:, 0]),
    ):  # fmt: skip
        size = np.abs(ours).max()
        assert np.abs(small * ours - theirs).max() <= small * size * (2e-4 + 20.0 * small**2)


def test_a_drive_by_its_acceleration() -> None:
    """The trolley is driven: its acceleration is put in, its travel is a state; the others answer."""
    small = 1e-3
    drive = "drives: {{motor: {{joint: rail, travel: '{small}*(1 - cos(2*t))'}}}}"
    u = [4.0 * np.cos(2 * TIMES)]
    travel, angle = foretold(
        drive.format(small=0).replace("0*(1 - cos(2*t))", "0"), ("motor",), u, ("rail.travel", "hinge.angle")
    )
    text = CRANE.format(push="0", turn="0", drive=drive.format(small=small))
    found = solved(text)
    assert np.abs(small * travel - found.coordinates["rail"]["travel"]).max() <= 2e-4 * small * np.abs(travel).max()
    assert np.abs(small * angle - found.coordinates["hinge"]["angle"]).max() <= 2e-4 * small * np.abs(angle).max()
