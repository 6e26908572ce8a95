"""Branches of poses that are followed."""

from __future__ import annotations

from tests.honesty.boundaries.part import Part

PART = Part(
    ("kernel: branches that are followed",),
    exempt={
        "KERNEL.branch_bend": "lengths of steps in which extremes are looked for: no number depends on it",
        "KERNEL.branch_between": "lengths of steps: where a condition is met, the closures tell to rounding",
        "KERNEL.branch_next_start": "lengths of the check run's steps along a branch, on which no number depends",
    },
    wanted={
        "KERNEL.branch_step": "lengths of steps along a branch: where they are too long another branch is taken",
    },
)
