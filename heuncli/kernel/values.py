"""Values that the kernel's functions pass to each other: motions of points and lines, and their changes.

Below: vectors of bodies and of arrays, directions fixed in bodies, vectors and quaternions among the numbers of a
state.
"""

from __future__ import annotations

from heuncli.kernel.algebra import Quaternion, Vec3, rotate
from heuncli.kernel.scene import Scene
from heuncli.kernel.structs import Pointer, Size, Value


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


class PointKinematics(Value):
    """The motion of a body's point: velocity, centripetal acceleration, and the body's angular velocity."""

    v: Vec3
    centripetal: Vec3
    omega: Vec3


class PlanarPointKinematics(Value):
    """The motion of a body's point in the plane: velocity, centripetal acceleration, the body's angular velocity."""

    vx: float
    vy: float
    cx: float
    cy: float
    omega: float


class LoadTangent(Value):
    """The change of a load along a direction of the state: of its place, force and moment."""

    place: Vec3
    force: Vec3
    moment: Vec3


class LineTangent(Value):
    """The change of the line between a load's two points along a direction of the state: of n, length and its rate."""

    turned: Vec3
    length: float
    rate: float


class BushingRates(Value):
    """The rate of a bushing's shift or turn and that of the other of the two, or their changes: velocity of b's point
    and angular velocity of b, as seen from a, world axes.
    """

    own: Vec3
    other: Vec3


class BushingTangent(Value):
    """The change of a bushing's force or moment along a direction of the state, and of the power of its damping."""

    acts: Vec3
    power: float


class RowTangent(Value):
    """The change of a closure row along a direction of the state: of place, unit load, rate, J Vdot + gamma."""

    Q: Vec3
    f: Vec3
    m: Vec3
    rate: float
    acceleration: float


class Strand(Value):
    """The position of a strand of a rope (sheaves.py): n, the axis; t, the strand's direction across it; w = t x n; l
    and S, the lengths across the axis and in all.
    """

    n: Vec3
    t: Vec3
    w: Vec3
    l: float
    S: float
    h: float  # along the axis
    sigma: float


class StrandRate(Value):
    """The motion of a strand: rates of its angle and of its lengths across the axis and in all; bend: the part of the
    second derivative of its length that the rates cause.
    """

    chi: float
    l: float
    S: float
    bend: float


class RopeMotion(Value):
    """The length of a rope and its rate."""

    S: float
    rate: float


class LengthBounds(Value):
    """Bounds, over an interval of time, of the rate and the second derivative of a length or strain.

    bend: how far it may be from the chord between its ends
    far: size of the terms that it is the difference of
    rounding: relative
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
    """A vector with its rate, and the changes of both along a direction of the state."""

    own: VectorRate
    change: VectorRate


class WheelContact(Value):
    """Where a wheel touches its plane, and the direction of its row."""

    c: VectorRate
    e: VectorRate


class WheelTangent(Value):
    """A wheel's contact with its change along a direction of the state."""

    c: VectorRateTangent
    e: VectorRateTangent


class CamStance(Value):
    """A cam and its follower in the world; or the changes of these."""

    e: Vec3  # the disc's axis
    g: Vec3  # the follower's axis or guide
    C: Vec3  # the follower's point, from the disc's axis
    w: Vec3  # its velocity relative to the carrier for a unit of the follower's rate
    h: Vec3  # the normal of its face
    slope: float  # L'


class CamContact(Value):
    """Where a cam touches, from the follower's point on, and the direction of its load there, of any length."""

    offset: Vec3
    n: Vec3


class TrackFrame(Value):
    """A direction across a path, and its change along it."""

    N: Vec3
    change: Vec3


class PlaceTangent(Value):
    """The change of the place s of a path nearest to a point: of s itself, r', r'', and |r'|^2 - r'' . (D - r)."""

    s: float
    slope: Vec3
    bend: Vec3
    square: float  # that itself
    squared: float  # and its change


class MotionTangent(Value):
    """The changes of velocity and acceleration of a place fixed in a body."""

    v: Vec3
    a: Vec3


class RelativeMotion(Value):
    """Velocity and acceleration of b's point as seen from a, at one place, world axes; and their changes along a
    direction of the state.
    """

    v: Vec3
    A: Vec3
    dv: Vec3
    dA: Vec3


class Instants(Value):
    """States to recover, and work arrays; the results of one kind follow each other, state by state."""

    count: Size  # how many states
    n: Size  # numbers of a state
    body_width: Size  # numbers of all bodies' results at one state
    freedom_width: Size
    load_width: Size
    row_width: Size
    part_width: Size
    whole_width: Size
    column_width: Size
    chooses_rows: bool  # the closure rows are chosen anew at each
    has_branches: bool  # `branches` are given
    has_causes: bool  # a column a cause is answered, too
    mode_count: int  # numbers of `holding` for each state (set_contact_modes); 0: the contacts stay as they are
    branches: list[float]  # that expressions hold
    holding: list[float]  # which contacts are closed, and how; where latches hold
    times: list[float]
    states: list[float]  # settled in place
    bodies: list[float]  # the results, one array for each kind (multibody/tree/tables.py)
    freedoms: list[float]
    loads: list[float]
    rows: list[float]
    parts: list[float]
    whole: list[float]  # of the state itself
    columns: list[float]  # of the causes
    y: list[float]  # the state under way
    dy: list[float]  # and its derivative


def world_direction(scene: Pointer[Scene], body: int, a: Vec3) -> Vec3:
    """Return the world components of a direction fixed in a body, or in the ground (-1)."""
    if body < 0:
        return a
    return rotate(scene.bodies[body].R, a)


def write_number(numbers: list[float], offset: Size, x: float) -> Size:
    """Write a number at `offset`; return the offset behind it."""
    numbers[offset] = x
    return offset + 1


def read_vector(numbers: list[float], offset: Size) -> Vec3:
    """Return the vector whose components begin at `offset`."""
    return Vec3(numbers[offset], numbers[offset + 1], numbers[offset + 2])


def write_vector(numbers: list[float], offset: Size, a: Vec3) -> Size:
    """Write a vector from `offset` on; return the offset behind it."""
    numbers[offset] = a.x
    numbers[offset + 1] = a.y
    numbers[offset + 2] = a.z
    return offset + 3


def read_quaternion(numbers: list[float], offset: Size) -> Quaternion:
    """Return the quaternion whose components begin at `offset`."""
    return Quaternion(numbers[offset], numbers[offset + 1], numbers[offset + 2], numbers[offset + 3])


def write_quaternion(numbers: list[float], offset: Size, q: Quaternion) -> Size:
    """Write a quaternion from `offset` on; return the offset behind it."""
    numbers[offset] = q.w
    numbers[offset + 1] = q.x
    numbers[offset + 2] = q.y
    numbers[offset + 3] = q.z
    return offset + 4
