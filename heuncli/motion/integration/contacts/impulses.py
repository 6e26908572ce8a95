"""Solve impulses: at an instant velocities jump, and impulses run through all joints.

    M (V+ - V-) = H + J' Lambda,   J (V+ - V-) = -(jumps of the prescribed rates)           (45)-(48), (50)

H are given impulses. What is driven jumps by as much as its prescribed rate does, and by nothing else. There is one
column of this linear map for each cause: each given impulse, and the drives together. Positions stay.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base.records import record, replace
from heuncli.motion.integration.contacts.shared_impulses import (
    SharedImpulse,
    find_shared_impulses,
    list_bilateral_contacts,
    select_loaded,
)
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.motion.integration.integrated_scene import just_before
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.response import Columns, ImpulseColumns, solve_impulses
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array
from heuncli.scene.expressions.discontinuities import MAX_TIED_DOUBLES, find_jumps
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.shapes.rotations import cross_rows

DRIVES = "drives"  # the cause besides the given impulses
SINGLE_INSTANT = 0.0  # end of the run [s] where there is none


@record
class GivenImpulse:
    """What happens at one instant by prescription: impulses, and drives whose rates jump.

    before_time, after_time: the last instant before it and the first after it [s]
    numbers: indices in mechanism.impulses
    drives: for each driven joint, the rates before and after
    """

    before_time: float
    after_time: float
    numbers: tuple[int, ...]
    drives: dict[int, tuple[float, float]]

    @property
    def written_time(self) -> float:
        """Of the instants that rounding does not separate, the one with the shortest decimal form, which a user
        means: 0.3, not 0.30000000000000004.
        """
        double_count = (
            int(np.diff(np.array([self.before_time, self.after_time]).view(np.int64))[0])
            if self.before_time >= 0.0
            else 0
        )
        if not 1 < double_count <= 2 * MAX_TIED_DOUBLES:
            return self.after_time
        instants = np.arange(double_count) + np.array(math.nextafter(self.before_time, math.inf)).view(np.int64)
        return float(min(instants.view(np.float64).tolist(), key=lambda t: len(repr(t))))

    def is_past(self, t: float) -> bool:
        """Return whether a run that continues from an instant t [s] has it behind itself."""
        return self.before_time < t or self.after_time <= t

    def merge(self, other: GivenImpulse) -> GivenImpulse:
        """Merge with another one, which begins at the same time or later."""
        drives = dict(self.drives)
        for owner, (before, after) in other.drives.items():  # of two jumps of one drive: from before the first
            drives[owner] = (self.drives[owner][0] if owner in self.drives else before, after)
        return GivenImpulse(
            self.before_time, max(self.after_time, other.after_time), (*self.numbers, *other.numbers), drives
        )

    def list_names(self, mechanism: Mechanism) -> tuple[str, ...]:
        """Return the names of what acts."""
        laws = {law.owner: law.name for law in mechanism.laws}
        return (*(mechanism.impulses[i].name for i in self.numbers), *(laws[k] for k in self.drives))


@record
class BodyImpulse:
    """A given impulse on a body: force [N s], moment [N m s] about the world position `position`; (3,), world axes."""

    number: int
    force: Array
    moment: Array
    position: Array


@record
class ImpulseEvent:
    """An impulse that happened.

    evaluation: results at the state before it, with the columns of jumps (1, n_c) as `causes`
    causes: names of these columns
    impulses: the given impulses
    after_state: the state after it, projected onto the closures
    kinetic: energy before and after [J]
    work: work of all impulses [J]
    contact_states: of all contacts after it (Contacts.contact_states)
    shared_impulses: contacts for which a model says how they share it
    display_time: its instant as reported, where rounding leaves several
    """

    time: float
    names: tuple[str, ...]
    evaluation: Evaluation
    causes: tuple[str, ...]
    impulses: tuple[BodyImpulse, ...]
    after_state: Array
    kinetic: tuple[float, float]
    work: float
    contact_states: Array = np.zeros(0)
    shared_impulses: tuple[SharedImpulse, ...] = ()
    display_time: float | None = None

    @property
    def reported_time(self) -> float:
        """The instant as it is reported [s]."""
        return self.time if self.display_time is None else self.display_time


def find_rate_jumps(value: Expression, last: float) -> list[tuple[float, float, float, float]]:
    """Return where within (0, last] the rate of a drive jumps: the instants before and after, and the rates there."""
    return find_jumps(value, last, order=1) if value.time_dependent else []


def schedule_impulses(mechanism: Mechanism, last: float) -> list[GivenImpulse]:
    """Return the impulses given at instants within [0, last], ascending; those of one instant are merged.

    Instants that rounding does not separate count as one: where one begins before the other has ended.
    """
    given = [
        GivenImpulse(before, after, (), {law.owner: (first, then)})
        for law in mechanism.laws
        for before, after, first, then in find_rate_jumps(law.value, last)
    ]
    for i, impulse in enumerate(mechanism.impulses):
        # without a time it acts where its condition becomes true (run/triggers.py)
        if impulse.when is None and impulse.time <= last:
            before = just_before(impulse.time) if impulse.time > 0.0 else 0.0
            given.append(GivenImpulse(before, impulse.time, (i,), {}))
    merged: list[GivenImpulse] = []
    for one in sorted(given, key=lambda one: one.before_time):
        if (merged and one.before_time < merged[-1].after_time) or (merged and one.after_time == merged[-1].after_time):
            merged[-1] = merged[-1].merge(one)
        else:
            merged.append(one)
    return merged


@record
class RightSides:
    """Right sides of the equations of an impulse at a state: a column for each given impulse and one for all drives.

    still: results at that state
    impulses: in world axes
    loads: columns (n_b, 6), moment about the joint point and force
    jumps: columns (n_f + n_rows,), jumps of the prescribed rates
    causes: names of the columns
    """

    still: Evaluation
    impulses: tuple[BodyImpulse, ...]
    loads: list[Array]
    jumps: list[Array]
    causes: tuple[str, ...]


def make_right_sides(
    evaluator: Evaluator, given_impulse: GivenImpulse, state: Array, contact_states: Array
) -> RightSides:
    """Make the right sides at a state (n,) just before the impulse acts.

    contact_states: all contacts are open, with columns of their own, except for latches that hold
    """
    layout, mechanism = evaluator.layout, evaluator.layout.mechanism
    still = evaluator.evaluate(np.array([given_impulse.before_time]), state[None, :], holding=contact_states)
    impulses = tuple(make_body_impulse(layout, still.bodies[0], i) for i in given_impulse.numbers)
    n_b, n_u = len(layout.place), len(layout.freedoms) + len(layout.rows)
    loads, jumps = (
        [find_impulse_column(layout, still.bodies[0], one) for one in impulses],
        [np.zeros(n_u)] * len(impulses),
    )
    if given_impulse.drives:
        loads.append(np.zeros((n_b, 6)))
        jumps.append(find_prescribed_jumps(layout, given_impulse))
    causes = tuple(mechanism.impulses[i].name for i in given_impulse.numbers) + (
        (DRIVES,) if given_impulse.drives else ()
    )
    return RightSides(still, impulses, loads, jumps, causes)


def solve_impulse(evaluator: Evaluator, given_impulse: GivenImpulse, state: Array, time: float) -> ImpulseEvent:
    """Solve a given impulse at a state (n,) of a scene without contacts."""
    sides = make_right_sides(evaluator, given_impulse, state, evaluator.layout.open_contacts)
    solution = solve_impulses(
        evaluator.workspace,
        given_impulse.before_time,
        sides.still.states[0],
        np.array(sides.loads),
        np.array(sides.jumps),
    )
    after_state, work = find_state_after(evaluator.layout, given_impulse, sides, solution.columns)
    loaded_contacts = select_loaded(list_bilateral_contacts(evaluator.layout), solution.columns.multipliers)
    shared = find_shared_impulses(
        loaded_contacts,
        np.zeros((len(loaded_contacts), len(loaded_contacts)), dtype=bool),
        solution.columns.multipliers,
    )
    impulse_result = ImpulseResult(
        time, solution, sides.causes, after_state, work, np.zeros(0), shared_impulses=tuple(shared)
    )
    return make_impulse_event(evaluator, given_impulse, sides, impulse_result)


def find_state_after(
    layout: Layout, given_impulse: GivenImpulse, sides: RightSides, columns: Columns
) -> tuple[Array, float]:
    """Return the state after columns of jumps, and the work of what is given [J]."""
    total = columns.sum()
    work = compute_impulse_work(layout, sides.still.bodies[0], total, sides.impulses) + compute_drive_work(
        layout, given_impulse, total
    )
    return add_jump(layout, sides.still.states[0], total), work


@record
class ImpulseResult:
    """The solution of an impulse: its columns by cause, the state and contact states after it, the work of all [J].

    struck_names: the contacts that take part in it, also those that share what others bear
    shared_impulses: see ImpulseEvent
    """

    time: float
    solution: ImpulseColumns
    causes: tuple[str, ...]
    after_state: Array
    work: float
    contact_states: Array
    struck_names: tuple[str, ...] = ()
    shared_impulses: tuple[SharedImpulse, ...] = ()


def make_impulse_event(
    evaluator: Evaluator, given_impulse: GivenImpulse, sides: RightSides, result: ImpulseResult
) -> ImpulseEvent:
    """Make the event with its energies from the solution of the impulse."""
    layout, solution, after_state = evaluator.layout, result.solution, result.after_state.copy()
    if layout.work_at >= 0:
        after_state[layout.work_at] += result.work
    after_evaluation = evaluator.evaluate(
        np.array([given_impulse.after_time]), after_state[None, :], holding=result.contact_states
    )
    still = replace(
        sides.still, causes=solution.columns.select(None), residual=np.array([solution.unmet.max()]),
        massless_count=np.array([float(solution.massless_count)]),
    )  # fmt: skip
    kinetic = (
        compute_kinetic_energy(layout, still.bodies[0]),
        compute_kinetic_energy(layout, after_evaluation.bodies[0]),
    )
    names = tuple(dict.fromkeys((*given_impulse.list_names(layout.mechanism), *result.struck_names)))
    return ImpulseEvent(
        result.time,
        names,
        still,
        result.causes,
        sides.impulses,
        after_evaluation.states[0],
        kinetic,
        result.work,
        result.contact_states,
        result.shared_impulses,
        given_impulse.written_time if given_impulse.before_time < result.time < given_impulse.after_time else None,
    )


def make_body_impulse(layout: Layout, bodies: Table, number: int) -> BodyImpulse:
    """Return a given impulse in world axes; bodies: their present results."""
    impulse = layout.mechanism.impulses[number]
    place = layout.place[impulse.body]
    R, r = bodies["R"][place], bodies["r"][place]
    point = impulse.point if impulse.point is not None else layout.mechanism.bodies[impulse.body].center
    vector = R @ impulse.vector if impulse.in_body else impulse.vector
    none = np.zeros(3)
    force, moment = (none, vector) if impulse.kind == "couple" else (vector, none)
    return BodyImpulse(number, force, moment, r + R @ (point - layout.reference[place]))


def find_impulse_column(layout: Layout, bodies: Table, impulse: BodyImpulse) -> Array:
    """Return an impulse as a column of loads, (n_b, 6): moment about the body's joint point, force."""
    place = layout.place[layout.mechanism.impulses[impulse.number].body]
    loads = np.zeros((len(bodies), 6))
    loads[place, :3] = impulse.moment + cross_rows(impulse.position - bodies["r"][place], impulse.force)
    loads[place, 3:] = impulse.force
    return loads


def find_prescribed_jumps(layout: Layout, given_impulse: GivenImpulse) -> Array:
    """Return the jumps of the prescribed rates, of the freedoms and then of the closure rows."""
    jumps = {k: then - first for k, (first, then) in given_impulse.drives.items()}
    freedoms = [jumps.get(f.joint, 0.0) if f.q < 0 else 0.0 for f in layout.freedoms]
    is_driven = layout.tables["closures"]["program"]["count"] > 0
    return np.array(
        freedoms
        + [jumps.get(k, 0.0) if has_drive else 0.0 for k, has_drive in zip(layout.rows, is_driven, strict=True)]
    )


def add_jump(layout: Layout, state: Array, jump: Columns) -> Array:
    """Return the state with its rates changed by a column of jumps (n_b, n_f); driven freedoms have no rate in the
    state.
    """
    after_state = state.copy()
    for body, change in zip(layout.bodies, jump.bodies, strict=True):
        if body["ball"]:
            after_state[body["rate_at"] : body["rate_at"] + 3] += change["alpha"]
    for freedom, change in zip(layout.freedoms, jump.freedoms, strict=True):
        if freedom.q >= 0:
            after_state[freedom.u] += change["udot"]
    return after_state


def compute_impulse_work(layout: Layout, bodies: Table, jump: Columns, impulses: tuple[BodyImpulse, ...]) -> float:
    """Return the work of given impulses [J]: each with the mean of the velocities before and after, where it acts."""
    work = 0.0
    for impulse in impulses:
        place = layout.place[layout.mechanism.impulses[impulse.number].body]
        body, velocity_jump = bodies[place], jump.bodies[place]
        omega = body["omega"] + 0.5 * velocity_jump["alpha"]
        v = body["v"] + 0.5 * velocity_jump["a"] + cross_rows(omega, impulse.position - body["r"])
        work += float(impulse.force @ v + impulse.moment @ omega)
    return work


def compute_drive_work(layout: Layout, given_impulse: GivenImpulse, jump: Columns) -> float:
    """Return the work of the drives' impulses [J], with the mean of the prescribed rates before and after.

    A drive whose rate does not jump does work too: its impulse times that rate.
    """
    work = 0.0
    for law in layout.mechanism.laws:
        k = law.owner
        steady_rate = law.value.derivatives(given_impulse.after_time)[1]
        rate = 0.5 * sum(given_impulse.drives.get(k, (steady_rate, steady_rate)))
        if law.quantity == "length":
            work += rate * float(jump.multipliers[layout.rows.index(k)])
        else:
            driven_freedoms = [n for n, freedom in enumerate(layout.freedoms) if freedom.joint == k and freedom.q < 0]
            work += rate * float(jump.freedoms["drive"][driven_freedoms].sum())
    return work


def compute_kinetic_energy(layout: Layout, bodies: Table) -> float:
    """Return the kinetic energy of all bodies [J]; bodies in tree order."""
    energy = 0.0
    for place, link in enumerate(layout.spanning.links):
        body, body_row = layout.mechanism.bodies[link.body], bodies[place]
        v = body_row["v"] + cross_rows(body_row["omega"], body_row["R"] @ (body.center - layout.reference[place]))
        w = body_row["R"].T @ body_row["omega"]
        energy += 0.5 * (body.mass * float(v @ v) + float(w @ body.inertia @ w))
    return energy


def compute_free_impulse_energy(layout: Layout, impulses: Sequence[BodyImpulse]) -> float:
    """Return the energy [J] that given impulses would give to their bodies' mass if no joint held them."""
    energy = 0.0
    for impulse in impulses:
        mass = float(layout.mechanism.scale_masses[layout.mechanism.impulses[impulse.number].body])
        arm = impulse.moment / layout.size
        energy += 0.5 * float(impulse.force @ impulse.force + arm @ arm) / mass
    return energy
