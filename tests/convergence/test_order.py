"""The order a method claims, measured: its tableau with fixed steps, and the program's own runs."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from heuncli.integration.methods.method import Method, Row
from heuncli.integration.methods.registry import method_of
from heuncli.method_rows import METHODS as ROWS
from heuncli.results import Array
from tests.closed_forms.test_theory_2j_motion import heavy_top
from tests.shared.bars import chain, double, rods
from tests.shared.scenes import study

METHODS = [method_of(row.name) for row in ROWS]


def slope_of_pendulum(t: float, y: Array) -> Array:
    """A pushed pendulum: smooth, not linear, and it knows the time."""
    return np.array([y[1], -np.sin(y[0]) + 0.3 * np.cos(1.7 * t)])


def combined(row: Row, K: list[Array]) -> Array:
    return np.sum([c * K[stage] for stage, c in row], axis=0)


def fixed_steps(method: Method, count: int, until: float = 3.0) -> tuple[Array, Callable[[float], Array]]:
    """The state at the end, and the dense output of the last step by its fraction."""
    y, h = np.array([1.0, 0.5]), until / count
    for n in range(count):
        t, K = n * h, [slope_of_pendulum(n * h, y)]
        for row, node in zip(method.stages, method.nodes[1:], strict=False):
            K.append(slope_of_pendulum(t + node * h, y + h * combined(row, K)))
        end = y + h * combined(method.solution, K)
        K.append(slope_of_pendulum(t + h, end))
        for row, node in zip(method.extra, method.nodes[len(method.stages) + 2:], strict=True):
            K.append(slope_of_pendulum(t + node * h, y + h * combined(row, K)))
        start, y = y, end
    # Hairer, Norsett, Wanner, Solving ODEs I, II.6: alternately x and 1 - x are multiplied in
    q = y - start
    F = [q, h * K[0] - q, 2 * q - h * (K[len(method.stages) + 1] + K[0])]
    F += [h * combined(row, K) for row in method.dense]

    def dense(x: float) -> Array:
        total = np.zeros(2)
        for k, part in reversed(list(enumerate(F))):
            total = (total + part) * (x if k % 2 == 0 else 1.0 - x)
        return start + total

    return y, dense


def fitted(counts: Array, errors: Array) -> float:
    """The slope of log error over log count."""
    return -float(np.polyfit(np.log(counts), np.log(errors), 1)[0])


@pytest.mark.parametrize("method", METHODS, ids=lambda m: m.name)
def test_order_with_fixed_steps(method: Method) -> None:
    """The error at the end falls with the order claimed, steps 0.3 to 0.15."""
    counts = np.array([10, 12, 14, 17, 20])
    exact = fixed_steps(method, 240)[0]
    errors = np.array([np.abs(fixed_steps(method, n)[0] - exact).max() for n in counts])
    assert errors.min() > 1e-13  # above rounding, else the slope means nothing
    assert fitted(counts, errors) == pytest.approx(method.order, abs=0.5)


@pytest.mark.parametrize("method", METHODS, ids=lambda m: m.name)
def test_order_of_the_dense_output(method: Method) -> None:
    """Between the ends of a step the error falls at least as fast as one order below the method's."""
    counts = np.array([10, 12, 15, 18, 21])
    errors = []
    for n in counts.tolist():
        step = 3.0 / n
        inside = fixed_steps(method, n)[1]
        worst = 0.0
        for x in (0.3, 0.5, 0.8):
            end = 3.0 - (1.0 - x) * step
            worst = max(worst, float(np.abs(inside(x) - fixed_steps(method, 240, end)[0]).max()))
        errors.append(worst)
    assert min(errors) > 1e-13
    assert fitted(counts, np.array(errors)) > method.order - 1.5


RUNS = {
    "double": double("{times: [2]}"), "chain5": chain(5, "{times: [1]}"), "heavy top": heavy_top(8, "60 deg", "[4]"),
    "two rods": rods([2.5, 2.5], [0.0, 0.0], "{times: [2]}"),
}  # fmt: skip


@pytest.mark.heavy
@pytest.mark.parametrize("name", RUNS)
@pytest.mark.parametrize("dense", [False, True], ids=["end", "asked instants"])
def test_order_of_runs(name: str, dense: bool) -> None:
    """Over eight decades of local tolerance: error ~ steps^-order, and error ~ tolerance."""
    s = study(RUNS[name])
    end = float(s.history.times[-1])
    times = np.linspace(0.0, end, 101) if dense else np.array([end])

    def centres(tolerance: float) -> tuple[Array, int]:
        run = s.setup.runner.trajectory(times, tolerance)
        found = s.setup.runner.recovered(run.times, run.states)
        return np.concatenate([found.bodies["R"].reshape(*found.bodies.shape, 9), found.bodies["r"]], axis=2), run.steps

    exact, _ = centres(1e-15)
    tolerances = 10.0 ** -np.arange(3.0, 11.5, 0.25)
    runs = [centres(tol) for tol in tolerances]
    errors = np.array([np.abs(x - exact).max() for x, _ in runs])
    steps = np.array([n for _, n in runs])
    assert fitted(steps, errors) == pytest.approx(9.0, abs=1.2)  # 8, and fewer steps are wasted when they are small
    assert fitted(1.0 / tolerances, errors) == pytest.approx(1.0, abs=0.2)
