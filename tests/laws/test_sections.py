"""Laws of section loads: nothing at free ends, the joint's reaction at its own place, dM1/ds = +Q2, dM2/ds = −Q1.

Also jumps at loads, d'Alembert forces summed over the volume, other points of reference, and the reduction line.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from heuncli.results.results import Results
from heuncli.scene.file_format.load import load
from heuncli.study.quantities.labels import make_labels
from tests.oracle.masses import Plane, cut, moved
from tests.oracle.turns import Array, random_rotation, random_unit, unit
from tests.shared.bars import HEAD
from tests.shared.scenes import near, solved

G = np.array([0.0, 0.0, -9.81])


def matrix(R: Array) -> str:
    return f"{{matrix: {R.tolist()}}}"


def test_a_whole_free_body_carries_nothing_at_its_ends() -> None:
    """Thrown and spinning, no joint, no load but its weight: zero at both ends of a run, not between."""
    found = solved(
        HEAD
        + f"""
bodies:
  bar:
    shapes:
      - {{type: cylinder, from: [0, 0, 0], to: [1.2, 0, 0], radius: 0.03, density: 7850}}
      - {{type: cone, from: [1.2, 0, 0], to: [1.5, 0, 0], radius: 0.05, to_radius: 0.02, density: 2700}}
    points: {{a: [0, 0, 0], b: [1.5, 0, 0]}}
    orientation: {matrix(random_rotation(np.random.default_rng(1)))}
    velocity: [1, 2, 3]
    angular_velocity: [4, -3, 6]
sections: {{along: {{body: bar, from: a, to: b, count: 11}}}}
analysis: {{duration: 0.5, samples: 6}}
"""
    ).sections["along"]
    assert found["side"] == [None] * 11
    for part, least in (("force", 10.0), ("moment", 0.01)):
        assert np.abs(found[part][:, 5]).max() > least
        for end in (0, -1):
            near(found[part][:, end], 0.0, 300.0, 1e-13)  # 30 kg under g


def beam(rng: np.random.Generator, loads: str, support: str) -> str:
    """A bar of 2 m along its own x in any attitude, at rest on supports at its root; a run of 41 cuts, h = 0.05 m."""
    R = random_rotation(rng)
    axes = f", axis: [1, 2, -1], to_axis: {(R.T @ [1.0, 2.0, -1.0]).tolist()}" if support == "pin" else ""
    return (
        HEAD
        + f"""
bodies:
  beam:
    shapes: [{{type: box, center: [1, 0, 0], size: [2, 0.1, 0.2], density: 500}}]
    points: {{root: [0, 0, 0], tip: [2, 0, 0], p: [0.5, 0.02, 0.05], q: [1.25, 0, 0], r: [1.6, -0.03, 0.01]}}
    position: [0, 0, 0]
    orientation: {matrix(R)}
joints: {{wall: {{type: {support}, from: ground.O, to: beam.root{axes}}}}}
forces: {loads}
sections: {{run: {{body: beam, from: root, to: tip, count: 41, first_axis: [0, 1, 0.3]}}}}
"""
    )


LOADS = """
  push: {type: force, on: beam.p, vector: [30, -20, 50]}
  twist: {type: couple, on: beam.q, vector: [5, 7, -4], frame: body}
  pull: {type: force, on: beam.r, vector: [-10, 40, 20], frame: body}
"""


@pytest.mark.parametrize("seed", range(6))
def test_slopes_of_bending_at_rest(seed: int) -> None:
    """Between loads s' is linear and M' quadratic along a uniform bar: trapezoids over a series of cuts are exact."""
    found = solved(beam(np.random.default_rng(seed), LOADS, "weld")).sections["run"]
    s, side = found["s"], found["side"]
    gaps = [k for k in range(len(s) - 1) if s[k + 1] > s[k]]
    assert len(gaps) == 40 and len(s) == 44  # two rows at each of the three loads
    for k in gaps:
        h = s[k + 1] - s[k]
        slope = {name: (found[name][0, k + 1] - found[name][0, k]) / h for name in ("M1", "M2", "T")}
        mean = {name: (found[name][0, k + 1] + found[name][0, k]) / 2 for name in ("Q1", "Q2")}
        near([slope["M1"], slope["M2"], slope["T"]], [mean["Q2"], -mean["Q1"], 0.0], 100.0, 1e-12)
    assert [side[k] for k in range(len(s)) if side[k] is not None] == ["beyond", *["before", "beyond"] * 3]


@pytest.mark.parametrize("seed", range(6))
def test_jumps_at_loads(seed: int) -> None:
    """s' jumps by the force, M' by the couple and the force times its lever; the cut before holds the load."""
    text = beam(np.random.default_rng(seed), LOADS, "weld")
    results = solved(text)
    found, R = results.sections["run"], results.bodies["beam"]["rotation"][0]
    places = {"p": [0.5, 0.02, 0.05], "q": [1.25, 0, 0], "r": [1.6, -0.03, 0.01]}
    force = {"p": np.array([30.0, -20.0, 50.0]), "q": np.zeros(3), "r": R @ [-10.0, 40.0, 20.0]}
    couple = {"p": np.zeros(3), "q": R @ [5.0, 7.0, -4.0], "r": np.zeros(3)}
    for name, place in places.items():
        rows = [k for k in range(44) if abs(found["s"][k] - place[0]) < 1e-12]
        assert [found["side"][k] for k in rows] == ["before", "beyond"]
        before, beyond = rows
        near(found["force"][0, before] - found["force"][0, beyond], force[name], 100.0, 1e-13)
        lever = R @ (np.array(place) - [place[0], 0.0, 0.0])
        jump = couple[name] + np.cross(lever, force[name])
        near(found["moment"][0, before] - found["moment"][0, beyond], jump, 100.0, 1e-13)


@pytest.mark.parametrize("support", ["weld", "ball", "pin"])
@pytest.mark.parametrize("seed", range(4))
def test_beside_a_joint_the_section_is_minus_its_reaction(seed: int, support: str) -> None:
    """At the root, in motion for ball and pin; the limit from inside is the cut just beyond the joint."""
    text = beam(np.random.default_rng(seed), LOADS, support)
    if support != "weld":
        text += "analysis: {times: [0, 0.1, 0.2], tolerance: 1e-11}\n"
    found = solved(text)
    wall, run = found.joints["wall"], found.sections["run"]
    size = max(100.0, float(np.abs(wall["force"]).max()))
    near(run["force"][:, 0], -wall["force"], size, 1e-12)
    near(run["moment"][:, 0], -wall["moment"], size, 1e-12)
    near(run["point"][:, 0], wall["point"], 1.0, 1e-15)
    near(run["force"][:, -1], 0.0, size, 1e-12)
    near(run["moment"][:, -1], 0.0, size, 1e-12)


def test_a_cut_between_two_joints_from_both_sides() -> None:
    """A bar in a chain: just inside its lower joint the section is what the rest of the chain exerts."""
    found = solved(
        HEAD
        + """
bodies:
  upper:
    shapes: [{type: cylinder, from: [0, 0, 0], to: [0, 0, -1], radius: 0.02, density: 3000}]
    points: {top: [0, 0, 0], end: [0, 0, -1]}
    orientation: {axis: [1, 0.3, 0], angle: 50 deg}
    angular_velocity: {vector: [1, 2, 0.5], frame: body}
  lower:
    shapes: [{type: cylinder, from: [0, 0, 0], to: [0, 0, -0.8], radius: 0.02, density: 3000}]
    points: {top: [0, 0, 0], end: [0, 0, -0.8]}
    angular_velocity: {vector: [-2, 1, 3], frame: body}
joints:
  pivot: {type: ball, from: ground.O, to: upper.top}
  elbow: {type: ball, from: upper.end, to: lower.top}
sections: {run: {body: upper, from: top, to: end, count: 3}}
analysis: {duration: 1, samples: 11}
"""
    )
    run, size = found.sections["run"], float(np.abs(found.joints["pivot"]["force"]).max())
    near(run["force"][:, 0], -found.joints["pivot"]["force"], size, 1e-12)
    near(run["force"][:, -1], -found.joints["elbow"]["force"], size, 1e-12)
    near(run["moment"][:, -1], 0.0, size, 1e-12)
    assert run["side"] == ["beyond", None, "before"]


DOUBLE = (
    HEAD
    + """
bodies:
  upper:
    shapes: [{type: cylinder, from: [0, 0, 0], to: [0, 0, -1], radius: 0.05, inner_radius: 0.02, density: 800}]
    points: {top: [0, 0, 0], end: [0, 0, -1]}
    orientation: {axis: [1, 0, 0], angle: 60 deg}
    angular_velocity: {vector: [0.3, -0.2, 1.0], frame: body}
  lower:
    shapes: [{type: cylinder, from: [0, 0, 0], to: [0, 0, -0.8], radius: 0.04, density: 900}]
    points: {top: [0, 0, 0], end: [0, 0, -0.8]}
    orientation: {axis: [0, 1, 0], angle: 45 deg}
    angular_velocity: {vector: [-0.5, 0.4, 0.7], frame: body}
joints:
  pivot: {type: ball, from: ground.O, to: upper.top}
  elbow: {type: ball, from: upper.end, to: lower.top}
sections:
  up: {body: upper, from: top, to: end, count: 6}
  low: {body: lower, from: top, to: end, count: 6}
analysis: {duration: 2, samples: 21}
"""
)
BARS = {"up": ("upper", 1.0, 0.05, 0.02, 800.0), "low": ("lower", 0.8, 0.04, 0.0, 900.0)}


def cylinder_points(low: float, high: float, radius: float, bore: float, density: float) -> tuple[Array, Array]:
    """Mass points of the cylinder below z = −low, body axes: Gauss along, over the radius and evenly round, exact."""
    x, w = np.polynomial.legendre.leggauss(4)
    z, wz = -(low + (high - low) * (1 + x) / 2), w * (high - low) / 2
    r, wr = bore + (radius - bore) * (1 + x) / 2, w * (radius - bore) / 2
    angle = 2 * np.pi * np.arange(8) / 8
    Z, R, A = (a.ravel() for a in np.meshgrid(z, r, angle, indexing="ij"))
    W = (wz[:, None, None] * (wr * r)[None, :, None] * np.full(8, 2 * np.pi / 8)).ravel()
    return np.stack([R * np.cos(A), R * np.sin(A), Z], axis=1), density * W


@pytest.mark.heavy
@pytest.mark.parametrize("name", BARS)
def test_against_dalembert_forces_along_the_bar(name: str) -> None:
    """Σ' m (g − ẍ) over the bar's own volume, and the lower joint's load; over two seconds of the double pendulum."""
    found = solved(DOUBLE)
    body, length, radius, bore, density = BARS[name]
    b, run = found.bodies[body], found.sections[name]
    elbow = found.joints["elbow"]
    size = float(np.abs(found.joints["pivot"]["force"]).max())
    for row, s in enumerate(run["s"].tolist()):
        X, m = cylinder_points(s, length, radius, bore, density)
        for k in range(len(found.time)):
            R, spin, turn = b["rotation"][k], b["angular_velocity"][k], b["angular_acceleration"][k]
            arm = X @ R.T - (b["center"][k] - b["position"][k])
            a = b["center_acceleration"][k] + np.cross(turn, arm) + np.cross(spin, np.cross(spin, arm))
            loads, places = m[:, None] * (G - a), b["position"][k] + X @ R.T
            P = b["position"][k] + R @ [0.0, 0.0, -s]
            force, moment = loads.sum(axis=0), np.cross(places - P, loads).sum(axis=0)
            if name == "up":  # the elbow exerts its opposite on the upper bar's end
                force = force - elbow["force"][k]
                moment = moment - np.cross(elbow["point"][k] - P, elbow["force"][k])
            near(run["point"][k, row], P, 1.0, 1e-14)
            near(run["force"][k, row], force, size, 1e-12)
            near(run["moment"][k, row], moment, size, 1e-12)


BOXES = [
    {"type": "box", "center": [0.5, 0.0, 0.0], "size": [1.0, 0.3, 0.2], "density": 500.0},
    {"type": "box", "center": [0.6, 0.25, 0.0], "size": [0.6, 0.2, 0.2], "density": 900.0},
]
AT, LOAD = [0.4, 0.05, 0.02], [0.8, 0.05, 0.1]


def drawn(seed: int) -> tuple[Array, Array, Array, Array]:
    """Attitude, angular velocity, push at LOAD, and the cut's normal (body axes)."""
    rng = np.random.default_rng(seed)
    normal = np.array([1.0, 0.0, 0.0]) + 0.2 * random_unit(rng)
    return random_rotation(rng), rng.uniform(-4, 4, 3), rng.uniform(-50, 50, 3), unit(normal)


def cut_of(where: str, seed: int) -> Results:
    """A lopsided body on a ball in motion, cut once; `where` says about which point M' is taken."""
    R, spin, push, normal = drawn(seed)
    section = {"body": "body", "at": AT, "normal": normal, "reduce_to": where}
    scene = {
        "gravity": G, "ground": {"points": {"O": [0, 0, 0], "F": [0.3, -0.4, 0.5]}},
        "bodies": {"body": {
            "shapes": BOXES, "points": {"root": [0, 0, 0], "p": [0.9, 0.1, 0.05], "load": LOAD},
            "orientation": {"matrix": R}, "angular_velocity": spin,
        }},
        "joints": {"pivot": {"type": "ball", "from": "ground.O", "to": "body.root"}},
        "forces": {"push": {"type": "force", "on": "body.load", "vector": push}},
        "sections": {"cut": section}, "analysis": {"times": [0.0, 0.1], "tolerance": 1e-11},
    }  # fmt: skip
    return solved(scene)


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(4))
def test_moments_about_other_points(seed: int) -> None:
    """M'(P) = M'(at) + (at − P) × s'; s' is the same. The centroid is that of both boxes' rectangles together."""
    at = cut_of("at", seed)
    block = at.sections["cut"]
    for where in ("centroid", "body.p", "ground.F", "ground.O", "body.root"):
        other = cut_of(where, seed).sections["cut"]
        near(other["force"], block["force"], 500.0, 1e-13)
        moved = block["moment"] + np.cross(block["point"] - other["point"], block["force"])
        near(other["moment"], moved, 500.0, 1e-13)
        for name, axis in (("T", "normal"), ("M1", "first_axis")):
            near(other[name], np.sum(other["moment"] * other[axis], axis=1), 500.0, 1e-13)
        second = np.cross(other["normal"], other["first_axis"])
        near(other["M2"], np.sum(other["moment"] * second, axis=1), 500.0, 1e-13)
    fixed = np.array([[0.3, -0.4, 0.5]] * 2)
    for where, place in (("ground.F", fixed), ("body.p", at.points["body.p"]["position"]), ("ground.O", 0.0 * fixed)):
        near(cut_of(where, seed).sections["cut"]["point"], place, 1.0, 1e-15)


@pytest.mark.parametrize("seed", range(4))
def test_fixed_point_of_58(seed: int) -> None:
    """About the body's fixed point M'_s = M'_k − J'σ̇ − σ×J'σ (60); J' of the piece by the oracle's quadrature."""
    found = cut_of("ground.O", seed)
    _, _, push, normal = drawn(seed)
    piece = cut({"shapes": BOXES}, Plane(np.array(AT), normal))[1]
    J_body = moved(piece, np.zeros(3))
    b = found.bodies["body"]
    for k in range(2):
        R, w, u = b["rotation"][k], b["angular_velocity"][k], b["angular_acceleration"][k]
        J = R @ J_body @ R.T
        M_k = np.cross(R @ piece.center, piece.mass * G) + np.cross(R @ LOAD, push)
        near(found.sections["cut"]["moment"][k], M_k - J @ u - np.cross(w, J @ w), 500.0, 1e-13)


@pytest.mark.parametrize("seed", range(6))
def test_reduction_line(seed: int) -> None:
    """Points of the plane whose moment in the plane is along the shear; the nearest one; and where it vanishes."""
    found = cut_of("line", seed).sections["cut"]
    plain = cut_of("at", seed).sections["cut"]
    line = found["line"]
    for k in range(2):
        n, s, M, at = (plain[key][k] for key in ("normal", "force", "moment", "point"))
        Q = s - (s @ n) * n
        d = line["direction"][k]
        near([d @ n, d @ Q / np.linalg.norm(Q), np.linalg.norm(d)], [0.0, 0.0, 1.0], 1.0, 1e-13)
        near(d, np.cross(n, Q) / np.linalg.norm(Q), 1.0, 1e-12)
        p = line["point"][k]
        near([(p - at) @ n, (p - at) @ d], [0.0, 0.0], max(1.0, np.linalg.norm(p - at)), 1e-12)
        for along in (-1.0, 0.0, 2.0):
            there = M + np.cross(at - (p + along * d), s)
            in_plane = there - (there @ n) * n
            near(np.cross(in_plane, Q) / np.linalg.norm(Q), np.zeros(3), max(500.0, np.linalg.norm(M)), 1e-11)
        c = line["pressure_centre"][k]
        there = M + np.cross(at - c, s)
        near(there - (there @ n) * n, np.zeros(3), max(500.0, np.linalg.norm(M)), 1e-11)
        near((c - p) @ Q / np.linalg.norm(Q), 0.0, max(1.0, np.linalg.norm(c)), 1e-11)


LEVEL = (
    HEAD
    + """
bodies:
  bar:
    shapes: [{type: box, center: [1, 0, 0], size: [2, 0.1, 0.1], density: 500}]
    points: {a: [0, 0, 0], b: [2, 0, 0]}
joints: {wall: {type: weld, from: ground.O, to: bar.a}}
sections: {cut: {body: bar, at: [1, 0, 0], normal: NORMAL, reduce_to: line}}
"""
)


@pytest.mark.parametrize(("gravity", "none", "kind"), [
    ([0, 0, -9.81], {"point", "direction", "pressure_centre"}, 1.0),  # pure shear and bending: no such point
    ([-9.81, 0, 0], {"point", "direction"}, 2.0),  # pure tension: all points
])  # fmt: skip
def test_degenerate_lines_are_flagged(gravity: list[float], none: set[str], kind: float) -> None:
    """N = 0 or Q = 0: no numbers, no division; `kind` says whether no point or every point will do."""
    text = LEVEL.replace("NORMAL", "[1, 0, 0]").replace("[0, 0, -9.81]", str(gravity))
    line = solved(text).sections["cut"]["line"]
    for name in ("point", "direction", "pressure_centre"):
        assert bool(np.isnan(line[name]).all()) is (name in none), name
        assert bool(np.isnan(line[name]).any()) is (name in none), name
    assert line["kind"].tolist() == [kind]


BARE_END = """
bodies:
  bar: {shapes: [MATTER], points: {a: [0, 0, 0], b: [2, 0, 0]}}
joints: {wall: {type: weld, from: ground.O, to: bar.a}}
forces: {tip: {type: force, on: bar.b, vector: FORCE}}
sections: {cut: {body: bar, at: [1.5, 0, 0], normal: NORMAL, reduce_to: line}}
"""
BAR = "{type: rod, from: [0, 0, 0], to: [1, 0, 0], mass: 2}"
BALL = "{type: point, at: [0, 0, 0], mass: 2}"


@pytest.mark.parametrize(("matter", "normal"), [(BAR, "[1, 0, 0]"), (BALL, "[1, 0, 0]"), (BALL, "[-1, 0, 0]")])
@pytest.mark.parametrize(("force", "kind"), [("[3, 4, 5]", 0.0), ("[0, 4, 5]", 1.0), ("[3, 0, 0]", 2.0)])
def test_a_line_without_mass_beyond_the_cut(matter: str, normal: str, force: str, kind: float) -> None:
    """No mass there, or all of it in the body's origin, gives no length: the body's own decides what counts as 0."""
    head = HEAD.replace("[0, 0, -9.81]", "[0, 0, 0]")
    text = (head + BARE_END).replace("MATTER", matter).replace("NORMAL", normal).replace("FORCE", force)
    cut = solved(text).sections["cut"]
    line = cut["line"]
    assert line["kind"].tolist() == [kind]
    assert bool(np.isnan(line["point"]).all()) is (kind != 0.0)
    assert bool(np.isnan(line["pressure_centre"]).all()) is (kind == 1.0)
    if kind == 0.0:  # the force pulls along the bar through (2, 0, 0): its line meets the plane where F x (p - b) = 0
        near(np.cross(line["pressure_centre"][0] - [2.0, 0.0, 0.0], [3.0, 4.0, 5.0]), 0.0, 10.0, 1e-14)


@pytest.mark.parametrize(("normal", "axis"), [
    ([1, 0, 0], [0, 1, 0]), ([0, 1, 0], [1, 0, 0]), ([0, 0, 1], [1, 0, 0]), ([-1, 0, 0], [0, 1, 0]),
    ([1, 1, 0], None), ([1, 0.5, 0.5], None), ([1, 1, 1], None), ([1, 1e-12, 0], [0, 1, 0]),
    ([1, 0, 1e-6], [0, 1, 0]), ([1, 1e-6, 0], None), ([1, -0.7, 0], None),
])  # fmt: skip
def test_default_first_axis(normal: list[float], axis: list[float] | None) -> None:
    """Of the axes other than the one nearest to the normal the first, made perpendicular to it."""
    text = LEVEL.replace("NORMAL", str(normal)).replace("at: [1, 0, 0]", "at: [1, 0.01, 0.02]")
    e1 = solved(text).sections["cut"]["first_axis"][0]
    n = np.array(normal) / np.linalg.norm(normal)
    if axis is None:
        start = np.array([0.0, 1.0, 0.0])
        axis = (start - (start @ n) * n) / np.linalg.norm(start - (start @ n) * n)
    near(e1, axis, 1.0, 2e-12)


@pytest.mark.parametrize("slope", [0.0, 1e-12, 1e-6, -1e-6, 0.5, 0.78])
def test_the_slope_of_a_bar_does_not_turn_e1_over(slope: float) -> None:
    """A sagging bar's moment is M2 and its shear Q1, drawn level or not; the heading says what was chosen."""
    x, y = math.cos(slope), math.sin(slope)
    bar = f"""
heun: 1
gravity: [{9.81 * y!r}, {-9.81 * x!r}, 0]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar:
    shapes: [{{type: rod, from: [0, 0, 0], to: [{2 * x!r}, {2 * y!r}, 0], mass: 3}}]
    points: {{a: [0, 0, 0], b: [{2 * x!r}, {2 * y!r}, 0]}}
joints: {{wall: {{type: weld, from: ground.O, to: bar.a}}}}
sections: {{run: {{body: bar, from: a, to: b, count: 3}}}}
"""
    found = solved(bar).sections["run"]
    near(found["M2"][0], [-29.43, -29.43 / 4, 0.0], 29.43, 1e-12)
    near(found["Q1"][0], [-29.43, -29.43 / 2, 0.0], 29.43, 1e-12)
    (heading,) = (info.first_axis for info in make_labels(load("bar.yaml", bar)).sections.values())
    assert heading.startswith("body y") and ("closest to body x" in heading) == (abs(slope) > 1e-9)


@pytest.mark.heavy
def test_a_run_says_where_it_is() -> None:
    """s from `from` to `to`, points and rows alike; single cuts have neither."""
    found: dict[str, Any] = solved(DOUBLE).sections["up"]
    near(found["s"], np.linspace(0, 1, 6), 1.0, 1e-15)
    assert found["N"].shape == (21, 6) and found["point"].shape == (21, 6, 3) and found["normal"].shape == (21, 3)
    single = solved(LEVEL.replace("NORMAL", "[1, 0, 0]")).sections["cut"]
    assert "s" not in single and "side" not in single and single["N"].shape == (1,)
