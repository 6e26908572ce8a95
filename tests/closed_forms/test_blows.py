"""Blows by hand: manual/theory.md, "Closed cases" 6, 7, 12, 13, 15, and what follows from the law of impulse alone.

J Δω = H on a hinge, Δv = H/m on what is free; of ideal joints no energy is lost but what the blow itself puts in,
½ H·(v⁺ + v⁻).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.results.results import Block
from tests.shared.golden_a import GOLDEN_A
from tests.shared.scenes import near, solved
from tests.shared.slider_crank import JOINTS, slider_crank

EXACT = 1e-13  # relative: what is printed has 15 digits or is a fraction
HEAD = "heun: 1\nground: {points: {O: [0, 0, 0]}}\n"


def blow(scene: str | dict[str, Any]) -> Block:
    """The one blow of a scene."""
    (found,) = solved(scene).impulses
    assert isinstance(found, dict)
    return found


# ---- 6: a hinged rod
def hinged(h: object, more: str = "") -> str:
    return (
        HEAD
        + f"""
bodies:
  rod:
    shapes: [{{type: rod, from: [0, 0, 0], to: [1, 0, 0], mass: 1}}]
    points: {{a: [0, 0, 0], h: [{h}, 0, 0]}}
joints: {{hinge: {{type: pin, from: ground.O, to: rod.a, axis: [0, 0, 1]}}}}
impulses: {{blow: {{on: rod.h, vector: [0, 1, 0]}}}}
{more}"""
    )


@pytest.mark.parametrize(("h", "value"), [("2/3", 0.0), (0.5, 0.25), (1, -0.5), (0.25, 0.625)])
def test_6_a_hinged_rod(h: object, value: float) -> None:
    """ω = 3h, impulse on the hinge 1 − 3h/2: nothing at the centre of percussion."""
    found = blow(hinged(h))
    at = 2 / 3 if h == "2/3" else float(h)  # type: ignore[arg-type]
    near(found["bodies"]["rod"]["angular_velocity_jump"], (0, 0, 3 * at), 1.0, EXACT)
    near(found["bodies"]["rod"]["center_velocity_jump"], (0, 1.5 * at, 0), 1.0, EXACT)
    for r in (found["foundation"]["force"], found["foundation"]["supports"]["hinge"]["force"]):
        near(r, (0, value, 0), 1.0, 1e-15)
    near(found["joints"]["hinge"]["force"], (0, -value, 0), 1.0, 1e-15)
    near(found["joints"]["hinge"]["moment"], np.zeros(3), 1.0, EXACT)
    near(found["foundation"]["moment"], np.zeros(3), 1.0, 1e-15)
    E = 1.5 * at**2
    near([found["energy_before"], found["energy_jump"], found["energy_after"]], (0, E, E), 1.0, EXACT)
    assert found["time"] == 0.0 and list(found["names"]) == ["blow"]


def test_6_the_table_says_zero() -> None:
    """Not 1e-17: nothing but rounding of what it is summed from."""
    from heuncli.output.documents.document import format_cell
    from heuncli.output.tables.page import make_page
    from heuncli.study.quantities.labels import make_labels
    from tests.shared.scenes import study

    run = study(hinged("2/3"))
    tables = make_page(run.results, make_labels(run.spec), run.magnitudes).make_tables_at_instants(run.results)
    cells = [format_cell(cell) for table in tables for row in table.rows for cell in row]
    assert not any("e-1" in cell for cell in cells), cells


@pytest.mark.parametrize("x", [0.0, 0.2, 0.5, 0.9])
def test_6_a_cut_of_it(x: float) -> None:
    """Beyond x: Q = (mass beyond) × (speed of its centre) − what of the blow stands there; M by its lever."""
    more = f"sections: {{cut: {{body: rod, at: [{x}, 0, 0], normal: [1, 0, 0], side: beyond}}}}"
    found = blow(hinged(0.6, more))["sections"]["cut"]
    speed = 3 * 0.6  # rad/s
    momentum, twist = speed * (1 - x**2) / 2, speed * ((1 - x**3) / 3 - x * (1 - x**2) / 2)
    near(found["force"], (0, (1.0 if x < 0.6 else 0.0) - momentum, 0), 1.0, EXACT)
    near(found["moment"], (0, 0, (0.6 - x if x < 0.6 else 0.0) - twist), 1.0, EXACT)


@pytest.mark.parametrize(("side", "own"), [("before", 1.0), ("beyond", 0.0)])
def test_6_a_cut_where_it_is_struck(side: str, own: float) -> None:
    """Just before the place the blow belongs to the piece, just beyond it does not."""
    more = f"sections: {{cut: {{body: rod, at: h, normal: [1, 0, 0], side: {side}}}}}"
    found = blow(hinged(0.6, more))["sections"]["cut"]
    near(found["force"], (0, own - 1.8 * (1 - 0.36) / 2, 0), 1.0, EXACT)


def test_6_a_run_of_cuts() -> None:
    """Two rows where the blow stands; minus the joint's impulse at the root, nothing at the free end."""
    more = "sections: {run: {body: rod, from: [0, 0, 0], to: [1, 0, 0], count: 11, first_axis: [0, 1, 0]}}"
    found = blow(hinged(0.6, more))
    run = found["sections"]["run"]
    s = np.asarray(run["s"], dtype=float)
    assert len(s) == 12 and list(run["side"])[5:9] == [None, "before", "beyond", None]
    beyond = np.array([x < 0.6 for x in s])
    beyond[6] = True
    near(run["Q1"], beyond - 1.8 * (1 - s**2) / 2, 1.0, EXACT)
    near(run["force"][0], -found["joints"]["hinge"]["force"], 1.0, EXACT)
    near([*run["force"][-1], *run["moment"][-1]], np.zeros(6), 1.0, EXACT)


# ---- 7: rods in line
def in_line(n: int, fixed: bool, more: str = "") -> str:
    bodies = "".join(f"  r{k}: {{shapes: [{{type: rod, from: [{k}, 0, 0], to: [{k + 1}, 0, 0], mass: 1}}],"
                     f" points: {{a: [{k}, 0, 0], b: [{k + 1}, 0, 0]}}}}\n" for k in range(n))  # fmt: skip
    joints = "  j0: {type: ball, from: ground.O, to: r0.a}\n" if fixed else ""
    joints += "".join(f"  j{k}: {{type: ball, from: r{k - 1}.b, to: r{k}.a}}\n" for k in range(1, n))
    joints = f"joints:\n{joints}" if joints else ""
    return f"{HEAD}bodies:\n{bodies}{joints}impulses: {{blow: {{on: r{n - 1}.b, vector: [0, 1, 0]}}}}\n{more}"


FIXED: dict[int, tuple[list[float], float, float, list[float]]] = {  # spins, tip, foundation, joint impulses on outer
    2: ([-6 / 7, 30 / 7], 24 / 7, 1 / 7, [2 / 7]),
    3: ([3 / 13, -15 / 13, 57 / 13], 45 / 13, -1 / 26, [-1 / 13, 7 / 26]),
    4: ([-6 / 97, 30 / 97, -114 / 97, 426 / 97], 336 / 97, 1 / 97, []),
}
FREE = {
    1: (-2.0, [6.0], 4.0), 2: (1 / 2, [-3 / 2, 9 / 2], 7 / 2), 3: (-2 / 15, [2 / 5, -6 / 5, 22 / 5], 52 / 15),
    4: (1 / 28, [-3 / 28, 9 / 28, -33 / 28, 123 / 28], 97 / 28),
}  # fmt: skip


@pytest.mark.parametrize("n", FIXED)
def test_7_rods_on_a_ball(n: int) -> None:
    spins, tip, r, inner = FIXED[n]
    found = blow(in_line(n, fixed=True))
    near([found["bodies"][f"r{k}"]["angular_velocity_jump"][2] for k in range(n)], spins, 1.0, EXACT)
    end = found["bodies"][f"r{n - 1}"]
    near(end["center_velocity_jump"][1] + end["angular_velocity_jump"][2] / 2, tip, 1.0, EXACT)
    near(found["foundation"]["force"], (0, r, 0), 1.0, EXACT)
    near(found["foundation"]["moment"], np.zeros(3), 1.0, EXACT)
    near([found["joints"][f"j{k + 1}"]["force"][1] for k in range(len(inner))], inner, 1.0, EXACT)
    near(found["energy_jump"], tip / 2, 1.0, EXACT)


@pytest.mark.parametrize("n", FREE)
def test_7_free_rods(n: int) -> None:
    base, spins, tip = FREE[n]
    found = blow(in_line(n, fixed=False))
    near([found["bodies"][f"r{k}"]["angular_velocity_jump"][2] for k in range(n)], spins, 1.0, EXACT)
    first, last = found["bodies"]["r0"], found["bodies"][f"r{n - 1}"]
    near(first["center_velocity_jump"][1] - first["angular_velocity_jump"][2] / 2, base, 1.0, EXACT)
    near(last["center_velocity_jump"][1] + last["angular_velocity_jump"][2] / 2, tip, 1.0, EXACT)
    near(found["foundation"]["force"], np.zeros(3), 1.0, EXACT)


@pytest.mark.parametrize("n", [2, 3, 4])
def test_a_stretched_chain_passes_the_whole_blow_on(n: int) -> None:
    """Along itself nothing moves: r = h, in every joint and every cut, exactly."""
    runs = "sections: {" + ", ".join(f"s{k}: {{body: r{k}, from: a, to: b, count: 5}}" for k in range(n)) + "}"
    found = blow(in_line(n, fixed=True, more=runs).replace("vector: [0, 1, 0]", "vector: [3, 0, 0]"))
    near(found["foundation"]["force"], (3, 0, 0), 3.0, EXACT)
    assert found["energy_jump"] == pytest.approx(0.0, abs=1e-15)
    for k in range(n):
        near(found["bodies"][f"r{k}"]["angular_velocity_jump"], np.zeros(3), 1.0, EXACT)
        near(found["joints"][f"j{k}"]["force"], (-3, 0, 0), 3.0, EXACT)
        near(found["sections"][f"s{k}"]["N"], np.full(5, 3.0), 3.0, EXACT)


# ---- 12: a slider-crank
@pytest.mark.parametrize("told", JOINTS)
def test_12_a_slider_crank(told: str) -> None:
    """Struck on its slider, at rest or turning: a blow takes no notice of rates."""
    hit = "impulses: {blow: {on: slider.B, vector: [1, 0, 0]}}\n"
    for start in ("angle: 1", "angle: 1, rate: 70"):
        found = blow(slider_crank(told, f", initial: {{{start}}}", hit))
        near(found["bodies"]["crank"]["angular_velocity_jump"], (0, 0, -3.8605403703980), 4.0, EXACT)
        near(found["bodies"]["slider"]["center_velocity_jump"], (0.3858064468756, 0, 0), 1.0, EXACT)


@pytest.mark.parametrize("told", JOINTS)
def test_12_at_the_dead_centre(told: str) -> None:
    """The whole blow goes to the bearing, nothing moves; a couple on the crank moves the crank, not the slider."""
    hit = "impulses: {blow: {on: slider.B, vector: [1, 0, 0]}}\n"
    found = blow(slider_crank(told, ", initial: {angle: 0}", hit))
    near(found["bodies"]["crank"]["angular_velocity_jump"], np.zeros(3), 1.0, EXACT)
    near(found["bodies"]["slider"]["center_velocity_jump"], np.zeros(3), 1.0, EXACT)
    near(found["foundation"]["force"], (1, 0, 0), 1.0, EXACT)
    near(found["joints"]["shaft"]["force"][:2], (-1, 0), 1.0, EXACT)
    near(found["energy_jump"], 0.0, 1.0, EXACT)
    beside = blow(slider_crank(told, ", initial: {angle: 1e-3}", hit))
    near(beside["bodies"]["crank"]["angular_velocity_jump"][2], -0.02222209, 1.0, 5e-9)
    twist = blow(slider_crank(told, ", initial: {angle: 0}", "impulses: {twist: {body: crank, couple: [0, 0, 1]}}\n"))
    near(twist["bodies"]["crank"]["angular_velocity_jump"], (0, 0, 166.6666666666667), 167.0, EXACT)
    near(twist["bodies"]["slider"]["center_velocity_jump"], np.zeros(3), 17.0, EXACT)


# ---- 13: a ladder
LADDER = (
    HEAD
    + """
parameters: {tilt: 0.9}
bodies:
  ladder:
    shapes: [{type: rod, from: [0, 0, 0], to: [0, 0, 1], mass: 1}]
    points: {foot: [0, 0, 0], head: [0, 0, 1], middle: [0, 0, 0.5]}
    position: ["sin(tilt)", 0, 0]
    orientation: {axis: [0, 1, 0], angle: "-tilt"}
joints:
  floor: {type: plane, from: ground.O, to: ladder.foot, normal: [0, 0, 1]}
  wall: {type: plane, from: ground.O, to: ladder.head, normal: [1, 0, 0]}
impulses: {blow: {on: ladder.middle, vector: [1, 0, 0]}}
"""
)


def test_13_a_ladder() -> None:
    found = blow(LADDER)
    near(found["bodies"]["ladder"]["angular_velocity_jump"], (0, -0.9324149524059966, 0), 1.0, EXACT)
    near(found["joints"]["floor"]["force"], (0, 0, -0.3651928615793232), 1.0, EXACT)
    near(found["joints"]["wall"]["force"], (-0.7102007855099077, 0, 0), 1.0, EXACT)


# ---- 15: golden case A
def golden(vector: str = "[1, 2, -1]", more: str = "") -> str:
    text = GOLDEN_A.replace("points: {base: [0, 0, 0]},", "points: {base: [0, 0, 0], struck: [0.9, 0, 0.3]},")
    return text + f"impulses: {{blow: {{on: two.struck, vector: {vector}}}}}\n{more}"


def test_15_golden_a() -> None:
    found = blow(golden())
    one, two = found["bodies"]["one"], found["bodies"]["two"]
    near(one["angular_velocity_jump"], (-0.075483415174485, 0.286832574335682, -0.35626988279587), 1.0, EXACT)
    near(two["angular_velocity_jump"], (0.601966902494389, 0.350331061757914, 3.023242844532551), 1.0, EXACT)
    near(found["foundation"]["force"], (0.580282235181806, 0.534667104935139, -0.142293727664147), 1.0, EXACT)
    near(-found["joints"]["link"]["force"], (0.745935957786883, 0.283868374106259, -0.379308862538035), 1.0, EXACT)
    near(found["foundation"]["moment"], np.zeros(3), 1.0, EXACT)
    near(found["energy_before"], 6.232248895944697, 6.0, EXACT)


def test_15_central_axis() -> None:
    """Of the impulse on the foundation: here through the one ball, without pitch."""
    axis = blow(golden())["foundation"]["axis"]
    near(axis["point"], np.zeros(3), 1.0, EXACT)
    near(axis["pitch"], 0.0, 1.0, EXACT)
    r = np.array((0.580282235181806, 0.534667104935139, -0.142293727664147))
    near(axis["direction"], r / np.linalg.norm(r), 1.0, EXACT)


# ---- what a blow is and is not
def test_values_at_its_own_instant_are_those_after() -> None:
    """Velocities, and forces with the centrifugal ones after it."""
    found = solved(hinged(1))
    near(found.bodies["rod"]["angular_velocity"][0], (0, 0, 3), 3.0, EXACT)
    near(found.joints["hinge"]["force"][0], (-9 / 2, 0, 0), 9.0, EXACT)
    near(found.energy["kinetic"][0], 1.5, 1.0, EXACT)


def test_weight_and_springs_have_no_part_in_it() -> None:
    plain, loaded = blow(golden()), blow(golden(more="""
forces:
  pull: {type: spring, from: ground.O, to: two.struck, stiffness: 1e6, length: 0.1}
  push: {type: force, on: one.joint, vector: [1e3, 0, 0]}
"""))  # fmt: skip
    for name in ("one", "two"):
        found, wanted = (b["bodies"][name]["angular_velocity_jump"] for b in (loaded, plain))
        near(found, wanted, 3.0, EXACT)
    near(loaded["foundation"]["force"], plain["foundation"]["force"], 1.0, EXACT)
    assert "pull" not in loaded["foundation"].get("elements", {}) or not np.any(
        loaded["foundation"]["elements"]["pull"]["force"])  # fmt: skip


def test_several_at_one_instant_are_one_blow() -> None:
    """Their jumps add up; the energy does not, for each works on the others' velocities."""
    parts = {"a": "[1, 0, 0]", "b": "[0, 2, 0]", "c": "[0, 0, -1]"}
    single = [blow(golden(vector)) for vector in parts.values()]
    together = golden().split("impulses:")[0] + "impulses:\n" + "".join(
        f"  {n}: {{on: two.struck, vector: {v}}}\n" for n, v in parts.items())  # fmt: skip
    found, whole = blow(together), blow(golden())
    assert set(found["names"]) == set(parts)
    for name in ("one", "two"):
        added = sum(s["bodies"][name]["angular_velocity_jump"] for s in single)
        near(found["bodies"][name]["angular_velocity_jump"], added, 1.0, EXACT)
    near(found["foundation"]["force"], whole["foundation"]["force"], 1.0, EXACT)
    near(found["energy_jump"], whole["energy_jump"], 1.0, EXACT)


def test_a_blow_in_the_body_frame_turns_with_it() -> None:
    """A wheel that has turned a quarter by its instant."""
    scene = (
        HEAD
        + """
bodies: {w: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 2], points: {o: [0, 0, 0], rim: [1, 0, 0]}}}
joints: {shaft: {type: pin, from: ground.O, to: w.o, axis: [0, 0, 1], initial: {rate: "pi"}}}
impulses: {blow: {on: w.rim, vector: [1, 4, 0], frame: body, time: 0.5}}
analysis: {duration: 1, samples: 3}
"""
    )
    run = solved(scene)
    (found,) = run.impulses
    near(found["bodies"]["w"]["angular_velocity_jump"], (0, 0, 2), 1.0, 1e-9)
    near(found["foundation"]["force"], (-4, 1, 0), 4.0, 1e-9)
    near(run.coordinates["shaft"]["rate"], (math.pi, math.pi + 2, math.pi + 2), 5.0, 1e-12)
    near(run.coordinates["shaft"]["angle"], (0, math.pi / 2, math.pi + 1), 5.0, 1e-12)


# ---- drives
def wheel(angle: str) -> str:
    return (
        HEAD
        + f"""
bodies: {{w: {{mass: 3, center: [0.1, 0, 0], inertia: [1, 1, 2], points: {{o: [0, 0, 0], rim: [1, 0, 0]}}}}}}
joints: {{shaft: {{type: pin, from: ground.O, to: w.o, axis: [0, 0, 1]}}}}
drives: {{motor: {{joint: shaft, angle: "{angle}"}}}}
"""
    )


def test_a_drive_whose_rate_jumps_is_a_blow() -> None:
    """From rest to 5 rad/s at 0.4 s: J ω about the shaft, 3 kg × 0.1 m × 5 rad/s across it; the ground bears both."""
    found = solved(wheel("5*max(t - 0.4, 0)") + "analysis: {duration: 1, samples: 11}\n")
    (hit,) = found.impulses
    moment = (2 + 3 * 0.01) * 5
    assert hit["time"] == pytest.approx(0.4, abs=1e-15) and list(hit["names"]) == ["motor"]
    near(hit["joints"]["shaft"]["drive"], moment, 10.0, EXACT)
    near(hit["joints"]["shaft"]["force"], (0, 1.5, 0), 1.5, EXACT)
    near(hit["foundation"]["force"], (0, -1.5, 0), 1.5, EXACT)
    near(hit["foundation"]["moment"], (0, 0, -moment), 10.0, EXACT)
    near(hit["foundation"]["elements"]["motor"]["moment"], (0, 0, -moment), 10.0, EXACT)
    near(hit["energy_jump"], moment * 5 / 2, 25.0, EXACT)
    rate = found.coordinates["shaft"]["rate"]
    near(rate, np.where(found.time >= 0.4, 5.0, 0.0), 5.0, EXACT)
    total = found.energy["kinetic"] + found.energy["potential"] - found.energy["work"]
    near(total, total[0], 25.0, 1e-9)


@pytest.mark.parametrize("angle", [
    "5*t - 5*max(t - 0.4, 0)", "5*min(t, 0.4)", "5*min(0.4, t)", "2 - 2.5*(0.4 - t) - 2.5*abs(0.4 - t)",
    "5*t if t <= 0.4 else 2", "5*t if t < 0.4 else 2",
])  # fmt: skip
def test_its_instant_is_told_as_after_it(angle: str) -> None:
    """Whichever way the drive is written: the wheel stands at 0.4 s, its drive and bearing are free of load."""
    found = solved(wheel(angle) + "analysis: {duration: 1, samples: 11}\n")
    (hit,) = found.impulses
    assert hit["time"] == pytest.approx(0.4, abs=1e-15)
    near(hit["joints"]["shaft"]["drive"], -10.15, 10.0, EXACT)
    turns = found.time < 0.4
    near(found.coordinates["shaft"]["rate"], 5.0 * turns, 5.0, EXACT)
    near(found.joints["shaft"]["force"][:, 0], -7.5 * np.cos(5.0 * found.time) * turns, 7.5, 1e-9)


def test_what_is_driven_does_not_jump() -> None:
    """A blow on a driven wheel goes into the drive and the bearing."""
    text = wheel("5*t") + "impulses: {blow: {on: w.rim, vector: [2, 3, 1], time: 0}}\n"
    found = blow(text)
    near(found["bodies"]["w"]["angular_velocity_jump"], np.zeros(3), 1.0, EXACT)
    near(found["joints"]["shaft"]["drive"], -3.0, 3.0, EXACT)
    near(found["foundation"]["force"], (2, 3, 1), 3.0, EXACT)
    near(found["foundation"]["moment"], (0, -1, 3), 3.0, EXACT)
    near(found["energy_jump"], 0.0, 1.0, EXACT)


@pytest.mark.parametrize("told", JOINTS)
def test_a_crank_set_going(told: str) -> None:
    """Its rate jumps from 100 to 200 rad/s at 60°: the slider's by as much as it had, and what that takes."""
    drive = 'drives: {motor: {joint: shaft, angle: "60*deg + 100*t + 100*max(t - 1e-3, 0) - 0.1"}}\n'
    found = solved(slider_crank(told, "", drive + "analysis: {times: [0, 1e-3, 2e-3], tolerance: 1e-12}\n"))
    (hit,) = found.impulses
    v = -10.1678107607332  # of the slider at 60° and 100 rad/s
    near(hit["bodies"]["slider"]["center_velocity_jump"], (v, 0, 0), 10.0, 1e-9)
    near(found.bodies["slider"]["velocity"][1], (2 * v, 0, 0), 20.0, 1e-9)
    near(hit["energy_jump"], 3 * hit["energy_before"], 500.0, 1e-9)
    near(hit["joints"]["shaft"]["drive"] * 150.0, hit["energy_jump"], 500.0, 1e-9)


def test_a_rate_that_jumps_as_the_run_ends() -> None:
    """The last instant is told as after the blow, too."""
    found = solved(wheel("5*max(t - 0.4, 0)") + "analysis: {times: [0, 0.2, 0.4]}\n")
    (hit,) = found.impulses
    near(hit["joints"]["shaft"]["drive"], 10.15, 10.0, EXACT)
    near(found.coordinates["shaft"]["rate"], (0, 0, 5), 5.0, EXACT)
    near(found.energy["kinetic"] - found.energy["work"], np.zeros(3), 25.0, EXACT)


# ---- ropes that only pull
def hung(at: np.ndarray, blow: np.ndarray, analysis: str = "type: impulse") -> str:
    """2 kg on a rope from the origin, struck."""
    small = "center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {c: [0, 0, 0]}"
    return (
        HEAD
        + f"""
gravity: [0, 0, -9.81]
bodies: {{b: {{mass: 2, {small}, position: {at.tolist()}}}}}
joints: {{rope: {{type: rod, from: ground.O, to: b.c, tension_only: true}}}}
impulses: {{hit: {{on: b.c, vector: {blow.tolist()}, time: {0.05 if "times" in analysis else 0}}}}}
analysis: {{{analysis}}}
"""
    )


def test_a_rope_pulls_in_a_blow() -> None:
    """Struck away from its end it takes that part of the blow and no other."""
    at, h = np.array([0.6, 0, -0.8]), np.array([3.0, 1, -1])
    found = blow(hung(at, h))
    near(found["joints"]["rope"]["tension"], h @ at, 3.0, EXACT)
    near(found["bodies"]["b"]["center_velocity_jump"], (h - (h @ at) * at) / 2, 2.0, EXACT)


def test_a_rope_does_not_push_in_a_blow() -> None:
    """Struck towards its end: refused, or a run ends just before it."""
    at = np.array([0.0, 0, -1])
    with pytest.raises(SolveError) as refusal:
        solved(hung(at, -at))
    assert refusal.value.problems[0].code == "rope-pushes"
    run = solved(hung(at, -at, "times: [0, 0.1]"))
    assert run.status["code"] == "stopped" and " rope " in run.status["message"] and not run.impulses
    assert run.time[-1] == pytest.approx(0.05)


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(20))
def test_struck_across_a_rope_neither_pulls_nor_pushes(seed: int) -> None:
    """But for rounding, which ends nothing."""
    rng = np.random.default_rng(seed)
    at = rng.standard_normal(3) * rng.uniform(0.2, 3)
    at[2] = -abs(at[2])
    h = np.cross(at, rng.standard_normal(3))
    found = blow(hung(at, h))
    near(found["bodies"]["b"]["center_velocity_jump"], h / 2, float(np.linalg.norm(h)), EXACT)
    near(found["joints"]["rope"]["tension"], 0.0, float(np.linalg.norm(h)), EXACT)


# ---- what redundant supports leave open
DOOR = (
    HEAD
    + """
bodies:
  door:
    mass: 5
    center: [0.4, 0, 0]
    inertia: [0.6, 1.0, 0.4]
    points: {top: [0, 0, 0.9], bottom: [0, 0, -0.7], knob: [0.8, 0, 0.1]}
joints:
  top: {type: ball, from: {body: ground, at: [0, 0, 0.9]}, to: door.top}
  bottom: {type: ball, from: {body: ground, at: [0, 0, -0.7]}, to: door.bottom}
impulses: {ram: {on: door.knob, vector: [3, 2, 7]}}
"""
)


def test_a_door_on_two_balls() -> None:
    """Along the line of its hinges the blow is carried by both, nobody knows by which how much."""
    found = blow(DOOR)
    spin = 0.8 * 2 / (0.4 + 5 * 0.16)  # about the hinges
    near(found["bodies"]["door"]["angular_velocity_jump"], (0, 0, spin), 1.0, EXACT)
    top, bottom = (found["joints"][n]["force"] for n in ("top", "bottom"))
    assert np.isnan([top[2], bottom[2]]).all() and not np.isnan([*top[:2], *bottom[:2]]).any()
    assert found["joints"]["top"]["open"] == ["force.z"]
    near(top[:2] + bottom[:2], (-3, 5 * 0.4 * spin - 2), 3.0, EXACT)
    near(found["foundation"]["force"], (3, 2 - 5 * 0.4 * spin, 7), 7.0, EXACT)
    (s,) = found["certain_sums"]
    assert {n: float(np.ravel(f)[0]) for n, f in s["terms"].items()} == {
        "joints.top.force.z": 1.0, "joints.bottom.force.z": 1.0}  # fmt: skip
    near(np.ravel(s["value"]), -7.0, 7.0, EXACT)
    # about the bottom hinge, y: the blow's moment, the top's, and nothing moves
    near(0.8 * 3 - 0.8 * 7 + 1.6 * top[0], 0.0, 10.0, EXACT)


def test_a_least_norm_split_of_it() -> None:
    found = solved(DOOR, least_norm=True).impulses[0]
    near([found["joints"][n]["force"][2] for n in ("top", "bottom")], (-3.5, -3.5), 7.0, EXACT)


def test_stiffness_splits_it() -> None:
    """Two to one, as forces would be."""
    text = DOOR.replace("to: door.top}", "to: door.top, stiffness: 2e8}").replace(
        "to: door.bottom}", "to: door.bottom, stiffness: 1e8}")  # fmt: skip
    found = solved(text).impulses[0]
    near([found["joints"][n]["force"][2] for n in ("top", "bottom")], (-14 / 3, -7 / 3), 7.0, EXACT)


def test_in_the_plane() -> None:
    """Two rods on pins, declared planar: nothing out of the plane, nothing open."""
    text = in_line(2, fixed=True).replace("heun: 1\n", "heun: 1\nspace: planar\n")
    found = blow(text)
    near([found["bodies"][f"r{k}"]["angular_velocity_jump"][2] for k in range(2)], (-6 / 7, 30 / 7), 1.0, EXACT)
    near(found["foundation"]["force"], (0, 1 / 7, 0), 1.0, EXACT)
    assert not found.get("certain_sums") and not any(j["open"] for j in found["joints"].values())


def test_what_nothing_holds_is_refused() -> None:
    """A straight chain between two supports struck across: with that speed it has no motion."""
    text = """
heun: 1
ground: {points: {A: [0, 0, 0], B: [2, 0, 0]}}
bodies:
  l: {mass: 1, center: [0.5, 0, 0], inertia: [0.01, 0.08, 0.08], points: {a: [0, 0, 0], c: [1, 0, 0]}}
  r: {mass: 1, center: [1.5, 0, 0], inertia: [0.01, 0.08, 0.08], points: {c: [1, 0, 0], b: [2, 0, 0]}}
joints:
  A: {type: pin, from: ground.A, to: l.a, axis: [0, 1, 0]}
  C: {type: pin, from: l.c, to: r.c, axis: [0, 1, 0]}
  B: {type: pin, from: r.b, to: ground.B, axis: [0, 1, 0]}
impulses: {blow: {on: l.c, vector: [0, 0, 1]}}
"""
    with pytest.raises(SolveError) as refusal:
        solved(text)
    (problem,) = refusal.value.problems
    assert problem.code in ("singular-pose", "closure-lost")


def test_free_bodies_and_thin_rods() -> None:
    """A free block, eccentrically: v = h/m, ω = J⁻¹ (r × h); a blow along a thin rod's axis is no twist."""
    free = blow(
        HEAD
        + """
bodies: {b: {mass: 2, center: [0, 0, 0], inertia: [1, 2, 3], points: {p: [0, 1, 2]}}}
impulses: {blow: {on: b.p, vector: [1, -1, 4]}}
"""
    )
    near(free["bodies"]["b"]["center_velocity_jump"], (0.5, -0.5, 2), 2.0, EXACT)
    near(free["bodies"]["b"]["angular_velocity_jump"], (6 / 1, 2 / 2, -1 / 3), 6.0, EXACT)
    near(free["foundation"]["force"], np.zeros(3), 1.0, EXACT)
