"""Whether accelerations exist and are unique: if not, an error instead of numbers."""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.number_range import out_of_range
from heuncli.base.records import record
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.mechanism.model import BushingLoad, PairLoad, path_of_load
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array

QUANTITIES = {  # of a body, in the kernel's answer
    "r": "coordinate of", "v": "speed of", "a": "acceleration of", "omega": "rate of turning of",
    "alpha": "angular acceleration of", "joint_force": "force on", "joint_moment": "moment on",
}  # fmt: skip
LARGE = "look at the units of loads, masses and lengths nearby"


@record
class Wording:
    """What is asked of a scene, in words; given [N m] or [N m s]: the largest moment of what is given beside loads."""

    answers: str = "accelerations"
    moment: str = "moment"
    unit: str = "N m"
    given: float = 0.0


def require_solvable(scene: PreparedScene, recovered: Recovered, wording: Wording = Wording()) -> None:  # noqa: B008
    """Raise SolveError for accelerations that are not finite, freedoms without inertia, moments about such axes."""
    moved, loads = np.abs(recovered.bodies.view(np.float64)), np.abs(recovered.loads["value"])
    if not max(moved.max(initial=0.0), loads.max(initial=0.0)) <= tolerances.MOST_MAGNITUDE:  # also what is no number
        finite = np.isfinite(moved).all(axis=1)
        if not finite.all():
            raise SolveError(*not_finite(scene, recovered, int(np.flatnonzero(~finite)[0])))
        require_range(scene, recovered, np.maximum(moved.max(axis=1, initial=0.0), loads.max(axis=1, initial=0.0)))
    for k in np.flatnonzero(recovered.idle > 0).tolist() if recovered.idle.any() else ():
        from heuncli.motion.integration.diagnosis.massless_motions import is_idle

        if not is_idle(scene, recovered, k):
            raise SolveError(freedom_without_inertia(scene, recovered, k))
    unmet = recovered.residual > recovered.may_stay
    if unmet.any():
        raise SolveError(unmet_rows(scene, recovered, int(np.flatnonzero(unmet)[0]), wording))
    layout, gravity = scene.layout, scene.mechanism.gravity
    for spin in scene.idle:
        rows = recovered.bodies[:, layout.place[spin.body]]
        R = rows["R"]
        alpha = np.einsum("tki,tk->ti", R, rows["alpha"])
        moment = np.abs(alpha @ (spin.axes @ spin.lent).T).max(initial=0.0)
        # the scale is made of applied loads and rates: the acceleration is amplified by the missing inertia
        force = np.abs(rows["joint_force"]).max(initial=0.0) + np.abs(recovered.loads["force"]).max(initial=0.0)
        body = scene.mechanism.bodies[spin.body]
        scale = (force + body.mass * float(np.abs(gravity).max())) * layout.size
        scale += np.abs(recovered.loads["moment"]).max(initial=0.0) + wording.given
        scale += float(np.trace(body.inertia)) * float(np.sum(rows["omega"] ** 2, axis=1).max())
        if moment > tolerances.NO_MOMENT * scale:
            axis = ", ".join(f"{x:.4g}" for x in spin.axes[0])
            name = scene.mechanism.bodies[spin.body].name
            message = (
                f"bodies.{name} has no inertia about its axis ({axis}), "
                f"and a {wording.moment} of {moment:.4g} {wording.unit} acts about it"
            )
            hint = "give the body its moment of inertia about that axis, or let the load act on the axis"
            raise SolveError(Problem("no-inertia", message, hint=hint))


def require_range(scene: PreparedScene, recovered: Recovered, largest: Array) -> None:
    """Raise SolveError for motions of bodies and for loads that are too large to be computed with: squares are next.

    largest (n_t,): at each instant. What is small passes: it is on its way through 0.
    """
    large = largest > tolerances.MOST_MAGNITUDE
    if large.any():
        raise SolveError(*too_large(scene, recovered, int(np.argmax(large))))


def too_large(scene: PreparedScene, recovered: Recovered, instant: int) -> list[Problem]:
    """The problems of values in time that are too large there, else the one of the largest load, or of the motion."""
    from heuncli.motion.integration.diagnosis.domains import coordinates_at, large_values  # only on the way to an error

    t, mechanism = float(recovered.times[instant]), scene.mechanism
    problems = large_values(mechanism, t, coordinates_at(scene.layout, recovered, instant))
    if problems:
        return problems
    sizes = np.abs(recovered.loads[instant]["value"])
    values = [(float(sizes[rows].max()), load) for load, rows in mechanism.load_rows()]
    value, load = max(values, key=lambda pair: pair[0], default=(0.0, None))
    if load is not None and value > tolerances.MOST_MAGNITUDE:
        what = f"at t = {t:.9g} s the value of {path_of_load(load)}"
    else:
        bodies = recovered.bodies[instant]
        largest = {name: np.abs(bodies[name]).max(axis=-1) for name in QUANTITIES}
        name = max(largest, key=lambda key: float(largest[key].max()))
        place = int(np.argmax(largest[name]))
        body = mechanism.bodies[scene.layout.spanning.hangs[place].body].name
        value, what = float(largest[name][place]), f"at t = {t:.9g} s the {QUANTITIES[name]} bodies.{body}"
    found = out_of_range(value, what)
    return [Problem(found.code, found.message, hint=LARGE)]


def require_start(scene: PreparedScene, start: Recovered, wording: Wording = Wording()) -> None:  # noqa: B008
    """Raise SolveError where there are no accelerations at the start, or loads push between points that coincide."""
    require_solvable(scene, start, wording)
    require_directions(scene, start, begins=True)


def require_directions(scene: PreparedScene, recovered: Recovered, begins: bool = False) -> None:
    """Raise SolveError for actuators and springs that push between points that coincide; begins: or are about to."""
    if any(isinstance(load, PairLoad) for load in scene.mechanism.loads):
        from heuncli.motion.integration.diagnosis.coincident_points import without_direction  # few scenes have them

        if problems := without_direction(scene.layout, recovered, begins):
            raise SolveError(*problems)


def unmet_rows(scene: PreparedScene, recovered: Recovered, instant: int, wording: Wording) -> Problem:
    """The problem of closed chains that nothing found holds together."""
    from heuncli.motion.integration.diagnosis.fighting_drives import fighting

    t, residual = float(recovered.times[instant]), float(recovered.residual[instant])
    if (problem := fighting(scene.mechanism, t, t)) is not None:
        return problem
    message = f"at t = {t:.9g} s the {wording.answers} leave {residual:.1g} of what the closed chains ask of them unmet"
    return Problem("closure-lost", message, hint="a singular pose, or joints that contradict each other by a little")


def not_finite(scene: PreparedScene, recovered: Recovered, instant: int) -> list[Problem]:
    """Problems of the expressions without a value there, else one that says that no acceleration exists."""
    from heuncli.motion.integration.diagnosis.domains import (  # only on the way to an error
        coordinates_at,
        without_value,
    )

    t, length = float(recovered.times[instant]), float(recovered.times[-1])
    problems = without_value(scene.mechanism, t, length, coordinates_at(scene.layout, recovered, instant))
    if not problems and any(isinstance(load, BushingLoad) for load in scene.mechanism.loads):
        from heuncli.motion.integration.diagnosis.turned_bushings import at_half_turn

        problems = at_half_turn(scene.mechanism, recovered, instant)
    if not problems and scene.mechanism.rubbing:
        from heuncli.motion.integration.diagnosis.jamming import jammed_at

        problems = jammed_at(scene.mechanism, recovered, instant)
    message = f"at t = {t:.9g} s no finite acceleration exists"
    return problems or [Problem("not-a-number", message, hint="look at points that coincide, and at very large values")]


def freedom_without_inertia(scene: PreparedScene, recovered: Recovered, instant: int) -> Problem:
    """The problem of a freedom that moves no mass: which bodies turn in it, about which axes."""
    from heuncli.motion.integration.diagnosis.massless_motions import loose_axes

    layout = scene.layout
    lacking = []
    for place, axes in loose_axes(scene, recovered.bodies[instant], recovered.rows[instant]).items():
        body = layout.mechanism.bodies[layout.spanning.hangs[place].body]
        lacking.append(f"bodies.{body.name} has no inertia about {in_words(axes)}")
    message = f"at t = {float(recovered.times[instant]):.6g} s a freedom has no inertia behind it"
    message = ": ".join([message, *(["; ".join(lacking)] if lacking else [])])
    return Problem("no-inertia", message, hint="give those bodies their moments of inertia, or hold the turn")


def in_words(axes: Array) -> str:
    """Axes (k, 3) of a body in its own components: one, those across one, or any."""
    if len(axes) == 3:
        return "any axis"
    n = axes[0] if len(axes) == 1 else np.cross(axes[0], axes[1])
    n = n * np.sign(n[np.argmax(np.abs(n))])  # the sign of a singular vector is arbitrary
    listed = ", ".join(f"{x:.4g}" for x in np.where(np.abs(n) < tolerances.DUST, 0.0, n))
    return f"its axis ({listed})" if len(axes) == 1 else f"its axes across ({listed})"
