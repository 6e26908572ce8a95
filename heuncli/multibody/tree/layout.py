"""The assembled mechanism laid out for the kernel: its tables, and what is needed to read its answers."""

from __future__ import annotations

from array import array
from functools import cached_property

import numpy as np

from heuncli.base.records import record
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.spanning import Spanning
from heuncli.multibody.tree.starts import JointStart
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array, Mask
from heuncli.scene.expressions.programs import Pack


@record
class Freedom:
    """A scalar freedom of the tree: which joint's which coordinate, and where it stands in the state (-1: driven)."""

    joint: int
    quantity: str  # angle, travel; of a universal first, second; of line and plane a direction; of free ones x y z turn
    q: int
    u: int


@record
class Island:
    """Closure rows of loops that share bodies; freedoms: of those bodies, a ball's three turns and no driven ones.

    couples (rows,): which rows carry a couple and no force; turns (freedoms,): which freedoms are turns.
    length [m]: mean distance of the cut joints' points from the centres of their bodies.
    """

    rows: Array
    freedoms: Array
    couples: Mask
    turns: Mask
    length: float


@record
class Contact:
    """A one-sided closure row that opens and closes: a rope that catches, or one limit of a stop; or a latch's.

    sense: 1 an upper limit, whose gap and multiplier are not positive, -1 a lower one, 0 a latch, which holds both ways
    while it is closed; joint: whose coordinate this is.
    """

    name: str  # of the rope (a joint), the stop or the latch
    is_rope: bool
    joint: int
    row: int
    sense: int
    restitution: float


@record
class Layout:
    """A scene laid out for the kernel, with what is needed to read its answers.

    place: body -> its place in the tree (spanning.hangs is in that order); reference (n, 3): each body's joint point in
    its own axes, tree order; rows: joint of each closure row; starts: where the joints stand at the start; y0: the
    state there. tables: the kernel's structs by name (kernel/scene.py); indices: what the closure rows point into.
    energy_group: which of the groups of components is the drives' work (-1: none). measure (answers,): of each freedom
    in its island's J, 1 of a shift, 1 / length of a turn, 0 of one that is in none. contacts: what opens and closes.
    size: of the scene [m]. weights (n_state,): by which components of the state are measured, 1 of angles and turns,
    1 / size of shifts, 0 of what has no say in a step. column_count: numbers in the columns of all closure rows.
    flat: the kernel moves it in the plane (kernel/plane.py), and finds no loads across it; without, as any scene.
    """

    mechanism: Mechanism
    spanning: Spanning
    place: dict[int, int]
    reference: Array
    freedoms: tuple[Freedom, ...]
    rows: tuple[int, ...]
    starts: tuple[JointStart, ...]
    counters: dict[int, int]  # cut joint -> place of its counted angle in the state
    size: float
    y0: Array
    energy_group: int
    weights: Array
    tables: dict[str, Table]
    indices: array[int]
    answer_count: int  # freedoms of the tree, a ball's three turns among them
    column_count: int
    pack: Pack
    work_at: int  # where the work stands in the state; -1: it is not asked for
    islands: tuple[Island, ...] = ()
    contacts: tuple[Contact, ...] = ()
    measure: Array = np.zeros(0)
    flat: bool = False

    @property
    def bodies(self) -> Table:
        """The kernel's bodies, tree order."""
        return self.tables["bodies"]

    @property
    def n_state(self) -> int:
        """Length of the state."""
        return len(self.y0)

    @cached_property
    def order(self) -> list[int]:
        """The place of each body in the tree, bodies as in the spec."""
        return [self.place[i] for i in range(len(self.mechanism.bodies))]

    @cached_property
    def beside(self) -> dict[str, Array]:
        """From the joint points of the bodies, as in the spec, to their origins and centres, body axes, (n, 3) each."""
        reference = self.reference[self.order]
        return {"origin": -reference, "centre": np.array([body.center for body in self.mechanism.bodies]) - reference}

    @cached_property
    def latches(self) -> tuple[int, ...]:
        """Which of the contacts are latches."""
        return tuple(i for i, contact in enumerate(self.contacts) if contact.sense == 0)

    @property
    def all_open(self) -> Array:
        """What is told of contacts of which none is closed: a number each, then of each latch where it holds."""
        places = self.tables["closures"]["length"][[self.contacts[i].row for i in self.latches]]
        return np.concatenate([np.zeros(len(self.contacts)), places])

    def closed(self, holding: Array) -> Array:
        """The same of others (..., n): 1 of each contact that is closed, also by others, 0 of one that is open."""
        shut = np.array(holding, dtype=float)
        n = len(self.contacts)
        shut[..., :n] = shut[..., :n] > 0.0
        return shut

    @property
    def tree_freedoms(self) -> int:
        """Freedoms of the tree alone, before its loops close: scalar ones that are not driven, three for each ball."""
        return sum(1 for f in self.freedoms if f.q >= 0) + 3 * int(self.bodies["ball"].sum())

    @property
    def driven(self) -> bool:
        """Whether a coordinate or a rope's length is prescribed."""
        return bool(self.mechanism.laws)

    def path(self, body: int) -> list[int]:
        """Places in the tree from a body to the root; empty for the ground."""
        parents, found = self.bodies["parent"], []
        at = self.place.get(body, -1)
        while at >= 0:
            found.append(at)
            at = int(parents[at])
        return found


def places_of_rates(layout: Layout) -> Array:
    """Where the rate of each freedom that is not driven stands in the state, a ball's three turns each; by answers.

    -1: driven.
    """
    found = np.full(layout.answer_count, -1)
    for body in layout.bodies:
        if body["ball"]:
            found[body["answer_at"] : body["answer_at"] + 3] = np.arange(body["rate_at"], body["rate_at"] + 3)
    for freedom in layout.tables["freedoms"]:
        if not freedom["driven"]:
            found[freedom["answer_at"]] = freedom["u_at"]
    return found
