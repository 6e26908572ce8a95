"""Seeds of random scenes as parameters of tests, with marks on those that the plain kernel is spared."""

from __future__ import annotations

from collections.abc import Container, Iterable
from typing import Any

import pytest


def spared(seeds: Iterable[Any], quick: Container[Any]) -> list[Any]:
    """The seeds, all but the quick ones marked heavy: a plain run of theirs takes more than a second or two."""
    return [seed if seed in quick else pytest.param(seed, marks=pytest.mark.heavy) for seed in seeds]
