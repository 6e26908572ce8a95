"""States moved along their freedoms: the finite displacements to which those of the linear equations are tangent."""

from __future__ import annotations

import numpy as np

from heuncli.multibody.tree.layout import Layout, places_of_rates
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import quaternion_from_vector, quaternion_product, vector_of_quaternion


def displaced(layout: Layout, states: Array, by: Array, rates: Array | None = None) -> Array:
    """States (..., n_state) with their undriven freedoms displaced by (..., n), and their rates changed by `rates`.

    In the order of the layout's answers. A ball is turned by its rotation vector about the world's axes. Closures are
    not looked at.
    """
    place = places_of_rates(layout)
    place = place[place >= 0]
    number = np.zeros(layout.n_state, dtype=int)  # of each freedom, by where its rate stands
    number[place] = np.arange(len(place))
    freedoms = layout.tables["freedoms"]
    own = freedoms[freedoms["driven"] == 0]
    moved = np.array(states, dtype=float)
    moved[..., own["q_at"]] += by[..., number[own["u_at"]]]
    for body in layout.bodies[layout.bodies["ball"] == 1]:
        at, first = int(body["attitude_at"]), int(number[body["rate_at"]])
        turn = quaternion_from_vector(by[..., first : first + 3])
        moved[..., at : at + 4] = quaternion_product(turn, moved[..., at : at + 4])
    if rates is not None:
        moved[..., place] += rates
    return moved


def displacement(layout: Layout, state: Array, other: Array) -> Array:
    """The displacement (n,) that makes a state (n_state,) another one: what displaced() undoes."""
    place = places_of_rates(layout)
    place = place[place >= 0]
    number = np.zeros(layout.n_state, dtype=int)
    number[place] = np.arange(len(place))
    freedoms = layout.tables["freedoms"]
    own = freedoms[freedoms["driven"] == 0]
    by = np.zeros(len(place))
    by[number[own["u_at"]]] = other[own["q_at"]] - state[own["q_at"]]
    for body in layout.bodies[layout.bodies["ball"] == 1]:
        at, first = int(body["attitude_at"]), int(number[body["rate_at"]])
        back = state[at : at + 4] * np.array([1.0, -1.0, -1.0, -1.0])
        by[first : first + 3] = vector_of_quaternion(quaternion_product(other[at : at + 4], back))
    return by
