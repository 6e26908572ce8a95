"""No numbers where no acceleration exists: the sentences that say so."""

from __future__ import annotations

import numpy as np

from heuncli import tolerances
from heuncli.errors import Problem, SolveError
from heuncli.integration.runner import Recovered
from heuncli.tree.idle_spins import without_inertia
from heuncli.tree.prepare import PreparedScene


def refuse(scene: PreparedScene, found: Recovered) -> None:
    """Raise SolveError for answers that are not finite, freedoms with nothing behind them, moments without inertia."""
    finite = np.isfinite(found.bodies.view(np.float64)).all(axis=1)
    if not finite.all():
        raise SolveError(*not_finite(scene, found, int(np.flatnonzero(~finite)[0])))
    if (found.idle > 0).any():
        raise SolveError(nothing_behind(scene, float(found.times[int(np.flatnonzero(found.idle > 0)[0])])))
    layout, gravity = scene.layout, scene.mechanism.gravity
    for spin in scene.idle:
        rows = found.bodies[:, layout.place[spin.body]]
        R = rows["R"]
        alpha = np.einsum("tki,tk->ti", R, rows["alpha"])
        moment = np.abs(alpha @ (spin.axes @ spin.lent).T).max(initial=0.0)
        # what is given or turns, not the acceleration, which such a moment makes as large as it likes
        force = np.abs(rows["joint_force"]).max(initial=0.0) + np.abs(found.loads["force"]).max(initial=0.0)
        body = scene.mechanism.bodies[spin.body]
        scale = (force + body.mass * float(np.abs(gravity).max())) * layout.size
        scale += np.abs(found.loads["moment"]).max(initial=0.0)
        scale += float(np.trace(body.inertia)) * float(np.sum(rows["omega"] ** 2, axis=1).max())
        if moment > tolerances.NO_MOMENT * scale:
            axis = ", ".join(f"{x:.4g}" for x in spin.axes[0])
            name = scene.mechanism.bodies[spin.body].name
            message = (
                f"bodies.{name} has no inertia about its axis ({axis}), and a moment of {moment:.4g} N m acts about it"
            )
            hint = "give the body its moment of inertia about that axis, or let the load act on the axis"
            raise SolveError(Problem("no-inertia", message, hint=hint))


def not_finite(scene: PreparedScene, found: Recovered, instant: int) -> list[Problem]:
    """The expressions without a value there, else that no acceleration exists."""
    from heuncli.integration.domains import moving, without_value  # only on the way to an error

    t, length = float(found.times[instant]), float(found.times[-1])
    problems = without_value(scene.mechanism, t, length, moving(scene.layout, found.freedoms[instant]))
    message = f"at t = {t:.9g} s no finite acceleration exists"
    return problems or [Problem("not-a-number", message, hint="look at points that coincide, and at very large values")]


def nothing_behind(scene: PreparedScene, t: float) -> Problem:
    """A freedom moves no mass: which bodies have no inertia about some axis."""
    thin = []
    for body in scene.mechanism.bodies:
        axes, _ = without_inertia(body, scene.layout.size)
        if len(axes):
            # the sign of an eigenvector is anybody's choice, and a point mass has no axis rather than another
            n = axes[0] * np.sign(axes[0][np.argmax(np.abs(axes[0]))]) + 0.0
            told = f"its axis ({', '.join(f'{x:.4g}' for x in n)})" if len(axes) == 1 else "its axis (any)"
            thin.append(f"bodies.{body.name} has no inertia about {told}")
    message = ": ".join([f"at t = {t:.6g} s a freedom has no inertia behind it", *(["; ".join(thin)] if thin else [])])
    return Problem("no-inertia", message, hint="give those bodies their moments of inertia, or hold the turn")
