"""The residual of d'Alembert's principle, recomputed for every body from the reported loads and motion.

    r = Σ k + m g − m ẍ,   R = Σ [(x − x_s) × k + couples] − (I σ̇ + σ × I σ)     about the centre of mass
k: applied forces, joints and drives on the body. The residual is relative to the body's largest load.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.kinetostatics.actions import Action
from heuncli.kinetostatics.bodies import BodyStates
from heuncli.kinetostatics.foundation import inertia_loads
from heuncli.kinetostatics.reactions import in_plane
from heuncli.mechanism.model import GROUND, Mechanism
from heuncli.results import Array


def balance_residual(mechanism: Mechanism, states: BodyStates, actions: Sequence[Action], size: float) -> float:
    """Largest residual of any body, relative to its largest load; moments are divided by `size` [m]."""
    ma, spin = inertia_loads(mechanism, states)
    weight = np.array([b.mass for b in mechanism.bodies])[:, None] * mechanism.gravity
    force, moment = weight - ma, -spin
    largest = np.maximum(np.abs(ma).max(axis=2, initial=0.0), np.abs(weight).max(axis=1, initial=0.0))

    def add_load(body: int, position: Array, F: Array, M: Array) -> None:
        if body == GROUND:
            return
        force[:, body] += F
        moment[:, body] += M + np.cross(position - states.centre[:, body], F)
        largest[:, body] = np.maximum(largest[:, body], np.maximum(np.abs(F).max(axis=1), np.abs(M).max(axis=1) / size))

    for action in actions:
        for end, F, M in action.on_bodies():
            add_load(end.body, end.position, F, M)
    if mechanism.planar:
        force, moment = in_plane(force, moment)
    residual = np.maximum(np.sqrt(np.sum(force**2, axis=2)), np.sqrt(np.sum(moment**2, axis=2)) / size)
    scale = np.where(largest > 0.0, largest, 1.0)
    return float((residual / scale).max(initial=0.0))
