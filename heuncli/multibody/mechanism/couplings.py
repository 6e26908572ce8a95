"""Couplings: conditions between bodies that no joint makes, as sums of conditions of two bodies each.

Gears, belts, screws, ropes, cams and wheels are all of them such: what they hold is told here in the numbers that the
kernel reads (kernel/scene.py, Closure), and nothing behind this knows their kinds but what tells of them.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.results.results import Array
from heuncli.scene.expressions.paths import Path
from heuncli.scene.expressions.programs import Expression
from heuncli.scene.file_format import couplings as spec

GROUND = -1
Place = Array | tuple[float, float, float]
NOWHERE = (0.0, 0.0, 0.0)
CouplingKind = Literal[
    "guide", "dot", "rod", "turn", "mesh", "cam", "touches", "rolls", "rolls_aside", "ball_touches", "ball_rolls",
    "strand", "arc", "wound",
]  # fmt: skip


class Coordinate(NamedTuple):
    """A joint's coordinate and how many times it is taken."""

    joint: int
    quantity: Literal["angle", "travel"]
    ratio: float


@record
class CamShape:
    """What a cam part has besides: the lift over the disc's angle, and what of the follower touches it.

    swings: whether the follower turns, about g through `pivot` of the carrier (3,), or slides along g. radius: of its
    roller about q, 0: a point. face: the normal of its flat face through q, its axes (3,); None: it has none.
    """

    lift: Path
    swings: bool
    pivot: Array
    radius: float
    face: Array | None


@record
class CouplingPart:
    """A condition of the two bodies a and b; what its fields mean for each kind stands with the kernel's Closure.

    p, q: points of a and b, body axes (of meshes and cams p is one of the carrier c); e, g: directions. coordinates:
    those that its gap is counted by, of a turn one, of a mesh one or two, of a cam the disc's and the follower's.
    apart: of a mesh the force that pushes b out of a beside it, for a multiplier of 1 or of -1: it does no work,
    whatever moves, and stands in the axes of c, too. radius: of a wheel; of what of a rope lies on
    a sheave, below zero where it runs round clockwise about e. strand: of that the place among the row's parts of the
    strand that arrives. other_axis: of a strand between two sheaves the axis of b, parallel to e.
    on_a: of a mesh the point of c at which its load counts as standing on a; None: p.
    """

    kind: CouplingKind
    a: int
    b: int
    p: Array | tuple[float, float, float] = NOWHERE
    q: Array | tuple[float, float, float] = NOWHERE
    e: Array | tuple[float, float, float] = NOWHERE
    g: Array | tuple[float, float, float] = NOWHERE
    factor: float = 1.0
    c: int = GROUND
    coordinates: tuple[Coordinate, ...] = ()
    apart: Array | tuple[float, float, float] = NOWHERE
    cam: CamShape | None = None
    radius: float = 0.0
    strand: int = 0
    other_axis: Array | tuple[float, float, float] = NOWHERE
    on_a: Array | None = None

    @property
    def holds_speed(self) -> bool:
        """Whether it holds a speed and no pose."""
        return self.kind in ("rolls", "rolls_aside", "ball_rolls")

    @property
    def turns_its_bodies(self) -> bool:
        """Whether it holds how its bodies turn, and not only where points of theirs are."""
        return self.kind not in ("guide", "rod")

    @property
    def is_couple(self) -> bool:
        """Whether its load is a couple alone."""
        return self.kind in ("dot", "turn")

    @property
    def lies(self) -> bool:
        """Whether it is of a rope what lies on a sheave, and loads nothing."""
        return self.kind in ("arc", "wound")

    @property
    def counts_alone(self) -> bool:
        """Whether it counts by coordinates for another part, and loads nothing."""
        return self.kind == "mesh" and self.a == self.b

    @property
    def places(self) -> tuple[tuple[int, Array], ...]:
        """Bodies with the points at which it looks at them, body axes."""
        if self.is_couple:
            return ()
        if self.kind == "mesh":
            return ((self.c, np.asarray(self.p)),)
        if self.kind == "cam":
            return (self.c, np.asarray(self.p)), (self.b, np.asarray(self.q))
        return (self.a, np.asarray(self.p)), (self.b, np.asarray(self.q))

    @property
    def bodies(self) -> tuple[int, ...]:
        """All bodies that it looks at."""
        return (self.a, self.b, self.c) if self.kind in ("mesh", "cam", "wound") else (self.a, self.b)


@record
class CoupledRow:
    """One scalar condition: the sum of its parts is the length; None: as it is at the assembled start.

    law: what is added to the length in time. weight: of its gap [m per unit], 0: the scene's size. tension_only: its
    multiplier is never above zero; with restitution it opens and closes, without the run ends where it would push.
    """

    parts: tuple[CouplingPart, ...]
    length: float | None = None
    weight: float = 1.0
    tension_only: bool = False
    restitution: float | None = None
    law: Expression | None = None

    @property
    def is_couple(self) -> bool:
        """Whether its loads are couples alone."""
        return all(part.is_couple for part in self.parts)


@record
class Coupling:
    """A coupling and its conditions; given: as the spec means it.

    stretched: of a rope that stretches what would be its condition; a load pulls along its parts (RopeLoad).
    """

    name: str
    rows: tuple[CoupledRow, ...]
    given: spec.Coupling
    stretched: CoupledRow | None = None

    @property
    def carriers(self) -> tuple[CoupledRow, ...]:
        """What it loads the bodies by: its conditions, or what a load pulls along."""
        return self.rows if self.stretched is None else (self.stretched,)

    @property
    def bodies(self) -> frozenset[int]:
        """All bodies that it looks at, without the ground."""
        return self.ends - {GROUND}

    @property
    def ends(self) -> frozenset[int]:
        """The same, with the ground where it looks at that."""
        return frozenset(i for row in self.carriers for part in row.parts for i in part.bodies)

    @property
    def law(self) -> Expression | None:
        """What prescribes a rope's length in time; None where that stays, or the rope stretches."""
        return self.given.law if isinstance(self.given, spec.Rope) and not self.given.stretches else None

    @property
    def pulls(self) -> bool:
        """Whether it is a belt with a pretension, which is a load of its name."""
        return isinstance(self.given, spec.Belt) and self.given.pretension > 0.0

    @property
    def has_load(self) -> bool:
        """Whether there is a load of its name beside what it holds: a pretension, or what rubs in a thread."""
        return self.pulls or (isinstance(self.given, spec.Screw) and self.given.friction is not None)

    @property
    def joints(self) -> frozenset[int]:
        """The joints whose coordinates it counts by."""
        return frozenset(x.joint for row in self.rows for part in row.parts for x in part.coordinates)
