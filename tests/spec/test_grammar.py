"""What an expression may be, and how it is told what is wrong with it."""

from __future__ import annotations

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from heuncli.base.errors import Finding
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.expressions.scope import Scope

SCOPE = Scope(
    parameters={"L": 1.5, "broken": None},
    joints={"shaft": "pin", "guide": "slide", "knee": "ball", "collar": "cylinder"},
    tables={"broken_table": None},
    in_time=True,
)


@pytest.mark.parametrize(("text", "code", "words"), [
    ("2^3", "expression-syntax", "**"),
    ("2 * * 3", "expression-syntax", "character 5"),
    ("(1 + 2", "expression-syntax", "')'"),
    ("1 + 2)", "expression-syntax", "')'"),
    ("1 +", "expression-syntax", "too early"),
    ("", "expression-syntax", "empty"),
    ("   ", "expression-syntax", "empty"),
    ("2L", "expression-syntax", "2*L"),
    ("L 2", "expression-syntax", "L*2"),
    ("t = 2", "expression-syntax", "=="),
    ("1 if t > 1", "expression-syntax", "else"),
    ("t > 1 ? 2 : 3", "expression-syntax", "a if c else b"),
    ("t && 1", "expression-syntax", "and"),
    ("7 % 3", "expression-syntax", "remainder"),
    ("7 // 3", "expression-syntax", "/"),
    ("'text'", "expression-syntax", "'"),
    ("[1, 2]", "expression-syntax", "["),
    ("1,5", "expression-syntax", ","),
    ("(L).real", "expression-syntax", "joint"),
    ("shaft.", "expression-syntax", "too early"),
    ("shaft.2", "unknown-name", "shaft.angle"),
    ("lambda: 1", "unknown-name", "lambda"),
    ("x := 1", "unknown-name", "x"),
    ("l", "unknown-name", "did you mean L"),
    ("sinus(1)", "unknown-name", "sin"),
    ("ln(2)", "unknown-name", "log"),
    ("pow(2, 3)", "unknown-name", "**"),
    ("L(2)", "unknown-name", "L"),
    ("__import__('os')", "unknown-name", "__import__"),
    ("time", "unknown-name", "write t"),
    ("shaft", "unknown-name", "shaft.angle"),
    ("shft.angle", "unknown-name", "shaft"),
    ("shaft.__class__", "unknown-coordinate", "__class__"),
    ("shaft.angle.real", "expression-syntax", "'.'"),
    ("shaft.travel", "unknown-coordinate", "angle and rate"),
    ("shaft.force", "unknown-name", "reactions cannot be used"),
    ("0.2*guide.drive", "unknown-name", "reactions cannot be used"),
    ("rope.tension", "unknown-name", "reactions cannot be used"),
    ("joints.shaft.force.z", "unknown-name", "reactions cannot be used"),
    ("guide.angle", "unknown-coordinate", "travel and speed"),
    ("knee.angle", "unknown-coordinate", "ball"),
    ("collar.travel", "unknown-coordinate", "cylinder"),
    ("sin", "function-arguments", "sin(...)"),
    ("sin()", "function-arguments", "1 argument, not 0"),
    ("sin(1, 2)", "function-arguments", "not 2"),
    ("atan2(1)", "function-arguments", "2 arguments"),
    ("min(1)", "function-arguments", "2 or more"),
    ("log(8, 2)", "function-arguments", "log(x)/log(b)"),
    ("sin(x=1)", "unknown-name", "x"),
    ("sin(1 2)", "expression-syntax", "','"),
    ("sin(1,)", "expression-syntax", "')'"),
    ("table", "function-arguments", "table(...)"),
    ("table()", "function-arguments", "table's name"),
    ("table(1, 2)", "function-arguments", "table's name"),
    ("table(gas, 1)", "unknown-table", "gas"),
    ("table(gas, 1", "expression-syntax", "')'"),
    ("1e999", "not-computable", "too large"),
    ("9**9**9**9", "not-computable", "finite"),
    ("1/0", "not-computable", "finite"),
    ("log(-1)", "not-computable", "finite"),
    ("1/0 if 1 > 0 else t", "not-computable", "finite"),
    ("(" * 200 + "1" + ")" * 200, "expression-limit", "deep"),
    ("2**" * 200 + "2", "expression-limit", "deep"),
    ("sin(" * 100 + "t" + ")" * 100, "expression-limit", "deep"),
    ("t if t else " * 100 + "t", "expression-limit", "deep"),
    ("+".join(["t"] * 300), "expression-limit", "500 parts"),
    ("1 + " * 600 + "1", "expression-limit", "2401"),
])  # fmt: skip
def test_refusals(text: str, code: str, words: str) -> None:
    with pytest.raises(Finding) as caught:
        compile_expression(text, SCOPE)
    assert caught.value.code == code
    assert words in f"{caught.value.message} {caught.value.hint}"


@pytest.mark.parametrize("text", ["-" * 1999 + "1", "not " * 400 + "1", "1" + "+0" * 150, " ( ( 1 ) ) "])
def test_long_but_plain(text: str) -> None:
    assert compile_expression(text, SCOPE).constant is not None


@pytest.mark.parametrize("text", ["broken*2", "table(broken_table, t)", "sin(broken)"])
def test_what_follows_from_another_error_is_marked(text: str) -> None:
    with pytest.raises(Finding) as caught:
        compile_expression(text, SCOPE)
    assert caught.value.code == "follows"


@pytest.mark.parametrize("text", ["t", "shaft.angle", "2*t", "table(broken_table, 1)"])
def test_time_is_for_values_in_time(text: str) -> None:
    with pytest.raises(Finding) as caught:
        compile_expression(text, Scope(SCOPE.parameters, SCOPE.joints, SCOPE.tables))
    assert caught.value.code == "not-in-time"


def test_a_constant_is_recognised() -> None:
    assert compile_expression("2*L + 1", SCOPE).constant == 4.0
    assert compile_expression("L if 1 < 2 else t", SCOPE).constant == 1.5
    assert compile_expression("0*t", SCOPE).constant is None
    assert compile_expression("-(2*pi)**2/4", SCOPE).constant == -((2 * 3.141592653589793) ** 2) / 4


def test_what_does_not_move_is_computed_once() -> None:
    assert len(compile_expression("2*pi*L*t", SCOPE).code) == 2 * 3


TOKENS = ["t", "L", "1", "2.5", "+", "-", "*", "/", "**", "(", ")", "<", ">=", "==", "if", "else", "and", "or", "not",
          "sin", "min", ",", "shaft", ".", "angle", "table", "^", "%", "$", "step", "hypot"]  # fmt: skip


@pytest.mark.heavy
@given(st.one_of(st.text(max_size=40), st.lists(st.sampled_from(TOKENS), max_size=14).map(" ".join)))
@example("\x00")
@example("²")
@example("1_000")
@example("0x10")
@example("1j")
@example("٣")
@settings(max_examples=200, deadline=None, derandomize=True)
def test_any_text_is_an_expression_or_a_finding(text: str) -> None:
    try:
        found = compile_expression(text, SCOPE)
    except Finding as finding:
        assert finding.message
        return
    assert isinstance(found, Expression)
    value = found.value(0.5, [0.25] * len(found.uses))
    assert isinstance(value, float)
