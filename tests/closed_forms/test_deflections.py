"""Deflections and buckling by beam theory against textbooks' formulas, and for tapers against quadrature.

Timoshenko, Strength of Materials, part I: cantilevers, beams on two supports; Euler's column.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from heuncli.base.errors import HeunError
from heuncli.results.results import Block, Results
from heuncli.study.queries.bars import WholeBar
from heuncli.study.queries.expectations import compare
from tests.shared.drawn_bars import panels_of
from tests.shared.scenes import near, solved, study

E, L = 210e9, 1.5
WIDTH, HEIGHT, DENSITY = 0.03, 0.06, 7850.0  # along y, z
I1, I2 = WIDTH * HEIGHT**3 / 12, HEIGHT * WIDTH**3 / 12
Q = DENSITY * WIDTH * HEIGHT * 9.81
FORCE = (-900.0, 40.0, -70.0)
BOX = f"{{type: box, center: [{L / 2}, 0, 0], size: [{L}, {WIDTH}, {HEIGHT}], density: {DENSITY}}}"
CANTILEVER = "joints: {wall: {type: weld, from: ground.O, to: bar.root}}"
ON_TWO_SUPPORTS = """joints:
  pin: {type: universal, from: ground.O, to: bar.root, axis: [0, 1, 0], to_axis: [0, 0, 1]}
  guide: {type: rod, from: ground.below, to: bar.tip}
  side: {type: rod, from: ground.aside, to: bar.tip}
"""


def scene(section: str, *, joints: str = CANTILEVER, shape: str = BOX, more: str = "", gravity: float = 0.0) -> Results:
    """A bar along x from its root at the origin, solved; `section` after the section's body."""
    return solved(text(section, joints=joints, shape=shape, more=more, gravity=gravity))


def text(section: str, *, joints: str = CANTILEVER, shape: str = BOX, more: str = "", gravity: float = 0.0) -> str:
    return f"""
heun: 1
gravity: [0, 0, {-gravity}]
ground: {{points: {{O: [0, 0, 0], below: [{L}, 0, -1], aside: [{L}, 1, 0]}}}}
bodies: {{bar: {{shapes: [{shape}], points: {{root: [0, 0, 0], middle: [{L / 2}, 0, 0], tip: [{L}, 0, 0]}}}}}}
{joints}
{more}
sections: {{along: {{body: bar, {section}}}}}
"""


def along(keys: str = "reference: start", ends: str = "from: root, to: tip", properties: str = "auto") -> str:
    return f"{ends}, count: 7, properties: {properties}, deflection: true, modulus: 210 GPa, {keys}"


def tip_force(force: tuple[float, ...] = FORCE) -> str:
    return f"forces: {{push: {{type: force, on: bar.tip, vector: {[*force]}}}}}"


def curve(found: Results, number: str) -> np.ndarray:
    return np.asarray(found.sections["along"]["deflection"][number][0])


def test_a_cantilever_bends_along_both_axes() -> None:
    found = scene(along(), more=tip_force())
    s = np.linspace(0.0, L, 7)
    shape, slope = s**2 * (3 * L - s) / 6, s * (2 * L - s) / 2
    for number, force, I in (("1", FORCE[1], I2), ("2", FORCE[2], I1)):
        near(curve(found, f"w{number}"), force * shape / (E * I), abs(force) * L**3 / (3 * E * I), 1e-11)
        near(curve(found, f"slope{number}"), force * slope / (E * I), abs(force) * L**2 / (2 * E * I), 1e-11)


def test_own_weight_between_two_supports() -> None:
    found = scene(along("reference: chord"), joints=ON_TWO_SUPPORTS, gravity=9.81)
    s = np.linspace(0.0, L, 7)
    sag = 5 * Q * L**4 / (384 * E * I1)
    near(curve(found, "w2"), -Q * s * (L**3 - 2 * L * s**2 + s**3) / (24 * E * I1), sag, 1e-11)
    near(curve(found, "w2")[3], -sag, sag, 1e-11)
    near(curve(found, "slope2")[[0, -1]], np.array([-1, 1]) * Q * L**3 / (24 * E * I1), sag / L, 1e-10)
    near(curve(found, "w1"), 0.0, sag, 1e-11)


def test_the_reference_moves_the_curve_as_a_rigid_bar() -> None:
    curves = {r: scene(along(f"reference: {r}"), more=tip_force()) for r in ("chord", "start", "end")}
    s = np.linspace(0.0, L, 7)
    w = {r: curve(found, "w2") for r, found in curves.items()}
    tip = w["start"][-1]
    size = abs(tip)
    near(w["chord"], w["start"] - s / L * tip, size, 1e-12)
    near(w["end"][-1], 0.0, size, 1e-12)
    near(curve(curves["end"], "slope2")[-1], 0.0, size / L, 1e-12)
    for r in ("chord", "end"):
        rest = w[r] - w["start"]
        near(np.diff(rest, 2), 0.0, size, 1e-12)
        near(curve(curves[r], "slope2") - curve(curves["start"], "slope2"), (rest[-1] - rest[0]) / L, size / L, 1e-12)


def test_a_reversed_run_mirrors() -> None:
    """Its e1 is the same, e2 = n x e1 the opposite; slopes are over the opposite direction."""
    forth, back = (
        scene(along("reference: chord, first_axis: [0, 1, 0]", ends), more=tip_force(), gravity=9.81)
        for ends in ("from: root, to: tip", "from: tip, to: root")
    )
    for number, sign in (("1", 1.0), ("2", -1.0)):
        w, slope = curve(forth, f"w{number}"), curve(forth, f"slope{number}")
        near(curve(back, f"w{number}")[::-1], sign * w, np.abs(w).max(), 1e-11)
        near(curve(back, f"slope{number}")[::-1], -sign * slope, np.abs(slope).max(), 1e-11)
    near(forth.sections["along"]["buckling"], back.sections["along"]["buckling"], 10.0, 1e-12)


@pytest.mark.parametrize("turn", [0.0, 0.3, 1.0, 2.0])
def test_axes_turned_about_the_bar(turn: float) -> None:
    """An angle has no principal axis along its legs: the components turn with e1."""
    c, s = math.cos(turn), math.sin(turn)
    force = (0.0, 40.0, -70.0)
    shape = (
        f"{{type: L, height: 0.1, width: 0.06, web: 0.008, flange: 0.008, from: [0, 0, 0], to: [{L}, 0, 0], "
        "density: 7850}"
    )
    found = scene(along(f"reference: start, first_axis: [0, {c}, {s}]"), shape=shape, more=tip_force(force))
    w = np.array([curve(found, "w1")[-1], curve(found, "w2")[-1]])
    a, b, t = 0.06, 0.1, 0.008  # by its two rectangles, along y and z
    parts = [(a * t, (a / 2, t / 2), (a, t)), (t * (b - t), (t / 2, (b + t) / 2), (t, b - t))]
    area = sum(A for A, _, _ in parts)
    middle = sum(A * np.array(p) for A, p, _ in parts) / area
    second = sum(A * (np.diag(np.square(size)) / 12 + np.outer(p - middle, p - middle)) for A, p, size in parts)
    expected = L**3 / (3 * E) * np.linalg.solve(second, np.array(force[1:]))
    near(np.array([[c, -s], [s, c]]) @ w, expected, np.abs(expected).max(), 1e-9)


def test_twice_the_modulus_half_the_deflection() -> None:
    one = scene(along(), more=tip_force())
    other = scene(along().replace("210 GPa", "420 GPa"), more=tip_force())
    near(curve(one, "w2"), 2 * curve(other, "w2"), 1e-3, 1e-13)
    near(2 * one.sections["along"]["buckling"], other.sections["along"]["buckling"], 10.0, 1e-13)


def test_given_properties_and_those_of_the_shape_agree() -> None:
    given = (f"{{rectangle: {{width: {WIDTH}, height: {HEIGHT}}}}}",
             f"{{area: 1e-3, I1: {I1}, I2: {I2}, J: 1e-7, c1: 0.01, c2: 0.01}}")  # fmt: skip
    w = curve(scene(along(), more=tip_force()), "w1")
    for properties in given:
        near(curve(scene(along(properties=properties), more=tip_force()), "w1"), w, np.abs(w).max(), 1e-11)


@pytest.mark.parametrize("end", [0.018, 0.005, 0.001])
def test_a_taper_is_integrated_with_its_own_second_moment(end: float) -> None:
    """By the virtual work of a unit force and couple at the tip, with 400 points of Gauss."""
    shape = f"{{type: cone, from: [0, 0, 0], to: [{L}, 0, 0], radius: 0.02, to_radius: {end}, density: 7850}}"
    found = scene(along("reference: start"), shape=shape, more=tip_force((-5.0, 0.0, -0.7)))
    x, weight = np.polynomial.legendre.leggauss(400)
    s, weight = 0.5 * L * (x + 1), 0.5 * L * weight
    flexibility = weight * 0.7 * (L - s) / (E * math.pi / 4 * (0.02 + (end - 0.02) * s / L) ** 4)
    w, slope = flexibility @ (L - s), flexibility.sum()
    near(curve(found, "w2")[-1], -w, w, 1e-9)
    near(curve(found, "slope2")[-1], -slope, slope, 1e-9)
    euler = math.pi**2 * E * math.pi / 4 * end**4 / L**2
    near(found.sections["along"]["buckling"], min(euler / 5.0, 1000.0), euler / 5.0, 1e-9)


def test_the_largest_deflection_lies_between_the_cuts() -> None:
    """A force at b = 0.3 L from the right: P b (L^2 - b^2)^(3/2)/(9 sqrt(3) L E I), at sqrt((L^2 - b^2)/3)."""
    b = 0.3 * L
    sag = 500.0 * b * (L**2 - b**2) ** 1.5 / (9 * math.sqrt(3) * L * E * I1)
    done = study(f"""
heun: 1
ground: {{points: {{O: [0, 0, 0], below: [{L}, 0, -1], aside: [{L}, 1, 0]}}}}
bodies: {{bar: {{shapes: [{BOX}], points: {{root: [0, 0, 0], at: [{L - b}, 0, 0], tip: [{L}, 0, 0]}}}}}}
{ON_TWO_SUPPORTS}
forces: {{push: {{type: force, on: bar.at, vector: [0, 0, -500]}}}}
sections: {{along: {{body: bar, {along("reference: chord")}}}}}
expect: [{{of: sections.along.deflection.w2, peak: min, is: {-sag!r}, rel: 1e-10}}]
""")
    verdict = compare(done, done.spec.expect[0])
    assert verdict.is_met, verdict
    assert np.abs(done.results.sections["along"]["deflection"]["w2"]).max() < 0.999 * sag


def test_a_load_that_travels_along_the_beam() -> None:
    """A trolley of weight P at a from the left: w = -P b x (L^2 - b^2 - x^2)/(6 L E I) for x < a, b = L - a."""
    P, speed = 2.0 * 9.81, 0.9
    found = solved(f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0], below: [{L}, 0, -1], aside: [{L}, 1, 0]}}}}
bodies:
  bar: {{shapes: [{BOX.replace("7850.0", "1e-9")}], points: {{root: [0, 0, 0], tip: [{L}, 0, 0]}}}}
  trolley: {{mass: 2, center: [0, 0, 0], inertia: [0.01, 0.01, 0.01], points: {{c: [0, 0, 0]}}}}
{ON_TWO_SUPPORTS}
  rail: {{type: slide, from: bar.root, to: trolley.c, axis: [1, 0, 0]}}
drives: {{ride: {{joint: rail, travel: "0.1 + {speed}*t"}}}}
sections: {{along: {{body: bar, {along("reference: chord")}}}}}
analysis: {{duration: 1.4, samples: 15}}
""")
    deflections = np.asarray(found.sections["along"]["deflection"]["w2"])
    rows = np.array(found.sections["along"]["s"])
    for t, w in zip(found.time, deflections, strict=True):
        a = 0.1 + speed * t
        b = L - a
        before = P * b * rows * (L**2 - b**2 - rows**2)
        after = P * a * (L - rows) * (L**2 - a**2 - (L - rows) ** 2)
        expected = -np.where(rows < a, before, after) / (6 * L * E * I1)
        near(w, expected, P * L**3 / (48 * E * I1), 1e-8)


def test_buckling_by_euler_in_the_weaker_plane() -> None:
    pinned = scene(along(), more=tip_force()).sections["along"]
    mast = scene(along("length_factor: 2"), more=tip_force()).sections["along"]
    pulled = scene(along(), more=tip_force((900.0, 0.0, 0.0))).sections["along"]
    euler = math.pi**2 * E * I2 / L**2
    near(pinned["buckling"], euler / 900.0, euler / 900.0, 1e-11)
    near(4 * mast["buckling"], euler / 900.0, euler / 900.0, 1e-11)
    assert pulled["buckling"].tolist() == [1000.0]


def test_the_largest_compression_anywhere_counts() -> None:
    """A standing column carries its own weight: the most at the foot of the run, which here comes last."""
    found = scene(
        along(ends=f"from: tip, to: [{L / 4}, 0, 0]"),
        more="""
forces:
  push: {type: distributed, on: bar, from: root, to: tip, vector: [-800, 0, 0]}
""",
    )
    near(found.sections["along"]["buckling"], math.pi**2 * E * I2 / (0.75 * L) ** 2 / (800 * 0.75 * L), 100.0, 1e-11)


def test_what_supports_leave_open_has_no_deflection() -> None:
    joints = CANTILEVER[:-1] + ", end: {type: weld, from: ground.far, to: bar.tip}}"
    text = scene_text(joints)
    found = solved(text)
    block: Block = found.sections["along"]
    assert "M1" in block["open"] and np.isnan(block["deflection"]["w2"]).any() and np.isnan(block["buckling"]).all()


def scene_text(joints: str) -> str:
    return f"""
heun: 1
ground: {{points: {{O: [0, 0, 0], far: [{L}, 0, 0]}}}}
bodies: {{bar: {{shapes: [{BOX}], points: {{root: [0, 0, 0], middle: [{L / 2}, 0, 0], tip: [{L}, 0, 0]}}}}}}
{joints}
sections: {{along: {{body: bar, {along("reference: chord")}}}}}
"""


def test_impulses_have_no_deflection() -> None:
    found = solved(scene_text(CANTILEVER) + "impulses: {blow: {on: bar.tip, vector: [0, 0, 1]}}\n")
    assert not {"deflection", "buckling", "stress"} & found.impulses[0]["sections"]["along"].keys()


@pytest.mark.parametrize(
    ("section", "code"),
    [
        (along().replace("modulus: 210 GPa, ", ""), "deflection-form"),
        (along().replace("properties: auto, ", ""), "deflection-form"),
        ("at: middle, normal: [1, 0, 0], properties: auto, deflection: true, modulus: 210 GPa", "deflection-form"),
        ("from: root, to: tip, count: 3, modulus: 210 GPa", "deflection-form"),
        (along("length_factor: 0"), "not-positive"),
        (along("reference: middle"), "unknown-word"),
    ],
)
def test_what_is_refused(section: str, code: str) -> None:
    with pytest.raises(HeunError) as caught:
        scene(section)
    assert [p.code for p in caught.value.problems] == [code]


def test_a_point_is_too_weak_for_beam_theory() -> None:
    shape = f"{{type: cone, from: [0, 0, 0], to: [{L}, 0, 0], radius: 0.02, to_radius: 1e-8, density: 7850}}"
    with pytest.raises(HeunError) as caught:
        scene(along(), shape=shape)
    assert [p.code for p in caught.value.problems] == ["no-deflection"]


def test_a_diagram_shows_the_curve_below_the_section_forces() -> None:
    """Also the range over a run: the cantilever's tip force grows with time."""
    still = study(text(along(), more=tip_force()))
    line = WholeBar(still, "along").make_lines(0.0)["deflection.w2"]
    near(
        line.values, FORCE[2] * line.s**2 * (3 * L - line.s) / (6 * E * I1), abs(FORCE[2]) * L**3 / (3 * E * I1), 1e-11
    )
    labels = list(panels_of(still, "along"))
    assert labels[-2:] == ["w1", "w2"] and "M1" in labels
    assert list(panels_of(still, "along.deflection.slope1")) == ["slope1"]
    push = "forces: {push: {type: force, on: bar.tip, vector: [0, 0, -70*t*(2 - t)]}}"
    grown = WholeBar(study(text(along(), more=f"{push}\nanalysis: {{duration: 1.6, samples: 4}}")), "along")
    tip = -70.0 * L**3 / (3 * E * I1)
    found = grown.make_ranges()["deflection.w2"]
    near(np.array([found.lowest.value, found.lowest.s, found.lowest.time]) / (tip, L, 1.0), 1.0, 1.0, 1e-6)
    near(found.low[-1], tip, abs(tip), 1e-6)
