"""A computation as stages: functions of records that change nothing, so that their results may be kept.

Here nothing is kept; kept_stages.py is for variants of a scene.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

T = TypeVar("T")


class Stages:
    """Runs stages, and keeps nothing."""

    def run(self, stage: Callable[..., T], *given: Any, of: str = "", by: Callable[[], T] | None = None) -> T:
        """The result of a stage; of: which one, of a stage that is run for several things by their names.

        by: how the same is made of stages, where some of what it is made of may be kept when it is not.
        """
        return stage(*given) if by is None else by()


ANEW = Stages()
