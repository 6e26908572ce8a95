"""Distributed loads against closed forms and against many point forces: beams, a bar in flight, a bar that turns."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.output.tables import measure
from heuncli.results.results import Array
from heuncli.results.results_schema import REPORTS
from tests.shared.scenes import near, solved, study

BEAM = """
heun: 1
ground: {{points: {{A: [0, 0, 0], B: [{span}, 0, 0]}}}}
bodies:
  beam:
    shapes: [{{type: rod, from: [0, 0, 0], to: [{length}, 0, 0], mass: 1}}]
    points: {{a: [0, 0, 0], b: [{span}, 0, 0], tip: [{length}, 0, 0]}}
joints: {joints}
forces: {{{forces}}}
sections: {{along: {{body: beam, from: a, to: tip, count: {count}}}}}
"""
HELD = "{wall: {type: weld, from: ground.A, to: beam.a}}"
SUPPORTED = (
    "{A: {type: ball, from: ground.A, to: beam.a}, B: {type: line, from: ground.B, to: beam.b, axis: [1, 0, 0]}}"
)


def beam(forces: str, joints: str = HELD, span: float = 6.0, length: float = 6.0, count: int = 25) -> str:
    return BEAM.format(forces=forces, joints=joints, span=span, length=length, count=count)


def load(start: float, end: float, first: float, last: float) -> str:
    """Downward, N/m."""
    ends = f"from: [{start}, 0, 0], to: [{end}, 0, 0]"
    return f"{{type: distributed, on: beam, {ends}, vector: [0, {-first}, 0], to_vector: [0, {-last}, 0]}}"


def test_a_linear_load_and_a_couple_at_the_end() -> None:
    """q = 5x/4 on a span of 6 m, 20 N m at A: V = 65/6 − 5x²/8, M = −5x³/24 + 65x/6 − 20; most at x = √(52/3)."""
    couple = "end: {type: couple, on: beam.a, vector: [0, 0, 20]}"
    run = study(beam(f"q: {load(0, 6, 0, 7.5)}, {couple}", SUPPORTED))
    found = run.results.sections["along"]
    x = np.asarray(found["s"])
    near(-found["Q1"][0], 65 / 6 - 5 * x**2 / 8, 20.0, 1e-14)
    near(found["M2"][0], -5 * x**3 / 24 + 65 * x / 6 - 20, 50.0, 1e-14)
    near(run.results.joints["A"]["force"][0], [0, 65 / 6, 0], 20.0, 1e-14)
    near(run.results.forces["q"]["value"][0], 22.5, 22.5, 1e-15)


def test_the_largest_moment_lies_between_the_cuts() -> None:
    """Found where V = 0, however few cuts there are; where the load ends the moment bends."""
    words = "max sections.along.M2"
    text = beam(f"q: {load(0, 6, 0, 7.5)}, end: {{type: couple, on: beam.a, vector: [0, 0, 20]}}", SUPPORTED, count=2)
    x = np.sqrt(52 / 3)
    told = measure.format_measures(measure.parse_measures([words]), study(text), "table")
    assert float(told) == pytest.approx(-5 * x**3 / 24 + 65 * x / 6 - 20, rel=1e-13)


def test_an_overhang() -> None:
    """12 kN over 2 m to the tip at 8 m, falling from 3 to 1 kN/m: 3 and 9 kN at the supports."""
    run = solved(beam(f"snow: {load(2, 8, 3000, 1000)}", SUPPORTED, 6.0, 8.0, 33))
    near(run.joints["A"]["force"][0], [0, 3000, 0], 12e3, 1e-14)
    near(run.joints["B"]["force"][0], [0, 9000, 0], 12e3, 1e-14)
    near(run.foundation["moment"][0], [0, 0, -12e3 * 4.5], 54e3, 1e-14)
    found = run.sections["along"]
    s, side = np.asarray(found["s"]), np.array([x == "beyond" for x in found["side"]])
    u = np.maximum(s - 2, 0.0)
    V = 3000 + 9000 * ((s > 6) | ((s == 6) & side)) - (3000 * u - 1000 * u**2 / 6)
    M = 3000 * s + 9000 * np.maximum(s - 6, 0.0) - (1500 * u**2 - 1000 * u**3 / 18)
    near(-found["Q1"][0], V, 12e3, 1e-14)
    near(found["M2"][0], M, 12e3, 1e-13)


def test_a_bar_in_flight() -> None:
    """Free, uniform load over its first half: what the inertia of the rest takes, V and M vanish at both ends."""
    q, L, m = 12.0, 6.0, 1.0
    found = solved(beam(f"q: {load(0, 3, q, q)}", "{}")).sections["along"]
    x = np.asarray(found["s"])
    a, turn = -q * 3 / m, (q * 3 * 1.5) / (m * L**2 / 12)  # of the centre; about z
    u = np.minimum(x, 3.0)
    V = -q * u - m / L * ((a - turn * L / 2) * x + turn * x**2 / 2)
    M = -q * (u * x - u**2 / 2) - m / L * ((a - turn * L / 2) * x**2 / 2 + turn * x**3 / 6)
    near(-found["Q1"][0], V, 36.0, 1e-14)
    near(found["M2"][0], M, 36.0, 1e-13)
    assert abs(V[-1]) < 1e-12 and abs(M[-1]) < 1e-12


def test_its_share() -> None:
    """By cause: on a cantilever what stands beyond the cut, directly; nothing of it through motion; the sum is all."""
    forces = f"q: {load(1, 5, 3, 3)}, push: {{type: force, on: beam.tip, vector: [0, 2, 0]}}"
    block = solved(beam(forces), requested_reports=frozenset((*REPORTS, "shares"))).sections["along"]
    own, x = block["shares"]["q"], np.asarray(block["s"])
    beyond = 3 * np.clip(5 - x, 0, 4)
    near(own["force"][0, :, 1], -beyond, 12.0, 1e-14)
    near(own["direct_force"], own["force"], 12.0, 1e-14)
    near(own["direct_moment"], own["moment"], 36.0, 1e-14)
    near(sum(np.asarray(share["M2"]) for share in block["shares"].values()), block["M2"], 36.0, 1e-14)


TURNING = """
heun: 1
gravity: [1, -9.81, 2]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar:
    shapes: [{{type: cylinder, from: [0, 0, 0], to: [2, 0, 0], radius: 0.05, mass: 3}}]
    points: {{o: [0, 0, 0], e: [2, 0, 0]}}
    angular_velocity: [0.3, -2, 5]
joints: {{pivot: {{type: ball, from: ground.O, to: bar.o}}}}
forces: {{{forces}}}
sections:
  along: {{body: bar, from: o, to: e, count: 5}}
  askew: {{body: bar, at: [0.9, 0, 0], normal: [1, 0.7, -0.4]}}
analysis: {{times: [0, 0.3]}}
"""
FIRST, LAST = ("-3*cos(9*t)", "4", "2*t"), ("5", "-2 + sin(t)", "1")
START, END = np.array([0.2, -0.3, 0.1]), np.array([1.7, 0.4, 0.2])


def turning(forces: str) -> dict[str, Array]:
    """What is compared: the acceleration, the reaction, the sections."""
    found = solved(TURNING.format(forces=forces))
    run, cut = found.sections["along"], found.sections["askew"]
    return {
        "acceleration": found.bodies["bar"]["angular_acceleration"], "reaction": found.joints["pivot"]["force"],
        "moment": run["moment"], "cut": cut["moment"], "shear": run["force"],
    }  # fmt: skip


@pytest.mark.parametrize("frame", ["world", "body"])
def test_many_point_forces_come_near_it(frame: str) -> None:
    """Their error falls as the square of the number in motion and reactions, at cuts as the number."""

    def points(n: int) -> str:
        parts = []
        for k in range(n):
            x = (k + 0.5) / n
            at = (START + x * (END - START)).tolist()
            ell = float(np.linalg.norm(END - START)) / n
            vector = ", ".join(f'"{ell}*({1 - x}*({a}) + {x}*({b}))"' for a, b in zip(FIRST, LAST, strict=True))
            parts.append(f"f{k}: {{type: force, on: {{body: bar, at: {at}}}, vector: [{vector}], frame: {frame}}}")
        return ", ".join(parts)

    ends = f"from: {START.tolist()}, to: {END.tolist()}, vector: [{', '.join(FIRST)}], to_vector: [{', '.join(LAST)}]"
    exact = turning(f"q: {{type: distributed, on: bar, {ends}, frame: {frame}}}")
    counts = (40, 160)
    many = [turning(points(n)) for n in counts]
    for name, value in exact.items():
        size = float(np.abs(value).max())
        coarse, fine = (float(np.abs(own[name] - value).max()) / size for own in many)
        parted = name in ("shear", "cut", "moment")  # by the cut, which takes the nearest of them as a whole
        assert fine < (0.6 if parted else 0.07) * coarse < 0.02, name


ACROSS = "across: {type: distributed, on: beam, from: [3, -1, 0], to: [3, 2, 0], vector: [0, 0, 4]}"


def test_a_line_in_the_plane_of_a_cut() -> None:
    """The loads jump there, by 12 N and about the cut's point 12 N times 0.5 m; a single cut needs its side."""
    found = solved(beam(ACROSS, count=3)).sections["along"]
    assert found["side"][1:3] == ["before", "beyond"]
    near(found["Q2"][0][1:3], [12, 0], 12.0, 1e-14)
    near(found["T"][0][1:3], [6, 0], 12.0, 1e-14)
    text = beam(ACROSS).replace("from: a, to: tip, count: 25", "at: [3, 0, 0], normal: [1, 0, 0]")
    with pytest.raises(SpecError, match="force across lies in the plane of the cut"):
        solved(text)
    before = solved(text.replace("normal:", "side: before, normal:")).sections["along"]
    near(before["T"][0], 6.0, 12.0, 1e-14)


def test_an_end_in_the_plane_needs_no_side() -> None:
    """At its end a distributed load is nothing."""
    text = beam(f"q: {load(2, 4, 3, 3)}").replace("from: a, to: tip, count: 25", "at: [2, 0, 0], normal: [1, 0, 0]")
    near(solved(text).sections["along"]["Q1"][0], -6.0, 6.0, 1e-14)


@pytest.mark.parametrize(("spec", "code"), [
    ("{type: distributed, on: beam, from: a, to: [0, 0, 0], vector: [0, 1, 0]}", "same-point"),
    ("{type: distributed, on: beam, from: a, to: c, vector: [0, 1, 0]}", "unknown-point"),
    ("{type: distributed, on: ground, from: a, to: tip, vector: [0, 1, 0]}", "ground-cannot"),
    ("{type: distributed, on: beams, from: a, to: tip, vector: [0, 1, 0]}", "unknown-body"),
    ("{type: distributed, on: beam, from: a, to: tip, vector: [0, 1 N, 0]}", "dimension"),
    ("{type: line_load, on: beam, from: a, to: tip, vector: [0, 1, 0]}", "unknown-force-type"),
])  # fmt: skip
def test_errors(spec: str, code: str) -> None:
    with pytest.raises(SpecError) as raised:
        solved(beam(f"q: {spec}"))
    assert [problem.code for problem in raised.value.problems] == [code]


@pytest.mark.parametrize(("text", "value"), [("3 kN/m", 3e3), ("2 N/mm", 2e3), ("10 lbf/ft", 145.93902937206)])
def test_units(text: str, value: float) -> None:
    found = solved(beam(f"q: {{type: distributed, on: beam, from: a, to: [2, 0, 0], vector: [0, {text}, 0]}}"))
    near(found.forces["q"]["value"], 2 * value, value, 1e-13)
