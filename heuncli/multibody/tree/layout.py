"""The assembled mechanism laid out for the kernel: its tables, and the data needed to read its solutions.

A frame is the part of it that does not depend on the value of any load: it is kept where only loads change.
"""

from __future__ import annotations

from array import array
from functools import cache, cached_property

import numpy as np

from heuncli.base.records import fields, record, replace
from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.spanning import SpanningTree
from heuncli.multibody.tree.starts import JointStart
from heuncli.multibody.tree.tables import Table, make_table
from heuncli.results.results import Array, Indices, Mask
from heuncli.scene.expressions.programs import Pack

# Layout

OPEN, CLOSED, CLOSED_BY_OTHERS = 0.0, 1.0, 2.0  # contact states: open, closed, closed by others


@record
class Freedom:
    """A scalar freedom of the tree: its joint and coordinate, and its indices in the state (-1: driven)."""

    joint: int
    quantity: str  # angle, travel; of a universal first, second; of line and plane a direction; of free ones x y z turn
    q: int
    u: int


@record
class Island:
    """Closure rows of loops that share bodies.

    freedoms: of those bodies, with a ball's three rotations, without driven ones
    couples (rows,): whether a row carries a couple and no force
    turns (freedoms,): whether a freedom is a rotation
    length [m]: mean distance of the cut joints' points from the centres of their bodies
    """

    rows: Array
    freedoms: Array
    couples: Mask
    turns: Mask
    length: float


@record
class Contact:
    """A one-sided closure row that opens and closes: of a rope, of one limit of a stop, of a latch, or of a friction.

    sense: 1 an upper limit, whose gap and multiplier are not positive, -1 a lower one, 0 a latch or a friction that
    sticks, which hold in both directions while they are closed
    load_row: of a friction its row among the loads; -1: of others
    joint: to which its coordinate belongs
    """

    name: str  # of the rope (a joint), the stop or the latch
    is_rope: bool
    joint: int
    row: int
    sense: int
    restitution: float
    load_row: int = -1


@record
class LayoutFrame:
    """A layout without loads, which scenes that differ only in loads share: the tree, its rows, the start.

    place: index in the tree by body (the order of spanning.links)
    reference (n, 3): each body's joint point in its own axes, tree order
    freedoms: the scalar freedoms of the tree; a ball's three rotations are not among them
    rows: joint of each closure row
    starts: coordinates of the joints at the start
    counters: by cut joint, the place of its counted angle in the state
    size: of the scene [m]
    y0: state at the start
    energy_group: index of the group of components that is the drives' work (-1: none)
    weights (n_state,): of the components of the state: 1 for angles and rotations, 1 / size for shifts, 0 for
    components that do not control the step size
    tables: the kernel's structs by name (kernel/scene.py); a frame lacks those of loads, watched values and variables
    indices: the indices that the closure rows point into; in a frame an array that can be made read-only
    velocity_count: number of generalised velocities of the tree: scalar freedoms, and three rotations for each ball
    column_count: numbers in the columns of all closure rows
    work_at: index of the work in the state (-1: it is not computed)
    islands: the groups of closure rows whose loops share bodies
    contacts: the rows that open and close
    velocity_scale (velocity_count,): of each freedom in its island's J: 1 for a shift, 1 / length for a rotation, 0
    outside
    flat: whether the kernel moves it in the plane (kernel/plane.py), without loads across it
    """

    spanning: SpanningTree
    place: dict[int, int]
    reference: Array
    freedoms: tuple[Freedom, ...]
    rows: tuple[int, ...]
    starts: tuple[JointStart, ...]
    counters: dict[int, int]
    size: float
    y0: Array
    energy_group: int
    weights: Array
    tables: dict[str, Table]
    indices: Array | array[int]
    velocity_count: int
    column_count: int
    work_at: int
    islands: tuple[Island, ...]
    contacts: tuple[Contact, ...]
    velocity_scale: Array
    flat: bool

    def relative(self, body: int, point: Array) -> Array:
        """Return a body's point relative to its joint point, body axes; a ground point is returned unchanged."""
        return point if body == GROUND else point - self.reference[self.place[body]]

    def in_tree(self, body: int) -> int:
        """Return a body's index in the tree."""
        return body if body == GROUND else self.place[body]


@record
class Layout(LayoutFrame):
    """A scene laid out for the kernel, with the data needed to read its solutions.

    pack: the programs of all expressions
    """

    mechanism: Mechanism
    pack: Pack
    indices: array[int]

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
        """The tree index of each body, in the order of the spec."""
        return [self.place[i] for i in range(len(self.mechanism.bodies))]

    @cached_property
    def body_offsets(self) -> dict[str, Array]:
        """Vectors from the joint points of the bodies, as in the spec, to their origins and centres, body axes, (n, 3)
        each.
        """
        reference = self.reference[self.order]
        return {"origin": -reference, "centre": np.array([body.center for body in self.mechanism.bodies]) - reference}

    @cached_property
    def latches(self) -> tuple[int, ...]:
        """The indices of the latches among the contacts."""
        return tuple(i for i, contact in enumerate(self.contacts) if contact.sense == 0 and contact.load_row < 0)

    @cached_property
    def friction_contacts(self) -> tuple[int, ...]:
        """The indices of the places among the contacts where friction may stick."""
        return tuple(i for i, contact in enumerate(self.contacts) if contact.load_row >= 0)

    @property
    def open_contacts(self) -> Array:
        """The contact state with all contacts open: a number for each, then for each latch the place where it holds.

        After them, for each friction that may stick, its coordinate while it does; else the sign of its slip, 0: it
        exerts nothing. Last, for each of these, the contact that leads the frictions which stick with it as one,
        counted from 1, and its rate per unit rate of that; 0 where it sticks alone or slips.
        """
        if not self.contacts and not self.friction_contacts:
            return np.zeros(0)
        places = self.tables["closures"]["length"][[self.contacts[i].row for i in self.latches]]
        return np.concatenate([np.zeros(len(self.contacts)), places, np.zeros(3 * len(self.friction_contacts))])

    @property
    def friction_slice(self) -> slice:
        """Where contact states hold the coordinates or signs of the frictions that may stick."""
        begin = len(self.contacts) + len(self.latches)
        return slice(begin, begin + len(self.friction_contacts))

    @property
    def group_slice(self) -> slice:
        """Where contact states hold, after these, the leaders and transmissions of the frictions that may stick."""
        return slice(self.friction_slice.stop, self.friction_slice.stop + 2 * len(self.friction_contacts))

    def read_groups(self, holding: Array) -> tuple[Indices, Array]:
        """Return of each friction that may stick the contact that leads its group and its rate per unit rate of that,
        from contact states (n_t, n); (n_t, k) both, -1 and 0 where it does not stick with others.
        """
        numbers = holding[:, self.group_slice]
        return numbers[:, ::2].astype(int) - 1, numbers[:, 1::2]

    def open_followers(self, holding: Array) -> Array:
        """Return contact states (n,) in which of frictions that stick as one their leader alone does."""
        holding = np.array(holding, dtype=float)
        if self.friction_contacts:
            leaders = self.read_groups(holding[None, :])[0][0]
            indices = np.array(self.friction_contacts)
            holding[indices[(leaders >= 0) & (leaders != indices)]] = 0.0
        return holding

    def closed_contacts(self, holding: Array) -> Array:
        """Reduce contact states (..., n) to 1 for each contact that is closed, also through others, and 0 for an open
        one.
        """
        is_closed = np.array(holding, dtype=float)
        n = len(self.contacts)
        is_closed[..., :n] = is_closed[..., :n] > 0.0
        return is_closed

    @property
    def tree_freedoms(self) -> int:
        """The number of freedoms of the tree before its loops close: scalar ones that are not driven, three for each
        ball.
        """
        return sum(1 for f in self.freedoms if f.q >= 0) + 3 * int(self.bodies["ball"].sum())

    @property
    def has_laws(self) -> bool:
        """Whether a coordinate or a rope's length is prescribed."""
        return bool(self.mechanism.laws)

    def path_to_root(self, body: int) -> list[int]:
        """Return the tree indices from a body to the root; empty for the ground."""
        parents, found = self.bodies["parent"], []
        index = self.place.get(body, -1)
        while index >= 0:
            found.append(index)
            index = int(parents[index])
        return found


def rate_indices(layout: Layout) -> Array:
    """Return the state index of the rate of each freedom, three for each ball; -1: driven."""
    indices = np.full(layout.velocity_count, -1)
    for body in layout.bodies:
        if body["ball"]:
            indices[body["velocity_at"] : body["velocity_at"] + 3] = np.arange(body["rate_at"], body["rate_at"] + 3)
    for freedom in layout.tables["freedoms"]:
        if not freedom["driven"]:
            indices[freedom["velocity_at"]] = freedom["u_at"]
    return indices


# Held speeds

SPEEDS = (kernel.ROLLS, kernel.ROLLS_ASIDE, kernel.BALL_ROLLS)


def find_speed_rows(layout: Layout) -> Mask:
    """Return which rows constrain a speed, (rows,); a wheel's row is the sum of one part."""
    closures, parts = layout.tables["closures"], layout.tables["parts"]
    sums = closures["kind"] == kernel.SUM
    is_speed = np.zeros(len(closures), dtype=bool)
    is_speed[sums] = np.isin(parts["kind"][closures["part"][sums]], SPEEDS)
    return is_speed


def make_frame(layout: Layout) -> LayoutFrame:
    """Return the part of a layout that does not depend on loads."""
    values = {name: getattr(layout, name) for name in LayoutFrame.__annotations__}
    return LayoutFrame(**values | {"indices": np.array(layout.indices)})


def make_layout(frame: LayoutFrame, mechanism: Mechanism, pack: Pack, loads: dict[str, Table]) -> Layout:
    """Make a layout from a frame; pack: the programs; loads: the tables that a frame does not have."""
    values = fields(frame) | {"indices": array("i", frame.indices.tobytes()), "tables": frame.tables | loads}
    return Layout(mechanism=mechanism, pack=pack, **values)


def remove_loads(layout: Layout) -> Layout:
    """Return a layout with the tables of a scene without loads and watched conditions."""
    return replace(layout, tables=layout.tables | empty_load_tables())


@cache
def empty_load_tables() -> dict[str, Table]:
    """Return the tables that a frame does not have, for a scene without loads: the time is a variable of all of
    them.
    """
    return {
        "loads": make_table(kernel.Load, []),
        "variables": make_table(kernel.Variable, [kernel.Variable()]),
        "watches": make_table(kernel.Watch, []),
    }
