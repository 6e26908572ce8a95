"""The oracle against manual/theory.md, "Closed cases", by number, to the digits printed there (g = 9.81)."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracle.motion import motion
from tests.oracle.read import start_state
from tests.oracle.rows import gaps, rates
from tests.oracle.solve import Solution, solve
from tests.oracle.theory_scenes import G, X, Y, Z, bar, golden_a, scene, slider_crank
from tests.oracle.turns import Array, about
from tests.oracle.weld import section


def close(a: object, b: object, tolerance: float = 1e-12) -> None:
    """To `tolerance` of the largest entry expected (of one where all are zero)."""
    b = np.asarray(b, dtype=float)
    np.testing.assert_allclose(np.asarray(a), b, rtol=0, atol=tolerance * (np.abs(b).max() or 1.0))


def solved(s: dict, fits: float = 1e-13) -> Solution:
    """The solution in the scene's own state, which must fit its joints."""
    state = start_state(s)
    assert max((abs(g).max() for g in gaps(s, state).values() if len(g)), default=0.0) <= fits
    assert max((abs(r).max() for r in rates(s, state).values() if len(r)), default=0.0) <= fits * 100
    found = solve(s, state)
    assert found.residual <= 1e-12 and found.unbalanced <= 1e-12
    return found


def test_1_free_top() -> None:
    s = scene({"top": {"mass": 1.0, "center": [0, 0, 0], "inertia": [1, 2, 3], "angular_velocity": [0.9, 0, 1.1]}}, {})
    states = motion(s, start_state(s), [0.0, 1.0, 6.078117841793404])
    spins = [x["top"].rotation.T @ x["top"].angular_velocity for x in states]
    close(spins[1], [0.4389935957999769, 0.7856746291223909, 1.002116988704977], 1e-12)
    close(spins[2], spins[0], 1e-11)


def test_2_heavy_top() -> None:
    lever = 1 / G
    R = about(X, np.pi / 3)
    s = scene(
        {
            "top": {
                "mass": 1.0,
                "center": [0, 0, lever],
                "inertia": [1 - lever**2, 1 - lever**2, 0.5],
                "points": {"tip": [0, 0, 0]},
                "orientation": {"matrix": R.tolist()},
                "angular_velocity": {"vector": [0, 0, 8.0], "frame": "body"},
            }
        },
        {"tip": {"type": "ball", "from": "ground.O", "to": "top.tip"}},
        -G * Z,
    )
    period = 1.660594261039426
    states = motion(s, start_state(s), [0.0, period / 2, 1.0, period])
    high = [x["top"].rotation[2, 2] for x in states]
    close(high, [0.5, 0.3944487245360107, 0.4050295921774855, 0.5], 1e-12)
    tip = states[-1]["top"].rotation[:, 2]
    start = states[0]["top"].rotation[:, 2]
    turned = np.arctan2(start[0] * tip[1] - start[1] * tip[0], start[:2] @ tip[:2])
    close(turned, 0.4259411370822, 1e-11)


@pytest.mark.parametrize(
    ("degrees", "period"), [(10, 2.009892627298601), (90, 2.367841947576237), (170, 4.893524274105486)]
)
def test_3_pendulum_periods(degrees: float, period: float) -> None:
    R = about(Y, -np.radians(degrees))
    s = scene(
        {
            "bob": {
                "shapes": [{"type": "point", "at": [0, 0, -1], "mass": 1.0}],
                "points": {"top": [0, 0, 0]},
                "orientation": {"matrix": R.tolist()},
            }
        },
        {"hinge": {"type": "pin", "from": "ground.O", "to": "bob.top", "axis": [0, 1, 0]}},
        -G * Z,
    )
    states = motion(s, start_state(s), [0.0, period / 4, period / 2])
    close(states[1]["bob"].rotation @ -Z, -Z, 1e-11)
    close(states[2]["bob"].rotation @ -Z, about(Y, np.radians(degrees)) @ -Z, 1e-10)


def falling_rod(tilt: float) -> tuple[dict, Array, Array]:
    """A rod hung by its root, let go level, now at `tilt` from the vertical; its direction and that of growing tilt."""
    along, growing = np.array([np.sin(tilt), 0, -np.cos(tilt)]), np.array([np.cos(tilt), 0, np.sin(tilt)])
    R = np.column_stack([along, Y, np.cross(along, Y)])
    spin = -np.sqrt(3 * G * np.cos(tilt)) * Y
    hinge = {"type": "pin", "from": "ground.O", "to": "rod.root", "axis": [0, 1, 0]}
    return scene({"rod": bar(1.0, 1.0, R, spin)}, {"hinge": hinge}, -G * Z), along, growing


@pytest.mark.parametrize(
    ("tilt", "pull", "push"), [(60, 12.2625, -2.123927302781336), (0, 24.525, 0.0), (90, 0.0, -2.4525)]
)
def test_3_uniform_rod_let_go_level(tilt: float, pull: float, push: float) -> None:
    s, along, growing = falling_rod(np.radians(tilt))
    found = solved(s)
    close([found.foundation_force @ along, found.foundation_force @ growing], [pull, push], 1e-14)
    close(found.reactions["hinge"].force, -found.foundation_force, 1e-14)


@pytest.mark.parametrize(
    ("xi", "M", "Q", "N"),
    [
        (0.5, -4598.4375, -306.5625, -2769.277468078683),
        (0.1, -2979.7875, 772.5375, -5694.416468533943),
        (0.8, -1177.2, -343.35, -989.4248162327539),
        (1 / 3, -5450.0, 0.0, None),
    ],
)
def test_4_falling_chimney(xi: float, M: float, Q: float, N: float | None) -> None:
    """Foot up along body x, falling towards +x: M about the horizontal axis of the fall, Q along growing tilt."""
    tilt, L = np.radians(30), 30.0
    along, growing = np.array([np.sin(tilt), 0, np.cos(tilt)]), np.array([np.cos(tilt), 0, -np.sin(tilt)])
    R = np.column_stack([along, Y, np.cross(along, Y)])
    s = scene(
        {"rod": bar(L, 1000.0, R, np.sqrt(3 * G * (1 - np.cos(tilt)) / L) * Y)},
        {"foot": {"type": "pin", "from": "ground.O", "to": "rod.root", "axis": [0, 1, 0]}},
        -G * Z,
    )
    cut = section(s, start_state(s), 0.0, "rod", [xi * L, 0, 0], [1, 0, 0])
    close([cut.moment @ Y, cut.force @ growing], [M, Q], 1e-12)
    assert cut.unique.all()
    if N is not None:
        assert cut.force @ along == pytest.approx(N, rel=1e-14)


@pytest.mark.parametrize(("xi", "N"), [(0.0, 600.0), (0.5, 450.0), (1.0, 0.0)])
def test_5_whirling_rod(xi: float, N: float) -> None:
    s = scene(
        {"rod": bar(1.5, 2.0, np.eye(3), 20 * Z)},
        {"hub": {"type": "pin", "from": "ground.O", "to": "rod.root", "axis": [0, 0, 1]}},
    )
    cut = section(s, start_state(s), 0.0, "rod", [1.5 * xi, 0, 0], [1, 0, 0], side="beyond")
    close(cut.force, [N, 0, 0], 1e-12)


def test_8_two_rods_level_let_go() -> None:
    s = scene(
        {"inner": bar(1.0, 1.0, np.eye(3)), "outer": bar(1.0, 1.0, np.eye(3), at=X)},
        {
            "a": {"type": "pin", "from": "ground.O", "to": "inner.root", "axis": [0, 1, 0]},
            "b": {"type": "pin", "from": "inner.end", "to": "outer.root", "axis": [0, 1, 0]},
        },
        -G * Z,
    )
    found = solved(s)
    close([found.angular_acceleration[b] @ Y for b in ("inner", "outer")], np.array([9 / 7, -3 / 7]) * G, 1e-14)
    close([found.reactions[j].force[2] for j in "ab"], np.array([2 / 7, -1 / 14]) * G, 1e-14)


def test_9_skew_rod() -> None:
    m, L, slant, spin, span = 3.0, 0.8, np.radians(40), 50.0, 0.5
    D = m * L**2 / 12 * np.sin(slant) * np.cos(slant)
    assert abs(D - 0.07878462024097664) < 1e-16
    half = L / 2 * np.array([np.sin(slant), 0, np.cos(slant)])
    rod = {
        "shapes": [{"type": "rod", "from": list(-half), "to": list(half), "mass": m}],
        "points": {"low": [0, 0, -span / 2], "high": [0, 0, span / 2]},
        "angular_velocity": [0, 0, spin],
    }
    low, high = ({"body": "ground", "at": [0, 0, z]} for z in (-span / 2, span / 2))
    s = scene(
        {"rod": rod},
        {
            "low": {"type": "ball", "from": low, "to": "rod.low"},
            "high": {"type": "line", "from": high, "to": "rod.high", "axis": [0, 0, 1]},
        },
    )
    found = solved(s)
    close(np.linalg.norm(found.foundation_moment), 196.9615506024416, 1e-14)
    for name in ("low", "high"):
        assert np.linalg.norm(found.reactions[name].force) == pytest.approx(393.9231012048832, rel=1e-14)


@pytest.mark.parametrize(
    ("shape", "squares"),
    [("point", (0.585786437626905, 3.414213562373095)), ("rod", (0.7322131619446366, 5.267786838055363))],
)
def test_10_double_pendulum_frequencies(shape: str, squares: tuple[float, float]) -> None:
    def slopes(angles: Array) -> Array:
        bodies, at = {}, np.zeros(3)
        for name, angle in zip(("upper", "lower"), angles, strict=True):
            R = about(Y, np.pi / 2 - angle)
            bodies[name] = bar(1.0, 1.0, R, at=at)
            if shape == "point":
                bodies[name]["shapes"] = [{"type": "point", "at": [1, 0, 0], "mass": 1.0}]
            at = at + R @ X
        s = scene(
            bodies,
            {
                "a": {"type": "pin", "from": "ground.O", "to": "upper.root", "axis": [0, 1, 0]},
                "b": {"type": "pin", "from": "upper.end", "to": "lower.root", "axis": [0, 1, 0]},
            },
            -G * Z,
        )
        found = solved(s)
        return np.array([-found.angular_acceleration[b] @ Y for b in ("upper", "lower")])

    def middle(h: float) -> Array:
        return -np.column_stack([(slopes(h * e) - slopes(-h * e)) / (2 * h) for e in np.eye(2)]) / G

    h = 1e-3  # two central differences, extrapolated: error of order h⁴
    K = (4 * middle(h) - middle(2 * h)) / 3
    close(np.sort(np.linalg.eigvals(K).real), squares, 1e-10)


def test_11_conical_rod() -> None:
    tilt = np.radians(40)
    along = np.array([np.sin(tilt), 0, -np.cos(tilt)])
    s = scene(
        {"rod": bar(1.0, 1.0, np.column_stack([along, Y, np.cross(along, Y)]), 4.382815107043016 * Z)},
        {"top": {"type": "ball", "from": "ground.O", "to": "rod.root"}},
        -G * Z,
    )
    found = solved(s)
    close(found.angular_acceleration["rod"], np.zeros(3), 1e-13)
    assert found.loose.shape == (6, 1)  # the spin about the rod
    close(np.abs(found.loose[3:, 0]) / np.linalg.norm(found.loose), np.abs(along), 1e-13)


def test_12_driven_slider_crank() -> None:
    phi, omega = np.pi / 3, 100.0
    drive = (lambda t: phi + omega * t, lambda t: omega, lambda t: 0.0)
    s = slider_crank(phi, omega, drives={"motor": {"joint": "base", "angle": drive}})
    found = solved(s)
    state = start_state(s)
    assert state["rod"].angular_velocity[2] == pytest.approx(-17.40776559556978, rel=1e-14)
    assert state["slider"].position[0] == pytest.approx(0.3372281323269014, rel=1e-15)
    assert state["slider"].velocity[0] == pytest.approx(-10.1678107607332, rel=1e-14)
    assert found.angular_acceleration["rod"][2] == pytest.approx(2923.746371663162, rel=1e-13)
    assert found.acceleration["slider"][0] == pytest.approx(-333.8349647695612, rel=1e-13)
    close(found.reactions["base"].force[:2], (-1084.286433062166, -466.0281685288434), 1e-13)
    close(found.reactions["crankpin"].force[:2], (-834.2864330621662, -33.0154666366241), 1e-13)
    assert found.reactions["wrist"].force[0] == pytest.approx(-500.7524471543417, rel=1e-13)
    assert found.reactions["guide"].force[1] == pytest.approx(-313.3946948771514, rel=1e-13)
    assert found.reactions["base"].drive == pytest.approx(70.60055117462299, rel=1e-13)
    close(-found.foundation_force[:2], (-1084.286433062166, -779.4228634059948), 1e-13)
    for name in ("base", "crankpin", "wrist"):  # three rows of the loop are there twice, all out of plane
        assert found.reactions[name].unique[[0, 1, 6]].all() and not found.reactions[name].unique[2]
    assert found.rows - found.rank == 3


def test_12_free_slider_crank() -> None:
    s = slider_crank(1.0, 10.0, forces={"gas": {"type": "force", "on": "slider.pin", "vector": [1000.0, 0, 0]}})
    found = solved(s)
    assert found.angular_acceleration["crank"][2] == pytest.approx(-3892.65856532819, rel=1e-13)
    close(found.reactions["base"].force[:2], (21.38399818, -86.77295698), 1e-10)


def test_13_ladder() -> None:
    """Foot on the floor (z up), head on the wall; both hold both ways."""
    tilt, start = 0.9, 0.3
    rate = np.sqrt(3 * G * (np.cos(start) - np.cos(tilt)))
    foot, head = np.array([np.sin(tilt), 0, 0]), np.array([0, 0, np.cos(tilt)])
    along = head - foot
    s = scene(
        {
            "ladder": bar(
                1.0, 1.0, np.column_stack([along, Y, np.cross(along, Y)]), -rate * Y, foot, rate * np.cos(tilt) * X
            )
        },
        {
            "floor": {"type": "plane", "from": "ground.O", "to": "ladder.root", "normal": [0, 0, 1]},
            "wall": {"type": "plane", "from": "ground.O", "to": "ladder.end", "normal": [1, 0, 0]},
        },
        -G * Z,
    )
    found = solved(s)
    assert -found.angular_acceleration["ladder"] @ Y == pytest.approx(11.526655475168418, rel=1e-14)
    assert found.reactions["floor"].force[2] == pytest.approx(2.242836917183334, rel=1e-13)
    assert found.reactions["wall"].force[0] == pytest.approx(-0.2642086567283595, rel=1e-12)


def test_15_golden_a() -> None:
    found = solved(golden_a())
    close(found.angular_acceleration["first"], (-7.872973507783647, 5.758454792674423, -3.649496691017909), 1e-14)
    close(found.angular_acceleration["second"], (-2.073300609302811, -2.314982049943921, 10.2532687586563), 1e-13)
    close(-found.reactions["elbow"].force, (7.771627258333382, 3.538823485902244, -1.95601380076495), 1e-13)
    close(found.foundation_force, (11.339814615811722, 10.324495892808134, -13.40547852636314), 1e-13)
    close(found.foundation_moment, np.zeros(3), 1e-13)


def test_15_golden_a_energy_and_power() -> None:
    from tests.oracle.totals import kinetic_energy, power

    s = golden_a()
    assert kinetic_energy(s, start_state(s)) == pytest.approx(6.232248895944697, rel=1e-14)
    assert power(s, start_state(s), solved(s)) == pytest.approx(-41.43487548934319, rel=1e-14)


def test_16_golden_box() -> None:
    box = {
        "shapes": [{"type": "box", "center": [1, 0, 0], "size": [2, 1, 0.6], "density": 1.0}],
        "points": {"O": [0, 0, 0]},
        "angular_velocity": [1, 2, -0.5],
    }
    s = scene({"box": box}, {"O": {"type": "ball", "from": "ground.O", "to": "box.O"}}, np.array([-3, 2, -9.0]))
    cut = section(s, start_state(s), 0.0, "box", [0.7, 0, 0], [1, 0, 0])
    close(solved(s).angular_acceleration["box"], (0.470588235294116, 6.123471882640587, -0.352941176470588), 1e-14)
    close(cut.force, (2.13525, -0.174352941176471, -0.045484107579461), 1e-14)
    close(cut.about(np.zeros(3)), (0, -0.7977740831295842, -0.2633647058823527), 1e-14)
    close(cut.moment, (0, -0.829612958435207, -0.141317647058823), 1e-14)
