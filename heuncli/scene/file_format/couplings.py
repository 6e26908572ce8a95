"""Validated couplings, the entries of `couplings` and `rolling` in SI, and the points of bodies that entries refer to.

One class per type; joints and bodies by name. As in scene/file_format/models.py, None marks what the spec leaves out.
"""

from __future__ import annotations

from typing import Literal

from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.expressions.motion_segments import MotionRows
from heuncli.scene.expressions.programs import Expression, TableFunction

# Ends

Vec = tuple[float, float, float]


class End(NamedTuple):
    """A point of a body ("ground" or a body's name), in the body's axes; name is None for a point given by
    coordinates.
    """

    body: str
    point: Vec
    name: str | None = None


# Couplings


class Term(NamedTuple):
    """A joint's coordinate and its factor in a sum."""

    joint: str
    quantity: Literal["angle", "travel"]
    factor: float


def joints_of(terms: tuple[Term, ...]) -> tuple[str, ...]:
    """Return the joints of the terms."""
    return tuple(term.joint for term in terms)


class Ratio(NamedTuple):
    """A linear relation: the sum of the terms keeps its start value, or equals `is_`."""

    terms: tuple[Term, ...]
    is_: float | None = None
    type: Literal["ratio"] = "ratio"

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints that it couples."""
        return joints_of(self.terms)


class RollingWheel(NamedTuple):
    """A wheel that rolls on a plane.

    wheel: its centre
    axis: its axle, in its own axes; None: a sphere
    on: a point of the plane
    normal: towards the wheel, in the axes of the plane's body
    friction: coefficient of friction, above which it slips; None: it never slips
    slides: it may slide along its track and is only held sideways
    held: the plane can also pull it
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
        """Empty: a wheel couples bodies, not joint coordinates."""
        return ()


class Gear(NamedTuple):
    """Two gears, or a gear and a rack, given by their joints: those of the terms, whose factors are 1.

    ratio: first coordinate over second, or None
    teeth: numbers of teeth, or None
    at: the pitch point
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
    """Friction in a screw thread: coefficient of the flanks as in a square thread, at the mean radius [m].

    speed: scaled by tanh(rate/speed), full where the spindle turns faster [rad/s]; None: as it is, so that it sticks
    static: the coefficient up to which it sticks, likewise
    """

    coefficient: float
    radius: float
    speed: float | None
    static: float = 0.0


class Screw(NamedTuple):
    """A thread between a turning and a sliding coordinate: both of a cylinder, or those of a pin and a slide.

    lead: travel per turn [m], in the coordinates as written
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
    """A belt over two pulleys of the given radii [m].

    crossed: the strands cross, so the pulleys turn in opposite directions
    pretension: of each strand at rest without load [N]
    """

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
    """A disc on the pin `shaft` that moves the follower, another joint, whose coordinate is the lift at the disc's
    angle.

    at: the point of the follower, in its axes: centre of a roller of `radius` [m], or a point of the flat face with a
    normal
    phase: angle of the disc at which the lift table has its zero [rad]
    is_two_sided: the follower is guided on both sides
    restitution: of a follower that lifts off and hits the disc again; None: the run ends where it would lift
    """

    shaft: str
    follower: str
    lift: TableFunction | MotionRows
    at: tuple[float, float, float]
    contact: Literal["roller", "flat", "point"]
    radius: float = 0.0
    normal: tuple[float, float, float] | None = None
    phase: float = 0.0
    is_two_sided: bool = False
    restitution: float | None = None
    type: Literal["cam"] = "cam"

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints that it couples."""
        return self.shaft, self.follower


class RopePassage(NamedTuple):
    """A place that a rope passes: a point of a body (radius 0), or a sheave around it.

    axis: of the sheave, body axes; None: that of the pin there
    side: on which the rope passes the sheave; None: the shortest path
    grips: the rope does not slip on the sheave
    """

    end: End
    radius: float = 0.0
    axis: tuple[float, float, float] | None = None
    side: Literal["over", "under", "left", "right"] | None = None
    grips: bool = False


class Rope(NamedTuple):
    """A massless rope through points and over sheaves.

    length: [m]; None: as assembled, or given by `law` in time
    tension_only: the run ends where it would push; with restitution it goes slack instead and catches again
    stiffness, damping: of an elastic rope [N/m], [N s/m]; its length without load is `length`, with a law that at the
    start; with tension_only it goes slack
    tension: of a rope that a weight or a winch keeps at it, whatever its length [N]
    """

    through: tuple[RopePassage, ...]
    length: float | None = None
    tension_only: bool = False
    restitution: float | None = None
    law: Expression | None = None
    stiffness: float | None = None
    damping: float = 0.0
    tension: Expression | None = None
    type: Literal["rope"] = "rope"

    @property
    def is_elastic(self) -> bool:
        """Whether the rope is elastic or paid out at a tension, so that its length is not a constraint."""
        return self.stiffness is not None or self.tension is not None

    @property
    def joints(self) -> tuple[str, ...]:
        """Empty: a rope couples bodies."""
        return ()

    @property
    def gripped_bodies(self) -> frozenset[str]:
        """The bodies with sheaves on which the rope does not slip."""
        return frozenset(x.end.body for x in self.through if x.grips)


Coupling = (  # a union of the classes here
    Ratio | Gear | Screw | Belt | Differential | Cam | RollingWheel | Rope
)
