"""Blows: at an instant velocities jump, and impulses run through all joints.

    M (V+ - V-) = H + J' Lambda,   J (V+ - V-) = -(jumps of the prescribed rates)           (45)-(48), (50)
H are given impulses; what is driven jumps by as much as its prescribed rate does, and by nothing else. One column of
the one linear map a cause: each given impulse, the drives together. Positions stay.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base.records import record, replace
from heuncli.motion.integration.contacts.shared_impulses import (
    SharedImpulse,
    find_shared_impulses,
    held_contacts,
    loaded,
)
from heuncli.motion.integration.evaluator import Evaluator, Recovered
from heuncli.motion.integration.segments import just_before
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.response import Blows as Answered
from heuncli.multibody.response import Columns, blows
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array
from heuncli.scene.expressions.discontinuities import MOST_EQUAL, jumps
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.shapes.rotations import cross_rows

DRIVES = "drives"  # the cause beside the given impulses


@record
class GivenBlow:
    """What is given to happen at one instant: impulses, and drives whose rates jump.

    before, after: the last instant before it and the first behind; blows: places in mechanism.blows; drives: of joints,
    from which rate to which.
    """

    before: float
    after: float
    blows: tuple[int, ...]
    drives: dict[int, tuple[float, float]]

    @property
    def written_time(self) -> float:
        """Of the instants that rounding does not tell apart the one that is written most briefly: a user means that."""
        count = int(np.diff(np.array([self.before, self.after]).view(np.int64))[0]) if self.before >= 0.0 else 0
        if not 1 < count <= 2 * MOST_EQUAL:
            return self.after
        instants = np.arange(count) + np.array(math.nextafter(self.before, math.inf)).view(np.int64)
        return float(min(instants.view(np.float64).tolist(), key=lambda t: len(repr(t))))

    def is_due(self, t: float) -> bool:
        """Whether a run that goes on from an instant t [s] has it behind itself."""
        return self.before < t or self.after <= t

    def with_other(self, other: GivenBlow) -> GivenBlow:
        """Both together; `other` begins with it, or later."""
        drives = {**self.drives, **other.drives}
        return GivenBlow(self.before, max(self.after, other.after), (*self.blows, *other.blows), drives)

    def names(self, mechanism: Mechanism) -> tuple[str, ...]:
        """The names of what acts."""
        laws = {law.owner: law.name for law in mechanism.laws}
        return (*(mechanism.blows[i].name for i in self.blows), *(laws[k] for k in self.drives))


@record
class Impulse:
    """A given impulse on a body: force [N s], moment [N m s] about the world position `at`; (3,), world axes."""

    blow: int
    force: Array
    moment: Array
    at: Array


@record
class Jump:
    """A blow that happened.

    recovered: the kernel's answers at the state before it, with `causes` the columns of jumps, (1, n_c); causes: their
    names; impulses: the given ones; after: the state behind, settled; kinetic: energy before and behind [J]; work: of
    all impulses [J]; holding (contacts,): which are closed behind it; shared: contacts of which a model says how they
    share it; told: its instant as it is told, where rounding leaves several.
    """

    time: float
    names: tuple[str, ...]
    recovered: Recovered
    causes: tuple[str, ...]
    impulses: tuple[Impulse, ...]
    after: Array
    kinetic: tuple[float, float]
    work: float
    holding: Array = np.zeros(0)
    shared: tuple[SharedImpulse, ...] = ()
    told: float | None = None

    @property
    def told_time(self) -> float:
        """The instant as it is told."""
        return self.time if self.told is None else self.told


def rate_jumps(value: Expression, last: float) -> list[tuple[float, float, float, float]]:
    """Where within (0, last] the rate of a drive jumps: the instants before and behind, and the rates there."""
    return jumps(value, last, order=1) if value.time_dependent else []


def schedule(mechanism: Mechanism, last: float) -> list[GivenBlow]:
    """The blows that are given at instants within [0, last], ascending; those of one instant together.

    One instant is also what rounding does not tell apart: where one begins before the other has ended.
    """
    given = [
        GivenBlow(before, after, (), {law.owner: (first, then)})
        for law in mechanism.laws
        for before, after, first, then in rate_jumps(law.value, last)
    ]
    for i, blow in enumerate(mechanism.blows):
        if blow.when is None:  # else it is struck where that becomes true (run/triggers.py)
            before = just_before(blow.time) if blow.time > 0.0 else 0.0
            given.append(GivenBlow(before, blow.time, (i,), {}))
    found: list[GivenBlow] = []
    for one in sorted(given, key=lambda one: one.before):
        if (found and one.before < found[-1].after) or (found and one.after == found[-1].after):
            found[-1] = found[-1].with_other(one)
        else:
            found.append(one)
    return found


@record
class RightSides:
    """What is given at a state: right sides of the equations of the blow, a column each impulse and one for all drives.

    still: the kernel's answers at that state; impulses: in world axes; loads: columns (n_b, 6), moment about the joint
    point and force; jumps: columns (n_f + n_rows,) of what the prescribed rates jump by; causes: names of the columns.
    """

    still: Recovered
    impulses: tuple[Impulse, ...]
    loads: list[Array]
    jumps: list[Array]
    causes: tuple[str, ...]


def right_sides(evaluator: Evaluator, given: GivenBlow, state: Array, holding: Array) -> RightSides:
    """What is given at a state (n,) just before it acts; holding: all contacts are open, and columns of their own, but
    for latches that hold.
    """
    layout, mechanism = evaluator.layout, evaluator.layout.mechanism
    still = evaluator.recovered(np.array([given.before]), state[None, :], holding=holding)
    impulses = tuple(impulse(layout, still.bodies[0], i) for i in given.blows)
    n_b, n_u = len(layout.place), len(layout.freedoms) + len(layout.rows)
    loads, jumps = [column(layout, still.bodies[0], one) for one in impulses], [np.zeros(n_u)] * len(impulses)
    if given.drives:
        loads.append(np.zeros((n_b, 6)))
        jumps.append(prescribed(layout, given))
    causes = tuple(mechanism.blows[i].name for i in given.blows) + ((DRIVES,) if given.drives else ())
    return RightSides(still, impulses, loads, jumps, causes)


def strike(evaluator: Evaluator, given: GivenBlow, state: Array, time: float) -> Jump:
    """The blow that is given at a state (n,) of a scene without contacts."""
    sides = right_sides(evaluator, given, state, evaluator.layout.all_open)
    found = blows(
        evaluator.workspace, given.before, sides.still.states[0], np.array(sides.loads), np.array(sides.jumps)
    )
    after, work = state_behind(evaluator.layout, given, sides, found.columns)
    own = loaded(held_contacts(evaluator.layout), found.columns.multipliers)
    shared = find_shared_impulses(own, np.zeros((len(own), len(own)), dtype=bool), found.columns.multipliers)
    blow = BlowResult(time, found, sides.causes, after, work, np.zeros(0), shared=tuple(shared))
    return jump_of(evaluator, given, sides, blow)


def state_behind(layout: Layout, given: GivenBlow, sides: RightSides, columns: Columns) -> tuple[Array, float]:
    """The state behind columns of jumps, and the work of what is given [J]."""
    whole = columns.sum()
    work = work_of_impulses(layout, sides.still.bodies[0], whole, sides.impulses) + work_of_drives(layout, given, whole)
    return jumped(layout, sides.still.states[0], whole), work


@record
class BlowResult:
    """What a blow came to: its columns by cause, the state behind it, the work of all, the contacts closed there.

    struck: the contacts that take part in it, also those that share what others bear; shared: see Jump.
    """

    time: float
    found: Answered
    causes: tuple[str, ...]
    after: Array
    work: float
    holding: Array
    struck: tuple[str, ...] = ()
    shared: tuple[SharedImpulse, ...] = ()


def jump_of(evaluator: Evaluator, given: GivenBlow, sides: RightSides, blow: BlowResult) -> Jump:
    """The blow with its energies; blow: what the impulses came to."""
    layout, found, after = evaluator.layout, blow.found, blow.after.copy()
    if layout.work_at >= 0:
        after[layout.work_at] += blow.work
    then = evaluator.recovered(np.array([given.after]), after[None, :], holding=blow.holding)
    still = replace(
        sides.still, causes=found.columns.at(None), residual=np.array([found.unmet.max()]),
        idle=np.array([float(found.idle)]),
    )  # fmt: skip
    kinetic = kinetic_energy(layout, still.bodies[0]), kinetic_energy(layout, then.bodies[0])
    names = tuple(dict.fromkeys((*given.names(layout.mechanism), *blow.struck)))
    return Jump(
        blow.time, names, still, blow.causes, sides.impulses, then.states[0], kinetic, blow.work, blow.holding,
        blow.shared, given.written_time if given.before < blow.time < given.after else None,
    )  # fmt: skip


def impulse(layout: Layout, bodies: Table, i: int) -> Impulse:
    """A given impulse in world axes; bodies: where they are."""
    blow = layout.mechanism.blows[i]
    place = layout.place[blow.body]
    R, r = bodies["R"][place], bodies["r"][place]
    point = blow.point if blow.point is not None else layout.mechanism.bodies[blow.body].center
    vector = R @ blow.vector if blow.in_body else blow.vector
    none = np.zeros(3)
    force, moment = (none, vector) if blow.kind == "couple" else (vector, none)
    return Impulse(i, force, moment, r + R @ (point - layout.reference[place]))


def column(layout: Layout, bodies: Table, given: Impulse) -> Array:
    """An impulse as a column of loads, (n_b, 6): moment about the body's joint point, force."""
    place = layout.place[layout.mechanism.blows[given.blow].body]
    loads = np.zeros((len(bodies), 6))
    loads[place, :3] = given.moment + cross_rows(given.at - bodies["r"][place], given.force)
    loads[place, 3:] = given.force
    return loads


def prescribed(layout: Layout, given: GivenBlow) -> Array:
    """The jumps of the prescribed rates, of the freedoms and then of the closure rows."""
    jumps = {k: then - first for k, (first, then) in given.drives.items()}
    freedoms = [jumps.get(f.joint, 0.0) if f.q < 0 else 0.0 for f in layout.freedoms]
    driven = layout.tables["closures"]["program"]["count"] > 0
    return np.array(freedoms + [jumps.get(k, 0.0) if own else 0.0 for k, own in zip(layout.rows, driven, strict=True)])


def jumped(layout: Layout, state: Array, jump: Columns) -> Array:
    """The state with its rates changed by a column of jumps (n_b, n_f); what is driven has none in the state."""
    after = state.copy()
    for body, answer in zip(layout.bodies, jump.bodies, strict=True):
        if body["ball"]:
            after[body["rate_at"] : body["rate_at"] + 3] += answer["alpha"]
    for freedom, answer in zip(layout.freedoms, jump.freedoms, strict=True):
        if freedom.q >= 0:
            after[freedom.u] += answer["udot"]
    return after


def work_of_impulses(layout: Layout, bodies: Table, jump: Columns, impulses: tuple[Impulse, ...]) -> float:
    """Work of given impulses: each by the mean of the velocities before and behind, where it acts [J]."""
    work = 0.0
    for given in impulses:
        place = layout.place[layout.mechanism.blows[given.blow].body]
        body, change = bodies[place], jump.bodies[place]
        omega = body["omega"] + 0.5 * change["alpha"]
        v = body["v"] + 0.5 * change["a"] + cross_rows(omega, given.at - body["r"])
        work += float(given.force @ v + given.moment @ omega)
    return work


def work_of_drives(layout: Layout, given: GivenBlow, jump: Columns) -> float:
    """Work of the drives' impulses, by the mean of the prescribed rates before and behind [J].

    A drive whose rate stays works, too: its impulse times that rate.
    """
    work = 0.0
    for law in layout.mechanism.laws:
        k = law.owner
        steady = law.value.derivatives(given.after)[1]
        rate = 0.5 * sum(given.drives.get(k, (steady, steady)))
        if law.quantity == "length":
            work += rate * float(jump.multipliers[layout.rows.index(k)])
        else:
            own = [n for n, freedom in enumerate(layout.freedoms) if freedom.joint == k and freedom.q < 0]
            work += rate * float(jump.freedoms["drive"][own].sum())
    return work


def kinetic_energy(layout: Layout, bodies: Table) -> float:
    """Of all bodies [J], tree order."""
    energy = 0.0
    for place, hang in enumerate(layout.spanning.hangs):
        body, own = layout.mechanism.bodies[hang.body], bodies[place]
        v = own["v"] + cross_rows(own["omega"], own["R"] @ (body.center - layout.reference[place]))
        w = own["R"].T @ own["omega"]
        energy += 0.5 * (body.mass * float(v @ v) + float(w @ body.inertia @ w))
    return energy


def met_freely(layout: Layout, impulses: Sequence[Impulse]) -> float:
    """The energy [J] that given impulses would bring to their bodies' mass, if no joint held them."""
    energy = 0.0
    for given in impulses:
        mass = layout.mechanism.bodies[layout.mechanism.blows[given.blow].body].mass
        arm = given.moment / layout.size
        energy += 0.5 * float(given.force @ given.force + arm @ arm) / mass
    return energy
