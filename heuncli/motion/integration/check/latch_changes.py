"""When latches catch and let go in a run, and how well that is known: by when the runs beside it have the same."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.records import replace
from heuncli.motion.integration.check.changes import Changes
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array


def latch_changes(layout: Layout, runs: Sequence[Trajectory], before: float) -> tuple[Changes, ...]:
    """Of each latch when it catches and lets go in the first of some runs, before an instant."""
    found = []
    for i in layout.latches:
        own, *others = (changes_in(layout.contacts[i].name, run, i) for run in runs)
        found.append(replace(own, error=errors(own, others)).before(before))
    return tuple(found)


def changes_in(name: str, run: Trajectory, contact: int) -> Changes:
    """When a latch catches and lets go in a run; of several changes at one instant what holds behind them."""
    held = run.holding[:, contact] > 0.0
    begins = np.concatenate([[0.0], run.ends])[: len(held)]
    last = np.append(begins[1:] != begins[:-1], True)
    begins, held = begins[last], held[last]
    changed = np.flatnonzero(held[1:] != held[:-1]) + 1
    return Changes(name, bool(held[0]), begins[changed], held[changed], np.zeros(len(changed)))


def errors(own: Changes, others: Sequence[Changes]) -> Array:
    """By how much the other runs have each change sooner or later, twice; nan where one has it not, (n,)."""
    found = tolerances.EPS * own.times
    for other in others:
        count = len(other.times)
        for k, t in enumerate(own.times.tolist()):
            same = k < count and other.begins == own.begins
            found[k] = max(found[k], 2.0 * abs(float(other.times[k]) - t)) if same else math.nan
    return np.asarray(found)
