"""Spins that nothing changes: of bodies symmetric about an axis, held, loaded and struck in points of that axis only.

    M . a = 0,  J = It (1 - a a^T) + I3 a a^T   =>   I3 Omegadot = 0,  Omega = omega . a       (Euler)
and the axis a moves as the angular momentum about it, I3 Omega, lets it, whatever I3 is. So another moment about the
axis may stand for it, with the spin that has the same angular momentum:
    I3' Omega' = I3 Omega,   R = R' rot(a, (Omega - Omega') t),   omega = omega' + (Omega - Omega') R a
A thin wire gets a moment that rounding of the moments about its axis does not accelerate, a fast top turns no faster
than it nutates. Where there is no inertia about the axis at all the spin is none, and multibody/tree/idle_spins.py sees
to it. Declined: what would turn with the body (a force in its axes), couples, pins, dampers in its balls.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record, replace
from heuncli.multibody.mechanism.model import Body, BushingLoad, Mechanism, PairLoad, PointLoad, RopeLoad, ThreadLoad
from heuncli.multibody.reduction.model import Reduction
from heuncli.multibody.reduction.slots import rotated
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.tables import Table, symmetric
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import about_axis, quaternion_product


@record
class Spin:
    """A spin that nothing changes: its axis (body axes), the moments about it and across it, at the farthest point.

    rate [rad/s].
    """

    axis: Array
    moment: float
    across: float
    rate: float

    @property
    def stand_in(self) -> float:
        """The moment about the axis that stands for its own."""
        return max(self.moment, self.across)

    @property
    def less(self) -> float:
        """By how much the body that stands for it spins slower [rad/s]."""
        return self.rate * (1.0 - self.moment / self.stand_in)


def step(scene: PreparedScene) -> Reduction | tuple[str, ...]:
    """The scene with bodies that spin slower, and have more inertia to do so; nothing if none can."""
    layout, mechanism = scene.layout, scene.mechanism
    found = {
        i: spin
        for i, spin in spins_of(scene).items()
        if (spin.rate != 0.0 and spin.moment < spin.across) or spin.moment < tolerances.SPINS_LIGHTLY * spin.across
    }
    if not found:
        return ()
    bodies = list(mechanism.bodies)
    omega = scene.start.angular_velocity.copy()
    for i, spin in found.items():
        bodies[i] = replace(bodies[i], inertia=bodies[i].inertia + added(spin))
        omega[i] -= spin.less * scene.start.rotation[i] @ spin.axis
    smaller = replace(mechanism, bodies=tuple(bodies))
    embed, restrict = partial(turned, layout, found, 1.0), partial(restricted, layout, found)
    tables = layout.tables | {"bodies": heavier(layout, found)}
    laid_out = replace(layout, mechanism=smaller, tables=tables, y0=restrict(0.0, layout.y0))
    start = replace(scene.start, angular_velocity=omega)
    told = tuple(sentence(bodies[i], spin) for i, spin in found.items())
    return Reduction(PreparedScene(smaller, start, scene.idle, laid_out), embed, restrict, told)


def sentence(body: Body, spin: Spin) -> str:
    """What was done to a body, and why that changes nothing."""
    return (
        f"bodies.{body.name} is symmetric about its axis and nothing turns it about that: its spin of {spin.rate:.4g} "
        f"rad/s stays, and one of {spin.rate - spin.less:.4g} rad/s with {spin.stand_in / spin.moment:.3g} times the "
        "inertia moves the axis alike"
    )


def added(spin: Spin) -> Array:
    """The inertia that a body is given about its axis, body axes."""
    return np.asarray((spin.stand_in - spin.moment) * np.outer(spin.axis, spin.axis))


def heavier(layout: Layout, spins: Mapping[int, Spin]) -> Table:
    """The kernel's bodies, with that inertia."""
    bodies = layout.bodies.copy()
    for i, spin in spins.items():
        row = bodies["inertia"][layout.place[i]]
        for name, more in zip(row.dtype.names or (), symmetric(added(spin)), strict=True):
            row[name] += more
    return bodies


def turned(layout: Layout, spins: Mapping[int, Spin], sense: float, times: Array, states: Array) -> Array:
    """States (n_t, n) with the bodies turned as their spins differ; sense: 1 to their own, -1 to what stands for them.

    They get the spin that they are known to have: of a thin wire a blow leaves roundings over its inertia beside it,
    which were an angular momentum if more inertia turned with them.
    """
    out = np.array(states, dtype=float)
    for i, spin in spins.items():
        row = layout.bodies[layout.place[i]]
        q, omega = (out[:, row[at] : row[at] + n] for at, n in (("attitude_at", 4), ("rate_at", 3)))
        n = rotated(q, spin.axis)
        rate = spin.rate if sense > 0.0 else spin.rate - spin.less
        omega += (rate - np.sum(omega * n, axis=1, keepdims=True)) * n
        q[:] = quaternion_product(q, about_axis(spin.axis, sense * spin.less * np.asarray(times, dtype=float)))
    return out


def restricted(layout: Layout, spins: Mapping[int, Spin], t: float, state: Array) -> Array:
    """The state of what stands for bodies in their state, (n,)."""
    return np.asarray(turned(layout, spins, -1.0, np.array([t]), np.asarray(state)[None, :])[0])


def spins_of(scene: PreparedScene) -> dict[int, Spin]:
    """The bodies with a spin that nothing changes, and inertia about its axis."""
    mechanism = scene.mechanism
    found: dict[int, Spin] = {}
    if mechanism.planar:
        return found
    idle = {spin.body for spin in scene.idle}
    points = {i: own for i, own in free_to_turn(mechanism).items() if i not in idle}
    if not points:
        return found
    moments, axes = np.linalg.eigh(np.array([mechanism.bodies[i].inertia for i in points]))
    for k, (i, own) in enumerate(points.items()):
        body = mechanism.bodies[i]
        rounding = rounding_of(body, float(moments[k, 2]), scene.layout.size)
        apart = (np.diff(moments[k]) > rounding).tolist()
        if all(apart):
            continue
        arms = np.array([point - body.center for point in own]).reshape(-1, 3)
        axis = axes[k][:, 0 if apart[0] else 2]
        far = float(np.sqrt(np.max(np.sum(np.square(arms), axis=1), initial=0.0)))
        if not any(apart) and far > 0.0:  # any axis: that through the points
            axis = arms[np.argmax(np.sum(np.square(arms), axis=1))] / far
        moment = float(axis @ body.inertia @ axis)
        across = 0.5 * (float(np.trace(body.inertia)) - moment)
        if moment > tolerances.NO_INERTIA * across and is_round(body, arms, axis, scene.layout.size, rounding):
            found[i] = Spin(axis, moment, across + body.mass * far**2, rate_about(scene.layout, i, axis))
    return found


def rounding_of(body: Body, largest: float, size: float) -> float:
    """By how much equal moments may differ: they are found from those about the origin, unless that is far away."""
    return tolerances.AXISYMMETRIC * (largest + body.mass * min(float(body.center @ body.center), size * size))


def rate_about(layout: Layout, i: int, axis: Array) -> float:
    """A body's spin about an axis of its own at the start [rad/s]."""
    row = layout.bodies[layout.place[i]]
    q, omega = layout.y0[row["attitude_at"] :][:4], layout.y0[row["rate_at"] :][:3]
    return float(omega @ rotated(q[None, :], axis)[0])


def is_round(body: Body, arms: Array, axis: Array, size: float, rounding: float) -> bool:
    """Whether a body is symmetric about an axis on which all points lie, arms (n, 3) from its centre; body axes."""
    moment = float(axis @ body.inertia @ axis)
    across = 0.5 * (float(np.trace(body.inertia)) - moment)
    about_axis = across * np.eye(3) + (moment - across) * np.outer(axis, axis)
    off = arms - np.outer(arms @ axis, axis)
    on_axis = bool((np.abs(off) <= tolerances.AXISYMMETRIC * size).all())
    return on_axis and bool(np.abs(body.inertia - about_axis).max() <= rounding)


def free_to_turn(mechanism: Mechanism) -> dict[int, list[Array]]:
    """Of the bodies that joints leave free to turn, and that no load or blow turns: the points where they act."""
    points: dict[int, list[Array]] = {i: [] for i in range(len(mechanism.bodies))}

    def acts(body: int, point: Array | None) -> None:
        if point is None:
            points.pop(body, None)
        elif body in points:
            points[body].append(point)

    for joint in mechanism.joints:
        kind = JOINTS[joint.kind]
        acts(joint.a, joint.p if kind.ball and not kind.wanders else None)
        acts(joint.b, joint.q if kind.ball else None)
    for load in mechanism.loads:
        if isinstance(load, PointLoad):
            acts(load.body, load.point if load.kind == "force" and not load.in_body else None)
        elif isinstance(load, PairLoad):
            acts(load.a, load.p)
            acts(load.b, load.q)
        elif isinstance(load, BushingLoad | ThreadLoad):
            acts(load.a, None)
            acts(load.b, None)
        elif isinstance(load, RopeLoad):
            continue  # its coupling stands below
        elif "turning" in JOINTS[mechanism.joints[load.joint].kind].motions:
            acts(mechanism.joints[load.joint].a, None)
            acts(mechanism.joints[load.joint].b, None)
    for coupling in mechanism.couplings:
        for body in coupling.bodies:
            acts(body, None)
    for named in mechanism.points.values():
        acts(named.body, named.place)
    for blow in mechanism.blows:
        acts(blow.body, blow.point if blow.kind == "impulse" else None)
    return points
