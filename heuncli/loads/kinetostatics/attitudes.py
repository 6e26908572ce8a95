"""Attitudes as unit quaternions (w, x, y, z), which go on without jumps while bodies turn.

q and -q are one attitude. A rotation matrix tells neither from the other, nor how often a body has turned; the state
does, with the angles of its joints and the quaternions of its balls. So the quaternions are products along the tree,

    q = q_parent * (cos phi/2, n sin phi/2) * frame * ...

and a body that turns on by 360 degrees comes back to -q. At the start of a run w >= 0, whatever instants are asked for.
"""

from __future__ import annotations

import numpy as np

from heuncli.base import tolerances
from heuncli.kernel.choose import scene as kernel
from heuncli.motion.integration.evaluator import Recovered
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import vectors
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import about_axis, quaternion_product, to_quaternion


def quaternions(layout: Layout, recovered: Recovered) -> Array:
    """Of all bodies in the order of the spec, (n_t, n, 4)."""
    angles = np.concatenate([start_angles(layout)[None], recovered.freedoms["q"]])
    states = np.concatenate([layout.y0[None], recovered.states])
    found = along_tree(layout, angles, states)
    start, now = found[0], found[1:]
    told = np.abs(start) > tolerances.ZERO_COMPONENT
    first = np.argmax(told, axis=1)  # half a turn has w = 0, but for rounding
    signs = np.sign(start[np.arange(len(start)), first])
    return np.asarray((now * signs[:, None])[:, [layout.place[i] for i in range(len(layout.bodies))]])


def rodrigues(q: Array) -> Array:
    """Rodrigues' vectors tan(half the turn) n = (x, y, z) / w of quaternions (..., 4); nan beside half a turn."""
    w = np.where(np.abs(q[..., :1]) < tolerances.HALF_TURN, np.nan, q[..., :1])
    return np.asarray(q[..., 1:] / w)


def start_angles(layout: Layout) -> Array:
    """The coordinates of the freedoms at the start, (n,), as far as they are turns."""
    driven = [layout.starts[freedom.joint].angle if freedom.q < 0 else 0.0 for freedom in layout.freedoms]
    places = np.array([freedom.q for freedom in layout.freedoms], dtype=int)
    return np.where(places >= 0, layout.y0[places], driven) if len(places) else np.zeros(0)


def along_tree(layout: Layout, angles: Array, states: Array) -> Array:
    """The quaternions of the bodies in tree order, (n_t, n, 4), at angles (n_t, freedoms) and states (n_t, n_state)."""
    bodies, freedoms = layout.bodies, layout.tables["freedoms"]
    axes, kinds = vectors(freedoms["direction"]), freedoms["kind"]
    found = np.zeros((len(states), len(bodies), 4))
    for i, body in enumerate(bodies):
        if body["ball"]:
            q = states[:, body["attitude_at"] :][:, :4]
        else:
            q = found[:, body["parent"]] if body["parent"] >= 0 else np.array([[1.0, 0.0, 0.0, 0.0]])
            own = range(body["first_freedom"], body["end_freedom"])
            for k in (k for k in own if kinds[k] == kernel.TURN_IN_PARENT):
                q = quaternion_product(q, about_axis(axes[k], angles[:, k]))
            if body["framed"]:
                q = quaternion_product(q, to_quaternion(np.reshape(body["frame"].tolist(), (3, 3)))[None])
            for k in (k for k in own if kinds[k] == kernel.TURN_IN_BODY):
                q = quaternion_product(q, about_axis(axes[k], angles[:, k]))
        found[:, i] = q / np.sqrt(np.sum(q * q, axis=1))[:, None]
    return found
