"""Random parameters: which numbers a seed draws, and that they follow their laws."""

from __future__ import annotations

from statistics import NormalDist

import numpy as np
import pytest
from scipy import stats
from scipy.stats import qmc

from heuncli.analyses.variants.parameters import AxisError, ParameterAxis, RandomVariable
from heuncli.analyses.variants.plans import make_axes_plan, make_draws, make_imbalance_warning

SEEDS = [0, 1, 2024]


def law(name: str, kind: str, a: float, b: float, unit: str = "") -> RandomVariable:
    return RandomVariable(name, kind, a, b, unit)  # type: ignore[arg-type]


BOX = [(-1.0, 3.0), (0.1, 0.2), (-1e3, 1e4)]


@pytest.mark.parametrize("seed", SEEDS)
def test_several_sobol_are_the_one_sequence_that_scipy_draws(seed: int) -> None:
    drawn = make_draws([law(name, "sobol", *ends) for name, ends in zip("xyz", BOX, strict=True)], 64, seed)
    low, high = np.transpose(BOX)
    own = qmc.Sobol(3, seed=np.random.default_rng(seed)).random(64)
    assert np.array_equal(drawn.values, qmc.scale(own, low, high))


@pytest.mark.parametrize("seed", SEEDS)
def test_several_lhs_are_the_one_hypercube_that_scipy_draws(seed: int) -> None:
    drawn = make_draws([law(name, "lhs", *ends) for name, ends in zip("xyz", BOX, strict=True)], 50, seed)
    low, high = np.transpose(BOX)
    own = qmc.LatinHypercube(3, seed=np.random.default_rng(seed)).random(50)
    assert np.array_equal(drawn.values, qmc.scale(own, low, high))
    slices = np.sort(np.floor((drawn.values - low) / (high - low) * 50).astype(int), axis=0)
    assert np.array_equal(slices, np.repeat(np.arange(50)[:, None], 3, axis=1))  # one in each slice


@pytest.mark.parametrize("seed", SEEDS)
def test_a_normal_beside_them_is_a_coordinate_of_their_plan(seed: int) -> None:
    laws = [law("x", "normal", 5.0, 2.0), law("u", "uniform", 0.0, 1.0), law("y", "sobol", 0.0, 1.0)]
    drawn = make_draws(laws, 128, seed).values
    own = qmc.Sobol(2, seed=np.random.default_rng(seed)).random(128)
    assert np.array_equal(drawn[:, 2], own[:, 1])
    theirs = stats.norm(5.0, 2.0).ppf(own[:, 0])
    assert np.allclose(drawn[:, 0], theirs, rtol=0.0, atol=100.0 * np.finfo(float).eps)
    assert np.array_equal(drawn[:, 1], make_draws([laws[1]], 128, seed).values[:, 0])  # a uniform one is not


def test_a_seed_draws_these_numbers_for_ever() -> None:
    """The bits of PCG64 by the definition of its output, and the mean and deviation they are turned by."""
    bits = np.random.PCG64(np.random.SeedSequence(7, spawn_key=(0, ord("d")))).random_raw(3)
    u = [(int(word >> 12) + 0.5) / 2**52 for word in bits.tolist()]
    assert make_draws([law("d", "uniform", 0.0, 1.0)], 3, 7).values[:, 0].tolist() == u
    normal = [100.0 + 0.1 * NormalDist().inv_cdf(x) for x in u]
    assert make_draws([law("d", "normal", 100.0, 0.1)], 3, 7).values[:, 0].tolist() == normal
    assert make_draws([law("d", "uniform", 0.0, 1.0)], 2).values[:, 0].tolist() == [
        0.28854231059985513,
        0.615607697444169,
    ]


def test_neither_more_samples_nor_other_parameters_change_what_is_drawn() -> None:
    d, e, r = law("d", "normal", 100.0, 0.1), law("e", "normal", 1.0, 1.0), law("r", "uniform", 1.0, 2.0)
    few, more = make_draws([d, r], 10, 3).values, make_draws([e, r, d], 99, 3)
    assert np.array_equal(few, more.values[:10, [2, 1]])
    assert not np.isclose(more.values[:, 0], (more.values[:, 2] - 100.0) / 0.1 + 1.0).any()  # nor are two the same
    sobol = [law("x", "sobol", 0.0, 1.0), law("y", "normal", 0.0, 1.0)]
    assert np.array_equal(make_draws(sobol, 16, 3).values, make_draws(sobol, 64, 3).values[:16])


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("beside", [[], [law("s", "sobol", 0.0, 1.0)], [law("s", "lhs", 0.0, 1.0)]])
def test_numbers_follow_their_law(seed: int, beside: list[RandomVariable]) -> None:
    """By the largest distance of their distribution from the law's, which chance passes once in 10,000 seeds."""
    laws = [law("x", "normal", -3.0, 0.5), law("y", "uniform", 2.0, 4.0), *beside]
    values = make_draws(laws, 1024, seed).values
    assert stats.kstest(values[:, 0], stats.norm(-3.0, 0.5).cdf).pvalue > 1e-4
    assert stats.kstest(values[:, 1], stats.uniform(2.0, 2.0).cdf).pvalue > 1e-4
    assert abs(stats.spearmanr(values[:, 0], values[:, 1]).statistic) < 4.0 / np.sqrt(1024)


@pytest.mark.parametrize("kind", ["uniform", "lhs", "sobol"])
def test_saltellis_plan_exchanges_one_parameter_after_the_other(kind: str) -> None:
    laws = [law("x", kind, 0.0, 1.0), law("y", kind, 5.0, 6.0), law("n", "normal", 0.0, 1.0)]
    drawn = make_draws(laws, 16, 1, indices=True)
    assert drawn.each == 5 and drawn.values.shape == (80, 3)
    A, B, *exchanged = drawn.values.reshape(16, 5, 3).transpose(1, 0, 2)
    assert not np.isin(A, B).any()
    for i, rows in enumerate(exchanged):
        others = [j for j in range(3) if j != i]
        assert np.array_equal(rows[:, i], B[:, i]) and np.array_equal(rows[:, others], A[:, others])
    if kind == "sobol":  # of A and B together, as scipy.stats.sobol_indices has it; of 16 plans in turn
        own = qmc.Sobol(6, seed=np.random.default_rng((1, 3))).random(2)
        more = make_draws(laws, 32, 1, indices=True).values.reshape(32, 5, 3)
        assert np.array_equal(more[[3, 19], 0, 0], own[:, 0]) and np.array_equal(more[[3, 19], 1, 1], own[:, 4] + 5.0)
        assert np.array_equal(more[:16], drawn.values.reshape(16, 5, 3))  # it goes on with more samples
    assert drawn.repetitions == (1 if kind == "uniform" else 16)


def test_every_combination_of_the_other_axes_gets_the_same_samples() -> None:
    draws = make_draws([law("d", "normal", 100.0, 0.1, "mm")], 4, 0)
    plan = make_axes_plan(
        [ParameterAxis("n", (1.0, 2.0), "rpm"), ParameterAxis("L", ("0.1", "2*r", "0.3"))], draws=draws
    )
    rows = [plan.find_values(number) for number in range(plan.size)]
    assert plan.size == 24 and [row["n"] for row in rows] == [(1.0, "rpm")] * 12 + [(2.0, "rpm")] * 12
    assert [row["d"] for row in rows] == [(d, "mm") for d in draws.values[:, 0]] * 6
    zipped = make_axes_plan(
        [ParameterAxis("n", ("1", "2")), ParameterAxis("L", ("3", "4"))], together=True, draws=draws
    )
    assert zipped.size == 8 and [zipped.find_values(k)["L"] for k in (0, 3, 4, 7)] == ["3", "3", "4", "4"]


def test_what_cannot_be_drawn_is_refused() -> None:
    with pytest.raises(AxisError, match="lhs and sobol in one sweep"):
        make_draws([law("x", "lhs", 0.0, 1.0), law("y", "sobol", 0.0, 1.0)], 8)
    with pytest.raises(AxisError, match="expected 2 or more"):
        make_draws([law("x", "lhs", 0.0, 1.0)], 1)
    with pytest.raises(AxisError, match="15,000,000 variants; at most 10,000,000"):
        make_draws([law("x", "uniform", 0.0, 1.0)], 5_000_000, indices=True)
    with pytest.raises(AxisError, match="expected 0 or more"):
        make_draws([law("x", "uniform", 0.0, 1.0)], 8, -1)


def test_a_sobol_sequence_that_is_cut_off_is_told() -> None:
    sobol = [law("x", "sobol", 0.0, 1.0)]
    assert make_imbalance_warning(sobol, 1024) == "" and make_imbalance_warning([law("x", "lhs", 0.0, 1.0)], 1000) == ""
    assert "512 and 1024" in make_imbalance_warning(sobol, 1000)
    assert len(make_draws(sobol, 1000).values) == 1000  # with no warning of SciPy's
