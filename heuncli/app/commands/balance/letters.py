"""The orders in letters, for the terminal: how large each is of the largest of its kind, logarithmic, to the right."""

from __future__ import annotations

import math

from heuncli.analyses.balancing.results import BalanceResults

LETTER = {"force": "F", "moment": "M", "torque": "T"}
SEVERAL = "+"
DECADES = 4
LABEL = 7
WIDTH = 81  # columns of the field at most


def draw(found: BalanceResults, width: int) -> str:
    """The orders as lines of text, no wider than that; ends with a newline. Nothing where there are none."""
    room = min(WIDTH, width - LABEL - 2)
    field = {order: [" "] * room for order in found.shown}
    for name, letter in LETTER.items():
        if name not in found.orders:
            continue
        rows = [row for row in found.orders[name] if row.order in field]
        largest = max((row.reach for row in found.orders[name]), default=0.0)
        for row in rows:
            if row.reach <= 10.0**-DECADES * largest:
                continue
            at = round((1.0 + math.log10(row.reach / largest) / DECADES) * (room - 1))
            own = field[row.order]
            own[at] = letter if own[at] == " " else SEVERAL
    if not field:
        return ""
    head = "ORDERS  of the largest order of its kind: F force, M moment, T torque, + several"
    lines = [f"{order:{LABEL}g} |{''.join(cells).rstrip()}" for order, cells in field.items()]
    ticks = {round(k * (room - 1) / DECADES): name_of(k - DECADES) for k in range(DECADES + 1)}
    axis = "".join("+" if k in ticks else "-" for k in range(room))
    under = [" "] * (room + LABEL)
    for place, text in ticks.items():
        begin = max(place - len(text) // 2, 0) + LABEL + 2
        under[begin : begin + len(text)] = text
    return "\n".join([head, *lines, f"{'':{LABEL}} +{axis}", "".join(under).rstrip()]) + "\n"


def name_of(power: int) -> str:
    """A share of one as people write it."""
    return "1" if power == 0 else f"{10.0**power:g}"
