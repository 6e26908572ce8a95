"""Derivatives of what is known within an error: the error that is told of them covers how far they are off.

The functions are known, with noise of the size that is stated for them, as measures of runs have it, and no less.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from heuncli.analyses.sensitivity import NoisyDerivative, compute_derivative
from heuncli.analyses.variants.measures import NoisyValue

Function = Callable[[float], float]


def told(f: Function, at: float, error: float, seed: int = 0) -> NoisyDerivative:
    """The derivative of a function at a number, from values within an error relative to 1 + |f|."""

    def ask(distance: float) -> NoisyValue:
        try:
            value = f(at + distance)
        except ValueError:
            return NoisyValue(None, why=("beyond", "not defined there"))
        size = error * (1.0 + abs(value))
        return NoisyValue(value + size * math.sin(1e9 * distance + seed), size)

    return compute_derivative(ask, at, abs(at) or 1.0)


@pytest.mark.parametrize("seed", range(120))
def test_errors_cover_random_functions(seed: int) -> None:
    rng = np.random.default_rng([3, seed])
    a, b, c, at = rng.normal(), rng.uniform(0.1, 12.0), rng.uniform(0.0, 6.0), rng.uniform(0.05, 3.0)
    error = 10.0 ** rng.uniform(-13.0, -5.0)
    f, slope = (
        (lambda x: a * math.sin(b * x + c), a * b * math.cos(b * at + c)),
        (lambda x: a * math.exp(-b * x / 4.0), -a * b / 4.0 * math.exp(-b * at / 4.0)),
        (lambda x: a / (x + 0.1), -a / (at + 0.1) ** 2),
        (lambda x: a * x**3 - b * x, 3.0 * a * at**2 - b),
        (lambda x: a + b * x, b),
        (lambda x: math.sqrt(b + x * x), at / math.sqrt(b + at * at)),
    )[seed % 6]
    one = told(f, at, error, seed)
    assert one.kind == "" and one.value is not None
    assert abs(one.value - slope) <= one.error
    assert one.error <= 300.0 * error ** (2.0 / 3.0) * (1.0 + abs(a)) * (1.0 + b) ** 3 / at  # and is of use


@pytest.mark.parametrize("at", [0.0, 0.7, -12.0])
@pytest.mark.parametrize("bend", [1.0, 0.1, 1e-2])
def test_a_bend_at_the_number_tells_both_slopes(at: float, bend: float) -> None:
    one = told(lambda x: 0.3 * x + bend * abs(x - at) + (x - at) ** 2, at, 1e-11)
    assert one.kind == "kink" and one.left is not None and one.right is not None
    assert abs(one.left[0] - (0.3 - bend)) <= one.left[1] < 1e-3 + bend
    assert abs(one.right[0] - (0.3 + bend)) <= one.right[1] < 1e-3 + bend


@pytest.mark.parametrize("height", [10.0, 0.1, 1e-3])
def test_a_jump_at_the_number_is_refused(height: float) -> None:
    one = told(lambda x: x + (height if x > 2.0 else 0.0), 2.0, 1e-11)
    assert one.kind == "refused" and one.value is None and one.why[0] == "not-smooth"


@pytest.mark.parametrize("distance", [1e-1, 1e-2, 1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize("height", [1.0, 1e-2])
def test_a_jump_beside_it_is_covered_or_refused(distance: float, height: float) -> None:
    one = told(lambda x: math.sin(x) + (height if x > 1.0 + distance else 0.0), 1.0, 1e-10)
    assert one.value is None or abs(one.value - math.cos(1.0)) <= one.error


def beside(rng: np.random.Generator) -> tuple[float, float, float]:
    """Where something happens beside the number 1 (or at it), and the slopes on its left and right."""
    far = rng.choice([0.0, -1.0, 1.0, 1.0, -1.0]) * 10.0 ** rng.uniform(-6.0, -1.0)
    left, right = rng.normal(size=2).tolist()
    return float(far), left, right


@pytest.mark.parametrize("seed", range(120))
def test_a_bend_beside_the_number_is_covered_or_told_within_a_distance(seed: int) -> None:
    rng = np.random.default_rng([19, seed])
    (far, left, right), error = beside(rng), 10.0 ** rng.uniform(-15.0, -3.5)
    one = told(lambda x: (left if x < 1.0 + far else right) * (x - 1.0 - far), 1.0, error, seed)
    if one.kind == "kink":
        assert one.left is not None and one.right is not None and abs(far) <= one.step
        assert abs(one.left[0] - left) <= one.left[1] and abs(one.right[0] - right) <= one.right[1]
        assert f"within {one.step:.2g} of the value" in one.why[1]
        return
    assert one.kind == "" and one.value is not None
    for slope in (left, right) if far == 0.0 else (left,) if far > 0.0 else (right,):
        assert abs(one.value - slope) <= one.error


@pytest.mark.parametrize("seed", range(80))
def test_a_jump_beside_the_number_is_covered_within_any_noise(seed: int) -> None:
    rng = np.random.default_rng([23, seed])
    (far, slope, _), error = beside(rng), 10.0 ** rng.uniform(-15.0, -3.5)
    height = 10.0 ** rng.uniform(-6.0, 0.0)
    one = told(lambda x: slope * x + (height if x > 1.0 + far else 0.0), 1.0, error, seed)
    assert one.value is None or abs(one.value - slope) <= one.error


@pytest.mark.parametrize("power", [3, 5])
@pytest.mark.parametrize("error", [1e-6, 1e-12, 1e-15])
def test_where_nothing_is_left_of_a_slope_it_is_0_within_its_error(power: int, error: float) -> None:
    one = told(lambda x: 1.0 + (x - 1.0) ** power, 1.0, error)
    assert one.kind == "" and one.value is not None and abs(one.value) <= one.error <= 100.0 * error ** (2.0 / 3.0)


def test_waves_shorter_than_the_step_are_seen_by_the_third() -> None:
    """Three steps cannot see all of them: by chance some look like a slope. Nearly all are refused, or covered."""
    wrong = 0
    for seed in range(300):
        rng = np.random.default_rng([29, seed])
        waves, phase, error = 10.0 ** rng.uniform(1.0, 4.0), rng.uniform(0.0, 6.0), 10.0 ** rng.uniform(-12.0, -4.0)
        one = told(lambda x, w=waves, p=phase: math.sin(w * (x - 1.0) + p), 1.0, error, seed)  # type: ignore[misc]
        wrong += one.value is not None and abs(one.value - waves * math.cos(phase)) > one.error
    assert wrong <= 3


def test_a_bound_leaves_one_side() -> None:
    one = told(lambda x: math.sqrt(1.0 - x) if x <= 0.5 else math.sqrt(-1.0), 0.5, 1e-11)
    assert one.kind == "one-sided" and one.why[0] == "beyond" and one.value is not None
    assert abs(one.value + 0.5 / math.sqrt(0.5)) <= one.error < 1e-3


@pytest.mark.parametrize("seed", range(120))
def test_a_bend_beside_a_bound_is_covered_as_far_as_it_shows(seed: int) -> None:
    """At the number itself it is told from the noise if the measure changes by 40 errors more there."""
    rng = np.random.default_rng([31, seed])
    (far, left, right), error = beside(rng), 10.0 ** rng.uniform(-15.0, -3.5)
    far, way = abs(far), rng.choice([-1.0, 1.0])

    def f(x: float) -> float:
        if way * (x - 1.0) < 0.0:
            return math.sqrt(-1.0)
        return (left if way * (x - 1.0) < far else right) * (way * (x - 1.0) - far)

    one = told(f, 1.0, error, seed)
    if one.value is not None and (far == 0.0 or abs(left - right) * far > 40.0 * error):
        assert one.kind == "one-sided"
        assert abs(one.value - way * (left if far > 0.0 else right)) <= one.error


def test_the_same_bits_are_nothing() -> None:
    one = compute_derivative(lambda x: NoisyValue(3.25, 1e-9), 1.0, 1.0)
    assert (one.kind, one.value, one.error) == ("nothing", 0.0, 0.0)
    assert compute_derivative(lambda x: NoisyValue(None, why=("open", "")), 1.0, 1.0).why[0] == "open"


def test_steps_are_few() -> None:
    """A base, and mostly three steps on either side: a smooth measure that is known to nine digits."""
    asked: set[float] = set()

    def ask(x: float) -> NoisyValue:
        asked.add(x)
        return NoisyValue(math.exp(x), 1e-9 * math.exp(x))

    compute_derivative(ask, 1.0, 1.0)
    assert len(asked) <= 9
