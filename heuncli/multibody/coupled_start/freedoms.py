"""The freedoms that a start may still change, and how bodies and closure rows move with each.

Rates are linear in the rates of the freedoms: what one of them does alone is measured with all others at rest, the
driven ones too, whose share is what is left when none moves.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from heuncli.base.records import record, replace
from heuncli.multibody.mechanism.model import Assembly
from heuncli.multibody.response import MeasuredState, measured, unsettled
from heuncli.multibody.tree.layout import Layout, places_of_rates
from heuncli.results.results import Array, Indices
from heuncli.scene.shapes.rotations import cross_rows, quaternion_from_vector, quaternion_product


@record
class FreedomMotion:
    """What each of n freedoms alone moves at rate 1, world axes: turns (n_b, 3, n), of the bodies, in the spec's order.

    v (n_b, 3, n): of their origins; rows (rows, n): rates of the gaps; x (n_b, 3): where the origins are.
    """

    turns: Array
    v: Array
    rows: Array
    x: Array

    def of_point(self, body: int, place: Array) -> Array:
        """How the body's point at a world place moves, (3, n); the ground's does not."""
        if body < 0:
            return np.zeros((3, self.turns.shape[2]))
        arm = place - self.x[body]
        return np.asarray(self.v[body] + np.cross(self.turns[body], arm[:, None], axis=0))

    def of_turn(self, body: int) -> Array:
        """How the body turns, (3, n)."""
        return self.turns[body] if body >= 0 else np.zeros(self.turns.shape[1:])


class Freedoms:
    """The freedoms of some trees on the ground, and the kernel that measures them; answers: which they are."""

    def __init__(self, layout: Layout, t: float, bodies: Iterable[int]) -> None:
        """bodies: places in the tree, with all that hangs on them."""
        self.layout, self.t = layout, t
        self.workspace = unsettled(layout)
        rate_at = places_of_rates(layout).astype(np.intp)
        own = [n for i in sorted(bodies) for n in _answers(layout, i) if rate_at[n] >= 0]
        self.answers: Indices = np.array(own, dtype=int)
        self.rate_at: Indices = np.array(rate_at[self.answers], dtype=np.intp)
        self.all_rates: Indices = np.array(rate_at[rate_at >= 0], dtype=np.intp)

    def measured(self, state: Array) -> MeasuredState:
        """How all stands and moves at a state."""
        return measured(self.workspace, self.layout, self.t, state)

    def start_of(self, told: MeasuredState) -> tuple[Array, Array, Array, Array]:
        """Position and velocity of the bodies' origins, attitude, angular velocity, in the spec's order."""
        own = told.bodies[self.layout.order]
        arm = np.einsum("nij,nj->ni", own["R"], self.layout.beside["origin"])
        return own["r"] + arm, own["v"] + cross_rows(own["omega"], arm), own["R"].copy(), own["omega"].copy()

    def assembly(self, told: MeasuredState, start: Assembly) -> Assembly:
        """The start as it is measured."""
        x, v, R, omega = self.start_of(told)
        return replace(start, position=x, rotation=R, velocity=v, angular_velocity=omega)

    def motion(self, state: Array) -> FreedomMotion:
        """What each freedom moves at a state."""
        still = np.array(state)
        still[self.all_rates] = 0.0
        x, v0, _, omega0 = self.start_of(rest := self.measured(still))
        turns, v = (np.zeros((len(x), 3, len(self.answers))) for _ in range(2))
        rows = np.zeros((len(self.layout.rows), len(self.answers)))
        for k, at in enumerate(self.rate_at):
            still[at] = 1.0
            _, v1, _, omega1 = self.start_of(told := self.measured(still))
            still[at] = 0.0
            turns[:, :, k], v[:, :, k], rows[:, k] = omega1 - omega0, v1 - v0, told.rates - rest.rates
        return FreedomMotion(turns, v, rows, x)

    def moved(self, state: Array, step: Array) -> Array:
        """The state with coordinates moved by a step (n,); turns of a ball about the world's axes."""
        by = np.zeros(self.layout.answer_count)
        by[self.answers] = step
        new = np.array(state)
        for body in self.layout.bodies[self.layout.bodies["ball"] == 1]:
            at, turn = body["attitude_at"], by[body["answer_at"] : body["answer_at"] + 3]
            if turn.any():
                new[at : at + 4] = quaternion_product(quaternion_from_vector(turn), new[at : at + 4])
        for freedom in self.layout.tables["freedoms"]:
            if not freedom["driven"]:
                new[freedom["q_at"]] += by[freedom["answer_at"]]
        return new

    def hurried(self, state: Array, step: Array) -> Array:
        """The state with rates changed by a step (n,)."""
        new = np.array(state)
        new[self.rate_at] += step
        return new


def _answers(layout: Layout, i: int) -> range:
    body = layout.bodies[i]
    count = 3 * int(body["ball"]) + int(body["end_freedom"] - body["first_freedom"])
    return range(int(body["answer_at"]), int(body["answer_at"]) + count)


def concerned(layout: Layout, rows: Iterable[int]) -> list[int]:
    """The bodies (places in the tree) of all trees on the ground that some closure rows tie, with others' help."""
    parents = layout.bodies["parent"]
    root = list(range(len(parents)))
    for i, parent in enumerate(parents.tolist()):
        if parent >= 0:
            root[i] = root[parent]
    group = {r: r for r in root}

    def found(i: int) -> int:
        while group[i] != i:
            i = group[i]
        return i

    paths = [roots_of(layout, r, root) for r in range(len(layout.rows))]
    for first, *others in filter(None, paths):
        for other in others:
            group[found(other)] = found(first)
    asked = {found(i) for r in rows for i in paths[r]}
    return [i for i in range(len(parents)) if found(root[i]) in asked]


def roots_of(layout: Layout, r: int, root: Sequence[int]) -> list[int]:
    """The bodies on the ground that a closure row's paths come from, by the root of each body."""
    row = layout.tables["closures"][r]
    return list(dict.fromkeys(root[i] for i in layout.indices[row["path"] : row["path"] + row["path_count"]]))
