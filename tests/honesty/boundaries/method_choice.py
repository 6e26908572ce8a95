"""The choice of the method."""

from __future__ import annotations

from tests.honesty.boundaries.part import Part

PART = Part(
    ("choice of the method",),
    exempt={
        "STIFF": "what is integrated by: either way the same motion, and its estimate",
        "EVENTFUL": "what is integrated by: either way the same motion, and its estimate",
        "EVENTS_RARE": "what is integrated by: either way the same motion, and its estimate",
        "VERNER98": "what is integrated by: either way the same motion, and its estimate",
        "RADAU5": "what is integrated by: either way the same motion, and its estimate",
    },
)
