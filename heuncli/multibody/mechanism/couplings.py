"""Couplings: constraints between bodies other than joints, as sums of conditions of two bodies each.

Gears, belts, screws, ropes, cams and wheels are couplings. Their conditions are given here in the numbers that the
kernel reads (kernel/scene.py, Closure); later code does not depend on their kinds, except to report on them.
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
from heuncli.scene.file_format.models import Vec

# Couplings

GROUND = -1
Place = Array | tuple[float, float, float]
NO_VECTOR = (0.0, 0.0, 0.0)
CouplingKind = Literal[
    "guide", "dot", "rod", "turn", "mesh", "cam", "touches", "rolls", "rolls_aside", "ball_touches", "ball_rolls",
    "strand", "arc", "wound",
]  # fmt: skip


class Coordinate(NamedTuple):
    """A joint's coordinate and its factor."""

    joint: int
    quantity: Literal["angle", "travel"]
    ratio: float


@record
class CamShape:
    """The additional data of a cam part: the lift over the disc's angle, and the shape of the follower.

    swings: whether the follower turns, about g through `pivot` of the carrier (3,), or slides along g
    radius: of its roller about q, 0: a point
    face: the normal of its flat face through q, its axes (3,), or None
    piece_number: of a lift in segments, the number of its piece at the disc's angle, else None
    """

    lift: Path
    swings: bool
    pivot: Array
    radius: float
    face: Array | None
    piece_number: Expression | None = None


@record
class CouplingPart:
    """A condition of the two bodies a and b; the meaning of its fields for each kind is described at the kernel's
    Closure.

    p, q: points of a and b, body axes (for meshes and cams p is a point of the carrier c)
    e, g: directions
    coordinates: those that measure its gap: one for a turn, one or two for a mesh, the disc's and the follower's for a
    cam
    separating_force: of a mesh, the additional force that pushes b away from a, for a multiplier of 1 or of -1, in the
    axes of c; it does no work
    radius: of a wheel; of the sheave on which a rope lies, below zero where the rope runs clockwise about e
    strand: of a rope on a sheave, the index of the strand that arrives among the row's parts
    other_axis: of a strand between two sheaves the axis of b, parallel to e
    on_a: of a mesh the point of c at which its load counts as acting on a, or None for p
    """

    kind: CouplingKind
    a: int
    b: int
    p: Array | tuple[float, float, float] = NO_VECTOR
    q: Array | tuple[float, float, float] = NO_VECTOR
    e: Array | tuple[float, float, float] = NO_VECTOR
    g: Array | tuple[float, float, float] = NO_VECTOR
    factor: float = 1.0
    c: int = GROUND
    coordinates: tuple[Coordinate, ...] = ()
    separating_force: Array | tuple[float, float, float] = NO_VECTOR
    cam: CamShape | None = None
    radius: float = 0.0
    strand: int = 0
    other_axis: Array | tuple[float, float, float] = NO_VECTOR
    on_a: Array | None = None

    @property
    def constrains_speed(self) -> bool:
        """Whether it constrains a speed and no pose."""
        return self.kind in ("rolls", "rolls_aside", "ball_rolls")

    @property
    def constrains_rotation(self) -> bool:
        """Whether it constrains the rotation of its bodies, and not only the positions of points."""
        return self.kind not in ("guide", "rod")

    @property
    def is_couple(self) -> bool:
        """Whether its load is a pure couple."""
        return self.kind in ("dot", "turn")

    @property
    def lies_on_sheave(self) -> bool:
        """Whether it is a piece of rope lying on a sheave; such a piece carries no load of its own."""
        return self.kind in ("arc", "wound")

    @property
    def has_no_load(self) -> bool:
        """Whether it only adds coordinates to another part, without a load."""
        return self.kind == "mesh" and self.a == self.b

    @property
    def body_points(self) -> tuple[tuple[int, Array], ...]:
        """Bodies with the points that it refers to, body axes."""
        if self.is_couple:
            return ()
        if self.kind == "mesh":
            return ((self.c, np.asarray(self.p)),)
        if self.kind == "cam":
            return (self.c, np.asarray(self.p)), (self.b, np.asarray(self.q))
        return (self.a, np.asarray(self.p)), (self.b, np.asarray(self.q))

    @property
    def bodies(self) -> tuple[int, ...]:
        """All bodies that it refers to."""
        return (self.a, self.b, self.c) if self.kind in ("mesh", "cam", "wound") else (self.a, self.b)


@record
class CoupledRow:
    """One scalar condition: the sum of its parts is the length; None: as in the assembled start.

    law: added to the length in time
    weight: of its gap [m per unit], 0: the scene's size
    tension_only: its multiplier is never above zero; with restitution it opens and closes, without it the run ends
    where it would push
    """

    parts: tuple[CouplingPart, ...]
    length: float | None = None
    weight: float = 1.0
    tension_only: bool = False
    restitution: float | None = None
    law: Expression | None = None

    @property
    def is_couple(self) -> bool:
        """Whether its loads are pure couples."""
        return all(part.is_couple for part in self.parts)


@record
class Coupling:
    """A coupling and its conditions; entry: its entry in the spec.

    stretched_row: of an elastic rope, what would be its condition; a load pulls along its parts (RopeLoad)
    friction_row: of a thread with friction that may stick, the condition that then holds it; its unit load is that of
    the friction
    """

    name: str
    rows: tuple[CoupledRow, ...]
    entry: spec.Coupling
    stretched_row: CoupledRow | None = None
    friction_row: CoupledRow | None = None

    @property
    def loading_rows(self) -> tuple[CoupledRow, ...]:
        """The rows along which it loads the bodies: its conditions, or the row of an elastic rope."""
        return self.rows if self.stretched_row is None else (self.stretched_row,)

    @property
    def bodies(self) -> frozenset[int]:
        """All bodies that it refers to, without the ground."""
        return self.bodies_and_ground - {GROUND}

    @property
    def bodies_and_ground(self) -> frozenset[int]:
        """All bodies that it refers to, including the ground."""
        return frozenset(i for row in self.loading_rows for part in row.parts for i in part.bodies)

    @property
    def law(self) -> Expression | None:
        """The law of a rope's length in time; None where that is constant, or the rope is elastic."""
        return self.entry.law if isinstance(self.entry, spec.Rope) and not self.entry.is_elastic else None

    @property
    def has_pretension(self) -> bool:
        """Whether it is a belt with pretension; that acts as a load of the same name."""
        return isinstance(self.entry, spec.Belt) and self.entry.pretension > 0.0

    @property
    def has_load(self) -> bool:
        """Whether there is a load of its name besides its conditions: a pretension, or the friction of a thread."""
        return self.has_pretension or (isinstance(self.entry, spec.Screw) and self.entry.friction is not None)

    @property
    def joints(self) -> frozenset[int]:
        """The joints whose coordinates it contains."""
        return frozenset(x.joint for row in self.rows for part in row.parts for x in part.coordinates)


# Directions


def unit_vector(vector: Vec) -> Array:
    """Normalize a vector; the spec layer has checked that it is not zero."""
    v = np.array(vector, dtype=float)
    v = v / np.abs(v).max()
    along: Array = v / np.sqrt(v @ v)
    return along
