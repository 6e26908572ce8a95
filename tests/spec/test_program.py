"""The evaluator: values against Python's arithmetic, derivatives against complex steps, one form against the other."""

from __future__ import annotations

import cmath
import math
from array import array
from random import Random
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from heuncli.kernel.choose import expressions, jets
from heuncli.scene.expressions.discontinuities import find_discontinuities
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.programs import Expression, Pack
from heuncli.scene.expressions.scope import Scope
from tests.shared.evaluators import COMPILED, PLAIN, answers, bits
from tests.shared.plain_kernel import plain_module
from tests.shared.random_programs import VARIABLES, random_program

IN_TIME = Scope(parameters={"L": 1.5}, joints={"shaft": "pin", "guide": "slide"}, in_time=True)


def read(text: str) -> Expression:
    return compile_expression(text, IN_TIME)


def step(x: float) -> float:
    return 1.0 if x >= 0.0 else 0.0


def sign(x: float) -> float:
    return float((x > 0.0) - (x < 0.0))


ANALYTIC = ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt")
PYTHON: dict[str, Any] = {
    **{name: getattr(math, name) for name in (*ANALYTIC, "atan2", "hypot", "pi")},
    "abs": abs, "min": min, "max": max, "step": step, "sign": sign, "L": 1.5,
}  # fmt: skip

EXAMPLES = 250

NUMBERS = st.sampled_from(["0.0", "1.0", "2.0", "0.5", "3.25", "1e-3", "7.0", "pi", "L", "t", "t", "t"])


def calls(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    one = st.sampled_from([*ANALYTIC, "abs", "sign", "step"])
    two = st.sampled_from(["atan2", "min", "max", "hypot"])
    return st.one_of(
        st.builds("({} {} {})".format, inner, st.sampled_from(["+", "-", "*", "/"]), inner),
        st.builds("({} ** {})".format, inner, st.sampled_from(["2", "3", "-1", "-2"])),
        st.builds("(abs({}) ** {})".format, inner, st.sampled_from(["0.5", "2.5", "-1.5"])),
        st.builds("(-{})".format, inner),
        st.builds("{}({})".format, one, inner),
        st.builds("{}({}, {})".format, two, inner, inner),
        st.builds("({} if {} < {} else {})".format, inner, inner, inner, inner),
        st.builds("({} if {} >= {} > {} else {})".format, inner, NUMBERS, inner, NUMBERS, inner),
        st.builds("(1 if {} > 1 and not {} < 2 or {} == 0 else 2)".format, inner, inner, inner),
    )


EXPRESSIONS = st.recursive(NUMBERS, calls, max_leaves=12)


def by_python(text: str, t: float) -> float | None:
    """What Python makes of the same text; None where it raises or overflows."""
    try:
        value = eval(text, {"__builtins__": {}}, {**PYTHON, "t": t})  # of texts made above, in test code only
    except (ValueError, ZeroDivisionError, OverflowError):
        return None
    return float(value) if math.isfinite(value) else None


@pytest.mark.heavy
@given(EXPRESSIONS, st.floats(-3.0, 3.0))
@settings(max_examples=EXAMPLES, deadline=None, derandomize=True)
def test_values_are_pythons(text: str, t: float) -> None:
    expected = by_python(text, t)
    try:
        expression = read(text)
    except ValueError as error:
        assert getattr(error, "code", "") == "not-computable"
        assert expected is None
        return
    found = expression.value(t)
    if expected is None:
        return  # Python stops at the first branch it cannot compute; the next test holds the evaluator to NaN
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("text", [
    "sqrt(-1 - t)", "log(0*t)", "log(-t)", "1/(t - t)", "asin(1 + t)", "acos(-1 - t)", "(0*t)**-1", "(-t)**0.5",
    "exp(1000*t)", "sin(exp(1000*t))", "tan(exp(1000*t))", "cos(exp(999*t))", "sinh(1000*t)", "cosh(1000*t)",
    "1 if sqrt(-t) > 0 else 2", "min(1, sqrt(-t))", "max(sqrt(-t), 1)", "step(sqrt(-t))", "sign(sqrt(-t))",
    "0*sqrt(-t)", "10**(400*t)", "(-10)**(401*t)", "hypot(exp(709.7*t), exp(709.7*t))",
])  # fmt: skip
def test_what_is_no_number_is_nan(text: str) -> None:
    expression = read(text)
    assert math.isnan(expression.value(1.0))
    assert all(map(math.isnan, expression.derivatives(1.0)))


@pytest.mark.parametrize(("text", "expected"), [
    ("sqrt(-1) if t < 0 else 5", 5.0), ("5 if t > 0 else 1/0", 5.0), ("t > 0 or 1/0 > 0", 1.0),
    ("t < 0 and 1/0 > 0", 0.0), ("-2**2", -4.0), ("2**-1", 0.5), ("2**3**2", 512.0), ("-2**-2", -0.25),
    ("(-2)**3", -8.0), ("(-8)**(1/3*3)", -8.0), ("0**0", 1.0), ("1 - 2 - 3", -4.0), ("8/4/2", 1.0), ("--3", 3.0),
    ("+-+3", -3.0), ("3 < 4 < 5", 1.0), ("3 < 4 > 5", 0.0), ("1 < 2 < 3 < t", 0.0), ("not 0", 1.0), ("not not 7", 1.0),
    ("atan(exp(1000*t))", math.pi / 2), ("exp(-exp(800*t))", 0.0), ("tanh(800*t)", 1.0), ("step(0)", 1.0),
    ("step(-0.0)", 1.0), ("step(-1e-300)", 0.0), ("sign(0)", 0.0), ("90*deg", math.pi / 2), ("60*rpm", 2 * math.pi),
    ("min(3, 1, 2)", 1.0), ("max(3, 1, 2, 7)", 7.0), ("hypot(2, 3, 6)", 7.0), (".5e1", 5.0), ("2.", 2.0),
])  # fmt: skip
def test_worked_values(text: str, expected: float) -> None:
    assert read(text).value(1.0) == pytest.approx(expected, rel=1e-15, abs=1e-15)


COMPLEX: dict[str, Any] = {
    **{name: getattr(cmath, name) for name in ANALYTIC},
    "pi": math.pi, "hypot": lambda x, y: cmath.sqrt(x * x + y * y), "min": lambda x, y: x if x.real <= y.real else y,
    "max": lambda x, y: x if x.real >= y.real else y, "abs": lambda x: x if x.real >= 0 else -x, "L": 1.5,
    "step": lambda x: 1.0 if x.real >= 0 else 0.0, "sign": lambda x: sign(x.real),
    # analytic where x > 0, which the texts below see to
    "atan2": lambda y, x: cmath.atan(y / x),
}  # fmt: skip
SMOOTH = [
    "t**3 - 2*t", "sin(2*pi*t)", "cos(t)*exp(-t)", "tan(t)", "asin(t/2)", "acos(t/2)", "atan(3*t)", "atan2(t, 2 + t*t)",
    "sinh(t)/cosh(2*t)", "tanh(t)", "log(1 + t)", "sqrt(1 + t*t)", "hypot(1 + t, 2*t)", "(1 + t)**2.5", "(2 + t)**-3",
    "(1 + t)**t", "2**t", "(1 + t)**(2*t*t)", "1/(1 + t)", "abs(sin(t) - 2)*t", "min(t*t, 5)", "max(t*t, sin(t))",
    "step(t)*t**4", "sign(t + 1)*exp(t)", "-(t**2)", "t*t if t < 9 else 1/t", "L*t/(3 - t)", "(t < 1)*5 + t*t*t",
    "(t - 1)**7", "t**5", "(0.5 - t)**3", "exp(sin(t)**2)/(1 + t)**2",
]  # fmt: skip


@pytest.mark.parametrize("text", SMOOTH)
@pytest.mark.parametrize("t", [0.3, 0.71])
def test_derivatives_are_those_of_complex_steps(text: str, t: float) -> None:
    def slope(s: float) -> float:
        value: complex = eval(compile_complex(text), {"__builtins__": {}}, {**COMPLEX, "t": s + 1e-20j})
        return complex(value).imag / 1e-20

    value, first, second = read(text).derivatives(t)
    assert value == pytest.approx(read(text).value(t), rel=1e-15)
    assert first == pytest.approx(slope(t), rel=1e-12, abs=1e-12)
    h = 1e-3  # Richardson on central differences: the error is of order h**4
    near, far = (slope(t + h) - slope(t - h)) / (2 * h), (slope(t + 2 * h) - slope(t - 2 * h)) / (4 * h)
    assert second == pytest.approx((4 * near - far) / 3, rel=1e-7, abs=1e-7)


def test_a_course_is_the_derivatives_at_its_instants() -> None:
    times = [-0.5, 0.0, 0.3, 0.71]
    for text in (*SMOOTH, "t*sqrt(t)"):
        expression = read(text)
        one_by_one = [expression.derivatives(t) for t in times]
        np.testing.assert_array_equal(np.transpose(expression.sample_derivatives(times)), one_by_one)
    assert math.isnan(read("sqrt(t)").sample_derivatives(times)[0][0])


def compile_complex(text: str) -> str:
    """Comparisons look at the real part."""
    return text.replace("t < 9", "t.real < 9").replace("(t < 1)", "(t.real < 1)")


def test_derivatives_at_the_edge_of_a_domain_stand_still_with_their_argument() -> None:
    assert read("sqrt(step(t) - 1)").derivatives(1.0) == (0.0, 0.0, 0.0)
    assert read("asin(step(t))").derivatives(1.0) == (math.pi / 2, 0.0, 0.0)
    assert read("(step(t) - 1)**0.5").derivatives(1.0) == (0.0, 0.0, 0.0)
    assert math.isnan(read("sqrt(t - 1)").derivatives(1.0)[1])


def test_coordinates_take_their_places() -> None:
    expression = read("shaft.angle + 10*guide.speed - 100*shaft.rate + t")
    assert expression.uses == (("shaft", "angle"), ("guide", "speed"), ("shaft", "rate"))
    assert expression.constant is None
    assert expression.time_dependent
    assert expression.value(0.5, [1.0, 2.0, 3.0]) == 1.0 + 20.0 - 300.0 + 0.5
    assert math.isnan(expression.derivatives(0.5)[0])


def test_a_pack_holds_programs_side_by_side() -> None:
    pack = Pack()
    texts = ["guide.travel*2", "t + shaft.angle", "7", "guide.travel - shaft.angle"]
    spans = [pack.add(read(text)) for text in texts]
    assert pack.variables == ["t", ("guide", "travel"), ("shaft", "angle")]
    x = [0.25, 3.0, 10.0]
    assert [pack.value(*span, x) for span in spans] == [6.0, 10.25, 7.0, -7.0]
    assert pack.starts == [start for start, _ in spans]
    with pytest.raises(ValueError, match="3 variables"):
        pack.value(*spans[0], [1.0])


def test_constants_need_no_program_run() -> None:
    expression = Expression.from_number(2.5)
    assert (expression.constant, expression.value(), expression.derivatives(3.0)) == (2.5, 2.5, (2.5, 0.0, 0.0))
    assert not expression.time_dependent
    assert list(read("t*t").sample([1.0, 2.0, 3.0])) == [1.0, 4.0, 9.0]


@pytest.mark.skipif(not expressions.COMPILED, reason="there is only the plain form")
@given(text=EXPRESSIONS, t=st.floats(-5.0, 5.0))
@settings(max_examples=EXAMPLES, deadline=None, derandomize=True)
def test_compiled_and_plain_give_the_same_bits(text: str, t: float) -> None:
    try:
        expression = read(text)
    except ValueError:
        return
    compiled = answers(COMPILED, expression.pack, expression.count, [t])
    assert compiled == answers(PLAIN, expression.pack, expression.count, [t])
    if "nan" not in compiled:
        # At a tie derivatives are of what begins; beside 0 that is seen where powers are no 0 yet.
        behind = float.hex(expression.value(max(math.nextafter(t, math.inf), t + 1e-30)))
        assert compiled[1] in (compiled[0], behind)


@pytest.mark.skipif(not expressions.COMPILED, reason="there is only the plain form")
def test_any_program_gives_the_same_bits_compiled_and_plain() -> None:
    """All operations on numbers of all sizes, infinite and none; about three in four have a value."""
    random = Random(5)
    have_value, seen = 0, set()
    for _ in range(3000):
        program = random_program(random)
        code, constants = program.numbered(expressions.OPERATIONS), array("d", program.constants)
        x = [random.uniform(-3.0, 3.0) for _ in range(VARIABLES)]
        found = []
        for evaluator, derived in (COMPILED, PLAIN):
            programs = evaluator.Expressions(code, constants, VARIABLES, tables=program.tables)
            count = len(program.code)
            found.append(bits([programs.evaluate(0, count, x), *derived.find_derivatives(programs, 0, count, x[0])]))
        assert found[0] == found[1], program
        have_value += found[0][0] != "nan"
        seen |= {op for op, _ in program.code if isinstance(op, str)}
    assert seen == set(expressions.OPERATIONS) - {"hold", "integral"}  # test_held.py, test_integrals.py
    assert 1500 < have_value < 2900


class Watched(list[Any]):
    """A stack that keeps in mind how far up it was used."""

    top = 0

    def __setitem__(self, i: Any, x: Any) -> None:
        self.top = max(self.top, i + 1)
        super().__setitem__(i, x)


@pytest.mark.parametrize("holds", [False, True], ids=["free", "held"])
def test_the_depth_counted_is_the_largest_seen_on_every_stack(holds: bool) -> None:
    """Values, derivatives in time and along coordinates, and bounds, of random programs; none goes higher, ever."""
    plain, derived = PLAIN
    bounds = plain_module("enclosure")
    random = Random(6)
    branchless = exact = 0
    for _ in range(400):
        program, held = (lambda p: p.holding() if holds else (p, []))(random_program(random))
        code, span = program.numbered(plain.OPERATIONS), (0, len(program.code))
        depth = plain.stack_depth(code)
        programs = plain.Expressions(code, array("d", program.constants), VARIABLES, len(held), tables=program.tables)
        memory = programs.programs
        assert len(memory.stack) == len(memory.jets) == len(memory.spans) == depth
        memory.stack, memory.jets, memory.spans = (Watched(x) for x in (memory.stack, memory.jets, memory.spans))
        for holding in ("taken", "held") if holds else ("free",):
            programs.hold(plain.HOLDING[holding])
            derived.find_gradient(programs, *span, [1.0] * VARIABLES)
        bounds.find_span(programs, *span, [(-9.0, 9.0, -9.0, 9.0, -9.0, 9.0)] * VARIABLES)
        if not holds:
            derived.find_derivatives(programs, *span, 1.0)
        tops = [stack.top for stack in (memory.stack, memory.jets, memory.spans)]
        assert max(tops) <= depth, program
        if not any(op == "unless" for op, _ in program.code):
            assert tops == [depth] * 3, program
            branchless += 1
        exact += max(tops) == depth
    assert branchless > 150 and exact > 320  # the others leave out a branch, on every way to run them


@pytest.mark.parametrize(("text", "depth"), [
    ("min(100*t, 5)", 3), ("max(100*t, 5, 7)", 3), ("t", 1), ("1 + t", 2), ("t < 1 < 2*t", 4), ("t*t if t else 1", 2),
])  # fmt: skip
def test_depth_of_an_expression_and_its_switches(text: str, depth: int) -> None:
    """Where the branches of min change is found by min's operands in the other order."""
    expression = read(text)
    codes = (expression.code, *(switch.decision for switch in expression.switches))
    assert max(expressions.stack_depth(code) for code in codes) == depth


OPS = expressions.OPERATIONS
T, ADD, TABLE = (OPS["var"], 0), (OPS["add"], 0), (OPS["table"], 0)
NOT_PROGRAMS = {
    "nothing": [],
    "an operand missing": [T, ADD],
    "two numbers left": [T, T],
    "a jump out of it": [T, (OPS["jump"], 1)],
    "a jump back": [T, (OPS["jump"], -1)],
    "branches that leave different numbers": [T, (OPS["unless"], 2), T, (OPS["jump"], 2), T, T],
    "a table without its data": [T, TABLE],
}


@pytest.mark.parametrize("pairs", NOT_PROGRAMS.values(), ids=NOT_PROGRAMS)
def test_code_that_is_no_program_is_refused(pairs: list[tuple[int, int]]) -> None:
    """Before it is run: the compiled evaluator would read and write beside its stack."""
    code = array("i", [x for pair in pairs for x in pair])
    with pytest.raises(ValueError, match="no program"):
        expressions.Expressions(code, array("d", [0.0]), 1)


def test_a_switch_deeper_than_its_expression_is_met() -> None:
    assert find_discontinuities(read("min(100*t, 5)"), 0.0, 1.0)[-1] == math.nextafter(0.05, 1.0)


def test_programs_added_later_are_run_too() -> None:
    pack = Pack()
    first = pack.add(read("2*t"))
    assert pack.value(*first, [3.0]) == 6.0
    second = pack.add(read("t - guide.speed*(1 + 2*t)"))
    assert [pack.value(*span, [3.0, 1.0]) for span in (first, second)] == [6.0, -4.0]


@pytest.mark.parametrize(("start", "count"), [(-1, 1), (0, 0), (0, 4), (3, 1)])
def test_what_is_no_program_is_not_run(start: int, count: int) -> None:
    programs = read("2*t").pack.expressions
    for run in (
        lambda: programs.evaluate(start, count, [1.0]),
        lambda: jets.find_derivatives(programs, start, count, 1.0),
        lambda: programs.sample(start, count, array("d", [1.0]), array("d", [0.0])),
    ):
        with pytest.raises(ValueError, match="no program"):
            run()
    with pytest.raises(ValueError, match="2 instants"):
        programs.sample(0, 3, array("d", [1.0, 2.0]), array("d", [0.0]))


def test_the_table_of_operations_is_complete() -> None:
    assert sorted(expressions.OPERATIONS.values()) == list(range(len(expressions.OPERATIONS)))
