"""Bounds over spans of time hold for every instant within, and come down as the spans get short."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest

from heuncli.expressions.curves import fit
from heuncli.expressions.enclosure import bounds
from heuncli.expressions.grammar import Scope, compile_expression
from heuncli.expressions.programs import Expression

RAMP = fit("ramp", [-9.0, 2.0, 9.0], [0.0, 1.0, 5.0], "linear", "hold", None)
ONE = ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt", "abs", "step", "sign")
TWO = ("min({}, {})", "max({}, {})", "hypot({}, {})", "atan2({}, {})")


def read(text: str) -> Expression:
    return compile_expression(text, Scope(tables={"ramp": RAMP}, in_time=True))


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
    return f"{random.choice(ONE)}({a})"


@pytest.mark.parametrize("seed", range(300))
def test_no_value_is_outside(seed: int) -> None:
    random = Random(seed)
    text = some_text(random, 4)
    try:
        expression = read(text)
    except Exception:
        return  # not computable wherever it is, or without the time
    if expression.constant is not None:
        return
    a = np.array([random.uniform(-3, 3) for _ in range(20)])
    b = a + [10.0 ** random.uniform(-6, 0.5) for _ in a]
    low, high = bounds(expression, a, b)
    for k in range(20):
        values = np.array(expression.sample(np.linspace(a[k], b[k], 101).tolist()))
        values = values[np.isfinite(values)]
        slack = 1e-9 * np.abs(values).max(initial=0.0)
        if len(values) == 101:
            assert low[k] - slack <= values.min() and values.max() <= high[k] + slack, f"{text} on [{a[k]}, {b[k]}]"


@pytest.mark.parametrize("text", ["t**3*(10 - 15*t + 6*t**2)", "t*t - 2*t", "sin(t)/(1 + t**2)", "exp(-(t - 1)**2)"])
def test_bounds_come_down_with_the_square_of_the_span(text: str) -> None:
    expression = read(text)
    over = []
    for width in (1e-2, 1e-3):
        a = np.array([1.0])
        low, high = bounds(expression, a, a + width)
        values = np.array(expression.sample(np.linspace(1.0, 1.0 + width, 101).tolist()))
        over.append(float((high - low)[0] - np.ptp(values)))
    assert over[1] <= 0.015 * over[0] + 1e-15


def test_a_table_lies_between_its_values() -> None:
    low, high = bounds(read("2*table(ramp, t) + 1"), np.array([2.0]), np.array([9.0]))
    assert low[0] == pytest.approx(3.0) and high[0] == pytest.approx(11.0)
