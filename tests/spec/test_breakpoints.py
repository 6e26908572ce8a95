"""Jumps and kinks in time, found to the last bit."""

from __future__ import annotations

import math
from random import Random

import pytest

from heuncli.base import tolerances
from heuncli.base.errors import LimitError
from heuncli.motion.integration.integrated_scene import find_one_sided_limits
from heuncli.motion.integration.methods.explicit import DOP853
from heuncli.motion.integration.methods.method import load_method_by_name
from heuncli.scene.expressions.curves import interpolate_points
from heuncli.scene.expressions.discontinuities import (
    find_discontinuities,
    find_jumps,
    find_run_discontinuities,
    instant_after_end,
    pair_adjacent_instants,
)
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.programs import Expression, TableFunction
from heuncli.scene.expressions.scope import Scope
from heuncli.study.solve.history import require_steps

TRIANGLE = interpolate_points("triangle", [0.0, 0.25, 0.5], [0.0, 1.0, 0.0], "linear", None, 0.5)
RAMP = interpolate_points("ramp", [1.0, 2.0, 4.0], [0.0, 1.0, 5.0], "linear", "hold", None)
REACH = interpolate_points("reach", [0.0, 0.25, 1.0], [0.0, 2.0, 3.0], "pchip", "hold", None)
TABLES: dict[str, TableFunction | None] = {"triangle": TRIANGLE, "ramp": RAMP, "reach": REACH}


def read(text: str) -> Expression:
    return compile_expression(text, Scope(joints={"shaft": "pin"}, tables=TABLES, in_time=True))


def after(t: float) -> float:
    return math.nextafter(t, math.inf)


def ends(text: str, last: float) -> list[float]:
    """The first instants of all pieces but the first."""
    return [t for _, t in pair_adjacent_instants(find_discontinuities(read(text), 0.0, last))]


@pytest.mark.parametrize(("text", "expected"), [
    ("t*t", []),
    ("step(t - 1)", [1.0]),
    ("abs(t - 1)", [1.0]),
    ("max(t, 1)", [1.0]),
    ("min(1, t)", [1.0]),
    ("min(t, 1)", [after(1.0)]),
    ("sign(t - 1)", [after(1.0)]),
    ("3 if t < 1 else 4", [1.0]),
    ("3 if t <= 1 else 4", [after(1.0)]),
    ("3 if 0.5 <= t < 1.5 else 4", [0.5, 1.5]),
    ("step(t - 1)*step(1.25 - t)", [1.0, after(1.25)]),
    ("3 if t > 1 and t >= 1.5 else 4", [after(1.0), 1.5]),
    ("step(t - 3)", []),
    ("step(t)", []),
    ("step(t - 2)", []),
    ("step(shaft.angle - 1)", []),
    ("step(t - 1)*shaft.angle", [1.0]),
    ("step(shaft.angle - step(t - 1))", [1.0]),
    ("abs(abs(t - 1) - 0.5)", [after(0.5), 1.0, 1.5]),
    ("atan2(t - 1, -1)", [1.0]),
    ("atan2(t - 1, 1)", []),
    ("table(triangle, t)", [0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75]),
    ("table(ramp, t)", [1.0]),
    ("table(ramp, 2*t)", [0.5, 1.0]),
    ("table(ramp, 5*t)", [0.2, 0.4, after(0.8)]),
])  # fmt: skip
def test_where_branches_change(text: str, expected: list[float]) -> None:
    assert ends(text, 2.0) == expected


@pytest.mark.parametrize("text", [
    "min(t, 1)", "min(1, t)", "max(1 - t, 0)", "max(0, 1 - t)", "abs(t - 1)", "abs(1 - t)", "sign(1 - t)",
    "step(1 - t)", "3 if t <= 1 else 4", "3 if 1 > t else 4", "min(100*t, 100)", "min(t/3, 1/3)", "table(ramp, t)",
    "table(ramp, t + 3)", "table(ramp, 3*t + 1)", "table(ramp, 2 - t)", "table(ramp, 3 - t)",
    "table(ramp, 3.7 + 0.3*t)", "table(ramp, 1.1 - 0.1*t)", "table(ramp, 3.9 + t/10)",
    "table(triangle, t/4)", "table(triangle, -t/4)",
    "min(0.7*t, 0.7)", "max(0.3 - 0.3*t, 0)", "table(reach, t)", "table(reach, 1 - t)",
])  # fmt: skip
def test_an_edge_is_no_part_of_the_piece_before_it(text: str) -> None:
    """Whichever branch an expression takes at the edge itself."""
    before, behind = next(
        p for p in pair_adjacent_instants(find_discontinuities(read(text), 0.0, 2.0)) if abs(p[1] - 1.0) < 0.1
    )
    assert before < 1.0 <= behind
    assert 1.0 - 3e-14 < before  # 3.9 + t/10 is rounded by 4e-16
    assert behind < 1.0 + 3e-14


@pytest.mark.parametrize("text", [
    "table(ramp, t + 3)", "table(ramp, 2 - t)", "table(ramp, 3.7 + 0.3*t)", "min(3*t, 3)", "max(3 - 3*t, 0)",
    "abs(1 - t)", "3*t if t <= 1 else 3",
])  # fmt: skip
def test_a_run_that_ends_at_a_break_tells_what_is_behind(text: str) -> None:
    ((before, behind, _, then),) = find_jumps(read(text), 1.0, order=1)
    assert before < 1.0
    assert then == read(text).derivatives(1.5)[1]
    assert find_jumps(read(text), 0.999, order=1) == []
    assert behind <= instant_after_end(1.0)


def test_behind_the_end_of_a_table_that_is_not_held_there_is_nothing_to_tell() -> None:
    table = interpolate_points("f", [0.0, 1.0], [0.0, 3.0], "linear", None, None)
    scope = Scope(tables={"f": table}, in_time=True)
    for text in ("table(f, t)", "table(f, 1 - t)", "asin(t)*step(1 - t)"):
        assert find_run_discontinuities(compile_expression(text, scope), 1.0) == []


@pytest.mark.parametrize(("text", "rate"), [
    ("min(t, 0)", 0.0), ("max(-t, 0)", 0.0), ("max(0, t)", 1.0), ("abs(-3*t)", 3.0), ("t if t <= 0 else 5*t", 5.0),
    ("table(ramp, 1 - t)", 0.0), ("table(ramp, 2 - t)", -1.0), ("table(ramp, 4 + t)", 0.0), ("table(ramp, 2 + t)", 2.0),
    ("table(triangle, -t)", 4.0), ("min(t*t, 0)", 0.0), ("sign(-t)*t", -1.0), ("(t <= 0)*t + 2*t", 2.0),
])  # fmt: skip
def test_derivatives_at_a_tie_are_those_of_the_branch_that_begins(text: str, rate: float) -> None:
    assert read(text).derivatives(0.0)[1] == pytest.approx(rate, abs=1e-15)


def test_each_is_the_first_instant_of_its_branch() -> None:
    expression = read("step(sin(7*t) - 0.3) + abs(cos(3*t)) + min(sin(t), 0.5)")
    found = find_discontinuities(expression, 0.0, 10.0)
    assert len(found) > 30
    for limits in pair_adjacent_instants(found):
        left, right = map(expression.derivatives, limits)
        assert abs(right[0] - left[0]) > 0.5 or abs(right[1] - left[1]) > 0.1


def test_many_and_narrow_ones_are_found() -> None:
    assert len(ends("step(sin(1000*t))", 1.0)) == 318
    narrow = ends("step(sin(2*pi*t) - 1 + 1e-10)", 3.0)
    assert len(narrow) == 6
    width = math.acos(1.0 - 1e-10) / math.pi
    assert [b - a for a, b in zip(narrow[::2], narrow[1::2], strict=True)] == pytest.approx([width] * 3, rel=1e-4)
    assert ends("step(t - 50)*step(50.00001 - t)", 100.0) == [50.0, after(50.00001)]
    assert find_discontinuities(read("abs((t - 1)**2)"), 0.0, 2.0) == []  # touches zero from above


def test_a_piece_that_is_no_number_is_a_branch_too() -> None:
    found = find_discontinuities(read("step(sqrt(t - 1) - 0.5)"), 0.0, 2.0)
    assert found == [1.0, 1.25]


@pytest.mark.heavy
def test_without_end_is_refused() -> None:
    with pytest.raises(LimitError) as caught:
        find_discontinuities(read("step(sin(1e7*t))"), 0.0, 1.0)
    assert caught.value.problems[0].code == "too-many-jumps"


def test_nothing_is_too_narrow_to_be_found() -> None:
    """Pulses anywhere in long runs, down to two doubles; knots of a table; single instants."""
    random = Random(31)
    for _ in range(60):
        begin = random.uniform(0.0, 100.0)
        end = max(begin + 10.0 ** random.uniform(-17.0, 0.0), after(after(begin)))
        found = find_discontinuities(read(f"1000 if {begin!r} < t < {end!r} else 0"), 0.0, 200.0)
        assert {after(begin), end} <= set(found)
        assert all(begin <= t <= after(begin) or end - t < 1e-13 for t in found)
    assert ends("1 if t == 0.7 else 0", 2.0) == [after(0.7)]
    assert ends("1 if (t - 0.3)**2 > 0 else 0", 2.0) == [after(0.3)]
    thin = interpolate_points(
        "thin", [0.0, 0.5, 0.5000001, 0.5000002, 3.0], [0.0, 0.0, 1.0, 0.0, 0.0], "linear", None, None
    )
    scope = Scope(tables={"thin": thin}, in_time=True)
    for text, stretch in (("table(thin, t)", 1.0), ("table(thin, t/50)", 50.0)):
        instants = find_discontinuities(compile_expression(text, scope), 0.0, 2.0 * stretch)
        found = [t for _, t in pair_adjacent_instants(instants)]
        assert found == pytest.approx([x * stretch for x in thin.x[1:-1]], rel=1e-15)


@pytest.mark.heavy
def test_crests_between_the_points_of_a_grid_are_found() -> None:
    """sin² > 0.9999 twice in each half turn: 1910 of them in two seconds."""
    found = ends("1 if sin(3000*t)**2 > 0.9999 else 0", 2.0)
    aside = math.acos(math.sqrt(0.9999))
    crests = [(k + 0.5) * math.pi for k in range(1910)]
    expected = [(crest + side) / 3000.0 for crest in crests for side in (-aside, aside)]
    assert found == pytest.approx(expected, abs=2e-15)  # 3000 t is rounded by 9e-13, t by 4e-16


@pytest.mark.parametrize("text", ["max(t, t)", "abs(sin(t)**2 + cos(t)**2 - 0.5)", "step(t*t - 2*t + 1)"])
def test_what_cannot_be_decided_is_seen_to_stay(text: str) -> None:
    """A margin that is zero, or touches it."""
    assert find_discontinuities(read(text), 0.0, 2.0) == []


@pytest.mark.heavy
@pytest.mark.parametrize("outside", ["hold", None])
def test_the_points_of_a_table_of_the_time_are_what_a_search_finds(outside: str | None) -> None:
    """To the last bit, also of many points between neighbouring instants of the search's grid, and of the ends."""
    random = Random(3)
    x = sorted({0.5, *(random.uniform(0.5, 1.5) for _ in range(3_000)), 1.5, after(1.5)})
    table = interpolate_points("f", x, [0.0] * len(x), "linear", outside, None)
    scope = Scope(tables={"f": table}, in_time=True)
    for t0, t1 in ((0.0, 2.0), (0.75, x[2_000]), (x[10], after(1.5))):
        known, found = (
            find_discontinuities(compile_expression(f"table(f, {text})", scope), t0, t1) for text in ("t", "1*t")
        )
        assert known == found
        assert len(known) > 1_000


def test_limits_of_many_jumps_are_those_of_each() -> None:
    """With neighbouring doubles among them, up to four in a row, and none at all."""
    random = Random(4)
    for count in (0, 1, 2, 50):
        instants: list[float] = []
        for _ in range(count):
            instants.append(random.choice((0.0, random.random())))
            for _ in range(random.choice((0, 0, 1, 3))):
                instants.append(after(instants[-1]))
        ascending = sorted(set(instants))
        before, behind = find_one_sided_limits(ascending)
        assert list(zip(before.tolist(), behind.tolist(), strict=True)) == pair_adjacent_instants(ascending)


@pytest.mark.parametrize("text", ["table(f, t)", "table(f, 1e9*t)", "table(f, -t) + t"])
def test_points_without_end_are_refused_before_any_is_looked_for(text: str) -> None:
    """A table that repeats itself a billion times in the run: nobody waits until all its points are found."""
    table = interpolate_points("f", [0.0, 5e-10, 1e-9], [0.0, 1.0, 0.0], "linear", None, 1e-9)
    expression = compile_expression(text, Scope(tables={"f": table}, in_time=True))
    with pytest.raises(LimitError) as caught:
        find_discontinuities(expression, 0.0, 1.0)
    (problem,) = caught.value.problems
    assert problem.code == "too-many-jumps"
    assert "points of its table between 0 and 1 s" in problem.message


def test_a_run_takes_a_step_to_a_segment_at_least() -> None:
    require_steps(tolerances.MOST_STEPS, DOP853)
    foreign = load_method_by_name("SciPy-LSODA")
    for segments, method in ((tolerances.MOST_STEPS + 1, DOP853), (tolerances.MOST_FOREIGN + 1, foreign)):
        with pytest.raises(LimitError) as caught:
            require_steps(segments, method)
        assert caught.value.problems[0].code == "step-limit"
