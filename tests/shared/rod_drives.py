"""A rod driven at the distance of a place from another one that turns, as a law in time."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

Law = Callable[[float], float]


@dataclass(frozen=True)
class Apart:
    """The distance of a place `far` from the origin and one `near` to it that turns there at a rate, by its angle.

    d^2 = far^2 + near^2 - 2 far near cos(start + rate t)
    """

    far: float
    near: float
    start: float
    rate: float

    @property
    def source(self) -> str:
        """As an expression."""
        squares, product = self.far**2 + self.near**2, 2 * self.far * self.near
        return f"sqrt({squares!r} - {product!r}*cos({self.start!r} + {self.rate!r}*t))"

    def __call__(self, t: float) -> float:
        angle = self.start + self.rate * t
        return math.sqrt(self.far**2 + self.near**2 - 2 * self.far * self.near * math.cos(angle))

    def first(self, t: float) -> float:
        """Its rate."""
        return self.far * self.near * self.rate * math.sin(self.start + self.rate * t) / self(t)

    def second(self, t: float) -> float:
        """The rate of that."""
        turning = self.far * self.near * self.rate**2 * math.cos(self.start + self.rate * t)
        return (turning - self.first(t) ** 2) / self(t)

    def drive(self) -> tuple[Law, Law, Law]:
        """The law with its derivatives."""
        return self, self.first, self.second
