"""Whether accelerations exist and are unique: if not, an error instead of numbers."""

from __future__ import annotations

import numpy as np

from heuncli import tolerances
from heuncli.errors import Problem, SolveError
from heuncli.integration.runner import Recovered
from heuncli.tree.idle_spins import without_inertia
from heuncli.tree.prepare import PreparedScene


def require_solvable(scene: PreparedScene, recovered: Recovered) -> None:
    """Raise SolveError for accelerations that are not finite, freedoms without inertia, moments about such axes."""
    finite = np.isfinite(recovered.bodies.view(np.float64)).all(axis=1)
    if not finite.all():
        raise SolveError(*not_finite(scene, recovered, int(np.flatnonzero(~finite)[0])))
    if (recovered.idle > 0).any():
        raise SolveError(
            freedom_without_inertia(scene, float(recovered.times[int(np.flatnonzero(recovered.idle > 0)[0])]))
        )
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
        scale += np.abs(recovered.loads["moment"]).max(initial=0.0)
        scale += float(np.trace(body.inertia)) * float(np.sum(rows["omega"] ** 2, axis=1).max())
        if moment > tolerances.NO_MOMENT * scale:
            axis = ", ".join(f"{x:.4g}" for x in spin.axes[0])
            name = scene.mechanism.bodies[spin.body].name
            message = (
                f"bodies.{name} has no inertia about its axis ({axis}), and a moment of {moment:.4g} N m acts about it"
            )
            hint = "give the body its moment of inertia about that axis, or let the load act on the axis"
            raise SolveError(Problem("no-inertia", message, hint=hint))


def not_finite(scene: PreparedScene, recovered: Recovered, instant: int) -> list[Problem]:
    """Problems of the expressions without a value there, else one that says that no acceleration exists."""
    from heuncli.integration.domains import joint_coordinates, without_value  # only on the way to an error

    t, length = float(recovered.times[instant]), float(recovered.times[-1])
    problems = without_value(scene.mechanism, t, length, joint_coordinates(scene.layout, recovered.freedoms[instant]))
    message = f"at t = {t:.9g} s no finite acceleration exists"
    return problems or [Problem("not-a-number", message, hint="look at points that coincide, and at very large values")]


def freedom_without_inertia(scene: PreparedScene, t: float) -> Problem:
    """The problem of a freedom that moves no mass: which bodies have no inertia about some axis."""
    lacking = []
    for body in scene.mechanism.bodies:
        axes, _ = without_inertia(body, scene.layout.size)
        if len(axes):
            # the sign of an eigenvector is arbitrary, and for a point mass every axis is one
            n = axes[0] * np.sign(axes[0][np.argmax(np.abs(axes[0]))]) + 0.0
            axis_text = f"its axis ({', '.join(f'{x:.4g}' for x in n)})" if len(axes) == 1 else "its axis (any)"
            lacking.append(f"bodies.{body.name} has no inertia about {axis_text}")
    message = ": ".join(
        [f"at t = {t:.6g} s a freedom has no inertia behind it", *(["; ".join(lacking)] if lacking else [])]
    )
    return Problem("no-inertia", message, hint="give those bodies their moments of inertia, or hold the turn")
