"""Shades of a field from low to high, dark to light, that are told apart in grey, too."""

from __future__ import annotations

ENDS = ((0x1F, 0x2A, 0x5A), (0x1F, 0x7A, 0x8C), (0x8F, 0xB9, 0x6A), (0xFD, 0xE7, 0x9A))


def shade(share: float) -> str:
    """The colour of a share, 0 to 1."""
    at = min(max(share, 0.0), 1.0) * (len(ENDS) - 1)
    k = min(int(at), len(ENDS) - 2)
    return "#" + "".join(f"{round(a + (b - a) * (at - k)):02x}" for a, b in zip(ENDS[k], ENDS[k + 1], strict=True))
