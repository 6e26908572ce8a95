"""Ratios, belts, screws and differentials by hand; geared shafts struck and swinging; starts that couplings ask for."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import heuncli
from heuncli.analyses.modes.study import compute_spec_modes
from heuncli.base.errors import SolveError, SpecError
from heuncli.output.tables.run_description import make_heading
from heuncli.scene.file_format.load import load
from tests.oracle.values import to_yaml
from tests.shared.gear_trains import STATE, pair, pin, wheel
from tests.shared.scenes import near, solved

ROUNDING = 1e-12
RADII = 0.05, 0.1


def belt(**more: Any) -> dict[str, Any]:
    """Two pulleys 0.5 m apart, the first turned by 5 N m; the second 0.1 m higher along the axis."""
    scene = pair()
    scene["ground"]["points"]["B"] = [0.5, 0, 0.1]
    scene["bodies"]["wheel"] = wheel(0.2, (0.5, 0, 0.1), 2.0)
    scene["couplings"] = {"strap": {"type": "belt", "of": ["p", "w"], "radii": list(RADII), "pretension": 60} | more}
    return scene


@pytest.mark.parametrize("crossed", [False, True])
def test_belt(crossed: bool) -> None:
    """The strands pull along the lines that touch both pulleys, in the plane of the first."""
    r1, r2 = RADII
    found = solved(belt(crossed=crossed))
    sense = -1.0 if crossed else 1.0
    near(found.coordinates["w"]["rate"], sense * 10 * r1 / r2, 10, ROUNDING)
    turned = 5 / (0.02 + 0.2 / 4)
    F = (5 - 0.02 * turned) / r1
    told = found.couplings["strap"]
    near(told["force"], F, F, ROUNDING)
    near((told["tight"], told["slack"]), ((60 + F / 2,), (60 - F / 2,)), F, ROUNDING)
    slope = math.asin((r1 + r2 if crossed else r2 - r1) / 0.5)
    # above the pinion the belt comes tight; seen from the wheel it falls, or crossed rises, towards the pinion
    down = (1.0 if crossed else -1.0) * math.sin(slope)
    tight, slack = ((-math.cos(slope), side * down, 0.0) for side in (1.0, -1.0))
    pull = (60 + F / 2) * np.array(tight) + (60 - F / 2) * np.array(slack)
    near(found.joints["w"]["force"][0], -pull, F, ROUNDING)
    near(found.joints["p"]["force"][0], pull, F, ROUNDING)
    near(found.joints["w"]["moment"][0], np.cross((0, 0, 0.1), pull), F, ROUNDING)
    for name, on, center, turns in (
        ("wheel", pull, (0.5, 0, 0.1), sense * F * r2),
        ("pinion", -pull, (0, 0, 0), -F * r1),
    ):
        own = told["on"][name]
        near(own["force"][0], on, F, ROUNDING)
        about = own["moment"][0] + np.cross(own["point"][0] - center, on)
        near(about, (0.0, 0.0, turns) - np.cross((0, 0, center[2]), on), F, ROUNDING)
    near(found.foundation["force"][0], 0.0, F, ROUNDING)
    assert not found.warnings


def test_belt_that_would_push_is_told() -> None:
    found = solved(belt(pretension=30))
    turned = 5 / (0.02 + 0.2 / 4)
    need = (5 - 0.02 * turned) / RADII[0] / 2
    assert any("strap" in said and f"{math.ceil(need * 100) / 100:.2f} N" in said for said in found.warnings)
    near(found.couplings["strap"]["slack"], 30 - need, need, ROUNDING)


@pytest.mark.parametrize(("until", "need"), [(1.0, 100), (0.25, 0.0), (0.255, 100 * math.exp(-0.25))])
def test_belt_that_pushes_between_samples_is_told(until: float, need: float) -> None:
    """A torque of 14 exp(-((t - 0.26)/0.01)**2) N m puts 200 N of that on the belt, and half of them on a strand."""
    scene = belt()
    scene["forces"]["motor"]["value"] = "14*exp(-((t - 0.26)/0.01)**2)"
    scene["analysis"] = {"duration": 1, "samples": 3, "until": f"t > {until - 1e-9}"}
    found = solved(scene)
    begins = 0.26 - 0.01 * math.sqrt(math.log(100 / 60))
    assert found.events["strap_pushes"]["time"][:1] == pytest.approx([begins] if need else [], abs=1e-7)
    told = [said for said in found.warnings if "strap" in said]
    assert bool(told) == bool(need)
    if need:
        assert f"t = {begins:.6g} s" in told[0] and f"{math.ceil(need * 100 - 1e-4) / 100:.4g} N" in told[0]


def test_blow_through_a_belt() -> None:
    """An impulse of 1 N m s: both strands share what turns the wheel, without the pretension; the table has it."""
    scene = belt()
    scene["impulses"] = {"hit": {"body": "pinion", "couple": [0, 0, 1]}}
    scene["analysis"] = {"type": "impulse"}
    r1, r2 = RADII
    with pytest.warns(heuncli.HeunWarning, match="no pretension withstands an impulse"):
        told = heuncli.solve(text=to_yaml(scene))
    carried = (1 - 0.02 / (0.02 + 0.2 * (r1 / r2) ** 2)) / r1
    for name, expected in (("force", carried), ("tight", carried / 2), ("slack", -carried / 2)):
        assert float(told[f"impulses.0.couplings.strap.{name}"]) == pytest.approx(expected, rel=1e-12)
    (line,) = (own for own in told.tables().splitlines() if own.split()[:1] == ["tight"])
    assert f"{carried / 2:.6g}" in line and "N·s" in line


def screw(**more: Any) -> dict[str, Any]:
    """A nut of 20 kg on a spindle, lifted or falling."""
    return {
        "gravity": [0, 0, -9.81],
        "ground": {"points": {"A": [0, 0, 0], "B": [0.2, 0, 0]}},
        "bodies": {"spindle": wheel(0.02), "nut": wheel(0.3, (0.2, 0, 0), 20.0)},
        "joints": {
            "p": pin("ground.A", "spindle.c", initial={"rate": 10}),
            "n": {"type": "slide", "from": "ground.B", "to": "nut.c", "axis": [0, 0, 1]},
        },
        "couplings": {"thread": {"type": "screw", "of": ["p", "n"], "lead": "10 mm"} | more},
        "analysis": STATE,
    }


@pytest.mark.parametrize("order", [["p", "n"], ["n", "p"]])
def test_screw_between_a_spindle_and_a_nut(order: list[str]) -> None:
    """The spindle is as heavy as 0.02 (2 pi / lead)^2 to the nut; the thread's torque goes into the nut's guide."""
    found = solved(screw(of=order))
    by = 0.01 / math.tau
    near(found.coordinates["n"]["speed"], 10 * by, 10 * by, ROUNDING)
    falls = -20 * 9.81 / (20 + 0.02 / by**2)
    near(found.coordinates["n"]["acceleration"], falls, -falls, 1e-9)
    thrust = 20 * (9.81 + falls)
    near(found.couplings["thread"]["force"], thrust, thrust, ROUNDING)
    near(found.couplings["thread"]["torque"], thrust * by, thrust, ROUNDING)
    near(found.joints["p"]["force"][0], (0, 0, 9.81 + thrust), thrust, ROUNDING)
    near(found.joints["n"]["moment"][0][2], -thrust * by, thrust, ROUNDING)


@pytest.mark.parametrize("reverse", [1, -1])
def test_a_spindle_that_slides_takes_its_thread_with_it(reverse: int) -> None:
    """x_n - x_s = p phi: N (1/m_n + 1/m_s + p^2/J) = p T/J; both slide, and none of it is lost in half a second."""
    scene = screw(lead="1 m") | {"gravity": [0, 0, 0], "analysis": {"duration": 0.5, "samples": 3}}
    a, b = ("ground.A", "spindle.c")[::reverse]
    scene["joints"]["p"] = {"type": "cylinder", "from": a, "to": b, "axis": [0, 0, 1]}
    scene["forces"] = {"motor": {"type": "couple", "on": "spindle", "vector": [0, 0, 3]}}
    scene["bodies"]["spindle"]["mass"] = 5.0
    found, p = solved(scene), reverse / math.tau
    thrust = 3 * p / 0.02 / (1 / 20 + 1 / 5 + p * p / 0.02)
    near(found.couplings["thread"]["force"], thrust, abs(thrust), 1e-9)
    for body, mass in (("nut", 20), ("spindle", -5)):
        near(found.bodies[body]["position"][-1][2], thrust / mass * 0.125, 1.0, 1e-9)


def test_screw_in_a_cylinder() -> None:
    scene = screw(of=["n"], lead="1 m")
    del scene["bodies"]["spindle"], scene["joints"]["p"]
    scene["joints"]["n"]["type"] = "cylinder"
    scene["bodies"]["nut"]["points"]["c"] = [0.2, 0, 0]
    found = solved(scene)
    by = 1 / math.tau
    falls = -20 * 9.81 / (20 + 0.3 / by**2)
    near(found.coordinates["n"]["acceleration"], falls, 9.81, ROUNDING)
    near(found.coordinates["n"]["angular_acceleration"], falls / by, 9.81 / by, ROUNDING)
    near(found.couplings["thread"]["on"]["nut"]["force"][0], (0, 0, 20 * (9.81 + falls)), 200, ROUNDING)
    near(found.couplings["thread"]["on"]["nut"]["moment"][0], (0, 0, 0.3 * falls / by), 200, ROUNDING)


def three_shafts(**more: Any) -> dict[str, Any]:
    """Three discs on one axis; 3 N m on the carrier."""
    return {
        "ground": {"points": {"A": [0, 0, 0], "B": [0, 0, 1], "C": [0, 0, 2]}},
        "bodies": {
            "one": wheel(0.1), "two": wheel(0.1, (0, 0, 1)), "cage": wheel(0.05, (0, 0, 2)),
        },
        "joints": {"a": pin("ground.A", "one.c"), "b": pin("ground.B", "two.c"), "c": pin("ground.C", "cage.c")},
        "couplings": {"axle": {"type": "differential", "of": ["a", "b", "c"]} | more},
        "forces": {"engine": {"type": "torque", "joint": "c", "value": 3}},
        "analysis": STATE,
    }  # fmt: skip


def test_differential_halves_the_torque_whatever_turns() -> None:
    scene = three_shafts()
    scene["joints"]["a"]["initial"], scene["joints"]["b"]["initial"] = {"rate": 7}, {"rate": 1}
    scene["forces"]["drag"] = {"type": "torque", "joint": "a", "value": -1}
    found = solved(scene)
    near(found.coordinates["c"]["rate"], 4, 4, ROUNDING)
    # lambda on each wheel, -2 lambda on the cage: 0.1 a = l - 1, 0.1 b = l, 0.05 c = 3 - 2 l, a + b = 2 c
    load = (10 + 2 * 3 / 0.05) / (20 + 4 / 0.05)
    near(np.abs(found.couplings["axle"]["moment"]), load, 1.0, ROUNDING)
    near(found.coordinates["b"]["acceleration"], load / 0.1, load / 0.1, ROUNDING)


def test_differential_of_another_ratio_is_willis() -> None:
    scene = three_shafts(ratio=-3)
    scene["joints"]["a"]["initial"], scene["joints"]["b"]["initial"] = {"rate": 8}, {"rate": 0}
    near(solved(scene).coordinates["c"]["rate"], 2, 8, ROUNDING)


def test_ratio_with_a_constant_moves_what_nothing_holds() -> None:
    """2 a - b = 3 rad: with a held at 4 rad b goes to 5 rad, nearest by turns counted on, not to 5 - 2 pi."""
    scene = three_shafts()
    scene["couplings"] = {"r": {"type": "ratio", "of": ["a", "b"], "factors": [2, -1], "is": "3 rad"}}
    scene["joints"]["a"]["initial"] = {"angle": 4, "rate": 1}
    found = solved(scene)
    near(found.coordinates["a"]["angle"], 4, 1, ROUNDING)
    near(found.coordinates["b"]["angle"], 5, 1, ROUNDING)
    near(found.coordinates["b"]["rate"], 2, 1, ROUNDING)
    scene["joints"]["b"]["initial"] = {"angle": 2}
    with pytest.raises(SolveError) as refused:
        solved(scene)
    (problem,) = refused.value.problems
    assert problem.code == "does-not-fit" and problem.entry_path == "couplings.r" and "3 rad" in problem.message


def test_ratio_of_an_angle_and_a_travel() -> None:
    scene = screw()
    scene["couplings"] = {"r": {"type": "ratio", "of": ["n", "p"], "factors": [1, -0.01 / math.tau]}}
    scene["joints"]["n"]["initial"] = {"travel": 0.3}
    plain, found = solved(screw()), solved(scene)
    near(found.coordinates["n"]["acceleration"], plain.coordinates["n"]["acceleration"], 9.81, ROUNDING)
    near(np.abs(found.couplings["r"]["force"]), plain.couplings["thread"]["force"], 200, ROUNDING)


def test_a_blow_on_one_gear_turns_both_at_once() -> None:
    """An angular impulse meets the reflected inertia; the teeth hand on their share of it."""
    scene = pair(teeth=[20, 60], helix="15 deg")
    scene["joints"]["p"].pop("initial")
    scene["impulses"] = {"blow": {"body": "pinion", "couple": [0, 0, 3]}}
    del scene["forces"]
    scene["analysis"] = {"type": "impulse"}
    (struck,) = solved(scene).impulses
    after = 3 / (0.02 + 0.2 / 9)
    near(struck["bodies"]["pinion"]["angular_velocity_jump"], (0, 0, after), after, ROUNDING)
    near(struck["bodies"]["wheel"]["angular_velocity_jump"], (0, 0, -after / 3), after, ROUNDING)
    push = (3 - 0.02 * after) / 0.1
    on = struck["couplings"]["mesh"]["on"]["wheel"]["force"]
    radial = push * math.tan(math.radians(20)) / math.cos(math.radians(15))
    near(on, (radial, push, -push * math.tan(math.radians(15))), push, ROUNDING)
    near(struck["joints"]["w"]["force"], -np.asarray(on), push, ROUNDING)


@pytest.mark.parametrize("order", [["p", "n"], ["n", "p"]])
def test_a_blow_through_a_screw(order: list[str]) -> None:
    """On the nut it meets its mass and 0.02 (2 pi / lead)^2, on the spindle 0.02 and 20 (lead / 2 pi)^2."""
    by = 0.01 / math.tau
    for blow, nut in (
        ({"on": "nut.c", "vector": [0, 0, -3]}, -3 / (20 + 0.02 / by**2)),
        ({"body": "spindle", "couple": [0, 0, 3]}, 3 * by / (0.02 + 20 * by**2)),
    ):
        scene = screw(of=order) | {"impulses": {"blow": blow}, "analysis": {"type": "impulse"}}
        (struck,) = solved(scene).impulses
        near(struck["bodies"]["nut"]["center_velocity_jump"], (0, 0, nut), abs(nut), ROUNDING)
        near(struck["bodies"]["spindle"]["angular_velocity_jump"], (0, 0, nut / by), abs(nut / by), ROUNDING)
        thrust = 20 * nut + (3 if "vector" in blow else 0)  # what the thread gives the nut
        on = struck["couplings"]["thread"]["on"]
        near(on["nut"]["force"], (0, 0, thrust), 3, ROUNDING)
        near(on["spindle"]["force"], (0, 0, -thrust), 3, ROUNDING)
        near(on["nut"]["moment"], (0, 0, thrust * by), 3, ROUNDING)
        near(struck["joints"]["p"]["force"], (0, 0, thrust), 3, ROUNDING)
        near(struck["joints"]["n"]["moment"][2], -thrust * by, 3, ROUNDING)


def test_rest_many_turns_away() -> None:
    """20 turns of a spindle, 1000 turns of a pinion, before a spring bears; what nothing holds is told by both."""
    scene = screw() | {"analysis": {"type": "rest"}}
    scene["joints"]["p"].pop("initial")
    free, spring = to_yaml(scene), {"type": "torque", "joint": "n", "value": "-981*n.travel"}
    near(solved({**scene, "forces": {"s": spring}}).coordinates["p"]["angle"], -20 * math.tau, 20 * math.tau, 1e-9)
    with pytest.raises(SolveError, match=r"keeps rotating, joints\.n keeps sliding: nothing stops it"):
        solved(free)
    train = pair(teeth=[10, 10000]) | {"analysis": {"type": "rest"}}
    train["joints"]["p"].pop("initial")
    train["forces"]["s"] = {"type": "turn_spring", "joint": "w", "stiffness": 5000 / math.tau, "angle": 0}
    near(solved(train).coordinates["p"]["angle"], 1000 * math.tau, 1000 * math.tau, 1e-9)


def test_modes_of_geared_shafts() -> None:
    """A spring of 50 N m/rad about the wheel's axis swings it with nine times the pinion's inertia."""
    scene = pair(teeth=[20, 60])
    scene["joints"]["p"].pop("initial")
    scene["forces"] = {"spring": {"type": "turn_spring", "joint": "w", "stiffness": 50}}
    (mode,) = compute_spec_modes(load("scene.yaml", to_yaml(scene))).modes
    wanted = math.sqrt(50 / (0.2 + 9 * 0.02))
    assert mode.eigenvalue.imag == pytest.approx(wanted, rel=1e-9)


def test_drives_that_fight_are_refused() -> None:
    scene = pair(teeth=[20, 60])
    scene["joints"]["p"].pop("initial")
    scene["drives"] = {"d": {"joint": "p", "angle": "t"}, "e": {"joint": "w", "angle": "t"}}
    del scene["forces"]
    with pytest.raises(SolveError) as refused:
        solved(scene)
    (problem,) = refused.value.problems
    assert problem.code == "rates-do-not-fit" and problem.entry_path == "couplings.mesh"


def test_drives_that_fight_through_a_train_are_refused() -> None:
    """The first and the last of three gears are driven: no coupling by itself holds both."""
    scene = pair(teeth=[20, 60])
    scene["joints"]["p"].pop("initial")
    scene["bodies"]["third"] = dict(scene["bodies"]["wheel"])
    scene["ground"]["points"]["T"] = [2, 0, 0]
    scene["joints"]["x"] = {**scene["joints"]["w"], "from": "ground.T", "to": "third.c"}
    scene["couplings"]["second"] = {"type": "gear", "of": ["w", "x"], "ratio": -2}
    del scene["forces"]
    for last, is_refused in (("2*t/3 + t**2", True), ("2*t/3", False)):
        scene["drives"] = {"d": {"joint": "p", "angle": "4*t"}, "e": {"joint": "x", "angle": last}}
        if not is_refused:
            solved(scene)
            continue
        with pytest.raises(SolveError) as refused:
            solved(scene)
        (problem,) = refused.value.problems
        assert problem.code == "rates-do-not-fit" and "mesh (gear) and second (gear)" in problem.message


@pytest.mark.parametrize(
    ("scene", "code"),
    [
        (belt(radii=[0.05]), "coupling-sizes"),
        (belt(radii=[0.05, 0.6]), "belt-axes"),
        (belt(pretension=-1), "coupling-sizes"),
        (screw(lead=0), "coupling-sizes"),
        (screw(of=["p"]), "screw-joints"),
        (three_shafts(ratio=1), "coupling-sizes"),
        (three_shafts(of=["a", "b"]), "coupling-count"),
    ],
)
def test_what_couplings_cannot_be_is_refused(scene: dict[str, Any], code: str) -> None:
    with pytest.raises(SpecError) as refused:
        solved(scene)
    assert {problem.code for problem in refused.value.problems} == {code}
    assert all(problem.hint and problem.location for problem in refused.value.problems)


@pytest.mark.parametrize(("other", "since"), [("t**3", 0.0), ("t**2", 0.0), ("max(t - 0.5, 0)**3", 0.5)])
@pytest.mark.parametrize("kind", ["gear", "ratio"])
def test_drives_that_part_over_a_coupling_are_named(kind: str, other: str, since: float) -> None:
    """They agree at the start, and up to when is told."""
    scene = pair(teeth=[20, 40])
    if kind == "ratio":
        scene["couplings"]["mesh"] = {"type": "ratio", "of": ["p", "w"], "factors": [1, 2]}
    scene["joints"]["p"].pop("initial")
    scene["drives"] = {"one": {"joint": "p", "angle": "10*t"}, "two": {"joint": "w", "angle": f"-5*t - {other}"}}
    scene["forces"] = {}
    scene["analysis"] = {"duration": 1, "samples": 3}
    with pytest.raises(SolveError) as refused:
        solved(scene)
    (problem,) = refused.value.problems
    assert problem.code == "rates-do-not-fit" and problem.entry_path == "couplings.mesh" and problem.hint
    assert "drives one and two" in problem.message and f"t = {since:g} s" in problem.message


def test_what_two_drives_leave_open_of_teeth() -> None:
    """Where both gears are driven alike nothing tells the tooth force: its parts are open with it, but for none."""
    scene = pair(teeth=[20, 40])
    scene["joints"]["p"].pop("initial")
    scene["drives"] = {"one": {"joint": "p", "angle": "10*t"}, "two": {"joint": "w", "angle": "-5*t"}}
    found = solved(scene).couplings["mesh"]
    assert all(np.isnan(found[name]).all() for name in ("force", "radial", "normal"))
    assert not found["axial"].any()


def test_what_two_stops_that_are_struck_at_once_leave_open_of_a_coupling() -> None:
    """Carts of 2 and 3 kg that move against each other come to both stops: Σ m Δv = -1.5 N s is all that is certain."""
    scene = {
        "ground": {"points": {"A": [0, 0, 0], "B": [0, 1, 0]}},
        "bodies": {
            name: {"mass": m, "center": [0, 0, 0], "inertia": [1, 1, 1], "points": {"o": [0, 0, 0]}}
            for name, m in (("a", 2), ("b", 3))
        },
        "joints": {
            "p": {"type": "slide", "from": "ground.A", "to": "a.o", "axis": [1, 0, 0], "initial": {"speed": 1}},
            "q": {"type": "slide", "from": "ground.B", "to": "b.o", "axis": [1, 0, 0]},
        },
        "couplings": {"tie": {"type": "ratio", "of": ["p", "q"], "factors": [1, 1]}},
        "stops": {
            "far": {"joint": "p", "travel": [None, 0.5], "restitution": 0.5},
            "near": {"joint": "q", "travel": [-0.5, None], "restitution": 0.5},
        },
        "analysis": {"duration": 1, "samples": 2},
    }
    (struck,) = solved(scene).impulses
    tie = struck["couplings"]["tie"]
    assert tie["open"] == ["force", "on.a.force.x", "on.ground.force.x", "on.ground.moment.z", "on.b.force.x"]
    assert np.isnan([tie["force"], tie["on"]["a"]["force"][0], tie["on"]["b"]["force"][0]]).all()
    near(struck["foundation"]["force"], (-1.5, 0.0, 0.0), 1.0, ROUNDING)


def carried_pair(**rates: Any) -> dict[str, Any]:
    """Two geared rotors, -2 to 1, on a frame that nothing holds; rates: angular velocities about z of some of them."""

    def rotor(name: str, x: float) -> dict[str, Any]:
        given = {"angular_velocity": [0, 0, rates[name]]} if name in rates else {}
        return {"mass": 1, "center": [x, 0, 0], "inertia": [1, 1, 1], "points": {"o": [x, 0, 0]}} | given

    frame = {"mass": 1, "center": [0, 0, 0], "inertia": [1, 1, 1], "points": {"o": [0, 0, 0], "p": [1, 0, 0]}}
    return {
        "bodies": {"frame": frame, "a": rotor("a", 0.0), "b": rotor("b", 1.0)},
        "joints": {
            "ja": {"type": "pin", "from": "frame.o", "to": "a.o", "axis": [0, 0, 1]},
            "jb": {"type": "pin", "from": "frame.p", "to": "b.o", "axis": [0, 0, 1]},
        },
        "couplings": {"mesh": {"type": "gear", "of": ["ja", "jb"], "ratio": -2}},
        "analysis": {"type": "state"},
    }


def test_the_other_shaft_turns_and_not_the_frame() -> None:
    """The rate of one gear is given: the frame stays, though to turn it, too, would be the least sum of squares."""
    found = solved(carried_pair(a=6.0))
    near(found.bodies["frame"]["angular_velocity"][0], (0, 0, 0), 6.0, ROUNDING)
    near(found.bodies["b"]["angular_velocity"][0], (0, 0, -3), 6.0, ROUNDING)
    assert "started" not in found.model


def test_a_frame_that_has_to_turn_is_told() -> None:
    """a - f = -2 (b - f) of two given rates: f = (a + 2 b) / 3."""
    found = solved(carried_pair(a=5.0, b=3.0))
    near(found.bodies["frame"]["angular_velocity"][0], (0, 0, 11 / 3), 5.0, ROUNDING)
    (sentence,) = found.model["started"]
    assert sentence.startswith("the couplings set in motion frame (3.667 rad/s")
    assert ("start", sentence) in make_heading(found)


def test_what_moves_though_it_could_have_stayed_is_told() -> None:
    """One of a differential's three shafts is given 10 rad/s: b - 2 c = -10 at the least b^2 + c^2."""
    scene = {
        "bodies": {n: wheel(1.0, (float(k), 0, 0), 1.0) for k, n in enumerate("abc")},
        "ground": {"points": {n.upper(): [float(k), 0, 0] for k, n in enumerate("abc")}},
        "joints": {n: pin(f"ground.{n.upper()}", f"{n}.c") for n in "abc"},
        "couplings": {"axle": {"type": "differential", "of": ["a", "b", "c"]}},
        "analysis": {"type": "state"},
    }
    scene["joints"]["a"]["initial"] = {"rate": 10.0}
    found = solved(scene)
    near([found.coordinates[n]["rate"][0] for n in "abc"], (10, -2, 4), 10.0, ROUNDING)
    (sentence,) = found.model["started"]
    assert sentence.startswith("the couplings set in motion b (2 rad/s), c (4 rad/s): other rates also satisfy them")


@pytest.mark.parametrize(("joint", "origin"), [(None, (0.0, -2.0, 0.0)), ("line", (0.0, -2.0, 0.0)), ("ball", None)])
def test_where_an_angular_velocity_alone_is_given_the_centre_rests(
    joint: str | None, origin: tuple[float, ...] | None
) -> None:
    """w x c of the origin, and the heading says so; where a joint holds a point it decides."""
    body = {"mass": 1, "center": [1, 0, 0], "inertia": [1, 1, 1], "angular_velocity": [0, 0, 2]}
    scene: dict[str, Any] = {"bodies": {"b": body | {"points": {"o": [0, 0, 0]}}}, "analysis": {"type": "state"}}
    if joint is not None:
        scene["ground"] = {"points": {"O": [0, 0, 0]}}
        scene["joints"] = {"j": {"type": joint, "from": "ground.O", "to": "b.o"}}
        scene["joints"]["j"] |= {"axis": [0, 1, 0]} if joint == "line" else {}
    found = solved(scene)
    if origin is None:
        assert "started" not in found.model
        near(found.bodies["b"]["center_velocity"][0], (0, 2, 0), 2.0, ROUNDING)
        return
    near(found.bodies["b"]["velocity"][0], origin, 2.0, ROUNDING)
    near(found.bodies["b"]["center_velocity"][0], (0, 0, 0), 2.0, ROUNDING)
    (sentence,) = found.model["started"]
    assert "its centre of mass starts at rest" in sentence and "its origin at (0, -2, 0) m/s" in sentence
