"""The structs of expressions.pxd as plain classes, for the kernel that is not compiled."""

from __future__ import annotations

from array import array
from typing import Any

from heuncli.kernel.algebra import Vec3


class Fields(type):
    """Makes slots of a class's annotations: a struct has its fields and no others."""

    def __new__(mcs, name: str, bases: tuple[type, ...], names: dict[str, Any]) -> Fields:
        names["__slots__"] = tuple(names.get("__annotations__", ()))
        return super().__new__(mcs, name, bases, names)


class Instruction:
    """An operation and its argument."""

    __slots__ = ("argument", "op")

    def __init__(self, op: int, argument: int) -> None:
        self.op = op
        self.argument = argument


class Program:
    """`count` instructions from number `start`; none where a number stands in the program's stead."""

    __slots__ = ("count", "start")

    def __init__(self, start: int, count: int) -> None:
        self.start = start
        self.count = count


class Jet:
    """A value with its first and second derivative in time; never changed in place."""

    __slots__ = ("rate", "second", "value")

    def __init__(self, value: float, rate: float, second: float) -> None:
        self.value = value
        self.rate = rate
        self.second = second


class Bounds:
    """The least and the largest that a number may be; never changed in place."""

    __slots__ = ("high", "low")

    def __init__(self, low: float, high: float) -> None:
        self.low = low
        self.high = high


class Span:
    """Bounds of a value, its rate and its second derivative over a stretch of time; never changed in place."""

    __slots__ = ("rate", "second", "value")

    def __init__(self, value: Bounds, rate: Bounds, second: Bounds) -> None:
        self.value = value
        self.rate = rate
        self.second = second


class Table:
    """A table among the constants: its knots and coefficients begin at these places."""

    __slots__ = ("coefficients", "knots", "outside", "period", "pieces")

    def __init__(self, pieces: int, outside: int, period: float, knots: int, coefficients: int) -> None:
        self.pieces = pieces
        self.outside = outside
        self.period = period
        self.knots = knots
        self.coefficients = coefficients


class Programs:
    """Programs side by side, what they point into, the stacks they run on, and the branches they hold.

    ranges, middles: of the variables over a stretch of time, and at an instant of it; doubt: whether each branch held
    may change there.
    """

    __slots__ = (
        "code", "constants", "doubt", "held", "holding", "jets", "middles", "ranges", "spans", "stack", "tables",
        "variables",
    )  # fmt: skip

    code: list[Instruction]
    constants: list[float]
    tables: list[array[float]]
    variables: list[float]
    stack: list[float]
    jets: list[Jet]
    held: list[float]
    holding: int
    doubt: list[int]
    ranges: list[Span]
    middles: list[Span]
    spans: list[Span]


class PointMotion:
    """A point's place and velocity."""

    __slots__ = ("v", "x")

    def __init__(self, x: Vec3, v: Vec3) -> None:
        self.x = x
        self.v = v


class LoadTangent:
    """What a load changes by along a direction of the state: its place, force and moment."""

    __slots__ = ("at", "force", "moment")

    def __init__(self, at: Vec3, force: Vec3, moment: Vec3) -> None:
        self.at = at
        self.force = force
        self.moment = moment


class RowTangent:
    """What a closure row changes by along a direction of the state: place, unit load, rate, J Vdot + gamma."""

    __slots__ = ("Q", "acceleration", "f", "m", "rate")

    def __init__(self, Q: Vec3, f: Vec3, m: Vec3, rate: float, acceleration: float) -> None:
        self.Q = Q
        self.f = f
        self.m = m
        self.rate = rate
        self.acceleration = acceleration


class MotionTangent:
    """What velocity and acceleration of a place that a body carries change by."""

    __slots__ = ("a", "v")

    def __init__(self, v: Vec3, a: Vec3) -> None:
        self.v = v
        self.a = a


class Carried:
    """How a body carries a place with it: velocity, centripetal acceleration, and its angular velocity."""

    __slots__ = ("centripetal", "omega", "v")

    def __init__(self, v: Vec3, centripetal: Vec3, omega: Vec3) -> None:
        self.v = v
        self.centripetal = centripetal
        self.omega = omega


class CarriedInPlane:
    """How a body carries a place in the plane: velocity, centripetal acceleration, its angular velocity."""

    __slots__ = ("cx", "cy", "omega", "vx", "vy")

    def __init__(self, vx: float, vy: float, cx: float, cy: float, omega: float) -> None:
        self.vx = vx
        self.vy = vy
        self.cx = cx
        self.cy = cy
        self.omega = omega


class Instants(metaclass=Fields):
    """States to recover, and room for the work."""

    count: int
    n: int
    width: int
    afresh: bool
    held: bool
    causes: bool
    opening: int
    branches: list[float]
    holding: list[float]
    times: list[float]
    states: list[float]
    out: list[float]
    y: list[float]
    dy: list[float]

    def __init__(self, *fields: Any) -> None:
        for name, value in zip(type(self).__annotations__, fields, strict=True):
            setattr(self, name, value)


class Tangent(metaclass=Fields):
    """The tangent of a motion at a state, and room for its work; jacobian.pxd says what the fields are."""

    n: int
    J: list[float]
    at: list[float]
    beside: list[float]


class Collocation(metaclass=Fields):
    """An implicit method; dense.pxd says what the fields are."""

    stages: int
    pair_count: int
    real: float
    parts: list[float]
    into: list[float]
    back: list[float]
    end: list[float]
    error: list[float]


class Factors(metaclass=Fields):
    """Of a dense matrix; dense.pxd says what the fields are."""

    A: list[float]
    B: list[float]
    pivots: list[int]


class Newton(metaclass=Fields):
    """The iteration for the stages of a step; dense.pxd says what the fields are."""

    solved: int
    elsewhere: int
    reach: float
    rate: float
    tangent: Tangent
    real: Factors
    pairs: list[Factors]
    Z: list[list[float]]
    known: list[list[float]]
    W: list[list[float]]
    step: list[list[float]]
    error: list[float]


class Method(metaclass=Fields):
    """A Runge-Kutta method; dense.pxd says what the fields are."""

    stages: int
    extra: int
    dense_rows: int
    estimates: int
    fixed: int
    by_step: int
    implicit: int
    attitude: int
    exponent: float
    begin: list[int]
    stage: list[int]
    coefficient: list[float]
    node: list[float]
    collocation: Collocation


class Course(metaclass=Fields):
    """The course of the coordinates over a stretch of time; dense.pxd says what the fields are."""

    degree: int
    late: int
    slot: int
    undecided: int
    begin: float
    length: float
    latest: float
    finest: float
    event: float
    crossed_by: float
    crossing: float
    value: list[list[float]]
    rate: list[list[float]]
    second: list[list[float]]
    work: list[float]
    begins: list[float]
    ends: list[float]
    promise: list[float]
    before: list[float]
    turned: list[float]
    resting: list[float]
    rests_from: float
    rests_to: float


class Branch(metaclass=Fields):
    """The start of a step of a motion that its drives determine; dense.pxd says what the fields are."""

    length: float
    pivot: float
    moved: float
    energy: float
    reach: list[float]
    marks: list[float]


class Run(metaclass=Fields):
    """The stepping loop's state; dense.pxd says what the fields are."""

    n: int
    group_count: int
    energy_group: int
    determined: int
    following: int
    fresh: int
    last: int
    near: int
    rejected_before: int
    dodges: int
    contact: int
    watching: int
    halting: int
    late: int
    seeing: int
    has_cut: int
    has_interpolant: int
    landings: int
    contact_landings: int
    turns: int
    at_once: int
    flurry: int
    stiff_after: int
    easy_after: int
    look_after: int
    stiff_steps: int
    easy_steps: int
    half_turn: int
    undecided: int
    on_grid: int
    steps: int
    evaluations: int
    rejected: int
    most: int
    done: int
    next_sample: int
    sample_count: int
    t: float
    h: float
    proposed: float
    stop: float
    before_end: float
    end: float
    tolerance: float
    step: float
    grid: float
    stable: float
    swiftness: float
    rate: float
    energy_scale: float
    error: float
    nearing: float
    gap: float
    best: float
    best_h: float
    pivot_at_start: float
    cut: float
    flurry_begin: float
    course: Course
    branch: Branch
    newton: Newton
    groups: list[Any]
    weights: list[float]
    y: list[float]
    z: list[float]
    carry: list[float]
    z_carry: list[float]
    K: list[list[float]]
    beside: list[list[float]]
    coarse: list[float]
    fine: list[float]
    dense: list[list[float]]
    stage: list[float]
    chart_y: list[float]
    chart_z: list[float]
    chart_K: list[list[float]]
    ways: list[float]
    times: list[float]
    samples: list[list[float]]
    ends: list[float]
    settled: list[float]
    pivots: list[float]
    turned: list[float]
    branches: list[list[float]]
    passed: list[list[float]]
