"""The records of a contact event, from what is given to its solution, and the errors of what cannot be solved."""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record
from heuncli.base.spelling import join_names
from heuncli.motion.integration.contacts.impulses import GivenImpulse, ImpulseEvent, RightSides
from heuncli.motion.integration.contacts.latches import LatchCatch
from heuncli.motion.integration.contacts.restitution import ContactImpulses
from heuncli.motion.integration.contacts.touching import TouchingContacts
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.multibody.response import Columns, ImpulseColumns
from heuncli.multibody.tree.layout import Layout
from heuncli.results.results import Array, Indices, Mask


@record
class ContactProblem:
    """The touching contacts, and how their rates respond to impulses.

    touching: the k contacts
    A (k, k): rates of opening from unit impulses (restitution.py)
    moves (k,): whether a load at a contact would move anything
    rates (k,): rates of opening that given impulses and drives add
    """

    touching: TouchingContacts
    A: Array
    moves: Mask
    rates: Array


@record
class EventSetting:
    """What an event is solved from.

    sides: right sides of the impulse equations; `sides.still`: the results just before the event
    units: columns of what is given, then of a unit impulse at each touching contact
    catches: latches that catch; the last columns of what is given are those of the ones with a rate
    unwatched: contacts that a latch holds at their limits
    latch_states: contact states in which only latches hold
    row: closure row of the contact that closed or opened, None if no contact caused the event
    shortest_flight: duration [s] below which the flight after a rebound does not count
    """

    given_impulse: GivenImpulse
    sides: RightSides
    units: ImpulseColumns
    problem: ContactProblem
    catches: list[LatchCatch]
    unwatched: Indices
    latch_states: Array
    row: int | None
    shortest_flight: float


@record
class ContactOutcome:
    """The solution of an event.

    impulses: of the touching contacts (k,)
    touching_states (k,): which of them are held from here on, and how (multibody/tree/layout.py)
    at_rest (k,): those at rest because their rebound would never be seen
    columns: of what is given, and of the touching contacts with their impulses
    after_state: the state after all impulses
    work: of all impulses [J]
    """

    impulses: ContactImpulses
    touching_states: Array
    at_rest: Mask
    columns: Columns
    after_state: Array
    work: float


def require_energy(event: ImpulseEvent, energy_scale: float) -> None:
    """Raise SolveError if the energies before and after an impulse and the work of its impulses do not add up.

    energy_scale: energy that the impulses would bring alone, which joints and others may take back
    """
    before, after = event.kinetic
    size = max(before, after, abs(event.work), tolerances.UNBALANCED * energy_scale)
    if not abs(after - before - event.work) <= tolerances.UNBALANCED * size:
        message = f"at t = {event.time:.9g} s the energy balance of the impulse on {', '.join(event.names)} is not met"
        raise SolveError(
            Problem(
                "blow-unbalanced", message, None, "a singular position, or nearly identical contacts", event.names[0]
            )
        )


def require_smooth(layout: Layout, given_impulse: GivenImpulse, is_closed: Mask) -> None:
    """Raise SolveError for a rope that may go slack and is taut where the rate of its length jumps."""
    for k, contact in enumerate(layout.contacts):
        if is_closed[k] and contact.is_rope and contact.joint in given_impulse.drives:
            first, then = given_impulse.drives[contact.joint]
            message = (
                f"at t = {given_impulse.after_time:.9g} s the rate of the length of {contact.name} "
                f"jumps from {first:.6g} to "
                f"{then:.6g} m/s while it is taut: heun cannot solve this jump of a rope that may go slack"
            )
            hint = (
                "change the rate over a short time, as max(t - 0.2, 0)**2; or leave out restitution: it then stays taut"
            )
            raise SolveError(Problem("rope-jerked", message, None, hint, layout.mechanism.owner_path(contact.joint)))


def require_caught(
    evaluator: Evaluator, sides: RightSides, solution: ImpulseColumns, catches: list[LatchCatch], t: float
) -> None:
    """Raise SolveError for latches that catch a joint that cannot stop, because drives and joints prescribe its
    rate.
    """
    allowed_residual = float(evaluator.allowed_residual(sides.still.gap)[0])
    moving_catches = [catch for catch in catches if catch.rate != 0.0]
    first = len(sides.loads) - len(moving_catches)
    for k, catch in enumerate(moving_catches):
        if not solution.unmet[first + k] <= allowed_residual:
            contact = evaluator.layout.contacts[catch.contact]
            joint = evaluator.layout.mechanism.joints[contact.joint].name
            message = (
                f"at t = {t:.9g} s {contact.name} catches the joint {joint}, but drives or other latches keep it moving"
            )
            hint = "stop the drive there, release the other latch before, or catch later: when"
            raise SolveError(Problem("latch-contradicts", message, None, hint, f"latches.{contact.name}"))


def require_yielding(layout: Layout, problem: ContactProblem, opening: Array, noise: Array, t: float) -> None:
    """Raise SolveError for contacts that close on, though nothing that they load can move: drives prescribe it.

    opening (k,): the rates, or the accelerations, at which the contacts open
    """
    mechanism = layout.mechanism
    is_driven_on = ~problem.moves & (opening < -noise)
    if not (is_driven_on.any() and mechanism.laws):
        return
    contact = layout.contacts[problem.touching.indices[np.flatnonzero(is_driven_on)[0]]]
    owner = mechanism.owner_path(contact.joint)
    drives = join_names([law.name for law in mechanism.laws])
    if contact.is_rope:
        message = f"at t = {t:.9g} s the rope {contact.name} is taut, and the prescribed motion ({drives}) stretches it"
        hint = "end the prescribed motion before, or give the rope a stiffness"
    else:
        message = f"at t = {t:.9g} s the drive ({drives}) pushes against the stop {contact.name} of {owner}"
        hint = "end the prescribed motion before the stop, or drive by a force or torque, which yield"
    raise SolveError(
        Problem(
            "stop-contradicts", message, hint=hint, entry_path=owner if contact.is_rope else f"stops.{contact.name}"
        )
    )
