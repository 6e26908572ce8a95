"""Every threshold at which a verdict can change, by concept; each with the reason for its size.

EPS is the rounding of one operation, 2.2e-16. A sum of some dozen terms of alternating sign keeps 13 to 14 digits of
the largest of them: what lies below that is rounding.
"""

from __future__ import annotations

# The kernel's thresholds (kernel/scene.py, Limits).
KERNEL: dict[str, float] = {
    "dodges": 10,  # lengths tried; .87**10 spans a factor of 4, more than the width of what a singular pose spoils
    # -- inertia
    "no_inertia": 1e-14,  # of the trace: some dozen roundings of the sums that make an articulated inertia
    # -- rank
    "moves_nothing": 1e-24,  # squares of loads: 1e-12 of the largest load the row could exert, its rounding
    "across": 0.01,  # a row's answer across its arms counts to a tenth of the arm: singular is told against that
    "independent": 1e-11,  # a pivot is a square: rows whose independent part is 3e-6 of them still count
    "preference": 1.01,  # 1 %: rows alike but for rounding are taken in their order, which keeps the choice steady
    "pivot_drop": 1e-3,  # of a pivot: 5 digits of the multipliers lost, time to look for better rows
    "near_singular": 0.2,  # a pivot below which the stages of a step are settled, too: their gaps grow by 1 / pivot
    "locked": 1e-4,
    "locked_step": 1e-9,  # of the time: a step 1e9 times shorter than the run, at a small pivot, is a lock
    # -- gaps, of the scene's size
    "closed": 1e-15,
    "nearly_closed": 1e-14,
    "reopened": 1e-11,
    "lost": 1e-8,
    # -- steps
    "least_step": 1e-14,  # of the time: fewer than 50 roundings of t
    "rope_step": 1e-12,  # of the time: how near a run comes to where a rope would push
    "dodge": 0.87,
    "pivot_rounding": 1e-16,  # a rounding of the closures, amplified by 1 / pivot
    "pivot_noise": 3e-13,  # what ten lengths could not avoid: the gap that settling leaves, amplified likewise
}
