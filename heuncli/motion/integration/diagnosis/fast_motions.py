"""Explain why steps are short or a run cannot continue: what moves, decays or grows fastest.

Steps are as short as the fastest motion of the linearised equations requires:

    d/dt dy = A dy,   A v = l v,  |l| the largest          A: the tangent at the state

The body that moves most along v is reported, with the inertia that resists v. For a motion x of all bodies, scaled so
that this body turns by 1 (or its centre shifts by 1), that is the sum of m x_c^2 + w I w. Near gimbal lock, or for a
light body between springs, it is the light body's own inertia, and tiny compared with the loads.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import HeunError, LimitError, Problem, SolveError
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record
from heuncli.motion.integration.diagnosis.domains import evaluate_coordinates, find_grown
from heuncli.motion.integration.evaluator import Evaluation, Evaluator
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.response import compute_motions, make_workspace, settle_state, tangent
from heuncli.multibody.tree.layout import Layout, rate_indices
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array

# Fast body

MAX_NOISE_SHARE = 0.1  # fraction of a step's tolerance above which rounding contributes to its estimated error


@record
class FastMotion:
    """The fastest motion.

    rate: |l| [1/s]
    body: the body that moves most, by its number in the spec
    turns: whether it turns, or shifts
    spin, speed: its present motion [rad/s], [m/s]
    inertia: what resists the motion [kg m^2], or [kg]
    pins: joints of the two angles that change most, if two do, and the angle between their axes [rad]
    """

    rate: float
    body: int
    turns: bool
    spin: float
    speed: float
    inertia: float
    pins: tuple[str, str, float] | None


def find_fast_motion(scene: Evaluator, t: float, state: Array, holding: Array | None = None) -> FastMotion | None:
    """Find the fastest motion at a state; None if its tangent is not finite, or too large to inspect."""
    layout = scene.layout
    if layout.n_state > tolerances.MOST_SOLVED or not len(layout.place):
        return None
    workspace = make_workspace(layout, None if holding is None else layout.closed_contacts(holding))
    projected_state, poses = settle_state(workspace, layout, t, state)
    tangent_motions = compute_motions(workspace, layout, t, projected_state)
    if not np.isfinite(tangent_motions.tangent).all():
        return None
    values, vectors = np.linalg.eig(tangent_motions.tangent)
    k = int(np.argmax(np.abs(values)))
    place = rate_indices(layout)
    rates = place[place >= 0]
    eigenvector = vectors[rates, k]
    # of a complex pair, the larger part; a motion without rates has no body to name
    eigenvector = (
        eigenvector.real
        if np.abs(eigenvector.real).max(initial=0.0) >= np.abs(eigenvector.imag).max(initial=0.0)
        else eigenvector.imag
    )
    spins, speeds = tangent_motions.omega[..., rates] @ eigenvector, tangent_motions.v[..., rates] @ eigenvector
    for i, link in enumerate(layout.spanning.links):
        arm = poses[i]["R"] @ (layout.mechanism.bodies[link.body].center - layout.reference[i])
        speeds[i] = speeds[i] + np.cross(spins[i], arm)
    turn, shift = (np.sqrt(np.sum(part**2, axis=1)) for part in (spins, speeds))
    moves = np.maximum(turn, shift / layout.size)
    i = int(np.argmax(moves))
    if not moves[i] > 0.0:
        return None
    turns = bool(turn[i] >= shift[i] / layout.size)
    scale = turn[i] if turns else shift[i]
    body = layout.spanning.links[i].body
    spin, speed = (float(np.sqrt(np.sum(poses[i][name] ** 2))) for name in ("omega", "v"))
    inertia = compute_twice_kinetic_energy(layout, poses, spins, speeds) / float(scale) ** 2
    return FastMotion(
        abs(complex(values[k])), body, turns, spin, speed, inertia,
        find_opposed_pins(layout, eigenvector, rates, poses),
    )  # fmt: skip


def compute_twice_kinetic_energy(layout: Layout, poses: Table, spins: Array, speeds: Array) -> float:
    """Return twice the kinetic energy of angular velocities and velocities of the centres, (n_b, 3) each."""
    total = 0.0
    for i, link in enumerate(layout.spanning.links):
        body, spin = layout.mechanism.bodies[link.body], poses[i]["R"].T @ spins[i]
        total += body.mass * float(speeds[i] @ speeds[i]) + float(spin @ body.inertia @ spin)
    return total


def find_opposed_pins(layout: Layout, eigenvector: Array, rates: Array, poses: Table) -> tuple[str, str, float] | None:
    """Return the two pins whose angles change most, and the angle between their axes; None where others change as
    much.
    """
    number = {int(index): k for k, index in enumerate(rates)}
    size = np.abs(eigenvector) * layout.weights[rates]
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


def find_noisiest_body(scene: Evaluator, t: float, state: Array) -> tuple[int, float]:
    """Find the body to which rounding of its loads gives the largest angular acceleration; return its number, and that.

    EPS F L / I [rad/s^2]: F what its joint and its loads carry, L the scene's size, I its largest inertia. Moments of
    large loads that cancel leave as much, in whatever order they are added.
    """
    layout, evaluation = scene.layout, scene.evaluate(np.array([t]), state[None, :])
    force, moment = (
        np.sqrt(np.sum(evaluation.bodies[name][0] ** 2, axis=1)) for name in ("joint_force", "joint_moment")
    )
    inertia = np.array([find_largest_inertia(layout, link.body) for link in layout.spanning.links])
    load_noise = tolerances.EPS * (force * layout.size + moment)
    noise = np.divide(load_noise, inertia, out=np.zeros(len(load_noise)), where=inertia > 0.0)
    i = int(np.argmax(noise))
    return layout.spanning.links[i].body, float(noise[i])


def find_largest_inertia(layout: Layout, number: int) -> float:
    """Return the largest principal moment of inertia of a body [kg m^2]."""
    return float(np.linalg.eigvalsh(layout.mechanism.bodies[number].inertia)[-1])


def explain_short_steps(scene: Evaluator, t: float, state: Array, step: float = 0.0, local: float = np.inf) -> str:
    """Name the body and the reason in a sentence; empty if there is none.

    step: length of the last steps [s]
    local: their tolerance [rad, or relative to the size, and of rates]
    """
    body, noise = find_noisiest_body(scene, t, state)
    motion = find_fast_motion(scene, t, state)
    if noise * step > MAX_NOISE_SHARE * local:
        sentence = (
            f"steps are short because of {describe_body(scene.layout, body)}: rounding of the loads "
            "on it, divided by that inertia, "
            f"is about {noise:.1g} rad/s\u00b2, which the step control takes for motion"
        )
    elif motion is None:
        return ""
    else:
        how, unit = ("rotation", "kg\u00b7m\u00b2") if motion.turns else ("translation", "kg")
        now = f"{motion.spin:.2g} rad/s" if motion.turns else f"{motion.speed:.2g} m/s"
        sentence = (
            f"steps are short because of {describe_body(scene.layout, motion.body)}, which moves at "
            f"{now}: its {how} changes "
            f"at {motion.rate:.2g} 1/s, resisted by an inertia of only {motion.inertia:.2g} {unit}"
        )
    if motion is not None and motion.pins is not None:
        first, second, angle = motion.pins
        sentence += f"; the axes of joints.{first} and joints.{second} are {angle:.2g} rad from collinear"
        sentence += " (gimbal lock at 0)"
    return sentence


def describe_body(layout: Layout, number: int) -> str:
    """Describe a body with its mass and its largest inertia."""
    body = layout.mechanism.bodies[number]
    return f"bodies.{body.name} ({body.mass:.2g} kg, {find_largest_inertia(layout, number):.2g} kg\u00b7m\u00b2)"


# Growth


def find_growing(
    scene: Evaluator, t: float, state: Array, passed_states: Sequence[tuple[float, Array]]
) -> list[Problem]:
    """Find the expressions that have grown so since a quarter of the time; passed_states: instants and states,
    ascending.
    """
    earlier, earlier_state = next((k for k in reversed(passed_states) if k[0] <= 0.25 * t), passed_states[0])
    evaluation = scene.evaluate(np.array([earlier, t]), np.array([earlier_state, state]))
    coordinates = [evaluate_coordinates(scene.layout, evaluation, k) for k in range(2)]
    return find_grown(scene.layout.mechanism, (t, coordinates[1]), (earlier, coordinates[0]))


def make_stalled_error(problems: Sequence[Problem], done_text: str, needed_steps: float, cause: str = "") -> HeunError:
    """Explain why a run does not advance: what grows, else how many steps it would need, and for which cause (a
    sentence).
    """
    if problems:
        return SolveError(*problems)
    needed = f"about {needed_steps:.1g} would be needed" if needed_steps < math.inf else "no number of steps suffices"
    hint = "check for loads, rates, stiffness or friction far above the others, or an inertia far below; or end earlier"
    message = f"{done_text}; for the whole run {needed}, the limit is {tolerances.MOST_STEPS}"
    message += f"; {cause}" if cause else ""
    return LimitError(Problem("step-limit", message, hint=hint))


def describe_largest_load(mechanism: Mechanism, evaluation: Evaluation) -> str:
    """Describe the largest load at the first instant; empty if there is none."""
    rows = evaluation.loads[0]
    sizes = [(float(np.abs(rows["value"][k]).max(initial=0.0)), load.path) for load, k in mechanism.iter_load_rows()]
    finite = [(value, name) for value, name in sizes if 0.0 < value < math.inf]
    return "the largest load is {1}, {0:.3g}".format(*max(finite)) if finite else ""


# Fastest motion

STEP = 1e-8  # displacement of the state along the eigenvector: rad, or relative to the size, and rates [1/s]


def describe_fastest_motion(scene: Evaluator, t: float, state: Array, h: float) -> str:
    """Describe in a sentence what is fast at a state, how fast, and how fast the motion itself is; h: explicit steps
    [s].
    """
    values, vectors = np.linalg.eig(tangent(scene.workspace, t, state))
    k = int(np.argmax(np.abs(values)))
    largest = complex(values[k])
    does = "oscillates" if abs(largest.imag) > abs(largest.real) else "decays"
    evaluation = scene.evaluate(np.array([t]), state[None, :])
    omega = np.sqrt(np.sum(evaluation.bodies["omega"] ** 2, axis=2)).max(initial=0.0)
    speed = np.sqrt(np.sum(evaluation.bodies["v"] ** 2, axis=2)).max(initial=0.0) / scene.size
    load_name = find_responsible_load(scene, t, state, vectors[:, k], abs(largest))
    return (
        f"stiff: {load_name} {does} at {abs(largest):.2g} 1/s, the motion changes at {max(omega, speed):.2g} 1/s; "
        f"this limits explicit steps to {h:.2g} s at t = {t:.3g} s"
    )


def find_responsible_load(scene: Evaluator, t: float, state: Array, eigenvector: Array, rate: float) -> str:
    """Return the load that responds most to a motion along an eigenvector, by the work it does there."""
    loads = scene.layout.mechanism.loads
    if not loads:
        return "the model"
    work = np.zeros(len(scene.layout.tables["loads"]))
    for part in (eigenvector.real, eigenvector.imag):
        size = np.abs(part * scene.layout.weights).max(initial=0.0)
        if size > 0.0:
            moved_states = state[None, :] + np.array([[-1.0], [1.0]]) * (STEP / size * part)
            loads_there = scene.evaluate(np.array([t, t]), moved_states).loads
            change = {name: np.abs(loads_there[name][1] - loads_there[name][0]) for name in ("value", "span", "rate")}
            work += change["value"] * (change["rate"] + rate * change["span"])
    shares = {load: float(work[rows].sum()) for load, rows in scene.layout.mechanism.iter_load_rows()}
    load = max(loads, key=lambda one: shares[one])
    return f"{load.row.display_name} `{load.name}`" if shares[load] > 0.0 else "the model"
