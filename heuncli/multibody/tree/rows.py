"""The rows of the kernel's tables: the fields of each struct that are given, with their types.

The meaning of the fields is described in kernel/scene.py. Bodies are tree indices, -1 is the ground; vectors are (3,),
matrices (3, 3). Fields with a default are zero if not given. Yes and no are 1 and 0.
"""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.base.records import record
from heuncli.kernel.choose import structs
from heuncli.multibody.tree.tables import Table, make_table
from heuncli.results.results import Array

Program = tuple[int, int]  # of a value in time: where it starts among the pack's, and how long it is
NO_PROGRAM: Program = (0, 0)
ZERO = (0.0, 0.0, 0.0)
Vector = Array | Sequence[float]


@record
class BodyRow:
    """A body on its joint; inertia as Sym3."""

    parent: int
    ball: int
    attitude_at: int
    rate_at: int
    first_freedom: int
    end_freedom: int
    answer_at: int
    framed: int
    mass: float
    first_moment: Array
    inertia: tuple[float, ...]
    joint_in_parent: Array
    frame: Array

    @property
    def answers(self) -> range:
        """The answer indices of this body's freedoms."""
        return range(self.answer_at, self.answer_at + 3 * self.ball + self.end_freedom - self.first_freedom)


@record
class FreedomRow:
    """A scalar freedom of a joint."""

    kind: int
    q_at: int
    u_at: int
    driven: int
    answer_at: int
    body: int
    program: Program
    direction: Array
    path: int = 0
    pieces: int = 0
    period: float = 0.0
    reach: float = 0.0
    slope: float = 0.0
    bend: float = 0.0
    radius: float = 0.0
    normal: Vector = ZERO


@record
class PieceRow:
    """A piece of a path."""

    begin: float
    c0: Array
    c1: Array
    c2: Array
    c3: Array


@record
class LoadRow:
    """An applied load: x, y, z are the components that vary, vector the constant ones."""

    kind: int
    a: int
    b: int
    x: Program
    y: Program
    z: Program
    vector: Vector
    in_body: int = 0
    freedom: int = 0
    counter: int = 0
    p: Vector = ZERO
    q: Vector = ZERO
    stiffness: float = 0.0
    length: float = 0.0
    coefficient: float = 0.0
    axis: Vector = ZERO
    speed: float = 0.0
    factor: float = 0.0
    offset: float = 0.0
    across: Vector = ZERO
    mark: Vector = ZERO
    presses: int = 0
    held_by: int = 0
    row: int = 0
    row_count: int = 0
    reach: float = 0.0
    frame: Sequence[float] = (0.0,) * 9
    to_frame: Sequence[float] = (0.0,) * 9
    stiffnesses: Vector = ZERO
    resistances: Vector = ZERO
    part: int = 0
    part_count: int = 0


@record
class ClosureRow:
    """A closure row: its condition."""

    kind: int
    a: int
    b: int
    p: Vector
    q: Vector
    weight: float
    freedom: int = 0
    program: Program = NO_PROGRAM
    e: Vector = ZERO
    g: Vector = ZERO
    length: float = 0.0
    part: int = 0
    part_count: int = 0
    factor: float = 0.0
    c: int = 0
    ratio: float = 0.0
    freedom_b: int = 0
    ratio_b: float = 0.0
    lift: int = 0
    pieces: int = 0
    period: float = 0.0
    swings: int = 0
    faced: int = 0
    radius: float = 0.0
    pivot: Vector = ZERO
    h: Vector = ZERO
    counter: int = 0


@record
class ClosureIndices:
    """Positions of the path, the answers and the couplings of a closure row in `indices`, and of its column in
    `columns`.
    """

    path: int
    path_count: int
    column: int
    answers: int
    answer_count: int
    filled_count: int
    couplings: int
    coupling_count: int
    rank: int


@record
class ContactRow:
    """A one-sided closure row."""

    row: int
    sense: int
    opens: int
    freedom: int
    held_at: int = 0


@record
class CounterRow:
    """The angle of a cut pin, or the position of a cut joint along its path."""

    a: int
    b: int
    at: int
    axis: Array
    track: int


@record
class VariableRow:
    """A coordinate that expressions use, or a point's position along a direction; all zero for the time.

    load: row of a load, for a variable that is its deformation
    q: the point from its body's joint point, its axes
    direction: world axes
    """

    freedom: int = 0
    is_rate: int = 0
    is_point: int = 0
    load: int = 0
    part: int = 0
    body: int = 0
    q: Vector = ZERO
    direction: Vector = ZERO
    offset: float = 0.0


@record
class WatchRow:
    """A program that is watched during the steps."""

    program: Program
    curved: int
    condition: int
    load: int


@record
class GroupRow:
    """Components of the state whose errors are taken together."""

    coordinates: int
    rates: int
    end: int


@record
class IslandRow:
    """Positions of the rows and the freedoms of an island in `indices`."""

    rows: int
    row_count: int
    freedoms: int
    freedom_count: int


Row = (
    BodyRow
    | FreedomRow
    | LoadRow
    | ClosureRow
    | ClosureIndices
    | ContactRow
    | CounterRow
    | PieceRow
    | VariableRow
    | WatchRow
    | GroupRow
    | IslandRow
)


def make_kernel_table(struct: type[structs.Record], *columns: Sequence[Row]) -> Table:
    """Make the kernel's table of rows; several sequences are parts of the same rows."""
    if len(columns) == 1:
        return make_table(struct, [vars(row) for row in columns[0]])
    rows = zip(*columns, strict=True)
    return make_table(struct, [{name: value for part in row for name, value in vars(part).items()} for row in rows])
