"""Enclosures: no value, rate or second derivative is outside, bounds come down with the stretch, doubts are told."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from array import array
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest

from heuncli.kernel.choose import enclosure, jets
from heuncli.kernel.form import KERNEL
from heuncli.scene.expressions.curves import interpolate_points
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.programs import Expression, Pack
from heuncli.scene.expressions.scope import Scope
from tests.shared.random_programs import (
    HELD,
    TAKEN,
    VARIABLES,
    programs_of,
    random_program,
    some_stretch,
)

PROGRAMS = 1000 if KERNEL == "compiled" else 60
TIME, NONE, ANY = (1.0, 1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0), (-math.inf, math.inf)
KNOTS = [-9.0, -1.0, 0.5, 1.0, 2.0, 9.0]
TABLES = {
    "ramp": interpolate_points("ramp", [-9.0, 2.0, 9.0], [0.0, 1.0, 5.0], "linear", "hold", None),
    "ends": interpolate_points("ends", KNOTS, [2.0, 0.0, -1.0, 4.0, 4.0, 2.0], "linear", None, None),
    "curve": interpolate_points("curve", KNOTS, [2.0, 0.0, -1.0, 4.0, 4.0, 2.0], "cubic", "hold", None),
    "gentle": interpolate_points("gentle", KNOTS, [2.0, 0.0, -1.0, 4.0, 4.0, 2.0], "pchip", None, None),
    "turns": interpolate_points("turns", [-1.0, 0.5, 1.0, 3.0], [2.0, -1.0, 4.0, 2.0], "linear", None, 4.0),
    "round": interpolate_points("round", [-1.0, 0.5, 1.0, 3.0], [2.0, -1.0, 4.0, 2.0], "cubic", None, 4.0),
}
ONE = ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs", "step", "sign")
TWO = ("min({}, {})", "max({}, {})", "hypot({}, {})", "atan2({}, {})")


def read(text: str) -> Expression:
    return compile_expression(text, Scope(joints={"g": "slide", "p": "pin"}, tables=TABLES, in_time=True))


def instants(random: Random, begin: float, end: float, count: int) -> list[float]:
    within = (begin + (end - begin) * random.random() for _ in range(count - 2))
    return [begin, end, *(min(max(t, begin), end) for t in within)]


def test_no_value_rate_or_second_derivative_of_any_program_is_outside() -> None:
    """Random programs in time on random stretches, to the last bit."""
    random = Random(21)
    seen = bounded = 0
    for _ in range(PROGRAMS):
        program = random_program(random).in_time()
        programs, span = programs_of(program), (0, len(program.code))
        for _ in range(3):
            begin, end = some_stretch(random)
            found = enclosure.find_span(programs, *span, [(begin, end, *TIME)] * VARIABLES)
            for t in instants(random, begin, end, 10):
                value = programs.evaluate(*span, [t] * VARIABLES)
                if math.isnan(value):
                    continue
                bounds = found
                if jets.find_derivatives(programs, *span, t)[0] != value:  # of the branch that begins there
                    behind = (begin, max(end, math.nextafter(t, math.inf)), *TIME)
                    bounds = enclosure.find_span(programs, *span, [behind] * VARIABLES)
                for low, high, x in zip(
                    bounds[::2], bounds[1::2], jets.find_derivatives(programs, *span, t), strict=True
                ):
                    assert not math.isfinite(x) or low <= x <= high, (program, begin, end, t)
                    seen += math.isfinite(x)
                    bounded += math.isfinite(x) and high - low < math.inf
    assert seen > 40 * PROGRAMS and bounded > 0.8 * seen


def test_held_values_are_inside_and_changes_of_branch_in_doubt() -> None:
    """Random programs with every branch held as it was at the beginning; t and two coordinates move."""
    random = Random(22)
    clear = changed = checked = 0
    for _ in range(PROGRAMS):
        program, held = random_program(random).holding()
        programs, span = programs_of(program, len(held)), (0, len(program.code))
        begin, end = some_stretch(random, -2.0)
        slopes = [(0.0, 1.0), *((random.uniform(-3, 3), random.choice((0.0, random.uniform(-2, 2)))) for _ in "xy")]

        def at(t: float, slopes: Any = slopes) -> list[float]:
            return [a + b * t for a, b in slopes]

        programs.hold(TAKEN)
        programs.evaluate(*span, at(begin))
        branches = programs.branches()
        ends = zip(at(begin), at(end), slopes, strict=True)
        ranges = [(min(x, y), max(x, y), slope, slope, 0.0, 0.0) for x, y, (_, slope) in ends]
        programs.hold(HELD)
        low, high = enclosure.find_span(programs, *span, ranges)[:2]
        doubts = programs.take_doubts()
        assert programs.take_doubts() == []
        clear += not doubts
        for t in instants(random, begin, end, 10):
            programs.hold_branches(branches)
            programs.hold(HELD)
            value = programs.evaluate(*span, at(t))
            programs.hold(TAKEN)
            free = programs.evaluate(*span, at(t))
            other = [k for k, (a, b) in enumerate(zip(branches, programs.branches(), strict=True)) if a != b]
            if math.isnan(free):
                continue
            # the angle jumps behind the origin only, and what is not run at the beginning has no branch there
            reached = [k for k in other if held[k] != "atan2"]
            assert not reached or doubts, (program, t)
            changed += bool(reached)
            if math.isfinite(value) and not (value == free and (other or math.isnan(low))):  # it has none of its own
                assert low <= value <= high, (program, begin, end, t)
                checked += 1
    assert clear > 0.4 * PROGRAMS and checked > 4 * PROGRAMS
    assert changed > 0.1 * PROGRAMS or KERNEL == "pure"


def doubts(text: str, held: float, *ranges: tuple[float, float], rate: tuple[float, float] = (-1.0, 1.0)) -> list[int]:
    """The doubts of an expression whose branches are all held as given, over ranges of its coordinates."""
    pack, expression = Pack(), read(text)
    span = pack.add(expression)
    pack.expressions.hold_branches([held] * pack.branch_count)
    pack.expressions.hold(HELD)
    enclosure.find_span(pack.expressions, *span, [(0.0, 1.0, *TIME), *((*r, *rate, *ANY) for r in ranges)])
    return list(pack.expressions.take_doubts())


BEYOND = math.nextafter(0.0, -1.0)


@pytest.mark.parametrize(("text", "held", "surely", "perhaps"), [
    ("g.travel >= 0", 1.0, (0.0, 3.0), (BEYOND, 3.0)),
    ("g.travel > 0", 0.0, (-3.0, 0.0), (-3.0, -BEYOND)),
    ("g.travel < 0.1", 1.0, (-3.0, 0.09), (-3.0, 0.1)),
    ("g.travel == 2", 0.0, (-3.0, 1.9), (-3.0, 2.0)),
    ("g.travel == 2", 1.0, (2.0, 2.0), (2.0, 2.1)),
    ("g.travel != 2", 1.0, (2.1, 3.0), (1.9, 3.0)),
    ("g.travel - 0.1 >= 0", 1.0, (0.1, 3.0), (0.09999999999999999, 3.0)),
    ("3*g.travel >= 3", 1.0, (1.0, 3.0), (0.9999999999999999, 3.0)),
    ("g.travel**2 - 9 <= 0", 1.0, (-3.0, 2.0), (-3.0, 3.0000000000000004)),
    ("sqrt(g.travel) >= 3", 1.0, (9.0, 12.0), (8.999999999999998, 12.0)),
    ("g.travel/3 >= 1", 1.0, (3.0, 12.0), (2.9999999999999996, 12.0)),
    ("sign(g.travel)", 0.0, (0.0, 0.0), (0.0, 1e-9)),
    ("sign(g.travel)", 1.0, (1e-9, 5.0), (0.0, 5.0)),
    ("sign(g.travel)", -1.0, (-5.0, BEYOND), (-5.0, 0.0)),
    ("step(g.travel)", 1.0, (0.0, 5.0), (BEYOND, 5.0)),
    ("step(g.travel)", 0.0, (-5.0, BEYOND), (-5.0, 0.0)),
    ("abs(g.travel)", 1.0, (0.0, 5.0), (BEYOND, 5.0)),
    ("abs(g.travel)", -1.0, (-5.0, BEYOND), (-5.0, 0.0)),
    ("min(g.travel, 1)", 0.0, (-5.0, 1.0), (-5.0, 1.1)),
    ("min(g.travel, 1)", 1.0, (1.1, 5.0), (1.0, 5.0)),
    ("max(1, g.travel)", 0.0, (-5.0, 1.0), (-5.0, 1.1)),
    ("max(1, g.travel)", 1.0, (1.1, 5.0), (1.0, 5.0)),
    ("table(ends, g.travel)", 1.0, (-1.0, 0.4), (-1.0, 0.5)),
    ("table(ends, g.travel)", 4.0, (2.0, 9.0), (2.0, 9.1)),
    ("table(ramp, g.travel)", 2.0, (9.1, 12.0), (9.0, 12.0)),
    ("table(turns, g.travel)", 3.0, (3.0, 4.4), (3.0, 4.5)),
    ("atan2(g.travel, -1)", 1.0, (0.0, 2.0), (BEYOND, 2.0)),
    ("atan2(g.travel, -1)", 0.0, (-2.0, BEYOND), (-2.0, 0.0)),
    ("atan2(-1*g.travel, -1)", 0.0, (0.0, 0.0), (-1.0, 0.0)),
])  # fmt: skip
def test_rounding_makes_no_doubt(
    text: str, held: float, surely: tuple[float, float], perhaps: tuple[float, float]
) -> None:
    """A branch is in doubt where it may change, and not an ulp before."""
    assert doubts(text, held, surely) == []
    assert doubts(text, held, perhaps) == [0]


def test_what_does_not_jump_is_not_in_doubt() -> None:
    """On the right of the origin the angle goes through 0 smoothly."""
    assert doubts("atan2(g.travel, p.angle)", 1.0, (-1.0, 1.0), (0.1, 2.0)) == []
    assert doubts("atan2(g.travel, p.angle)", 1.0, (-1.0, 1.0), (-0.1, 2.0)) == [0]


def test_a_branch_that_is_not_run_is_not_in_doubt() -> None:
    assert doubts("sign(p.angle) if g.travel > 0 else 3", 0.0, (-1.0, 1.0), (-2.0, 1.0)) == [1]
    assert doubts("sign(p.angle) if g.travel > 0 else 3", 1.0, (-1.0, 1.0), (2.0, 3.0)) == [0]


def some_text(random: Random, deep: int) -> str:
    """A random expression of time."""
    if deep == 0 or random.random() < 0.1:
        return random.choice(["t", "t", f"{random.uniform(-2, 2):.3f}"])
    a, b = (some_text(random, deep - 1) for _ in range(2))
    kind = random.random()
    if kind < 0.5:
        return f"({a} {random.choice('+-*/')} {b})"
    if kind < 0.6:
        return random.choice([f"({a})**{random.randint(-2, 5)}", f"abs({a})**1.5"])
    if kind < 0.7:
        return f"({a} if {b} {random.choice(['<', '>=', '!='])} 0.3 < 1 else {b})"
    if kind < 0.75:
        return random.choice(TWO).format(a, b)
    if kind < 0.8:
        return f"table({random.choice([*TABLES])}, {a})"
    return f"{random.choice(ONE)}({a})"


def test_no_value_is_outside_the_closer_bounds() -> None:
    """What people can write, with tables as they are made: f and f' at the middle count, too."""
    random, looked = Random(23), 0
    for _ in range(PROGRAMS):
        try:
            expression = read(some_text(random, 4))
        except Exception:
            continue  # not computable wherever it is
        if expression.constant is not None:
            continue
        stretches = [some_stretch(random) for _ in range(6)]
        least, largest = expression.bounds(*zip(*stretches, strict=True))
        for (begin, end), low, high in zip(stretches, least, largest, strict=True):
            values = np.array(expression.sample(np.linspace(begin, end, 41).tolist()))
            values = values[np.isfinite(values)]
            assert np.all((low <= values) & (values <= high)), f"{expression.source} on [{begin}, {end}]"
            looked += len(values)
    assert looked > 50 * PROGRAMS


SMOOTH = ["t**3*(10 - 15*t + 6*t**2)", "t*t - 2*t", "sin(t)/(1 + t**2)", "exp(-(t - 1)**2)*sqrt(t)", "hypot(t, cos(t))",
          "atan2(sin(t), t**1.5)", "log(t)*tanh(t - 2)", "table(curve, t)*t", "asin(t/3)/t"]  # fmt: skip


@pytest.mark.parametrize("text", SMOOTH)
def test_bounds_come_down_with_the_stretch(text: str) -> None:
    """The natural ones linearly, the closer ones by the square at least."""
    expression = read(text)
    natural, closer, rounding = [], [], 1e-14 * abs(expression.value(1.2))
    for width in (1e-2, 1e-3, 1e-4):
        low, high = enclosure.find_span(expression.pack.expressions, 0, expression.count, [(1.2, 1.2 + width, *TIME)])[
            :2
        ]
        least, largest = expression.bounds([1.2], [1.2 + width])
        values = np.array(expression.sample(np.linspace(1.2, 1.2 + width, 101).tolist()))
        natural.append(high - low)
        closer.append(largest[0] - least[0] - float(np.ptp(values)))
    assert natural[1] <= 0.15 * natural[0] and natural[2] <= 0.15 * natural[1]
    assert closer[1] <= 0.015 * closer[0] + rounding and closer[2] <= 0.015 * closer[1] + rounding


@pytest.mark.parametrize("name", TABLES)
def test_tables_lie_between_their_least_and_largest_value(name: str) -> None:
    """Over one piece, many, and round the turn; the bounds are those of 20,000 samples, and the rounding of a cubic.

    Its terms are 1540 together at most.
    """
    random, expression = Random(24), read(f"table({name}, t)")
    for _ in range(40):
        begin, end = some_stretch(random)
        found = enclosure.find_span(expression.pack.expressions, 0, expression.count, [(begin, end, *TIME)])
        values = np.array(expression.sample(np.linspace(begin, end, 20_001 if KERNEL == "compiled" else 501).tolist()))
        slack = 5 * 2.3e-16 * 1540 + (1e-6 if KERNEL == "compiled" else 1e-2) * (end - begin)
        assert found[0] == pytest.approx(values.min(), abs=slack) and found[0] <= values.min()
        assert found[1] == pytest.approx(values.max(), abs=slack) and found[1] >= values.max()


def test_beyond_its_ends_a_table_stands_still_or_has_no_value() -> None:
    held, refused = read("table(ramp, t)"), read("table(ends, t)")
    for expression, found in ((held, (5.0, 5.0, *NONE)), (refused, (math.nan,) * 6)):
        given = enclosure.find_span(expression.pack.expressions, 0, expression.count, [(9.5, 11.0, *TIME)])
        assert given == pytest.approx(found, rel=1e-15, nan_ok=True)


@pytest.mark.parametrize(("text", "low", "high"), [
    ("sqrt(t)", 0.0, 2.0), ("log(t)", -math.inf, math.log(4.0)), ("asin(t)", -math.pi / 2, math.pi / 2),
    ("acos(t)", 0.0, math.pi), ("t**0.5", 0.0, 2.0), ("t**2", 0.0, 16.0), ("t**-2", 1 / 16, math.inf),
    ("(t + 1)/(t + 1)", 0.0, math.inf), ("1/t", -math.inf, math.inf), ("sin(pi*t)", -1.0, 1.0), ("cos(t)", -1.0, 1.0),
    ("step(t)", 0.0, 1.0), ("sign(t)", -1.0, 1.0), ("abs(t)", 0.0, 4.0), ("min(t, 1)", -1.0, 1.0),
    ("2 if t < 1 else sqrt(t)", 0.0, 2.0), ("hypot(t, 0)", 0.0, 4.0), ("(t - t)*exp(1000*t)", -math.inf, math.inf),
])  # fmt: skip
def test_functions_are_taken_where_they_have_values(text: str, low: float, high: float) -> None:
    expression = read(text)
    found = enclosure.find_span(expression.pack.expressions, 0, expression.count, [(-1.0, 4.0, *TIME)])
    assert found[0] == pytest.approx(low, rel=3e-15) and found[1] == pytest.approx(high, rel=3e-15)


@pytest.mark.parametrize("text", ["sqrt(t)", "log(t)", "asin(t)", "acos(t - 2)", "t**0.5", "(0*t)**-1", "1/(0*t)"])
def test_what_has_no_value_at_all_has_no_bounds(text: str) -> None:
    expression = read(text)
    found = enclosure.find_span(expression.pack.expressions, 0, expression.count, [(-4.0, -2.0, *TIME)])
    assert all(map(math.isnan, found))


@pytest.mark.parametrize(("text", "rate", "second"), [
    ("t if t < 1 else 2", ANY, ANY), ("abs(t - 1)", (-1.0, 1.0), ANY), ("max(t, 1)", (0.0, 1.0), ANY),
    ("table(ramp, t + 1)", (1 / 11, 4 / 7), ANY), ("sign(t - 1)", ANY, ANY), ("atan2(t - 1, -1)", ANY, ANY),
    ("3 - t", (-1.0, -1.0), (0.0, 0.0)), ("sqrt(t)", (0.5 / math.sqrt(2.0), math.inf), ANY),
])  # fmt: skip
def test_derivatives_are_unknown_where_there_may_be_a_jump_between(text: str, rate: Any, second: Any) -> None:
    """Of a kink the rate is known: it is one or the other."""
    expression = read(text)
    found = enclosure.find_span(expression.pack.expressions, 0, expression.count, [(0.0, 2.0, *TIME)])
    assert found[2:4] == pytest.approx(rate, rel=3e-15)
    if text != "sqrt(t)":
        assert found[4:] == second


SAME = """
import json, sys
from random import Random
from heuncli.kernel.choose import enclosure
from tests.shared.random_programs import HELD, VARIABLES, programs_of, random_program, some_stretch
random, found = Random(25), []
for _ in range(400):
    program, held = random_program(random).holding()
    programs, span = programs_of(program, len(held)), (0, len(program.code))
    programs.hold_branches([random.choice((-1.0, 0.0, 1.0, 2.0)) for _ in held])
    begin, end = some_stretch(random)
    middle = begin + 0.5*(end - begin)
    ranges = [(a + begin, a + end, 1.0, 1.0, 0.0, 0.0) for a in range(VARIABLES)]
    middles = [(a + middle, a + middle, 1.0, 1.0, 0.0, 0.0) for a in range(VARIABLES)]
    for mode in (0, HELD):
        programs.hold(mode)
        ends = enclosure.find_close_span(programs, *span, ranges, middles)
        found.append([*(x.hex() if x == x else "nan" for x in ends), programs.take_doubts()])
print(json.dumps(found))
"""


@pytest.mark.skipif(KERNEL == "pure", reason="there is no compiled kernel to compare with")
def test_compiled_and_plain_give_the_same_bits() -> None:
    found = []
    for kernel in ("compiled", "pure"):
        environment = {**os.environ, "HEUN_KERNEL": kernel, "PYTHONPATH": str(Path(__file__).parents[2])}
        command = [sys.executable, "-c", SAME]
        done = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
        found.append(json.loads(done.stdout))
    assert found[0] == found[1]
    assert sum(ends[0] != "nan" for ends in found[0]) > 400 and any(ends[-1] for ends in found[0])


def test_the_doors_refuse_what_does_not_fit() -> None:
    programs = read("2*t").pack.expressions
    with pytest.raises(ValueError, match="no program"):
        enclosure.find_span(programs, 0, 4, [(0.0, 1.0, *TIME)])
    with pytest.raises(ValueError, match="1 variables, not 2"):
        enclosure.find_span(programs, 0, 3, [(0.0, 1.0, *TIME)] * 2)
    with pytest.raises(ValueError, match="as many"):
        enclosure.find_bounds(programs, 0, 3, *(array("d", [0.0] * n) for n in (2, 2, 2, 1)))
