"""Small oscillations against closed forms: chains, pendulums, dampers, tops, turning frames, follower loads."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from heuncli.analyses.modes.study import compute_spec_modes
from heuncli.motion.linearisation.oscillations import SceneModes
from heuncli.scene.file_format.load import load
from tests.oracle.values import to_yaml
from tests.shared.governors import porter, spindle

G = 9.81
DIGITS = 1e-12  # of the largest eigenvalue: sums of some dozen terms
POINT = {"center": [0, 0, 0], "inertia": [0.1, 0.1, 0.1], "points": {"c": [0, 0, 0]}}


def found(scene: dict[str, Any]) -> SceneModes:
    return compute_spec_modes(load("scene.yaml", to_yaml(scene)))


def frequencies(told: SceneModes) -> list[float]:
    """Of what oscillates [rad/s]."""
    return [mode.eigenvalue.imag for mode in told.modes if mode.eigenvalue.imag > 0.0]


def near(values: Sequence[float], wanted: Sequence[float], size: float = 0.0) -> None:
    assert len(values) == len(wanted)
    assert np.abs(np.array(values) - np.array(wanted)).max() <= DIGITS * max(size, *map(abs, wanted))


def masses(n: int, ends: bool, k: float = 50.0, m: float = 2.0) -> dict[str, Any]:
    """Masses on one rail, springs between neighbours, and, with ends, to the ground on either side."""
    bodies = {f"m{i}": {"mass": m, **POINT, "position": [float(i + 1), 0, 0]} for i in range(n)}
    joints = {f"s{i}": {"type": "slide", "axis": [1, 0, 0], "from": "ground.O", "to": f"m{i}.c"} for i in range(n)}
    points = ["ground.O" if ends else "", *(f"m{i}.c" for i in range(n)), "ground.E" if ends else ""]
    springs = {
        f"k{i}": {"type": "spring", "from": a, "to": b, "stiffness": k, "length": 1}
        for i, (a, b) in enumerate(pairwise(points))
        if a and b
    }
    ground = {"points": {"O": [0, 0, 0], "E": [float(n + 1), 0, 0]}}
    return {"ground": ground, "bodies": bodies, "joints": joints, "forces": springs}


@pytest.mark.parametrize("n", [1, 2, 7, 30])
def test_masses_between_walls(n: int) -> None:
    """w_j = 2 sqrt(k/m) sin(j pi / (2 n + 2)), shapes sin(j pi i / (n + 1))."""
    told = found(masses(n, ends=True))
    near(frequencies(told), [10.0 * math.sin(j * math.pi / (2 * n + 2)) for j in range(1, n + 1)])
    for j, shape in enumerate(told.shapes, 1):
        wanted = np.array([math.sin(j * math.pi * i / (n + 1)) for i in range(1, n + 1)])
        ours = np.array([shape[f"s{i}.travel"].real for i in range(n)])
        assert abs(abs(ours @ wanted) - np.linalg.norm(ours) * np.linalg.norm(wanted)) <= 1e-9 * n
    assert all(mode.growth == 0.0 and mode.kind == "oscillation" for mode in told.modes)


def test_a_free_train_has_one_free_motion() -> None:
    """w_j = 2 sqrt(k/m) sin(j pi / 2 n), the first of them 0: all cars alike, and no frequency of rounding."""
    told = found(masses(8, ends=False))
    assert [mode.kind for mode in told.modes].count("free") == 1 and told.modes[0].frequency == 0.0
    near([abs(x) for x in told.shapes[0].values()], [1.0] * 8)
    near(frequencies(told), [10.0 * math.sin(j * math.pi / 16) for j in range(1, 8)])


def test_a_free_carriage_with_a_damper_creeps() -> None:
    """m x'' + c x' = 0: nothing holds the place, and the rate dies with c/m."""
    scene = masses(1, ends=False)
    scene["forces"] = {"c": {"type": "damper", "joint": "s0", "coefficient": 6.0}}
    told = found(scene)
    assert [mode.kind for mode in told.modes] == ["free", "decay"]
    near([mode.growth for mode in told.modes], [0.0, -3.0])


@pytest.mark.parametrize("c", [0.0, 4.0, 20.0, 40.0])
def test_a_damped_mass(c: float) -> None:
    """m l^2 + c l + 2 k = 0: oscillation, the aperiodic limit left out, decay."""
    scene = masses(1, ends=True)
    scene["forces"]["c"] = {"type": "damper", "joint": "s0", "coefficient": c}
    told = found(scene)
    m, k = 2.0, 100.0
    root = cmath.sqrt(c * c - 4.0 * m * k)
    wanted = sorted({(-c + root) / (2 * m), (-c - root) / (2 * m)}, key=lambda x: x.real)
    ours = {complex(mode.growth, sign * mode.eigenvalue.imag) for mode in told.modes for sign in (1, -1)}
    assert all(min(abs(x - y) for y in ours) <= 1e-13 * abs(x) for x in wanted)
    if root.imag:
        assert told.modes[0].damping == pytest.approx(c / (2.0 * math.sqrt(m * k)), rel=1e-13)
        assert told.modes[0].frequency == pytest.approx(root.imag / (2 * m) / (2 * math.pi), rel=1e-13)


def test_the_aperiodic_limit() -> None:
    """c^2 = 4 m k: one double root -c / 2 m, which rounding would split into a slow oscillation."""
    scene = masses(1, ends=True)
    scene["forces"]["c"] = {"type": "damper", "joint": "s0", "coefficient": 2.0 * math.sqrt(200.0)}
    told = found(scene)
    assert [(mode.kind, mode.frequency) for mode in told.modes] == [("decay", 0.0)] * 2
    assert all(abs(mode.growth + math.sqrt(50.0)) <= mode.error <= 1e-3 for mode in told.modes)


def pendulum(kind: str, **more: Any) -> dict[str, Any]:
    """Two points on massless bars of length 1, one below the other; up: where the second bar stands up."""
    bar = {"mass": 1.5, "center": [0, 0, -1], "inertia": [0, 0, 0], "points": {"a": [0, 0, 0], "b": [0, 0, -1]}}
    joint = {"type": kind} | ({"axis": [0, 1, 0]} if kind == "pin" else {})
    return {
        "gravity": [0, 0, -G],
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {"upper": bar, "lower": {**bar, "position": [0, 0, -1]}},
        "joints": {
            "O": {**joint, "from": "ground.O", "to": "upper.a"},
            "K": {**joint, "from": "upper.b", "to": "lower.a"},
        },
    } | more


@pytest.mark.parametrize(("kind", "times"), [("pin", 1), ("ball", 2)])
def test_double_pendulum(kind: str, times: int) -> None:
    """w^2 = g/l (2 -+ sqrt 2); on balls twice each, and the bars' spins, which no inertia resists, are not told."""
    told = found(pendulum(kind))
    slow, fast = (math.sqrt(G * (2.0 + s * math.sqrt(2.0))) for s in (-1.0, 1.0))
    near(frequencies(told), [slow] * times + [fast] * times)
    if kind == "pin":  # absolute angles 1 : sqrt 2, so relative ones 1 : sqrt 2 - 1
        shape = told.shapes[0]
        assert abs(shape["K.angle"] / shape["O.angle"] - (math.sqrt(2.0) - 1.0)) <= 1e-12


def test_a_pendulum_that_stands_falls() -> None:
    """l = +-sqrt(g/l): unstable, and named."""
    scene = pendulum("pin")
    scene["bodies"] = {"upper": {**scene["bodies"]["upper"], "orientation": {"axis": [0, 1, 0], "angle": math.pi}}}
    scene["joints"] = {"O": scene["joints"]["O"]}
    told = found(scene)
    near([mode.growth for mode in told.modes], [math.sqrt(G), -math.sqrt(G)])
    assert [mode.kind for mode in told.modes] == ["divergence", "decay"]
    assert [mode.damping for mode in told.modes] == [-1.0, 1.0]


def column(P: float, c: float = 4.0, m: float = 3.0) -> dict[str, Any]:
    """Ziegler's: two bars with springs in their hinges, masses 2 m and m, P along the second bar wherever it is."""
    scene = pendulum("pin", gravity=[0, 0, 0])
    scene["bodies"]["upper"]["mass"] = 2.0 * m
    scene["bodies"]["lower"] = {**scene["bodies"]["lower"], "mass": m}
    scene["forces"] = {
        "O": {"type": "torque", "joint": "O", "value": f"-{c}*O.angle"},
        "K": {"type": "torque", "joint": "K", "value": f"-{c}*K.angle"},
        "P": {"type": "force", "on": "lower.b", "vector": [0, 0, P], "frame": "body"},
    }
    return scene


@pytest.mark.parametrize("P", [0.0, 1.0, 2.0, 2.2, 4.0])
def test_follower_load(P: float) -> None:
    """Ziegler's column flutters beyond P l / c = 7/2 - sqrt 2; below its motions neither grow nor die."""
    c, m = 4.0, 3.0
    told = found(column(P * c))
    M = m * np.array([[3.0, 1.0], [1.0, 1.0]])
    K = c * np.array([[2.0 - P, P - 1.0], [-1.0, 1.0]])
    square = np.linalg.eigvals(np.linalg.solve(M, K)).astype(complex)
    wanted = [root for k in square for root in (cmath.sqrt(-k), -cmath.sqrt(-k))]
    ours = [mode.eigenvalue for mode in told.modes]
    assert len(ours) == 2
    for value in ours:
        assert min(abs(value - root) for root in wanted) <= DIGITS * abs(value)
    fluttering = P > 3.5 - math.sqrt(2.0)
    kinds = {mode.kind for mode in told.modes}
    assert kinds == ({"flutter", "oscillation"} if fluttering else {"oscillation"})
    assert all(mode.growth == 0.0 for mode in told.modes) is not fluttering


@pytest.mark.parametrize("spin", [0.0, 20.0, 60.0, 200.0])
def test_sleeping_top(spin: float) -> None:
    """A l^2 - i C w l - m g h = 0 in x + i y: nutation and precession, or a fall in a spiral if it spins too slowly."""
    A, C, m, h = 0.02, 0.003, 1.2, 0.1
    scene = {
        "gravity": [0, 0, -G],
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {"top": {"mass": m, "center": [0, 0, h], "inertia": [A - m * h * h, A - m * h * h, C],
                           "points": {"tip": [0, 0, 0]}, "angular_velocity": [0, 0, spin]}},
        "joints": {"tip": {"type": "ball", "from": "ground.O", "to": "top.tip"}},
    }  # fmt: skip
    told = found(scene)
    root = cmath.sqrt(4.0 * A * m * G * h - (C * spin) ** 2)
    wanted = [(1j * C * spin + s * root) / (2.0 * A) for s in (1.0, -1.0)]
    assert told.modes[0].kind == "free" and told.largest[0] == ("tip.z",)
    ours = {z for mode in told.modes[1:] for z in (mode.eigenvalue, mode.eigenvalue.conjugate())}
    for value in wanted:
        assert min(abs(value - z) for z in ours) <= 1e-9 * abs(value)
    stable = C * spin > math.sqrt(4.0 * A * m * G * h)
    assert all(mode.growth == 0.0 for mode in told.modes) is stable
    if stable:  # it goes round: x and y a quarter of a turn apart
        shape = told.shapes[-1]
        assert (
            abs(abs(shape["tip.x"]) - 1.0) <= 1e-9
            and abs(shape["tip.x"] / shape["tip.y"] - 1j) * abs(shape["tip.x"] / shape["tip.y"] + 1j) <= 1e-8
        )


def test_free_gyroscope() -> None:
    """Without weight the axis nods with C w / A, and what is left is free: both turns across, and the spin."""
    A, C, w = 0.5, 0.8, 30.0
    scene = {
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {"disc": {"mass": 2, "center": [0, 0, 0], "inertia": [A, A, C], "points": {"c": [0, 0, 0]},
                            "angular_velocity": [0, 0, w]}},
        "joints": {"c": {"type": "ball", "from": "ground.O", "to": "disc.c"}},
    }  # fmt: skip
    told = found(scene)
    near(frequencies(told), [C * w / A])
    assert [mode.kind for mode in told.modes] == ["free"] * 3 + ["oscillation"]


@pytest.mark.parametrize("theta", [0.3, 1.0])
def test_governor(theta: float) -> None:
    """An arm hinged on a spindle stands at cos = g / W^2 and swings about that with W sin."""
    W = math.sqrt(G / math.cos(theta))
    told = found(spindle("pin", W, theta))
    assert told.is_steady and told.reference == "state"
    near(frequencies(told), [W * math.sin(theta)])


@pytest.mark.parametrize("theta", [0.3, 1.0])
def test_conical_pendulum(theta: float) -> None:
    """On a ball it goes round freely: seen from what turns with it, W sqrt(1 + 3 cos^2), and free along its circle."""
    W = math.sqrt(G / math.cos(theta))
    told = found(spindle("ball", W, theta))
    near(frequencies(told), [W * math.sqrt(1.0 + 3.0 * math.cos(theta) ** 2)])
    assert [mode.kind for mode in told.modes] == ["free", "oscillation"]


def test_parallelogram() -> None:
    """Two cranks and a coupler that swings without turning: w^2 = g (m_c l + m l) / (2 I_A + m l^2)."""
    l, mc, m, I = 0.7, 0.4, 1.1, 0.05
    crank = {"mass": mc, "center": [0, 0, -l / 2], "inertia": [I, I, I], "points": {"a": [0, 0, 0], "b": [0, 0, -l]}}
    pin = {"type": "pin", "axis": [0, 1, 0]}
    told = found({
        "gravity": [0, 0, -G],
        "ground": {"points": {"A": [0, 0, 0], "B": [2, 0, 0]}},
        "bodies": {
            "left": crank, "right": {**crank, "position": [2, 0, 0]},
            "deck": {"mass": m, "center": [1, 0, -0.3], "inertia": [1, 1, 1], "position": [0, 0, -l],
                     "points": {"a": [0, 0, 0], "b": [2, 0, 0]}},
        },
        "joints": {"A": {**pin, "from": "ground.A", "to": "left.a"}, "B": {**pin, "from": "ground.B", "to": "right.a"},
                   "C": {**pin, "from": "left.b", "to": "deck.a"}, "D": {**pin, "from": "right.b", "to": "deck.b"}},
    })  # fmt: skip
    inertia = 2.0 * (I + mc * l * l / 4.0) + m * l * l
    near(frequencies(told), [math.sqrt(G * (mc * l + m * l) / inertia)])
    shape = told.shapes[0]
    assert all(abs(shape[f"{j}.angle"] - s * shape["A.angle"]) <= 1e-12 for j, s in (("B", 1), ("C", -1), ("D", -1)))


def cantilever(n: int) -> dict[str, Any]:
    """A bar of length, mass and EI 1 in n links, springs n EI about the hinges between, 2 n EI at the wall."""
    h = 1.0 / n
    link = {"mass": h, "center": [h / 2, 0, 0], "inertia": [0, h**3 / 12, h**3 / 12],
            "points": {"a": [0, 0, 0], "b": [h, 0, 0]}}  # fmt: skip
    ends = ["ground.O", *(f"l{i}.b" for i in range(n - 1))]
    return {
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {f"l{i}": {**link, "position": [i * h, 0, 0]} for i in range(n)},
        "joints": {f"h{i}": {"type": "pin", "axis": [0, 0, 1], "from": a, "to": f"l{i}.a"} for i, a in enumerate(ends)},
        "forces": {
            f"k{i}": {"type": "turn_spring", "joint": f"h{i}", "stiffness": n * (1.0 if i else 2.0)} for i in range(n)
        },
    }


def test_beam_of_links() -> None:
    """Euler's cantilever, w = 1.8751^2, 4.6941^2, 7.8548^2: the error falls with the square of the links' length."""
    wanted = np.array([1.8751040687119611, 4.694091132974174, 7.854757438237613]) ** 2
    coarse, fine = (np.array(frequencies(found(cantilever(n)))[:3]) for n in (20, 40))
    assert np.abs((coarse - wanted) / (fine - wanted) - 4.0).max() <= 0.2
    assert np.abs((4.0 * fine - coarse) / 3.0 - wanted).max() <= 1e-3 * wanted.max()


@pytest.mark.parametrize("w", [16.0, 20.0, 30.0])
def test_porters_governor(w: float) -> None:
    """Closed chains on a spindle that turns: second derivatives of potential and centrifugal potential."""
    scene, square = porter(w)
    near(frequencies(found(scene)), [math.sqrt(square)])


@pytest.mark.parametrize("W", [0.0, 30.0, 300.0])
def test_whirl_of_a_rotor_in_springs(W: float) -> None:
    """A disc in a gimbal: A1 A2 w^4 - (k (A1 + A2) + (C W)^2) w^2 + k^2 = 0, with the rings' inertia in A1 and A2."""
    A, C, ring, k = 0.3, 0.5, 0.02, 70.0
    body = {"mass": 1, "center": [0, 0, 0], "points": {"o": [0, 0, 0]}}
    told = found({
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {
            "outer": {**body, "inertia": [ring] * 3}, "inner": {**body, "inertia": [ring] * 3},
            "disc": {**body, "inertia": [A, A, C]},
        },
        "joints": {
            "x": {"type": "pin", "axis": [1, 0, 0], "from": "ground.O", "to": "outer.o"},
            "y": {"type": "pin", "axis": [0, 1, 0], "from": "outer.o", "to": "inner.o"},
            "z": {"type": "pin", "axis": [0, 0, 1], "from": "inner.o", "to": "disc.o"},
        },
        "forces": {f"k{n}": {"type": "turn_spring", "joint": n, "stiffness": k} for n in "xy"},
        "drives": {"motor": {"joint": "z", "angle": f"{W}*t"}},
    })  # fmt: skip
    A1, A2 = A + 2.0 * ring, A + ring
    half = 0.5 * (k * (A1 + A2) + (C * W) ** 2) / (A1 * A2)
    fast = math.sqrt(half + math.sqrt(half * half - k * k / (A1 * A2)))
    slow = k / math.sqrt(A1 * A2) / fast
    assert all(mode.growth == 0.0 for mode in told.modes)
    for mode, wanted in zip(told.modes, (slow, fast), strict=True):
        assert abs(mode.eigenvalue.imag - wanted) <= max(mode.error, 1e-12 * wanted)
        assert mode.error <= 1e-9 * fast


def test_a_pendulum_in_a_lift_at_constant_speed() -> None:
    """It swings as at rest; speeding up at a, as under g + a: but that is no state that lasts."""
    cabin = {"mass": 5, "center": [0, 0, 0], "inertia": [1, 1, 1], "points": {"c": [0, 0, 0]}}
    bob = {"mass": 1, "center": [0, 0, -1], "inertia": [0, 0, 0], "points": {"a": [0, 0, 0]}}
    scene = {
        "gravity": [0, 0, -G],
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {"cabin": cabin, "bob": {**bob, "velocity": [0, 0, 3]}},
        "joints": {"shaft": {"type": "slide", "axis": [0, 0, 1], "from": "ground.O", "to": "cabin.c"},
                   "hook": {"type": "pin", "axis": [0, 1, 0], "from": "cabin.c", "to": "bob.a"}},
        "drives": {"winch": {"joint": "shaft", "travel": "3*t"}},
    }  # fmt: skip
    told = found(scene)
    assert told.is_steady
    near(frequencies(told), [math.sqrt(G)])
