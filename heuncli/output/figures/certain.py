"""Numbers in words of a picture: with no more digits than their errors let be, as in tables."""

from __future__ import annotations

from heuncli.study.quantities.digits import style, write


def certain(value: float, error: float) -> str:
    """A number and how well it is known, both in the unit that is shown; `?` where the error reaches it."""
    return write([value], style(abs(value), error))[0]
