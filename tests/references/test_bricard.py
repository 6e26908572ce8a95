"""A04, Bricard's mechanism: six hinges hold 30 times what 29 conditions do: which loads are certain, which open.

Its motion and the total on the ground are compared with numbers in tests/references/test_published.py.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from heuncli.study.queries.study import Study
from tests.oracle.published import bricard
from tests.oracle.read import model
from tests.oracle.solve import Solution, solve
from tests.shared.scenes import instants, moving, near, study, terms_at

pytestmark = pytest.mark.heavy  # nearly singular all the way, of a tolerance of 1e-11; random loops pass the same lines
TIMES = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 5.0, 9.99)
HINGES = [f"P{k}" for k in range(6)]
AXES = "yzxyzx"


@cache
def run(least_norm: bool = False) -> Study:
    return study(moving(bricard(), TIMES, 1e-11), least_norm=least_norm)


@cache
def oracle() -> list[Solution]:
    read = model(bricard())
    return [solve(read, state, t) for _, t, state in instants(run().results)]


def test_counts() -> None:
    found = run().results.model
    assert (found["freedoms"], found["redundant"], found["grubler"], found["loops"]) == (1, 1, 0, 1)


@pytest.mark.parametrize("name", HINGES)
def test_open_components(name: str) -> None:
    """The one self-stress loads every hinge at every instant, but for couples about axes that stay where they are."""
    block, own = run().results.joints[name], AXES[int(name[1])]
    still = {f"moment.{own}"} if name in ("P0", "P2", "P3", "P5") else set()
    every = {f"{part}.{c}" for part in ("force", "moment") for c in "xyz"}
    assert {n for n in block["open"] if "." in n} == every - still
    for k, solution in enumerate(oracle()):
        unique = solution.reactions[name].unique
        got = np.concatenate([block["force"][k], block["moment"][k]])
        assert (~np.isnan(got)).tolist() == unique[:6].tolist()


@pytest.mark.heavy
def test_neighbouring_hinges_carry_the_same_forces() -> None:
    """Fifteen equalities of components: what lies between two hinges is weight and inertia, which are certain."""
    forces = [s for s in run().results.certain_sums if all(".force." in n for n in s["terms"])]
    pairs = [s for s in forces if not any(np.ndim(factor) for factor in s["terms"].values())]
    assert len(pairs) == 15
    for s in pairs:
        (first, one), (second, other) = s["terms"].items()
        assert first[-1] == second[-1] and abs(one) == abs(other) == 1.0
        assert (one == other) == ("P5" in second)  # the last hinge is told the other way round, from the ground


def test_across_the_self_stress_a_hinge_carries_what_is_certain() -> None:
    """Two directions of the first hinge's force, that turn with the mechanism: across (1, 1, 1) at the start."""
    turning = [s for s in run().results.certain_sums if any(np.ndim(factor) for factor in s["terms"].values())]
    across = [s for s in turning if all(".force." in n for n in s["terms"])]
    assert [list(s["terms"]) for s in across] == [[f"joints.P0.force.{c}" for c in two] for two in ("xy", "xz")]
    for s in across:
        c = np.stack(list(s["terms"].values()), axis=1)
        near(np.linalg.norm(c, axis=1), 1.0, 1.0, 1e-12)
        near(c[0], np.sqrt(0.5) * np.array([1, -1]), 1.0, 1e-12)
        assert np.abs(c - c[0]).max() > 0.1
        assert np.all(np.sum(c[1:] * c[:-1], axis=1) > 0.0)
    xy, xz = (s["value"][0] * np.sqrt(2.0) for s in across)
    near([xy, xz - xy], [-33.023084, 31.711168], 1.0, 1e-6)


def test_certain_sums_are_certain() -> None:
    """Every listed sum, at every instant, by the oracle's self-stress; its single terms are not."""
    found = run().results
    for k, solution in enumerate(oracle()):
        for s in found.certain_sums:
            terms = terms_at(s["terms"], k)
            value, certain = solution.sum(terms)
            assert certain
            near(s["value"][k], value, 100.0, 1e-10)
            if k > 0:  # at the start some couples are without a share, by accident of the pose
                assert not any(solution.sum({name: 1.0})[1] for name in s["terms"])


@pytest.mark.heavy
def test_differences_at_the_start() -> None:
    """At t = 0 the self-stress is (1, 1, 1) in every hinge: differences of components are certain in any split."""
    P0 = run(least_norm=True).results.joints["P0"]["force"][0]
    near([P0[0] - P0[1], P0[1] - P0[2]], [-33.023084, 31.711168], 1.0, 1e-6)
    assert {"force.x", "force.y", "force.z"} <= set(run(least_norm=True).results.joints["P0"]["chosen"])


def test_accuracy() -> None:
    found = run().results.accuracy
    assert found["constraint_gap"] <= 1e-14
    assert found["energy_drift"] <= 1e-9
    assert found["estimate"]["motion"] <= 1e-10
