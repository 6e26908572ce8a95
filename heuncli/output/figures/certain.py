"""Format numbers in figures with no more digits than their errors allow, as in tables."""

from __future__ import annotations

from heuncli.study.quantities.digits import choose_style, write_numbers


def format_certain(value: float, error: float) -> str:
    """Format a number with the digits that its error leaves, both in the unit shown; `?` if the error is as large."""
    return write_numbers([value], choose_style(abs(value), error))[0]
