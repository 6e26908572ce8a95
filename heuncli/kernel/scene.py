"""The scene as the kernel sees it: one struct for each body, freedom, load and closure row.

    [n; f] = [A C; C' K] [alpha; a] + [M_branch; f_branch]       what a joint must exert on the branch from its body
                                                                 outward, about the body's joint point r; world axes

Each field is declared here alone: C's structs (headers.py) and the NumPy types of the tables that are the compiled
kernel's memory (multibody/tree/tables.py) follow. The rows of a scene are packed as objects of these classes, by the
names of the fields: a field that is ZERO here may be left out, what stands below `Computed` belongs to the kernel.
World axes unless stated otherwise; `a` always is the acceleration minus that of gravity.
"""

from __future__ import annotations

from heuncli.kernel.algebra import Ldl3, Mat3, Sym3, Vec3
from heuncli.kernel.programs import Program, Programs
from heuncli.kernel.structs import ZERO, Computed, Pointer, Record, Struct

# Kinds of freedoms, loads (named in base/load_kinds.py; their order means nothing) and closure rows.
TURN_IN_PARENT, TURN_IN_BODY, SHIFT = range(3)
FORCE, COUPLE, SPRING, ACTUATOR, TORQUE, THRUST, TURN_SPRING = range(7)
TURN_DAMPER, SHIFT_DAMPER, TURN_FRICTION, SHIFT_FRICTION, THREAD_FRICTION = range(7, 12)
BUSHING_SHIFT, BUSHING_TURN, ROPE = range(12, 15)
AT_POINT, OF_LOAD = range(1, 3)  # variables that depend on the bodies' places
ALONG_LINE, DRAWN = range(3, 5)  # a load's length, and the rate of its unloaded length; 0 to 2: parts of the strain
GUIDE, DOT, ROD, TURN, SUM, MESH, CAM = range(7)
TOUCHES, ROLLS, ROLLS_ASIDE, BALL_TOUCHES, BALL_ROLLS = range(30, 35)  # for wheels
STRAND, ARC, WOUND = range(7, 10)
TRACK, ALONG = range(10, 12)  # for paths
CARRIES, APART, LEANS = range(3)  # modes of closure rows
# Normal force of a joint's friction: given; the joint's whole force; its part across the axis; the forces at two ends;
# the multiplier of a coupling's row.
GIVEN, WHOLE, ACROSS, ENDS, THRUST_OF_ROW = range(5)
FOUND, JAMS, TWO, UNPROVED = range(4)  # solutions of joint friction: one, none, two, perhaps not one


class Body(Record):
    """A rigid body on its joint; parents come before their children."""

    parent: int  # -1: the ground
    ball: int  # 1: all turns are free; the state holds the body's own attitude and angular velocity
    attitude_at: int  # for a ball: where its quaternion stands in the state
    rate_at: int  # and its angular velocity
    first_freedom: int  # scalar freedoms, in the order from the parent outward
    end_freedom: int
    velocity_at: int  # position of a ball's three turns, then its freedoms, among the loads e on the freedoms
    has_frame: int  # 1: `frame` is not 1
    mass: float
    first_moment: Vec3  # m c, body axes from the joint point
    inertia: Sym3  # J about the joint point, body axes
    joint_in_parent: Vec3  # the joint point in the parent, from its joint point, its axes
    frame: Mat3  # attitude in the parent where all coordinates are zero

    _: Computed
    R: Mat3  # attitude, body to world
    r: Vec3  # joint point
    omega: Vec3
    v: Vec3  # velocity of the joint point
    arm: Vec3  # from the parent's joint point to this one
    alpha_bias: Vec3  # part of alpha relative to the parent due to velocities and prescribed accelerations
    a_bias: Vec3
    alpha_zero: Vec3  # alpha and a (gravity left out) if no freedom accelerated
    a_zero: Vec3
    mc: Vec3  # R (m c)
    gyroscopic: Vec3  # omega x J omega
    centrifugal: Vec3  # omega x (omega x m c)
    M_applied: Vec3  # applied moment about the joint point
    f_applied: Vec3
    A: Sym3  # articulated inertia of the branch; in a flat scene all of it, of turn about z, shift x, shift y
    C: Mat3
    K: Sym3
    A_factors: Ldl3  # for a ball: factors of A
    G: Mat3  # for a ball: A^-1 C
    M_branch: Vec3  # load that the branch needs from its joint; for all loads, or for one closure row's unit load
    f_branch: Vec3
    alpha: Vec3
    a: Vec3
    M_joint: Vec3  # load of the joint on the body, by Newton's and Euler's laws
    f_joint: Vec3


class Freedom(Record):
    """A scalar freedom of a joint: a turn about an axis, or a shift along a direction."""

    kind: int
    q_at: int  # where coordinate and rate stand in the state; -1: driven
    u_at: int
    driven: int
    velocity_at: int
    body: int
    program: Program  # value of the drive
    direction: Vec3  # fixed in the parent, or (TURN_IN_BODY) in the body
    path: int = ZERO  # first piece of the path along which a point runs
    pieces: int = ZERO  # and how many it has; 0: its direction is fixed
    period: float = ZERO  # period of the coordinate on a closed path; else 0
    reach: float = ZERO  # bounds of the path's |r|, |r'| and |r''|
    slope: float = ZERO
    bend: float = ZERO
    radius: float = ZERO  # distance of a roller's centre from the path; 0: on it
    normal: Vec3 = ZERO  # normal of the path's plane; the roller is to its left

    _: Computed
    s: Vec3  # its direction, of unit length or, along a path, r'
    curved: Vec3  # along a path r'', else zero
    twisted: Vec3  # and r'''
    U_turn: Vec3  # inertia against it, I s: moment and force
    U_shift: Vec3
    D: float  # 1 / (s . I s); zero where it is driven or moves nothing
    q: float
    u: float
    is_held: int  # 1: a closed contact holds it, so that its rate is exactly 0, without rounding
    udot: float  # prescribed, or found
    drive: float  # load of the drive along it


class Load(Record):
    """An applied load on body b, or between the bodies a and b (on b, the opposite on a)."""

    kind: int
    a: int
    b: int
    in_body: int = ZERO  # the vector is in b's axes; of joint loads: reported along the axis; of ropes: only pulls
    freedom: int = ZERO  # for a turn spring: whose coordinate, and `offset`, make its angle; -1: its joint was cut
    counter: int = ZERO  # that then counts its turns
    x: Program = ZERO  # components of `vector` that vary; x alone for a single value
    y: Program = ZERO  # for a rope: its length without load
    z: Program = ZERO
    p: Vec3 = ZERO  # point of a, from its joint point, its axes
    q: Vec3 = ZERO  # point of b
    vector: Vec3 = ZERO  # force [N], couple [N m]; a single value (torque, actuator, size of friction) stands in x
    stiffness: float = ZERO  # spring [N/m], torsion spring [N m/rad]
    length: float = ZERO  # free length of a spring or rope [m]; free angle of a torsion spring, largest of a bushing
    coefficient: float = ZERO  # damping [N s/m], [N m s]; for friction the factor on its size
    axis: Vec3 = ZERO  # in a
    speed: float = ZERO  # for friction: below which it falls off, tanh(rate/speed) [m/s], [rad/s]
    breakaway: float = ZERO  # for friction that sticks: the factor on its size up to which it does; else 0
    factor: float = ZERO  # on the vector of a force or couple; of a thread's friction its force by its moment [1/m]
    offset: float = ZERO
    mark_a: Vec3 = ZERO  # for a joint that was cut: a direction across the axis, in a
    mark_b: Vec3 = ZERO  # and the one in b that agrees with it at angle 0
    # for friction: GIVEN, or which part of the joint's own load is the normal force; the coefficient then
    # multiplies it
    normal_force_kind: int = ZERO
    joint_body: int = ZERO  # the body whose joint it is; -1: the joint was cut
    row: int = ZERO  # for a joint that was cut: its first closure row; of a thread its own
    row_count: int = ZERO
    reach: float = ZERO  # for ENDS: the distance between the two ends [m]
    frame: Mat3 = ZERO  # for a bushing: its axes, in a
    to_frame: Mat3 = ZERO  # and those in b that agree with them where it is not turned
    own_stiffness: Mat3 = ZERO  # by its own strain, in its axes [N/m], of turning [N m/rad]
    own_damping: Mat3 = ZERO  # by its own rate [N s/m], [N m s]
    is_coupled: int = ZERO  # 1: its shift loads its turn, and the other way round
    coupled_stiffness: Mat3 = ZERO  # by the strain of the bushing's other load [N/rad], [N m/m]
    coupled_damping: Mat3 = ZERO  # by the rate of the other [N s], [N m s/m]
    part: int = ZERO  # for a rope: the first of its parts
    part_count: int = ZERO

    _: Computed
    force: Vec3  # on b
    moment: Vec3
    place: Vec3  # where on b
    place_on_a: Vec3  # where on a
    value: float
    span: float  # length of the line, of a rope; of a turn spring its angle
    strain: Vec3  # for a bushing: its shift or its turn, in its axes
    rate: float
    power: float
    unit: Vec3  # for joint friction: force or moment on b for a normal force of 1; of a thread the moment
    normal_force: float  # normal force [N]; of GIVEN friction its size [N], [N m]
    friction_outcome: float  # what solutions its normal force has: FOUND, JAMS, TWO, UNPROVED
    slip: float  # for friction that may stick: 1 or -1, the sign of its rate while it slips; 0 while it sticks
    reserve: float  # how much more it could take before it slips; 0 while it slips


class Closure(Record):
    """A closure row J V = 0: multiplier 1 puts the force f at the point Q and the couple m on b, the opposite on a.

    GUIDE: e . (Q - P) = length, e fixed in a. DOT: e . g = 0, e fixed in a, g in b. ROD: |Q - P| = length. TURN: a
    pin's angle = length, about e fixed in a. SUM: the sum of its parts, each of which is such a condition between two
    bodies, taken `factor` times; parts have a table of their own, as they have no multiplier.

    MESH: f = e and m = g at Q = p, all three fixed in a third body c; the gap is ratio q + ratio_b q_b - length of the
    coordinates of two freedoms. CAM: the coordinate of freedom_b is the lift over that of `freedom` (kernel/cams.py).
    TOUCHES, ROLLS, ROLLS_ASIDE, BALL_TOUCHES, BALL_ROLLS: of a wheel on a plane (kernel/rolling.py); those that roll
    constrain a speed, and have no gap.

    STRAND, ARC, WOUND: of a rope (sheaves.py). A strand goes from the sheave a, about e at p, to a sheave or point q of
    b; g: the radii there, positive if it goes round counter-clockwise about e, and 1, or -1 if the rope as listed goes
    from b to a. ARC, WOUND: next to the strand `part` of the same row; `radius` is such a signed radius.

    TRACK: across a path of a, along which a counter counts. ALONG: the coordinate of `freedom` along its path = length.
    """

    kind: int
    a: int
    b: int
    freedom: int = ZERO  # for a TURN: whose angle; -1: of a pin that was cut, whose mark on b is g
    program: Program = ZERO  # driven length
    path: int = ZERO  # first of the bodies between its two ends and the ground, tips first, in `indices`
    path_count: int = ZERO
    column: int = ZERO  # its first number in `columns`
    velocities: int = ZERO  # which generalised velocities, in `indices`: first those of its path, then what fills in
    velocity_count: int = ZERO  # how many of its path
    filled_count: int = ZERO  # with those that fill in when earlier rows are taken out of it
    couplings: int = ZERO  # earlier rows that fill in, in `indices`
    coupling_count: int = ZERO
    rank: int = ZERO  # its place among the independent rows; -1: left out
    e: Vec3 = ZERO
    g: Vec3 = ZERO
    p: Vec3 = ZERO  # point of a, from its joint point, its axes
    q: Vec3 = ZERO  # point of b
    length: float = ZERO
    weight: float  # weight of the gap [m per unit]
    part: int = ZERO  # for a SUM: the first of its parts; of what lies on a sheave the strand that comes to it
    part_count: int = ZERO
    factor: float = ZERO  # for a part of a SUM its factor; 1 for a row itself
    c: int = ZERO  # for a MESH or WOUND: the body that carries its place and directions; -1: the ground
    ratio: float = ZERO  # factor on the coordinate of `freedom`
    freedom_b: int = ZERO
    ratio_b: float = ZERO
    lift: int = ZERO  # for a CAM: the first piece of its lift, over the angle of `freedom`; of a TRACK that of its path
    pieces: int = ZERO
    period: float = ZERO
    piece_branch: int = ZERO  # of a lift in segments: 1 + the branch that is the number of its piece
    swings: int = ZERO  # 1: the follower turns about g through `pivot`, both of c; 0: it slides along g
    faced: int = ZERO  # 1: touched on a flat face, across h of b through q; 0: on a roller about q; of a TRACK which N
    radius: float = ZERO  # radius of the roller; 0: a point
    pivot: Vec3 = ZERO
    h: Vec3 = ZERO
    counter: int = ZERO  # for a TRACK: which counter counts its place
    unit_load_size: float = ZERO  # size of its unit load: 1 for a force, the island's length for a couple

    _: Computed
    f: Vec3
    m: Vec3
    Q: Vec3
    t: Vec3  # for a STRAND: its direction across the axis, as the rope is listed
    on_a: Vec3  # for a part: where its load acts on the two bodies, if not at Q
    on_b: Vec3
    gap: float
    rate: float
    gamma: float  # J Vdot + gamma = 0
    multiplier: float
    terms: float  # size of the terms of J Vdot + gamma over a step, while a contact is closed
    demand: float  # what it demands of the response: J V = -demand
    prescribed_rate: float
    prescribed_second: float  # second derivative of a driven length; in an impulse the jump of its rate
    response_size: float  # size of the freedoms' response to its unit load, in the norm of M
    multiplier_error: float  # what rounding may make of its multiplier
    mode: int  # CARRIES; of a contact also APART: it is open; LEANS: kept closed by other contacts, it carries nothing
    pivot_velocity: int  # the generalised velocity that its reflector leaves something of
    selection_order: int  # while rows are selected: its place in the order of pivots; -1: not yet
    support_count: int  # numbers of its reflector
    coupled_count: int  # independent rows that fill it
    reflector: float  # 2 / |v|^2 of its reflector 1 - 2 v v' / |v|^2
    pose_scale: float  # 1 / sqrt(r), r its response, or a part of that to a load across its arms (set_pose_scale)


class Contact(Record):
    """A unilateral closure row: its margin, sense * gap if open, sense * multiplier if closed, is not positive.

    The margin is followed over every step; for an open contact its rate shows whether it leaves. The row of a latch
    holds both ways while it is closed, at a length that is given with its mode: it has no margin. So does that of a
    friction that sticks (sticking.py), whose margins are of their own; while it is open, its sign of slip is given.
    """

    row: int
    sense: int  # 1: an upper limit, a rope; -1: a lower limit; 0: a latch
    mode_index: int  # 1 + its place among those that open and close; 0: a rope that ends the run where it would push
    freedom: int  # which it limits or holds; -1: no single one
    latch_index: int = ZERO  # of a latch 1 + the place of the length at which it holds, among the modes; 0: no latch
    friction: int = ZERO  # 1 + the load whose friction sticks while it is closed; 0: of others
    group_index: int = ZERO  # for a friction 1 + the index of the leader of its group, then of its transmission

    _: Computed
    sticks: int  # 1 while its friction sticks
    leader: int  # 1 + the contact that stands for all frictions that stick with it as one; 0: it sticks alone
    transmission: float  # its rate per unit rate of the leader
    start: float  # the margin at the start of a step, and its rate
    start_rate: float
    least: float  # what the stages of a step saw of it
    most: float
    threshold: float  # of the margin: above it the contact closes, or opens
    # over equidistant points in a part of a step
    highest: float  # largest margin so far
    bent: float  # its largest second difference
    previous: float  # the margin one point back
    before_previous: float  # two points back
    fastest: float  # largest rate of the margin so far
    rate_bent: float  # its largest second difference
    rate_previous: float  # the rate one point back
    rate_before_previous: float  # two points back


class PathPiece(Record):
    """A piece of a path: c0 + c1 h + c2 h^2 + c3 h^3, h measured from the coordinate `begin`; of a lift in segments
    see kernel/paths.py.
    """

    begin: float
    c0: Vec3
    c1: Vec3
    c2: Vec3
    c3: Vec3


class Counter(Record):
    """The angle of a pin that was cut, counted over many turns as a state of its own; or a place on a path."""

    a: int
    b: int
    state_at: int  # where it stands in the state
    axis: Vec3  # in a
    track: int  # for a place: 1 + its TRACK among the closure rows; 0: an angle

    _: Computed
    value: float  # the state's angle, which is right to half a turn; or its place, right to its branch of the path


class Variable(Record):
    """A variable of expressions: a freedom's coordinate, or (is_point) a point's place along a direction; or its rate.

    For a load (OF_LOAD) the length of its line, or the rate of that, or the rate of a rope's unloaded length; or a
    component of its strain.
    """

    freedom: int = ZERO
    is_rate: int = ZERO
    is_point: int = ZERO  # 0, AT_POINT, OF_LOAD
    load: int = ZERO
    part: int = ZERO  # part of the load: along its axis 0, 1 or 2; ALONG_LINE, DRAWN
    body: int = ZERO  # body of the point; -1: the ground
    q: Vec3 = ZERO  # the point, from the body's joint point, its axes
    direction: Vec3 = ZERO  # unit vector, world axes
    offset: float = ZERO  # offset of its place along the direction


class Watch(Record):
    """A program that is watched over the steps: a load's, a drive's, or a condition that does not affect the motion."""

    program: Program
    curved: int  # 1: the acceleration of a drive counts
    condition: int  # 1: its branches alone count
    load: int  # for a bushing: the load of whose force or moment it is a part; -1: it is of none

    _: Computed
    low: float  # what the stages of a step saw of it
    high: float
    scale: float  # how large it may be in the step
    rounding: float  # rounding of its terms


class ArtificialInertia(Record):
    """Inertia added to a body about an axis, so that the tree can be factored, and compensated afterwards
    (kernel/response.py).
    """

    body: int
    root: float  # square root of the inertia
    axis: Vec3  # unit vector, body axes

    _: Computed
    n: Vec3  # root times the axis, world
    z: float  # n . alpha: the artificial inertia takes the load z n on the body


class Group(Record):
    """Components of the state whose errors are measured together, those of one body: coordinates, then rates."""

    coordinates: int
    rates: int
    end: int

    _: Computed
    rate: float  # the largest it has had
    trial: float  # step being tried


class Island(Record):
    """Closure rows of loops that share bodies, and their freedoms, which `indices` lists."""

    rows: int
    row_count: int
    freedoms: int
    freedom_count: int


class Limits(Record):
    """Thresholds of the kernel: heuncli/base/tolerances.py derives each."""

    singular_retries: int  # lengths tried for a step whose stages come near to a singular pose
    no_inertia: float  # relative to the inertia in all directions: below it, nothing is moved
    own_share: float  # relative to a motion's inertia with the artificial part: below it, nothing resists
    much_artificial: float  # with a smaller share than this, but more than that, less artificial inertia is used
    row_across: float  # part of a row's possible response across its arms that counts as its scale in any pose
    independent: float  # least length of what is left of a row, by the rows chosen before it, for it to be chosen
    passing: float  # the same on the way through a singular pose
    passing_of_start: float  # and no more than this of what the rows of the start have left
    rounding: float  # rounding of a sum, relative to its terms
    preference: float  # a later row must have so many times the pivot of an earlier one
    pivot_drop: float  # relative to the pivot when the rows were chosen: below it they are chosen again
    near_singular: float  # pivot below which the stages of a step are settled, too
    locked: float  # pivot, with a step of `locked_step` of the time, at which the closures lock
    locked_step: float
    closed: float  # gaps of the scene's size: rounding, nothing to mend
    nearly_closed: float  # rounding after a correction
    reopened: float  # a row that was left out opens
    closures_lost: float  # the closures cannot be held
    jump: float  # relative to the largest rate: a larger change of rates by the closures is not rounding
    jump_of_error: float  # the same of the local tolerance, by the root of the pivot
    jump_of_given: float  # and the same at most of what a given step turns the scene by
    slow_rate: float  # relative to the model's largest rate: slower bodies are judged as if this fast
    held_rate: float  # relative to the rate that loads could cause: bodies held at rest are judged as if this fast
    balanced_rate: float  # relative to the rate that drives and loads impose: what is slower may rest between them
    imposed_rounding: float  # and the rounding of its rates
    least_step: float  # relative to the time: rounding
    given_end: float  # relative to a given step: a shorter remainder of a piece is merged into its last step
    retry_ratio: float  # ratio of the lengths tried
    pivot_rounding: float  # what rounding makes of the closures, times h rate / pivot
    one_instant: float  # relative to the time: rounding of an instant
    finest: float  # part of a step down to which events are told apart
    window: float  # relative to a step, on both sides of its end: events found by the preceding step are there
    seen_turn: float  # rotation of a point's body in a step [rad]: with more, the stages do not show its path
    near_kink: float  # relative to a step: a step may end this close to a kink, because branches continue smoothly
    no_jump: float  # relative to a load's scale: branches this close meet in a kink
    leaving_first: float  # relative to a step: distance from its start where rounding may pick a wrong branch: at least
    leaving_last: float  # ... and at most
    flurry: float  # relative to the time: events following each other within it accumulate at an instant
    least_load: float  # smaller loads are none, in any unit
    touching: float  # relative to the size, and to its places and limits: accuracy of a contact's gap
    friction_rounding: float  # relative to a friction and to what it can hold: rounding of their difference
    still_rate: float  # relative to the terms of a row's rate: rounding
    unseen: float  # relative to a load's largest value: change unseen by the stages before a step is repeated
    pivot_noise: float  # what a step at the least of the lengths tried may be off by, likewise
    branch_step: float  # relative to the least pivot: motion of the coordinates in a step along a branch
    branch_next_start: float  # factor on branch_step for a run begun next to the start
    branch_between: float  # [rad, of an island's length]: the course of what a drive moves, between a step's ends
    branch_bend: float  # relative to a drive's acceleration in a step: allowed error of its midpoint
    half_turn: float  # cosine of half a turn: where it is less, Rodrigues' numbers have come to a half turn
    chart_turn: float  # relative to the rotation that leaves a chart of attitudes: longer steps are refused
    newton_ends: float  # relative to the largest coordinate or rate: smaller corrections are rounding
    newton_rounding: float  # corrections that do not become smaller may be as large by rounding ...
    newton_part: float  # ... or so large of the tolerance ...
    newton_noise: float  # ... or, of a method of fixed step, so large
    newton_stalls: float  # times the best contraction so far: corrections of that size do not contract, but tremble
    friction_left: float  # 1 minus the loop gain of friction by normal forces: with less the solution is rejected
    newton_diverges: float  # a ratio of two corrections, the first ones, beyond which the iteration will not turn round


class BodyAtState(Record):
    """A body's values at a state, stored while directions from there are evaluated (tangent.py)."""

    inertia: Sym3  # about the joint point, world axes
    alpha: Vec3
    a: Vec3
    M: Vec3  # load of the joint on the body
    f: Vec3


class BodyTangent(Record):
    """The change of a body's motion and loads along a direction of the state, per unit of it; world axes."""

    moves: int  # 0: nothing of its motion changes
    turn: Vec3  # its attitude, as a small turn: dR = turn x R
    arm: Vec3
    r: Vec3
    spin: Vec3  # while its turns are taken one after the other: the angular velocity before the next one, itself
    omega: Vec3
    v: Vec3
    alpha: Vec3  # at the accelerations of the freedoms that stand at the state
    a: Vec3
    M: Vec3  # what it asks of its joint: inertia less applied loads; with what its branches' arms change by
    f: Vec3


class FreedomTangent(Record):
    """The change of a freedom along a direction of the state."""

    q: float
    u: float
    udot: float  # its acceleration at the state, itself
    load: float  # ds . F: what the joint's load does along it, as its direction turns
    s: Vec3


class Scene(Struct):
    """A scene and the kernel's work on it."""

    body_count: int
    freedom_count: int
    load_count: int
    closure_count: int
    part_count: int
    counter_count: int
    variable_count: int
    point_count: int  # variables that are of points or loads
    artificial_count: int
    island_count: int
    watch_count: int
    contact_count: int  # one-sided rows
    held_count: int  # branches of expressions that are held over a step
    angle_count: int  # number of these that belong to atan2
    velocity_count: int  # freedoms, a ball's three turns among them
    selected_count: int  # independent closure rows
    friction_count: int  # loads of joint friction that depend on the joint's own load
    friction_outcome: int  # the last outcome that was not FOUND: JAMS, TWO, UNPROVED
    friction_outcome_load: int  # and which load it is that says so
    friction_outcome_time: float  # when
    has_drives: int  # something is driven: the work of drives counts
    flat: int  # bodies turn about z and shift across it: plane.py moves them
    work_at: int  # position of the work in the state; -1: it is not computed
    gravity: Vec3
    size: float
    limits: Limits
    rank_of_gap: float  # what of a row the gap of a pose may feign [1/m]
    least_row: float  # what has to be left of a row for it to be chosen
    pivot_chosen: float  # least pivot of the closures when their rows were chosen
    pivot: float  # now
    pivot_of_step: float  # least since the step began
    gap: float  # largest gap of the last recovered state, over all rows [m]
    artificial_part: float  # root of the part of the artificial inertias that is used
    own_share: float  # least pivot of 1 - T: share of a motion's inertia that is its own, not artificial
    pivot_recovered: float  # least of the independent rows there, as they were selected: geometry alone, squared
    load_size: float  # |D^(-1/2) e|: size of the response without closures, in the norm of M
    residual: float  # largest J Vdot + gamma of all rows there, of the terms it is the sum of
    bodies: list[Body]
    freedoms: list[Freedom]
    loads: list[Load]
    closures: list[Closure]
    parts: list[Closure]  # parts of the rows that are sums, then of the ropes among the loads
    counters: list[Counter]
    variables: list[Variable]
    pieces: list[PathPiece]
    spare_bodies: list[Body]  # spare bodies, on which points are evaluated without changing the scene's
    spare_freedoms: list[Freedom]
    artificial_inertias: list[ArtificialInertia]
    islands: list[Island]
    watches: list[Watch]
    contacts: list[Contact]
    is_angle: list[int]  # which branches are those of atan2
    least: list[float]  # range of each variable as seen by the stages of a step
    most: list[float]
    programs: Pointer[Programs]
    indices: list[int]  # paths, generalised velocities and couplings of the closure rows
    selected: list[int]  # independent rows, ascending
    envelope: list[int]  # first coupled row of each of them
    support: list[int]  # which generalised velocities the reflectors have, in the order of `columns`
    coupled: list[int]  # for the independent rows: earlier rows coupled to them, at the place of their couplings
    is_pivot: list[int]  # which generalised velocities are pivots of reflectors already
    velocity_scale: list[float]  # in an island: 1 translation, 1 / length rotation; 0: in none, or driven
    e: list[float]  # load on each freedom
    inertia_root: list[float]  # D^(-1/2) of each generalised velocity
    velocity_vector: list[float]  # one vector over all of them
    columns: list[float]  # e_r of all rows, one after the other; then the reflectors that make R of them
    R: list[float]  # R' over the independent rows, the diagonal inverted
    J: list[float]  # one island's rows of J on its freedoms, scaled
    remainders: list[float]  # for each of these rows the squared remainder after the rows chosen before
    pivot_row_velocities: list[int]  # the freedoms that the pivot row has something of
    rows_left: list[int]  # its rows that may yet be chosen, ascending
    row_bits: list[int]  # for each row of J the parts of the island's degrees of freedom with entries, one bit per part
    row_vector: list[float]  # a number an independent row
    own_inertia: list[float]  # 1 - T of the artificial inertias, and its Cholesky factor
    state_values: list[BodyAtState]  # what stands at the state whose directions are looked at
    tangents: list[BodyTangent]  # tangents of the bodies, along one direction
    freedom_tangents: list[FreedomTangent]
    multipliers: list[float]  # at the state
    slopes: list[float]  # slopes of the variables of the expressions, along the direction
    has_slopes: int  # some of them are not 0
    friction_loads: list[int]  # the loads of joint friction that depend on the joint's own load
    # for each cause and each of them: the two vectors whose lengths are normal forces (kernel/joint_friction.py)
    contact_forces: list[float]
    stored_loads: list[float]  # moment and force applied to each body, stored while others are solved for
    friction_bound: list[float]  # how much one normal force grows at most by a unit of another; then its elimination
    friction_slope: list[float]  # 1 - the slope of that at the solution
    friction_trial: list[float]  # rows of a number each (joint_friction.py)
    direction: list[float]  # a direction of the state
