"""Every threshold at which a decision can change, by concept, each with the reason for its size.

EPS is the rounding of one operation, 2.2e-16. A sum of some dozen terms of alternating sign keeps 13 to 14 digits of
the largest of them: anything below is rounding. A singular value, or an angle computed from a pose, keeps about nine
digits, for poses are closed to 1e-10 of the scene's size (OPEN_GAP). Numbers typed by hand have a few digits only.
Sizes are relative (to the scene's size, to the largest load, to the run's length) unless a unit is given. Plain
numbers, and no imports: reading a spec needs some of them.
"""

from __future__ import annotations

EPS = 2.0**-52

# -- rank: which conditions of the joints hold what others hold already
RANK = 1e-9  # of a row scaled to 1, what is left of it by the others: nine digits, what a closed pose gives
NEARLY_DEPENDENT = 1e-12  # the same: what is less is rounding of coordinates; between this and RANK dependence is told
NO_SINGULAR_VALUE = EPS  # of the largest, times the longer side of a matrix known to all its digits: below is rounding
RANK_OF_GAP = 100.0  # times the gap: a pose is known to its gap only, and singular values amplify it by some tens
NEIGHBOUR = 1e-3  # [rad] or of the size: an accident of the start is left by 1e-3, far above RANK, the machine hardly
MOVES = 1e-6  # of rates drawn between -1 and 1: less, after projection on the closures, is rounding
SUSPECT_PIVOT = 0.05  # a step of an ordinary loop stays above; below, a singular pose is looked for within it
SINGULAR_MET = 4.0  # times the width left of the search over its first: the value falls to zero at most so steeply
NEAR_PIVOT = 1e-2  # relative singular value 0.1, a tenth of it in another measure: rounding over its 4th power, 2e-8
UNSEEN_GAP = 16.0 * EPS  # of the size: what the sums of a closure may not see, and more than settling leaves
UNKNOWN_NEAR_SINGULAR = 1e-6  # of the largest of its kind: six digits, as in a table; beyond it a value is unknown
UNMET = 10.0  # times what has to be left of a row: rows left out are met to less, and all others to rounding
SINGULAR_FALL = 0.5  # of the largest value in the search: on the way through a singular pose it falls to nothing
PUSHED = 1e-8  # of the loads: what of them acts along a motion of a pose known to RANK, a digit above
NEARLY_SINGULAR = 1e-6  # relative singular value: reactions err by gap / value, 1e-10 / 1e-6, and keep four digits

# -- couplings: what of a drawing decides whether gears fit
TYPED_AXES = 1e-9  # sine between axes that are parallel, or at right angles, by what is typed or computed of it
DRIVES_DISAGREE = 1e-9  # of the largest rate: what several drives of a coupling may leave of it, far above rounding
NO_PATH_DIRECTION = 1e-6  # of the greatest slope of a path: where it is less the path has no direction to six digits
SAME_PLACE = 1e-9  # of a path's reach: branches nearer than that are at one place, by what is typed or assembled of it
TYPED_POINT = 1e-6  # of the distance it is measured by: points of a drawing are typed with six digits and more

# -- open: which components no law of rigid bodies decides, and the sums that are certain
NO_SELF_STRESS = 1e-13  # of unit multipliers: a null vector that puts less into every joint is rounding
OPEN_SHARE = 1e-8  # of a self-stress's largest share: a null vector is known to RANK, ten times better
HELD_BY_OTHERS = 1e-12  # sine squared between a direction that gives way and what self-stresses reach: 1e-6, as shares
# of 1e-8 err where they are summed from levers a hundred times as long
STRAINED = 1e-9  # of the largest strain: RANK again, a self-stress that strains less is not decided by the stiffness
STILL_OPEN = 1e-9  # of unit share: what is left of self-stresses after a split, if below, is rounding of their parts
DEPENDENT_SHARES = 1e-7  # of a component's largest share: known to OPEN_SHARE, with a digit for the elimination
ABSENT_FACTOR = 1e-9  # of the largest, or of unit length: a factor below it stands for a component that is not there
WHOLE_FACTOR = 1e-9  # a factor so near to a whole number is that number; shares are not known better
# [rad] or of the size: poses in which a certain sum must hold too; large, for what turns must show, and several, for
# what has one freedom gives two poses each, and among more components than poses some sums hold by accident
SUM_POSES = (0.05, 0.1, 0.2, 0.4)
ONE_DIRECTION = 1e-6  # of the largest: over poses NEIGHBOUR apart an open force in one direction turns by NEIGHBOUR**2
ZERO_COMPONENT = 1e-12  # of a unit direction that is proposed, or quaternion: smaller ones are rounding, not printed

# -- in the plane
# sine of a direction, and of the size or a vector's length: some dozen roundings, which turning a plane in space leaves
# and every step makes anew; nothing that is typed is so small
FLAT = 64.0 * EPS
NEARLY_FLAT = 1e-3  # the same: a drawing off by less was meant to be flat, which is told

# -- small oscillations
# times what scenes and poses moved by START_ROUNDING differ by, in an entry of the stiffness or in a push: the entry
# itself errs by roundings of its terms, which are some tenths of those, so what is left where terms cancel is a
# stiffness from some 64 EPS of them on
HELD = 8.0
EIGENVALUE = 64.0 * EPS  # of the norm, times the number of motions: what some dozen roundings make of each entry
FREELY_PUSHED = 1e-9  # of the loads along a motion that nothing holds: a sum of poses that are closed to OPEN_GAP
OFF_BALANCE = 1e-9  # [rad] or of the size: so far a start may be from the pose that rests; frequencies keep nine digits
KINK = 1e-9  # of a coordinate, or 1: so near to where a law jumps or bends a pose is on it, closed as it is to OPEN_GAP
STEEP = 0.5  # of the largest slope within KINK: a root there doubles it at each step, what is smooth keeps it to KINK
STEADY_CHANGE = (
    1e-8  # of the stiffness and loads: what of them may change as a steady motion goes on; rounding of long ways
)

# -- orders
CANCELS = 1e-9  # of the sum of the bodies' own amplitudes: drawings typed with ten digits balance that well
SAME_PERIOD = 1e-2  # of the largest force or moment: two periods that differ more have no order to two digits
SAME_WEIGHT = 1e-10  # of the largest singular value: places of weights that differ by less in effect serve alike
ORDERS_SETTLED = (
    1e-12  # of the largest order: what the highest may be for all below them to be told; some FFT's roundings
)

# -- coordinates of Lagrange's equations
COORDINATE_RATIO = (
    1e8  # largest over least rate of coordinates for a unit of motion: eight digits of the partials are left
)
NO_OFFSET = 1e-9  # rad/s^2, or of the size: what a pose that rests leaves of accelerations is rounding
HALF_TURN = 1e-9  # of the scalar part of a quaternion, known to 1e-15: six digits of its Rodrigues vector are left

# -- bushings: where they come to half a turn
# [rad] short of it: there the moment jumps to the other side, and which side it is on is known to the error of a run,
# which is a thousandth of this where nobody asks for more
TURNED_OVER = 1e-6
NEARLY_TURNED_OVER = 1e-3  # the same, where a run could not go on: so near to that it did not for that

# -- no inertia
NO_INERTIA = 1e-12  # of the body's largest moment: a tensor turned into other axes keeps 14 digits, some are typed
NO_MASS = 1e-12  # of the heaviest body: no digit of a sum of weights that anyone reads
POINT_MASS = 1e-9  # of m L^2: a body whose radius of gyration is 3e-5 of the scene's size is no point mass yet
ON_AXIS = 1e-9  # of the size: points typed with ten digits; what is nearer to the thin axis acts on it
ALONG = 1.0 - 1e-9  # cosine of an axis with that of the missing inertia: 4.5e-5 rad, for the spin it frees is idle
ALONG_SQUARED = 1.0 - 1e-9  # square of the same cosine, as found from the points on the axis: 3e-5 rad
AXISYMMETRIC = 16.0 * EPS  # of the largest moment about the origin, of the size: sums of some dozen terms, and turned
# axes; a body that is less round by more is turned by its own motion
SPINS_LIGHTLY = 1e-3  # of the moment across: rounding of the moments about the axis accelerates 1e3 times as much
ARTIFICIAL_RADIUS = 1e-3  # of the size: the least radius of gyration of an inertia lent to an idle spin (it cancels)
SLENDER = 1e-6  # determinant over the cube of the trace: above, no moment is NO_INERTIA of it; a rod 200 diameters long
NO_MOMENT = 1e-9  # of the loads at a body: a smaller moment about its thin axis is what ON_AXIS lets pass

# -- gaps of poses and rates that are assembled
OPEN_GAP = 1e-10  # of the size, or rad: a quadratic iteration goes below at once, a joint that cannot close stays above
GAP_ROUNDING = 64.0 * EPS  # of the largest coordinate: some dozen roundings far from the origin
OPEN_RATE = 1e-10  # of the scene's speed, with that of its drives over its size: as OPEN_GAP
AT_REST = 1e-6  # [rad/s] the least speed a scene is taken to have: rounding about rest opens no joint
SOLVABLE = 1e-8  # of the acceleration asked for: what may stay unsolved, a digit above RANK
NO_ACCELERATION = 1e-12  # of speed^2/size: accelerations below are asked for by rounding of the rates alone
STILL = 1e-28  # [m/s^2, rad/s^2] squares of rates of 1e-14, which rounding leaves where a blow ends rates of 1
SAME_VALUE = 1e-9  # rad, m, or relative beyond 1: a held value and a drive that agree so far say the same; typed digits
NO_LENGTH = 1e-9  # of the size: a shorter rod's direction has one digit beyond OPEN_GAP
NEAR_DRAWING = 0.5  # a joint's gap (by L) or angle, a body's shift or turn: a drawing off by less means this very pose
FARTHER = 1.2  # times the nearest pose's way: least turns may lead so far; then no body goes twice as far as known ones
DRIVE_FOLLOWED = (
    1e-12  # of the size, or of what accelerations must meet: beyond some hundred roundings a drive is not followed
)
CLOSED = 1e-15  # of the size: as closed as rounding allows
NO_SLOPE = 1e-7  # of |C| |e|: square root of some dozen roundings, below which a sum of squares has no slope
POLISHED = 1e-12  # turns [rad] and shifts (by the size): nothing is left to polish
SUM_OF_SQUARES_LIMIT = (
    1e-5  # the same: squares of steps below 1e-5 are 1e-10 and drown in what closing leaves in the sums
)
SAME_SUM = 1e-13  # of a sum of squares: hundreds of roundings
DRAWN_IN_PLACE = 0.1  # a joint's gap (by L) or angle: a slip of the drawing is less, bodies drawn apart miss by a link
MOVED = 1e-3  # of the scene's size: a body that had to leave its place by more is mentioned above the tables; places
# typed with three digits, a millimetre in a metre, close that well
UNMOVED = 1e-12  # of the size, or rad: a smaller change of the start is rounding, and no choice to mention
PRINTED_COMPONENT = 1e-9  # of the size: components that a chosen value is printed without

# -- contacts
CONTACT_TOUCHES = 1e-12  # of the size, and of places and limits: START_ROUNDING after some hundred steps, so that what
# touches at an instant touches in a run from a moved start, too
CONTACT_RATE = 1e-12  # of the terms of a rate of opening: thousands of roundings, which settling and a blow leave
CONTACT_ACCELERATION = 1e-11  # the same of accelerations, which loads and factors leave a digit more of
CONTACT_TOGETHER = 1e-8  # of a gap: contacts of a sequence that close within it close together; ten times the default
# tolerance of a motion, so that a start moved by its error finds the same ones
CONTACT_BASIS = 1e-3  # of a contact's own answer: what those before it must leave of it, to be solved for by its rate
CONTACT_DEPENDS = 1e-12  # of a contact's own answer: what others leave of it if less; squares, so 1e-6 of a lever
NO_ANSWER = 1e-13  # of what free bodies would answer: what all other joints hold already, to hundreds of roundings
SHORTEST_FLIGHT = 1e-12  # of the run's length: a hundred times what its instants are told apart by (least_step)

# -- ropes over sheaves
FLEET_ANGLE = 0.07  # rad, 4 deg: how far a rope may leave a sheave's plane (DIN 15020-1); its forces are then right to
# 1 - cos of it, 0.25 %
FLEET_SEEN = 1e-4  # rad: below, what that makes is 5e-9 of a force, as little as the loads of a run are known to
ASKEW = 1e-7  # rad: axes of two sheaves that a strand runs between, which only rounding may part
OFF_SHEAVE = 1e-9  # rad: an arc that is less than none by more has left its sheave

# -- same instant, same place, same direction
SAME_INSTANT = 1e-9  # of the run's length: instants typed with ten digits
SIDE_BY_SIDE = 1e-12  # of the run's length: thousands of roundings of an instant; what jumps between has two sides
ONE_PLACE = 1e-12  # of the largest coordinate: a scene of less extent is one place, whose size is taken as 1 m
SAME_CUT = 1e-9  # of a run of cuts' length: places typed with ten digits
IN_PLANE = 1e-12  # of the body's size, or of coordinates along the normal: nearer to a cutting plane counts as in it
LEAST_EXTENT = 1e-9  # [m] what IN_PLANE is measured by where all lies in the origin
TOUCHING = 1e3  # times IN_PLANE: outlines of a cut that come so near are one
OUTLINES_APART = 1e-3  # of their radii: polygons of 96 sides are 5e-4 of a radius off the curves they stand for
OFF_AXIS = 2e-15  # sine of a normal to a body of revolution's axis: rounding of a unit vector, 9 EPS
EQUAL_COMPONENTS = (
    1e-9  # of a unit normal: equal ones, of which x goes before y before z (manual/format.md, "Sections")
)
MESH_DIGITS = 2.0**-21  # of the largest coordinate: eight steps of a float32, which is what files of meshes hold
PARALLEL = 1e-9  # sine between directions typed with ten digits: below, they are one line
OUTLINE_PRINCIPAL = 1e-4  # the same of a mesh: its corners have the digits of a float32, its arcs are chords
# of the area times the cube of its extent: third moments of an outline that is the same turned by 180 degrees; as
# chords of arcs leave, while a channel has some 1e-2
OUTLINE_SYMMETRIC = 1e-3
PRINCIPAL = 1e-9  # I12 of sqrt(I1 I2): typed lengths; the neutral axis turns by less than that over 1 - I1/I2
UPRIGHT = 1e-9  # 1 - cosine of a body's z axis to the world's: 4.5e-5 rad, as typed quaternions leave

# -- loads that are none
STARTS_MOVING = 1e-10  # of the largest load on a body over its mass: ten times NO_LOAD, which a sweep leaves
NO_FORCE = 1e-12  # of the largest load it is summed from: hundreds of roundings; it has no line of action
NO_LOAD = 1e-11  # of the largest m (a - g): what a sweep leaves at six freedoms that nothing holds
NO_ENERGY = 1e-20  # of the weight's work over the size: squares of speeds of 1e-10, as OPEN_RATE lets pass
UNBALANCED = 1e-6  # of a body's largest load: rounding stays far below, near a singular pose, too
CONSTANT = 1e-13  # of its size: a quantity that varies less varies by hundreds of roundings, and has no peak

# -- accuracy
# of the way to where a motion fails: how long before it a run may end, that finds what is passed sooner; near a lock
# rates grow as the inverse root of what is left
BEFORE_FAILURE = (1e-9, 1e-6, 1e-3, 1e-2, 0.1)
CLAIMED = 1e-3  # of the whole: the error at the horizon, beyond which nothing is claimed
JUDGED = 1e-8  # of the whole: up to where a chart is judged if its references part; half the digits are left to compare
LOST = 1.0  # of the whole: a motion off by as much tells nothing of where anything is; charts show no more of its error
# a tolerance that is asked for: the rounding of a state's numbers, 8 EPS, shows as its five-fold in the difference of
# two runs; where what is told may err by more than a tenth of the scene, nothing is where it is told
LEAST_ASKED = 1e-14
MOST_ASKED = 0.1
LEAST_TOLERANCE = 3e-14  # local tolerance: a thirtieth of it, of the check run, is 5 EPS; below, steps chase rounding
COARSEST_RETRY = 1e-6  # local tolerance beyond which a run that collapsed is not tried again: three digits are left
PLACE_ROUNDING = 2.0 * EPS  # of the size, or of the farthest coordinate: rounding of a place; no estimate is below
START_ROUNDING = 8.0 * EPS  # of a state's numbers: typed digits, assembling, and what some hundred steps add on the way
ROUNDING_MATTERS = 5e-10  # local tolerance: errors are some 1e-3 of it, and then no more than 300 START_ROUNDING
SUM_ROUNDING = 16.0 * EPS  # of the largest term: sums of some dozen terms, and what their own roundings add up to
UNKNOWN = 1e6  # an error relative to what it is an error of, where that is without bound or not a number
FRICTION_LACKS = 1e-6  # of its value: smoothed friction that lacks less is full to the six digits of a table
WRITTEN = 1e-12  # of the largest: digits of what was solved exactly, all that some thousand roundings leave
LEAST_RATE = 1e-5  # of a radian, or of the size, in the time asked for: slower ones are judged as if that fast
BOUNDLESS = 1e3  # a value that grows so many times over within 2**-20 of the run is on its way to infinity; where steps
# become too many, one that has grown so in the last three quarters of the time is what they follow
MOST_STEPS = 20_000_000  # of a run: minutes of the smallest scene, and what is put down of them half a gigabyte
MOST_SOLVED = 1_000  # numbers of a state whose dense equations are solved: a second a step, 50 million bytes
MOST_FOREIGN = 200_000  # steps of SciPy's, which take a hundred times as long
CHECK_STEPS = 4  # steps of the check run for one given step: order 1 errs there by a quarter, and 2 |A - B| by 1.5 of A
SHARED_STEP = 1 / 3  # of a run's longest step: shorter ones err by 3**-5 of it and less, at any order from 5 on
SAME_STEP = 1e-6  # of a step: events of a run from a moved start come so much earlier or later, and no more
HOPELESS = 1.0  # times the most steps, over the root of their part done: what may be left of the steps projected
INTEGRATED = 2.0 * EPS  # of a rate's size times the time: the rounding of one rule's sum, between whole and halves
UNSEEN_RATE = 1e-9  # of a rate's size: what it may do in the mean between the nodes of its integral, no more than a
# default tolerance; the integral itself errs by rounding
QUADRATURE = 1e-14  # of the scale: whole against halves; planes that graze thin walls then err by as much

# -- choice of the method
STIFF = 0.5  # of the boundary of stability: where that holds steps short they are at it, else seldom beyond a third
EVENTFUL = 1 / 4  # of the steps: a step that an event ends costs three, so that half the stages are spent on events
EVENTS_RARE = 1 / 8  # of the steps of a method of few stages: it takes several between events where order 8 takes one
VERNER98 = 1e-11  # tolerance: from there on order 9 misses it in 2 of 23 scenes, order 8 in 7, for as many evaluations
RADAU5 = 3e-6  # local tolerance above which three stages take less than five, with a check run at a thirtieth of it

# -- what a motion comes near to
GIMBAL = 1e-3  # rad from a lock of Euler angles: the condition of their matrix is 2e3, three digits are lost
FASTER_THAN_TIME = 4.0  # over the second half of a run: what grows with the square of the time grows fourfold

# -- pictures
THROUGHOUT = 1e-9  # of its size: a value that varies by less is shown once; typed with ten digits it would be constant
IN_ONE_PLANE = 1e-9  # of the largest vector of a run: components across a plane that turned axes and steps leave
TOLD_ACROSS = 1e-6  # of the largest vector in the plane: what else stands across it is told: six digits, a table's
SAME_TURN_DRAWN = 2e-3  # of the largest vector: a pixel of a picture; turns that differ by less are drawn as one
MAX_INTERPOLATED_TURN = (
    1.57  # rad, a quarter turn: farther apart two instants do not show how a body turns from one to the other
)
NOTHING_ACTS = 100.0 * EPS  # of what forces are summed from: rounding of the sum, which has no direction to be drawn

# -- rest
REST_FIRST = 0.01  # rad, or of the size: the first step, short against any lever
REST_DOUBT = 0.05  # rad, or of the size: what is off by as much, grown, may be on the other side of a ridge
REST_SAME = 1e-6  # rad, or of the size: Newton's steps bring two searches that near, other poses are farther apart
REST_WAY = 1e-4  # the same along indifferent directions: if two searches agree so far, no finer one is made
REST_SEARCHES_DIFFER = 0.1  # the same: farther apart two searches have not gone one way
REST_FARTHEST = 0.5  # the same: a longer step may pass over what bends within half a turn
REST_BENT = 0.05  # of a step: what the linear law may leave out; a fifth of it is then missed at third order
REST_MISSED = 0.01  # of that: what closing may lead aside
REST_FINER = 0.1  # the same of a search against the one before it, which it checks
REST_STRAIGHT = 1e-6  # the same of a step beyond REST_FARTHEST: nothing bends there
RUN_AWAY = 1e6  # times the scene's size: what shifts as far is held by nothing
TURNS_ON = 63.0  # rad: ten turns have seen every pose of a turn, several times
PUSHED_BY_ROUNDING = 50.0  # times what START_ROUNDING of a pose makes of its accelerations: some hundred steps' worth,
# so that a scene drawn alike on both sides comes to rest so, stable or not
STEADY = 1e-9  # of the terms of an acceleration, of the fastest drive: axes typed with ten digits turn on themselves
INDIFFERENT = 1024.0 * EPS  # of the terms of an eigenvalue: exact slopes, of a pose known to its rounding
NEARLY_DEFECTIVE = 1e-6  # of unit eigenvectors, across each other: apart by more they keep ten digits, as a block all
NOT_HELD = 1e-6  # of the terms of an acceleration: a rest leaves rounding of them, loads that jump leave their part

# -- the range of what is computed with, SI: the largest products are of four quantities (m L^2 of an inertia is one of
# three, and the square of a moment F L one of four), 1e240; their sums over 10,000 bodies stay below the end of double
# precision, 1.8e308, and what is divided by them above its other end, 2.2e-308
LEAST_MAGNITUDE = 1e-60
MOST_MAGNITUDE = 1e60

# -- what is typed in a spec
UNIT_TYPED = 1e-2  # a unit quaternion or rotation matrix may be this far off: two digits at least
UNIT_EXACT = 1e-14  # some dozen roundings: nearer to a rotation, a matrix is taken as it stands
INERTIA_REFUSED = 1e-3  # of the largest moment: bound on a broken triangle rule
INERTIA_TYPED = 1e-9  # of the largest moment: moments typed with ten digits keep the rule, and symmetry, this well
AT_LIMIT = 1e-9  # of the size, or rad: a start beyond a limit by less stands at it, by the ten digits that are typed
LEAST_STRENGTH = 1e6  # [Pa] below what bars are made of (foams aside): a strength in MPa was written without its unit
TABLE_ENDS = 1e-6  # of the span: a table's period and the values at its ends are printed with seven digits
EXPECTED_RELATIVE = 1e-6  # of the largest number expected: default of `rel` (manual/format.md, "Expect")
EXPECTED_ABSOLUTE = 1e-9  # default of `abs`

# The kernel's thresholds (kernel/scene.py, Limits).
KERNEL: dict[str, float] = {
    # -- inertia
    "no_inertia": 1e-14,  # of the trace: some dozen roundings of the sums that make an articulated inertia
    # square of NEARLY_SINGULAR: where the loops hold a freedom without inertia by a lever of s, s^2 of the others' is
    # what it moves, and accelerations are known to rounding / s^2
    "own_share": 1e-12,
    "much_lent": 1e-3,  # three digits lost
    # -- friction
    # of 1, by what friction adds to what presses: the sum over what is left keeps eight digits of sixteen
    "friction_left": 1e-8,
    # -- rank
    "across": 0.01,  # a row's answer across its arms counts to a tenth of the arm, in any pose
    "independent": RANK,  # what the verdicts judge by, too
    "passing": 3e-6,  # square root of `reopened`: through a singular pose a row with s left of it opens by s**2
    "passing_of_start": 1e-3,  # of what the start's rows have left: no machine is kept from its own start's rank
    "rounding": 8.0 * EPS,  # of some ten terms: a row's demand, a freedom's load
    "preference": 1.01,  # 1 %: rows alike but for rounding are taken in their order, which keeps the choice steady
    "pivot_drop": 1e-3,  # of a pivot: 5 digits of the multipliers lost, time to look for better rows
    "near_singular": 0.2,  # a pivot below which the stages of a step are settled, too: their gaps grow by 1 / pivot
    "locked": 1e-4,
    "locked_step": 1e-9,  # of the time: a step 1e9 times shorter than the run, at a small pivot, is a lock
    # -- gaps, of the scene's size
    "closed": 1e-15,
    "nearly_closed": 1e-14,
    "reopened": 1e-11,
    "lost": 1e-8,
    # -- rates that the closures change at the end of a step, of the largest
    "jump": 1e-2,  # coarse runs err by 1e-3, a blow changes rates by their own size
    "jump_of_error": 100.0,  # an accepted step errs by the tolerance, the rows' rates by some of it, over their pivot
    # of a rate of the scene's size: a step of half a radian turns it by that much; beyond, a blow changes rates so
    "jump_of_given": 0.5,
    # -- steps
    "slow_rate": 0.01,  # of the largest: by its own rate alone what hardly moves would be followed for nothing
    "held_rate": 0.1,  # of sqrt(acceleration / size): a tenth of the time of fall, in which what is let go is in motion
    "given_end": 1e-6,  # of a given step: 10 million steps know their ends to 1e-8 of one, typed durations to 1e-9
    "least_step": 1e-14,  # of the time: fewer than 50 roundings of t; what lies nearer together is one instant
    "dodge": 0.87,
    "dodges": 10,  # lengths tried; .87**10 spans a factor of 4, more than the width of what a singular pose spoils
    "pivot_rounding": 1e-16,  # a rounding of the closures, amplified by 1 / pivot
    "pivot_noise": 3e-13,  # what ten lengths could not avoid: the gap that settling leaves, amplified likewise
    # -- events
    "one_instant": 4.0 * EPS,  # what an event is off by adds up over many: no more than instants are rounded
    "finest": 1e-10,  # of a step: pulses a ten-thousandth of a millionth of it long are met, and its error not
    "window": 1e-4,  # interpolants err by 50 tolerances, 5e-8 of a step's way; a parabola about its end by a cube
    # rad: between stages a third of it apart a circle leaves what they see by 1/70 of a radius, a quarter of it is 1/32
    "seen_turn": 1.0,
    "near_kink": 1e-9,  # a load is then off by 1e-9 of what a step changes it, for 1e-9 of the step
    "no_jump": 1e-9,  # a kink's branches differ by its width in x, 1e-14, times any slope
    "leaving_first": 1e-13,  # of a step's way: some hundred roundings
    "leaving_last": 1e-3,  # of steps so short that coordinates move by roundings; what chatters never leaves
    "flurry": 1e-9,  # as SAME_INSTANT; a pulse a millionth of the run long has 2 events in 1e-6
    "least_load": 1e-200,  # N, N m or rad/s^2: bounds of exponentials are no closer than 1e-250
    "touching": 1e-14,  # of the size, and of places and limits: what settling leaves of a gap (nearly_closed)
    "unseen": 1e-4,  # of a load's largest in a step: what it does beyond what the stages saw
    # -- branches that are followed
    # rows of J turn threefold with what moves, so the least pivot keeps five eighths, Newton's method contracts by 3/5
    "branch_step": 0.125,
    "branch_beside": 0.7,  # other steps, few more; what differs then is rounding, or the branch
    # of a motion that goes round a quintic over a step of m rad is off by m^6 / 46080: 33 steps a swing, and what comes
    # near a limit by less is not told from what passes it; where it is passed, the closures tell
    "branch_between": 1e-9,
    "branch_bend": 0.05,  # a sine's step is then two fifths of its period; extremes are looked for at four places in it
    # -- charts of attitudes
    # cube root of EPS: rounding of W, EPS kappa, is there what the straight last way to the half turn leaves, kappa^-2
    "half_turn": EPS ** (1 / 3),
    "chart_turn": 0.5,  # half the way there: no step passes it, and of what turns re-centred |kappa| stays below 1
    # -- stages that are solved for
    "newton_ends": EPS,  # of the largest coordinate or rate: the next correction of the stages would be rounding
    "newton_rounding": 1e3 * EPS,  # what the sums of a derivative leave of stages that are solved for
    "newton_part": 0.1,  # of the local tolerance: what the stages may be left off by beside a step's own error
    "newton_noise": 1e-9,  # the same where no tolerance is given: nine digits, for what is stiff loses some
    "newton_stalls": 5.0,  # contraction of a simplified iteration is steady: five times the best is no contraction
    "newton_diverges": 2.0,  # the first ratio may pass 1 while the stiff parts turn in; what doubles is repelled
}
