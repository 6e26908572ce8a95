"""Blows: at an instant velocities jump, and impulses run through all joints.

    M (V+ - V-) = H + J' Lambda,   J (V+ - V-) = -(jumps of the prescribed rates)           (45)-(48), (50), (51)
H are given impulses; what is driven jumps by as much as its prescribed rate does, and by nothing else. One column of
the one linear map a cause: each given impulse, the drives together. Positions stay.
"""

from __future__ import annotations

import numpy as np

from heuncli import tolerances
from heuncli.errors import Problem, SolveError
from heuncli.expressions.discontinuities import discontinuities, one_sided_limits
from heuncli.expressions.programs import Expression
from heuncli.integration.evaluator import Evaluator, Recovered
from heuncli.integration.loop import Integration, Steps, just_after, just_before
from heuncli.mechanism.model import Mechanism
from heuncli.records import record, replace
from heuncli.response import Columns, blows
from heuncli.results import Array
from heuncli.tree.layout import Layout
from heuncli.tree.tables import Table

DRIVES = "drives"  # the cause beside the given impulses


@record
class Given:
    """What is given to happen at one instant: impulses, and drives whose rates jump.

    before, after: the last instant before it and the first behind; blows: places in mechanism.blows; drives: of joints,
    from which rate to which.
    """

    before: float
    after: float
    blows: tuple[int, ...]
    drives: dict[int, tuple[float, float]]

    def names(self, mechanism: Mechanism) -> tuple[str, ...]:
        """The names of what acts."""
        drives = (mechanism.joints[k].drive for k in self.drives)
        return (*(mechanism.blows[i].name for i in self.blows), *(d.name for d in drives if d is not None))


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
    all impulses [J].
    """

    time: float
    names: tuple[str, ...]
    recovered: Recovered
    causes: tuple[str, ...]
    impulses: tuple[Impulse, ...]
    after: Array
    kinetic: tuple[float, float]
    work: float


def rate_jumps(value: Expression, last: float) -> list[tuple[float, float, float, float]]:
    """Where within (0, last] the rate of a drive jumps: the instants before and behind, and the rates there."""
    found = []
    instants = discontinuities(value, 0.0, just_after(last)) if last > 0.0 and value.time_dependent else []
    for before, after in one_sided_limits(instants):
        first, then = value.derivatives(before)[1], value.derivatives(after)[1]
        if before > 0.0 and abs(then - first) > tolerances.SAME_VALUE * max(abs(first), abs(then), 1.0):
            found.append((before, after, first, then))
    return found


def schedule(mechanism: Mechanism, last: float) -> list[Given]:
    """The blows that are given within [0, last], ascending; those of one instant together."""
    at: dict[float, tuple[list[int], dict[int, tuple[float, float]]]] = {}
    befores: dict[float, float] = {}
    for k, joint in enumerate(mechanism.joints):
        for before, after, first, then in rate_jumps(joint.drive.value, last) if joint.drive is not None else ():
            befores[after] = before
            at.setdefault(after, ([], {}))[1][k] = (first, then)
    for i, blow in enumerate(mechanism.blows):
        with_drive = next((t for t, before in befores.items() if before < blow.time <= t), blow.time)
        at.setdefault(with_drive, ([], {}))[0].append(i)
    return [
        Given(befores.get(t, just_before(t) if t > 0.0 else 0.0), t, tuple(at[t][0]), at[t][1]) for t in sorted(at)
    ]


def strike(evaluator: Evaluator, given: Given, state: Array, time: float) -> Jump:
    """What blows make of a state, at an instant."""
    layout, mechanism = evaluator.layout, evaluator.layout.mechanism
    still = evaluator.recovered(np.array([given.before]), state[None, :])
    impulses = tuple(impulse(layout, still.bodies[0], i) for i in given.blows)
    n_b, n_u = len(layout.place), len(layout.freedoms) + len(layout.rows)
    loads, jumps = [column(layout, still.bodies[0], one) for one in impulses], [np.zeros(n_u)] * len(impulses)
    if given.drives:
        loads.append(np.zeros((n_b, 6)))
        jumps.append(prescribed(layout, given))
    found = blows(evaluator.workspace, given.before, still.states[0], np.array(loads), np.array(jumps))
    causes = tuple(mechanism.blows[i].name for i in given.blows) + ((DRIVES,) if given.drives else ())
    whole = found.columns.sum()
    after = jumped(layout, still.states[0], whole)
    work = work_of_impulses(layout, still.bodies[0], whole, impulses) + work_of_drives(layout, given, whole)
    if layout.work_at >= 0:
        after[layout.work_at] += work
    behind = evaluator.recovered(np.array([given.after]), after[None, :])
    still = replace(
        still, causes=found.columns.at(None), residual=np.array([found.unmet.max()]), idle=np.array([float(found.idle)])
    )  # fmt: skip
    kinetic = kinetic_energy(layout, still.bodies[0]), kinetic_energy(layout, behind.bodies[0])
    return Jump(time, given.names(mechanism), still, causes, impulses, behind.states[0], kinetic, work)


class Blows:
    """The given blows of a run, each done where the run comes to its instant. Changes the run."""

    def __init__(self, evaluator: Evaluator, run: Integration, steps: Steps, last: float) -> None:
        self.evaluator, self.run, self.steps = evaluator, run, steps
        self.due = schedule(evaluator.layout.mechanism, last)
        self.done: list[Jump] = []

    def until(self, t: float, reached: float) -> str | None:
        """Those up to an instant, behind the one that the run has reached: it goes on from the state behind them.

        A rope that would have to push in one of them: the run ends before it. Raises SolveError if that is the start.
        """
        while self.due and self.due[0].after <= t:
            jump = strike(self.evaluator, self.due.pop(0), np.array(self.run.loop.state()), reached)
            rope = pushing(self.evaluator.layout, jump)
            if rope is not None and reached > 0.0:
                return rope
            require_pull(rope)
            self.run.loop.jump(jump.after)
            self.steps.stand(jump.after)
            self.done.append(jump)
        return None


def at_once(evaluator: Evaluator, state: Array) -> tuple[Jump, ...]:
    """The blow at the start of a scene of which nothing else is asked."""
    jumps = tuple(strike(evaluator, given, state, 0.0) for given in schedule(evaluator.layout.mechanism, 0.0)[:1])
    for jump in jumps:
        require_pull(pushing(evaluator.layout, jump))
    return jumps


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
        joint = layout.mechanism.joints[k]
        if joint.tension_only and joint.restitution is None and impulses[r] > tolerances.NO_FORCE * largest:
            return joint.name
    return None


def require_pull(rope: str | None) -> None:
    """Raise SolveError for a rope that would have to push in a blow at the start."""
    if rope is not None:
        message = f"in the blow at t = 0 s the rod {rope} would have to push (tension_only)"
        hint = "with restitution: 0 (to 1) it goes slack, and catches again"
        raise SolveError(Problem("rope-pushes", message, hint=hint))


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
    loads[place, :3] = given.moment + np.cross(given.at - bodies["r"][place], given.force)
    loads[place, 3:] = given.force
    return loads


def prescribed(layout: Layout, given: Given) -> Array:
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
        v = body["v"] + 0.5 * change["a"] + np.cross(omega, given.at - body["r"])
        work += float(given.force @ v + given.moment @ omega)
    return work


def work_of_drives(layout: Layout, given: Given, jump: Columns) -> float:
    """Work of the drives' impulses, by the mean of the prescribed rates before and behind [J].

    A drive whose rate stays works, too: its impulse times that rate.
    """
    work = 0.0
    for k, joint in enumerate(layout.mechanism.joints):
        if joint.drive is None:
            continue
        steady = joint.drive.value.derivatives(given.after)[1]
        rate = 0.5 * sum(given.drives.get(k, (steady, steady)))
        if joint.drive.quantity == "length":
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
        v = own["v"] + np.cross(own["omega"], own["R"] @ (body.center - layout.reference[place]))
        w = own["R"].T @ own["omega"]
        energy += 0.5 * (body.mass * float(v @ v) + float(w @ body.inertia @ w))
    return energy
