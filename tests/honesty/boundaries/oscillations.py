"""Small oscillations: what is free, at rest, and where a law has a slope."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from heuncli.commands.modes.study import modes
from heuncli.errors import HeunError
from heuncli.linearisation.oscillations import oscillations
from heuncli.linearisation.reduced_equations import ReducedEquations
from heuncli.linearisation.steady_motion import off_balance
from heuncli.spec.load import load
from tests.honesty.boundaries.part import Part, Row
from tests.shared.scenes import near


def soft_beside_stiff(x: float) -> str:
    """Two motions, one of stiffness 1, the other of 2 x: the kind of the softer."""
    f = np.zeros((2, 2))
    system = ReducedEquations(np.eye(2), f, np.eye(2), f, -np.diag([2.0 * x, 1.0]), f, np.zeros(2), 0.0, 0.0)
    return oscillations(system)[0].kind


def pushed_freely(x: float) -> str:
    """What nothing holds, pushed by x of the loads there."""
    f, one = np.zeros((1, 1)), np.eye(1)
    here = SimpleNamespace(system=ReducedEquations(one, f, one, f, f, f, np.array([x]), 1.0, 0.0), weights=np.ones(1))
    return "falls" if np.isinf(off_balance(here)) else "rests"  # type: ignore[arg-type]


def hanging(x: float, law: str = "0") -> str:
    """Modes of a pendulum drawn askew by x, with a torque: refused, or the right frequency."""
    text = f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar:
    mass: 1
    center: [0, 0, -1]
    inertia: [0, 0, 0]
    points: {{a: [0, 0, 0]}}
    orientation: {{axis: [0, 1, 0], angle: {x!r}}}
joints: {{pivot: {{type: pin, axis: [0, 1, 0], from: ground.O, to: bar.a}}}}
forces: {{law: {{type: torque, joint: pivot, value: "{law}"}}}}
"""
    try:
        found = modes(load("scene.yaml", text))
    except HeunError as error:
        return f"refused: {error.problems[0].code}"
    near(2.0 * np.pi * found.modes[0].frequency, np.sqrt(9.81), 1.0, 1e-12)
    return "fine"


def beside_a_kink(x: float) -> str:
    """The same at rest, with a torque that begins beyond an angle of x."""
    return hanging(0.0, f"max(0, pivot.angle - {x!r})")


PART = Part(
    ("small oscillations",),
    rows=(
        Row("EIGENVALUE", soft_beside_stiff, "free", "oscillation"),
        Row("FREELY_PUSHED", pushed_freely, "rests", "falls"),
        Row("OFF_BALANCE", hanging, "fine", "refused: not-at-rest"),
        Row("KINK", beside_a_kink, "refused: no-modes", "fine"),
    ),
    wanted={
        "GOES_ON": "whether what moves steadily goes on in the same way",
    },
)
