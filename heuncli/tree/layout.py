"""The assembled mechanism laid out for the kernel: flat arrays, and what is needed to read its answers."""

from __future__ import annotations

from array import array

from heuncli.expressions.programs import Pack
from heuncli.mechanism.model import Mechanism
from heuncli.records import record
from heuncli.results import Array
from heuncli.tree.spanning import Spanning
from heuncli.tree.starts import JointStart


@record
class Freedom:
    """A scalar freedom of the tree: which joint's which coordinate, and where it stands in the state (-1: driven)."""

    joint: int
    quantity: str  # angle | travel | first | second (of line, plane, free bodies)
    q: int
    u: int


@record
class Layout:
    """A scene laid out for the kernel, with what is needed to read its answers.

    place: body -> sweep place (spanning.hangs is in sweep order); reference (n, 3): each body's joint point in its own
    axes, sweep order; rows: joint of each closure row; starts: where the joints stand at the start; y0: the state
    there.
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
    groups: array[int]  # the kernel's D
    weights: Array
    I: array[int]
    P: array[float]
    W: array[float]
    pack: Pack
    work: bool

    @property
    def n_state(self) -> int:
        """Length of the state."""
        return len(self.y0)
