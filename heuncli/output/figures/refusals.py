"""What cannot be drawn, and what to ask for in its place."""

from __future__ import annotations

from heuncli.base.errors import HeunError, Problem


class NotDrawable(HeunError):
    """What is to be drawn makes no such picture."""

    exit_code = 2

    def __init__(self, message: str, hint: str) -> None:
        super().__init__(Problem("bad-option", message, hint=hint))
