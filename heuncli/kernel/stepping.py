"""The structs of the stepping loop: a method, the present step, and a run (integration.py creates them)."""

from __future__ import annotations

from heuncli.kernel.scene import Group
from heuncli.kernel.structs import Struct

# What `run_steps` returns (steps.py), and the verdicts on a step.
REACHED, MORE, COLLAPSED, NOT_A_NUMBER, CLOSURES_LOST, ROPE_SLACK, CHATTERING = range(7)
STRUCK, LET_GO, TURNED, STIFF, HALF_TURN, UNSOLVED, ACCEPTED, AGAIN = range(7, 15)
# What a step tried comes to.
NO_EVENT, REPEAT_TO, CONTACT_EVENT, EVENT_CHATTER = range(4)
# A record of the track: whether the step's polynomial is recorded, its start, its length.
HAS_COURSE, STEP_START, STEP_LENGTH = range(3)
MAX_LANDINGS = 6  # attempts at one event: the error of its place is squared each time
# What happens in an interval of time, and what bounds leave undecided. A branch turns: an operation of an expression (a
# condition, a clamp, a sign) takes another of its branches.
NOTHING, TURNS, UNSEEN, UNDECIDED, CLEAR, BRANCH_IN_DOUBT, VALUE_IN_DOUBT, PASSED = range(8)
AS_HELD, BRANCH_TURNED, UNCERTAIN = range(3)  # branches at an instant


class Tangent(Struct):
    """The tangent of a motion at a state, and its work arrays."""

    n: int
    J: list[float]  # d(ydot)/dy by rows
    derivative: list[float]  # the derivative at the state
    change: list[float]  # what it changes by along a direction


class Collocation(Struct):
    """An implicit method by its numbers: the stages Z = T W, with A^-1 = T L T^-1 (collocation.py)."""

    stages: int
    pair_count: int  # complex pairs of eigenvalues in L
    real: float  # the real eigenvalue in L; 0: it has none
    parts: list[float]  # real and imaginary part of each pair
    T_inverse: list[float]  # T^-1 by rows
    T: list[float]  # T by rows
    end: list[float]  # what of the stages makes the end of a step
    error: list[float]  # what of them makes the estimate


class Factors(Struct):
    """The factors of a dense matrix A + i B, by rows (linear.py)."""

    A: list[float]
    B: list[float]
    pivots: list[int]


class Newton(Struct):
    """The iteration for the stages of a step."""

    has_stages: int  # 1: there are stages
    is_evaluated_elsewhere: int  # 1: the last that was evaluated is not the end of the step
    reach: float  # the largest coordinate
    rate: float  # and rate, by which corrections are measured
    tangent: Tangent  # at the start of the step
    real: Factors  # of L - h J
    pairs: tuple[Factors, Factors]
    Z: list[list[float]]  # (stages, n): difference of each stage's state from the start
    polynomial_rows: list[list[float]]  # the same from 1 on, then the first rows of the interpolating polynomial
    W: list[list[float]]  # (stages, n): T^-1 Z, in which the equations of the stages come apart
    step: list[list[float]]  # a correction of W
    error: list[float]


class Method(Struct):
    """A Runge-Kutta method."""

    stages: int  # evaluations a step; the derivative at its end is one more, and the next step's first
    extra: int  # further stages of the dense output
    dense_rows: int  # rows of the interpolating polynomial beside the three that every method has
    estimates: int  # rows of the error estimate: the finer, and (2) a coarser one to weigh it by
    fixed: int  # 1: the steps are given (Controller.step), none is judged
    by_step: int  # 1: an asked instant within a step is reached by a step of its own from the step's start
    implicit: int  # 1: the stages are solved for (collocation.py)
    attitude: int  # held within a step: 0 quaternion, 1 Rodrigues' parameters, 2 the same from the step's start
    exponent: float  # 1 / order of the error estimate in h
    begin: list[int]  # of each row: stages, solution, extra stages, estimates (coarser first), dense
    stage: list[int]  # which stages a row combines
    coefficient: list[float]
    node: list[float]
    collocation: Collocation  # coefficients of an implicit method


class PointCourse(Struct):
    """The motion of points over an interval of time: the state's components, and bounds of the bodies' motion.

    The bounds are magnitudes over the part that is checked, one for each body.
    """

    n: int  # length of the state
    chart: int  # as Method.attitude: which numbers attitudes stand in over a step
    interval_chart: int  # the same over the stretch: 0 about the end of a step
    origin: list[float]  # the state at which a chart begins
    states: list[list[float]]  # Bernstein coefficients of each component over the interval
    slopes: list[float]  # those of a component's rate
    state: list[float]  # a state of the stretch
    saved_variables: list[float]  # variables put aside
    first_place: list[float]  # for each variable of a point: its place at the start of a part, and its rate
    first_rate: list[float]
    last_place: list[float]  # at the end of it
    last_rate: list[float]
    angular_velocity: list[float]  # angular velocity
    angular_acceleration: list[float]  # angular acceleration
    acceleration: list[float]  # acceleration of the joint point
    reach: list[float]  # how far it is from the origin
    speed: list[float]  # its velocity


class Course(Struct):
    """The course of the coordinates over an interval of time."""

    degree: int  # degree of their polynomials
    late: int  # as Run.late: a branch turns where that is certain, not where its margin is zero
    slot: int  # a branch that turns
    undecided: int  # 1: bounds left open whether all values were seen
    begin: float  # the instant of x = 0
    length: float  # from there to x = 1
    latest: float  # the last instant that counts
    finest: float  # part of it down to which events are told apart
    event: float  # x of the event
    crossed_by: float  # an end of a part by which branches have turned ...
    crossing: float  # ... and where, somewhere before it
    value: list[list[float]]  # Bernstein coefficients of each variable over the interval
    rate: list[list[float]]  # and those of its rate, and of the rate of that
    second: list[list[float]]
    work: list[float]
    points: PointCourse  # of the points that expressions use
    begins: list[float]  # starts of the parts to examine
    ends: list[float]
    promise: list[float]  # and what they may hold
    saved_branches: list[float]  # branches put aside
    turned: list[float]  # branches behind the event
    resting: list[float]  # 1: a branch whose margin rests at zero, which is passed over ...
    rests_from: float  # ... between these x
    rests_to: float


class FollowedStep(Struct):
    """What a step of a motion that its drives determine needs of its start."""

    length: float  # by which shifts are measured
    pivot: float  # least of what is left of an independent row
    moved: float  # the most that any coordinate moves in the step
    energy: float  # kinetic and potential
    travel: list[float]  # for each freedom, then each closure row: largest motion per unit of its drive; -1: none
    reach: list[float]  # and how far any of those that turn J
    bends: list[int]  # for each degree of freedom, then each ball body: whether it changes J
    marks: list[float]  # for each counted angle a direction across its axis, in b


class Controller(Struct):
    """The lengths of the steps, and what determines them (judging.py)."""

    tolerance: float
    step: float  # step of a fixed-step method; 0: adaptive
    grid: float  # the instant from which given steps are counted
    on_grid: int  # given steps done since then
    rejected_before: int  # 1: the last attempt was rejected
    proposed: float  # length of the next step
    error: float  # error of the tried step, 1 = just allowed
    rate: float  # the scene's largest so far [1/s]
    imposed_rate: float  # the largest so far of drives, and of each load on its own, also in balance [1/s]
    is_balanced: int  # 1: all is so much slower that it may rest but for rounding
    least_mass_size: float  # the least mass but 0, times the size [kg m]
    energy_scale: float  # sum m size^2
    retries: int  # other lengths tried for this step, to keep its stages off a singular pose
    best: float  # the least trouble of the lengths tried, and its length
    best_h: float
    pivot_at_start: float  # least pivot of the closures where the step starts


class Stiffness(Struct):
    """Whether stability, not accuracy, limits the steps (stages.py)."""

    short_limit: int  # steps held short after which the loop is left; 0: not looked at
    easy_limit: int  # steps on end that were not, after which their count begins anew
    total_limit: int  # steps after which it is left in any case, twice as many the next time; 0: never
    steps: int  # the counts
    easy_steps: int
    stable: float  # h |lambda| from which a step counts as held short
    swiftness: float  # h |lambda| of the step tried


class Landing(Struct):
    """Where the present step is to end on an event, and events that follow each other closely (landing.py,
    contacts.py).
    """

    has_cut: int  # 1: the step under way ends at `cut`
    attempts: int  # to end this step on an event of a branch or a load
    contact_attempts: int  # the same where a contact closes or opens
    turns: int  # 1: branches turn at the end of the step under way
    turns_at_instant: int  # turns of branches since the time went on
    flurry: int  # events since flurry_begin
    cut: float
    flurry_begin: float


class Chart(Struct):
    """The numbers that steps are taken in: the state's own, or those of a chart of attitudes (attitudes.py)."""

    y: list[float]
    z: list[float]
    K: list[list[float]]
    angles_left: list[float]  # for each body the rotation left before it leaves the chart [rad]
    approach_rate: float  # largest angular velocity that a stage saw, by the way to the chart's end [1/s]
    half_turn: int  # 1 + the body whose attitude has come to the end of its chart


class Samples(Struct):
    """The requested instants, and the states there."""

    next: int
    count: int
    times: list[float]
    states: list[list[float]]


class Track(Struct):
    """The steps of one call: those done, or those to be repeated."""

    capacity: int  # room for so many
    step_count: int
    ends: list[float]
    settled: list[float]  # for each step whether its stages were settled
    pivots: list[float]  # least pivot of the closures in each step
    turned: list[float]  # for each step whether branches changed at its end
    branches: list[list[float]]  # branches held in each step
    passed: list[list[float]]  # at each end what the next step starts from (steps.py, write_record)
    has_courses: int  # 1: the polynomials of steps that made one are put down, too
    spans: list[list[float]]  # for each step whether its polynomial is stored, its start and its length
    courses: list[list[float]]  # for each step the state at its start, then the rows of the polynomial, (., n)


class Run(Struct):
    """The stepping loop's state: its options, the present step, and its parts."""

    n: int  # length of the state
    group_count: int
    energy_group: int  # the group of the drives' work; -1: none
    determined: int  # 1: nothing is integrated, the closures tell where everything is
    following: int  # 1: the steps are given by the track, none is judged
    watches_contacts: int  # 1: contacts are watched
    stops_at_turns: int  # 1: the loop is left where a piece begins and where branches turn
    # 1: events are moved by their rounding: a gap that comes within it closes before it is zero, branches and what
    # sticks change later; the difference from the other run shows how exactly events are met
    late: int

    begins_piece: int  # 1: a piece begins
    ends_piece: int  # 1: this step reaches the end of the piece
    projects_stages: int  # 1: the stages are settled, too
    sees_stages: int  # 1: stages are looked at for events
    has_interpolant: int  # 1: the dense output of the step tried is there
    contact: int  # 1 + the one-sided row that closes or opens
    undecided: int  # steps of which bounds could not decide what they hold
    steps: int  # accepted
    evaluations: int  # of the derivative
    t: float  # the instant reached
    h: float  # length of the step under way
    stop: float  # where the step under way ends
    before_end: float  # the last instant at which the piece's expressions hold
    end: float  # of the piece
    gap: float  # the largest that closures were left with [m]

    control: Controller
    stiffness: Stiffness
    landing: Landing
    chart: Chart
    samples: Samples
    track: Track
    course: Course
    followed_step: FollowedStep
    newton: Newton

    groups: list[Group]
    weights: list[float]  # of the components: 1, or 1 / size
    y: list[float]  # the state reached
    z: list[float]  # the solution tried
    carry: list[float]  # what rounding took off y when it was summed up (compensated summation)
    z_carry: list[float]  # the same of z
    K: list[list[float]]  # (stages + 1 + extra, n): derivatives at the stages
    side_stages: list[list[float]]  # the same of steps to asked instants within the step under way
    coarse: list[float]  # error estimates
    fine: list[float]
    dense: list[list[float]]  # (3 + dense_rows, n): rows of the interpolating polynomial
    stage: list[float]  # a state under way
