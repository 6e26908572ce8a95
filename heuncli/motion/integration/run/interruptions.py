"""What interrupts a run: given blows at their instants, and contacts that close, are struck or let go.

Changes the run: it goes on from the state behind.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record, replace
from heuncli.motion.integration.contacts.blows import GivenBlow, Jump, schedule, strike
from heuncli.motion.integration.contacts.shared_impulses import sharing_sentences
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.motion.integration.run.progress import Progress
from heuncli.motion.integration.segments import Segment
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array

if TYPE_CHECKING:  # loaded where something opens and closes
    from heuncli.motion.integration.contacts.contact_events import Contacts
    from heuncli.motion.integration.contacts.latches import Bolts


class Interruptions:
    """The blows of a run, each done where the run comes to its instant, and its contacts. Changes the run.

    due: given blows still to come; done: the blows that happened. They are solved in the scene itself, whatever is
    integrated in its place.
    """

    def __init__(self, progress: Progress) -> None:
        self.progress, self.scene, self.moving = progress, progress.scene, progress.moving
        self.due = schedule(self.scene.layout.mechanism, progress.last)
        self.done: list[Jump] = []
        self.contacts = contacts_of(self.scene, progress.last)

    def until(self, t: float, reached: float) -> str | None:
        """Do the given blows that are due up to t [s]; the run, at `reached` [s], goes on from the state behind them.

        The rope, if there is one, that would have to push in one of them: the run then ends before it. Raises
        SolveError if that is the start.
        """
        while self.due and self.due[0].is_due(t):
            jump = self.meet(self.due.pop(0), reached)
            if jump is None:
                continue
            rope = pushing(self.scene.layout, jump)
            if rope is not None and reached > 0.0:
                return rope
            require_pull(self.scene.layout.mechanism, rope)
            self.take(jump)
        return None

    def strike(self, t: float, blows: tuple[int, ...], said: Bolts | None) -> str | None:
        """Do the blows whose conditions became true at an instant that the run has reached; as `until` does others.

        said: what the conditions of latches say there.
        """
        jump = self.meet(GivenBlow(t, t, blows, {}), t, said=said)
        rope = None if jump is None else pushing(self.scene.layout, jump)
        if jump is not None and rope is None:
            self.take(jump)
        return rope

    def meet(self, given: GivenBlow, time: float, row: int | None = None, said: Bolts | None = None) -> Jump | None:
        """The blow that is given at the state reached, and that of its contacts; row: of the one that closed."""
        state = self.moving.state(time, self.progress.integrated_state)
        if self.contacts is None:
            return strike(self.scene, given, state, time)
        return self.contacts.meet(given, state, time, row, said)

    def settle(self, t: float, row: int | None = None, said: Bolts | None = None) -> None:
        """Do what contacts do at an instant that the run has reached.

        row: the closure row, in what is integrated, of the contact that closed or opened there, if one did; said: what
        the conditions of latches say there, if it is told.
        """
        if self.contacts is None:
            return
        if row is not None:
            self.contacts.count(t)
            row = self.scene.layout.contacts[self.moving.contact(row)].row
        jump = self.meet(GivenBlow(t, t, (), {}), t, row, said)
        if jump is not None:
            self.take(jump)

    def begin(self, segment: Segment) -> None:
        """The run goes on from the state reached, with the contacts that are closed there."""
        if self.contacts is not None:
            self.moving.workspace.hold(self.contacts.holding)
            self.progress.steps.hold(self.contacts.holding)
        self.progress.kernel.loop.begin(*segment)

    def take(self, jump: Jump) -> None:
        """Go on from behind a blow."""
        after = self.moving.restrict(jump.time, jump.after)
        self.progress.kernel.loop.jump(after)
        self.progress.steps.stand(after)
        self.done.append(replace(jump, after=self.moving.state(jump.time, after)))

    @property
    def notes(self) -> tuple[str, ...]:
        """What is to be told of the contacts."""
        return notes_of(self.scene.layout, self.done, self.contacts)


def notes_of(layout: Layout, jumps: Sequence[Jump], contacts: Contacts | None) -> tuple[str, ...]:
    """What is to be told of contacts and the blows of a run: how they share these first."""
    found = []
    if any(jump.shared for jump in jumps):
        found += sharing_sentences([(jump.time, jump.shared) for jump in jumps], layout.mechanism.impacts)
    if contacts is not None:
        found += [*contacts.notes, *(f"{name} did not catch" for name in contacts.latches.idle)]
    return tuple(found)


def closed_at_start(scene: Evaluator) -> Array:
    """The contacts of a scene that are closed at its start, (contacts,)."""
    from heuncli.motion.integration.contacts.contact_events import held_at  # few scenes have them

    return held_at(scene, 0.0, scene.layout.y0)


def contacts_of(evaluator: Evaluator, last: float) -> Contacts | None:
    """The contacts of a run, where there are any."""
    if not evaluator.layout.contacts:
        return None
    from heuncli.motion.integration.contacts.contact_events import Contacts  # few scenes have them

    return Contacts(evaluator, last)


@record
class AtOnce:
    """What happens at the only instant of a scene: the blow, if there is one, and what is to be told of contacts."""

    jumps: tuple[Jump, ...] = ()
    notes: tuple[str, ...] = ()


def at_once(evaluator: Evaluator, state: Array, t: float) -> AtOnce:
    """The blow at the only instant of a scene: the one that is given, and that of its contacts."""
    contacts = contacts_of(evaluator, t)
    given = [one for one in schedule(evaluator.layout.mechanism, 0.0) if t == 0.0][:1]
    if not given and contacts is not None:
        given = [GivenBlow(t, t, (), {})]
    for one in given:
        jump = contacts.meet(one, state, t, None) if contacts is not None else strike(evaluator, one, state, t)
        if jump is not None:
            require_pull(evaluator.layout.mechanism, pushing(evaluator.layout, jump))
            return AtOnce((jump,), notes_of(evaluator.layout, [jump], contacts))
    return AtOnce()


def pushing(layout: Layout, jump: Jump) -> str | None:
    """The rope that would have to push in a blow, if there is one that does not go slack."""
    columns = jump.recovered.causes
    assert columns is not None
    impulses = columns.multipliers[0].sum(axis=0)
    largest = max(
        np.abs(columns.multipliers[0]).max(initial=0.0), np.abs(columns.bodies["joint_force"]).max(initial=0.0),
        *(np.abs(given.force).max() + np.abs(given.moment).max() / layout.size for given in jump.impulses),
    )  # fmt: skip
    for r, k in enumerate(layout.rows):
        if impulses[r] > tolerances.NO_FORCE * largest and ends_pushed(layout, r, k):
            return layout.mechanism.owner(k).partition(".")[2]
    return None


def ends_pushed(layout: Layout, r: int, owner: int) -> bool:
    """Whether a closure row is a rope at which a run ends where it would push."""
    mechanism = layout.mechanism
    if owner < len(mechanism.joints):
        joint = mechanism.joints[owner]
        return joint.opens and joint.restitution is None and r == layout.rows.index(owner)
    row = mechanism.couplings[owner - len(mechanism.joints)].rows[r - layout.rows.index(owner)]
    return row.tension_only and row.restitution is None


def require_pull(mechanism: Mechanism, rope: str | None) -> None:
    """Raise SolveError for what would have to push in a blow at the start: a rope, of a joint or a coupling.

    Or a cam's follower that lifts, or a path that would have to pull.
    """
    if rope in {joint.name for joint in mechanism.joints if joint.one_sided}:
        message = f"in the blow at t = 0 s the path of joint {rope} would have to pull (one_sided)"
        hint = "with restitution: 0 (to 1) its point flies off, and strikes again"
        raise SolveError(Problem("rope-pushes", message, hint=hint, about=f"joints.{rope}"))
    if rope is not None:
        kind = {coupling.name: coupling.given.type for coupling in mechanism.couplings}.get(rope)
        lost = f"the {kind or 'rod'} {rope} would have to push (tension_only)"
        hint = "with restitution: 0 (to 1) it goes slack, and catches again"
        if kind == "cam":
            lost = f"contact is lost: the follower of cam {rope} lifts off"
            hint = "with restitution: 0 (to 1) it flies, and strikes again"
        where = "joints" if kind is None else "couplings"
        raise SolveError(Problem("rope-pushes", f"in the blow at t = 0 s {lost}", hint=hint, about=f"{where}.{rope}"))
