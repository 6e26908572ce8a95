"""Make sentences: counts of things, lists of names, and lines of a width."""

from __future__ import annotations

from collections.abc import Sequence

CONTINUATION_INDENT = 4  # additional indent of the continuation lines of a long heading, title or note


def wrap_text(text: str, width: int | None, extra_indent: int = CONTINUATION_INDENT) -> list[str]:
    """Wrap a text to lines of at most `width`; `textwrap` would have to be imported, and ignores clauses."""
    lines = [text]
    while width is not None and len(lines[-1]) > width:
        line, start = lines[-1], len(lines[-1]) - len(lines[-1].lstrip())
        cut = _find_break(line, start, width)
        if cut < 0:
            break  # one long word
        lead = " " * (start if len(lines) > 1 else start + extra_indent)
        lines[-1:] = [line[:cut].rstrip(), lead + line[cut:].lstrip()]
    return lines


def _find_break(line: str, start: int, width: int) -> int:
    """Return the blank at which to break a line: after a clause that ends in its last third and not within brackets, or
    else the last.
    """
    blanks = [i for i in range(start + 1, min(width + 1, len(line))) if line[i] == " "]
    late_clauses = [i for i in blanks if line[i - 1] in ",;" and 3 * i > 2 * width]
    clause_ends = [i for i in late_clauses if line.count("(", 0, i) == line.count(")", 0, i)]
    return max(clause_ends or blanks, default=line.find(" ", max(width, start + 1)))


MAX_NAMES = 5  # listed in a sentence


def format_count(n: int, one: str, many: str | None = None) -> str:
    """Format a number of things; many: the plural, if it is not the singular with an s."""
    return f"{n:,} {one if n == 1 else many or one + 's'}"


def list_some(names: Sequence[str]) -> str:
    """List the first names, and how many more there are."""
    more = len(names) - MAX_NAMES
    return ", ".join(names[:MAX_NAMES]) + (f" and {more} more" if more > 0 else "")
