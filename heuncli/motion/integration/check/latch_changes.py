"""Find when latches catch and release in a run, and estimate the error of these instants from the neighbouring runs."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.motion.integration.check.changes import ConditionChanges
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array


def find_latch_changes(layout: Layout, runs: Sequence[Trajectory], before_time: float) -> tuple[ConditionChanges, ...]:
    """Find when each latch catches and releases in the first of several runs, before an instant."""
    found = []
    for i in layout.latches:
        latch_changes_of_run, *others = (find_changes_in_run(layout.contacts[i].name, run, i) for run in runs)
        found.append(
            replace(latch_changes_of_run, error=estimate_errors(latch_changes_of_run, others)).select_before(
                before_time
            )
        )
    return tuple(found)


def find_changes_in_run(name: str, run: Trajectory, contact: int) -> ConditionChanges:
    """Find when a latch catches and releases in one run; of several changes at one instant, the state after them
    counts.
    """
    is_held = run.holding[:, contact] > 0.0
    begins = np.concatenate([[0.0], run.ends])[: len(is_held)]
    is_last = np.append(begins[1:] != begins[:-1], True)
    begins, is_held = begins[is_last], is_held[is_last]
    changed = np.flatnonzero(is_held[1:] != is_held[:-1]) + 1
    return ConditionChanges(name, bool(is_held[0]), begins[changed], is_held[changed], np.zeros(len(changed)))


def estimate_errors(changes: ConditionChanges, others: Sequence[ConditionChanges]) -> Array:
    """Return twice the time by which other runs have each change earlier or later; nan where one lacks it, (n,)."""
    error = tolerances.EPS * changes.times
    for other in others:
        count = len(other.times)
        for k, t in enumerate(changes.times.tolist()):
            same = k < count and other.begins == changes.begins
            error[k] = max(error[k], 2.0 * abs(float(other.times[k]) - t)) if same else math.nan
    return np.asarray(error)
