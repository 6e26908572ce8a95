"""Map the state of a smaller scene into that of the larger one, with the constants between them.

A body that hangs on the same joint has the same coordinates and rates, with two exceptions. Where it has no parent,
they are those of its centre of mass, which is another one if the body has become larger:

    c' = c + R d,    cdot' = cdot + omega x (R d)        d from the old centre to the new one, body axes

The two shifts of a plane's point are along directions that are chosen by the normal's components: they turn by a
constant angle if those are in other axes.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record
from heuncli.multibody.reduction.smaller_scene import BodyParts
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.spanning import TreeLink
from heuncli.multibody.tree.starts import joint_direction
from heuncli.results.results import Array, Indices
from heuncli.scene.shapes.rotations import cross_rows


@record
class StateEmbedding:
    """The map from the smaller scene's state to the larger one's: larger[indices] = smaller.

    constant (n,): the numbers of the larger state that the smaller one does not have
    rotations: pairs of indices in the larger state that take C times those of the smaller, (indices, C (2, 2))
    centres: bodies without parent, with their new centres
    """

    indices: Indices
    constant: Array
    rotations: tuple[tuple[Indices, Array], ...]
    centres: tuple[MovedCentre, ...]

    def embed(self, times: Array, states: Array) -> Array:
        """Map states (n_t, n') of the smaller scene to those of the larger, (n_t, n)."""
        out = np.repeat(self.constant[None, :], len(states), axis=0)
        out[:, self.indices] = states
        for places, C in self.rotations:
            out[:, places] = out[:, places] @ C.T
        for centre in self.centres:
            centre.move(out, -1.0)
        return out

    def restrict(self, t: float, state: Array) -> Array:
        """Map a state (n,) of the larger scene to one of the smaller, (n',)."""
        states = np.array(state, dtype=float)[None, :]
        for centre in self.centres:
            centre.move(states, 1.0)
        for places, C in self.rotations:
            states[:, places] = states[:, places] @ C
        return np.asarray(states[0, self.indices])


@record
class MovedCentre:
    """The centre of a body without parent to which others have been added; indices are those of the larger state.

    place, speed: of its shifts
    arm: the displacement of the centre, states (n_t, n) -> R d and omega x (R d)
    """

    place: Indices
    speed: Indices
    arm: Callable[[Array], tuple[Array, Array]]

    def move(self, states: Array, sense: float) -> None:
        """Move it in states (n_t, n), in place; sense: 1 to the new centre, -1 to the old one."""
        displacement, velocity = self.arm(states)
        states[:, self.place] += sense * displacement[:, : len(self.place)]
        states[:, self.speed] += sense * velocity[:, : len(self.speed)]


def make_state_embedding(larger: Layout, smaller: Layout, parts: BodyParts, constant: Array) -> StateEmbedding:
    """Make the map from the smaller scene's state; constant (n,): a larger state for the numbers that the smaller
    lacks.
    """
    indices = np.full(smaller.n_state, -1)
    rotations: list[tuple[Indices, Array]] = []
    centres: list[MovedCentre] = []
    remaining = [i for i, link in enumerate(larger.spanning.links) if link.body in parts.roots]
    for here, there in enumerate(remaining):
        link = larger.spanning.links[there]
        small_group, large_group = smaller.tables["groups"][here], larger.tables["groups"][there]
        indices[small_group["coordinates"] : small_group["end"]] = np.arange(
            large_group["coordinates"], large_group["end"]
        )
        if link.joint >= 0:
            rotations += shift_rotations(larger, smaller, parts, (here, there))
            continue
        d = (
            smaller.mechanism.bodies[smaller.spanning.links[here].body].center
            - larger.mechanism.bodies[link.body].center
        )
        if d.any():
            centres.append(make_moved_centre(larger, there, d))
    names = {joint.name: k for k, joint in enumerate(larger.mechanism.joints)}
    for k, place in smaller.counters.items():
        indices[place] = larger.counters[names[smaller.mechanism.joints[k].name]]
    if smaller.work_at >= 0:
        indices[smaller.work_at] = larger.work_at
    return StateEmbedding(indices, constant, tuple(rotations), tuple(centres))


def shift_rotations(
    larger: Layout, smaller: Layout, parts: BodyParts, places: tuple[int, int]
) -> list[tuple[Indices, Array]]:
    """Return how the two shifts of a plane's point turn, for a body by its indices in the two trees."""
    here, there = places
    link: TreeLink = larger.spanning.links[there]
    joint, small_joint = (
        larger.mechanism.joints[link.joint],
        smaller.mechanism.joints[smaller.spanning.links[here].joint],
    )
    kind = JOINTS[joint.kind]
    R = parts.get_placement(joint.a).R
    if len(kind.shifts) < 2 or np.array_equal(R, np.eye(3)):
        return []
    before = np.array([R @ joint_direction(joint, d) for d in kind.shifts])
    C = before @ np.array([joint_direction(small_joint, d) for d in kind.shifts]).T
    row = larger.bodies[there]
    freedoms = [f for f in larger.freedoms[row["first_freedom"] : row["end_freedom"]] if f.quantity in kind.shifts]
    return [(np.array([f.q for f in freedoms]), C), (np.array([f.u for f in freedoms]), C)]


def make_moved_centre(layout: Layout, place: int, d: Array) -> MovedCentre:
    """Make the centre, moved by d (body axes), of a body without parent."""
    row = layout.bodies[place]
    freedoms = layout.freedoms[row["first_freedom"] : row["end_freedom"]]
    shifts = [f for f in freedoms if f.quantity != "turn"]
    if row["ball"]:
        arm: Callable[[Array], tuple[Array, Array]] = partial(
            arm_in_space, places=(row["attitude_at"], row["rate_at"]), d=d
        )
    else:
        turn = next(f for f in freedoms if f.quantity == "turn")
        R = np.array(row["frame"].tolist()).reshape(3, 3)
        arm = partial(arm_in_plane, places=(turn.q, turn.u), d=R @ d)
    return MovedCentre(np.array([f.q for f in shifts]), np.array([f.u for f in shifts]), arm)


def arm_in_space(states: Array, places: tuple[int, int], d: Array) -> tuple[Array, Array]:
    """Compute R d and omega x (R d) of a body whose attitude and rate are at those state indices, (n_t, 3) each."""
    q, omega = states[:, places[0] : places[0] + 4], states[:, places[1] : places[1] + 3]
    out = rotate_vector(q, d)
    return out, cross_rows(omega, out)


def arm_in_plane(states: Array, places: tuple[int, int], d: Array) -> tuple[Array, Array]:
    """Compute R d and omega x (R d), (n_t, 2) each, of a body that turns about z only; places: of its angle and rate.

    At angle zero R d is d.
    """
    angle, rate = states[:, places[0]], states[:, places[1]]
    cosine, sine = np.cos(angle), np.sin(angle)
    x, y = cosine * d[0] - sine * d[1], sine * d[0] + cosine * d[1]
    return np.stack([x, y], axis=1), np.stack([-rate * y, rate * x], axis=1)


def rotate_vector(q: Array, d: Array) -> Array:
    """Compute R d of quaternions (n_t, 4), which need not be of unit length."""
    w, v = q[:, :1], q[:, 1:]
    across = cross_rows(v, d)
    return np.asarray(d + 2.0 * (w * across + cross_rows(v, across)) / np.sum(q * q, axis=1, keepdims=True))
