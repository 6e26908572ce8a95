"""The option `--shard K/N`: a part of a sweep, for external schedulers."""

from __future__ import annotations

from heuncli.app.cli.entry import UsageError
from heuncli.base.errors import Problem


def parse_shard(word: str | None) -> tuple[int, int]:
    """Return the number of the part, and of how many. Raises UsageError."""
    if word is None:
        return 1, 1
    k, slash, n = word.partition("/")
    numbers = [int(text) for text in (k, n) if text.isascii() and text.isdecimal() and len(text) < 10]
    if not slash or len(numbers) < 2 or not 1 <= numbers[0] <= numbers[1]:
        message = f"--shard {word}: expected K/N, the K-th part of N"
        raise UsageError(Problem("bad-option", message, hint="for example --shard 2/8; the last is 8/8"))
    return numbers[0], numbers[1]
