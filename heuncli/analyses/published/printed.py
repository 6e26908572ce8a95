"""A number as it was printed: its value, and the digit at which it was cut."""

from __future__ import annotations

import re

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.expressions.grammar import Scope
from heuncli.scene.file_format.quantity import number

DECIMAL = re.compile(r"[+-]?(?=\.?\d)(\d*)(?:\.(\d*))?(?:[eE]([+-]?\d+))?\Z")


class Printed(NamedTuple):
    """A number as it stands in its source; last: one unit of its last digit, 0 of what is exact."""

    text: str
    value: float
    last: float

    @property
    def digits(self) -> int:
        """How many digits were printed, from the first that is not 0; 0 of what is exact."""
        found = DECIMAL.match(self.text) if self.last else None
        return len(f"{found[1]}{found[2] or ''}".lstrip("0")) if found is not None else 0


def printed(text: str) -> Printed:
    """A decimal number: 0.3284 claims 0.32835 to 0.32845. Raises ValueError."""
    found = DECIMAL.match(text)
    if found is None:
        raise ValueError(f"{text} is no decimal number")
    return Printed(text, float(text), 10.0 ** (int(found[3] or 0) - len(found[2] or "")))


def exact(text: str, names: dict[str, float]) -> Printed:
    """An expression such as 7*l*q/24, exact in the names that it holds. Raises Finding."""
    return Printed(text, number(text, None, Scope(parameters=names)), 0.0)
