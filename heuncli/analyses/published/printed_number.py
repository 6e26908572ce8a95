"""A number as it was printed: its value, and the place of its last digit."""

from __future__ import annotations

import re

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.expressions.grammar import Scope
from heuncli.scene.file_format.quantity import read_number

DECIMAL = re.compile(r"[+-]?(?=\.?\d)(\d*)(?:\.(\d*))?(?:[eE]([+-]?\d+))?\Z")


class PrintedNumber(NamedTuple):
    """A number as printed in its source; last_digit: one unit of its last digit, 0 if it is exact."""

    text: str
    value: float
    last_digit: float

    @property
    def digit_count(self) -> int:
        """Number of significant digits printed; 0 if the number is exact."""
        decimal = DECIMAL.match(self.text) if self.last_digit else None
        return len(f"{decimal[1]}{decimal[2] or ''}".lstrip("0")) if decimal is not None else 0


def parse_decimal(text: str) -> PrintedNumber:
    """Parse a decimal number: 0.3284 means 0.32835 to 0.32845. Raises ValueError."""
    decimal = DECIMAL.match(text)
    if decimal is None:
        raise ValueError(f"{text} is not a decimal number")
    return PrintedNumber(text, float(text), 10.0 ** (int(decimal[3] or 0) - len(decimal[2] or "")))


def evaluate_exact(text: str, names: dict[str, float]) -> PrintedNumber:
    """Evaluate an expression such as 7*l*q/24, exact in the names that it contains. Raises Finding."""
    return PrintedNumber(text, read_number(text, None, Scope(parameters=names)), 0.0)
