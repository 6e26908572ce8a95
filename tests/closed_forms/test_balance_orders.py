"""`heun balance`: orders of slider-cranks and engines against their closed forms and the textbooks' tables."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from heuncli.analyses.balancing.results import BalanceOptions
from heuncli.analyses.balancing.study import balance
from heuncli.scene.file_format.load import load
from tests.shared.cycling import RPM, Cylinder, amplitude, balance_of, engine, row_of

SPECS = Path(__file__).parents[2] / "specs"
PISTON = {  # -x''/(r ω²) of cos(kφ), by crank over rod: the series in elliptic integrals
    (1.0, 3.0): (1.0, 0.3431085772854066, -0.01009907915242399, 0.0003344321532971346, -1.093827037107022e-5),
    (1.0, 4.0): (1.0, 0.2540250423069753, -0.004098111172029278, 7.437903279419574e-5, -1.333291504827959e-6),
    (45.0, 140.0): (1.0, 0.3301588531472815, -0.008998066126766215, 0.0002758977154432287, -8.355261843123624e-6),
}
DIGITS = 1e-12  # of the largest


@pytest.mark.parametrize("lengths", PISTON)
def test_a_piston_shakes_by_its_series(lengths: tuple[float, float]) -> None:
    r, l = 0.01 * lengths[0], 0.01 * lengths[1]
    found = balance_of(engine([Cylinder(0.0, mass=1.5)], r, l, rate=10.0))
    for k, wanted in zip((1, 2, 4, 6, 8), PISTON[lengths], strict=True):
        own = amplitude(found, "force", k) / (1.5 * r * 100.0)
        assert abs(own - [wanted, 0, 0]).max() < DIGITS
        row = row_of(found, "force", k)
        assert (
            row is not None and row.verdict == "remains" and row.with_turn == pytest.approx(row.against_turn, rel=1e-9)
        )
    assert all(row.verdict == "does not arise" for row in found.orders["force"] if row.order in (3, 5, 7))


def test_primary_and_secondary_of_a_single_cylinder() -> None:
    found = balance_of(engine([Cylinder(0.0)]))
    wanted = {1: 4386.490844928604, 2: 1114.2785224621, 4: -17.976327137606, 6: 0.32626294640638}
    for k, value in wanted.items():
        assert abs(amplitude(found, "force", k) - [value, 0, 0]).max() < DIGITS * wanted[1]


def test_the_slider_crank_in_all_its_orders() -> None:
    """Force along the guide and across, moment of orbital and spin, torque: cosines real, sines imaginary."""
    found = balance(load(str(SPECS / "slider_crank.yaml"), checking=False))
    force = {1: 2800.0, 2: 651.906296842273, 4: -19.1882503896056, 6: 0.635421091264556, 8: -0.0207827137050334}
    for k in range(1, 9):
        wanted = [force.get(k, 0.0), 900j if k == 1 else 0.0, 0.0]
        assert abs(amplitude(found, "force", k) - wanted).max() < DIGITS * 2800.0
    moment = {1: (40.580141897206, 60.870212845808), 3: (-1.7786621311297, -2.6679931966945),
              5: (0.065286860511057, 0.097930290766586)}  # fmt: skip
    for k in range(1, 6):
        row = row_of(found, "moment", k)
        assert row is not None and row.parts is not None
        whole, orbital = moment.get(k, (0.0, 0.0))
        assert abs(amplitude(found, "moment", k) - [0, 0, 1j * whole]).max() < DIGITS * 60.0
        for part, wanted_part in (("orbital", orbital), ("spin", whole - orbital)):
            a, phase = row.parts[part]
            assert abs(a * np.exp(1j * phase) - [0, 0, 1j * wanted_part]).max() < DIGITS * 60.0
    torque = -16.297657421057, 101.74321207365, 49.612531652781, 5.196074529575, -1.225741528153, -0.22943722928793
    for k, value in enumerate(torque, start=1):
        assert abs(amplitude(found, "torque", k) - 1j * value).max() < DIGITS * 101.0
    first = row_of(found, "force", 1)
    assert first is not None and first.with_turn == pytest.approx(1850.0, rel=DIGITS)
    assert first.against_turn == pytest.approx(950.0, rel=DIGITS)
    assert found.residual["force"].rms == pytest.approx(2130.181965585094, rel=DIGITS)


SIXES = (1, 2, 4, 6)
STARS = {  # throws; |sum exp(ikδ)| and |sum z exp(ikδ)| of k = 1, 2, 4, 6, the pitch 1, about the middle
    "twin, 180": ((0, 180), (0, 2, 2, 2), (1, 0, 0, 0)),
    "twin, 360": ((0, 0), (2, 2, 2, 2), (0, 0, 0, 0)),
    "twin, 270": ((0, 90), (1.414213562, 0, 2, 0), (0.707106781, 1, 0, 1)),
    "three": ((0, 120, 240), (0, 0, 0, 3), (1.732050808, 1.732050808, 1.732050808, 0)),
    "four, flat": ((0, 180, 180, 0), (0, 4, 4, 4), (0, 0, 0, 0)),
    "four, cross": ((0, 90, 270, 180), (0, 0, 4, 0), (3.16227766, 0, 0, 0)),
    "five": ((0, 72, 288, 216, 144), (0, 0, 0, 0), (4.74997957, 1.56131166, 4.74997957, 4.74997957)),
    "five, usual": ((0, 144, 216, 288, 72), (0, 0, 0, 0), (0.449027977, 4.97979657, 0.449027977, 0.449027977)),
    "six, mirrored": ((0, 120, 240, 240, 120, 0), (0, 0, 0, 6), (0, 0, 0, 0)),
    "six, two-stroke": ((0, 240, 120, 60, 180, 300), (0, 0, 0, 6), (1.73205081, 3, 3, 0)),
    "eight, mirrored": ((0, 90, 270, 180, 180, 270, 90, 0), (0, 0, 8, 0), (0, 0, 0, 0)),
    "twelve, mirrored": (2 * (0, 120, 240, 240, 120, 0), (0, 0, 0, 12), (0, 0, 0, 0)),
}
PITCH = 0.2
PRINTED = 2e-8  # digits of the stars


@pytest.mark.parametrize("name", STARS)
def test_what_the_star_of_the_throws_leaves(name: str) -> None:
    throws, forces, moments = STARS[name]
    middle = (len(throws) - 1) / 2.0
    found = balance_of(engine([Cylinder(throw, PITCH * (i - middle)) for i, throw in enumerate(throws)]))
    scale = 2.0 * 0.05 * (2000.0 * RPM) ** 2
    for k, force, moment, own in zip(SIXES, forces, moments, PISTON[1.0, 4.0], strict=False):
        size = scale * abs(own)
        assert abs(np.abs(amplitude(found, "force", k)) - [force * size, 0, 0]).max() < PRINTED * size
        assert abs(np.abs(amplitude(found, "moment", k)) - [0, moment * PITCH * size, 0]).max() < PRINTED * size
        for quantity, left in (("force", force), ("moment", moment)):
            row = row_of(found, quantity, k)
            assert (row.verdict if row is not None else "cancels") == ("remains" if left else "cancels")


def test_even_stars_leave_nothing_below_the_count_of_their_throws() -> None:
    """Seven and nine throws evenly: no order of the force that is no multiple of their count."""
    for count in (7, 9):
        throws = [360.0 * ((2 * i) % count) / count for i in range(count)]
        found = balance_of(engine([Cylinder(throw, 0.1 * i) for i, throw in enumerate(throws)]))
        assert all(row.verdict != "remains" for row in found.orders["force"] if row.order < count)


@pytest.mark.parametrize(("throws", "order", "force", "moment"), [
    ((0, 180, 180, 0), 2, 4457.114089848593, 0.0),
    ((0, 180, 180, 0), 4, 71.90530855042, 0.0),
    ((0, 180, 180, 0), 6, 1.305051786, 0.0),
    ((0, 120, 240, 240, 120, 0), 6, 1.957577678438, 0.0),
    ((0, 72, 288, 216, 144), 1, 0.0, 4167.148378),
    ((0, 72, 288, 216, 144), 2, 0.0, 347.94721),
    ((0, 72, 288, 216, 144), 4, 0.0, 17.07743732),
])  # fmt: skip
def test_engines_in_newtons(throws: tuple[float, ...], order: int, force: float, moment: float) -> None:
    middle = (len(throws) - 1) / 2.0
    found = balance_of(engine([Cylinder(throw, PITCH * (i - middle)) for i, throw in enumerate(throws)]))
    assert np.abs(amplitude(found, "force", order)).max() == pytest.approx(force, rel=1e-9, abs=1e-8)
    assert np.abs(amplitude(found, "moment", order)).max() == pytest.approx(moment, rel=1e-9, abs=1e-8)


def test_v_twin_on_one_throw_turns_with_the_shaft() -> None:
    """At 90 degrees order 1 is m r ω² with the turn alone; order 2 lies across the bisector."""
    found = balance_of(engine([Cylinder(0.0, bank=45.0), Cylinder(0.0, bank=-45.0)]))
    first, second = row_of(found, "force", 1), row_of(found, "force", 2)
    assert first is not None and second is not None
    assert first.with_turn == pytest.approx(4386.490844928604, rel=DIGITS) and first.against_turn == 0.0
    assert second.amplitude[0] == 0.0 and second.amplitude[1] == pytest.approx(1575.827798727024, rel=DIGITS)
    assert "rotating with the shaft" in found.summaries["force"]


def test_schlicks_engine_is_left_with_little() -> None:
    found = balance(load(str(SPECS / "schlick.yaml"), checking=False))
    for quantity, order in (("force", 1), ("force", 2), ("moment", 1)):
        row = row_of(found, quantity, order)
        assert row is not None and row.verdict == "cancels" and row.body_sum > 1000.0
    assert np.abs(amplitude(found, "force", 4)).max() == pytest.approx(50.88688241, rel=1e-9)
    assert np.abs(amplitude(found, "moment", 2)).max() == pytest.approx(4317.15684, rel=1e-9)
    assert np.abs(amplitude(found, "moment", 4)).max() == pytest.approx(31.8135909, rel=1e-8)


def test_schlicks_angles_and_masses() -> None:
    """Those that he printed the conditions for: the spec's own solution of them, at two pairs of pitches."""
    for given, (alpha, beta, ratio) in (
        ({}, (26.3657391591801, -123.921031470062, 1.60555127546399)),
        ({"zo": "2.0", "zi": "0.8"}, (29.631794312065, -125.115593917444, 1.51108924951913)),
    ):
        own = load(str(SPECS / "schlick.yaml"), overrides=given, checking=False).parameters
        assert math.degrees(own["alpha"]) == pytest.approx(alpha, rel=1e-12)
        assert math.degrees(own["beta"]) == pytest.approx(beta, rel=1e-12)
        assert own["inner"] / own["outer"] == pytest.approx(ratio, rel=1e-12)
        orders = balance(load(str(SPECS / "schlick.yaml"), overrides=given, checking=False))
        rows = [row_of(orders, quantity, order) for quantity, order in (("force", 1), ("force", 2), ("moment", 1))]
        assert [row.verdict for row in rows if row is not None] == ["cancels"] * 3


@pytest.mark.parametrize("begin", ["0", "60 deg", "1.2345", "-2"])
def test_the_largest_is_searched_between_the_angles(begin: str) -> None:
    """At the dead centre (m_crank/2 + m_rod/2 ...) adds up to 3433 1/3 N, wherever the cycle begins."""
    spec = load(str(SPECS / "slider_crank.yaml"), overrides={"phi": begin}, checking=False)
    force = balance(spec).residual["force"]
    assert force.peak == pytest.approx(10300.0 / 3.0, rel=1e-12) and abs(force.peak - 10300.0 / 3.0) <= force.error
    assert math.remainder(force.peak_angle, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-5)


DISC = """
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{disc: {{mass: 2, center: [0.01, 0, 0], inertia: [0.1, 0.1, 0.2], points: {{o: [0, 0, 0]}}}}}}
joints: {{p: {{type: pin, from: ground.O, to: disc.o, axis: [0, 0, {axis}]}}}}
drives: {{m: {{joint: p, rate: {rate}}}}}
"""


@pytest.mark.parametrize(("axis", "rate"), [(1, 100.0), (1, -100.0), (-1, 100.0), (-1, -100.0)])
def test_what_stands_still_in_the_disc_turns_with_it_whichever_way_it_turns(axis: int, rate: float) -> None:
    found = balance_of(DISC.format(axis=axis, rate=rate))
    row = row_of(found, "force", 1.0)
    assert (
        row is not None and row.with_turn == pytest.approx(2.0 * 0.01 * 100.0**2, rel=1e-12) and row.against_turn == 0.0
    )
    assert found.summaries["force"] == "only order 1 remains, rotating with the shaft"


@pytest.mark.parametrize("rate", [100.0, -100.0])
def test_the_way_of_orders_hangs_on_no_rate(rate: float) -> None:
    """Of a V engine on one throw order 1 turns with the shaft, at 90° all of it."""
    found = balance(load(str(SPECS / "v_twin.yaml"), checking=False), BalanceOptions(rate=rate))
    first = row_of(found, "force", 1.0)
    assert first is not None and first.with_turn is not None and first.with_turn > 0.0 and first.against_turn == 0.0
