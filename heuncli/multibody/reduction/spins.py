"""Reduce constant spins: of bodies symmetric about an axis, held, loaded and struck in points of that axis only.

    M . a = 0,  J = It (1 - a a^T) + I3 a a^T   =>   I3 Omegadot = 0,  Omega = omega . a       (Euler)

and the axis a moves as the angular momentum about it, I3 Omega, lets it, whatever I3 is. So another moment of inertia
about the axis may replace it, with the spin that has the same angular momentum:

    I3' Omega' = I3 Omega,   R = R' rot(a, (Omega - Omega') t),   omega = omega' + (Omega - Omega') R a

A thin wire gets a moment of inertia large enough against the rounding of moments about its axis, and a fast top turns
no faster than it nutates. Where there is no inertia about the axis at all there is no spin, which
multibody/tree/prepare.py handles. Not reduced: bodies with loads that turn with them (a force in their axes),
couples, pins, dampers in their balls.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record, replace
from heuncli.multibody.mechanism.loads import BushingLoad, PairLoad, PointLoad, RopeLoad, ThreadLoad
from heuncli.multibody.mechanism.model import Body, Mechanism
from heuncli.multibody.reduction.compose import Reduction
from heuncli.multibody.reduction.state_embedding import rotate_vector
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.multibody.tree.tables import Table, to_sym3
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import quaternion_product, quaternions_about


@record
class Spin:
    """A constant spin: its axis (body axes), the moments of inertia about it and across it, at the farthest point.

    rate [rad/s]
    """

    axis: Array
    moment: float
    transverse_moment: float
    rate: float

    @property
    def replacement_moment(self) -> float:
        """The moment of inertia about the axis that replaces its own."""
        return max(self.moment, self.transverse_moment)

    @property
    def rate_reduction(self) -> float:
        """How much slower the replacing body spins [rad/s]."""
        return self.rate * (1.0 - self.moment / self.replacement_moment)


def step(scene: PreparedScene) -> Reduction | tuple[str, ...]:
    """Make the scene with bodies that spin slower, with larger inertia; return nothing if there are none."""
    layout, mechanism = scene.layout, scene.mechanism
    spins = {
        i: spin
        for i, spin in find_constant_spins(scene).items()
        if (spin.rate != 0.0 and spin.moment < spin.transverse_moment)
        or spin.moment < tolerances.SPINS_LIGHTLY * spin.transverse_moment
    }
    if not spins:
        return ()
    bodies = list(mechanism.bodies)
    omega = scene.start.angular_velocity.copy()
    for i, spin in spins.items():
        bodies[i] = replace(bodies[i], inertia=bodies[i].inertia + added_inertia(spin))
        omega[i] -= spin.rate_reduction * scene.start.rotation[i] @ spin.axis
    smaller = replace(mechanism, bodies=tuple(bodies))
    embed, restrict = partial(transfer_spins, layout, spins, 1.0), partial(restrict_spins, layout, spins)
    tables = layout.tables | {"bodies": add_inertias(layout, spins)}
    smaller_layout = replace(layout, mechanism=smaller, tables=tables, y0=restrict(0.0, layout.y0))
    start = replace(scene.start, angular_velocity=omega)
    explanations = tuple(format_explanation(bodies[i], spin) for i, spin in spins.items())
    return Reduction(PreparedScene(smaller, start, scene.idle_spins, smaller_layout), embed, restrict, explanations)


def format_explanation(body: Body, spin: Spin) -> str:
    """Explain what was done to a body, and why that changes nothing."""
    return (
        f"bodies.{body.name} is axisymmetric and no moment acts about its axis: its spin of {spin.rate:.4g} "
        f"rad/s is constant; a spin of {spin.rate - spin.rate_reduction:.4g} rad/s with "
        f"{spin.replacement_moment / spin.moment:.3g} times the "
        "inertia gives the same motion of the axis"
    )


def added_inertia(spin: Spin) -> Array:
    """Return the inertia added to a body about its axis, body axes."""
    return np.asarray((spin.replacement_moment - spin.moment) * np.outer(spin.axis, spin.axis))


def add_inertias(layout: Layout, spins: Mapping[int, Spin]) -> Table:
    """Return the kernel's bodies with the added inertia."""
    bodies = layout.bodies.copy()
    for i, spin in spins.items():
        row = bodies["inertia"][layout.place[i]]
        for name, increment in zip(row.dtype.names or (), to_sym3(added_inertia(spin)), strict=True):
            row[name] += increment
    return bodies


def transfer_spins(layout: Layout, spins: Mapping[int, Spin], sense: float, times: Array, states: Array) -> Array:
    """Turn the bodies in states (n_t, n) by the difference of their spins; sense: 1 to their own, -1 to the replacing
    ones.

    They get the spin that is known exactly: an impulse on a thin wire leaves a spin of roundings over its inertia,
    which a larger inertia would turn into an angular momentum.
    """
    out = np.array(states, dtype=float)
    for i, spin in spins.items():
        row = layout.bodies[layout.place[i]]
        q, omega = (out[:, row[name] : row[name] + n] for name, n in (("attitude_at", 4), ("rate_at", 3)))
        n = rotate_vector(q, spin.axis)
        rate = spin.rate if sense > 0.0 else spin.rate - spin.rate_reduction
        omega += (rate - np.sum(omega * n, axis=1, keepdims=True)) * n
        q[:] = quaternion_product(
            q, quaternions_about(spin.axis, sense * spin.rate_reduction * np.asarray(times, dtype=float))
        )
    return out


def restrict_spins(layout: Layout, spins: Mapping[int, Spin], t: float, state: Array) -> Array:
    """Return the state of the replacing bodies from that of the given ones, (n,)."""
    return np.asarray(transfer_spins(layout, spins, -1.0, np.array([t]), np.asarray(state)[None, :])[0])


def find_constant_spins(scene: PreparedScene) -> dict[int, Spin]:
    """Find the bodies with a constant spin, and inertia about its axis."""
    mechanism = scene.mechanism
    spins: dict[int, Spin] = {}
    if mechanism.planar:
        return spins
    idle_bodies = {spin.body for spin in scene.idle_spins}
    points = {i: body_points for i, body_points in find_free_bodies(mechanism).items() if i not in idle_bodies}
    if not points:
        return spins
    moments, axes = np.linalg.eigh(np.array([mechanism.bodies[i].inertia for i in points]))
    for k, (i, body_points) in enumerate(points.items()):
        body = mechanism.bodies[i]
        rounding = moment_tolerance(body, float(moments[k, 2]), scene.layout.size)
        is_distinct = (np.diff(moments[k]) > rounding).tolist()
        if all(is_distinct):
            continue
        arms = np.array([point - body.center for point in body_points]).reshape(-1, 3)
        axis = axes[k][:, 0 if is_distinct[0] else 2]
        reach = float(np.sqrt(np.max(np.sum(np.square(arms), axis=1), initial=0.0)))
        if not any(is_distinct) and reach > 0.0:  # any axis: that through the points
            axis = arms[np.argmax(np.sum(np.square(arms), axis=1))] / reach
        moment = float(axis @ body.inertia @ axis)
        across = 0.5 * (float(np.trace(body.inertia)) - moment)
        if moment > tolerances.NO_INERTIA * across and is_axisymmetric(body, arms, axis, scene.layout.size, rounding):
            spins[i] = Spin(axis, moment, across + body.mass * reach**2, spin_rate(scene.layout, i, axis))
    return spins


def moment_tolerance(body: Body, largest: float, size: float) -> float:
    """Tolerance for equal moments of inertia: they come from those about the origin, unless that is far away."""
    return tolerances.AXISYMMETRIC * (largest + body.mass * min(float(body.center @ body.center), size * size))


def spin_rate(layout: Layout, i: int, axis: Array) -> float:
    """A body's spin about an axis of its own at the start [rad/s]."""
    row = layout.bodies[layout.place[i]]
    q, omega = layout.y0[row["attitude_at"] :][:4], layout.y0[row["rate_at"] :][:3]
    return float(omega @ rotate_vector(q[None, :], axis)[0])


def is_axisymmetric(body: Body, arms: Array, axis: Array, size: float, rounding: float) -> bool:
    """Return whether a body is symmetric about an axis that has all points; arms (n, 3) from its centre, body axes."""
    moment = float(axis @ body.inertia @ axis)
    across = 0.5 * (float(np.trace(body.inertia)) - moment)
    symmetric_inertia = across * np.eye(3) + (moment - across) * np.outer(axis, axis)
    offsets = arms - np.outer(arms @ axis, axis)
    on_axis = bool((np.abs(offsets) <= tolerances.AXISYMMETRIC * size).all())
    return on_axis and bool(np.abs(body.inertia - symmetric_inertia).max() <= rounding)


def find_free_bodies(mechanism: Mechanism) -> dict[int, list[Array]]:
    """Find the bodies that joints leave free to turn and that no load or impulse turns, with the points where loads
    act.
    """
    points: dict[int, list[Array]] = {i: [] for i in range(len(mechanism.bodies))}

    def acts(body: int, point: Array | None) -> None:
        if point is None:
            points.pop(body, None)
        elif body in points:
            points[body].append(point)

    for joint in mechanism.joints:
        kind = JOINTS[joint.kind]
        acts(joint.a, joint.p if kind.is_ball and not kind.has_moving_contact else None)
        acts(joint.b, joint.q if kind.is_ball else None)
    for load in mechanism.loads:
        if isinstance(load, PointLoad):
            acts(load.body, None if load.is_couple or load.in_body else load.point)
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
    for impulse in mechanism.impulses:
        acts(impulse.body, impulse.point if impulse.kind == "impulse" else None)
    return points
