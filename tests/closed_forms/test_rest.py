"""Rest poses against closed forms, an independent minimum of the energy, and against themselves: what rests stays.

Steady states of what drives turn; ropes and stops that bear or do not; why there is no rest.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from heuncli.base.errors import SolveError
from heuncli.loads.equilibrium.coordinates import make_coordinates
from heuncli.loads.equilibrium.directions import decompose
from heuncli.loads.equilibrium.pose import Pose, make_bearing_pose
from heuncli.loads.equilibrium.rest_law import RestLaw
from heuncli.loads.equilibrium.search import RestSearch
from heuncli.loads.equilibrium.verification import require_at_rest
from heuncli.motion.integration.run.request import MotionTask
from heuncli.results.results import Array, Results
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve
from tests.shared.folders import ROOT
from tests.shared.scenes import near, solved, study
from tests.shared.settled_scenes import BALL, BAR, HEAD, PIN, POINTS, G, tree, triangle

pytestmark = pytest.mark.heavy  # families: the plain kernel has the same bits (tests/package/test_kernels_agree.py)


def pendulum(angle: str, more: str = "") -> str:
    """A bar of 1 m on a pin."""
    pin = f"p: {{{PIN}, from: ground.O, to: bar.top, initial: {{angle: {angle}}}}}"
    return f"{HEAD}{POINTS}bodies: {{bar: {{{BAR}}}}}\njoints: {{{pin}}}\n{more}"


def refused(text: str) -> str:
    """Why there is no rest pose."""
    with pytest.raises(SolveError) as caught:
        solved(text)
    problem = caught.value.problems[0]
    assert problem.code == "no-rest-pose"
    assert problem.hint
    return problem.message


def unstable(results: Results) -> bool:
    return any("unstable" in warning for warning in results.warnings)


# ---- ridges ----------------------------------------------------------------------------------------------------
def ridge(beside: float) -> Results:
    """x' = x + 0.3 y^2, y' = -y from y = 1, between stops at x = -1 and 1.

    x e^-s goes to x(0) + 0.3/3: from x(0) = -0.1 it stays between them, from beside that it goes to one of the stops.
    """
    bodies = f"bodies: {{x: {{{BALL}}}, y: {{{BALL}}}}}"
    joints = (
        f"ux: {{type: slide, axis: [1, 0, 0], from: ground.O, to: x.c, initial: {{travel: {-0.1 + beside!r}}}}}, "
        "uy: {type: slide, axis: [0, 1, 0], from: ground.O, to: y.c, initial: {travel: 1}}"
    )
    forces = (
        "fx: {type: torque, joint: ux, value: 2*ux.travel + 0.6*uy.travel**2}, "
        "fy: {type: torque, joint: uy, value: -2*uy.travel}"
    )
    stops = "stops: {x: {joint: ux, travel: [-1, 1]}}"
    return solved(f"{HEAD}{POINTS}{bodies}\njoints: {{{joints}}}\nforces: {{{forces}}}\n{stops}\n")


@pytest.mark.parametrize("beside", [0.1, -0.1, 1e-3, -1e-3, 1e-4, -1e-4])
@pytest.mark.third
def test_beside_a_ridge_the_way_goes_to_its_side(beside: float) -> None:
    results = ridge(beside)
    near(results.coordinates["ux"]["travel"][0], math.copysign(1.0, beside), 1.0, 1e-12)
    assert not results.warnings


@pytest.mark.parametrize("beside", [1e-9, -1e-9, 1e-12, -1e-12])
@pytest.mark.third
def test_on_a_ridge_the_other_pose_is_told(beside: float) -> None:
    results = ridge(beside)
    side = float(results.coordinates["ux"]["travel"][0])
    near(abs(side), 1.0, 1.0, 1e-12)
    (told,) = results.warnings
    assert "ridge" in told
    assert told.endswith(f"ux.travel = {-side:.6g} m")


# ---- chains and springs ----------------------------------------------------------------------------------------
SPAN, LENGTH = 1.0, 1.5


def chain(places: Array) -> str:
    """Rods of 1 kg/m between places in the xz plane, the first and the last on the ground; pins."""
    n = len(places) - 1
    lines = []
    for i, (p, q) in enumerate(zip(places[:-1].tolist(), places[1:].tolist(), strict=True)):
        shape = f"{{type: rod, from: {p}, to: {q}, line_density: 1}}"
        lines.append(f"  l{i}: {{shapes: [{shape}], points: {{a: {p}, b: {q}}}}}")
    ends = [f"ground.A, to: l{0}.a", *(f"l{i}.b, to: l{i + 1}.a" for i in range(n - 1))]
    joints = [f"  j{i}: {{{PIN}, from: {end}}}" for i, end in enumerate(ends)]
    joints.append(f"  last: {{type: line, axis: [0, 1, 0], from: l{n - 1}.b, to: ground.B}}")
    ground = f"ground: {{points: {{A: {places[0].tolist()}, B: {places[-1].tolist()}}}}}"
    return "\n".join([HEAD + ground, "bodies:", *lines, "joints:", *joints])


def parameter() -> float:
    """a of z = a cosh(x/a), which hangs from level ends: 2 a sinh(SPAN / 2a) = LENGTH."""
    return float(brentq(lambda a: 2.0 * a * math.sinh(SPAN / (2.0 * a)) - LENGTH, 0.05, 5.0, xtol=1e-15))


def tent(n: int) -> Array:
    """n links drawn as two straight halves, standing up."""
    s = np.linspace(0.0, 1.0, n + 1)
    h = math.sqrt((LENGTH / 2.0) ** 2 - (SPAN / 2.0) ** 2)
    return np.stack([SPAN * s, 0.0 * s, -2.0 * h * np.minimum(s, 1.0 - s)], axis=1)


def test_a_chain_hangs_in_the_catenary() -> None:
    """Links of equal length err by 1/n^2: of the pull H = w a, and of the sag."""
    a, errors = parameter(), []
    for n in (6, 12, 24):
        found = solved(chain(tent(n)))
        assert not found.warnings
        sag = found.bodies[f"l{n // 2}"]["position"][0] + found.bodies[f"l{n // 2}"]["rotation"][0] @ tent(n)[n // 2]
        deep = a * (math.cosh(SPAN / (2.0 * a)) - 1.0)
        errors.append([abs(found.joints["last"]["force"][0, 0]) / (G * a) - 1.0, -sag[2] / deep - 1.0])
        near(abs(found.joints["j0"]["force"][0, 2]), G * LENGTH / 2.0, G, 1e-10)
    ratios = np.array(errors[:-1]) / np.array(errors[1:])
    assert np.all(np.abs(ratios[-1] - 4.0) < 0.15), ratios


def test_fifty_links() -> None:
    """From the catenary itself, cut into equal chords: the pull to its own 1/n^2."""
    a, n = parameter(), 50
    s = np.linspace(-LENGTH / 2.0, LENGTH / 2.0, n + 1)
    x = a * np.arcsinh(s / a)
    places = np.stack([x + SPAN / 2.0, 0.0 * s, a * np.cosh(x / a)], axis=1)
    found = solved(chain(places))
    assert abs(abs(found.joints["last"]["force"][0, 0]) / (G * a) - 1.0) < 2.0 / n**2


def plate(rng: np.random.Generator) -> tuple[str, Array, Array, Array, float]:
    """A plate on three springs without length, hung at its centre of mass: ground ends, points, stiffnesses, mass."""
    tops: Array = np.array([[1.0, 0.0, 1.0], [-0.6, 0.8, 1.2], [-0.5, -0.9, 0.9]]) + rng.uniform(-0.2, 0.2, (3, 3))
    own = np.array([[0.8, 0.1, 0.0], [-0.5, 0.6, 0.1], [-0.4, -0.7, 0.05]]) + rng.uniform(-0.1, 0.1, (3, 3))
    k, mass = rng.uniform(30.0, 80.0, 3), 3.0
    ground = ", ".join(f"G{i}: {p}" for i, p in enumerate(tops.tolist()))
    points = ", ".join(f"p{i}: {p}" for i, p in enumerate(own.tolist()))
    springs = "\n".join(
        f"  s{i}: {{type: spring, from: ground.G{i}, to: plate.p{i}, stiffness: {float(k[i])!r}, length: 0}}"
        for i in range(3)
    )
    body = f"mass: {mass}, center: [0, 0, 0], inertia: [0.3, 0.4, 0.6], points: {{{points}}}"
    text = f"{HEAD}ground: {{points: {{{ground}}}}}\nbodies: {{plate: {{{body}}}}}\nforces:\n{springs}\n"
    return text, tops, own, k, mass


@pytest.mark.parametrize("seed", range(3))
def test_a_plate_on_three_springs(seed: int) -> None:
    """sum k |x + R p - G|^2 / 2 + m g z is least where R turns the moments best onto each other (Kabsch)."""
    text, tops, own, k, mass = plate(np.random.default_rng(seed))
    mean_top, mean_own = k @ tops / k.sum(), k @ own / k.sum()
    U, _, V = np.linalg.svd((own - mean_own).T @ (k[:, None] * (tops - mean_top)))
    R = V.T @ np.diag([1.0, 1.0, np.linalg.det(V.T @ U.T)]) @ U.T
    # weight acts at the centre, which the springs' own resultant does not pass: with it the moment is shifted
    found = solved(text)
    x, turned = found.bodies["plate"]["position"][0], found.bodies["plate"]["rotation"][0]
    force = sum(k[i] * (tops[i] - x - turned @ own[i]) for i in range(3))
    near(force, [0.0, 0.0, mass * G], mass * G, 1e-13)
    moment = sum(np.cross(turned @ own[i], k[i] * (tops[i] - x - turned @ own[i])) for i in range(3))
    near(moment, np.zeros(3), mass * G, 1e-13)
    assert np.linalg.norm(turned - R) < 0.9  # on the branch of the least energy
    if seed == 0:
        light = solved(text.replace(f"-{G}", "0"))
        near(light.bodies["plate"]["rotation"][0], R, 1.0, 1e-13)
        near(light.bodies["plate"]["position"][0], mean_top - R @ mean_own, 1.0, 1e-13)


@pytest.mark.parametrize(("stiff", "soft"), [(100.0, 20.0), (1e9, 1.0), (1.0, 1e9), (1e3, 1e-3)])
def test_spring_scales(stiff: float, soft: float) -> None:
    """Two masses one below the other: z = -L - (m + n) g / k, and the lower one m g / k more."""
    bodies = f"bodies: {{a: {{{BALL}, position: [0, 0, -1]}}, b: {{{BALL}, position: [0, 0, -2.1]}}}}\n"
    slides = ", ".join(f"{x}: {{type: slide, from: ground.O, to: {y}.c, axis: [0, 0, 1]}}" for x, y in ("ua", "vb"))
    springs = (
        f"forces: {{s: {{type: spring, from: ground.O, to: a.c, stiffness: {stiff}, length: 1}}, "
        f"q: {{type: spring, from: a.c, to: b.c, stiffness: {soft}, length: 1}}}}"
    )
    found = solved(f"{HEAD}{POINTS}{bodies}joints: {{{slides}}}\n{springs}")
    a = -1.0 - 4.0 * G / stiff
    wanted = np.array([a, a - 1.0 - 2.0 * G / soft])
    told = np.array([found.bodies[x]["position"][0, 2] for x in "ab"])
    near(told, wanted, float(np.abs(wanted).max()), 1e-12)
    assert np.abs(told - wanted).max() <= 3.0 * found.accuracy["estimate"]["motion"] * np.abs(wanted).max() + 1e-15
    near(found.forces["s"]["value"], -4.0 * G, 4.0 * G, 1e-6 if stiff > 1e8 else 1e-11)


def test_a_follower_load() -> None:
    """sin of the lower bar = -2F/mg, tan of the upper one = -F cos / (1.5 m g + F sin): moments about the two pins."""
    F = 2.0
    lower = f"l: {{{BAR}, orientation: {{axis: [0, 1, 0], angle: 20 deg}}}}"
    joints = f"joints: {{p: {{{PIN}, from: ground.O, to: u.top}}, e: {{{PIN}, from: u.end, to: l.top}}}}\n"
    push = f"forces: {{f: {{type: force, on: l.end, vector: [{F}, 0, 0], frame: body}}}}"
    found = solved(f"{HEAD}{POINTS}bodies: {{u: {{{BAR}}}, {lower}}}\n{joints}{push}")
    second = math.asin(-2.0 * F / G)
    first = math.atan(-F * math.cos(second) / (1.5 * G + F * math.sin(second)))
    near(found.coordinates["p"]["angle"][0], first, 1.0, 1e-14)
    near(found.coordinates["e"]["angle"][0], second - first, 1.0, 1e-14)


# ---- stable or not ---------------------------------------------------------------------------------------------
@pytest.mark.parametrize("angle", ["60 deg", "-179.999999 deg", "0.001", "179 deg"])
def test_a_pendulum_hangs(angle: str) -> None:
    found = solved(pendulum(angle))
    near(found.coordinates["p"]["angle"][0], 0.0, 1.0, 1e-15)
    near(found.joints["p"]["force"][0], [0.0, 0.0, G], G, 1e-14)
    assert not found.warnings
    assert f"{0.5 * G / 0.33:.4g} 1/s²" in found.model["rest"][0]
    assert f"{math.sqrt(0.5 * G / 0.33) / (2.0 * math.pi):.4g} Hz" in found.model["rest"][0]


def test_upright_it_stays_and_says_so() -> None:
    found = solved(pendulum("180 deg"))
    near(found.coordinates["p"]["angle"][0], math.pi, 1.0, 1e-15)
    assert unstable(found)
    assert f"exp({math.sqrt(0.5 * G / 0.33):.4g} t)" in found.model["rest"][0]


def test_a_carriage_stays_where_it_is() -> None:
    """On a level rail, with a pendulum that swings out and back: its own coordinate is indifferent."""
    bodies = f"bodies: {{c: {{{BALL}}}, bar: {{{BAR}, orientation: {{axis: [0, 1, 0], angle: 100 deg}}}}}}\n"
    rail = "r: {type: slide, from: ground.O, to: c.c, axis: [1, 0, 0]}"
    found = solved(f"{HEAD}{POINTS}{bodies}joints: {{{rail}, p: {{{PIN}, from: c.c, to: bar.top}}}}")
    near(found.coordinates["p"]["angle"][0], 0.0, 1.0, 1e-14)
    assert "indifferent: joints.r" in found.model["rest"][1]
    # nothing pushes both: the common centre of mass hardly shifts across, as far as steps of the search are exact
    near(3.0 * found.coordinates["r"]["travel"][0], -0.5 * math.sin(math.radians(100.0)), 0.5, 0.1)


def test_what_bends_alone_holds() -> None:
    """A force of -100 x^3 has no slope at rest: it is found all the same."""
    slide = "u: {type: slide, from: ground.O, to: b.c, axis: [1, 0, 0], initial: {travel: 0.5}}"
    load = "forces: {s: {type: torque, joint: u, value: -100*u.travel**3 + 1e-6}}"
    found = solved(f"heun: 1\nanalysis: {{type: rest}}\n{POINTS}bodies: {{b: {{{BALL}}}}}\njoints: {{{slide}}}\n{load}")
    near(found.coordinates["u"]["travel"][0], 1e-8 ** (1.0 / 3.0), 1e-2, 1e-9)


@pytest.mark.parametrize("soft", [1e-4, 1e-8, 1e-12])
def test_a_soft_pose_shows_no_false_digits(soft: float) -> None:
    """A torque that takes back all but a trace of the weight's moment: what rounding makes of the pose is told."""
    all_but = 0.5 * G * (1.0 - soft)
    left = 0.5 * G - all_but
    load = f'forces: {{k: {{type: torque, joint: p, value: "{all_but!r}*sin(p.angle) + {1e-3 * left!r}"}}}}'
    found = solved(pendulum("0.01", load))
    error = abs(found.coordinates["p"]["angle"][0] - math.asin(1e-3))
    assert error <= found.accuracy["estimate"]["motion"] * 1.25 <= 1e3 * 2.0**-52 / soft + 1e-15


def test_across_springs_without_tension() -> None:
    """Springs at their free length hold what moves across them by its cube alone: eight digits, and that is told."""
    slide = "u: {type: slide, from: ground.O, to: b.c, axis: [0, 0, 1], initial: {travel: 0.5}}"
    ends = "ground: {points: {O: [0, 0, 0], A: [-1, 0, 0], B: [1, 0, 0]}}"
    springs = ", ".join(f"s{x}: {{type: spring, from: ground.{x}, to: b.c, stiffness: 100, length: 1}}" for x in "AB")
    body = f"bodies: {{b: {{{BALL}}}}}\njoints: {{{slide}}}\nforces: {{{springs}}}"
    found = solved(f"heun: 1\nanalysis: {{type: rest}}\n{ends}\n{body}")
    travel = abs(found.coordinates["u"]["travel"][0])
    assert travel <= 2.0 * found.accuracy["estimate"]["motion"] <= 1e-6


# ---- against the least energy, and against motion --------------------------------------------------------------


@pytest.mark.parametrize("seed", range(4))
def test_a_loop_in_space_has_the_least_energy(seed: int) -> None:
    text, S, k, free = triangle(np.random.default_rng(seed))
    found = solved(text)
    R = math.hypot(0.6, 0.5)

    def elbow(phi: float) -> Array:
        return np.array([0.5, R * math.cos(phi), R * math.sin(phi)])

    def energy(phi: float) -> float:
        stretched = float(np.linalg.norm(elbow(phi) - S)) - free
        return G * float(elbow(phi)[2]) + 0.5 * k * stretched**2

    told = found.bodies["a"]["rotation"][0] @ np.array([0.5, 0.6, -0.5])
    phi = math.atan2(told[2], told[1])
    least = minimize_scalar(energy, bounds=(phi - 0.3, phi + 0.3), method="bounded", options={"xatol": 1e-10})
    near(elbow(least.x), told, 1.0, 1e-7)  # a minimum is known to the root of its digits
    assert abs(energy(phi + 1e-5) - energy(phi - 1e-5)) < 1e-5 * k * 1e-8
    assert not unstable(found)


def stays(run: Study, within: float) -> None:
    """A motion from the rest pose, over a second, does not leave it."""
    layout = run.setup.scene.layout
    later = run.setup.runner.run(MotionTask(np.array([0.0, 1.0]), 1e-10)).states
    rates = np.concatenate([np.arange(g["rates"], g["end"]) for g in layout.tables["groups"]])
    near(later[1, rates] - later[0, rates], 0.0, 1.0, within)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.sixth
def test_what_rests_stays(seed: int) -> None:
    run = study(tree(np.random.default_rng(seed)))
    assert not unstable(run.results)
    stays(run, 1e-8)


def test_loops_that_rest_stay() -> None:
    stays(study(triangle(np.random.default_rng(7))[0]), 1e-8)


# ---- what turns steadily ---------------------------------------------------------------------------------------
def spindle(joint: str, drive: str = "6*t", gravity: str = f"[0, 0, -{G}]") -> str:
    """A bar hung on the axis of a spindle that turns about z."""
    bodies = f"s: {{{BALL}}}, bar: {{{BAR}, orientation: {{axis: [0, 1, 0], angle: -40 deg}}}}"
    joints = f"m: {{type: pin, axis: [0, 0, 1], from: ground.O, to: s.c}}, p: {{{joint}, from: s.c, to: bar.top}}"
    head = HEAD.replace(f"[0, 0, -{G}]", gravity)
    drives = f"drives: {{w: {{joint: m, angle: {drive}}}}}"
    return f"{head}{POINTS}bodies: {{{bodies}}}\njoints: {{{joints}}}\n{drives}\n"


@pytest.mark.parametrize("joint", [PIN, "type: ball"])
def test_a_bar_on_a_spindle(joint: str) -> None:
    """cos = m g l / w^2 (A - C): the moment of the centrifugal forces about the pin, A and C about its top."""
    found = solved(spindle(joint))
    cos = 0.5 * G / (36.0 * (0.33 - 0.001))
    near(found.bodies["bar"]["center"][0], [0.5 * math.sqrt(1.0 - cos**2), 0.0, -0.5 * cos], 1.0, 1e-14)
    assert "frame that moves with drives.w" in found.model["rest"][0]
    assert not unstable(found)
    # what drives the spindle has nothing to do, and carries the weight and the centripetal force
    near(found.joints["m"]["drive"][0], 0.0, 1.0, 1e-12)
    near(found.joints["p"]["force"][0], [-36.0 * 0.5 * math.sqrt(1.0 - cos**2), 0.0, G], 20.0, 1e-14)


def test_slowly_turned_it_hangs_and_faster_that_is_unstable() -> None:
    """On the axis it rests at any speed; above w^2 = m g l / (A - C) not stably."""
    along = spindle(PIN).replace("-40 deg", "0")
    least = math.sqrt(0.5 * G / 0.329)
    assert not unstable(solved(along.replace("6*t", f"{0.99 * least!r}*t")))
    assert unstable(solved(along.replace("6*t", f"{1.01 * least!r}*t")))


def test_the_governor() -> None:
    """Porter's: two balls m on arms l, links l to a sleeve M: w^2 = (m + M) g / (m l cos); the sleeve a loop's end."""
    m, M, length, w = 1.0, 5.0, 0.3, 20.0
    x, z = length * math.sin(0.5), -length * math.cos(0.5)
    light = "inertia: [1e-9, 1e-9, 1e-9]"
    bodies = [
        f"s: {{{BALL}}}",
        f"sleeve: {{mass: {M}, center: [0, 0, {2 * z!r}], inertia: [1, 1, 1], points: {{c: [0, 0, {2 * z!r}]}}}}",
    ]
    joints = [
        "m: {type: pin, axis: [0, 0, 1], from: ground.O, to: s.c}",
        "guide: {type: slide, axis: [0, 0, 1], from: s.c, to: sleeve.c}",
    ]
    for name, side in (("a", 1.0), ("b", -1.0)):
        at = [side * x, 0.0, z]
        bodies.append(f"{name}: {{mass: {m}, center: {at}, {light}, points: {{o: [0, 0, 0], e: {at}}}}}")
        joints.append(f"p{name}: {{{PIN}, from: s.c, to: {name}.o}}")
        joints.append(f"r{name}: {{type: rod, from: {name}.e, to: sleeve.c}}")
    drives = f"drives: {{w: {{joint: m, angle: {w}*t}}}}"
    found = solved(f"{HEAD}{POINTS}bodies: {{{', '.join(bodies)}}}\njoints: {{{', '.join(joints)}}}\n{drives}")
    cos = (m + M) * G / (m * length * w**2)
    assert cos < 1.0
    near(found.coordinates["guide"]["travel"][0], -2.0 * length * cos, length, 1e-8)  # 1e-9 of inertia beside m l^2
    near(2.0 * found.joints["ra"]["tension"][0] * cos, M * G, M * G, 1e-8)


# ---- one side only ---------------------------------------------------------------------------------------------
def test_a_trapdoor_rests_on_its_buffer() -> None:
    found = solved(pendulum("170 deg", "stops: {b: {joint: p, angle: [30 deg, null]}}"))
    near(found.coordinates["p"]["angle"][0], math.radians(30.0), 1.0, 1e-15)
    near(found.stops["b"]["moment"][0], 0.5 * G * math.sin(math.radians(30.0)), G, 1e-14)


@pytest.mark.parametrize("more", ["", ", restitution: 0.5"])
@pytest.mark.third
def test_a_rope_that_bears_and_one_that_hangs_slack(more: str) -> None:
    """A mass of 2 kg hangs on 1 m of rope; with a second rope from 1 m beside it between both, if that is short."""
    body = f"bodies: {{d: {{{BALL}, position: [0.3, 0, -0.2]}}}}\n"
    for other, slack in ((1.2, False), (3.0, True)):
        rope = f"type: rod, tension_only: true{more}, to: d.c"
        ropes = f"r: {{{rope}, from: ground.O, length: 1}}, q: {{{rope}, from: ground.A, length: {other}}}"
        found = solved(f"{HEAD}{POINTS}{body}joints: {{{ropes}}}")
        x = 0.0 if slack else (1.0 - other**2 + 1.0) / 2.0
        z = -math.sqrt(1.0 - x * x)
        near(found.bodies["d"]["position"][0], [x, 0.0, z], 1.0, 1e-14)
        q = 2.0 * G * x / -z * other
        near(found.joints["q"]["tension"][0], q, 2.0 * G, 1e-13)
        near(found.joints["r"]["tension"][0], (2.0 * G - q * -z / other) / -z, 2.0 * G, 1e-13)


# ---- directions that fall together ------------------------------------------------------------------------------
def carriage(angle: str) -> str:
    """A bar that hangs on a carriage on a level rail, drawn at an angle."""
    bodies = f"bodies: {{c: {{{BALL}}}, bar: {{{BAR}, orientation: {{axis: [0, 1, 0], angle: {angle}}}}}}}\n"
    rail = "r: {type: slide, from: ground.O, to: c.c, axis: [1, 0, 0]}"
    return f"{HEAD}{POINTS}{bodies}joints: {{{rail}, p: {{{PIN}, from: c.c, to: bar.top}}}}"


@pytest.mark.parametrize("off", [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3])
@pytest.mark.third
def test_a_level_bar_on_a_free_carriage_falls(off: float) -> None:
    """Drawn level it is pushed, but no slope turns it back: A = [[0, 0], [k, 0]], and nearly so beside."""
    found = solved(carriage(repr(math.pi / 2.0 - off)))
    near(found.coordinates["p"]["angle"][0], 0.0, 1.0, 1e-13)
    near(found.joints["p"]["force"][0], [0.0, 0.0, G], G, 1e-13)
    near(3.0 * found.coordinates["r"]["travel"][0], -0.5, 0.5, 0.1)
    assert "stable" in found.model["rest"][0]
    assert "indifferent: joints.r" in found.model["rest"][1]
    assert "the position along it depends on the path" in found.model["rest"][1]


@pytest.mark.parametrize("seed", range(4))
def test_matrices_whose_directions_fall_together(seed: int) -> None:
    """X B X^-1 is the matrix, and the step it leads to solves z' = c + A z: against the sum of its own series."""
    rng = np.random.default_rng(seed)
    off = [0.0, 1e-14, 1e-9, 1e-5][seed]
    J = np.diag([-3.0, -3.0 - off, 0.0, off, -40.0, 2.0])
    J[0, 1] = J[2, 3] = 5.0
    P = np.linalg.qr(rng.normal(size=(6, 6)))[0] + 0.2 * rng.normal(size=(6, 6))
    A = P @ J @ np.linalg.inv(P)
    own = decompose(A, np.eye(6))
    near(own.reassemble(np.ones(6, dtype=bool)), A, 40.0, 1e-9)
    c = rng.normal(size=6)
    z, term, h = np.zeros(6), c.copy(), 0.7 / 40.0
    for k in range(1, 40):
        term = term * h / k
        z = z + term
        term = A @ term
    near((own.X @ own.integrate(h, own.inverse @ c)).real, z, float(np.abs(z).max()), 1e-9)


def test_what_is_told_is_judged(monkeypatch: pytest.MonkeyPatch) -> None:
    """A search that ends too early is refused, whatever it was told."""
    monkeypatch.setattr(RestLaw, "significant_c", property(lambda own: np.zeros(len(own.c))))
    monkeypatch.setattr(RestLaw, "newton_step", lambda own, a: 0.0 * a)
    assert "the search ended where joints.p still accelerates by 14.9 rad" in refused(carriage("90 deg"))


SLIDER = f"""{HEAD}{POINTS}bodies: {{c: {{{BALL}}}}}
joints: {{r: {{type: slide, from: ground.O, to: c.c, axis: [1, 0, 0]}}}}
forces: {{f: {{type: torque, joint: r, value: "FORCE"}}}}
"""


@pytest.mark.parametrize(("force", "said"), [
    ("1e-300*sqrt(r.travel)", "(forces.f) has no value"),  # on one side of the pose, by rounding
    ("2e-3 - r.travel", "joints.r still accelerates by 0.001 m/s²"),  # of 2 kg
])  # fmt: skip
def test_a_slider_that_does_not_rest_is_told_in_its_unit(force: str, said: str) -> None:
    """A law without a value beside the pose read "still accelerates by 0 rad/s²", of a slide."""
    text = SLIDER.replace("FORCE", force).replace("type: rest", "type: state")
    spec = load("slider.yaml", text)
    runner = set_up(spec, reduce=False).runner
    coordinates = make_coordinates(runner.layout)
    with pytest.raises(SolveError) as caught:
        require_at_rest(runner, coordinates, make_bearing_pose(runner, coordinates, 0.0, runner.layout.y0))
    assert said in caught.value.problems[0].message
    assert "report" not in (caught.value.problems[0].hint or "")


@pytest.mark.parametrize("cube", ["100", "1e-3"])
@pytest.mark.third
def test_what_bends_alone_is_not_told_as_stable(cube: str) -> None:
    """At the flat point of -k x^3 the slope is the rounding of the pose."""
    slide = "u: {type: slide, from: ground.O, to: b.c, axis: [1, 0, 0], initial: {travel: 0.5}}"
    load = f"forces: {{s: {{type: torque, joint: u, value: -{cube}*u.travel**3}}}}"
    found = solved(f"heun: 1\nanalysis: {{type: rest}}\n{POINTS}bodies: {{b: {{{BALL}}}}}\njoints: {{{slide}}}\n{load}")
    assert not any(sentence.startswith("stable") for sentence in found.model["rest"]), found.model["rest"]
    assert any("to first order" in sentence and "joints.u" in sentence for sentence in found.model["rest"])


# ---- no rest ---------------------------------------------------------------------------------------------------
def test_what_nothing_holds() -> None:
    stone = f"{HEAD}{POINTS}bodies: {{stone: {{{BALL}}}}}"
    assert "bodies.stone falls: nothing stops it" in refused(stone)
    slope = "r: {type: slide, from: ground.O, to: c.c, axis: [1, 0, -0.1]}"
    cart = f"{HEAD}{POINTS}bodies: {{c: {{{BALL}}}}}\njoints: {{{slope}}}"
    assert "joints.r keeps sliding" in refused(cart)
    assert "joints.p keeps rotating" in refused(pendulum("0", "forces: {m: {type: torque, joint: p, value: 6}}"))


def test_what_does_not_keep_still() -> None:
    load = "forces: {f: {type: force, on: bar.end, vector: [sin(t), 0, 0]}}"
    assert "forces.f depends on t" in refused(pendulum("0", load))
    assert "drives.w does not have a constant rate" in refused(spindle(PIN, "t**2"))
    assert "does not stay at rest in the frame" in refused(spindle(PIN, gravity="[0, 1e-6, -9.81]"))
    assert "changes as drives.w moves" in refused(spindle(PIN, gravity="[0, -9.81, 0]"))
    assert "a jump of a load" in refused(
        pendulum("0.5", "forces: {f: {type: torque, joint: p, value: -8*sign(p.angle - 0.2)}}")
    )


@pytest.mark.parametrize("turned", ["8", "10", "12", "14"])
def test_a_way_that_ends_stretched(turned: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Turned too slowly, arms and links of the governor hang straight down: there either arm may swing by itself.

    The search ends when it stands still there; until its steps are used up it would take thousands.
    """
    steps: list[int] = []
    advance = RestSearch.advance

    def count(search: RestSearch, pose: Pose, law: RestLaw) -> Pose:
        steps.append(search.steps)
        return advance(search, pose, law)

    monkeypatch.setattr(RestSearch, "advance", count)
    with pytest.raises(SolveError) as caught:
        solve(load(str(ROOT / "specs" / "governor.yaml"), overrides={"w": turned}))
    assert max(steps) < 100
    assert "singular position" in caught.value.problems[0].message
    assert caught.value.problems[0].code == "no-rest-pose"


def test_where_a_load_has_no_value() -> None:
    root = "forces: {k: {type: torque, joint: p, value: -sqrt(p.angle - 0.5)}}"
    assert "forces.k" in refused(pendulum("1", root))


def test_idle_spins_are_not_told() -> None:
    """Two thin rods that hang from each other: what spins about their axes is nothing."""
    thin = BAR.replace("0.001", "0")
    bodies = ", ".join(
        f"{x}: {{{thin}, orientation: {{axis: [1, 1, 0], angle: {a} deg}}}}" for x, a in (("u", 70), ("l", 30))
    )
    joints = "p: {type: ball, from: ground.O, to: u.top}, e: {type: ball, from: u.end, to: l.top}"
    found = solved(f"{HEAD}{POINTS}bodies: {{{bodies}}}\njoints: {{{joints}}}")
    assert len(found.model["rest"]) == 1
    assert "stable" in found.model["rest"][0]
    near(found.joints["p"]["force"][0], [0.0, 0.0, 2.0 * G], G, 1e-14)


def test_a_crank_drive_keeps_the_rod_moving() -> None:
    crank = "c: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0], p: [0.1, 0, 0]}}"
    rod = "r: {mass: 1, center: [0.25, 0, 0], inertia: [1, 1, 1], points: {p: [0.1, 0, 0], q: [0.4, 0, 0]}}"
    pin = "type: pin, axis: [0, 0, 1]"
    joints = f"m: {{{pin}, from: ground.O, to: c.o}}, p: {{{pin}, from: c.p, to: r.p}}"
    joints += ", q: {type: line, from: ground.O, to: r.q, axis: [1, 0, 0]}"
    text = f"{HEAD}{POINTS}bodies: {{{crank}, {rod}}}\njoints: {{{joints}}}\ndrives: {{w: {{joint: m, angle: 3*t}}}}"
    assert "drives.w keeps bodies.r moving" in refused(text)
    still = solved(text.replace("3*t", "0.3"))
    near(still.coordinates["m"]["angle"][0], 0.3, 1.0, 1e-15)


@pytest.mark.parametrize(
    ("force", "is_decided"),
    [("-10*sign(s.travel - 0.1)*sqrt(abs(s.travel - 0.1))", False), ("-10*tanh((s.travel - 0.1)/1e-6)", True)],
)
def test_beside_a_root_no_stiffness_is_told(force: str, is_decided: bool) -> None:
    """The slope of the root is infinite, and that at a pose found 1e-15 m beside it means nothing."""
    text = (
        f"{HEAD}{POINTS}bodies: {{ball: {{{BALL}}}}}\n"
        "joints: {s: {type: slide, axis: [1, 0, 0], from: ground.O, to: ball.c}}\n"
        f'forces: {{pull: {{type: torque, joint: s, value: "{force}"}}}}\n'
    )
    said = " ".join(solved(text).model["notes"])
    assert ("stable: smallest eigenvalue" in said) == is_decided
    assert ("forces.pull has no derivative there" in said) != is_decided
