"""Whether a scene moves in a plane."""

from __future__ import annotations

from tests.honesty.boundaries.part import Part, Row
from tests.honesty.nearly_flat import PARTS, drawn_askew, leaving

PART = Part(
    ("in the plane",),
    rows=(
        *(Row("FLAT", leaving(part), "flat", "not flat") for part in PARTS),
        Row("NEARLY_FLAT", drawn_askew, "told", "in space"),
    ),
)
