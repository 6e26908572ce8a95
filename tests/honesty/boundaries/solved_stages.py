"""Stages of a step that are solved for, by Newton's iteration."""

from __future__ import annotations

from tests.honesty.boundaries.part import Part

PART = Part(
    ("kernel: stages that are solved for",),
    exempt={
        "KERNEL.newton_ends": "when an iteration ends that goes on to rounding: one more changes nothing but that",
        "KERNEL.newton_rounding": "when corrections of an iteration count as noise: what is left is rounding",
        "KERNEL.newton_part": "what an iteration that stalls may leave of a step whose error is judged besides",
        "KERNEL.newton_noise": "the same of a given step; tests/convergence/test_collocation.py has both sides",
        "KERNEL.newton_stalls": "when corrections count as noise; what they may be as noise newton_rounding decides",
        "KERNEL.newton_diverges": "how soon an iteration is given up that does not contract; it is at its third step",
    },
)
