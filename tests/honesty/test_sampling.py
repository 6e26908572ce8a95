"""What a sample says of all that could be drawn: its intervals hold the truth as often as they claim to."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.random import Generator
from scipy.stats import binom, norm

from heuncli.analyses.variants.parameters import RandomVariable
from heuncli.analyses.variants.plans import make_draws
from heuncli.analyses.variants.sample_statistics import (
    CONFIDENCE,
    MIN_INDEX_BOUNDED,
    PERCENTS,
    BoundedEstimate,
    compute_sobol_indices,
    compute_statistics,
)
from heuncli.results.results import Array

SEEDS = 2000
# of so many true intervals fewer hold the truth once in 10,000 times
LEAST_SEEN = binom.ppf(1e-4, SEEDS, CONFIDENCE) / SEEDS
Law = tuple[Callable[[Generator, int], Array], float, float, Callable[[float], float]]
# How it is drawn, its mean, its deviation, its quantiles.
LAWS: dict[str, Law] = {
    "normal": (lambda rng, n: rng.normal(3.0, 2.0, n), 3.0, 2.0, norm(3.0, 2.0).ppf),
    "uniform": (lambda rng, n: rng.random(n), 0.5, 12**-0.5, lambda p: p),
    "exponential": (lambda rng, n: rng.exponential(1.0, n), 1.0, 1.0, lambda p: -math.log1p(-p)),
}


def holds(one: BoundedEstimate, truth: float) -> bool:
    return (one.low is None or one.low <= truth) and (one.high is None or truth <= one.high)


def shares(law: Law, n: int) -> tuple[float, float, list[float]]:
    """How many of the intervals of mean, deviation and percentiles hold the truth."""
    draw, mean, deviation, quantile = law
    rng = np.random.default_rng(17)
    hits = np.zeros(2 + len(PERCENTS))
    for _ in range(SEEDS):
        found = compute_statistics(draw(rng, n))
        assert found is not None
        truths = [mean, deviation, *(quantile(0.01 * percent) for percent in PERCENTS)]
        told = [found.mean, found.deviation, *(one for _, one in found.percentiles)]
        hits += [holds(one, truth) for one, truth in zip(told, truths, strict=True)]
    of_mean, of_deviation, *of_percentiles = (hits / SEEDS).tolist()
    return of_mean, of_deviation, of_percentiles


@pytest.mark.parametrize("n", [20, 100, pytest.param(400, marks=pytest.mark.long)])
@pytest.mark.parametrize("law", ["normal", "uniform"])
@pytest.mark.third
def test_intervals_hold_the_truth_as_often_as_they_say(law: str, n: int) -> None:
    of_mean, of_deviation, of_percentiles = shares(LAWS[law], n)
    assert min(of_mean, *of_percentiles) >= LEAST_SEEN
    assert of_deviation >= LEAST_SEEN - 0.01  # Bonett's interval is one of many draws
    assert max(of_mean, of_deviation) < 0.975  # nor are they wide for nothing


def test_of_a_skew_law_what_the_docstring_says() -> None:
    of_mean, of_deviation, of_percentiles = shares(LAWS["exponential"], 100)
    assert min(of_percentiles) >= LEAST_SEEN and of_mean > 0.92 and of_deviation > 0.89


def ishigami(u: Array) -> Array:
    x = math.pi * (2.0 * u - 1.0)
    found: Array = np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    return found


def product(u: Array) -> Array:
    """x y + z: variances 1/48, 1/48, 1/12 of each alone, 1/144 of x and y together."""
    found: Array = u[:, 0] * u[:, 1] + u[:, 2]
    return found


OF_PRODUCT = (np.array([3.0, 3.0, 12.0]) / 19.0, np.array([4.0, 4.0, 12.0]) / 19.0)
OF_ISHIGAMI = (np.array([0.313905, 0.442411, 0.0]), np.array([0.557589, 0.442411, 0.243684]))


@pytest.mark.heavy
@pytest.mark.parametrize(("law", "n"), [("uniform", 64), ("lhs", 64), ("sobol", 64), ("sobol", 256)])
@pytest.mark.parametrize(("f", "truths"), [(product, OF_PRODUCT), (ishigami, OF_ISHIGAMI)], ids=["product", "ishigami"])
@pytest.mark.third
def test_intervals_of_indices_hold_the_truth_as_often_as_they_say(
    f: Callable[[Array], Array], truths: tuple[Array, Array], law: str, n: int
) -> None:
    """From the least number of samples on that have intervals; they are not wide for nothing."""
    laws = [RandomVariable(name, law, 0.0, 1.0, "") for name in "xyz"]  # type: ignore[arg-type]
    hits, seeds = np.zeros((3, 2)), 60
    for seed in range(seeds):
        draws = make_draws(laws, n, seed, indices=True)
        plans = np.arange(n) % draws.repetitions if draws.repetitions > 1 else None
        found = compute_sobol_indices(f(draws.values).reshape(n, 5), plans)
        assert found is not None
        hits += [
            [holds(one.first, first), holds(one.total, total)] for one, first, total in zip(found, *truths, strict=True)
        ]
    assert (hits / seeds).min() >= binom.ppf(1e-4, seeds, CONFIDENCE) / seeds and (
        hits / seeds
    ).mean() >= CONFIDENCE - 0.01


def test_few_samples_have_indices_without_intervals() -> None:
    rows = np.random.default_rng(5).random((MIN_INDEX_BOUNDED, 4))
    few, enough = compute_sobol_indices(rows[:-1]), compute_sobol_indices(rows)
    assert few is not None and few[0].first.low is None and few[0].total.high is None
    assert enough is not None and enough[0].first.low is not None


def test_the_percentile_interval_is_that_of_the_binomial_law() -> None:
    """Of 20 draws at most 5 lie below the median in 2.07 % of samples, at most 6 in 5.77 %: the 6th to the 15th."""
    found = compute_statistics(np.arange(1.0, 21.0))
    assert found is not None
    median = dict(found.percentiles)[50.0]
    assert (median.value, median.low, median.high) == (10.5, 6.0, 15.0)
    least = dict(found.percentiles)[1.0]
    assert least.low is None and least.high is not None  # 20 draws do not bound the first per cent from below


def test_few_numbers_have_no_interval() -> None:
    assert compute_statistics(np.array([1.0])) is None
    found = compute_statistics(np.array([1.0, 2.0]))
    assert found is not None and found.mean.value == 1.5 and found.deviation.low is None
    same = compute_statistics(np.full(10, 3.0))
    assert (
        same is not None
        and same.deviation == BoundedEstimate(0.0, 0.0, 0.0)
        and same.mean == BoundedEstimate(3.0, 3.0, 3.0)
    )
