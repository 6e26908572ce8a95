"""What the results hold: which blocks run over the instants, which report each belongs to. Imports nothing."""

from __future__ import annotations

from collections.abc import Sequence

XYZ = ("x", "y", "z")
TIMED = ("bodies", "points", "coordinates", "foundation", "joints", "sections", "forces", "energy", "system_vector")
# Inside the blocks above, yet the same at all instants: (block, depth, key); bodies and sections may bear such names.
STATIC = frozenset({("foundation", 0, "about"), ("sections", 1, "s"), ("sections", 1, "side")})
# Which parts of the results belong to which report; the rest (model, accuracy, ...) always stays.
PARTS = {
    "bodies": "motion",
    "coordinates": "motion",
    "system_vector": "motion",
    "points": "points",
    "foundation": "foundation",
    "joints": "joints",
    "sections": "sections",
    "forces": "forces",
    "energy": "energy",
}


def is_static(kind: str, keys: Sequence[str], key: str) -> bool:
    """Whether what stands at this place of a block that runs over the instants is the same at all of them."""
    return (kind, len(keys), key) in STATIC

