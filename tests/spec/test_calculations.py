"""A number calculated again is what reading it again makes of it; where a choice hangs on a value, nothing is kept."""

from __future__ import annotations

import pytest

from heuncli.base.errors import Finding
from heuncli.base.units import FORCE, LENGTH
from heuncli.scene.expressions.codegen import CalculationCache
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.scope import DimensionedParameter, Scope
from tests.shared.bits import bits

FIRST = {"a": 2.0, "b": -0.5, "n": 3.0}
OTHERS = ({"a": 0.1, "b": 7.0, "n": 2.0}, {"a": 1e-300, "b": -0.0, "n": 0.5}, {"a": 3.0, "b": 1e3, "n": -1.0})
AGAIN = (
    "a", "-a", "a*b", "a - b/3", "2*a + 3*b*a", "sqrt(a**2 + b**2)/n", "-(a + b)*-2", "a**2**2", "a**-3", "a**0.5",
    "pi*a", "max(a, b, n)", "hypot(a, b)", "abs(b) + sign(b)", "a < b", "not a", "atan2(a, b)", "7", "a**-(1 + 1)",
)  # fmt: skip
CHOICES = ("a if a > b else b", "a or b", "a and b", "a < b < n", "a**n", "a**(n - 1)", "2**n", "not a if b else n")


def kept(text: str) -> CalculationCache:
    known = CalculationCache()
    compile_expression(text, Scope(FIRST, calculations=known))
    return known


@pytest.mark.parametrize("text", AGAIN)
def test_a_calculation_is_what_reading_makes_of_it(text: str) -> None:
    known = kept(text)
    for values in (*OTHERS, FIRST):
        again = known.recalculate(text, values, lambda _: None)
        try:
            read = compile_expression(text, Scope(values))
        except Finding:
            assert again is None
            continue
        assert again is not None
        assert [*bits(again)] == [*bits(read)]
        assert [*bits(compile_expression(text, Scope(values, calculations=known)))] == [*bits(read)]


@pytest.mark.parametrize("text", CHOICES)
def test_where_a_choice_hangs_on_a_value_nothing_is_kept(text: str) -> None:
    assert kept(text).entries == {}


def test_what_there_is_to_be_told_of_is_read() -> None:
    known = kept("a/b")
    for b in (0.0, None):
        assert known.recalculate("a/b", {"a": 1.0, "b": b}, lambda _: None) is None
    with pytest.raises(Finding, match="not a finite number"):
        compile_expression("a/b", Scope({"a": 1.0, "b": 0.0}, calculations=known))


def test_other_dimensions_are_read_anew() -> None:
    known = kept("a + b")
    given = {"a": DimensionedParameter(LENGTH, "2 m"), "b": DimensionedParameter(FORCE, "1 N")}
    with pytest.raises(Finding, match="adds"):
        compile_expression("a + b", Scope(FIRST, given=given, calculations=known))
    alike = {"a": DimensionedParameter(LENGTH, "2 m"), "b": DimensionedParameter(LENGTH, "1 m")}
    for _ in range(2):
        assert compile_expression("a + b", Scope(FIRST, given=alike, calculations=known)).dimension == LENGTH
    assert compile_expression("a + b", Scope(FIRST, calculations=known)).dimension is None
    assert len(known.entries["a + b"]) == 2
