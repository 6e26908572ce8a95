"""Counts with their nouns (`2 bodies`), and ranges of numbered names (`pin1–pin3`). Needs no NumPy."""

from __future__ import annotations

import re
from collections.abc import Iterable


def format_count(number: int, noun: str) -> str:
    """Format a number of things: `1 body`, `2 bodies`, `no loops`, `0 degrees of freedom`."""
    if noun == "degree of freedom":
        return f"{number} {noun if number == 1 else 'degrees of freedom'}"
    plural = f"{noun[:-1]}ies" if noun.endswith("y") else f"{noun}s"
    return f"{number or 'no'} {noun if number == 1 else plural}"


MIN_RANGE = 3  # names; two are listed
NUMBERED = re.compile(r"(.*?)([1-9]\d*|0)$", re.DOTALL)


def join_ranges(names: Iterable[str]) -> list[str]:
    """Join runs of names that end in consecutive numbers."""
    runs: list[list[str]] = []
    for name in names:
        if runs and _is_next(runs[-1][-1], name):
            runs[-1].append(name)
        else:
            runs.append([name])
    return [text for run in runs for text in ([f"{run[0]}–{run[-1]}"] if len(run) >= MIN_RANGE else run)]


def _is_next(name: str, following: str) -> bool:
    """Return whether a name differs from the one before only by a number that is larger by 1."""
    first, second = NUMBERED.fullmatch(name), NUMBERED.fullmatch(following)
    return bool(first and second and first[1] == second[1] and int(second[2]) == int(first[2]) + 1)
