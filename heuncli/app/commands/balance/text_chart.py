"""Draw the orders as text, for the terminal: the size of each relative to the largest of its kind, on a logarithmic
axis.
"""

from __future__ import annotations

import math

from heuncli.analyses.balancing.results import BalanceResults

LETTERS = {"force": "F", "moment": "M", "torque": "T"}
SEVERAL = "+"
DECADES = 4
LABEL = 7
WIDTH = 81  # columns of the field at most


def draw_orders(results: BalanceResults, width: int) -> str:
    """Draw the orders as lines of text, no wider than `width`; ends with a newline. Empty if no order is shown."""
    columns = min(WIDTH, width - LABEL - 2)
    field = {order: [" "] * columns for order in results.shown_orders}
    for name, letter in LETTERS.items():
        if name not in results.orders:
            continue
        rows = [row for row in results.orders[name] if row.order in field]
        largest = max((row.peak for row in results.orders[name]), default=0.0)
        for row in rows:
            if row.peak <= 10.0**-DECADES * largest:
                continue
            position = round((1.0 + math.log10(row.peak / largest) / DECADES) * (columns - 1))
            cells_of_order = field[row.order]
            cells_of_order[position] = letter if cells_of_order[position] == " " else SEVERAL
    if not field:
        return ""
    head = "ORDERS  relative to the largest of each kind: F force, M moment, T torque, + overlap"
    lines = [f"{order:{LABEL}g} |{''.join(cells).rstrip()}" for order, cells in field.items()]
    ticks = {round(k * (columns - 1) / DECADES): format_share(k - DECADES) for k in range(DECADES + 1)}
    axis = "".join("+" if k in ticks else "-" for k in range(columns))
    tick_line = [" "] * (columns + LABEL)
    for place, text in ticks.items():
        begin = max(place - len(text) // 2, 0) + LABEL + 2
        tick_line[begin : begin + len(text)] = text
    return "\n".join([head, *lines, f"{'':{LABEL}} +{axis}", "".join(tick_line).rstrip()]) + "\n"


def format_share(power: int) -> str:
    """Format a power of ten as a share of one."""
    return "1" if power == 0 else f"{10.0**power:g}"
