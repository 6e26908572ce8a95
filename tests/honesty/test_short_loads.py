"""No short load is missed: scenes at random against their motions from edge to edge (tests/honesty/short_loads.py)."""

from __future__ import annotations

import pytest

from tests.honesty.short_loads import FACTOR, judged, scene, tells_chatter


@pytest.mark.heavy
@pytest.mark.parametrize("seed", range(60))
@pytest.mark.third
def test_none_is_missed(seed: int) -> None:
    """Places within what the run tells, and the loads' work; where no motion goes on, that is told with its instant."""
    drawn = scene(seed)
    if drawn.chatters is not None:
        assert not tells_chatter(drawn)
        return
    found = judged(drawn)
    assert found.off <= FACTOR, (drawn.scene.kinds, found)
    assert found.work <= FACTOR, (drawn.scene.kinds, found)
