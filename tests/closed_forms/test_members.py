"""Members: their cross-sections against printed tables, own integrals and closed forms; their mass; their stresses.

Tables: EN 10365 (IPE, HEA, HEB, HEM), DIN 1026-1 (UPN), as ArcelorMittal's sales programme prints them; EN 10210-2 for
hollow sections. cm2, cm4, cm3. Tolerances are half a unit of the last digit that is printed.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from heuncli.base.errors import Finding
from heuncli.loads.kinetostatics.member_stress import compute_member_stresses, make_factors
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Member, Shape
from heuncli.scene.file_format.profiles import Family, Measures, compute_area, find_profile, read_tables
from heuncli.scene.shapes.composite_solid import make_composite_solid
from heuncli.scene.shapes.member_section import MemberSection, make_member_section
from heuncli.scene.shapes.member_solid import make_member_solid
from heuncli.study.workflow import solve
from tests.shared.member_regions import is_inside

# name: A, I about the width, I about the height, J, W about the width
PRINTED = {
    "IPE 80": ("7.64", "80.14", "8.49", "0.70", "20.03"),
    "IPE 200": ("28.48", "1943", "142.4", "6.98", "194.3"),
    "IPE 300": ("53.81", "8356", "603.8", "20.12", "557.1"),
    "IPE 600": ("156.0", "92080", "3387", "165.4", "3069"),
    "HEA 100": ("21.24", "349.2", "133.8", "5.24", "72.76"),
    "HEA 200": ("53.83", "3692", "1336", "20.98", "388.6"),
    "HEA 1000": ("346.8", "553800", "14000", "", ""),
    "HEB 100": ("26.04", "449.5", "167.3", "9.25", "89.91"),
    "HEB 200": ("78.08", "5696", "2003", "59.28", "569.6"),
    "HEB 300": ("149.1", "25170", "8563", "185.0", "1678"),
    "HEM 100": ("53.24", "1143", "399.2", "68.21", "190.4"),
    "HEM 200": ("131.3", "10640", "3651", "259.4", "967.4"),
    "HEM 1000": ("444.2", "722300", "18460", "", ""),
    "RHS 100x50x4": ("11.2", "140", "46.2", "113", "27.9"),
    "RHS 200x100x8": ("44.8", "2234", "739", "1804", "223"),
    "SHS 100x5": ("18.7", "279", "279", "439", "55.9"),
}
# three digits; the largest deviation is 0.7 %, of Iz of UPN 400
CHANNELS = {
    "UPN 80": (11.0, 106.0, 19.4, 2.16), "UPN 100": (13.5, 206.0, 29.3, 2.81), "UPN 200": (32.2, 1910.0, 148.0, 11.9),
    "UPN 300": (58.8, 8030.0, 495.0, 37.4), "UPN 350": (77.3, 12840.0, 570.0, 61.2),
    "UPN 400": (91.5, 20350.0, 846.0, 81.6),
}  # fmt: skip
SHEAR_CENTRES = {"UPN 80": 2.67, "UPN 100": 2.93, "UPN 200": 3.94, "UPN 300": 5.41}  # from the centroid [cm]
LINES = 12000
OWN: tuple[tuple[Family, Measures], ...] = (
    ("I", Measures(0.1, 0.2, 0.006, 0.009, 0.012, 0.003)),
    ("C", Measures(0.08, 0.16, 0.008, 0.011, 0.01, 0.005, 0.08)),
    ("L", Measures(0.08, 0.12, 0.008, 0.01, 0.011, 0.005)),
    ("T", Measures(0.1, 0.08, 0.007, 0.01, 0.012, 0.002)),
    ("box", Measures(0.06, 0.1, 0.005, 0.005, 0.008, 0.004)),
)


def half_a_digit(printed: str) -> float:
    """Half a unit of the last digit; of the zeros before the point only the fourth digit and later ones are rounded."""
    digits = printed.replace(".", "").lstrip("0")
    if "." in printed:
        return 0.5001 * 10.0 ** -len(printed.partition(".")[2])
    return 0.5001 * 10.0 ** max(len(digits) - 4, 0)


def section(name: str) -> MemberSection:
    profile = find_profile(name)
    assert profile.measures is not None
    assert profile.family != "tube"
    return make_member_section(profile.family, profile.measures)


@pytest.mark.parametrize("name", PRINTED)
def test_printed_tables(name: str) -> None:
    found = section(name)
    numbers = (found.area * 1e4, found.Ivv * 1e8, found.Iuu * 1e8, found.J * 1e8, found.moduli[0] * 1e6)
    for number, printed in zip(numbers, PRINTED[name], strict=True):
        if printed:
            assert number == pytest.approx(float(printed), abs=half_a_digit(printed)), printed


@pytest.mark.parametrize("name", CHANNELS)
def test_printed_channels(name: str) -> None:
    found = section(name)
    numbers = (found.area * 1e4, found.Ivv * 1e8, found.Iuu * 1e8)
    assert numbers == pytest.approx(CHANNELS[name][:3], rel=7e-3)
    assert found.J * 1e8 == pytest.approx(CHANNELS[name][3], rel=0.025)


@pytest.mark.parametrize("name", SHEAR_CENTRES)
def test_printed_shear_centres(name: str) -> None:
    measures = find_profile(name).measures
    assert measures is not None
    found = section(name).shear_center * 1e2
    assert found[1] == 0.0
    assert -found[0] == pytest.approx(SHEAR_CENTRES[name], abs=0.02 * measures.width * 1e2)


def test_names() -> None:
    assert find_profile("HE 200 A") == find_profile("hea200") == find_profile("HEA 200")
    assert find_profile("SHS 80x80x5") == find_profile("shs 80×5")
    assert len(read_tables()) == 18 + 3 * 24 + 16
    tube = find_profile("CHS 60.3x3.2")
    assert (tube.family, tube.radius, tube.inner_radius) == ("tube", pytest.approx(0.03015), pytest.approx(0.02695))
    cold, hot = find_profile("CFRHS 100x50x4").measures, find_profile("RHS 100x50x4").measures
    assert cold is not None
    assert hot is not None
    assert (cold.radius, cold.toe_radius, hot.radius, hot.toe_radius) == pytest.approx((8e-3, 4e-3, 6e-3, 4e-3))


@pytest.mark.parametrize(("name", "hint"), [
    ("IPE 210", "the nearest are IPE 200 and IPE 220"), ("HEC 100", "did you mean HEM 100?"),
    ("SHS 80x60x5", "SHS 80x5"), ("RHS 80x5", "RHS 100x50x4"), ("XYZ", "IPE 200"),
])  # fmt: skip
def test_unknown_names(name: str, hint: str) -> None:
    with pytest.raises(Finding) as caught:
        find_profile(name)
    assert caught.value.code == "unknown-profile"
    assert hint in caught.value.hint


def integrate(inside: Callable[[Array, Array], Array], m: Measures, low: float, left: float) -> Array:
    """1, x, y, x^2, x y, y^2 over a cross-section: along 12,000 lines, between crossings, which are bisected."""
    y = low + m.height * (np.arange(LINES) + 0.5) / LINES
    x = left + m.width * np.linspace(-1e-9, 1.0 + 1e-9, 400)
    flags = inside(x[None] + 0.0 * y[:, None], y[:, None] + 0.0 * x[None])
    row, k = np.nonzero(flags[:, 1:] != flags[:, :-1])
    a, c, was = x[k], x[k + 1], flags[row, k]
    for _ in range(45):
        middle = 0.5 * (a + c)
        same = inside(middle, y[row]) == was
        a, c = np.where(same, middle, a), np.where(same, c, middle)
    sign = np.where(was, 1.0, -1.0) * m.height / LINES
    terms = (a, a**2 / 2, a * y[row], a**3 / 3, a**2 / 2 * y[row], a * y[row] ** 2)
    return np.array([(sign * term).sum() for term in terms])


@pytest.mark.parametrize(("family", "m"), OWN)
@pytest.mark.third
def test_area_and_moments_by_lines(family: Family, m: Measures) -> None:
    """An integral over lines, without the outline's corners and arcs."""
    left = 0.0 if family in ("C", "L") else -0.5 * m.width
    low = -0.5 * m.height if family == "box" else 0.0
    A, Sx, Sy, xx, xy, yy = integrate(is_inside(family, m), m, low, left)
    found = make_member_section(family, m)
    x, y = Sx / A, Sy / A
    assert found.area == pytest.approx(A, rel=2e-4)
    assert compute_area(family, m) == pytest.approx(found.area, rel=1e-13)
    assert found.centroid == pytest.approx((x, y), abs=2e-4 * m.height)
    size = found.Ivv
    assert found.Ivv == pytest.approx(yy - A * y * y, rel=3e-4)
    assert found.Iuu == pytest.approx(xx - A * x * x, rel=3e-4)
    assert found.Iuv == pytest.approx(xy - A * x * y, abs=3e-4 * size)


def test_angle_with_equal_legs() -> None:
    """Its principal axes stand at 45 degrees, its shear centre is where the middle lines meet."""
    found = make_member_section("L", Measures(0.1, 0.1, 0.01, 0.01, 0.012, 0.006))  # EN 10056-1: 19.2 cm2, 177 cm4
    assert (found.area * 1e4, found.Ivv * 1e8) == pytest.approx((19.2, 177.0), abs=0.5)
    first, second, angle = found.principal
    assert (first * 1e8, second * 1e8) == pytest.approx((280.0, 73.0), abs=0.5)
    assert angle == pytest.approx(math.pi / 4)
    assert found.centroid + found.shear_center == pytest.approx([0.005, 0.005])


def test_thin_channel() -> None:
    """Timoshenko: the shear centre is 3 b^2 f/(h t + 6 b f) before the web, of middle lines b and h."""
    b, h, t, f = 0.1, 0.2, 0.002, 0.003
    found = make_member_section("C", Measures(b + t / 2, h + f, t, f))
    before_web = -(found.centroid[0] + found.shear_center[0] - t / 2)
    assert before_web == pytest.approx(3 * b * b * f / (h * t + 6 * b * f), rel=1e-3)


def solid(family: Family, first: Measures, last: Measures) -> Shape:
    return Shape(
        "member", density=2.0, from_=(0.1, 0.2, 0.3), to=(1.1, 0.4, 0.6), member=Member(family, first, last, None)
    )


@pytest.mark.parametrize(("family", "m"), OWN)
def test_mass_of_a_prism(family: Family, m: Measures) -> None:
    """Mass by the area; second moments across the axis by those of the cross-section, along it by the length."""
    shape = solid(family, m, m)
    start, end = np.array(shape.from_), np.array(shape.to)
    body = make_member_solid(shape.member, start, end, 2.0)  # type: ignore[arg-type]
    P = make_composite_solid([shape]).whole_inertia()
    length = float(np.linalg.norm(end - start))
    found = make_member_section(family, m)
    assert P[3, 3] == pytest.approx(2.0 * found.area * length, rel=1e-12)
    center = P[:3, 3] / P[3, 3]
    assert center == pytest.approx(0.5 * (start + end), abs=1e-13)
    second = P[:3, :3] - P[3, 3] * np.outer(center, center)
    u, v = body.first_axis, np.cross(body.axis, body.first_axis)
    assert body.axis @ second @ body.axis == pytest.approx(P[3, 3] * length**2 / 12.0)
    assert u @ second @ u == pytest.approx(2.0 * length * found.Iuu, rel=3e-5)
    assert v @ second @ v == pytest.approx(2.0 * length * found.Ivv, rel=3e-5)
    assert u @ second @ v == pytest.approx(2.0 * length * found.Iuv, abs=3e-5 * 2.0 * length * found.Ivv)


@pytest.mark.parametrize(("family", "m"), OWN)
def test_cut_at_any_angle(family: Family, m: Measures) -> None:
    """The pieces of a tapered member are its whole; a plane that shows more of it by 1/cos shows more area by it."""
    rng = np.random.default_rng(3)
    prism = make_composite_solid([solid(family, m, m)])
    tapered = make_composite_solid([solid(family, m, Measures(*(0.6 * x for x in m[:6]), m.slope))])
    axis = np.array([1.0, 0.2, 0.3]) / np.linalg.norm([1.0, 0.2, 0.3])
    for _ in range(4):
        n = axis + 0.3 * rng.normal(size=3)
        n = n / np.linalg.norm(n)
        d = n @ np.array([0.6, 0.3, 0.45]) + rng.uniform(-0.05, 0.05, 3)
        pieces = [tapered.piece_inertias(s * n, s * d, np.zeros(3)) for s in (1.0, -1.0)]
        assert pieces[0] + pieces[1] == pytest.approx(np.repeat(tapered.whole_inertia()[None], 3, axis=0), abs=1e-12)
        sections = prism.cross_sections(n, d, np.zeros(3))
        assert sections.area * abs(axis @ n) == pytest.approx(np.full(3, make_member_section(family, m).area))
        assert sections.regions.tolist() == [1, 1, 1]


def test_tapered_member_has_the_measures_between() -> None:
    a, b = Measures(0.1, 0.3, 0.006, 0.01), Measures(0.1, 0.1, 0.006, 0.01)
    body = make_composite_solid([solid("I", a, b)])
    n = np.array([1.0, 0.2, 0.3]) / np.linalg.norm([1.0, 0.2, 0.3])
    area = body.cross_sections(n, np.array([n @ np.array([0.35, 0.25, 0.375])]), np.zeros(1)).area
    assert area == pytest.approx(2 * 0.1 * 0.01 + (0.25 - 0.02) * 0.006)


LOADS = {"N": 1e4, "Q1": 2e3, "Q2": -5e3, "T": 80.0, "M1": 900.0, "M2": 300.0}


def stresses(family: Family, m: Measures, **loads: float) -> dict[str, float]:
    arrays = {name: np.array([loads.get(name, 0.0)]) for name in LOADS}
    block = compute_member_stresses(make_factors(family, m), arrays, None)
    return {name: float(value[0]) for name, value in block.items() if name != "points"}


def test_stresses_of_an_I_by_hand() -> None:
    """Bending at the corners, shear in the middle of the web by Jourawski of middle lines, torsion by f T/J."""
    b, h, t, f = 0.1, 0.2, 0.006, 0.009
    m = Measures(b, h, t, f)
    I1 = (b * h**3 - (b - t) * (h - 2 * f) ** 3) / 12
    I2 = (2 * f * b**3 + (h - 2 * f) * t**3) / 12
    found = stresses("I", m, M1=900.0, M2=300.0)
    assert found["normal_max"] == pytest.approx(900 * h / 2 / I1 + 300 * b / 2 / I2)
    H = h - f
    I_lines = 2 * b * f * (H / 2) ** 2 + t * H**3 / 12
    largest = 5e3 * (b * f * H / 2 + t * (H / 2) ** 2 / 2) / (I_lines * t)
    found = stresses("I", m, Q2=-5e3)
    assert found["shear_max"] == pytest.approx(largest)
    assert found["shear_mean"] == pytest.approx(5e3 / (2 * b * f + (h - 2 * f) * t))
    found = stresses("I", m, T=80.0)
    assert found["shear_torsion"] == pytest.approx(80.0 * f / make_member_section("I", m).J)
    assert found["mises"] == pytest.approx(math.sqrt(3.0) * found["shear_torsion"])


def test_stresses_of_a_box_by_hand() -> None:
    """Bredt and the wall's own torsion; shear of two webs, largest in their middle."""
    b, h, t = 0.1, 0.1, 0.005
    m = Measures(b, h, t, t)
    enclosed, length = (b - t) * (h - t), 2 * (b + h - 2 * t)
    J = t**3 * length / 3 + 4 * enclosed**2 * t / length
    found = stresses("box", m, T=1000.0)
    assert found["shear_torsion"] == pytest.approx(1000.0 * (t + 2 * enclosed / length) / J)
    thin = stresses("box", Measures(b, h, 1e-3, 1e-3), T=1000.0)
    assert thin["shear_torsion"] == pytest.approx(1000.0 / (2 * (b - 1e-3) * (h - 1e-3) * 1e-3), rel=0.025)
    H = h - t
    S = (H / 2) * t * H / 2 + t * (H / 2) ** 2 / 2
    I_lines = 2 * (H * t * (H / 2) ** 2 + t * H**3 / 12)
    assert stresses("box", m, Q2=5e3)["shear_max"] == pytest.approx(5e3 * S / (I_lines * t))


@pytest.mark.parametrize(("family", "m"), OWN)
def test_shear_flow_carries_the_force(family: Family, m: Measures) -> None:
    """The shear stresses over all walls add up to the force, and to no moment about the shear centre."""
    found = make_member_section(family, m)
    x, weights = np.polynomial.legendre.leggauss(6)
    x, weights = 0.5 * (1.0 + x), 0.5 * weights
    force, moment = np.zeros((2, 2)), np.zeros(2)
    for wall, flow in zip(found.walls, found.flows, strict=True):
        step = found.nodes[wall.end] - found.nodes[wall.start]
        q = np.array([x**i for i in range(4)]).T @ flow
        total = weights @ q
        force += np.outer(step, total)
        arm = found.nodes[wall.start] - found.shear_center
        moment += (arm[0] * step[1] - arm[1] * step[0]) * total
    assert force == pytest.approx(np.eye(2), abs=1e-9)
    assert moment == pytest.approx([0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize(("family", "m"), OWN)
def test_stresses_do_not_depend_on_the_axes_of_the_cut(family: Family, m: Measures) -> None:
    """Of axes turned by an angle, and of the plane seen from its other side."""
    factors = make_factors(family, m)
    own = compute_member_stresses(factors, {k: np.array([v]) for k, v in LOADS.items()}, 1e8)
    c, s = math.cos(0.7), math.sin(0.7)
    Q1, Q2, M1, M2 = (LOADS[k] for k in ("Q1", "Q2", "M1", "M2"))
    turned = LOADS | {"Q1": c * Q1 + s * Q2, "Q2": c * Q2 - s * Q1, "M1": c * M1 + s * M2, "M2": c * M2 - s * M1}
    # seen from the other side: n and e2 reversed, and force and moment are those on the other piece, reversed
    opposite = {"N": LOADS["N"], "Q1": -Q1, "Q2": Q2, "T": LOADS["T"], "M1": -M1, "M2": M2}
    for loads, frame in ((turned, (c, s, -s, c)), (opposite, (1.0, 0.0, 0.0, -1.0))):
        found = compute_member_stresses(factors, {k: np.array([v]) for k, v in loads.items()}, 1e8, frame)
        for name in ("normal_max", "normal_min", "shear_torsion", "shear_mean", "shear_max", "mises", "utilisation"):
            assert found[name] == pytest.approx(own[name], rel=1e-9), name


@pytest.mark.parametrize(("family", "m"), OWN)
def test_largest_stresses_are_bounds_of_the_walls_fields(family: Family, m: Measures) -> None:
    """At many places of the walls no stress is larger, and the largest one is nearly reached."""
    section_, rng = make_member_section(family, m), np.random.default_rng(8)
    I = np.array([[section_.Iuu, section_.Iuv], [section_.Iuv, section_.Ivv]])
    x = np.linspace(0.0, 1.0, 801)
    for _ in range(20):
        N, Q1, Q2, T, M1, M2 = rng.normal(size=6) * [2e4, 5e3, 5e3, 50.0, 1e3, 1e3]
        bend = np.linalg.solve(I, [-M2, M1])
        twist = T - (section_.shear_center[0] * Q2 - section_.shear_center[1] * Q1)
        largest = 0.0
        for wall, flow, per_torque in zip(section_.walls, section_.flows, section_.torsion_stress, strict=True):
            step = section_.nodes[wall.end] - section_.nodes[wall.start]
            across = np.array([-step[1], step[0]]) / np.hypot(*step)
            t = wall.start_thickness + (wall.end_thickness - wall.start_thickness) * x
            shear = np.array([x**i for i in range(4)]).T @ flow @ [Q1, Q2] / t
            for face in (-0.5, 0.5):
                places = section_.nodes[wall.start] + x[:, None] * step + (face * t)[:, None] * across
                sigma = N / section_.area + places @ bend
                sign = 1.0 if family == "box" else 2.0 * face
                tau = shear + sign * twist * per_torque
                largest = max(largest, float(np.sqrt(sigma**2 + 3.0 * tau**2).max()))
        found = stresses(family, m, N=N, Q1=Q1, Q2=Q2, T=T, M1=M1, M2=M2)["mises"]
        assert largest <= found * (1.0 + 1e-12)
        assert found < 1.35 * largest


BEAM = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  beam:
    shapes: [SHAPE]
    points: {a: [0, 0, 0], b: [2, 0, 0]}
joints: {wall: {type: weld, from: ground.O, to: beam.a}}
forces: {tip: {type: force, on: beam.b, vector: [0, 300, -1000]}}
sections:
  auto: {body: beam, at: [0.5, 0, 0], normal: [1, 0, 0], properties: auto}
  given: {body: beam, at: [0.5, 0, 0], normal: [1, 0, 0], properties: GIVEN}
  back: {body: beam, at: [0.5, 0, 0], normal: [-1, 0, 0], first_axis: [0, 1, 2], properties: auto}
"""
EQUAL = {
    "{type: profile, profile: UPN 120, from: [0, 0, 0], to: [2, 0, 0], density: 7850}": "{profile: UPN120}",
    "{type: L, height: 90 mm, width: 70 mm, web: 8 mm, flange: 9 mm, radius: 9 mm, from: [0, 0, 0], to: [2, 0, 0], "
    "mass: 3}": "{L: {height: 90 mm, width: 70 mm, web: 8 mm, flange: 9 mm, radius: 9 mm}}",
    "{type: box, center: [1, 0, 0], size: [2, 60 mm, 90 mm], wall: 4 mm, mass: 3}":
        "{box: {height: 90 mm, width: 60 mm, wall: 4 mm}}",
    "{type: T, height: 90 mm, to_height: 50 mm, width: 70 mm, web: 8 mm, flange: 9 mm, from: [0, 0, 0], to: [2, 0, 0], "
    "mass: 3}": "{T: {height: 80 mm, width: 70 mm, web: 8 mm, flange: 9 mm}}",
    "{type: profile, profile: CHS 60.3x3.2, from: [0, 0, 0], to: [2, 0, 0], density: 7850}": "{profile: CHS 60.3x3.2}",
}  # fmt: skip


@pytest.mark.parametrize("shape", EQUAL)
def test_stresses_of_shapes_are_those_of_properties(shape: str) -> None:
    """Whatever the cut's axes and sides."""
    spec = load("x.yaml", text=BEAM.replace("SHAPE", shape).replace("GIVEN", EQUAL[shape]))
    sections = solve(spec).results.sections
    for name in ("normal_max", "normal_min", "shear_torsion", "shear_max", "mises"):
        expected = sections["given"]["stress"][name]
        assert sections["auto"]["stress"][name] == pytest.approx(expected, rel=2e-6, abs=1.0), name
        assert sections["back"]["stress"][name] == pytest.approx(expected, rel=2e-6, abs=1.0), name
