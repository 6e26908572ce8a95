"""Counterweights of least squares against closed forms: Berkof and Lowen's, a rotor's two planes, the half balance."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heuncli.analyses.balancing.results import BalanceOptions, BalanceResults, Counterbalance, WeightRequest
from heuncli.analyses.balancing.study import balance
from heuncli.scene.file_format.load import load
from tests.shared.cycling import RPM, Cylinder, balance_of, engine, four_bar

SPECS = Path(__file__).parents[2] / "specs"
DIGITS = 1e-12


def weights(found: BalanceResults) -> Counterbalance:
    assert found.counterbalance is not None
    return found.counterbalance


def crank_weight(scene: dict[str, Any], **asked: Any) -> Counterbalance:
    return weights(balance_of(scene, weights=(WeightRequest("crank", "main", None),), **asked))


def test_half_of_what_goes_to_and_fro_and_all_that_turns() -> None:
    """The slider-crank: 0.9 r turns, 1.9 r goes to and fro, of which half is taken."""
    asked = BalanceOptions(weights=(WeightRequest("crank", "main", None),))
    found = weights(balance(load(str(SPECS / "slider_crank.yaml"), checking=False), asked))
    [one] = found.weights
    assert one.product == pytest.approx(0.185, rel=DIGITS) and abs(one.angle) == pytest.approx(math.pi, rel=DIGITS)
    assert one.mass == pytest.approx(1.85, rel=DIGITS) and one.radius == 0.1
    assert found.loads_without["force"].rms == pytest.approx(2130.181965585094, rel=DIGITS)
    assert found.loads_with["force"].rms == pytest.approx(1056.018563522430, rel=DIGITS)
    left = found.orders["force"][0]
    assert left.with_turn == 0.0 and left.against_turn == pytest.approx(950.0, rel=DIGITS)


@pytest.mark.parametrize("ratio", [0.2, 0.25, 0.3])
def test_a_single_cylinder_takes_half_whatever_its_rod(ratio: float) -> None:
    scene = engine([Cylinder(0.0)], 0.05, 0.05 / ratio)
    found = crank_weight(scene)
    [one] = found.weights
    assert one.product == pytest.approx(0.5 * 2.0 * 0.05, rel=1e-11) and abs(one.angle) == pytest.approx(math.pi)
    if ratio == 0.25:
        scale = 2.0 * 0.05 * (2000.0 * RPM) ** 2
        before, after = found.loads_without["force"], found.loads_with["force"]
        assert before.rms is not None and after.rms is not None and after.peak is not None and before.peak is not None
        assert before.rms / scale == pytest.approx(0.7295702578, abs=1e-10)
        assert after.rms / scale == pytest.approx(0.5312934793, abs=1e-10)
        assert before.peak / scale == pytest.approx(1.25, rel=DIGITS)
        assert after.peak / scale == pytest.approx(0.75, rel=1e-10)


def test_a_v_twin_is_rid_of_its_first_order() -> None:
    found = crank_weight(engine([Cylinder(0.0, bank=45.0), Cylinder(0.0, bank=-45.0)]))
    assert found.weights[0].product == pytest.approx(0.1, rel=1e-11)
    assert found.orders["force"][0].verdict == "cancels"


def berkof_lowen(scene: dict[str, Any]) -> tuple[complex, complex]:
    """Mass times radius on crank and rocker, complex in their axes, that hold the common centre of mass."""
    (m1, s1), (m2, s2), (m3, s3) = (
        (body["mass"], complex(*body["center"][:2])) for body in scene["bodies"].values()
    )  # fmt: skip
    a, b, c = (
        scene["bodies"][name]["points"][end][0] for name, end in (("crank", "B"), ("coupler", "C"), ("rocker", "C"))
    )  # fmt: skip
    return -(m1 * s1 + m2 * a * (1.0 - s2 / b)), -(m3 * s3 + m2 * c / b * s2)


@pytest.mark.parametrize("seed", range(4))
def test_any_four_bar_is_balanced_in_force_by_two(seed: int) -> None:
    scene = four_bar(np.random.default_rng(seed))
    asked = WeightRequest("crank", "A", None), WeightRequest("rocker", "D", None)
    found = balance_of(scene, weights=asked)
    own = weights(found)
    for weight, wanted in zip(own.weights, berkof_lowen(scene), strict=True):
        assert complex(*weight.vector[:2]) == pytest.approx(wanted, rel=1e-11)
    before, after = own.loads_without["force"].rms, own.loads_with["force"].rms
    assert before is not None and after is not None and after < 1e-11 * before
    assert all(row.verdict != "remains" for row in own.orders["force"])
    assert own.loads_with["moment"].rms != pytest.approx(own.loads_without["moment"].rms, rel=1e-3)  # the price is told


ROTOR = """\
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  rotor:
    shapes:
      - {{type: cylinder, from: [0, 0, 0], to: [0, 0, 0.6], radius: 0.05, mass: 10}}
      - {{type: point, at: [0.05, 0, 0.1], mass: 0.2}}
      - {{type: point, at: [{x2!r}, {y2!r}, 0.3], mass: 0.4}}
      - {{type: point, at: [{x3!r}, {y3!r}, 0.45], mass: 0.3}}
    points: {{main: [0, 0, 0], one: [0, 0, 0.05], two: [0.03, 0.01, 0.5]}}
joints:
  main: {{type: pin, from: ground.O, to: rotor.main, axis: [0, 0, 1]}}
drives:
  motor: {{joint: main, angle: 10*t}}
"""


def test_two_planes_of_a_rotor() -> None:
    """Unbalances of .010, .020 and .015 kg m at 0, 120 and 210 degrees in three planes, taken up in two others."""
    at = {f"{letter}{k}": 0.05 * f(math.radians(angle)) for k, angle in ((2, 120.0), (3, 210.0))
          for letter, f in (("x", math.cos), ("y", math.sin))}  # fmt: skip
    places = WeightRequest("rotor", "one", 0.05), WeightRequest("rotor", "two", 0.05)
    found = balance_of(ROTOR.format(**at), weights=places)
    own = weights(found)
    assert own.objective == "mix" and not own.several
    for weight, product, angle in zip(
        own.weights, (0.007492003169567319, 0.01626233208448715), (-113.61379224224, -10.47227852417), strict=True
    ):
        assert weight.product == pytest.approx(product, rel=1e-12)
        assert math.degrees(weight.angle) == pytest.approx(angle, abs=1e-10)
        assert weight.mass == pytest.approx(product / 0.05, rel=1e-12)
    assert found.residual["force"].rms == pytest.approx(0.01628472839394837 * 100.0, rel=1e-12)
    assert found.residual["moment"].rms == pytest.approx(0.00805426328405709 * 100.0, rel=1e-12)
    for name in ("force", "moment"):
        after = own.loads_with[name].rms
        assert after is not None and after < 1e-13 * 100.0
    same = weights(balance_of(ROTOR.format(**at), weights=places, minimise="force"))
    assert same.several  # of the force alone the planes serve as well as each other


def test_lanchester_takes_the_second_order_of_a_four() -> None:
    """Two shafts at twice the rate, one each way, each with m r A2/2: order 2 is gone, 4 and 6 stay."""
    scene = engine([Cylinder(throw, 0.2 * (i - 1.5)) for i, throw in enumerate((0, 180, 180, 0))])
    rate, U = 2000.0 * RPM, 0.01270125211534876
    wheels = {}
    for name, sign in (("plus", 1), ("minus", -1)):
        scene["bodies"][name] = {"mass": 0.5, "center": [-2.0 * U / 0.5 / 2.0, 0, 0], "inertia": [1e-3, 1e-3, 1e-3],
                                 "points": {"c": [0, 0, 0]}}  # fmt: skip
        scene["joints"][name] = {"type": "pin", "from": "ground.O", "to": f"{name}.c", "axis": [0, 0, 1]}
        wheels[name] = {"joint": name, "angle": f"{2 * sign * rate!r}*t"}
    found = balance_of(scene | {"drives": scene["drives"] | wheels}, cycle="main")
    second = next(row for row in found.orders["force"] if row.order == 2)
    fourth = next(row for row in found.orders["force"] if row.order == 4)
    assert second.verdict == "cancels" and fourth.size == pytest.approx(71.90530855042, rel=1e-9)
