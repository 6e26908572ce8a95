"""A computation in stages: functions of records without side effects, so that their results may be cached.

Here nothing is cached; stage_cache.py does that for the variants of a scene.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

T = TypeVar("T")


class Stages:
    """Runs stages without a cache."""

    def run(self, stage: Callable[..., T], *inputs: Any, key: str = "", fallback: Callable[[], T] | None = None) -> T:
        """Return the result of a stage. key: which one, of a stage that is run for several objects by name.

        fallback: computes the same from smaller stages, some of which may be cached when the stage itself is not
        """
        return stage(*inputs) if fallback is None else fallback()


NO_CACHE = Stages()
