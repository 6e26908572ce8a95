"""The residual of d'Alembert's principle: loads and inertia of every body, added up again from the reported numbers."""

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
    """Largest d'Alembert residual of any body, relative to its largest load; from the reported numbers alone."""
    ma, spin = inertia_loads(mechanism, states)
    weight = np.array([b.mass for b in mechanism.bodies])[:, None] * mechanism.gravity
    force, moment = weight - ma, -spin
    largest = np.maximum(np.abs(ma).max(axis=2, initial=0.0), np.abs(weight).max(axis=1, initial=0.0))

    def put(body: int, place: Array, F: Array, M: Array) -> None:
        if body == GROUND:
            return
        force[:, body] += F
        moment[:, body] += M + np.cross(place - states.centre[:, body], F)
        largest[:, body] = np.maximum(largest[:, body], np.maximum(np.abs(F).max(axis=1), np.abs(M).max(axis=1) / size))

    for action in actions:
        for end, F, M in action.on_bodies():
            put(end.body, end.position, F, M)
    if mechanism.planar:
        force, moment = in_plane(force, moment)
    residual = np.maximum(np.sqrt(np.sum(force**2, axis=2)), np.sqrt(np.sum(moment**2, axis=2)) / size)
    scale = np.where(largest > 0.0, largest, 1.0)
    return float((residual / scale).max(initial=0.0))
