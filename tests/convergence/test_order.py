"""The order a method claims, measured: one test over the registry by the program's own runs, and of the tableaus.

Any method goes in given steps if it is told so; a row that joins the registry is measured like the others.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.base.method_rows import METHODS
from heuncli.base.records import replace
from heuncli.motion.integration.methods.method import Method, Row, load_method_by_name
from heuncli.motion.integration.run.request import MotionTask
from heuncli.motion.integration.run.runner import Runner
from heuncli.results.results import Array
from tests.shared.bars import chain, double, rods
from tests.shared.scenes import study
from tests.shared.slopes import fitted
from tests.shared.tops import heavy_top

NAMES = [row.name for row in METHODS if row.kind != "SciPy"]  # what SciPy integrates takes no given steps
TABLEAUS = [row.name for row in METHODS if row.kind == "explicit" and row.attitude == "quaternion"]
SCENE = double("{times: [1]}")  # balls in space, which turn by a radian in the first half second
COUNTS = np.array([2, 3, 4, 5, 6, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48, 64, 96, 128, 256])
ROUNDED, COARSE = 1e-12, 0.1  # m: below, rounding shows; above, the error is not yet that of small steps
POINTS = 4  # the finest of those between


def centres(runner: Runner, times: Array, states: Array) -> Array:
    """Attitudes and places of all bodies."""
    found = runner.evaluate(times, states)
    return np.concatenate([found.bodies["R"].reshape(*found.bodies.shape, 9), found.bodies["r"]], axis=2)


def measured(name: str, end: float, at: Array) -> tuple[Array, Array]:
    """Numbers of steps, and the largest error at some instants, parts of the last step: where it tells the order."""
    runner = study(SCENE).setup.runner
    method = replace(load_method_by_name(name), has_fixed_step=True)
    counts, errors = [], []
    for n in COUNTS.tolist():
        times = end - (1.0 - at) * (end / n)
        exact = runner.run(MotionTask(times, 1e-15))
        try:
            run = runner.run(MotionTask(times, end / n, method=method))
        except SolveError as refused:  # Newton's iteration for the stages of too long a step
            assert refused.problems[0].code == "stages-unsolved"
            continue
        assert run.steps == n
        error = float(np.abs(centres(runner, times, run.states) - centres(runner, times, exact.states)).max())
        if error < ROUNDED:
            break
        if error < COARSE:
            counts.append(n)
            errors.append(error)
    return np.array(counts[-POINTS:]), np.array(errors[-POINTS:])


@pytest.mark.heavy
@pytest.mark.parametrize("name", NAMES)
def test_order_in_given_steps(name: str) -> None:
    """The error at the end falls with the order claimed."""
    counts, errors = measured(name, 0.3, np.array([1.0]))
    assert len(counts) == POINTS
    order = next(row.order for row in METHODS if row.name == name)
    assert load_method_by_name(name).order == order
    assert fitted(counts, errors) == pytest.approx(order, abs=0.5)


@pytest.mark.heavy
@pytest.mark.parametrize("name", NAMES)
def test_order_between_the_ends_of_steps(name: str) -> None:
    """There the error falls at least as fast as one order below the method's; that of stages with one more than they.

    (The error of stages is what judges adaptive steps of implicit methods.)
    """
    counts, errors = measured(name, 0.5, np.array([0.3, 0.5, 0.8]))
    assert len(counts) == POINTS
    method = load_method_by_name(name)
    by_stages = method.implicit and not method.by_step
    assert fitted(counts, errors) > (len(method.stages) + 1 if by_stages else method.order) - 1.5


# ---- tableaus: what their rows must fulfil, to the rounding of their numbers


def total(row: Row, nodes: tuple[float, ...], power: int) -> float:
    """Sum of a row's coefficients times a power of the nodes, exactly; the end of the step is a node, too."""
    return float(sum(Fraction(c) * Fraction(nodes[stage]) ** power for stage, c in row))


def nodes_of(method: Method) -> tuple[float, ...]:
    """The nodes of all stages, with that of the derivative at the end."""
    count = len(method.stages) + 1
    return (*method.nodes[:count], 1.0, *method.nodes[count + 1 :])


@pytest.mark.parametrize("name", TABLEAUS)
def test_rows_add_up_to_their_nodes(name: str) -> None:
    """For y' = 1 every stage is where it says."""
    method = load_method_by_name(name)
    rows = [*zip(method.stages, method.nodes[1:], strict=False)]
    rows += zip(method.extra, method.nodes[len(method.stages) + 2 :], strict=True)
    for row, node in rows:
        size = sum(abs(c) for _, c in row)
        assert total(row, (0.0,) * 99, 0) == pytest.approx(node, abs=4e-16 * max(size, 1.0))


@pytest.mark.parametrize("name", TABLEAUS)
def test_the_solution_is_a_quadrature_of_its_order(name: str) -> None:
    """For y' = t^k, k < order: the integral; and the estimates see nothing of it as far as their own order goes."""
    method = load_method_by_name(name)
    nodes = nodes_of(method)
    for k in range(method.order):
        assert total(method.solution, nodes, k) == pytest.approx(1.0 / (k + 1), abs=2e-15)
    for row in method.estimates[-1:]:
        size = sum(abs(c) for _, c in row)
        for k in range(method.error_order - 1 if len(method.estimates) == 1 else 5):
            assert total(row, nodes, k) == pytest.approx(0.0, abs=1e-15 * size)


@pytest.mark.parametrize("name", TABLEAUS)
@pytest.mark.parametrize("x", [0.2, 0.5, 0.9])
def test_the_dense_output_is_a_quadrature_of_one_order_less(name: str, x: float) -> None:
    """For y' = t^k the interpolating polynomial is x^(k+1) / (k+1), as far as its order goes."""
    method = load_method_by_name(name)
    nodes, end = nodes_of(method), len(method.stages) + 1
    order = min(method.order, max(3, method.order - 1))
    for k in range(order):
        change = total(method.solution, nodes, k)
        first, last = float(k == 0), nodes[end] ** k
        F = [change, first - change, 2.0 * change - last - first, *(total(row, nodes, k) for row in method.dense)]
        value = 0.0
        for i, part in reversed(list(enumerate(F))):
            value = (value + part) * (x if i % 2 == 0 else 1.0 - x)
        assert value == pytest.approx(x ** (k + 1) / (k + 1), abs=1e-12)


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

    def run_to(tolerance: float) -> tuple[Array, int]:
        run = s.setup.runner.run(MotionTask(times, tolerance))
        return centres(s.setup.runner, run.times, run.states), run.steps

    exact, _ = run_to(1e-15)
    tolerances = 10.0 ** -np.arange(3.0, 11.5, 0.25)
    runs = [run_to(tol) for tol in tolerances]
    errors = np.array([np.abs(x - exact).max() for x, _ in runs])
    steps = np.array([n for _, n in runs])
    assert fitted(steps, errors) == pytest.approx(9.0, abs=1.2)  # 8, and fewer steps are wasted when they are small
    assert fitted(1.0 / tolerances, errors) == pytest.approx(1.0, abs=0.2)
