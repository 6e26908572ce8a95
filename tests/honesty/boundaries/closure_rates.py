"""Rates that the closures change at the end of a step: whether that is a blow."""

from __future__ import annotations

from tests.honesty.boundaries.part import Part

PART = Part(
    ("kernel: rates that the closures change at the end of a step, of the largest",),
    wanted={
        "KERNEL.jump": "whether rates that the closures change are a blow",
        "KERNEL.jump_of_error": "the same at a coarse tolerance",
        "KERNEL.jump_of_given": "the same in a given step",
    },
)
