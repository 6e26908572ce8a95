"""The error for what cannot be drawn, with a hint."""

from __future__ import annotations

from heuncli.base.errors import HeunError, Problem


class NotDrawable(HeunError):
    """The requested quantity cannot be drawn in this kind of figure."""

    exit_code = 2

    def __init__(self, message: str, hint: str) -> None:
        super().__init__(Problem("bad-option", message, hint=hint))
