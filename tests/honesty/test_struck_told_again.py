"""Random machines that are struck say the same told otherwise: struck_told_again.py beside it."""

from __future__ import annotations

import numpy as np
import pytest

from tests.honesty.struck_told_again import FACTOR, RIGHT, all_of, answer, judged, scene
from tests.shared.rest_told_again import TELLINGS

# The blow comes where the condition that is watched passes and turns the motion back: rounding leaves it true for a
# moment, or not.
ON_THE_EDGE = (41, 43, 81, 162)
WAYS = list(TELLINGS)


@pytest.mark.heavy
@pytest.mark.parametrize("seed", [*range(21), *ON_THE_EDGE])
@pytest.mark.sixth
def test_it_is_struck_as_told_before(seed: int) -> None:
    """As many blows, and all numbers of them and of the motion within what both tellings state."""
    way = WAYS[seed % len(WAYS)]
    what, ratio, more, *_ = judged(seed, way)
    assert what in RIGHT, (way, what, ratio, more)


@pytest.mark.heavy
def test_a_weaker_blow_is_seen() -> None:
    """By a millionth."""
    tree = scene(0)
    told = TELLINGS["turned"](tree, np.random.default_rng(0), None)  # type: ignore[arg-type]
    blows = {k: {**b, "vector": [(1.0 + 1e-6) * x for x in b["vector"]]} for k, b in told.tree["impulses"].items()}
    first, second = answer(tree), answer({**told.tree, "impulses": blows})
    assert not isinstance(first, str)
    assert not isinstance(second, str)
    assert max(d.ratio for d in all_of(first, second, told)) > FACTOR
