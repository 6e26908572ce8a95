"""Where the numbers of a smaller scene's state stand in the larger one's, and the constants between them.

A body that hangs as it did has the same coordinates and rates, but for two kinds. Where nothing carries it, they are
those of its centre of mass, which is another one if the body has become larger:
    c' = c + R d,    cdot' = cdot + omega x (R d)        d from the old centre to the new one, body axes
The two shifts of a plane's point are along directions that are chosen by the normal's components: they turn by a
constant angle if those are of other axes.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from heuncli.base.joint_kinds import JOINTS
from heuncli.base.records import record
from heuncli.multibody.reduction.smaller_scene import Parts
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.spanning import Hang
from heuncli.multibody.tree.starts import joint_frame
from heuncli.results.results import Array, Indices
from heuncli.scene.shapes.rotations import cross_rows


@record
class Slots:
    """Where the numbers of a smaller scene's state stand in the larger one's: larger[at] = smaller.

    constant (n,): the numbers of the larger state that the smaller one does not have.
    mixed: pairs of places in the larger state that take C times those of the smaller, (places, C (2, 2)); centres:
    bodies that nothing carries, with their new centres.
    """

    at: Indices
    constant: Array
    mixed: tuple[tuple[Indices, Array], ...]
    centres: tuple[Centre, ...]

    def embed(self, times: Array, states: Array) -> Array:
        """States (n_t, n) of the larger scene from those of the smaller, (n_t, n')."""
        out = np.repeat(self.constant[None, :], len(states), axis=0)
        out[:, self.at] = states
        for places, C in self.mixed:
            out[:, places] = out[:, places] @ C.T
        for centre in self.centres:
            centre.move(out, -1.0)
        return out

    def restrict(self, t: float, state: Array) -> Array:
        """A state (n',) of the smaller scene from one of the larger, (n,)."""
        own = np.array(state, dtype=float)[None, :]
        for centre in self.centres:
            centre.move(own, 1.0)
        for places, C in self.mixed:
            own[:, places] = own[:, places] @ C
        return np.asarray(own[0, self.at])


@record
class Centre:
    """The centre of a body that nothing carries, of which more has become part; places are those of the larger state.

    place, speed: of its shifts; arm: what the centre of a state is moved by, states (n_t, n) -> R d and omega x (R d).
    """

    place: Indices
    speed: Indices
    arm: Callable[[Array], tuple[Array, Array]]

    def move(self, states: Array, sense: float) -> None:
        """Move it in states (n_t, n), which are changed: 1 to the new centre, -1 to the old one."""
        out, swept = self.arm(states)
        states[:, self.place] += sense * out[:, : len(self.place)]
        states[:, self.speed] += sense * swept[:, : len(self.speed)]


def slots(larger: Layout, smaller: Layout, parts: Parts, constant: Array) -> Slots:
    """Where the smaller scene's numbers stand; constant (n,): a larger state for what the smaller does not have."""
    at = np.full(smaller.n_state, -1)
    mixed: list[tuple[Indices, Array]] = []
    centres: list[Centre] = []
    left = [i for i, h in enumerate(larger.spanning.hangs) if h.body in parts.roots]
    for here, there in enumerate(left):
        h = larger.spanning.hangs[there]
        own, of = smaller.tables["groups"][here], larger.tables["groups"][there]
        at[own["coordinates"] : own["end"]] = np.arange(of["coordinates"], of["end"])
        if h.joint >= 0:
            mixed += turned_shifts(larger, smaller, parts, (here, there))
            continue
        d = smaller.mechanism.bodies[smaller.spanning.hangs[here].body].center - larger.mechanism.bodies[h.body].center
        if d.any():
            centres.append(centre_of(larger, there, d))
    names = {joint.name: k for k, joint in enumerate(larger.mechanism.joints)}
    for k, place in smaller.counters.items():
        at[place] = larger.counters[names[smaller.mechanism.joints[k].name]]
    if smaller.work_at >= 0:
        at[smaller.work_at] = larger.work_at
    return Slots(at, constant, tuple(mixed), tuple(centres))


def turned_shifts(
    larger: Layout, smaller: Layout, parts: Parts, places: tuple[int, int]
) -> list[tuple[Indices, Array]]:
    """How the two shifts of a plane's point turn, of a body by its places in the two trees."""
    here, there = places
    h: Hang = larger.spanning.hangs[there]
    joint, own = larger.mechanism.joints[h.joint], smaller.mechanism.joints[smaller.spanning.hangs[here].joint]
    kind = JOINTS[joint.kind]
    R = parts.at(joint.a).R
    if len(kind.shifts) < 2 or np.array_equal(R, np.eye(3)):
        return []
    before = np.array([R @ joint_frame(joint, d) for d in kind.shifts])
    C = before @ np.array([joint_frame(own, d) for d in kind.shifts]).T
    row = larger.bodies[there]
    freedoms = [f for f in larger.freedoms[row["first_freedom"] : row["end_freedom"]] if f.quantity in kind.shifts]
    return [(np.array([f.q for f in freedoms]), C), (np.array([f.u for f in freedoms]), C)]


def centre_of(layout: Layout, place: int, d: Array) -> Centre:
    """The centre, moved by d (body axes), of a body that nothing carries."""
    row = layout.bodies[place]
    freedoms = layout.freedoms[row["first_freedom"] : row["end_freedom"]]
    shifts = [f for f in freedoms if f.quantity != "turn"]
    if row["ball"]:
        arm: Callable[[Array], tuple[Array, Array]] = partial(in_space, at=(row["attitude_at"], row["rate_at"]), d=d)
    else:
        turn = next(f for f in freedoms if f.quantity == "turn")
        R = np.array(row["frame"].tolist()).reshape(3, 3)
        arm = partial(in_plane, at=(turn.q, turn.u), d=R @ d)
    return Centre(np.array([f.q for f in shifts]), np.array([f.u for f in shifts]), arm)


def in_space(states: Array, at: tuple[int, int], d: Array) -> tuple[Array, Array]:
    """R d and omega x (R d) of a body whose attitude and rate stand at those places, (n_t, 3) each."""
    q, omega = states[:, at[0] : at[0] + 4], states[:, at[1] : at[1] + 3]
    out = rotated(q, d)
    return out, cross_rows(omega, out)


def in_plane(states: Array, at: tuple[int, int], d: Array) -> tuple[Array, Array]:
    """R d and omega x (R d), (n_t, 2) each, of a body that turns about z only; angle and rate stand at those places.

    At angle zero R d is d.
    """
    angle, rate = states[:, at[0]], states[:, at[1]]
    cosine, sine = np.cos(angle), np.sin(angle)
    x, y = cosine * d[0] - sine * d[1], sine * d[0] + cosine * d[1]
    return np.stack([x, y], axis=1), np.stack([-rate * y, rate * x], axis=1)


def rotated(q: Array, d: Array) -> Array:
    """R d of quaternions (n_t, 4), which need not be of unit length."""
    w, v = q[:, :1], q[:, 1:]
    across = cross_rows(v, d)
    return np.asarray(d + 2.0 * (w * across + cross_rows(v, across)) / np.sum(q * q, axis=1, keepdims=True))
