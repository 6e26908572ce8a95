"""A04, Bricard's mechanism: six hinges hold 30 times what 29 conditions do; motion and the ground's total are certain.

The table is good to the digits printed. Its P3 is the hinge at (1, -1, 0); its forces and moments are those of the
ground ON the mechanism.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from heuncli.study.ask.study import Study
from tests.oracle.published import bricard
from tests.oracle.read import model
from tests.oracle.solve import Solution, solve
from tests.shared.scenes import instants, moving, near, study, terms_at

TABLE = {  # t: place of the hinge, crank's rate and acceleration, force and moment of the ground about P0
    0.0: ((1, -1, 0), 0, 1.9580838, (-1.958084, 47.091916, -7.832335), (-17.338832, 5.228084, 26.16)),
    0.2: ((0.961349551, -0.999281403, -0.037903521), 0.396422914, 2.0272194,
          (-2.27882, 47.635786, -7.21851), (-16.707543, 4.745592, 25.963624)),
    0.4: ((0.851450939, -0.990499594, -0.13751565), 0.815243721, 2.1592123,
          (-3.374988, 48.639107, -5.402596), (-14.499113, 3.383285, 24.706779)),
    0.6: ((0.686986932, -0.96451598, -0.264024477), 1.254304362, 2.2053331,
          (-5.347014, 49.260106, -2.421033), (-10.73654, 1.550119, 21.223546)),
    0.8: ((0.488999685, -0.924805747, -0.380439654), 1.682366997, 2.0241771,
          (-7.350312, 49.596769, 2.065731), (-6.93752, -0.079242, 15.21986)),
    1.0: ((0.274481319, -0.886707939, -0.462330003), 2.036415381, 1.4298729,
          (-6.849902, 50.064398, 7.983521), (-5.115354, -0.800785, 7.957687)),
    1.2: ((0.053329821, -0.866844861, -0.498577965), 2.218276932, 0.3145747,
          (-1.698445, 50.460887, 12.190371), (-5.093614, -0.250339, 1.423421)),
    5.0: ((0.999932742, -0.999999998, -0.0000672554), 0.016229915, 1.9582155,
          (-1.958611, 47.09297, -7.831282), (-17.337819, 5.22725, 26.15978)),
    9.99: ((0.9999576506, -0.9999999991, -0.0000423485), 0.012878446, 1.9581667, None, None),
}  # fmt: skip
TIMES = tuple(TABLE)
HINGES = [f"P{k}" for k in range(6)]
AXES = "yzxyzx"


@cache
def run(least_norm: bool = False) -> Study:
    scene = bricard()
    scene["bodies"]["rod2"]["points"] = {"P3": [1, -1, 0]}
    return study(moving(scene, TIMES, 1e-11), least_norm=least_norm)


@cache
def oracle() -> list[Solution]:
    read = model(bricard())
    return [solve(read, state, t) for _, t, state in instants(run().results)]


@pytest.mark.heavy
@pytest.mark.parametrize("t", TIMES)
def test_motion_and_the_ground(t: float) -> None:
    found, k = run().results, TIMES.index(t)
    place, rate, acceleration, force, moment = TABLE[t]
    crank = found.bodies["rod1"]
    near(found.points["rod2.P3"]["position"][k], place, 1.0, 6e-10)
    near(crank["angular_velocity"][k, 1], rate, 1.0, 6e-10)
    near(crank["angular_acceleration"][k, 1], acceleration, 1.0, 6e-8)
    if force is not None:
        near(-found.foundation["force"][k], force, 1.0, 1e-6)  # five to six decimals are printed
        near(-found.foundation["moment"][k], moment, 1.0, 1e-6)


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
