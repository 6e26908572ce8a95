"""Which body keeps the steps of a run short, and why: the fastest motion that the equations have where it is.

    d/dt dy = A dy,   A v = l v,  |l| the largest          A: the tangent at the state
The body that moves most along v is named, with the inertia that resists v: of a motion x of all bodies, scaled so that
this body turns by 1 (or its centre shifts by 1), the sum of m x_c^2 + w I w. Near a gimbal's lock, or of a light body
between springs, that is the light body's own, and next to nothing beside what the loads act with.

Loaded where a run is given up, or takes long.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.multibody.mechanism.model import GROUND
from heuncli.multibody.response import motions, settled, workspace_of
from heuncli.multibody.tree.layout import Layout, places_of_rates
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array

NOISY = 0.1  # of the tolerance of a step: rounding above takes a share in its estimated error


@record
class FastMotion:
    """rate: |l| [1/s]; body: the one that moves most, by its number in the spec; turns: whether it turns, or shifts;
    spin, speed: how it moves now [rad/s], [m/s]; inertia: what resists the motion [kg m^2], or [kg];
    pins: joints of the two angles that change most, if two do, and the angle between their axes [rad].
    """

    rate: float
    body: int
    turns: bool
    spin: float
    speed: float
    inertia: float
    pins: tuple[str, str, float] | None


def fast_motion(scene: Evaluator, t: float, state: Array, holding: Array | None = None) -> FastMotion | None:
    """The fastest motion at a state, None where there is no finite tangent of it, or it is too large to look at."""
    layout = scene.layout
    if layout.n_state > tolerances.MOST_SOLVED or not len(layout.place):
        return None
    at = workspace_of(layout, None if holding is None else layout.closed(holding))
    own, poses = settled(at, layout, t, state)
    found = motions(at, layout, t, own)
    if not np.isfinite(found.tangent).all():
        return None
    values, vectors = np.linalg.eig(found.tangent)
    k = int(np.argmax(np.abs(values)))
    place = places_of_rates(layout)
    rates = place[place >= 0]
    along = vectors[rates, k]
    # of a pair the part that moves more; a motion at rest in its rates has no body to name
    along = along.real if np.abs(along.real).max(initial=0.0) >= np.abs(along.imag).max(initial=0.0) else along.imag
    spins, speeds = found.omega[..., rates] @ along, found.v[..., rates] @ along
    for i, hang in enumerate(layout.spanning.hangs):
        arm = poses[i]["R"] @ (layout.mechanism.bodies[hang.body].center - layout.reference[i])
        speeds[i] = speeds[i] + np.cross(spins[i], arm)
    turn, shift = (np.sqrt(np.sum(part**2, axis=1)) for part in (spins, speeds))
    moves = np.maximum(turn, shift / layout.size)
    i = int(np.argmax(moves))
    if not moves[i] > 0.0:
        return None
    turns = bool(turn[i] >= shift[i] / layout.size)
    scale = turn[i] if turns else shift[i]
    body = layout.spanning.hangs[i].body
    spin, speed = (float(np.sqrt(np.sum(poses[i][name] ** 2))) for name in ("omega", "v"))
    inertia = twice_energy(layout, poses, spins, speeds) / float(scale) ** 2
    return FastMotion(
        abs(complex(values[k])), body, turns, spin, speed, inertia,
        opposed_pins(layout, along, rates, poses),
    )  # fmt: skip


def twice_energy(layout: Layout, poses: Table, spins: Array, speeds: Array) -> float:
    """Twice the kinetic energy of some angular velocities, and velocities of the centres, (n_b, 3) each."""
    total = 0.0
    for i, hang in enumerate(layout.spanning.hangs):
        own, spin = layout.mechanism.bodies[hang.body], poses[i]["R"].T @ spins[i]
        total += own.mass * float(speeds[i] @ speeds[i]) + float(spin @ own.inertia @ spin)
    return total


def opposed_pins(layout: Layout, along: Array, rates: Array, poses: Table) -> tuple[str, str, float] | None:
    """The two pins whose angles change most, and the angle between their axes; None where others change as much."""
    number = {int(at): k for k, at in enumerate(rates)}
    size = np.abs(along) * layout.weights[rates]
    pins = [
        (float(size[number[f.u]]), f.joint)
        for f in layout.freedoms
        if f.joint >= 0 and f.q >= 0 and f.quantity == "angle" and JOINTS[layout.mechanism.joints[f.joint].kind].turns
    ]
    first = sorted(pins, reverse=True)[:2]
    if len(first) < 2 or first[1][0] < 0.5 * size.max(initial=0.0):
        return None
    joints = [layout.mechanism.joints[k] for _, k in first]
    axes = [j.axis if j.a == GROUND else poses[layout.place[j.a]]["R"] @ j.axis for j in joints]
    across = np.cross(axes[0], axes[1])
    names = sorted(j.name for j in joints)
    return names[0], names[1], float(np.arctan2(np.sqrt(across @ across), abs(axes[0] @ axes[1])))


def noise_of(scene: Evaluator, t: float, state: Array) -> tuple[int, float]:
    """The body to which rounding of the loads on it makes the largest angular acceleration, its number, and that.

    EPS F L / I [rad/s^2]: F what its joint and its loads carry, L the scene's size, I its largest inertia. Moments of
    large loads that cancel leave as much, whichever way they are added.
    """
    layout, at = scene.layout, scene.recovered(np.array([t]), state[None, :])
    force, moment = (np.sqrt(np.sum(at.bodies[name][0] ** 2, axis=1)) for name in ("joint_force", "joint_moment"))
    inertia = np.array([largest_inertia(layout, hang.body) for hang in layout.spanning.hangs])
    loaded = tolerances.EPS * (force * layout.size + moment)
    noise = np.divide(loaded, inertia, out=np.zeros(len(loaded)), where=inertia > 0.0)
    i = int(np.argmax(noise))
    return layout.spanning.hangs[i].body, float(noise[i])


def largest_inertia(layout: Layout, number: int) -> float:
    """The largest principal moment of inertia of a body [kg m^2]."""
    return float(np.linalg.eigvalsh(layout.mechanism.bodies[number].inertia)[-1])


def why_steps_are_short(scene: Evaluator, t: float, state: Array, step: float = 0.0, local: float = np.inf) -> str:
    """The body and the reason in a sentence; empty where there is none to tell.

    step: the length of the last steps [s]; local: their tolerance [rad, or of the size, and of rates].
    """
    body, noise = noise_of(scene, t, state)
    motion = fast_motion(scene, t, state)
    if noise * step > NOISY * local:
        sentence = (
            f"steps are short because of {named(scene.layout, body)}: rounding of the loads on it, over that inertia, "
            f"is some {noise:.1g} rad/s\u00b2, and a step takes that for motion"
        )
    elif motion is None:
        return ""
    else:
        how, unit = ("turn", "kg\u00b7m\u00b2") if motion.turns else ("shift", "kg")
        now = f"{motion.spin:.2g} rad/s" if motion.turns else f"{motion.speed:.2g} m/s"
        sentence = (
            f"steps are short because of {named(scene.layout, motion.body)}, which moves at {now}: its {how} changes "
            f"at {motion.rate:.2g} 1/s, resisted by no more than {motion.inertia:.2g} {unit}"
        )
    if motion is not None and motion.pins is not None:
        first, second, apart = motion.pins
        sentence += f"; the axes of joints.{first} and joints.{second} are {apart:.2g} rad from one line"
        sentence += " (gimbal lock at 0)"
    return sentence


def named(layout: Layout, number: int) -> str:
    """A body with its mass and its largest inertia."""
    own = layout.mechanism.bodies[number]
    return f"bodies.{own.name} ({own.mass:.2g} kg, {largest_inertia(layout, number):.2g} kg\u00b7m\u00b2)"
