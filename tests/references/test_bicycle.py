"""The benchmark bicycle: Meijaard, Papadopoulos, Ruina, Schwab, Proc. R. Soc. A 463 (2007) 1955-1982.

Parameters of table 1, eigenvalues of the upright run of table 2, as printed. There z points down.
"""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.analyses.modes.study import compute_spec_modes
from heuncli.base.errors import SolveError
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from tests.shared.scenes import study

W, C, TILT = 1.02, 0.08, np.pi / 10
UP = np.diag([1.0, -1.0, -1.0])
FRAME = np.array([[9.2, 0, 2.4], [0, 11, 0], [2.4, 0, 2.8]])
FORK = np.array([[0.05892, 0, -0.00756], [0, 0.06, 0], [-0.00756, 0, 0.00708]])
# speed [m/s]: eigenvalues [1/s] but for those that are zero
PRINTED = {
    0.0: (5.53094371765393, 3.13164324790656, -3.13164324790656, -5.53094371765393),
    5.0: (-0.77534188219585 + 4.46486771378823j, -0.32286642900409, -14.07838969279822),
}


def bicycle(speed: float) -> str:
    """The spec of the bicycle, upright and straight on."""
    axis = (UP @ np.array([-np.sin(TILT), 0, -np.cos(TILT)])).tolist()
    head = [W + C, 0, 0]

    def upright(inertia: Array) -> list[list[float]]:
        return (UP @ inertia @ UP).tolist()  # type: ignore[no-any-return]

    return f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  rear: {{mass: 2, center: [0, 0, 0.3], inertia: [0.0603, 0.12, 0.0603], points: {{c: [0, 0, 0.3]}}}}
  frame: {{mass: 85, center: [0.3, 0, 0.9], inertia: {upright(FRAME)}, points: {{r: [0, 0, 0.3], s: {head}}},
          position: [0, 0, 0], velocity: [{speed}, 0, 0], angular_velocity: [0, 0, 0]}}
  fork: {{mass: 4, center: [0.9, 0, 0.7], inertia: {upright(FORK)}, points: {{s: {head}, f: [{W}, 0, 0.35]}}}}
  front: {{mass: 3, center: [{W}, 0, 0.35], inertia: [0.1405, 0.28, 0.1405], points: {{c: [{W}, 0, 0.35]}}}}
joints:
  hub_r: {{type: pin, from: frame.r, to: rear.c, axis: [0, 1, 0]}}
  head: {{type: pin, from: frame.s, to: fork.s, axis: {axis}, initial: {{angle: 0, rate: 0}}}}
  hub_f: {{type: pin, from: fork.f, to: front.c, axis: [0, 1, 0]}}
rolling:
  r: {{wheel: rear.c, axis: [0, 1, 0], radius: 0.3, on: ground.O, normal: [0, 0, 1]}}
  f: {{wheel: front.c, axis: [0, 1, 0], radius: 0.35, on: ground.O, normal: [0, 0, 1]}}
analysis: {{duration: 1, samples: 2}}
"""


@pytest.mark.parametrize("speed", PRINTED)
def test_eigenvalues(speed: float) -> None:
    """Thirteen digits are printed after the point; heun's own error is told beside each."""
    found = [mode for mode in compute_spec_modes(load("bicycle.yaml", bicycle(speed))).modes if mode.kind != "free"]
    printed = list(PRINTED[speed])
    assert len(found) == len(printed)
    for value in printed:
        nearest = min(found, key=lambda mode: abs(mode.eigenvalue - value))
        assert abs(nearest.eigenvalue - value) <= max(nearest.error, 2e-14 * abs(value))


@pytest.mark.heavy
def test_freedoms_of_pose_and_of_speed() -> None:
    """Seven and three, as the paper counts them."""
    model = study(bicycle(5.0)).results.model
    assert (model["pose_freedoms"], model["freedoms"]) == (7, 3)


def test_a_leaning_bicycle_is_no_steady_motion() -> None:
    """It has no modes, and says so."""
    text = bicycle(5.0).replace("position: [0, 0, 0],", "orientation: {axis: [1, 0, 0], angle: 0.1},")
    with pytest.raises(SolveError, match="not-at-rest"):
        compute_spec_modes(load("bicycle.yaml", text.replace(", initial: {angle: 0, rate: 0}", "")))
