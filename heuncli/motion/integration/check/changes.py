"""Find when the conditions on a motion, its latches and its frictions change, and estimate the error of these instants.

The error of an instant follows from that of the motion. The check run, or another neighbouring run, must show the same
change within an interval d of time. Around the instant, its motion follows from rates and accelerations,

    q(t + d) = q + u d + a d^2 / 2,    u(t + d) = u + a d

and d is enlarged until the condition has one value before it and the other one after it. Where a margin barely passes
through zero, d becomes large: such an instant has few digits, or none.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record, replace
from heuncli.motion.integration.check.run_comparison import match_impulses
from heuncli.motion.integration.conditions import Conditions, Coordinates, evaluate_coordinates
from heuncli.motion.integration.contacts.impulses import ImpulseEvent
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Mask
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format.names import name_sticking_event

# Changes


@record
class ConditionChanges:
    """When a condition changes.

    begins: whether it is true at first
    times (n,): instants of change [s], ascending
    values (n,): the new value after each change
    error (n,): errors of the instants [s]; nan where another run does not show the change
    """

    name: str
    begins: bool
    times: Array
    values: Mask
    error: Array

    def select_before(self, t: float) -> ConditionChanges:
        """Select the changes before an instant [s]."""
        return self.select(self.times < t)

    def select_possible_until(self, t: float, last: float) -> ConditionChanges:
        """Select the changes that, within their errors, may have happened up to t [s]; later ones are moved to `last`,
        the end of the run.
        """
        selection = self.select(self.times - np.nan_to_num(self.error) <= t)
        return replace(selection, times=np.where(selection.times < t, selection.times, last))

    def select(self, selection: Mask) -> ConditionChanges:
        """Select some of the changes; selection (n,)."""
        return replace(self, times=self.times[selection], values=self.values[selection], error=self.error[selection])


def find_changes(runner: Runner, runs: Sequence[Trajectory], before_time: float) -> tuple[ConditionChanges, ...]:
    """Find when the conditions change in the first of several runs, before an instant, with errors from the other
    runs.
    """
    found = find_changes_in_run(runner, runs[0])
    return tuple(
        replace(condition_changes, error=estimate_errors(runner, runs, number, condition_changes))
        for number, condition_changes in enumerate(changes.select_before(before_time) for changes in found)
    )


def find_changes_in_run(runner: Runner, run: Trajectory) -> list[ConditionChanges]:
    """Find when the conditions change in one run, without errors."""
    conditions = Conditions(runner.integrated_scene.layout)
    begins, inside, branches = find_branch_intervals(run)
    coordinates = evaluate_coordinates(runner, inside, runner.resample(run, inside))
    truths = np.array(
        [
            conditions.evaluate_held(t, row, there)
            for t, row, there in zip(inside.tolist(), branches, coordinates, strict=True)
        ]
    )
    found = []
    for condition, truth in zip(conditions.conditions, truths.T, strict=True):
        if np.isnan(truth).any():
            raise make_no_value_error(condition.value, float(inside[np.isnan(truth)][0]))
        found.append(make_changes(condition.name, begins, truth > 0.5))
    return found


def find_branch_intervals(run: Trajectory) -> tuple[Array, Array, Array]:
    """Return the intervals of a run without branch changes: the begins, an instant within each, and the branches held
    there.

    The last one is the end of the run, with the branches after it.
    """
    bounds = np.concatenate([[0.0], run.ends])
    count = len(run.ends)
    rows = np.vstack([run.branches.reshape(count, -1), run.final_branches[None, :]])
    is_interval_start = np.isin(bounds, run.segments.ends)
    is_interval_start[1:] |= (rows[1:] != rows[:-1]).any(axis=1)
    is_interval_start[0] = is_interval_start[count] = True
    # a jump in time alone may end a run one double after its last step, where the condition is true
    inside = np.append(0.5 * (bounds[:-1] + bounds[1:]), max(bounds[-1], run.times[-1]))
    return bounds[is_interval_start], inside[is_interval_start], rows[is_interval_start]


def make_changes(name: str, begins: Array, truth: Mask) -> ConditionChanges:
    """Collect the changes from interval to interval; a change that is undone at the same instant does not count.

    Instants closer than rounding are one, with the value after the last of them: where an impulse comes as its
    condition becomes true and turns the motion back, rounding decides whether the condition is true for a moment.
    """
    is_apart = np.append(begins[1:] - begins[:-1] > tolerances.SIDE_BY_SIDE * begins[-1], True)
    begins = begins[np.append(True, is_apart[:-1])]
    truth = truth[is_apart]
    changed = np.flatnonzero(truth[1:] != truth[:-1]) + 1
    return ConditionChanges(name, bool(truth[0]), begins[changed], truth[changed], np.zeros(len(changed)))


def estimate_errors(
    runner: Runner, runs: Sequence[Trajectory], number: int, condition_changes: ConditionChanges
) -> Array:
    """Estimate the errors of the instants of one condition's changes from the other runs, (n,)."""
    found = np.zeros(len(condition_changes.times))
    if not len(condition_changes.times):
        return found
    conditions, last = Conditions(runner.layout), float(runs[0].times[-1])
    for run in runs[1:]:
        instants = np.minimum(condition_changes.times, run.end_time)
        coordinates = evaluate_coordinates(runner, instants, runner.resample(run, instants))
        impulse_errors = find_impulse_time_differences(runs[0].impulse_events, run.impulse_events)
        for i, (t, value, jets) in enumerate(
            zip(condition_changes.times.tolist(), condition_changes.values.tolist(), coordinates, strict=True)
        ):
            apart = (
                impulse_errors[t]
                if t in impulse_errors
                else find_change_distance(conditions, number, (t, value, last), jets)
            )
            found[i] = np.maximum(found[i], 2.0 * apart)
    return found


def find_impulse_time_differences(
    impulses: Sequence[ImpulseEvent], others: Sequence[ImpulseEvent]
) -> dict[float, float]:
    """Return for each impulse of a run how much earlier or later another run has it; nan where that has none."""
    found = dict.fromkeys((blow.time for blow in impulses), UNKNOWN)
    for i, k in match_impulses(impulses, others):
        t = impulses[i].time
        found[t] = max(abs(others[k].time - t), tolerances.EPS * t)
    return found


def find_change_distance(
    conditions: Conditions, number: int, change: tuple[float, bool, float], coordinates: Coordinates
) -> float:
    """Return the time within which another run shows a change too; nan if not within a part of the run."""
    t, value, last = change
    d = tolerances.KERNEL["one_instant"] * max(t, 0.01 * last)
    while d <= tolerances.CLAIMED * last:
        sides = (conditions.evaluate_free(number, t, side * d, coordinates) for side in (-1.0, 1.0))
        if tuple(sides) == ((0.0, 1.0) if value else (1.0, 0.0)):
            return d
        d *= 2.0
    return UNKNOWN


def make_no_value_error(value: Expression, t: float) -> SolveError:
    """Make the error of a condition that has no value."""
    hint = "keep it within the domain of its functions, as with max(x, 0) or 'a if c else b', or within its tables"
    message = f"'{value.source.strip()}' has no value at t = {t:.9g} s"
    return SolveError(Problem("no-value", message, value.location, hint))


UNKNOWN = math.nan  # an unknown error


# Changes of what latches and frictions hold


def find_held_changes(layout: Layout, runs: Sequence[Trajectory], before_time: float) -> tuple[ConditionChanges, ...]:
    """Find when each latch catches and releases, and each friction sticks and slips, in the first of several runs,
    before an instant.
    """
    found = []
    for name, contacts in list_holding_contacts(layout).items():
        changes, *others = (find_held_changes_in_run(name, run, contacts) for run in runs)
        error = estimate_held_errors(changes, others)
        found.append(replace(changes, error=error).select_before(before_time))
    return tuple(found)


def list_holding_contacts(layout: Layout) -> dict[str, list[int]]:
    """List the contacts of each event of this kind by its name: a latch's own, and NAME_sticks for a friction.

    A friction that sticks in several directions, as in a cylinder, has a contact for each.
    """
    contacts_by_event = {layout.contacts[i].name: [i] for i in layout.latches}
    for i in layout.friction_contacts:
        name = name_sticking_event(layout.contacts[i].name.rpartition(".")[2])
        contacts_by_event.setdefault(name, []).append(i)
    return contacts_by_event


def find_held_changes_in_run(name: str, run: Trajectory, contacts: Sequence[int]) -> ConditionChanges:
    """Find when all of some contacts hold in one run; of several changes at one instant, the state after them
    counts.
    """
    is_held = np.asarray((run.holding[:, list(contacts)] > 0.0).all(axis=1))
    begins = np.concatenate([[0.0], run.ends])[: len(is_held)]
    is_last = np.append(begins[1:] != begins[:-1], True)
    begins, is_held = begins[is_last], is_held[is_last]
    changed = np.flatnonzero(is_held[1:] != is_held[:-1]) + 1
    return ConditionChanges(name, bool(is_held[0]), begins[changed], is_held[changed], np.zeros(len(changed)))


def estimate_held_errors(changes: ConditionChanges, others: Sequence[ConditionChanges]) -> Array:
    """Return twice the time by which other runs have each change earlier or later; nan where one lacks it, (n,)."""
    error = tolerances.EPS * changes.times
    for other in others:
        count = len(other.times)
        for k, t in enumerate(changes.times.tolist()):
            same = k < count and other.begins == changes.begins
            error[k] = max(error[k], 2.0 * abs(float(other.times[k]) - t)) if same else math.nan
    return np.asarray(error)
