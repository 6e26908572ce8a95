"""Accuracy against time on logarithmic scales, in text: a letter a run, tolerances of 1e-4 to 1e-13 along each line."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

WIDTH, PER_DECADE = 64, 2  # columns; rows a decade of error
LABELS = (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000)


def chart(
    runs: Mapping[str, Sequence[tuple[float, float]]], labels: Sequence[float] = LABELS, across: str = "ms",
    down: str = "m",
) -> str:  # fmt: skip
    """(milliseconds, error [m]) of the runs of each letter, or others. Errors run downwards, time to the right."""
    times = [t for points in runs.values() for t, _ in points]
    errors = [e for points in runs.values() for _, e in points]
    left, right = math.log10(min(times)) - 0.05, math.log10(max(times)) + 0.05
    top, bottom = math.ceil(math.log10(max(errors))), math.floor(math.log10(min(errors)))
    rows = [[" "] * WIDTH for _ in range((top - bottom) * PER_DECADE + 1)]
    for letter, points in runs.items():
        for t, e in points:
            row = round((top - math.log10(e)) * PER_DECADE)
            column = round((math.log10(t) - left) / (right - left) * (WIDTH - 1))
            rows[row][column] = letter if rows[row][column] in (" ", letter) else "*"
    lines = [
        f"{f'1e{top - k // PER_DECADE:+03d} {down}' if k % PER_DECADE == 0 else '':>8} |{''.join(row).rstrip()}"
        for k, row in enumerate(rows)
    ]
    axis, names = ["-"] * WIDTH, [" "] * (WIDTH + 6)
    for label in labels:
        column = round((math.log10(label) - left) / (right - left) * (WIDTH - 1))
        if 0 <= column < WIDTH:
            axis[column] = "+"
            names[column : column + len(text)] = (text := f"{label:g}")
    return "\n".join([*lines, f"{'':8} +{''.join(axis)}", f"{'':9} {''.join(names).rstrip()} {across}"])
