"""The README's picture of a bending moment, drawn from the results: a test compares the two."""

from __future__ import annotations

import numpy as np

from heuncli.results import Array

WIDE, HIGH = 60, 7  # columns along the bar, rows below it


def picture(s: Array, moment: Array) -> list[str]:
    """Lines of text: the bar from its first cut to its last, and the moment below it where it is negative [kN m].

    s (n,) [m] and moment (n,) [N m] of a run's cuts at one instant.
    """
    places = np.linspace(s[0], s[-1], WIDE + 1)
    values = np.interp(places, s, moment) / 1e3
    step = values.min() / HIGH
    level = np.rint(values / step).astype(int)
    lines = ["M2 [kN m]  " + "".join(f"{x:<10.3g}" for x in np.linspace(s[0], s[-1], 7)) + "s [m]"]
    lines.append("     0     " + "".join("+" if i % 10 == 0 else "=" for i in range(WIDE + 1)) + "  top")
    for row in range(1, HIGH + 1):
        line = "".join("*" if k == row else " " for k in level)
        lines.append(f"  {step * row:5.2f}    {line}".rstrip())
    return lines
