"""Small oscillations of random scenes told otherwise agree within their errors: modes_told_again.py beside it."""

from __future__ import annotations

import numpy as np
import pytest

from tests.honesty.modes_told_again import INDIFFERENT, RIGHT, WAYS, agree, answer, judged, scene
from tests.shared.rest_scenes import KINDS
from tests.shared.rest_told_again import TELLINGS

EACH = 2
ALL = (*KINDS, INDIFFERENT)
# where nothing holds it the pose is known as the way there is, and a frequency with it
ALONG_THE_WAY = [("friction", 14, "turned"), ("ropes", 1, "mirrored")]
SLOW = {case[:2] for case in ALONG_THE_WAY}  # 7 to 15 s each
CASES = [(kind, seed, WAYS[(seed + EACH * k) % len(WAYS)]) for k, kind in enumerate(ALL) for seed in range(EACH)]
ALL_CASES = [
    pytest.param(*case, marks=pytest.mark.long) if case[:2] in SLOW else case for case in [*CASES, *ALONG_THE_WAY]
]


@pytest.mark.heavy
@pytest.mark.parametrize(("kind", "seed", "way"), ALL_CASES)
@pytest.mark.sixth
def test_it_swings_as_told_before(kind: str, seed: int, way: str) -> None:
    """As many of each kind, frequencies and growths within what both tellings state; refused where the first is."""
    found, *_ = judged(kind, seed, way)
    assert found.what in RIGHT, (way, found)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.third
def test_what_is_held_has_the_error_of_rounding_alone(seed: int) -> None:
    """A pose in which all is held is known to its rounding, and so are the modes: another billionth is seen."""
    tree = scene("plane", seed)
    told = TELLINGS["turned"](tree, np.random.default_rng(0), None)  # type: ignore[arg-type]
    first, second = answer(tree), answer({**told.tree, "gravity": [(1.0 + 1e-9) * g for g in told.tree["gravity"]]})
    assert not isinstance(first, str)
    assert all(mode.kind == "oscillation" for mode in first.modes)
    assert agree(first, second, told).what == "farther than stated"
