"""Couplings as they are meant: what stands under `couplings` and `rolling`, SI, references followed.

One class a type; joints and bodies by their names. As in scene/file_format/models.py, None is what was left out.
"""

from __future__ import annotations

from typing import Literal

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.expressions.programs import Expression, TableFunction
from heuncli.scene.file_format.ends import End, Vec


class Term(NamedTuple):
    """A joint's coordinate and how many times it is taken."""

    joint: str
    quantity: Literal["angle", "travel"]
    factor: float


def joints_of(terms: tuple[Term, ...]) -> tuple[str, ...]:
    """Those whose coordinates are terms."""
    return tuple(term.joint for term in terms)


class Ratio(NamedTuple):
    """A linear relation: the sum of the terms stays what it is at the start, or is `is_`."""

    terms: tuple[Term, ...]
    is_: float | None = None
    type: Literal["ratio"] = "ratio"

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints that it couples."""
        return joints_of(self.terms)


class RollingWheel(NamedTuple):
    """A wheel that rolls on a plane.

    wheel: its centre; axis: its axle, in its own axes, None: a sphere. on: a point of the plane; normal: towards the
    wheel, in the axes of the body that has the plane. friction: the coefficient from which on it slips, None: never.
    slides: it does not roll along its track, and only does not slip aside. held: the plane can pull it, too.
    """

    wheel: End
    axis: Vec | None
    radius: float
    on: End
    normal: Vec
    friction: float | None = None
    slides: bool = False
    held: bool = False
    type: Literal["wheel"] = "wheel"

    @property
    def joints(self) -> tuple[str, ...]:
        """None: a wheel counts by no coordinate."""
        return ()


class Gear(NamedTuple):
    """Two gears, or a gear and a rack, by their joints: those of the terms, whose factors are 1.

    ratio: of the first coordinate by the second; teeth: of both; None where not given. at: the pitch point.
    """

    terms: tuple[Term, ...]
    ratio: float | None = None
    teeth: tuple[float, float] | None = None
    internal: bool = False
    at: End | None = None
    pressure_angle: float = 0.0
    helix: float = 0.0
    type: Literal["gear"] = "gear"

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints that it couples."""
        return joints_of(self.terms)


class ThreadFriction(NamedTuple):
    """What rubs in a thread: coefficient of its flanks as in a square thread, at the mean radius [m].

    Full where the spindle turns faster than `speed` [rad/s], times tanh(rate/speed).
    """

    coefficient: float
    radius: float
    speed: float


class Screw(NamedTuple):
    """A thread between what turns and what slides: a cylinder's two coordinates, or a pin's and a slide's.

    lead: travel a turn [m], in the coordinates as they are written.
    """

    terms: tuple[Term, ...]
    lead: float
    friction: ThreadFriction | None = None
    type: Literal["screw"] = "screw"

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints that it couples."""
        return joints_of(self.terms)


class Belt(NamedTuple):
    """A belt over two pulleys of some radii [m]; pretension [N]: of each strand at rest without load; crossed."""

    terms: tuple[Term, ...]
    radii: tuple[float, float]
    crossed: bool = False
    pretension: float = 0.0
    type: Literal["belt"] = "belt"

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints that it couples."""
        return joints_of(self.terms)


class Differential(NamedTuple):
    """Two shafts and their carrier, the terms: first - carrier = ratio (second - carrier)."""

    terms: tuple[Term, ...]
    ratio: float = -1.0
    type: Literal["differential"] = "differential"

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints that it couples."""
        return joints_of(self.terms)


class Cam(NamedTuple):
    """A disc on the pin `shaft` that moves the follower of another joint: its coordinate is the lift over the angle.

    at: the point of the follower, its axes; its roller has that centre and a radius [m], its flat face that point and a
    normal. phase: the disc's angle at which the lift's own zero stands [rad]. restitution: of one that lifts off and
    strikes again; None: the run ends where it would lift, or, with `both`, the follower is guided on both sides.
    """

    shaft: str
    follower: str
    lift: TableFunction
    at: tuple[float, float, float]
    contact: Literal["roller", "flat", "point"]
    radius: float = 0.0
    normal: tuple[float, float, float] | None = None
    phase: float = 0.0
    both: bool = False
    restitution: float | None = None
    type: Literal["cam"] = "cam"

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints that it couples."""
        return self.shaft, self.follower


class Passage(NamedTuple):
    """Where a rope passes: a point of a body, radius 0, or a sheave about it.

    axis: of the sheave, body axes, None: that of the pin there; side: past which the rope runs, None: the shortest way;
    grips: the rope does not slip on the sheave.
    """

    end: End
    radius: float = 0.0
    axis: tuple[float, float, float] | None = None
    side: Literal["over", "under", "left", "right"] | None = None
    grips: bool = False


class Rope(NamedTuple):
    """A rope without mass through points and over sheaves; length [m], None: as assembled, or by the law in time.

    tension_only: the run ends where it would push; with restitution it goes slack instead, and catches again.
    stiffness [N/m], damping [N s/m]: of one that stretches, at its length without load, by a law at the start; such a
    one that pulls alone goes slack.
    """

    through: tuple[Passage, ...]
    length: float | None = None
    tension_only: bool = False
    restitution: float | None = None
    law: Expression | None = None
    stiffness: float | None = None
    damping: float = 0.0
    type: Literal["rope"] = "rope"

    @property
    def stretches(self) -> bool:
        """Whether its length is no condition."""
        return self.stiffness is not None

    @property
    def joints(self) -> tuple[str, ...]:
        """None: it couples bodies."""
        return ()

    @property
    def gripped(self) -> frozenset[str]:
        """The bodies with sheaves on which it does not slip."""
        return frozenset(x.end.body for x in self.through if x.grips)


Coupling = (  # a union of the classes here
    Ratio | Gear | Screw | Belt | Differential | Cam | RollingWheel | Rope
)
