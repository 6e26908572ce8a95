"""Whether accelerations exist and are unique: if not, an error instead of numbers."""

from __future__ import annotations

import numpy as np

from heuncli import tolerances
from heuncli.errors import Problem, SolveError
from heuncli.integration.evaluator import Recovered
from heuncli.integration.runner import Runner
from heuncli.mechanism.model import PairLoad
from heuncli.records import record
from heuncli.results import Array
from heuncli.tree.prepare import PreparedScene, lacking_inertia


def ready(scene: PreparedScene) -> tuple[PreparedScene, Runner]:
    """A scene to be run and its work arrays: inertia is lent where motions of its tree move no mass."""
    lacking = lacking_inertia(scene)
    if lacking:
        from heuncli.integration.inertialess import lend  # few scenes need it

        scene = lend(scene, lacking)
    return scene, Runner(scene.layout)


@record
class Asked:
    """What is asked of a scene, in words; given [N m] or [N m s]: the largest moment of what is given beside loads."""

    answers: str = "accelerations"
    moment: str = "moment"
    unit: str = "N m"
    given: float = 0.0


def require_solvable(scene: PreparedScene, recovered: Recovered, asked: Asked = Asked()) -> None:  # noqa: B008
    """Raise SolveError for accelerations that are not finite, freedoms without inertia, moments about such axes."""
    finite = np.isfinite(recovered.bodies.view(np.float64)).all(axis=1)
    if not finite.all():
        raise SolveError(*not_finite(scene, recovered, int(np.flatnonzero(~finite)[0])))
    for k in np.flatnonzero(recovered.idle > 0).tolist():
        from heuncli.integration.inertialess import is_idle

        if not is_idle(scene, recovered, k):
            raise SolveError(freedom_without_inertia(scene, recovered, k))
    unmet = recovered.residual > recovered.may_stay
    if unmet.any():
        raise SolveError(unmet_rows(recovered, int(np.flatnonzero(unmet)[0]), asked))
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
        scale += np.abs(recovered.loads["moment"]).max(initial=0.0) + asked.given
        scale += float(np.trace(body.inertia)) * float(np.sum(rows["omega"] ** 2, axis=1).max())
        if moment > tolerances.NO_MOMENT * scale:
            axis = ", ".join(f"{x:.4g}" for x in spin.axes[0])
            name = scene.mechanism.bodies[spin.body].name
            message = (
                f"bodies.{name} has no inertia about its axis ({axis}), "
                f"and a {asked.moment} of {moment:.4g} {asked.unit} acts about it"
            )
            hint = "give the body its moment of inertia about that axis, or let the load act on the axis"
            raise SolveError(Problem("no-inertia", message, hint=hint))


def require_start(scene: PreparedScene, start: Recovered, asked: Asked = Asked()) -> None:  # noqa: B008
    """Raise SolveError where there are no accelerations at the start, or forces along lines that have no length there.

    A spring that is relaxed without length needs no direction: it is as strong there as it is long.
    """
    require_solvable(scene, start, asked)
    problems = []
    for load, rows in scene.mechanism.load_rows():
        if not isinstance(load, PairLoad) or start.loads[0, rows]["span"][0] > tolerances.NO_LENGTH * scene.layout.size:
            continue
        if load.stiffness * load.length != 0.0 if load.value is None else load.value.constant != 0.0:
            t = float(start.times[0])
            message = f"at t = {t:.6g} s the points of forces.{load.name} coincide: its force has no direction"
            hint = "in a pin or slide use type: torque; else let its points be apart from the start"
            problems.append(Problem("no-direction", message, hint=hint))
    if problems:
        raise SolveError(*problems)


def unmet_rows(recovered: Recovered, instant: int, asked: Asked) -> Problem:
    """The problem of closed chains that nothing found holds together."""
    t, residual = float(recovered.times[instant]), float(recovered.residual[instant])
    message = f"at t = {t:.9g} s the {asked.answers} leave {residual:.1g} of what the closed chains ask of them unmet"
    return Problem("closure-lost", message, hint="a singular pose, or joints that contradict each other by a little")


def not_finite(scene: PreparedScene, recovered: Recovered, instant: int) -> list[Problem]:
    """Problems of the expressions without a value there, else one that says that no acceleration exists."""
    from heuncli.integration.domains import joint_coordinates, without_value  # only on the way to an error

    t, length = float(recovered.times[instant]), float(recovered.times[-1])
    problems = without_value(scene.mechanism, t, length, joint_coordinates(scene.layout, recovered.freedoms[instant]))
    message = f"at t = {t:.9g} s no finite acceleration exists"
    return problems or [Problem("not-a-number", message, hint="look at points that coincide, and at very large values")]


def freedom_without_inertia(scene: PreparedScene, recovered: Recovered, instant: int) -> Problem:
    """The problem of a freedom that moves no mass: which bodies turn in it, about which axes."""
    from heuncli.integration.inertialess import loose_axes

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
