"""Drives and values in time for the oracle: text for the program, and the same law as a function where it is needed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Source:
    """Text for the program; `law` for who needs the number here."""

    source: str
    law: Callable[[float], float] | None = None

    def __call__(self, t: float) -> float:
        assert self.law is not None, self.source
        return self.law(t)


def driven(joint: str, quantity: str, source: str) -> dict[str, Any]:
    """A drive told by its expression alone."""
    return {"joint": joint, quantity: Source(source)}


def smooth_step(t: float) -> float:
    """From 0 to 1 over one second with three derivatives continuous."""
    return t - math.sin(2 * math.pi * t) / (2 * math.pi)
