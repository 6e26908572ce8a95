"""The places where friction may stick; at rest those of one freedom stick together, as in all pins of a four-bar.

    q_i' = t_i q_L'     rates on one freedom, t_i the transmission from the leader L
    |sum of t_i value_i|  <=  sum of |t_i| limit_i            they stick

Their closure rows are proportional, so that how they share what holds the freedom is indeterminate, but not the sum.
With given limits some share is possible exactly where the sum is (the convex hull of all shares is an interval). The
rates are proportional where the response to unit friction is of rank 1:

    R_ij = t_i t_j R_LL
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.contacts.touching import find_free_response, make_unit_load
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.multibody.response import solve_impulses
from heuncli.multibody.tree.layout import Contact, Layout
from heuncli.results.results import Array, Mask
from heuncli.scene.shapes.rotations import quaternion_from_vector, quaternion_product

SEED = 58  # fixed: the same scene gives the same verdicts
SAMPLES = 8  # poses and instants at which the transmissions must be those of the present pose
DISPLACEMENT = 1e-3  # of those poses [rad], or relative to the scene's size


class FrictionGroup(NamedTuple):
    """Frictions that stick or slip together.

    members: numbers of the places where friction may stick, their leader first
    transmissions: rate of each per unit rate of the leader, 1 for that
    """

    members: tuple[int, ...]
    transmissions: tuple[float, ...]

    @property
    def leader(self) -> int:
        """The member in whose coordinate the group's friction is counted."""
        return self.members[0]

    def sum_at_leader(self, values: Array) -> float:
        """Return the friction of the group at its leader, for values (k,) of all places."""
        return sum(t * float(values[k]) for k, t in zip(self.members, self.transmissions, strict=True))


class PlaceResponse(NamedTuple):
    """What unit friction in one place does to another, while none sticks.

    response (k, k): accelerations of all places by unit friction in each, [1/kg] or [1/(kg m^2)]
    noise (k,): rounding of the accelerations [m/s^2 or rad/s^2], from all loads and weights: guards the test whether
    what slips accelerates in its direction
    slack (k,): rounding of the friction that holds a place [N or N m]: guards the test whether it is within its limit
    rounding (k,): of a place's own response, in its unit, from that of free bodies: guards the tests whether it can
    move, and whether two can only move together
    """

    response: Array
    noise: Array
    slack: Array
    rounding: Array

    @property
    def moves(self) -> Mask:
        """Whether anything lets a place move, (k,)."""
        return np.asarray(np.diag(self.response) > self.rounding)

    def is_proportional(self, k: int, leader: int) -> bool:
        """Return whether two places that can move do so only together."""
        own, other = float(self.response[k, k]), float(self.response[leader, leader])
        rounding = float(self.rounding[k]) * other + float(self.rounding[leader]) * own
        return own * other - float(self.response[k, leader]) ** 2 <= rounding + tolerances.CONTACT_RATE * own * other

    def find_transmission(self, k: int, leader: int) -> float:
        """Return the rate of a place per unit rate of another one that moves only with it."""
        return float(self.response[k, leader] / self.response[leader, leader])


class FrictionPlaces:
    """The places of a scene where friction may stick: a place is one coordinate of one friction, and has a contact.

    presses (k,): whether the joint's own load tells its size; has_one_size: static friction is kinetic everywhere
    is_given: no friction depends on a load; is_convex: so that one choice of states agrees at most
    """

    def __init__(self, evaluator: Evaluator) -> None:
        self.evaluator, self.layout = evaluator, evaluator.layout
        self.indices = list(self.layout.friction_contacts)
        self.contacts = [self.layout.contacts[i] for i in self.indices]
        self.rows = [contact.row for contact in self.contacts]
        self.load_rows = [contact.load_row for contact in self.contacts]
        self.names = [contact.name for contact in self.contacts]
        loads = self.layout.tables["loads"][self.load_rows]
        self.presses = loads["normal_force_kind"] != kernel.GIVEN
        self.has_one_size = bool((loads["breakaway"] == loads["coefficient"]).all())
        self.is_given = not self.layout.mechanism.joint_friction
        self.is_convex = self.is_given and self.has_one_size

    def set_states(
        self,
        contact_states: Array,
        sticks: Array | Mask,
        coordinate_or_sign: Array,
        groups: Sequence[FrictionGroup] = (),
    ) -> Array:
        """Return contact states in which friction sticks at a coordinate, in groups, or slips with a sign."""
        contact_states = contact_states.copy()
        if self.indices:
            contact_states[self.indices] = sticks
            contact_states[self.layout.friction_slice] = coordinate_or_sign
            contact_states[self.layout.group_slice] = list_group_numbers(groups, self.indices)
        return contact_states

    def release_all(self, contact_states: Array) -> Array:
        """Return contact states in which no friction sticks or acts."""
        none = np.zeros(len(self.indices))
        return self.set_states(contact_states, none, none)

    def has_row(self, group: FrictionGroup, row: int | None) -> bool:
        """Return whether a closure row is that of a member of a group."""
        return any(self.rows[k] == row for k in group.members)

    def evaluate(self, t: float, state: Array, contact_states: Array) -> Evaluation:
        """Evaluate a state with given contact states."""
        return self.evaluator.evaluate(np.array([t]), state[None, :], holding=contact_states)


def measure_response(
    evaluator: Evaluator, contacts: Sequence[Contact], open_states: Array, opened: Evaluation
) -> PlaceResponse:
    """Measure the response of places at a state.

    contacts: of the places; open_states: contact states in which no friction sticks; opened: the results with these
    """
    layout, rows = evaluator.layout, [contact.row for contact in contacts]
    units = np.array([make_unit_load(layout, opened, contact, 1.0) for contact in contacts])
    units = units.reshape(len(contacts), len(layout.place), 6)
    jumps = np.zeros((len(units), len(layout.freedoms) + len(layout.rows)))
    evaluator.workspace.hold(layout.closed_contacts(open_states))
    t, state = float(opened.times[0]), opened.states[0]
    columns = solve_impulses(evaluator.workspace, t, state, units, jumps).columns.bodies
    motion = np.concatenate([columns["alpha"], columns["a"]], axis=2)
    response = np.einsum("kbi,cbi->kc", units, motion)
    weights = float(layout.bodies["mass"].sum() * np.abs(layout.mechanism.gravity).sum())
    loads = np.abs(opened.loads["force"][0]).sum() + np.abs(opened.loads["moment"][0]).sum() / layout.size
    own = np.abs(np.diag(response))
    effect = own * layout.tables["closures"][rows]["weight"] * (weights + float(loads))
    noise = np.asarray(tolerances.CONTACT_ACCELERATION * (opened.rows["terms"][0, rows] + effect))
    slack = 2.0 * noise / np.where(own > 0.0, own, np.inf)
    rounding = tolerances.NO_ANSWER * find_free_response(layout, units)
    return PlaceResponse(0.5 * (response + response.T), noise, slack, rounding)


def make_groups(
    response: PlaceResponse, places: Sequence[int], can_join: Mask, present_groups: Sequence[FrictionGroup] = ()
) -> list[FrictionGroup]:
    """Group the places at rest; a place that no other moves with is a group of its own.

    can_join (k,): whether a place may be in a group with others
    present_groups: those that stick already, whose leaders stay
    """
    leaders = [group.leader for group in present_groups if group.leader in places]
    groups: list[tuple[list[int], list[float]]] = []
    for k in [*leaders, *(k for k in places if k not in leaders)]:
        for members, transmissions in groups:
            can_be_joined = all(can_join[i] and response.moves[i] for i in (k, members[0]))
            if can_be_joined and response.is_proportional(k, members[0]):
                members.append(k)
                transmissions.append(response.find_transmission(k, members[0]))
                break
        else:
            groups.append(([k], [1.0]))
    return [FrictionGroup(tuple(members), tuple(transmissions)) for members, transmissions in groups]


def has_fixed_transmissions(
    evaluator: Evaluator,
    contacts: Sequence[Contact],
    sticking_states: Array,
    open_states: Array,
    opened: Evaluation,
    groups: Sequence[FrictionGroup],
    end_time: float,
) -> bool:
    """Return whether the transmissions within groups stay what they are while these stick, whatever else moves.

    They are compared with those in poses displaced along all other freedoms, and at later instants of drives.

    sticking_states, open_states: contact states in which the groups stick, and in which no friction does
    opened: the results at the state with the latter
    end_time: of the run [s]
    """
    layout, t = evaluator.layout, float(opened.times[0])
    states = displace_freedoms(layout, opened.states[0])
    times = np.linspace(t, max(t, end_time), SAMPLES + 1)[1:] if layout.has_laws else np.full(SAMPLES, t)
    poses = evaluator.evaluate(times, states, holding=sticking_states)
    if not (poses.gap <= tolerances.OPEN_GAP * layout.size).all():
        return False
    for time, state in zip(times, poses.states, strict=True):
        there = evaluator.evaluate(np.array([time]), state[None, :], holding=open_states)
        response = measure_response(evaluator, contacts, open_states, there)
        for group in groups:
            for k, transmission in zip(group.members, group.transmissions, strict=True):
                if not response.moves[k] or not response.is_proportional(k, group.leader):
                    return False
                change = abs(response.find_transmission(k, group.leader) - transmission)
                if change > tolerances.DEPENDENT_SHARES * abs(transmission):
                    return False
    return True


def displace_freedoms(layout: Layout, state: Array) -> Array:
    """Return states (SAMPLES, n) displaced at random along all scalar freedoms and turned in all balls."""
    rng = np.random.default_rng(SEED)
    states = np.repeat(state[None, :], SAMPLES, axis=0)
    for freedom in layout.freedoms:
        if freedom.q >= 0:
            states[:, freedom.q] += DISPLACEMENT * rng.uniform(-1.0, 1.0, SAMPLES) / layout.weights[freedom.u]
    for place in layout.bodies["attitude_at"][layout.bodies["ball"] == 1].tolist():
        attitudes = slice(place, place + 4)
        turns = quaternion_from_vector(DISPLACEMENT * rng.uniform(-1.0, 1.0, (SAMPLES, 3)))
        states[:, attitudes] = quaternion_product(turns, states[:, attitudes])
    return states


def list_group_numbers(groups: Sequence[FrictionGroup], contacts: Sequence[int]) -> Array:
    """Return what the kernel is to know of groups of several members, (2 k,): for each place the contact of its leader,
    counted from 1, and its transmission; 0 for others.

    contacts (k,): number of the contact of each place
    """
    numbers = np.zeros((len(contacts), 2))
    for group in groups:
        if len(group.members) > 1:
            numbers[list(group.members), 0] = contacts[group.leader] + 1
            numbers[list(group.members), 1] = group.transmissions
    return numbers.ravel()
