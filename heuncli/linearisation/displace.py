"""A state moved along its freedoms: the finite displacements to which those of the linear equations are tangent."""

from __future__ import annotations

import numpy as np

from heuncli.results import Array
from heuncli.shapes.rotations import quaternion_product
from heuncli.tree.layout import Layout, places_of_rates


def displaced(layout: Layout, state: Array, displacement: Array, rates: Array | None = None) -> Array:
    """The state with its undriven freedoms displaced, and their rates changed, in the order of the layout's answers.

    A ball is turned by its rotation vector about the world's axes. Closures are not looked at.
    """
    place = places_of_rates(layout)
    place = place[place >= 0]
    at = {u: k for k, u in enumerate(place.tolist())}
    y = np.array(state, dtype=float)
    for freedom in layout.tables["freedoms"]:
        if not freedom["driven"]:
            y[freedom["q_at"]] += displacement[at[int(freedom["u_at"])]]
    for body in layout.bodies:
        if body["ball"]:
            k, own = at[int(body["rate_at"])], slice(body["attitude_at"], body["attitude_at"] + 4)
            y[own] = quaternion_product(turning(displacement[k : k + 3]), y[own])
    if rates is not None:
        y[place] += rates
    return y


def turning(turn: Array) -> Array:
    """The unit quaternion of a rotation vector."""
    angle = float(np.linalg.norm(turn))
    sine = 0.5 if angle == 0.0 else np.sin(0.5 * angle) / angle
    return np.append(np.cos(0.5 * angle), sine * turn)
