"""Attitudes as unit quaternions (w, x, y, z), which are continuous while bodies turn.

q and -q are one attitude. A rotation matrix shows neither the sign nor how often a body has turned; the state does,
with the angles of its joints and the quaternions of its ball joints. So the quaternions are products along the tree,

    q = q_parent * (cos phi/2, n sin phi/2) * frame * ...

and a body that turns by 360 degrees comes to -q. At the start of a run w >= 0, whatever instants are requested.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import vector_array
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import quaternion_from_matrix, quaternion_product, quaternions_about


def body_quaternions(layout: Layout, evaluation: Evaluation) -> Array:
    """Return the quaternions of all bodies in the order of the spec, (n_t, n, 4)."""
    angles = np.concatenate([find_start_angles(layout)[None], evaluation.freedoms["q"]])
    states = np.concatenate([layout.y0[None], evaluation.states])
    tree_quaternions = multiply_along_tree(layout, angles, states)
    start, later = tree_quaternions[0], tree_quaternions[1:]
    is_nonzero = np.abs(start) > tolerances.ZERO_COMPONENT
    first = np.argmax(is_nonzero, axis=1)  # half a turn has w = 0, but for rounding
    signs = np.sign(start[np.arange(len(start)), first])
    return np.asarray((later * signs[:, None])[:, [layout.place[i] for i in range(len(layout.bodies))]])


def rodrigues_vectors(q: Array) -> Array:
    """Return Rodrigues vectors tan(half the turn) n = (x, y, z) / w of quaternions (..., 4); nan close to half a
    turn.
    """
    w = np.where(np.abs(q[..., :1]) < tolerances.HALF_TURN, np.nan, q[..., :1])
    return np.asarray(q[..., 1:] / w)


def find_start_angles(layout: Layout) -> Array:
    """Return the coordinates of the freedoms at the start, (n,), as far as they are rotations."""
    driven = [layout.starts[freedom.joint].angle if freedom.q < 0 else 0.0 for freedom in layout.freedoms]
    places = np.array([freedom.q for freedom in layout.freedoms], dtype=int)
    return np.where(places >= 0, layout.y0[places], driven) if len(places) else np.zeros(0)


def multiply_along_tree(layout: Layout, angles: Array, states: Array) -> Array:
    """Return the quaternions of the bodies in tree order, (n_t, n, 4), at angles (n_t, freedoms) and states (n_t,
    n_state).
    """
    bodies, freedoms = layout.bodies, layout.tables["freedoms"]
    axes, kinds = vector_array(freedoms["direction"]), freedoms["kind"]
    result = np.zeros((len(states), len(bodies), 4))
    for i, body in enumerate(bodies):
        if body["ball"]:
            q = states[:, body["attitude_at"] :][:, :4]
        else:
            q = result[:, body["parent"]] if body["parent"] >= 0 else np.array([[1.0, 0.0, 0.0, 0.0]])
            body_freedoms = range(body["first_freedom"], body["end_freedom"])
            for k in (k for k in body_freedoms if kinds[k] == kernel.TURN_IN_PARENT):
                q = quaternion_product(q, quaternions_about(axes[k], angles[:, k]))
            if body["framed"]:
                q = quaternion_product(q, quaternion_from_matrix(np.reshape(body["frame"].tolist(), (3, 3)))[None])
            for k in (k for k in body_freedoms if kinds[k] == kernel.TURN_IN_BODY):
                q = quaternion_product(q, quaternions_about(axes[k], angles[:, k]))
        result[:, i] = q / np.sqrt(np.sum(q * q, axis=1))[:, None]
    return result
