"""Axes reversed, ends exchanged: the same machine. The family is reversed_told_again.py beside it."""

from __future__ import annotations

import pytest

from tests.honesty.reversed_told_again import KINDS, RIGHT, judged


@pytest.mark.heavy
@pytest.mark.parametrize(("kind", "seed"), [*((kind, seed) for kind in KINDS for seed in (3, 8)), ("planar", 16)])
@pytest.mark.third
def test_it_moves_as_told_before(kind: str, seed: int) -> None:
    """Motion, foundation, joints, couplings, sections, energies and blows within what both tellings state."""
    what, ratio, more, *_ = judged(kind, seed)
    assert what in RIGHT, (what, ratio, more)
