"""Interrupt a run for given impulses at their instants, and for contacts that close, are struck or released.

It changes the run, which continues from the state after them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record, replace
from heuncli.motion.integration.contacts.impulses import (
    SINGLE_INSTANT,
    GivenImpulse,
    ImpulseEvent,
    schedule_impulses,
    solve_impulse,
)
from heuncli.motion.integration.contacts.shared_impulses import format_sharing
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.integration.integrated_scene import Segment
from heuncli.motion.integration.run.progress import RunProgress
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

if TYPE_CHECKING:  # loaded only for scenes with contacts
    from heuncli.motion.integration.contacts.contact_events import Contacts
    from heuncli.motion.integration.contacts.latches import LatchCondition


class Interruptions:
    """The impulses of a run, each solved where the run reaches its instant, and its contacts. Changes the run.

    pending: given impulses still to come
    events: impulses that happened

    Impulses are solved in the full scene, even if a reduced one is integrated in its place.
    """

    def __init__(self, progress: RunProgress) -> None:
        self.progress, self.scene, self.integrated_scene = progress, progress.scene, progress.integrated_scene
        self.pending = schedule_impulses(self.scene.layout.mechanism, progress.last)
        self.events: list[ImpulseEvent] = []
        self.contacts = make_contacts(self.scene, progress.last)

    def apply_until(self, t: float, reached_time: float) -> str | None:
        """Apply the given impulses that are due up to t [s]; the run, at `reached_time` [s], continues from the state
        after them.

        Returns the rope, if there is one, that would have to push in one of them: the run then ends before it. Raises
        SolveError if that is the start.
        """
        while self.pending and self.pending[0].is_past(t):
            event = self.solve_event(self.pending.pop(0), reached_time)
            if event is None:
                continue
            rope = find_pushing_rope(self.scene.layout, event)
            if rope is not None and reached_time > 0.0:
                return rope
            require_pull(self.scene.layout.mechanism, rope)
            self.continue_after(event)
        return None

    def apply_triggered(
        self, t: float, blows: tuple[int, ...], latch_conditions: tuple[LatchCondition, ...] | None
    ) -> str | None:
        """Apply the impulses whose conditions became true at the instant reached, as `apply_until` does for others.

        latch_conditions: conditions of the latches there
        """
        event = self.solve_event(GivenImpulse(t, t, blows, {}), t, latch_conditions=latch_conditions)
        rope = None if event is None else find_pushing_rope(self.scene.layout, event)
        if event is not None and rope is None:
            self.continue_after(event)
        return rope

    def solve_event(
        self,
        given_impulse: GivenImpulse,
        time: float,
        row: int | None = None,
        latch_conditions: tuple[LatchCondition, ...] | None = None,
    ) -> ImpulseEvent | None:
        """Solve a given impulse at the state reached, with that of its contacts; row: of the contact that closed."""
        state = self.integrated_scene.embed_state(time, self.progress.integrated_state)
        if self.contacts is None:
            return solve_impulse(self.scene, given_impulse, state, time)
        return self.contacts.handle_event(given_impulse, state, time, row, latch_conditions)

    def handle_contacts(
        self, t: float, row: int | None = None, latch_conditions: tuple[LatchCondition, ...] | None = None
    ) -> None:
        """Handle the contacts at the instant reached.

        row: the integrated scene's closure row of the contact that closed or opened there, if one did
        latch_conditions: conditions of the latches there, if they are known
        """
        if self.contacts is None:
            return
        if row is not None:
            self.contacts.notes.count_event(t)
            row = self.scene.layout.contacts[self.integrated_scene.find_contact(row)].row
        event = self.solve_event(GivenImpulse(t, t, (), {}), t, row, latch_conditions)
        if event is not None:
            self.continue_after(event)

    def begin_segment(self, segment: Segment) -> None:
        """Continue the run from the state reached, with the contacts that are closed there."""
        if self.contacts is not None:
            self.integrated_scene.workspace.hold(self.contacts.contact_states)
            self.progress.steps.record_holding(self.contacts.contact_states)
        self.progress.kernel.loop.begin(*segment)

    def continue_after(self, event: ImpulseEvent) -> None:
        """Continue the run from the state after an impulse."""
        after_state = self.integrated_scene.restrict(event.time, event.after_state)
        self.progress.kernel.loop.jump(after_state)
        self.progress.steps.restart_from(after_state)
        self.events.append(replace(event, after_state=self.integrated_scene.embed_state(event.time, after_state)))

    @property
    def notes(self) -> tuple[str, ...]:
        """The notes on the contacts."""
        return collect_notes(self.scene.layout, self.events, self.contacts)


def collect_notes(layout: Layout, events: Sequence[ImpulseEvent], contacts: Contacts | None) -> tuple[str, ...]:
    """Collect the notes on contacts and the impulses of a run; how they share these comes first."""
    sentences = []
    if any(jump.shared_impulses for jump in events):
        sentences += format_sharing([(jump.time, jump.shared_impulses) for jump in events], layout.mechanism.impacts)
    if contacts is not None:
        sentences += [*contacts.notes.sentences, *(f"{name} did not catch" for name in contacts.latches.unused_names)]
    return tuple(sentences)


def find_closed_at_start(scene: Evaluator) -> Array:
    """Return the contacts of a scene that are closed at its start, (contacts,)."""
    from heuncli.motion.integration.contacts.contact_events import find_held_contacts  # few scenes have them

    return find_held_contacts(scene, 0.0, scene.layout.y0)


def make_contacts(evaluator: Evaluator, last: float) -> Contacts | None:
    """Return the contacts of a run, or None if there are none."""
    if not evaluator.layout.contacts:
        return None
    from heuncli.motion.integration.contacts.contact_events import Contacts  # few scenes have them

    return Contacts(evaluator, last)


@record
class SingleInstant:
    """The impulse at the only instant of a scene: the impulse, if there is one, and notes on the contacts."""

    events: tuple[ImpulseEvent, ...] = ()
    notes: tuple[str, ...] = ()


def solve_single_instant(evaluator: Evaluator, state: Array, t: float) -> SingleInstant:
    """Solve the impulse at the only instant of a scene: the given one, and that of its contacts."""
    contacts = make_contacts(evaluator, SINGLE_INSTANT)
    given_impulses = [
        given_impulse for given_impulse in schedule_impulses(evaluator.layout.mechanism, SINGLE_INSTANT) if t == 0.0
    ][:1]
    if not given_impulses and contacts is not None:
        given_impulses = [GivenImpulse(t, t, (), {})]
    for given_impulse in given_impulses:
        event = (
            contacts.handle_event(given_impulse, state, t, None)
            if contacts is not None
            else solve_impulse(evaluator, given_impulse, state, t)
        )
        if event is not None:
            require_pull(evaluator.layout.mechanism, find_pushing_rope(evaluator.layout, event))
            return SingleInstant((event,), collect_notes(evaluator.layout, [event], contacts))
    return SingleInstant()


def find_pushing_rope(layout: Layout, event: ImpulseEvent) -> str | None:
    """Return the rope that would have to push in an impulse and cannot go slack, if there is one."""
    columns = event.evaluation.causes
    assert columns is not None
    impulses = columns.multipliers[0].sum(axis=0)
    largest = max(
        np.abs(columns.multipliers[0]).max(initial=0.0), np.abs(columns.bodies["joint_force"]).max(initial=0.0),
        *(np.abs(impulse.force).max() + np.abs(impulse.moment).max() / layout.size for impulse in event.impulses),
    )  # fmt: skip
    for r, k in enumerate(layout.rows):
        if impulses[r] > tolerances.NO_FORCE * largest and is_ending_rope(layout, r, k):
            return layout.mechanism.owner_path(k).partition(".")[2]
    return None


def is_ending_rope(layout: Layout, r: int, owner: int) -> bool:
    """Return whether a closure row is a rope at which a run ends where it would push."""
    mechanism = layout.mechanism
    if owner < len(mechanism.joints):
        joint = mechanism.joints[owner]
        return joint.can_open and joint.restitution is None and r == layout.rows.index(owner)
    rows, k = mechanism.couplings[owner - len(mechanism.joints)].rows, r - layout.rows.index(owner)
    if k >= len(rows):  # friction of a thread
        return False
    row = rows[k]
    return row.tension_only and row.restitution is None


def require_pull(mechanism: Mechanism, rope: str | None) -> None:
    """Raise SolveError for what would have to push in an impulse at the start: a rope of a joint or a coupling.

    Also for a cam's follower that lifts off, or a path that would have to pull.
    """
    if rope in {joint.name for joint in mechanism.joints if joint.one_sided}:
        message = f"in the impulse at t = 0 s the path of joint {rope} would have to pull (one_sided)"
        hint = "with restitution: 0 (to 1) its point lifts off, and impacts again"
        raise SolveError(Problem("rope-pushes", message, hint=hint, entry_path=f"joints.{rope}"))
    if rope is not None:
        kind = {coupling.name: coupling.entry.type for coupling in mechanism.couplings}.get(rope)
        lost = f"the {kind or 'rod'} {rope} would have to push (tension_only)"
        hint = "with restitution: 0 (to 1) it goes slack, and becomes taut again with an impact"
        if kind == "cam":
            lost = f"contact is lost: the follower of cam {rope} lifts off"
            hint = "with restitution: 0 (to 1) it lifts off, and impacts again"
        where = "joints" if kind is None else "couplings"
        raise SolveError(
            Problem("rope-pushes", f"in the impulse at t = 0 s {lost}", hint=hint, entry_path=f"{where}.{rope}")
        )
