"""What the kernel's functions hand to each other by value: motions of points and lines, and how they change."""

from __future__ import annotations

from heuncli.kernel.algebra import Vec3
from heuncli.kernel.structs import Size, Value


class PathPoint(Value):
    """A place of a path with its derivatives by the coordinate."""

    r: Vec3
    slope: Vec3
    bend: Vec3
    twist: Vec3


class PointMotion(Value):
    """A point's place and velocity."""

    x: Vec3
    v: Vec3


class Carried(Value):
    """How a body carries a place with it: velocity, centripetal acceleration, and its angular velocity."""

    v: Vec3
    centripetal: Vec3
    omega: Vec3


class CarriedInPlane(Value):
    """How a body carries a place in the plane: velocity, centripetal acceleration, its angular velocity."""

    vx: float
    vy: float
    cx: float
    cy: float
    omega: float


class LoadTangent(Value):
    """What a load changes by along a direction of the state: its place, force and moment."""

    at: Vec3
    force: Vec3
    moment: Vec3


class LineTangent(Value):
    """What the line between a load's two points changes by along a direction of the state: n, length and its rate."""

    turned: Vec3
    length: float
    rate: float


class BushingTangent(Value):
    """What a bushing's force or moment changes by along a direction of the state, and the power of its loss."""

    acts: Vec3
    power: float


class RowTangent(Value):
    """What a closure row changes by along a direction of the state: place, unit load, rate, J Vdot + gamma."""

    Q: Vec3
    f: Vec3
    m: Vec3
    rate: float
    acceleration: float


class Strand(Value):
    """How a strand of a rope lies (sheaves.py): the axis, its direction across it, t x n, lengths across and whole."""

    n: Vec3
    t: Vec3
    w: Vec3
    l: float
    S: float
    h: float  # along the axis
    sigma: float


class StrandRate(Value):
    """How a strand moves: rates of its angle and of its lengths across and whole; bend: of its second derivative."""

    chi: float
    l: float
    S: float
    bend: float


class RopeMotion(Value):
    """The length of a rope and its rate."""

    S: float
    rate: float


class LengthBounds(Value):
    """Over a stretch of time: of a length, or a strain, how large its rate and its second derivative may be.

    bend: how far from the chord between its ends it may be; far: of what it is the difference; rounding: relative.
    """

    rate: float
    second: float
    bend: float
    far: float
    rounding: float


class VectorRate(Value):
    """A vector and its rate."""

    x: Vec3
    rate: Vec3


class VectorRateTangent(Value):
    """A vector with its rate, and what both change by along a direction of the state."""

    own: VectorRate
    change: VectorRate


class WheelContact(Value):
    """Where a wheel touches its plane, and the direction that a row of it looks along."""

    c: VectorRate
    e: VectorRate


class WheelTangent(Value):
    """The same with what it changes by along a direction of the state."""

    c: VectorRateTangent
    e: VectorRateTangent


class CamStance(Value):
    """A cam and its follower in the world; or what these change by."""

    e: Vec3  # the disc's axis
    g: Vec3  # the follower's axis or guide
    C: Vec3  # the follower's point, from the disc's axis on
    w: Vec3  # its velocity against the carrier, by a unit of the follower's rate
    h: Vec3  # the normal of its face
    slope: float  # L'


class CamContact(Value):
    """Where a cam touches, from the follower's point on, and the direction of its load there, of any length."""

    beside: Vec3
    n: Vec3


class TrackFrame(Value):
    """A direction across a path, and what it changes by along it."""

    N: Vec3
    change: Vec3


class PlaceTangent(Value):
    """What the place s of a path beside a point changes by: s itself, r', r'', and |r'|^2 - r'' . (D - r)."""

    s: float
    slope: Vec3
    bend: Vec3
    square: float  # that itself
    squared: float  # and its change


class MotionTangent(Value):
    """What velocity and acceleration of a place that a body carries change by."""

    v: Vec3
    a: Vec3


class Instants(Value):
    """States to recover, and room for the work; what is told of one kind stands end to end, state by state."""

    count: Size  # how many states
    n: Size  # numbers of a state
    body_width: Size  # numbers of what is told of all bodies at one
    freedom_width: Size
    load_width: Size
    row_width: Size
    part_width: Size
    whole_width: Size
    column_width: Size
    afresh: bool  # the closure rows are chosen anew at each
    held: bool  # `branches` are given
    causes: bool  # a column a cause is answered, too
    opening: int  # numbers of `holding` a state (take_holding); 0: the contacts stay as they are
    branches: list[float]  # that expressions hold
    holding: list[float]  # which contacts are closed, and how; where latches hold
    times: list[float]
    states: list[float]  # settled in place
    bodies: list[float]  # the answers, a kind each (multibody/tree/tables.py)
    freedoms: list[float]
    loads: list[float]
    rows: list[float]
    parts: list[float]
    whole: list[float]  # of the state itself
    columns: list[float]  # of the causes
    y: list[float]  # the state under way
    dy: list[float]  # and its derivative
