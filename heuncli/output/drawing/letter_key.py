"""Write what stands below a view of a machine on a terminal: a scale bar, the axes, and the arrows of loads."""

from __future__ import annotations

from heuncli.base.text_safety import escape
from heuncli.output.drawing.canvas import RESET, TerminalStyle
from heuncli.output.drawing.figure import SpaceKey
from heuncli.output.drawing.pens import find_pen

ALONG_AXIS = 0.999  # component of a world axis along a side of the drawing, from which its direction is told


def format_key(key: SpaceKey, columns_per_unit: float, style: TerminalStyle) -> list[str]:
    """Return the lines of a key; each arrow is as long as its value, to the column."""
    rule, ends, head = ("─", "├┤", "▶") if style.has_braille else ("-", "||", ">")
    bar = rule * max(0, round(columns_per_unit * key.bar[0]) - 2)
    lines = [f"{ends[0]}{bar}{ends[1]} {escape(key.bar[1])}"]
    ways = [f"{name} {way}" for name, a, b in key.axes if (way := _find_way(a, b))]
    lines[0] += f"   {', '.join(ways)}" if ways else ""
    for arrow in key.arrows:
        heads = head * (1 + arrow.is_double)
        shaft = rule * max(0, round(columns_per_unit * arrow.length) - len(heads)) + heads
        if style.has_colours and arrow.pen is not None:
            shaft = f"\x1b[{find_pen(arrow.pen).code}m{shaft}{RESET}"
        lines.append(f"{shaft} {escape(arrow.text)}")
    return lines


def _find_way(a: float, b: float) -> str:
    """Return the direction of a world axis along a side of the drawing; empty for any other."""
    if max(abs(a), abs(b)) < ALONG_AXIS:
        return ""
    return ("right" if a > 0.0 else "left") if abs(a) > abs(b) else "up" if b > 0.0 else "down"
