"""The errors of shares by cause: never below the true ones, at the asked instants and between; near singular poses too.

Shares may be much larger than what they add up to. The true error is that against a run at the least tolerance, or for
one instant what the pose's own rounding makes of them.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from heuncli.results.results import Array, Results
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve
from tests.shared.folders import SPECS
from tests.shared.scenes import study

WANTED = frozenset({"joints", "foundation", "sections", "shares"})
NAMES = ("crane_load", "engine", "double", "friction", "four_bar", "spatial_crank", "jib", "hammered_four_bar")
LOOSE = 1e-6
UNITS = {"force": "N", "moment": "N·m", "direct_force": "N", "direct_moment": "N·m"}
pytestmark = pytest.mark.heavy


@cache
def studied(name: str, tolerance: float) -> tuple[Study, Results]:
    """A spec's run by cause, and what it tells at instants between, too."""
    made = solve(load(str(SPECS / f"{name}.yaml")), Options(tolerance=tolerance, requested_reports=WANTED))
    times = made.history.times
    return made, made.compute_reports(np.unique(np.concatenate([times, np.linspace(times[0], times[-1], 101)])), WANTED)


def shares(found: Results) -> dict[tuple[str, str], list[Array]]:
    """All shares by kind of error and unit."""
    own: dict[tuple[str, str], list[Array]] = {}
    blocks: list[tuple[str, dict[str, Any]]] = [("foundation", found.foundation)]
    blocks += [("reactions", block) for block in found.joints.values()]
    blocks += [("sections", block) for block in found.sections.values()]
    for kind, block in blocks:
        for share in block["shares"].values():
            for name, unit in UNITS.items():
                if name in share:
                    own.setdefault((f"{kind} by cause", unit), []).append(share[name])
    return own


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.third
def test_never_below_the_true_error(name: str) -> None:
    made, told = studied(name, LOOSE)
    finest, exact = studied(name, 1e-13)
    errors = made.magnitudes.errors
    for kind, values in shares(told).items():
        apart = [np.nan_to_num(a - b) for a, b in zip(values, shares(exact)[kind], strict=True)]
        error = max(float(np.sqrt(np.sum(d * d, axis=-1)).max(initial=0.0)) for d in apart)
        scale = max(float(np.abs(np.nan_to_num(v)).max(initial=0.0)) for v in values)
        # beside a singular pose rounding reaches the finest run, too, by as much as it says itself
        assert errors[kind] + finest.magnitudes.errors[kind] >= error - 1e-12 * scale, kind


def knee(sag: float) -> Study:
    """Two bars almost in line between supports, pushed down in the middle and held by an opposite force.

    Each force alone makes P/(2 sag) along the bars; together they all but cancel.
    """
    points = f"{{a: [0, 0, 0], b: [2, 0, 0], m: [1, 0, {sag!r}]}}"
    return study(
        f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {points}}}
bodies:
  left: {{mass: 1, center: [0.5, 0, {sag / 2!r}], inertia: [0.1, 0.1, 0.1], points: {points}}}
  right: {{mass: 1, center: [1.5, 0, {sag / 2!r}], inertia: [0.1, 0.1, 0.1], points: {points}}}
joints:
  A: {{type: pin, from: ground.a, to: left.a, axis: [0, 1, 0]}}
  M: {{type: pin, from: left.m, to: right.m, axis: [0, 1, 0]}}
  B: {{type: pin, from: ground.b, to: right.b, axis: [0, 1, 0]}}
forces:
  down: {{type: force, on: left.m, vector: [0, 0, -1000]}}
  up: {{type: force, on: left.m, vector: [0, 0, 1000]}}
""",
        requested_reports=WANTED,
    )


@pytest.mark.parametrize("sag", [1e-2, 1e-4, 1e-5])
def test_shares_that_cancel_err_by_more_than_their_sum(sag: float) -> None:
    """The thrust of each force alone is P/(2 sag) on bars of length 1: the error stated is its own."""
    made = knee(sag)
    error = made.magnitudes.errors["reactions by cause", "N"]
    push, hold = (made.results.joints["A"]["shares"][name]["force"][0, 0] for name in ("down", "up"))
    rounding = 1e-15 * abs(push)  # of the last places told
    assert abs(push - 500.0 / sag) <= error + rounding
    assert abs(push + hold) <= 2.0 * error + rounding
    assert error <= 1e-12 / sag * abs(push)  # and it is no more than the pose makes of rounding, some digits of it
