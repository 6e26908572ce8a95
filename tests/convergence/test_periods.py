"""A hundred periods of a pendulum and of a free top by every method that keeps to quaternions, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.method_rows import METHODS
from heuncli.base.tolerances import EPS
from heuncli.motion.integration.methods.method import load_method_by_name
from heuncli.results.results import Array
from tests.bench.long import KNOWN, Errors, errors, runner_of

RUNNERS = {name: runner_of(known) for name, known in KNOWN.items()}
SYMMETRIC = [row.name for row in METHODS if row.kind == "implicit" and row.steps == "fixed"]


def after(name: str, method: str, local: float) -> Errors:
    return errors(KNOWN[name], RUNNERS[name], load_method_by_name(method), local, 100)


def growth(off: Array) -> float:
    """By what power of the time something grows, from 20 to 100 periods."""
    return float(np.log(off[99] / off[19]) / np.log(5.0))


@pytest.mark.parametrize("name", KNOWN)
@pytest.mark.parametrize("method", ["DOPRI5", "DOP853", "Verner98"])
def test_phase_grows_with_the_square_of_the_time(name: str, method: str) -> None:
    """Each step loses a little energy, and what is lost shifts the period from then on."""
    found = after(name, method, 1e-7)
    assert growth(found.phase) == pytest.approx(2.0, abs=0.2)
    assert growth(found.energy) == pytest.approx(1.0, abs=0.2)


@pytest.mark.parametrize("name", KNOWN)
@pytest.mark.parametrize("method", SYMMETRIC)
def test_symmetric_methods_keep_the_energy(name: str, method: str) -> None:
    """After whole periods nothing is lost but rounding, two a step; the phase grows with the time only."""
    found = after(name, method, KNOWN[name].period / 40.0)
    assert found.energy.max() <= 2.0 * EPS * 100 * 40
    assert growth(found.phase) == pytest.approx(1.0, abs=0.1)
    assert found.momentum.max() <= 1.5 * found.momentum[:20].max()
