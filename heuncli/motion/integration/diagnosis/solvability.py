"""Check that accelerations exist and are unique; if not, raise an error instead of returning numbers."""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem, SolveError
from heuncli.base.records import record
from heuncli.base.units import range_error
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.loads import BushingLoad, PairLoad
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array

QUANTITIES = {  # of a body, in the kernel's answer
    "r": "coordinate of", "v": "speed of", "a": "acceleration of", "omega": "angular velocity of",
    "alpha": "angular acceleration of", "joint_force": "force on", "joint_moment": "moment on",
}  # fmt: skip
LARGE = "check the units of loads, masses and lengths nearby"


@record
class ErrorWording:
    """Words for what is computed of a scene.

    moment_scale [N m] or [N m s]: largest moment given besides the loads
    """

    results: str = "accelerations"
    moment: str = "moment"
    unit: str = "N m"
    moment_scale: float = 0.0


def require_solvable(scene: PreparedScene, evaluation: Evaluation, wording: ErrorWording = ErrorWording()) -> None:  # noqa: B008
    """Raise SolveError for accelerations that are not finite, freedoms without inertia, moments about such axes."""
    body_values, loads = np.abs(evaluation.bodies.view(np.float64)), np.abs(evaluation.loads["value"])
    if not max(body_values.max(initial=0.0), loads.max(initial=0.0)) <= tolerances.MOST_MAGNITUDE:  # also true for nan
        is_finite = np.isfinite(body_values).all(axis=1)
        if not is_finite.all():
            raise SolveError(*find_not_finite(scene, evaluation, int(np.flatnonzero(~is_finite)[0])))
        require_range(
            scene, evaluation, np.maximum(body_values.max(axis=1, initial=0.0), loads.max(axis=1, initial=0.0))
        )
    for k in np.flatnonzero(evaluation.massless_count > 0).tolist() if evaluation.massless_count.any() else ():
        from heuncli.motion.integration.diagnosis.massless_motions import is_unloaded_spin

        if not is_unloaded_spin(scene, evaluation, k):
            raise SolveError(make_no_inertia_problem(scene, evaluation, k))
    is_unmet = evaluation.residual > evaluation.allowed_residual
    if is_unmet.any():
        raise SolveError(make_unmet_rows_problem(scene, evaluation, int(np.flatnonzero(is_unmet)[0]), wording))
    layout, gravity = scene.layout, scene.mechanism.gravity
    for spin in scene.idle_spins:
        rows = evaluation.bodies[:, layout.place[spin.body]]
        R = rows["R"]
        alpha = np.einsum("tki,tk->ti", R, rows["alpha"])
        moment = np.abs(alpha @ (spin.axes @ spin.artificial_inertia).T).max(initial=0.0)
        # the scale is made of applied loads and rates: the acceleration is amplified by the missing inertia
        force = np.abs(rows["joint_force"]).max(initial=0.0) + np.abs(evaluation.loads["force"]).max(initial=0.0)
        body = scene.mechanism.bodies[spin.body]
        scale = (force + body.mass * float(np.abs(gravity).max())) * layout.size
        scale += np.abs(evaluation.loads["moment"]).max(initial=0.0) + wording.moment_scale
        scale += float(np.trace(body.inertia)) * float(np.sum(rows["omega"] ** 2, axis=1).max())
        if moment > tolerances.NO_MOMENT * scale:
            axis = ", ".join(f"{x:.4g}" for x in spin.axes[0])
            name = scene.mechanism.bodies[spin.body].name
            message = (
                f"bodies.{name} has no inertia about its axis ({axis}), "
                f"and a {wording.moment} of {moment:.4g} {wording.unit} acts about it"
            )
            hint = "give the body a moment of inertia about that axis, or apply the load on the axis"
            raise SolveError(Problem("no-inertia", message, hint=hint))


def require_range(scene: PreparedScene, evaluation: Evaluation, largest: Array) -> None:
    """Raise SolveError for motions of bodies or loads that are too large to compute with, because squares follow.

    largest (n_t,): largest value at each instant. Small values pass, because they may be on their way through 0.
    """
    is_large = largest > tolerances.MOST_MAGNITUDE
    if is_large.any():
        raise SolveError(*find_too_large(scene, evaluation, int(np.argmax(is_large))))


def find_too_large(scene: PreparedScene, evaluation: Evaluation, instant: int) -> list[Problem]:
    """Return the problems of expressions that are too large there, else that of the largest load or motion."""
    from heuncli.motion.integration.diagnosis.domains import (  # only on the way to an error
        evaluate_coordinates,
        find_large_values,
    )

    t, mechanism = float(evaluation.times[instant]), scene.mechanism
    problems = find_large_values(mechanism, t, evaluate_coordinates(scene.layout, evaluation, instant))
    if problems:
        return problems
    sizes = np.abs(evaluation.loads[instant]["value"])
    values = [(float(sizes[rows].max()), load) for load, rows in mechanism.iter_load_rows()]
    value, load = max(values, key=lambda pair: pair[0], default=(0.0, None))
    if load is not None and value > tolerances.MOST_MAGNITUDE:
        what = f"at t = {t:.9g} s the value of {load.path}"
    else:
        bodies = evaluation.bodies[instant]
        largest = {name: np.abs(bodies[name]).max(axis=-1) for name in QUANTITIES}
        name = max(largest, key=lambda key: float(largest[key].max()))
        place = int(np.argmax(largest[name]))
        body = mechanism.bodies[scene.layout.spanning.links[place].body].name
        value, what = float(largest[name][place]), f"at t = {t:.9g} s the {QUANTITIES[name]} bodies.{body}"
    range_problem = range_error(value, what)
    return [Problem(range_problem.code, range_problem.message, hint=LARGE)]


def require_start(scene: PreparedScene, evaluation: Evaluation, wording: ErrorWording = ErrorWording()) -> None:  # noqa: B008
    """Raise SolveError where there are no accelerations at the start, or loads push between points that coincide."""
    require_solvable(scene, evaluation, wording)
    require_directions(scene, evaluation, is_motion_start=True)


def require_directions(scene: PreparedScene, evaluation: Evaluation, is_motion_start: bool = False) -> None:
    """Raise SolveError for actuators and springs that push between coincident points; is_motion_start: or will push."""
    if problems := find_undirected(scene, evaluation, is_motion_start):
        raise SolveError(*problems)


def find_undirected(scene: PreparedScene, evaluation: Evaluation, is_motion_start: bool = False) -> list[Problem]:
    """Return the problems of loads that push between coincident points, or will."""
    if not any(isinstance(load, PairLoad) for load in scene.mechanism.loads):
        return []
    from heuncli.motion.integration.diagnosis.ambiguous_laws import find_undirected_loads  # few scenes have them

    return find_undirected_loads(scene.layout, evaluation, is_motion_start)


def make_unmet_rows_problem(
    scene: PreparedScene, evaluation: Evaluation, instant: int, wording: ErrorWording
) -> Problem:
    """Make the problem of closed chains that the accelerations found do not hold together."""
    from heuncli.motion.integration.diagnosis.ambiguous_laws import find_fighting_drives

    t, residual = float(evaluation.times[instant]), float(evaluation.residual[instant])
    if (problem := find_fighting_drives(scene.mechanism, t, t)) is not None:
        return problem
    message = (
        f"at t = {t:.9g} s the {wording.results} violate the constraints of closed loops by {residual:.1g} (relative)"
    )
    return Problem("closure-lost", message, hint="a singular position, or joints that contradict each other slightly")


def find_not_finite(scene: PreparedScene, evaluation: Evaluation, instant: int) -> list[Problem]:
    """Return problems of the expressions without a value there, else one that says that no acceleration exists."""
    from heuncli.motion.integration.diagnosis.domains import (  # only on the way to an error
        evaluate_coordinates,
        find_without_value,
    )

    t, length = float(evaluation.times[instant]), float(evaluation.times[-1])
    problems = find_undirected(scene, evaluation) or find_without_value(
        scene.mechanism, t, length, evaluate_coordinates(scene.layout, evaluation, instant)
    )
    if not problems and any(isinstance(load, BushingLoad) for load in scene.mechanism.loads):
        from heuncli.motion.integration.diagnosis.ambiguous_laws import find_half_turned

        problems = find_half_turned(scene.mechanism, evaluation, instant)
    if not problems and scene.mechanism.joint_friction:
        from heuncli.motion.integration.diagnosis.ambiguous_laws import find_jammed

        problems = find_jammed(scene.mechanism, evaluation, instant)
    message = f"at t = {t:.9g} s no finite acceleration exists"
    return problems or [
        Problem("not-a-number", message, hint="check for points that coincide and for very large values")
    ]


def make_no_inertia_problem(scene: PreparedScene, evaluation: Evaluation, instant: int) -> Problem:
    """Make the problem of a freedom that moves no mass: which bodies turn in it, about which axes."""
    from heuncli.motion.integration.diagnosis.massless_motions import find_loose_axes

    layout = scene.layout
    lacking = []
    for place, axes in find_loose_axes(scene, evaluation.bodies[instant], evaluation.rows[instant]).items():
        body = layout.mechanism.bodies[layout.spanning.links[place].body]
        lacking.append(f"bodies.{body.name} has no inertia about {describe_axes(axes)}")
    message = f"at t = {float(evaluation.times[instant]):.6g} s a degree of freedom has no inertia"
    message = ": ".join([message, *(["; ".join(lacking)] if lacking else [])])
    return Problem("no-inertia", message, hint="give those bodies moments of inertia, or constrain the rotation")


def describe_axes(axes: Array) -> str:
    """Describe axes (k, 3) of a body by its own components: one axis, those across one, or any."""
    if len(axes) == 3:
        return "any axis"
    n = axes[0] if len(axes) == 1 else np.cross(axes[0], axes[1])
    n = n * np.sign(n[np.argmax(np.abs(n))])  # the sign of a singular vector is arbitrary
    components = ", ".join(f"{x:.4g}" for x in np.where(np.abs(n) < tolerances.PRINTED_COMPONENT, 0.0, n))
    return f"its axis ({components})" if len(axes) == 1 else f"its axes perpendicular to ({components})"
