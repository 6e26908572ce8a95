"""Small oscillations: what is free, at rest, and where a law has a slope."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from heuncli.analyses.modes.study import compute_spec_modes
from heuncli.base import tolerances
from heuncli.base.errors import HeunError
from heuncli.motion.linearisation.indifference import Indifference, IndifferentMotions, find_indifference
from heuncli.motion.linearisation.linearise import linearise
from heuncli.motion.linearisation.oscillations import Mode, find_modes
from heuncli.motion.linearisation.reduced_equations import ReducedEquations
from heuncli.motion.linearisation.steady_motion import find_distance_from_rest
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from tests.honesty.boundaries.part import Part, Row
from tests.shared.scenes import near, solved


def turning_force(x: float) -> str:
    """Two motions of stiffness 1, and a force 4 x across each displacement: whether they grow."""
    K, f, none = np.array([[1.0, 4.0 * x], [-4.0 * x, 1.0]]), np.zeros((2, 2)), np.zeros((2, 0))
    system = ReducedEquations(np.eye(2), f, np.eye(2), f, -K, f, np.zeros(2), 0.0, 0.0)
    return max(
        find_modes(system, IndifferentMotions(none, none, 0.0, np.linalg.inv(K), np.eye(2), K, f)), key=growth
    ).kind


def growth(mode: Mode) -> float:
    return mode.growth


def beside_its_rounding(x: float) -> str:
    """Two carts on a spring, of which one is held by x times what rounding makes of that: as rest and modes tell it."""
    found = indifference_of(carts(0.0)).elimination
    unit = float(found.null_errors.max() / found.K[0, 0]) * 3.0 / tolerances.REAL_STIFFNESS_FACTOR
    text = carts(x * unit)
    free = any(mode.kind == "free" for mode in compute_spec_modes(load("scene.yaml", text)).modes)
    told = any("indifferent" in sentence for sentence in solved(text).model["rest"])
    assert free == told
    return "indifferent" if told else "held"


def carts(k: float) -> str:
    """Of 1 kg, in line, on a spring of 3 N/m between them; the first is held by k N/m, both are together."""
    mass = "mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}"
    slide = "type: slide, axis: [1, 0, 0]"
    return f"""
heun: 1
ground: {{points: {{O: [0, 0, 0], A: [0.7, 0, 0]}}}}
bodies: {{a: {{{mass}}}, b: {{{mass}, position: [0.7, 0, 0]}}}}
joints: {{u: {{{slide}, from: ground.O, to: a.c}}, v: {{{slide}, from: ground.A, to: b.c}}}}
forces:
  s: {{type: spring, from: a.c, to: b.c, stiffness: 3, length: 0.7}}
  h: {{type: torque, joint: u, value: "-{k!r}*u.travel"}}
analysis: {{type: rest}}
"""


def indifference_of(text: str) -> Indifference:
    """What of a scene at rest nothing holds."""
    setup = set_up(load("scene.yaml", text), reduce=False)
    layout = setup.scene.layout
    return find_indifference(setup.scene, 0.0, np.zeros(0), linearise(layout, 0.0, layout.y0))


def pushed_freely(x: float) -> str:
    """What nothing holds, pushed by x of the loads there."""
    f, one = np.zeros((1, 1)), np.eye(1)
    system = ReducedEquations(one, f, one, f, f, f, np.array([x]), 1.0, 0.0)
    here = SimpleNamespace(
        system=system, weights=np.ones(1), indifferent=IndifferentMotions(one, one, 0.0, f, one, f, f)
    )
    return "falls" if np.isinf(find_distance_from_rest(here)) else "rests"  # type: ignore[arg-type]


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
        found = compute_spec_modes(load("scene.yaml", text))
    except HeunError as error:
        return f"refused: {error.problems[0].code}"
    near(2.0 * np.pi * found.modes[0].frequency, np.sqrt(9.81), 1.0, 1e-12)
    return "fine"


def beside_a_kink(x: float) -> str:
    """The same at rest, with a torque that begins beyond an angle of x."""
    return hanging(0.0, f"max(0, pivot.angle - {x!r})")


def beside_a_bend(x: float) -> str:
    """The same with a weak torque whose slope is less by x of itself some 1e-10 beside the pose: a root, or smooth."""
    width = 0.05 * tolerances.KINK
    return hanging(0.0, f"-1e-14*(pivot.angle + {x / (1.0 - x)!r}*{width!r}*tanh(pivot.angle/{width!r}))")


PART = Part(
    ("small oscillations",),
    rows=(
        Row("REAL_STIFFNESS_FACTOR", beside_its_rounding, "indifferent", "held"),
        Row("EIGENVALUE", turning_force, "oscillation", "flutter"),
        Row("FREELY_PUSHED", pushed_freely, "rests", "falls"),
        Row("OFF_BALANCE", hanging, "fine", "refused: not-at-rest"),
        Row("KINK", beside_a_kink, "refused: no-modes", "fine"),
        Row("STEEP", beside_a_bend, "fine", "refused: no-modes"),
    ),
    wanted={
        "STEADY_CHANGE": "whether what moves steadily goes on in the same way",
    },
)
