"""Sentences in lines of a width."""

from __future__ import annotations

MORE = 4  # by which the lines that a long heading, title or note goes on in stand further in


def wrapped(text: str, width: int | None, more: int = MORE) -> list[str]:
    """A text in lines no wider than that; `textwrap` would have to be imported for it, and knows no clauses."""
    lines = [text]
    while width is not None and len(lines[-1]) > width:
        line, start = lines[-1], len(lines[-1]) - len(lines[-1].lstrip())
        cut = _end_of_line(line, start, width)
        if cut < 0:
            break  # one long word
        lead = " " * (start if len(lines) > 1 else start + more)
        lines[-1:] = [line[:cut].rstrip(), lead + line[cut:].lstrip()]
    return lines


def _end_of_line(line: str, start: int, width: int) -> int:
    """The blank at which a line is parted: behind a clause where one ends in its last third, not within brackets."""
    blanks = [i for i in range(start + 1, min(width + 1, len(line))) if line[i] == " "]
    late = [i for i in blanks if line[i - 1] in ",;" and 3 * i > 2 * width]
    ends = [i for i in late if line.count("(", 0, i) == line.count(")", 0, i)]
    return max(ends or blanks, default=line.find(" ", max(width, start + 1)))
