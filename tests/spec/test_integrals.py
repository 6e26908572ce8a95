"""Integrals of rates: their values in closed form, their bounds, and what refuses to be integrated."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.kernel.choose import expressions
from heuncli.scene.expressions.curves import interpolate_points
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.integrals import add_start_value, integrate_rate
from heuncli.scene.expressions.programs import Expression, Pack
from heuncli.scene.expressions.scope import Scope
from tests.shared.evaluators import COMPILED, PLAIN, answers
from tests.shared.scenes import near

LAST = 10.0
TABLES = {"v": interpolate_points("v", [0, 1, 3, 10], [0, 2, -1, -1], "linear", None, None)}
LAWS: dict[str, Callable[[float], float]] = {  # of a rate its integral from 0
    "5": lambda t: 5 * t,
    "0": lambda t: 0.0,
    "t**3 - 2*t": lambda t: t**4 / 4 - t * t,
    "sin(50*t)": lambda t: math.sin(25 * t) ** 2 / 25,
    "3*step(t - 1.3)": lambda t: 3 * max(0.0, t - 1.3),
    "sign(t - 1)*t": lambda t: t * t / 2 - 1 if t > 1 else -t * t / 2,
    "min(2*t, 5)": lambda t: t * t if t < 2.5 else 6.25 + 5 * (t - 2.5),
    "sqrt(t)": lambda t: t * math.sqrt(t) / 1.5,
    "1/(1 + t)": math.log1p,
    "table(v, t)": lambda t: t * t if t < 1 else 1 + 2 * (t - 1) - 0.75 * (t - 1) ** 2 if t < 3 else 5 - t,
    # a pulse that no grid would see, and one that decays at once behind a jump
    "exp(-((t - 3.3)*1e5)**2) + 0.1": lambda t: math.sqrt(math.pi) / 2e5 * (math.erf((t - 3.3) * 1e5) + 1) + 0.1 * t,
    "1e4*exp(-(t - 1)*1e4) if t >= 1 else 0": lambda t: -math.expm1(-(t - 1) * 1e4) if t > 1 else 0.0,
}


def read(text: str) -> Expression:
    return compile_expression(text, Scope(joints={}, tables=TABLES, in_time=True))


@pytest.mark.parametrize("text", LAWS)
def test_value_and_derivatives(text: str) -> None:
    """The value in closed form, at knots and between; the derivatives are the rate and its own."""
    rate = read(text)
    value = add_start_value(integrate_rate(rate, LAST), 0.5)
    times = [*np.linspace(0.0, LAST, 41).tolist(), 1.0, 1.00013, 2.5, 3.29999, 3.300007]
    size = max(1.0, *(abs(LAWS[text](t)) for t in times))
    fastest = max(map(abs, rate.sample([1.0, *times])))
    for t in times:
        rounded_instant = 4 * 2.0**-52 * t * fastest
        near(value.value(t), 0.5 + LAWS[text](t), 1.0, 2e-15 * size + rounded_instant)
        found, first, second = value.derivatives(t)
        behind = rate.derivatives(t)[0]  # at a jump the rate is that of the branch that begins
        assert (found, first) == (value.value(t), behind)
        assert behind == rate.value(t) or math.isclose(behind, rate.value(math.nextafter(t, math.inf)), rel_tol=1e-15)
        assert second == rate.derivatives(t)[1] or math.isnan(second)  # of sqrt(t) at 0


@pytest.mark.parametrize("text", LAWS)
def test_bounds(text: str) -> None:
    """No value of a stretch lies outside the bounds over it, and these close in on it."""
    value = integrate_rate(read(text), LAST)
    rng = np.random.default_rng(5)
    for width in (3.0, 1e-2, 1e-6):
        begin = rng.uniform(0.0, LAST - width, 20).tolist()
        end = [t + width for t in begin]
        low, high = value.bounds(begin, end)
        size = max(1.0, abs(value.value(LAST)))
        for a, b, least, most in zip(begin, end, low, high, strict=True):
            seen = value.sample(np.linspace(a, b, 33).tolist())
            assert least <= min(seen) and max(seen) <= most
            fastest = max(abs(x) for bound in read(text).bounds([a], [b]) for x in bound)
            assert most - least <= 2.0 * width * fastest + 1e-13 * size


def test_beside_others_in_a_pack() -> None:
    """An integral finds its constants and tables behind those of other programs."""
    pack = Pack()
    pack.add(read("3 + table(v, t)"))
    place = pack.add(integrate_rate(read("2*table(v, t) + 1"), LAST))
    near(pack.value(*place, [2.0]), 2 * LAWS["table(v, t)"](2.0) + 2, 1.0, 2e-15)


@pytest.mark.skipif(not expressions.COMPILED, reason="there is only the plain form")
@pytest.mark.parametrize("text", LAWS)
def test_compiled_and_plain_give_the_same_bits(text: str) -> None:
    value = integrate_rate(read(text), LAST)
    for t in np.linspace(0.0, LAST, 23).tolist():
        assert answers(COMPILED, value.pack, value.count, [t]) == answers(PLAIN, value.pack, value.count, [t])


def test_no_integral() -> None:
    """Over a pole there is none; behind the end of a domain there is no value."""
    with pytest.raises(SpecError, match="'1/\\(4 - t\\)' grows without bound at t = 4 s"):
        integrate_rate(read("1/(4 - t)"), LAST)
    value = integrate_rate(read("sqrt(4 - t)"), LAST)
    near(value.value(4.0), 16 / 3, 1.0, 2e-15)
    assert math.isnan(value.value(4.1))
