"""The ceiling by which most intervals of a search are passed over never lies below what one of them promises."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.study.search.intervals import FOURTH_DERIVATIVE_SHARE, bound_heights, bound_heights_cheaply


@pytest.mark.parametrize("seed", range(4))
def test_no_promise_is_passed_over(seed: int) -> None:
    """Over heights and bends of all sizes, numbers that are none among them, bends that agree and that do not."""
    rng = np.random.default_rng(seed)
    b, c, left, right, up, down = rng.normal(size=(6, 100_000)) * 10.0 ** rng.uniform(-6.0, 6.0, (6, 100_000))
    same = rng.random(100_000) < 0.3
    right, c = np.where(same, left, right), np.where(rng.random(100_000) < 0.2, b, c)
    up, down = (np.where(rng.random(100_000) < 0.1, np.nan, x) for x in (up, down))
    most = np.maximum(np.abs(left), np.abs(right))
    promise = bound_heights(b, c, left, right, FOURTH_DERIVATIVE_SHARE * most, up, down)
    known = np.isfinite(promise)
    assert known.mean() > 0.9
    assert (bound_heights_cheaply(b, c, most, up, down)[known] >= promise[known]).all()
    assert (bound_heights_cheaply(b, c, 0.5 * most, up, down)[known] < promise[known]).any()
