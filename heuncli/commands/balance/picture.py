"""The orders as a drawing: bars of force, moment and torque, legible in black and white."""

from __future__ import annotations

from heuncli.balancing.results import BalanceResults
from heuncli.balancing.words import unit_of
from heuncli.drawing.picture import Line, Picture, Shape, Text
from heuncli.foreign_text import shown
from heuncli.wrapping import wrapped

WIDTH, PANEL = 760.0, 150.0  # pixels: of the whole, and how high the field of a quantity is
LEFT, RIGHT, GAP = 92.0, 24.0, 62.0
TITLE, SMALL = 17.0, 11.0  # sizes of letters
LINE, LETTER = 15.0, 0.6
BAR = 0.6  # of the room of an order
GRID, GREY, BLACK = "#d0d0d0", "#444444", "#000000"
COLOURS = {"force": "#123f7a", "moment": "#8c1515", "torque": "#555555"}
NAMES = {"force": "force on the foundation", "moment": "moment on the foundation", "torque": "torque of the inertia"}
TICKS = 4


def picture(found: BalanceResults) -> Picture:
    """The drawing of a balance."""
    shapes: list[Shape] = []
    title = found.title or "Balance"
    rate = f" at {found.rate:.6g} rad/s" if found.rate is not None else ""
    cycle = f"{found.coordinate}{rate}" if found.period is None else f"time, 1/T = {1.0 / found.period.seconds:.6g} Hz"
    told = f"orders of {cycle}; force: {found.words['force']}; moment: {found.words['moment']}"
    y = 28.0
    for text in wrapped(shown(title), int((WIDTH - 40.0) / (LETTER * TITLE)), 0):
        shapes.append(Text(20.0, y, text, TITLE, bold=True))
        y += 21.0
    for text in wrapped(told, int((WIDTH - 40.0) / (LETTER * SMALL)), 0):
        shapes.append(Text(20.0, y, text, SMALL, colour=GREY))
        y += LINE
    for quantity in (name for name in NAMES if name in found.orders):
        y += GAP - 24.0
        shapes += panel(found, quantity, y)
        y += PANEL + 24.0
    return Picture(WIDTH, y + 24.0, f"{shown(title)}: orders", told, shapes)


def panel(found: BalanceResults, quantity: str, top: float) -> list[Shape]:
    """The bars of one quantity below a height."""
    rows = {row.order: row.size for row in found.orders[quantity]}
    largest = max((rows.get(order, 0.0) for order in found.shown), default=0.0)
    bottom, right = top + PANEL, WIDTH - RIGHT
    shapes: list[Shape] = [Text(LEFT, top - 8.0, f"{NAMES[quantity]} [{unit_of(found, quantity)}]", SMALL, bold=True)]
    for k in range(TICKS + 1):
        y = bottom - PANEL * k / TICKS
        shapes.append(Line(((LEFT, y), (right, y)), GRID if k else BLACK, 0.8))
        shapes.append(Text(LEFT - 8.0, y + 4.0, f"{largest * k / TICKS:.4g}", SMALL, "end"))
    room = (right - LEFT) / max(len(found.shown), 1)
    for k, order in enumerate(found.shown):
        x = LEFT + room * (k + 0.5)
        share = rows.get(order, 0.0) / largest if largest > 0.0 else 0.0
        if share > 0.0:
            shapes.append(Line(((x, bottom), (x, bottom - PANEL * share)), COLOURS[quantity], min(BAR * room, 30.0)))
        shapes.append(Text(x, bottom + 15.0, f"{order:g}", SMALL, "middle"))
    return shapes
