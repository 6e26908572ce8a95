"""Supports that hold more than is free: a split by dropped rows or by least squares is one of infinitely many."""

from __future__ import annotations

import numpy as np
import pytest

from tests.limits.methods import Equations
from tests.oracle.published import bricard
from tests.shared.redundant_supports import door
from tests.shared.scenes import solved


def test_the_hinge_that_is_named_last_carries_nothing() -> None:
    """A door on two balls, dependent rows dropped: all 49.05 N in the one hinge or in the other, and not a word."""
    equations = Equations(door())
    order = list(range(len(equations.rows)))
    one, other = (equations.without(rows) for rows in (order, order[::-1]))
    assert [equations.force(one, name)[2] for name in ("top", "bottom")] == pytest.approx([49.05, 0.0], abs=1e-12)
    assert [equations.force(other, name)[2] for name in ("top", "bottom")] == pytest.approx([0.0, 49.05], abs=1e-12)
    with pytest.raises(np.linalg.LinAlgError):
        equations.by_cholesky()


def test_least_squares_depend_on_the_unit_of_length() -> None:
    """A beam clamped at one end and propped at the other, loaded at four fifths: the prop bears 6/10 or 8/10 of it.

    Least squares of forces and couples in N and N·m, or in N and N·mm, as the file's unit of length happens to be.
    """
    prop = []
    for metre in (1.0, 1000.0):
        J = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, metre]])  # the clamp's force and couple, the prop's force
        prop.append(np.linalg.lstsq(J.T, [1.0, 0.8 * metre], rcond=None)[0][2])
    assert prop == [pytest.approx(0.6, abs=1e-12), pytest.approx(0.8, abs=1e-6)]


def test_heun_leaves_the_door_open() -> None:
    """The sum is certain, the split is not a number: tests/closed_forms/test_redundant.py has the rest."""
    found = solved(door())
    assert np.isnan([found.joints[name]["force"][0, 2] for name in ("top", "bottom")]).all()
    (whole,) = (s for s in found.certain_sums if set(s["terms"]) == {"joints.top.force.z", "joints.bottom.force.z"})
    assert whole["value"][0] == pytest.approx(49.05, rel=1e-14)


def test_which_row_is_dropped_decides_what_bricard_s_hinge_carries() -> None:
    """A04: 30 conditions of which 29 do. Each of the 30 may be the one that is dropped; the count says 0 freedoms.

    P0's Fx then lies anywhere from −33 to +14 N. Fx − Fy is the same by all of them: it is certain, and heun's.
    """
    equations = Equations(bricard())
    rows = list(range(len(equations.rows)))
    assert len(rows) == 30 and np.linalg.matrix_rank(equations.J, 1e-9) == 29
    splits = [equations.without([k for k in rows if k != last] + [last]) for last in rows]
    force = np.array([equations.force(found, "P0") for found in splits])
    assert force[:, 0].min() == pytest.approx(-33.023, abs=1e-3)
    assert force[:, 0].max() == pytest.approx(14.069, abs=1e-3)
    assert np.ptp(force[:, 0] - force[:, 1]) < 1e-9
    assert force[0, 0] - force[0, 1] == pytest.approx(-33.023084, abs=1e-6)
    with pytest.raises(np.linalg.LinAlgError):
        equations.by_cholesky()


def test_heun_counts_bricard_s_freedom_and_leaves_its_hinges_open() -> None:
    """Motion and the ground's total to the digits published: tests/references/test_bricard.py."""
    found = solved(bricard())
    assert (found.model["freedoms"], found.model["redundant"], found.model["grubler"]) == (1, 1, 0)
    assert np.isnan([found.joints[f"P{k}"]["force"][0] for k in range(6)]).all()
    certain = [s for s in found.certain_sums if all(".force." in name for name in s["terms"])]
    assert len([s for s in certain if not any(np.ndim(f) for f in s["terms"].values())]) >= 15
