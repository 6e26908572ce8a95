"""Shades of a field from low to high, dark to light, which can be distinguished in grey as well."""

from __future__ import annotations

SHADE_COLOURS = ((0x1F, 0x2A, 0x5A), (0x1F, 0x7A, 0x8C), (0x8F, 0xB9, 0x6A), (0xFD, 0xE7, 0x9A))


def find_shade(share: float) -> str:
    """Return the colour of a share, 0 to 1."""
    position = min(max(share, 0.0), 1.0) * (len(SHADE_COLOURS) - 1)
    k = min(int(position), len(SHADE_COLOURS) - 2)
    return "#" + "".join(
        f"{round(a + (b - a) * (position - k)):02x}"
        for a, b in zip(SHADE_COLOURS[k], SHADE_COLOURS[k + 1], strict=True)
    )
