"""The oracle against published mechanisms: manual/references.md, A02, A03, A04, whirling and skew rod."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracle.motion import motion
from tests.oracle.published import END, END_RATES, PINS, START, andrews, at_the_end, bricard, windows
from tests.oracle.read import start_state
from tests.oracle.rows import gaps
from tests.oracle.solve import Solution, solve
from tests.oracle.weld import section
from tests.shared.published import printed_values

X = np.eye(3)[0]
PRINTED = printed_values("andrews")


# ---- A03, Andrews' squeezer
def accelerations_of(found: Solution) -> dict[str, float]:
    spin = {name: a[2] for name, a in found.angular_acceleration.items()}
    return {
        "b": spin["K1"],
        "Th": spin["K2"] - spin["K1"],
        "g": spin["K3"],
        "Ph": spin["K4"] - spin["K5"],
        "de": spin["K5"],
        "Om": spin["K6"] - spin["K7"],
        "ep": spin["K7"],
    }


def open_gap(s: dict) -> float:
    return max(abs(g).max() for g in gaps(s, start_state(s)).values())


def test_andrews_start() -> None:
    s = andrews(START, dict.fromkeys(START, 0.0))
    assert open_gap(s) < 1e-15
    found = solve(s, start_state(s))
    a = accelerations_of(found)
    for name, pin in (("b", "O"), ("Th", "F")):
        assert a[name] == pytest.approx(PRINTED[f"coordinates.{pin}.acceleration", 0.0], rel=1e-11)
    assert max(abs(a[k]) for k in ("g", "Ph", "de", "Om", "ep")) < 1e-8 * abs(a["b"])
    for name in PINS.values():
        reaction = found.reactions[name]
        assert reaction.unique[:2].all() and not reaction.unique[2]
        wanted = [PRINTED.get((f"joints.{name}.force.{axis}", 0.0), 0.0) for axis in "xy"]
        if name != "A7":  # nothing but the crank and its neighbours is moved at the start
            np.testing.assert_allclose(reaction.force[:2], wanted, rtol=0, atol=6e-9)


def test_andrews_end() -> None:
    """At the published state of t = 0.03: pin forces, and the published accelerations and multipliers.

    Those two are good to 1e-7 of their largest: the published rates leave the loops opening at 7e-10 m/s.
    """
    s = andrews(END, END_RATES)
    assert open_gap(s) < 1e-13
    found = solve(s, start_state(s))
    a, wanted = accelerations_of(found), at_the_end("acceleration")
    for name, value in wanted.items():
        assert a[name] == pytest.approx(value, abs=1.1e-7 * max(wanted.values()))
    for name in ("O", "F", "B", "E2", "A5", "G", "H"):
        force = [PRINTED[f"joints.{name}.force.{axis}", 0.03] for axis in "xy"]
        np.testing.assert_allclose(found.reactions[name].force[:2], force, rtol=0, atol=6e-7)
    for name in ("E4", "E6"):  # multipliers: here of K4 and K6 on K3
        force = [-PRINTED[f"joints.{name}.force.{axis}", 0.03] for axis in "xy"]
        np.testing.assert_allclose(found.reactions[name].force[:2], force, rtol=0, atol=1.1e-7 * 244.88)


# ---- A02, N-four-bar
def top_of_the_first_bar(t: float) -> list[list[float]]:
    """Its place and velocity by the closed motion."""
    printed = printed_values("windows", "formula")
    return [[printed[f"points.bar0.end.{what}.{axis}", t] for axis in "xy"] for what in ("position", "velocity")]


def test_two_windows_upright() -> None:
    s = windows(2, 0.0, 1.0)
    found = solve(s, start_state(s))
    assert (found.rows - found.rank, found.freedoms) == (6, 1)  # three redundant a loop
    for name, force in {"G0": (0, 13.715), "G1": (0, 18.12), "G2": (0, 13.715)}.items():
        np.testing.assert_allclose(-found.reactions[name].force[:2], force, rtol=0, atol=1e-13)
    for name in ("left0", "right0", "left1", "right1"):
        np.testing.assert_allclose(found.reactions[name].force[:2], (0, 4.405), rtol=0, atol=1e-13)
        assert found.reactions[name].unique[:3].tolist() == [True, True, False]
    assert found.foundation_force[1] == pytest.approx(-45.55, rel=1e-14)


def test_two_windows_at_half_a_second() -> None:
    """In the closed motion's state: from B0's printed place and speed."""
    place, speed = (np.array(of) for of in top_of_the_first_bar(0.5))
    s = windows(2, float(np.arctan2(*place)), float(np.linalg.norm(speed)))
    found = solve(s, start_state(s))
    assert -found.angular_acceleration["bar0"][2] == pytest.approx(11.445 * place[0], rel=1e-12)  # I th'' = G sin th
    outer, inner = (0.8112759, 3.8361331), (0.2942763, 3.3016997)
    for name, force in {"G0": outer, "G1": inner, "G2": outer}.items():
        np.testing.assert_allclose(-found.reactions[name].force[:2], force, rtol=0, atol=6e-8)
    np.testing.assert_allclose(found.reactions["left0"].force[:2], (0.5374433, -0.5344334), rtol=0, atol=6e-8)
    np.testing.assert_allclose(found.reactions["right0"].force[:2], (0.0102219, -0.5344334), rtol=0, atol=6e-8)


def test_two_windows_move() -> None:
    s = windows(2, 0.0, 1.0)
    state = motion(s, start_state(s), [0.0, 0.25, 0.5])[-1]["bar0"]
    place, speed = top_of_the_first_bar(0.5)
    np.testing.assert_allclose(state.point(X)[:2], place, rtol=0, atol=1e-11)
    np.testing.assert_allclose(state.speed(X)[:2], speed, rtol=0, atol=1e-10)


# ---- A04, Bricard
def test_bricard() -> None:
    s = bricard()
    found = solve(s, start_state(s))
    assert (found.rows, found.rank, found.freedoms, found.grubler) == (30, 29, 1, 0)
    printed = printed_values("bricard")
    crank = found.angular_acceleration["rod1"][1]
    assert crank == pytest.approx(printed["coordinates.P0.acceleration", 0.0], abs=6e-8)
    for what, own in (("force", found.foundation_force), ("moment", found.foundation_moment)):
        wanted = [printed[f"foundation.{what}.{axis}", 0.0] for axis in "xyz"]
        np.testing.assert_allclose(own, wanted, rtol=0, atol=6e-7)


def test_bricard_self_stress() -> None:
    s = bricard()
    found = solve(s, start_state(s))
    forces = {f"P{k}": (1, 1, 1) for k in range(5)} | {"P5": (-1, -1, -1)}
    moments = {
        "P0": (-1, 0, 1),
        "P1": (-1, 1, 0),
        "P2": (0, 1, -1),
        "P3": (1, 0, -1),
        "P4": (1, -1, 0),
        "P5": (0, 1, -1),
    }
    scale = found.reactions["P0"].share[0, 0]
    for name, reaction in found.reactions.items():
        np.testing.assert_allclose(reaction.share[:3, 0] / scale, forces[name], rtol=0, atol=1e-13)
        np.testing.assert_allclose(reaction.share[3:6, 0] / scale, moments[name], rtol=0, atol=1e-13)
        assert not reaction.unique[:3].any()
    xy = found.sum({"joints.P0.force.x": 1, "joints.P0.force.y": -1})
    yz = found.sum({"joints.P0.force.y": 1, "joints.P0.force.z": -1})
    np.testing.assert_allclose((xy[0], yz[0]), (-33.023084, 31.711168), rtol=0, atol=6e-7)
    assert xy[1] and yz[1]
    assert not found.sum({f"joints.P0.force.{c}": 1 for c in "xyz"})[1]


# ---- textbook bars
def turning_rod(spin: float, push: float) -> dict:
    """m = 2, L = 1.5 about its end, with the couple that gives it the angular acceleration `push`."""
    return {
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {
            "rod": {
                "shapes": [{"type": "rod", "from": [0, 0, 0], "to": [1.5, 0, 0], "mass": 2.0}],
                "points": {"root": [0, 0, 0]},
                "angular_velocity": [0, 0, spin],
            }
        },
        "joints": {"hub": {"type": "pin", "from": "ground.O", "to": "rod.root", "axis": [0, 0, 1]}},
        "forces": {"motor": {"type": "torque", "joint": "hub", "value": push * 2.0 * 1.5**2 / 3}},
    }


@pytest.mark.parametrize(("r", "N", "V", "M"), [(0.0, 150, 7.5, 7.5), (0.75, 112.5, 5.625, 2.34375)])
def test_whirling_rod(r: float, N: float, V: float, M: float) -> None:
    """V and M as what the outer part exerts on the inner: against the acceleration."""
    s = turning_rod(10.0, 5.0)
    cut = section(s, start_state(s), 0.0, "rod", [r, 0, 0], [1, 0, 0], side="beyond")
    np.testing.assert_allclose(cut.force, [N, -V, 0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(cut.moment, [0, 0, -M], rtol=0, atol=1e-12)


@pytest.mark.parametrize(("s_over_h", "M", "N"), [(0.0, 8.11898816, 9.375), (0.5, 2.53718380, None)])
def test_skew_rod_sections(s_over_h: float, M: float, N: float | None) -> None:
    m, L, spin, slant = 2.0, 1.5, 10.0, np.radians(30)
    along = np.array([np.sin(slant), 0, np.cos(slant)])
    half = L / 2 * along
    s = {
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {
            "rod": {
                "shapes": [{"type": "rod", "from": list(-half), "to": list(half), "mass": m}],
                "points": {"O": [0, 0, 0]},
                "angular_velocity": [0, 0, spin],
            }
        },
        "joints": {"shaft": {"type": "pin", "from": "ground.O", "to": "rod.O", "axis": [0, 0, 1]}},
    }
    cut = section(s, start_state(s), 0.0, "rod", s_over_h * L / 2 * along, along, side="beyond")
    assert np.linalg.norm(solve(s, start_state(s)).foundation_moment) == pytest.approx(16.23797632, abs=6e-9)
    assert np.linalg.norm(cut.moment) == pytest.approx(M, abs=6e-9)
    if N is not None:
        assert cut.force @ along == pytest.approx(N, rel=1e-13)
