"""Measured curves as expectations: a bar turned at a steady rate, whose forces are known at every instant."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.shared.command import Heun

W, M, L = 3.0, 2.0, 0.5  # rate, mass, distance of the centre from the pivot
SPEC = f"""\
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{bar: {{mass: {M}, center: [{L}, 0, 0], inertia: [0, 0.2, 0.2], points: {{a: [0, 0, 0]}}}}}}
joints: {{pivot: {{type: pin, from: ground.O, to: bar.a, axis: [0, 0, 1]}}}}
drives: {{motor: {{joint: pivot, angle: {W}*t}}}}
analysis: {{duration: 1, samples: 4}}
expect:
  - {{of: joints.pivot.force.x, curve: bench.csv, EXTRA}}
"""
TIMES = [0.037 * k for k in range(20)]


def force(t: float) -> float:
    """The pivot carries the mass round: -M W² L cos(W t) along x."""
    return -M * W**2 * L * math.cos(W * t)


@pytest.fixture
def check(heun: Heun, folder: Path) -> Callable[..., tuple[int, str, str]]:
    """Check the bar against rows of a table."""

    def checked(rows: list[tuple[float, float]] | str, extra: str) -> tuple[int, str, str]:
        text = rows if isinstance(rows, str) else "t,F\n" + "".join(f"{x!r},{y!r}\n" for x, y in rows)
        (folder / "bench.csv").write_text(text)
        (folder / "bar.yaml").write_text(SPEC.replace("EXTRA", extra))
        done = heun("check", "bar.yaml", "--format", "json")
        return done.returncode, done.stdout, done.stderr

    return checked


def test_the_run_is_followed_at_the_table_s_own_instants(check: Callable[..., tuple[int, str, str]]) -> None:
    """None of them is a sample of the output."""
    assert check([(t, force(t)) for t in TIMES], "abs: 1e-9")[0] == 0


def test_columns_have_names_and_units(check: Callable[..., tuple[int, str, str]]) -> None:
    rows = "time [ms];Fx\n".replace(";", ",") + "".join(f"{1e3 * t!r},{1e-3 * force(t)!r}\n" for t in TIMES)
    assert check(rows, "x: 'time [ms]', y: Fx, x_unit: ms, y_unit: kN, abs: 1e-9")[0] == 0


def test_over_an_angle_the_instants_are_those_of_the_angle(check: Callable[..., tuple[int, str, str]]) -> None:
    rows = [(math.degrees(W * t), force(t)) for t in TIMES]
    assert check(rows, "x: coordinates.pivot.angle, x_unit: deg, abs: 1e-9")[0] == 0


def test_an_angle_that_the_run_never_has_fails_by_its_line(check: Callable[..., tuple[int, str, str]]) -> None:
    rows = [(math.degrees(W * t), force(t)) for t in [*TIMES, 1.2]]
    code, told, _ = check(rows, "x: coordinates.pivot.angle, x_unit: deg, abs: 1e-9")
    assert code == 1
    assert "never reaches 3.6 (bench.csv:22)" in told


def test_the_worst_point_is_told_with_its_line_and_by_how_much(check: Callable[..., tuple[int, str, str]]) -> None:
    rows = [(t, force(t) + (0.5 if k == 7 else 0.1 if k == 3 else 0.0)) for k, t in enumerate(TIMES)]
    code, told, _ = check(rows, "abs: 0.05")
    (case,) = json.loads(told)["cases"]
    assert code == 1
    assert (case["curve_line"], case["outside"], case["points"]) == (9, 2, 20)
    assert case["at"] == pytest.approx(TIMES[7])
    assert case["expected"] - case["found"] == pytest.approx(0.5, abs=1e-9)


@pytest.mark.parametrize(("wrong", "code"), [(0, 0), (1, 0), (2, 1)])
def test_within_lets_so_many_lie_outside(check: Callable[..., tuple[int, str, str]], wrong: int, code: int) -> None:
    rows = [(t, force(t) + (0.5 if k < wrong else 0.0)) for k, t in enumerate(TIMES)]
    assert check(rows, "abs: 0.05, within: 0.95")[0] == code


@pytest.mark.parametrize(
    ("rows", "extra", "place", "told"),
    [
        ("t,F\n0.1,1\n", "abs: 1", "bench.csv:2:1", "only one point"),
        ("t,F\n", "abs: 1", "bench.csv", ""),
        ("t,F\n0.1,1\n0.1,2\n", "abs: 1", "bench.csv:3:1", "x must increase"),
        ("t,F\n0.2,1\n0.1,2\n", "abs: 1", "bench.csv:3:1", "x must increase"),
        ("t,F\n0.1,1\n0.2,nan\n", "abs: 1", "bench.csv:3", ""),
        ("t,F\n0.1,1\n0.2,two\n", "abs: 1", "bench.csv:3", ""),
        ("t,F\n0.1,1\n2.5,2\n", "abs: 1", "bench.csv:3:1", "outside the run"),
        ("t,F\n0.1,1\n0.2,2\n", "y: Fy, abs: 1", "bar.yaml:8", "F"),
        ("t,F\n0.1,1\n0.2,2\n", "y_unit: m, abs: 1", "expect.0.y_unit", "expected"),
        ("t,F\n0.1,1\n0.2,2\n", "x_unit: kN, abs: 1", "expect.0.x_unit", "expected"),
        ("t,F\n0.1,1\n0.2,2\n", "is: 3, abs: 1", "expect.0", "'is' given together with 'curve'"),
        ("t,F\n0.1,1\n0.2,2\n", "within: 0, abs: 1", "expect.0.within", "must be above 0"),
    ],
)
def test_what_is_wrong_is_told_by_its_line(
    check: Callable[..., tuple[int, str, str]], rows: str, extra: str, place: str, told: str
) -> None:
    code, _, said = check(rows, extra)
    assert code == 2
    assert place in said
    assert told in said


def test_a_file_that_is_not_there(heun: Heun, folder: Path) -> None:
    (folder / "bar.yaml").write_text(SPEC.replace("EXTRA", "abs: 1"))
    done = heun("validate", "bar.yaml")
    assert (done.returncode, "bar.yaml:8:" in done.stderr) == (2, True)
