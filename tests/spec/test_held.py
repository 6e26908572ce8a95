"""Branches that are held: the expression goes on smoothly beyond its branch; taken as they are, nothing changes."""

from __future__ import annotations

import math
import re
from array import array
from random import Random
from typing import Any

import pytest

from heuncli.kernel.choose import expressions
from heuncli.scene.expressions.curves import interpolate_points
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.programs import OPS, Expression, Pack
from heuncli.scene.expressions.scope import Scope
from tests.shared.plain_kernel import plain_module
from tests.shared.random_programs import VARIABLES, random_program

FREE, HELD, TAKEN = (expressions.HOLDING[name] for name in ("free", "held", "taken"))
KNOTS, HEIGHTS = [-1.0, 0.5, 1.0, 3.0], [2.0, -1.0, 4.0, 2.0]
TABLES = {
    "ends": interpolate_points("ends", KNOTS, HEIGHTS, "cubic", None, None),
    "goes_on": interpolate_points("goes_on", KNOTS, HEIGHTS, "linear", "hold", None),
    "turns": interpolate_points("turns", KNOTS, HEIGHTS, "linear", None, 4.0),
}
SCOPE = Scope(joints={"g": "slide", "p": "pin"}, tables=TABLES, in_time=True)


def read(text: str) -> Expression:
    return compile_expression(re.sub(r"\bx\b", "g.travel", re.sub(r"\by\b", "p.angle", text)), SCOPE)


class Held:
    """An expression's value with branches held as they were where it was taken."""

    def __init__(self, text: str, *at: float) -> None:
        self.expression = read(text)
        pack = Pack()
        self.span, self.programs = pack.add(self.expression), pack.expressions
        self.programs.hold(TAKEN)
        taken = self.programs.evaluate(*self.span, [0.0, *at])
        assert bits(taken) == bits(self.expression.value(0.0, at))

    @property
    def branches(self) -> list[float]:
        return list(self.programs.branches())

    def __call__(self, *x: float) -> float:
        self.programs.hold(HELD)
        return float(self.programs.evaluate(*self.span, [0.0, *x]))


def bits(x: float) -> str:
    return float(x).hex() if x == x else "nan"


@pytest.mark.parametrize(("text", "start", "branch", "beyond"), [
    ("sign(x)*x", 2.0, 1.0, lambda x: x),
    ("sign(x)", 0.0, 0.0, lambda x: 0.0),
    ("sign(x)*x", -2.0, -1.0, lambda x: -x),
    ("step(x)*x", 0.0, 1.0, lambda x: x),
    ("step(x)*x", -0.1, 0.0, lambda x: 0.0),
    ("abs(x)", 0.0, 1.0, lambda x: x),
    ("abs(x)**3", -1.0, -1.0, lambda x: -(x**3)),
    ("min(x, 2*x)", 0.0, 0.0, lambda x: x),
    ("min(x, 2*x)", -1.0, 1.0, lambda x: 2 * x),
    ("max(x, 2*x)", -1.0, 0.0, lambda x: x),
    ("max(x, 2*x)", 1.0, 1.0, lambda x: 2 * x),
    ("x*x if x < 1 else 1", 0.0, 1.0, lambda x: x * x),
    ("x*x if x <= 1 else 1", 1.0, 1.0, lambda x: x * x),
    ("x*x if x > 1 else 1", 1.0, 0.0, lambda x: 1.0),
    ("x*x if x >= 1 else 1", 1.0, 1.0, lambda x: x * x),
    ("x*x if x == 1 else 1", 0.0, 0.0, lambda x: 1.0),
    ("x*x if x != 1 else 1", 0.0, 1.0, lambda x: x * x),
    ("x*x if x else 1", 0.0, 0.0, lambda x: 1.0),
    ("x*x if not x else 1", 1.0, 0.0, lambda x: 1.0),
    ("table(goes_on, x)", -1.5, -1.0, lambda x: 2.0),
    ("table(goes_on, x)", -1.0, 0.0, lambda x: 2.0 - 2.0 * (x + 1.0)),
    ("table(goes_on, x)", 0.5, 1.0, lambda x: -1.0 + 10.0 * (x - 0.5)),
    ("table(goes_on, x)", 3.0, 2.0, lambda x: 4.0 - (x - 1.0)),
    ("table(goes_on, x)", 3.5, 3.0, lambda x: 2.0),
    ("table(turns, x)", 6.0, 5.0, lambda x: 4.0 - (x - 5.0)),
    ("table(turns, x)", -3.0, -1.0, lambda x: 4.0 - (x + 3.0)),
    ("table(turns, x)", 3.0, 3.0, lambda x: 2.0 - 2.0 * (x - 3.0)),
])  # fmt: skip
def test_goes_on_beyond_its_branch(text: str, start: float, branch: float, beyond: Any) -> None:
    held = Held(text, start)
    assert held.branches[0] == branch
    for x in (-7.3, -1.0, -0.1, 0.0, 0.4, 0.5, 1.0, 2.9, 3.0, 8.0):
        assert held(x) == pytest.approx(beyond(x), rel=1e-13, abs=1e-13)


def test_the_angle_goes_on_round_the_circle() -> None:
    """atan2 over the negative x axis, either way."""
    for side in (1.0, -1.0):
        held = Held("atan2(y, x)", side * math.sin(2.0), math.cos(2.0))
        for phi in (0.3, 2.0, 3.0, 3.14, 3.2, 4.0, 4.7):
            y, x = side * math.sin(phi), math.cos(phi)
            assert held(y, x) == pytest.approx(side * phi, rel=1e-13)
    assert Held("atan2(y, x)", 0.0, -1.0)(-0.0, -1.0) == math.pi
    assert Held("atan2(y, x)", -0.0, -1.0)(0.0, -1.0) == -math.pi


def test_a_cubic_goes_on_as_the_same_cubic() -> None:
    """Four points of the piece give the cubic; far beyond its knots it is still that one."""
    held, expression = Held("table(ends, x)", 0.7), read("table(ends, x)")
    assert held.branches == [1.0]
    points = [0.5, 0.65, 0.8, 0.95]

    def cubic(x: float) -> float:
        return sum(expression.value(0.0, [a]) * math.prod((x - b) / (a - b) for b in points if b != a) for a in points)

    for x in (-0.9, 0.0, 1.2, 2.5):
        assert held(x) == pytest.approx(cubic(x), rel=1e-9)
    assert held(3.5) == pytest.approx(cubic(3.5), rel=1e-9)  # that piece has no end
    assert math.isnan(Held("table(ends, x)", 3.5)(3.5))


def test_each_link_of_a_chain_has_its_own_branch() -> None:
    held = Held("5 if 0 < x <= 2 else 7", 1.0)
    assert held.expression.held_branches == ("0 < g.travel", "g.travel <= 2")
    assert held.branches == [1.0, 1.0]
    assert held(3.0) == held(-3.0) == 5.0
    assert Held("5 if 0 < x <= 2 else 7", 3.0).branches == [1.0, 0.0]


def test_no_value_but_with_its_branch() -> None:
    """Beyond x = 0 the root has none: there the branches are as they are. An operand without a value gives none."""
    held = Held("sqrt(x) if x > 0 else 0", 1.0)
    assert (held(4.0), held(-1e-9)) == (2.0, 0.0)
    assert held(4.0) == 2.0  # and is held again
    for text in ("1 if sqrt(x) >= 0 else 2", "min(sqrt(x), -1)", "sign(sqrt(x))", "table(turns, log(x))"):
        assert math.isnan(Held(text, 1.0)(-1.0))


def test_what_is_not_run_keeps_its_branch() -> None:
    held = Held("sign(x) if y > 0 else 3", 1.0, -5.0)
    assert held.expression.held_branches == ("sign(g.travel)", "p.angle > 0")
    held.programs.hold_branches([7.0, 5.0])
    held.programs.hold(TAKEN)
    held.programs.evaluate(*held.span, [0.0, -1.0, -5.0])
    assert held.branches == [7.0, 0.0]
    with pytest.raises(ValueError, match="2 branches"):
        held.programs.hold_branches([1.0])


@pytest.mark.parametrize("text", [
    "sign(t)*abs(t - 1)", "1 if t < 1 < 2*t else 0", "table(turns, t)", "min(t, 1)*x", "atan2(t, 1)*x", "x*(t > 1)",
    "x if t and not t else 1",
])  # fmt: skip
def test_branches_in_time_alone_are_not_held(text: str) -> None:
    assert read(text).held_branches == ()
    assert OPS["hold"] not in read(text).code[::2]


@pytest.mark.parametrize(("text", "held"), [
    ("1 if x > 1 and y or not t < x else 2", ("g.travel > 1", "p.angle", "t < g.travel")),
    ("min(x, 1, t)", ("min(g.travel, 1, t)",) * 2),
    ("hypot(abs( x), 1)", ("abs( g.travel)",)),
    ("(x > 1) + 2*step(-x)", ("g.travel > 1", "step(-g.travel)")),
    ("1 if step(x) and (y > 0 or y < -1) else 0", ("step(g.travel)", "p.angle > 0", "p.angle < -1")),
])  # fmt: skip
def test_branches_are_named_as_they_are_written(text: str, held: tuple[str, ...]) -> None:
    assert read(text).held_branches == held


def test_a_pack_knows_whose_branches_it_holds() -> None:
    pack = Pack()
    first, second = read("sign(x)*step(y)"), read("abs(y - x)")
    spans = [pack.add(e) for e in (first, read("t*x"), second, first)]
    assert (pack.branch_count, len(pack.expressions.branches())) == (5, 5)
    assert [(e.source, e.held_branches[k]) for e, k in pack.branches] == [
        (e.source, text) for e in (first, second, first) for text in e.held_branches
    ]
    pack.expressions.hold(TAKEN)
    for span, x in zip(spans, (1.0, 2.0, 3.0, -4.0), strict=True):
        pack.value(*span, [0.0, x, 0.5])
    assert pack.expressions.branches() == [1.0, 1.0, -1.0, -1.0, 1.0]


def test_held_branches_change_no_bits() -> None:
    """Random programs: taken and held where they were taken as without, in either form of the kernel."""
    random = Random(11)
    held_values = moved = 0
    for _ in range(1500):
        program = random_program(random)
        constants, bare = array("d", program.constants), program.numbered(OPS)
        holding, held = program.holding()
        code = holding.numbered(OPS)
        x, beyond = ([random.uniform(-3.0, 3.0) for _ in range(VARIABLES)] for _ in range(2))
        found = []
        for form in (expressions, plain_module("expressions")):
            programs = form.Expressions(code, constants, VARIABLES, len(held), tables=program.tables)
            without = form.Expressions(bare, constants, VARIABLES, tables=program.tables)
            span = (0, len(code) // 2)
            value = bits(without.evaluate(0, len(bare) // 2, x))
            for mode in (FREE, TAKEN):
                programs.hold(mode)
                assert bits(programs.evaluate(*span, x)) == value
            programs.hold(HELD)
            again, other = programs.evaluate(*span, x), programs.evaluate(*span, beyond)
            assert math.isnan(again) == (value == "nan") and (value == "nan" or again == float.fromhex(value))
            found.append([value, bits(again), bits(other), *map(bits, programs.branches())])
            held_values += value != "nan" and len(held) > 0
            moved += bits(other) != bits(without.evaluate(0, len(bare) // 2, beyond))
        assert found[0] == found[1], program
    assert held_values > 800 and moved > 100
