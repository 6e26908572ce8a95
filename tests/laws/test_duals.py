"""Dual numbers: slopes of every function against complex steps, and what they say where there is none."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.shared import duals
from tests.shared.dual_kernel import dual_module
from tests.shared.duals import Dual, value_of

STEP = 1e-30  # of a complex step: it loses no digits
ROUNDING = 4.0 * np.finfo(float).eps


def of_first(f: Callable[..., Any]) -> Callable[..., Any]:
    """A function of one number as one of two."""
    return lambda x, y: f(x)


NAMES = ("sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log")
FORMULAS: dict[str, tuple[Callable[..., Any], Callable[..., Any]]] = {
    **{name: (of_first(getattr(duals, name)), of_first(getattr(cmath, name))) for name in NAMES},
    "product": (lambda x, y: 3.0 * x * y - y * 2.0 + (1.0 - x), lambda x, y: 3.0 * x * y - y * 2.0 + (1.0 - x)),
    "quotient": (lambda x, y: x / y + 2.0 / x - y / 3.0, lambda x, y: x / y + 2.0 / x - y / 3.0),
    "power": (lambda x, y: duals.pow(x, y) + duals.pow(x, 3.0) + duals.pow(2.0, y), lambda x, y: x**y + x**3 + 2.0**y),
    "angle": (lambda x, y: duals.atan2(x, y), lambda x, y: cmath.atan(x / y)),
    "size": (lambda x, y: abs(-x) + duals.fabs(y - 2.0), lambda x, y: x + 2.0 - y),
}


@pytest.mark.parametrize("name", FORMULAS)
def test_slopes(name: str) -> None:
    """The gradient is that of a complex step, and the value that of plain numbers."""
    ours, wanted = FORMULAS[name]
    x, y = 0.37, 1.2
    found = ours(Dual(x, np.array([1.0, 0.0])), Dual(y, np.array([0.0, 1.0])))
    exact = [wanted(x + 1j * STEP, y).imag / STEP, wanted(x, y + 1j * STEP).imag / STEP]
    assert math.isclose(found.value, wanted(x + 0j, y).real, rel_tol=ROUNDING)
    assert math.isclose(value_of(ours(x, y)), found.value, rel_tol=ROUNDING)
    assert np.allclose(found.gradient, exact, rtol=ROUNDING, atol=ROUNDING)


def test_what_is_zero_and_moves_is_not_nothing() -> None:
    moving, still = Dual(0.0, np.array([1.0])), Dual(0.0, np.array([0.0]))
    assert moving != 0.0 and still == 0.0
    assert not moving > 0.0 and moving >= 0.0


def test_no_slope_is_told_as_none() -> None:
    """A root where it begins, an arc where it ends, a power below 1 at 0; a root of a sum of squares has one, of 0."""
    one = np.array([1.0])
    for found in (duals.sqrt(Dual(0.0, one)), duals.asin(Dual(1.0, one)), duals.pow(Dual(0.0, one), 0.5)):
        assert np.isnan(found.gradient).all()
    x = Dual(0.0, one)
    assert duals.sqrt(x * x) == 0.0


def test_the_kernel_that_computes_is_left_alone() -> None:
    from heuncli.kernel.choose import workspace

    dual = dual_module("workspace")
    assert dual is not workspace and dual_module("workspace") is dual
    assert dual_module("scene").Scene is dual.Scene
