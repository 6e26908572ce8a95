"""`heun probe` against closed forms: growth, half turns, gimbal locks, dead centres, stability, condition."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from heuncli.analyses.motion_diagnostics.results import DEAD_CENTRE, GIMBAL, HALF_TURN, SINGULAR, Probe
from heuncli.analyses.motion_diagnostics.stiffness import find_stable_distance, stability_polynomial
from heuncli.analyses.motion_diagnostics.study import probe
from heuncli.motion.integration.methods.explicit import DOP853
from heuncli.motion.integration.methods.method import Method, load_method_by_name
from heuncli.motion.integration.run.kernel_loop import KernelLoop
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from tests.shared.bars import HEAD, rods

FLAT = Path(__file__).parents[2] / "specs" / "flat_four_bar.yaml"
SHADOW = 3e-6  # of a growth: 3e-14 a step, of shadows 1e-8 away; squares of disturbances are less
AXIS = """\
heun: 1
bodies: {{b: {{mass: 1, center: [0, 0, 0], inertia: [1, 2, 3], angular_velocity: {omega}}}}}
analysis: {{duration: {duration}, samples: 5}}
"""
ROD = "{mass: 1, center: [0, 0, 0.5], inertia: [1/12, 1/12, 0.01], points: {a: [0, 0, 0]}}"
CRANK = """\
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  crank: {mass: 1, center: [0.05, 0, 0], inertia: [1e-3, 1e-3, 1e-3], points: {o: [0, 0, 0], a: [0.1, 0, 0]}}
  rod: {mass: 1, center: [0.15, 0, 0], inertia: [1e-2, 1e-2, 1e-2], points: {a: [0, 0, 0], b: [0.3, 0, 0]},
        near: {position: [0.1, 0, 0]}}
  piston: {mass: 1, center: [0, 0, 0], inertia: [1e-3, 1e-3, 1e-3], points: {b: [0, 0, 0]},
           near: {position: [0.4, 0, 0]}}
joints:
  main: {type: pin, axis: [0, 0, 1], from: ground.O, to: crank.o, INITIAL}
  big: {type: pin, axis: [0, 0, 1], from: crank.a, to: rod.a}
  small: {type: ball, from: rod.b, to: piston.b}
  bore: {type: slide, axis: [1, 0, 0], from: ground.O, to: piston.b}
ANALYSIS
"""


def probed(text: str, **options: bool) -> Probe:
    return probe(load("scene.yaml", text), Options(**options))


def instants(found: Probe, kind: str, where: str = "") -> list[float]:
    return [event.time for event in found.events if event.kind == kind and event.where.startswith(where)]


def test_a_spin_about_the_intermediate_axis_is_left_as_theory_says() -> None:
    """Growth sqrt(1/3); heun solves it as a flat motion, in which nothing grows, and half turns come every 2 pi."""
    found = probed(AXIS.format(omega="[0, 1, 0]", duration=40))
    assert found.model["plane"] == "found"
    assert found.out_of_plane is not None and found.out_of_plane.exponential
    assert found.out_of_plane.rate == pytest.approx(math.sqrt(1.0 / 3.0), rel=SHADOW)
    assert found.growth is not None and not found.growth.exponential
    assert found.verdict.startswith("unstable out of plane")
    turns = np.array(instants(found, HALF_TURN))
    assert turns == pytest.approx(np.pi * (2 * np.arange(6) + 1), abs=1e-9)


def test_the_same_in_space() -> None:
    found = probed(AXIS.format(omega="[0, 1, 0]", duration=40), reduce=False)
    assert found.growth is not None and found.growth.exponential
    assert found.growth.rate == pytest.approx(math.sqrt(1.0 / 3.0), rel=SHADOW)
    assert found.growth.directions == 12 and found.growth.horizon is None
    # beyond the run: eps sqrt(n) e^(0.577 t) = 1e-3 at 46.8, 44.1, 42.8 s for 100, 2000, 10000 steps
    assert found.growth.expected_horizon == pytest.approx(44.8, abs=2.0)


@pytest.mark.parametrize(("joint", "across"), [("pin, axis: [0, 1, 0]", False), ("ball", True)])
def test_an_upright_rod_falls(joint: str, across: bool) -> None:
    """sqrt(1.5 g/L), in the plane and out of it."""
    text = f"{HEAD}bodies: {{r: {ROD}}}\njoints: {{p: {{type: {joint}, from: ground.O, to: r.a}}}}\n"
    found = probed(text + "analysis: {duration: 5, samples: 3}\n")
    rate = math.sqrt(1.5 * 9.81)
    assert found.growth is not None and found.growth.rate == pytest.approx(rate, rel=SHADOW)
    assert found.growth.logarithm == pytest.approx(math.log(math.cosh(5.0 * rate) ** 2) / 2.0, abs=1.0)
    if across:
        whole = probed(text + "analysis: {duration: 5, samples: 3}\n", reduce=False)
        assert whole.growth is not None and whole.growth.rate == pytest.approx(rate, rel=SHADOW)


def test_beside_a_run_by_scipy_the_kernel_runs() -> None:
    """It has no stages of such a method; its stiff one goes beside it, and finds what theory says."""
    found = probed(AXIS.format(omega="[0, 1, 0]", duration=40).replace("samples", "method: SciPy-LSODA, samples"))
    assert found.model["method"] == "SciPy-LSODA" and found.out_of_plane is not None
    assert found.out_of_plane.rate == pytest.approx(math.sqrt(1.0 / 3.0), rel=SHADOW)
    with pytest.raises(ValueError, match="no stages of SciPy-LSODA"):
        KernelLoop(None, None, load_method_by_name("SciPy-LSODA"), np.zeros(0), 1, None)  # type: ignore[arg-type]


def test_a_pendulum_forgets_nothing() -> None:
    found = probed(rods([1.0], [0.0], "{duration: 20, samples: 3}"))
    assert found.growth is not None and not found.growth.exponential and found.growth.horizon is None
    assert found.verdict == "no difficulties for heun's default method in this motion"


@pytest.mark.heavy
@pytest.mark.parametrize(("joint", "whole"), [("pin", False), ("ball", True)])
def test_the_horizon_of_the_double_pendulum(joint: str, whole: bool) -> None:
    """manual/theory.md, "Chaos": no value beyond about 15 s means anything, in the plane and in space."""
    text = rods([2.5, 2.5], [0.0, 0.0], "{duration: 25, samples: 26}")
    if joint == "ball":
        text = text.replace("type: pin", "type: ball").replace(", axis: [0, 0, 1]}", "}")
    found = probed(text, reduce=not whole)
    assert found.growth is not None and found.growth.horizon is not None
    assert 13.0 < found.growth.horizon < 17.0
    assert found.growth.rate == pytest.approx(1.65, abs=0.35)
    assert found.verdict.startswith("chaos: ")


@pytest.mark.parametrize("tilt", [1e-8, 1e-4, 1e-1])
def test_the_condition_of_euler_angles(tilt: float) -> None:
    """manual/theory.md, "Attitudes": 2e8 at 1e-8, 2e4 at 1e-4, 20 at 1e-1: the cotangent of half the angle."""
    body = f"{{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], orientation: {{axis: [1, 0, 0], angle: {tilt}}}}}"
    found = probed(f"heun: 1\nbodies: {{b: {body}}}\nanalysis: {{type: state}}\n")
    zxz, _ = found.attitudes[0].euler["zxz"]
    assert zxz == pytest.approx(1.0 / math.tan(0.5 * tilt), rel=1e-7)
    assert bool(instants(found, GIMBAL)) == (tilt < 1e-3)


def test_nearest_approach_to_a_lock() -> None:
    """A spin about x of a body whose z was tilted about y: its z is level's complement off z once a turn."""
    tilt, omega = 3e-4, 2.0
    turned = f"orientation: {{axis: [0, 1, 0], angle: {tilt}}}, angular_velocity: [{omega}, 0, 0]"
    body = f"{{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], {turned}}}"
    found = probed(f"heun: 1\nbodies: {{b: {body}}}\nanalysis: {{duration: 7, samples: 3}}\n")
    zxz, _ = found.attitudes[0].euler["zxz"]
    assert zxz == pytest.approx(1.0 / math.tan(0.5 * tilt), rel=1e-6)
    locks = [e.time for e in found.events if e.kind == GIMBAL and e.message.startswith("zxz")]
    assert locks == pytest.approx([k * np.pi / omega for k in range(5)], abs=1e-6)


@pytest.mark.parametrize("driven", [True, False])
def test_dead_centres_of_a_slider_crank(driven: bool) -> None:
    """The bore stands at 0 and 180 degrees, driven or free; the crank can always be driven through."""
    initial = "" if driven else ", initial: {angle: 1, rate: 20}"
    text = CRANK.replace(", INITIAL", initial)
    drive = "drives: {d: {joint: main, angle: 1 + 20*t}}\n" if driven else ""
    found = probed(text.replace("ANALYSIS", drive + "analysis: {duration: 0.3, samples: 4}"))
    assert {event.where for event in found.events if event.kind == DEAD_CENTRE} >= {"joints.bore"}
    assert not instants(found, DEAD_CENTRE, "joints.main")
    if driven:
        times = instants(found, DEAD_CENTRE, "joints.bore")
        assert times == pytest.approx([(np.pi - 1.0) / 20.0, (2.0 * np.pi - 1.0) / 20.0], abs=1e-9)


def test_one_instant() -> None:
    """At the dead centre, and beside it; what needs a motion is not told, with a reason."""
    for angle, there in (("180 deg", True), ("179 deg", False)):
        text = CRANK.replace(", INITIAL", f", initial: {{angle: {angle}, rate: 1}}")
        found = probed(text.replace("ANALYSIS", "analysis: {type: state}"))
        assert bool(instants(found, DEAD_CENTRE, "joints.bore")) == there
        block = found.to_block()
        assert block["growth_rate"] is None and block["horizon"] is None and "growth_rate" in block["not_told"]
        assert block["condition"]["mass"] >= 1.0


@pytest.mark.parametrize(("analysis", "told"), [("{duration: 1, samples: 4}", True), ("{type: state}", False)])
def test_a_law_without_a_slope_at_the_start(analysis: str, told: bool) -> None:
    """A root of the squared rate, which is 0 there: the tangent is looked at elsewhere, or said to be none."""
    block = probed(f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{bar: {{mass: 1, center: [0.5, 0, 0], inertia: [0.01, 0.1, 0.1], points: {{O: [0, 0, 0]}}}}}}
joints: {{pivot: {{type: pin, from: ground.O, to: bar.O, axis: [0, 1, 0]}}}}
forces: {{drag: {{type: torque, joint: pivot, value: "-0.1*sqrt(pivot.rate**2)"}}}}
analysis: {analysis}
""").to_block()
    assert (block["stiffness"] is not None) == told
    assert ("no derivative" in block["not_told"].get("stiffness", "")) != told


def test_a_flat_four_bar_is_told_as_singular() -> None:
    found = probed(FLAT.read_text(encoding="utf-8"))
    assert len(instants(found, SINGULAR)) == 2 and found.verdict.startswith("singular positions")


def test_a_stiff_damper_bounds_explicit_steps() -> None:
    """m x'' + c x' + k x = 0 falls apart into k/c and c/m: the faster decay allows steps of 6.4 m/c."""
    text = """\
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {b: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}}
joints: {s: {type: slide, axis: [1, 0, 0], from: ground.O, to: b.c, initial: {travel: 1}}}
forces: {k: {type: torque, joint: s, value: -100*s.travel - 2000*s.speed}}
analysis: {duration: 1, samples: 3, tolerance: 1e-6}
"""
    found = probed(text)
    stiff = found.stiffness
    assert stiff is not None
    fast = 0.5 * (1e3 + math.sqrt(1e6 - 200.0))
    assert stiff.decay == pytest.approx(fast, rel=1e-6)
    row = next(step for step in stiff.steps if step.method == "DOP853")
    assert row.stability == pytest.approx(find_stable_distance(DOP853, -1.0 + 0j) / fast, rel=1e-6)
    assert stiff.ratio > 10.0 and found.trouble[0].startswith("stiff")


RK4 = Method(
    name="RK4", order=4, nodes=(0.0, 0.5, 0.5, 1.0), stages=(((0, 0.5),), ((1, 0.5),), ((2, 1.0),)),
    solution=((0, 1 / 6), (1, 1 / 3), (2, 1 / 3), (3, 1 / 6)),
)  # fmt: skip


def test_stability_polynomials() -> None:
    """Of RK4 the exponential's series to z^4, stable to 2.785 on the real axis and to 2 sqrt 2 on the imaginary one."""
    assert stability_polynomial(RK4) == pytest.approx([1.0, 1.0, 1 / 2, 1 / 6, 1 / 24], rel=1e-15)
    assert find_stable_distance(RK4, -1.0 + 0j) == pytest.approx(2.785, abs=0.01)
    assert find_stable_distance(RK4, 1j) == pytest.approx(2.0 * math.sqrt(2.0), abs=0.01)
    assert math.isinf(find_stable_distance(RK4, 1.0 + 0j))
    coefficients = stability_polynomial(DOP853)
    assert coefficients[:9] == pytest.approx([1.0 / math.factorial(k) for k in range(9)], rel=1e-13)


def test_the_condition_of_a_mass_matrix() -> None:
    """A free body of mass 2 and size 3 m: shifts count 2 * 9, turns their moments."""
    body = "{mass: 2, center: [0, 0, 0], inertia: [1, 1.5, 2], points: {p: [3, 0, 0]}}"
    found = probed(f"heun: 1\nbodies: {{b: {body}}}\nanalysis: {{type: state}}\n")
    assert found.mass is not None
    size = 3.0
    assert found.mass.value == pytest.approx(2.0 * size * size / 1.0, rel=1e-12)
    assert found.mass.where == "bodies.b"


def braked(angle: float, rate: float, t: float) -> tuple[float, float]:
    """Angle and rate of a wheel braked by .5 where sin 4a > 0, else driven by it: pieces of steady acceleration."""
    while True:
        k = math.floor(angle / (0.25 * math.pi) + 1e-9)  # at an edge the piece behind it
        a = -0.5 if k % 2 == 0 else 0.5
        way = (k + 1) * 0.25 * math.pi - angle
        behind = math.sqrt(rate * rate + 2.0 * a * way)
        took = 2.0 * way / (rate + behind)
        if took > t:
            return angle + rate * t + 0.5 * a * t * t, rate + a * t
        angle, rate, t = (k + 1) * 0.25 * math.pi, behind, t - took


def test_growth_through_loads_that_jump_with_an_angle() -> None:
    """Steps end where they jump; a disturbance has crossed there or not yet. It grows with the time, no faster."""
    text = """\
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {w: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}}
joints: {s: {type: pin, axis: [0, 0, 1], from: ground.O, to: w.o, initial: {angle: 0.1, rate: 2}}}
forces: {b: {type: torque, joint: s, value: "-0.5 if sin(4*s.angle) > 0 else 0.5"}}
analysis: {duration: 20, samples: 3}
"""
    found = probed(text).growth
    rate = max(braked(0.1, 2.0, t)[1] for t in (0.0, 10.0, 20.0))  # disturbances of rates are counted by it
    d = 1e-5
    by_angle = (braked(0.1 + d, 2.0, 20.0)[0] - braked(0.1 - d, 2.0, 20.0)[0]) / (2.0 * d)
    by_rate = (braked(0.1, 2.0 + d, 20.0)[0] - braked(0.1, 2.0 - d, 20.0)[0]) / (2.0 * d)
    assert found is not None and not found.exponential
    assert found.logarithm == pytest.approx(math.log(math.hypot(by_angle, rate * by_rate)), abs=1e-4)


def test_what_an_implicit_method_takes_troubles_the_others_alone() -> None:
    """A strut of 8e5 N/m with 4e4 Ns/m, driven: c/m = 4e4/s, and k/c = 20/s, which the run follows."""
    text = """\
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {b: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}}
joints: {s: {type: slide, axis: [1, 0, 0], from: ground.O, to: b.c, initial: {travel: 0.1, speed: 0}}}
forces: {k: {type: torque, joint: s, value: "-8e5*s.travel - 4e4*s.speed + 100*sin(t)"}}
analysis: {duration: 10, samples: 3, tolerance: 1e-6}
"""
    found = probed(text)
    assert found.implicit_method == "Radau9" and found.stiffness is not None and found.stiffness.ratio > 100.0
    assert found.verdict == "no difficulties for heun's default method in this motion" and not found.trouble
    assert any(words.startswith("stiff: ") and "Radau9" in words for words in found.others)
    assert found.growth is not None and found.growth.stop_reason is None  # runs beside it come to the end
    slow = 4e4 / 2.0 - math.sqrt(4e8 - 8e5)
    assert found.growth.logarithm == pytest.approx(-10.0 * slow, rel=0.02)
    by_hand = probed(text.replace("tolerance", "method: SciPy-Radau, tolerance"))
    assert by_hand.implicit_method == "SciPy-Radau" and not by_hand.trouble


def test_what_is_free_neither_decays_nor_oscillates() -> None:
    """A balanced arm on its spring: double zeros of the tangent, of which rounding makes 1e-7 a second."""
    found = probed((FLAT.parent / "lamp.yaml").read_text(encoding="utf-8"))
    assert found.stiffness is not None
    assert (found.stiffness.decay, found.stiffness.oscillation) == (0.0, 0.0)
    assert math.copysign(1.0, found.stiffness.decay) == 1.0
    assert all(math.isinf(step.stability) for step in found.stiffness.steps)
