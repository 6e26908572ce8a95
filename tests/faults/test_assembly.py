"""What cannot be assembled is refused with the joint, the gap and the two bodies."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.multibody.assembly.assemble import assemble
from heuncli.multibody.mechanism.model import Mechanism
from tests.shared.drafted_loops import four_bar, slider_crank
from tests.shared.drafted_mechanisms import X, Y, Z, body, in_time, joint, scene, turned


def refusal(s: Mechanism) -> tuple[str, str]:
    with pytest.raises(SolveError) as caught:
        assemble(s)
    (problem,) = caught.value.problems
    return problem.code, str(problem)


def test_links_too_short_to_meet() -> None:
    code, text = refusal(four_bar(1.0, 1.0, 0.5, 3.0))
    assert code == "does-not-fit"
    assert "joint C (pin) cannot be assembled: its points on coupler and rocker remain 0.5 m from where" in text
    assert "near" in text


def test_a_crank_that_reaches_too_far() -> None:
    """Crank 0.1 down, guide 0.35 up, rod 0.3 between: 0.15 m short."""
    s = slider_crank(angle=np.radians(270))
    guide = joint("guide", "slide", "ground", (0, 0.35, 0), "piston", (0, 0, 0), X)
    t = scene(list(s.bodies), [*[again(s, j) for j in s.joints[:3]], guide])
    code, text = refusal(t)
    assert code == "does-not-fit"
    assert "0.15 m" in text


def again(s: Mechanism, j: Any) -> dict[str, Any]:
    names = ["ground" if i < 0 else s.bodies[i].name for i in (j.a, j.b)]
    return joint(j.name, j.kind, names[0], j.p, names[1], j.q, j.axis, angle=j.angle)


def test_two_held_positions_that_contradict() -> None:
    s = scene(
        [body("a", position=(0, 0, 0), rotation=np.eye(3)), body("b", position=(1, 0, 0.25), rotation=np.eye(3))],
        [joint("j", "ball", "a", (1, 0, 0), "b", (0, 0, 0))],
    )
    code, text = refusal(s)
    assert code == "held-conflict"
    assert (
        "joint j (ball): its points on a and b remain 0.25 m from where the joint requires them; both are prescribed"
        in text
    )
    assert "leave out the position of one of them" in text


def test_two_held_attitudes_that_contradict() -> None:
    code, text = refusal(
        scene([body("a", rotation=turned(X, 30))], [joint("j", "pin", "ground", (0, 0, 0), "a", (0, 0, 0), Z)])
    )
    assert code == "held-conflict"
    assert "joint j (pin): ground and a remain misaligned by 30 deg; both are prescribed" in text


def test_a_held_attitude_against_an_initial_angle_and_a_drive() -> None:
    for given, hint in (({"angle": 0.5}, "initial angle"), ({"drive": ("angle", in_time("0.5 + t"))}, "drive motor")):
        s = scene(
            [body("a", rotation=turned(Z, 10))], [joint("j", "pin", "ground", (0, 0, 0), "a", (0, 0, 0), Z, **given)]
        )
        code, text = refusal(s)
        assert code == "held-conflict"
        assert "misaligned by 18.6 deg" in text
        assert hint in text


@pytest.mark.parametrize(
    ("kind", "given", "said"),
    [
        (
            "pin",
            {"angle": 0.5, "drive": ("angle", in_time("t"))},
            "initial angle 0.5 rad contradicts drive motor, which requires 0 rad",
        ),
        (
            "pin",
            {"rate": 0.5, "drive": ("angle", in_time("2*t"))},
            "initial rate 0.5 rad/s contradicts drive motor, which requires 2 rad/s",
        ),
        (
            "slide",
            {"travel": 0.1, "drive": ("travel", in_time("0.2 - t"))},
            "initial travel 0.1 m contradicts drive motor",
        ),
        (
            "cylinder",
            {"speed": 3.0, "drive": ("travel", in_time("t**2"))},
            "initial speed 3 m/s contradicts drive motor",
        ),
        (
            "pin",
            {"drive": ("angle", in_time("0.3 + t"), True)},
            "angle 0.3 rad at the start, where it is zero by definition",
        ),
        (
            "pin",
            {"angle": 0.3, "to_axis": (0, 0, 1)},
            "angle 0.3 rad at the start, where it is zero by definition",
        ),
    ],
)
def test_initial_values_against_drives(kind: str, given: dict[str, Any], said: str) -> None:
    code, text = refusal(scene([body("a")], [joint("j", kind, "ground", (0, 0, 0), "a", (0, 0, 0), Z, **given)]))
    assert code == "held-conflict"
    assert said in text


def test_initial_values_that_agree_with_a_drive_are_taken() -> None:
    given = {"angle": 0.5 + 2 * np.pi, "rate": 2.0, "drive": ("angle", in_time("0.5 + sin(2*t)"))}
    a = assemble(scene([body("a")], [joint("j", "pin", "ground", (0, 0, 0), "a", (0, 0, 0), Y, **given)]))
    assert a.rotation[0] == pytest.approx(turned(Y, np.degrees(0.5)), abs=1e-15)
    assert a.angular_velocity[0] == pytest.approx([0, 2, 0], abs=1e-15)


def test_all_conflicts_are_told_at_once() -> None:
    drives = {"drive": ("angle", in_time("t"))}
    joints = [
        joint(f"j{i}", "pin", "ground", (0, 0, 0), f"b{i}", (0, 0, 0), Z, angle=1.0, rate=5.0, **drives)
        for i in range(2)
    ]
    with pytest.raises(SolveError) as caught:
        assemble(scene([body("b0"), body("b1")], joints))
    assert len(caught.value.problems) == 4


def test_a_drive_that_cannot_be_computed_at_the_start() -> None:
    given = {"drive": ("angle", in_time("sqrt(t)"))}  # its rate at 0 is infinite
    code, text = refusal(scene([body("a")], [joint("j", "pin", "ground", (0, 0, 0), "a", (0, 0, 0), Z, **given)]))
    assert code == "not-computable"
    assert "drive motor: angle 'sqrt(t)'" in text


def test_a_drive_counted_from_the_assembled_start_holds_no_angle() -> None:
    R = turned(Z, 40)
    given = {"drive": ("angle", in_time("3*t"), True)}
    a = assemble(scene([body("a", rotation=R)], [joint("j", "pin", "ground", (0, 0, 0), "a", (0, 0, 0), Z, **given)]))
    assert np.all(a.rotation[0] == R)
    assert a.angular_velocity[0] == pytest.approx([0, 0, 3], abs=1e-15)


def test_rods_need_a_length() -> None:
    for given in ({}, {"length": 0.0}, {"drive": ("length", in_time("-0.1 + t"))}):
        code, text = refusal(scene([body("a")], [joint("j", "rod", "ground", (0, 0, 0), "a", (0, 0, 0), **given)]))
        assert code == "no-length"
        assert "joint j (rod)" in text


def test_held_rates_that_contradict() -> None:
    s = scene(
        [
            body("a", velocity=(0, 0, 0), angular_velocity=(0, 0, 1)),
            body("b", velocity=(0, 0, 0), angular_velocity=(0, 0, 0)),
        ],
        [joint("j", "ball", "a", (2, 0, 0), "b", (2, 0, 0))],
    )
    code, text = refusal(s)
    assert code == "rates-do-not-fit"
    assert "joint j (ball): the start velocities of a and b are incompatible at the joint by 2 m/s" in text


def test_a_spin_that_a_pin_cannot_have() -> None:
    s = scene([body("a", angular_velocity=(0.5, 0, 1))], [joint("j", "pin", "ground", (0, 0, 0), "a", (0, 0, 0), Z)])
    code, text = refusal(s)
    assert code == "rates-do-not-fit"
    assert "0.5 rad/s" in text
