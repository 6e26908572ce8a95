"""Displace states along their freedoms by finite amounts; the displacements of the linear equations are tangent to
these.
"""

from __future__ import annotations

import numpy as np

from heuncli.multibody.tree.layout import Layout, rate_indices
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import quaternion_from_vector, quaternion_product, vector_from_quaternion


def displace(layout: Layout, states: Array, displacement: Array, rates: Array | None = None) -> Array:
    """Displace the undriven freedoms of states (..., n_state) by (..., n), and change their rates by `rates`.

    The order is that of the layout's results. A ball joint is turned by its rotation vector about the world's axes.
    Closures are ignored.
    """
    place = rate_indices(layout)
    place = place[place >= 0]
    number = np.zeros(layout.n_state, dtype=int)  # of each freedom, by where its rate stands
    number[place] = np.arange(len(place))
    freedoms = layout.tables["freedoms"]
    undriven = freedoms[freedoms["driven"] == 0]
    displaced_states = np.array(states, dtype=float)
    displaced_states[..., undriven["q_at"]] += displacement[..., number[undriven["u_at"]]]
    for body in layout.bodies[layout.bodies["ball"] == 1]:
        attitude_index, first = int(body["attitude_at"]), int(number[body["rate_at"]])
        turn = quaternion_from_vector(displacement[..., first : first + 3])
        displaced_states[..., attitude_index : attitude_index + 4] = quaternion_product(
            turn, displaced_states[..., attitude_index : attitude_index + 4]
        )
    if rates is not None:
        displaced_states[..., place] += rates
    return displaced_states


def find_displacement(layout: Layout, state: Array, other: Array) -> Array:
    """Return the displacement (n,) that turns one state (n_state,) into another one; the inverse of displace()."""
    place = rate_indices(layout)
    place = place[place >= 0]
    number = np.zeros(layout.n_state, dtype=int)
    number[place] = np.arange(len(place))
    freedoms = layout.tables["freedoms"]
    undriven = freedoms[freedoms["driven"] == 0]
    result = np.zeros(len(place))
    result[number[undriven["u_at"]]] = other[undriven["q_at"]] - state[undriven["q_at"]]
    for body in layout.bodies[layout.bodies["ball"] == 1]:
        attitude_index, first = int(body["attitude_at"]), int(number[body["rate_at"]])
        conjugate = state[attitude_index : attitude_index + 4] * np.array([1.0, -1.0, -1.0, -1.0])
        result[first : first + 3] = vector_from_quaternion(
            quaternion_product(other[attitude_index : attitude_index + 4], conjugate)
        )
    return result
