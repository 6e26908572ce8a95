"""`heun lagrange` against closed forms: pendulums, slider-cranks, a top by Rodrigues' vector, a pole on a cart."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from heuncli.analyses.lagrange.inertia_curve import find_inertia_curve
from heuncli.analyses.lagrange.results import InertiaCurve
from heuncli.app.commands.lagrange.command import parse_range
from heuncli.base.errors import SolveError
from heuncli.scene.file_format.load import load
from heuncli.scene.shapes.rotations import cross_matrix
from tests.oracle.published import START, andrews
from tests.shared.folders import ROOT
from tests.shared.lagrange import double, told
from tests.shared.scenes import solved

DIGITS = 2e-14  # of the largest: a dozen sums
CRANK = ROOT / "specs" / "slider_crank.yaml"


def near(found: Any, wanted: Any, size: float | None = None) -> None:
    a, b = np.asarray(found, dtype=float), np.asarray(wanted, dtype=float)
    assert a.shape == b.shape
    assert np.abs(a - b).max() <= DIGITS * (np.abs(b).max() if size is None else size)


def test_a_double_pendulum() -> None:
    """Every symbol of the two uniform rods, by hand from their energy."""
    found = told(double(), christoffel=True)
    assert found.names == ("A.angle", "B.angle") and found.gamma is not None and found.alpha is not None
    near(found.values, [0.7, -1.1])
    near(found.epsilon, [[2.120262788092244, 0.5601313940461220], [0.5601313940461220, 1 / 3]])
    near(found.eta, [[0.8481611319946626, -1.425245031719722], [-1.425245031719722, 5.394973459423432]])
    g = 0.4456036800307177
    near(found.gamma, [[[0, g], [g, g]], [[-g, 0], [0, 0]]])
    a = 0.6350944310798050
    b = 0.3779437216758409
    near(found.alpha, [[[-a, -b], [-b, -b]], [[2.404020027187133, a], [a, a]]])
    near(found.coriolis, [-0.8912073600614353, -1.002608280069115])
    near(found.coriolis_matrix, [[-0.8912073600614353, -0.2228018400153588], [-0.6684055200460765, 0]])
    near(found.momenta, [2.060131394046122, 0.1735304244025164])
    near(found.total_force, [-7.569566298678693, 1.910096969023931])
    near(found.accelerations, [-9.815643162378105, 25.23226541128554])
    near([found.energy, found.reciprocal_energy], [1.371568121132075] * 2)
    near([one.others_free for one in found.apparent_inertias], [1.179021252304088, 0.1853577237258311])
    near([one.others_locked for one in found.apparent_inertias], [2.120262788092244, 1 / 3])
    assert found.residual <= DIGITS


def test_forces_stand_beside_each_other() -> None:
    loads = "forces: {push: {type: force, on: b.e, vector: [3, 0, 0]}, rub: {type: damper, joint: B, coefficient: 0.7}}"
    found = told(double(f"{loads}\nanalysis: {{type: state}}"))
    near(found.forces["push"], [5.057709543862122, 2.763182982008656])
    near(found.forces["rub"], [0.0, 1.4])
    near(found.total_force, sum(found.forces.values()))


def test_what_a_section_passes_on() -> None:
    """s' of the outer 0.6 m of rod two: what is applied to it less what its motion takes, along each coordinate."""
    near(told(double()).sections["cut"].s[0], [-1.426414518612498, -0.4933319119650378])
    blow = told(double("impulses: {hit: {on: b.e, vector: [2, 0, 0]}}\nanalysis: {type: impulse}", (0, 0))).impulses[0]
    near(blow.h, [3.371806362574747, 1.842121988005770])
    near(blow.sections["cut"].s[0], [0.4896150774109775, 0.1229984346168536])
    near(blow.reciprocal_energy, 5.122498738676783)
    near(blow.jumps, [0.2343598901213223, 5.132548968130854])


TURN = {  # degrees: inertia at the crank, half its slope
    0: (0.006, 0.0), 30: (0.01424321996980808, 0.01334376507819028), 60: (0.02661272834625254, 0.007060055117462295),
    90: (0.02633333333333333, -0.006717514421272201), 120: (0.01669030195677776, -0.009664016729724799),
    150: (0.008680589554001442, -0.005177160251070724), 180: (0.006, 0.0),
}  # fmt: skip
MEAN = 0.01642669572178526


def course(name: str = "slider_crank", words: str = "main.angle=0:360deg/73") -> InertiaCurve:
    spec = load(str(ROOT / "specs" / f"{name}.yaml"))
    return find_inertia_curve(spec, parse_range(words, spec))


@pytest.mark.parametrize("name", ["slider_crank", "slider_crank_pins"])
def test_the_inertia_of_a_slider_crank_over_its_turn(name: str) -> None:
    """Also where supports are redundant: they do no virtual work."""
    found = course(name)
    assert found.is_driven and len(found.values) == 73
    for degrees, (inertia, slope) in TURN.items():
        k = degrees // 5
        near([found.values[k], found.epsilon[k], found.half[k]], [math.radians(degrees), inertia, slope], 1.0)
    near(found.mean, MEAN)
    near(found.half, -found.half[::-1], 1.0)


def test_a_range_that_goes_back_from_its_start() -> None:
    """It is followed to either side of where the scene stands, and told in the order asked for."""
    whole, part = course(), course(words="main.angle=90deg:30 deg/13")
    near(part.values, np.radians(np.linspace(90.0, 30.0, 13)))
    near(part.epsilon, whole.epsilon[6:19][::-1])
    near(part.half, whole.half[6:19][::-1])


def test_what_drives_a_slider_crank() -> None:
    found = told(CRANK)
    near(found.drives, [70.60055117462295])
    near(found.coriolis, found.drives)
    near(told(CRANK, coordinates=("guide.travel",)).epsilon, [[2.574153799816733]])


def test_a_crank_that_is_let_go_against_a_force() -> None:
    text = CRANK.read_text().split("drives:")[0].replace("phi: 60 deg, w: 100 rad/s", "phi: 1, w: 10")
    text = text.replace("axis: [0, 0, 1]}\n  big", "axis: [0, 0, 1], initial: {angle: phi, rate: w}}\n  big")
    found = told(text + "forces: {F: {type: force, on: slider.pin, vector: [1000, 0, 0]}}\nanalysis: {type: state}\n")
    near([found.epsilon[0, 0], found.coriolis[0]], [0.02588649693056331, 0.8314275544747639], 1.0)
    near(found.total_force, [-99.93586644862434])
    near(found.accelerations, [-3892.658565328187])


def test_a_dead_centre_tells_nothing() -> None:
    text = CRANK.read_text().replace("phi: 60 deg", "phi: 0")
    with pytest.raises(SolveError, match=r"guide\.travel cannot describe the motion here.*dead centre.*no-coordinate"):
        told(text, coordinates=("guide.travel",))


def test_a_top_by_its_rodrigues_vector() -> None:
    k, rate = np.array([0.1, 0.2, 0.3]), np.array([0.4, -0.5, 0.6])
    omega = 2.0 / (1.0 + k @ k) * (np.eye(3) + cross_matrix(k)) @ rate
    q = (np.array([1.0, *k]) / np.sqrt(1.0 + k @ k)).tolist()
    top = f"mass: 2, center: [0, 0, 0.3], inertia: [1.82, 2.32, 3], orientation: {{quaternion: {q}}}"
    scene = f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{top: {{{top}, points: {{o: [0, 0, 0]}}, angular_velocity: {omega.tolist()}}}}}
joints: {{b: {{type: ball, from: ground.O, to: top.o}}}}
analysis: {{type: state}}
"""
    found = told(scene, coordinates=("rodrigues",), christoffel=True)
    assert found.gamma is not None
    near(found.values, k)
    near(found.rates, rate)
    diagonal = [7.217605417051400, 8.341028008618036, 9.556786703601108]
    near(np.diag(found.epsilon), diagonal)
    near(found.epsilon[[0, 0, 1], [1, 2, 2]], [-0.6463527239150508, 0.3847337642351493, -0.5232379193598030], 9.6)
    near(np.diag(found.eta), [0.1397608333333333, 0.1210933333333333, 0.1051808333333333])
    near(found.eta[[0, 0, 1], [1, 2, 2]], [0.01051333333333333, -0.005050833333333333, 0.006206666666666667], 0.14)
    near(found.momenta, [3.441058787319175, -4.742997845490920, 6.149584487534626])
    near(found.energy, 3.718836565096953)
    near(found.coriolis, [-1.713725680776271, 0.1746286306717857, -1.321702224166140])
    near(found.total_force, [1.974681440443213, 3.949362880886427, -0.2717451523545706])
    near(found.accelerations, [0.5498767341746178, 0.5023893398994562, 0.1152343473889402])
    symbols = found.gamma[[0, 0, 1, 2], [0, 1, 0, 2], [0, 2, 2, 2]]
    assert np.abs(symbols - [-1.2662465643950, 1.6523302716625, -2.5108940402715, -5.0298877387374]).max() < 1e-12
    plain = told(scene)
    near(plain.accelerations, [0.4932529300063537, 1.313088604140905, -0.07622707697735152])
    assert plain.gamma is None and any("quasi-velocities" in note for note in plain.notes)


CART = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  cart: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{c: [0, 0, 0]}}}}
  pole: {{shapes: [{{type: rod, from: [0, 0, 0], to: [0, 0, 0.6], mass: 0.2}}], points: {{foot: [0, 0, 0]}}}}
joints:
  rail: {{type: slide, axis: [1, 0, 0], from: ground.O, to: cart.c}}
  hinge: {{type: pin, axis: [0, -1, 0], from: cart.c, to: pole.foot}}
forces:
  push: {{type: torque, joint: rail, value: 0}}
  drag: {{type: damper, joint: rail, coefficient: {drag}}}
  rub: {{type: damper, joint: hinge, coefficient: {rub}}}
analysis: {{type: state}}
"""


def test_the_matrices_of_a_pole_on_a_cart() -> None:
    found = told(CART.format(drag=0.5, rub=0.01), state_space=True, inputs=("push",))
    near(found.epsilon, [[1.2, -0.06], [-0.06, 0.024]])
    linear = found.state_space
    assert linear is not None and linear.states == ("rail.travel", "hinge.angle", "rail.speed", "hinge.rate")
    lower = [
        [0, 1.401428571428571, -0.4761904761904762, -0.02380952380952381],
        [0, 28.02857142857143, -1.190476190476190, -0.4761904761904762],
    ]
    near(linear.A, [[0, 0, 1, 0], [0, 0, 0, 1], *lower])
    near(linear.B, [[0], [0], [0.9523809523809524], [2.380952380952382]])
    near(linear.C, np.eye(4)[:2])
    poles = np.sort(np.linalg.eigvals(linear.A).real)
    assert np.abs(poles - [-5.57135837, -0.41629895, 0.0, 5.03527636]).max() < 5e-9
    bare = told(CART.format(drag=0, rub=0), state_space=True, inputs=("push",)).state_space
    assert bare is not None
    assert np.abs(np.linalg.eigvals(bare.A).real).max() == pytest.approx(5.294201680005346, rel=1e-12)


ROD_ON_A_SHAFT = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  shaft: {mass: 1, center: [0, 0, 0], inertia: [0, 0, 0], points: {o: [0, 0, 0]}}
  rod: {shapes: [{type: rod, from: [0, 0, 0], to: [0, 0, -1], mass: 1}], points: {o: [0, 0, 0]}}
joints:
  main: {type: pin, axis: [0, 0, 1], from: ground.O, to: shaft.o}
  hinge: {type: pin, axis: [0, -1, 0], from: shaft.o, to: rod.o, initial: {angle: 40 deg, rate: 2}}
drives: {motor: {joint: main, angle: 10*t}}
analysis: {type: state}
"""


def test_a_rod_across_a_shaft_that_is_driven() -> None:
    """Coriolis' torque on the drive."""
    found = told(ROD_ON_A_SHAFT)
    assert found.names == ("main.angle", "hinge.angle") and found.is_driven == (True, False)
    near(np.diag(found.epsilon), [0.1377253037221782, 1 / 3])
    near([found.coriolis[1], found.total_force[1]], [-16.41346255020347, -3.152873225512475])
    near(found.accelerations, [0.0, 39.78176797407298])
    near(found.drives, [6.565385020081387, 0.0])
    free, mixed, driven = found.energies
    near([free, mixed, driven], [0.5 / 3 * 4, 0.0, 0.5 * found.epsilon[0, 0] * 100], 7.0)


def test_friction_by_what_a_driven_joint_carries() -> None:
    """k of it is that of the scene as it is driven: without its drive the joints would carry other loads."""
    rubs = "forces: {rub: {type: friction, joint: guide, coefficient: 0.2, speed: 1e-3}}\n"
    text = CRANK.read_text().split("expect:")[0] + rubs
    found = told(text)
    results = solved(text)
    carried = np.abs(results.joints["guide"]["force"][0, 1])
    speed = results.coordinates["guide"]["speed"][0]
    assert found.forces["rub"][0] == pytest.approx(-0.2 * carried * abs(speed) / 100.0, rel=1e-12)
    near(found.drives, [results.joints["main"]["drive"][0]])
    assert found.residual <= DIGITS
    for asked in ({"state_space": True}, {}):
        with pytest.raises(SolveError, match=r"friction depends on the joint reaction"):
            if asked:
                told(text, **asked)
            else:
                spec = load("scene.yaml", text)
                find_inertia_curve(spec, parse_range("main.angle=0:1", spec))


@pytest.mark.parametrize(("name", "coordinate"), [("slider_crank", "main.angle"), ("four_bar_balanced", "crank.angle")])
def test_the_slope_of_the_inertia_over_a_turn(name: str, coordinate: str) -> None:
    """Half of de/dq by the accelerations is that of the trigonometric polynomial through e; over a turn it vanishes."""
    found = course(name, f"{coordinate}=0:360deg/181")
    e = found.epsilon[:-1]
    n = len(e)
    slope = np.fft.irfft(1j * np.arange(n // 2 + 1) * np.fft.rfft(e) * (np.arange(n // 2 + 1) < n // 2), n)
    assert np.abs(0.5 * slope - found.half[:-1]).max() <= 1e-11 * np.abs(e).max()
    assert abs(found.half[:-1].mean()) <= DIGITS * np.abs(found.half).max() * 10.0


def test_the_inertia_of_the_squeezing_mechanism() -> None:
    """Andrews at his start: the published b'' follows from it and the motor's torque."""
    found = told({**andrews(START, dict.fromkeys(START, 0.0)), "analysis": {"type": "state"}})
    assert found.names == ("O.angle",)
    assert found.epsilon[0, 0] == pytest.approx(2.32027633125e-6, rel=1e-11)
    assert found.total_force[0] / found.epsilon[0, 0] == pytest.approx(14222.4439199541, rel=1e-7)
