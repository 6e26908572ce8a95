"""Recompute the residual of d'Alembert's principle for every body from the reported loads and motion.

    r = Σ k + m g − m ẍ,   R = Σ [(x − x_s) × k + couples] − (I σ̇ + σ × I σ)     about the centre of mass

k: applied forces, joints and drives on the body. The residual is relative to the body's largest load, including the
inertia loads of its pieces: a rotor that spins about its centre has no others. A body that an instant or an impulse
reaches by rounding alone has no load of its own: there the residual is relative to the smallest load that rounding of
the instant's largest one leaves certain.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.loads.kinetostatics.actions import Action
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.loads.kinetostatics.foundation import inertia_rows
from heuncli.multibody.mechanism.model import GROUND, Mechanism
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import cross_components, squared_lengths

CHUNK = 100_000  # instants times actions summed together


def balance_residual(
    mechanism: Mechanism, states: BodyStates, inertia: Array, actions: Sequence[Action], size: float
) -> float:
    """Return the largest residual of any body, relative to its largest load; moments are divided by `size` [m].

    inertia: the largest inertia load of each body (`inertia_scale`)

    The rounding of the instant's largest load, summed over the bodies, stays below UNBALANCED, however small a body's
    own load.
    """
    ma, spin = inertia_rows(mechanism, states)
    weight = np.array([b.mass for b in mechanism.bodies])[:, None] * mechanism.gravity
    force, moment = weight[..., None] - ma, -spin
    largest = inertia.T.copy()

    ends_with_loads = [(end, F, M) for action in actions for end, F, M in action.iter_ends() if end.body != GROUND]
    batch_size = max(1, CHUNK // max(len(inertia), 1))
    for first in range(0, len(ends_with_loads), batch_size):
        ends, forces, moments = zip(*ends_with_loads[first : first + batch_size], strict=True)
        F, M, position = (stack_vectors(x) for x in (forces, moments, [end.position for end in ends]))
        about_centre = M + cross_components(position - states.component_rows("centre")[[end.body for end in ends]], F)
        action_sizes = np.maximum(np.abs(F).max(axis=1), np.abs(M).max(axis=1) / size)
        for k, body in enumerate(end.body for end in ends):
            force[body] += F[k]
            moment[body] += about_centre[k]
            np.maximum(largest[body], action_sizes[k], out=largest[body])
    if mechanism.planar:
        force, moment = force * np.array([[1.0], [1.0], [0.0]]), moment * np.array([[0.0], [0.0], [1.0]])
    residual = np.maximum(np.sqrt(squared_lengths(force)), np.sqrt(squared_lengths(moment)) / size)
    rounding = tolerances.SUM_ROUNDING * len(mechanism.bodies) * largest.max(axis=0, initial=0.0)
    scale = np.maximum(largest, rounding / tolerances.UNBALANCED)
    scale[scale == 0.0] = 1.0
    return float((residual / scale).max(initial=0.0))


def stack_vectors(vectors: Sequence[Array]) -> Array:
    """Stack vectors of actions, (n_t, 3) each, by component, (k, 3, n_t)."""
    return np.ascontiguousarray(np.stack(vectors).transpose(0, 2, 1))
