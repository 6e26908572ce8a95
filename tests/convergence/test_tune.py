"""The search of `heun tune` on functions: kinks, valleys, jumps, noise, constraints, and what cannot be solved."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np
import pytest

from heuncli.analyses.tune.results import TuneGoal, TuneResults, TuneTask
from heuncli.analyses.tune.study import Tuning
from heuncli.analyses.tune.trials import Trials
from heuncli.analyses.variants.conditions import Comparison
from heuncli.analyses.variants.measures import TIME_LIMIT_CODE, MeasureValue, VariantResult
from heuncli.analyses.variants.parameters import DesignVariable, Values
from heuncli.results.results import Array

Function = Callable[[Array], float]
SLOPES = np.array([[1.0, 3.0], [-1.0, 2.0], [0.3, -2.5], [1.0, 0.0], [-1.0, 0.0]])


def tuned(
    goal: Function,
    constraints: Sequence[Function] = (),
    *,
    n: int = 2,
    most: int = 600,
    error: float | None = None,
    unsolvable: Callable[[Array], bool] = lambda x: False,
    time_for: float = math.inf,
    greatest: bool = False,
    seed: int = 0,
) -> TuneResults:
    """What is found of a function over the unit box, whose constraints are to be 0 or less."""
    variables = tuple(DesignVariable(f"x{i}", 0.0, 1.0, "") for i in range(n))
    limits = tuple(Comparison(f"c{i}", "<=", 0.0, "") for i in range(len(constraints)))
    task = TuneTask(variables, TuneGoal("f", "", greatest), limits, max_variants=most, seed=seed)
    solved: list[Values] = []

    def answers(several: Sequence[Values]) -> Iterator[VariantResult]:
        for values in several:
            if len(solved) >= time_for:
                yield VariantResult(code=TIME_LIMIT_CODE)
                return
            assert values not in solved  # nothing is solved twice
            solved.append(values)
            x = np.array([one.value for one in values.values() if not isinstance(one, str)])
            if unsolvable(x):
                yield VariantResult(code="does-not-close", reason="it does not close")
            else:
                yield VariantResult((MeasureValue(goal(x), error), *(MeasureValue(c(x)) for c in constraints)))

    tuning = Tuning(Trials(task, answers, lambda done, of, what: None), VariantResult())
    tuning.run()
    found = tuning.make_results()
    assert len(found.history) == len(solved) <= most
    assert [trial.number for trial in found.history] == [*range(1, len(solved) + 1)]
    return found


def best_of(found: TuneResults) -> float:
    assert found.best is not None
    return found.best.goal


def kinked(x: Array) -> float:
    """The largest of some planes: 5 at (0.37, 0.61), and more everywhere else."""
    return float((SLOPES @ (x - [0.37, 0.61])).max()) + 5.0


def bowl(x: Array) -> float:
    return float(((x - 0.3) ** 2 * np.arange(1, len(x) + 1)).sum()) + 1.0


def spread(f: Function, n: int = 2) -> float:
    """What a function ranges over in the box, about."""
    values = [f(x) for x in np.random.default_rng(3).random((200, n))]
    return float(np.median(values) - min(values))


@pytest.mark.parametrize("seed", range(4))
def test_a_kink_in_two_variables(seed: int) -> None:
    found = tuned(kinked, seed=seed, most=1000)
    assert found.ending == "converged" and found.gain is not None
    assert found.gain <= found.floor <= 2e-6 * spread(kinked)
    assert 0.0 <= best_of(found) - 5.0 <= 10.0 * found.floor
    for range_, rises in zip(found.tolerance_ranges, ((1.0, 1.0), (2.5, 3.0)), strict=True):
        for move, rise in zip(range_.hundredth_moves, rises, strict=True):
            assert move is not None and move.limit == "worse"
            assert 0.8 * 0.05 / rise - 1e-4 <= move.distance <= 0.05 / rise + 1e-4


@pytest.mark.parametrize("greatest", [False, True])
def test_a_smooth_bowl_whichever_way_up(greatest: bool) -> None:
    found = tuned(lambda x: -bowl(x) if greatest else bowl(x), error=1e-9, greatest=greatest)
    assert found.ending == "converged" and abs(abs(best_of(found)) - 1.0) <= found.floor
    for range_, curvature in zip(found.tolerance_ranges, (1.0, 2.0), strict=True):
        for move in range_.hundredth_moves:  # 1 % of 1: curvature s² = 0.01
            assert move is not None and move.distance == pytest.approx(math.sqrt(0.01 / curvature), rel=0.15)
        for move in range_.floor_moves:
            assert move is not None and move.distance == pytest.approx(math.sqrt(found.floor / curvature), rel=0.5)


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_several_variables(n: int) -> None:
    found = tuned(bowl, n=n, most=200 * (n + 1))
    assert found.ending == "converged" and best_of(found) - 1.0 <= found.floor


def test_two_valleys() -> None:
    """The lower of two is found, though the other one is wider; both were looked at."""
    found = tuned(lambda x: float(min(((x - 0.2) ** 2).sum(), 2.0 * ((x - 0.85) ** 2).sum() - 0.05)))
    assert found.ending == "converged" and best_of(found) == pytest.approx(-0.05, abs=1e-6)


def test_a_boundary_with_a_closed_form() -> None:
    """x + 2y is least where xy = 0.2 at x = sqrt(0.4), y = x/2."""
    found = tuned(lambda x: float(x[0] + 2.0 * x[1]), [lambda x: float(0.2 - x[0] * x[1])])
    assert found.ending == "converged" and found.is_feasible and found.active_constraints == (True,)
    assert 0.0 <= best_of(found) - 2.0 * math.sqrt(0.4) <= 2.0 * found.floor
    assert found.best is not None and found.best.place == pytest.approx((math.sqrt(0.4), math.sqrt(0.1)), abs=2e-3)
    down, up = found.tolerance_ranges[0].hundredth_moves
    assert down is not None and down.limit == "c0" and up is not None and up.limit == "worse"


def test_a_corner_of_two_constraints_and_one_that_does_nothing() -> None:
    constraints = [
        lambda x: float(0.2 - x[0] * x[1]),
        lambda x: float(x[1] - 0.25),
        lambda x: float(x.sum() - 1.9),
    ]
    found = tuned(lambda x: float(x[0] + 2.0 * x[1]), constraints)
    assert found.ending == "converged" and found.active_constraints == (True, True, False)
    assert 0.0 <= best_of(found) - 1.3 <= 2.0 * found.floor


def test_bounds_that_hold_it() -> None:
    found = tuned(lambda x: float(x[0] - 3.0 * x[1]))
    assert found.ending == "converged" and best_of(found) == -3.0
    assert (found.find_bound(0), found.find_bound(1)) == ("low", "high")
    assert found.tolerance_ranges[0].hundredth_moves[0] is not None
    assert (
        found.tolerance_ranges[0].hundredth_moves[0].limit == "bound"
        and found.tolerance_ranges[0].hundredth_moves[0].distance == 0.0
    )


def test_half_of_the_box_cannot_be_solved() -> None:
    """The best lies where the other half begins."""
    found = tuned(kinked, unsolvable=lambda x: bool(x[0] < 0.5))
    ys = np.linspace(0.4, 0.8, 40001)
    edge = min(kinked(np.array([0.5, y])) for y in ys)
    assert found.ending == "converged" and abs(best_of(found) - edge) <= 1e-4
    assert found.failures["does-not-close"] > 10 and found.best is not None and found.best.place[0] >= 0.5
    down = found.tolerance_ranges[0].hundredth_moves[0]
    assert down is not None and down.limit == "does-not-close"


def test_a_jump() -> None:
    """The best lies beside a jump, and its moves say so."""
    found = tuned(lambda x: float((x[0] - 0.3) ** 2 + (x[1] - 0.6) ** 2 + (5.0 if x[0] > 0.25 else 0.0)) + 1.0)
    assert found.ending == "converged" and best_of(found) == pytest.approx(1.0025, abs=1e-5)
    up = found.tolerance_ranges[0].hundredth_moves[1]
    assert up is not None and up.distance < 1e-6 and up.limit == "jump"


@pytest.mark.parametrize("noise", [1e-3, 1e-5])
def test_noise_ends_the_search(noise: float) -> None:
    """No finer than the stated error, with fewer variants; and no worse than some errors."""

    def rough(x: Array) -> float:
        return bowl(x) + noise * math.sin(1e7 * float(x @ [1.0, 1.7]))

    found, exact = tuned(rough, error=2.0 * noise), tuned(bowl)
    assert found.ending == "converged" and found.floor == 2.0 * noise
    assert best_of(found) - 1.0 <= 4.0 * noise
    assert len(found.history) < 1.2 * len(exact.history)


def test_a_flat_valley() -> None:
    """Where one variable does nothing, it may move from bound to bound."""
    found = tuned(lambda x: float((x[0] - 0.4) ** 2) + 1.0)
    assert found.ending == "converged" and best_of(found) - 1.0 <= found.floor
    assert [move.limit for move in found.tolerance_ranges[1].hundredth_moves if move is not None] == ["bound", "bound"]
    assert found.best is not None
    assert [move.distance for move in found.tolerance_ranges[1].hundredth_moves if move is not None] == pytest.approx(
        [found.best.place[1], 1.0 - found.best.place[1]]
    )


def test_nothing_differs_anywhere() -> None:
    found = tuned(lambda x: 7.0)
    assert found.ending == "converged" and best_of(found) == 7.0


def test_nothing_feasible() -> None:
    """What passes the constraints least is told, and which of them is nearest."""
    found = tuned(bowl, [lambda x: float(x[0] - 0.4), lambda x: float(0.6 - x[0])])
    assert found.ending == "infeasible" and not found.is_feasible and found.best is not None
    assert 0.4 - 1e-3 <= found.best.place[0] <= 0.6 + 1e-3
    over = [max(value, 0.0) for value in found.best.constraint_values]
    assert sum(over) == pytest.approx(0.2, abs=1e-3) and found.nearest_violated in (0, 1)
    assert found.tolerance_ranges == () and found.active_constraints == (False, False)


def test_a_narrow_feasible_strip() -> None:
    found = tuned(bowl, [lambda x: abs(float(x[0] - x[1]) - 0.1) - 0.002])
    assert found.ending == "converged" and found.is_feasible and found.active_constraints == (True,)
    assert best_of(found) - 1.0 == pytest.approx(0.098**2 * 2.0 / 3.0, rel=1e-2)  # of weights 1 and 2


@pytest.mark.parametrize("most", [1, 5, 11, 60, 150])
def test_the_budget_is_kept_and_its_end_is_said(most: int) -> None:
    found = tuned(kinked, most=most)
    assert len(found.history) == most and found.ending == "evaluations" and found.gain is None
    assert best_of(found) == min(trial.goal for trial in found.history)


def test_the_end_of_the_time() -> None:
    found = tuned(kinked, time_for=70)
    assert len(found.history) == 70 and found.ending == "time"
    assert tuned(kinked, time_for=5).ending == "time"


def test_nothing_can_be_solved() -> None:
    found = tuned(bowl, unsolvable=lambda x: True)
    assert found.best is None and found.ending == "infeasible"
    assert found.failures == {"does-not-close": len(found.history)}


def test_the_same_seed_the_same_variants() -> None:
    first, again, other = tuned(kinked), tuned(kinked), tuned(kinked, seed=1)
    assert first.history == again.history
    assert [trial.place for trial in first.history] != [trial.place for trial in other.history]


@pytest.mark.parametrize(("low", "high"), [(0.0, 3.0), (1000.0, 1000.001), (-5e-9, 5e-9), (0.0, 1e9)])
def test_values_are_told_as_they_are_solved(low: float, high: float) -> None:
    """In few digits beside the width of the interval, both bounds exactly."""
    variable = DesignVariable("x", low, high, "kg")
    assert (variable.to_number(0.0), variable.to_number(1.0)) == (low, high)
    for place in np.random.default_rng(0).random(50):
        value = variable.to_number(float(place))
        assert low <= value <= high and abs(value - (low + place * (high - low))) <= 1e-9 * (high - low) + 1e-12 * high
        assert float(variable.to_value(float(place)).format().removesuffix(" kg")) == value
