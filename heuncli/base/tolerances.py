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
# part of a constraint row (scaled to 1) independent of the others: nine digits, the accuracy of a closed position
RANK = 1e-9
# likewise: anything smaller is rounding of coordinates; between this and RANK the dependence is reported
NEARLY_DEPENDENT = 1e-12
NO_SINGULAR_VALUE = EPS  # relative to the largest, times the longer side of an exactly known matrix: below is rounding
# factor on the constraint error: positions are known only to that error, singular values amplify it by some tens
RANK_OF_GAP = 100.0
# [rad] or relative to the size: a displacement that leaves an accidental start position, far above RANK
NEIGHBOUR = 1e-3
REMAINING_RATE = 1e-6  # rates drawn between -1 and 1: a smaller rest after projection onto the closures is rounding
SUSPECT_PIVOT = 0.05  # pivots of ordinary loops stay above; below it, the step is searched for a singular position
# factor on the ratio of remaining to initial search width: the value falls to zero at most that steeply
SINGULAR_MET = 4.0
NEAR_PIVOT = 1e-2  # relative singular value 0.1, a tenth of it in another measure: rounding over its 4th power, 2e-8
# relative to the size: rounding that a sum of a closure may hide, more than the projection leaves
UNSEEN_GAP = 16.0 * EPS
# relative to the largest value of its kind: six digits, as in a table; above it a value is unknown
UNKNOWN_NEAR_SINGULAR = 1e-6
# factor on the allowed residual of a row: rows left out meet less than this, all others meet it to rounding
UNMET_ROW_FACTOR = 10.0
SINGULAR_FALL = 0.5  # relative to the largest value in the search: it falls to zero at a singular position
# relative to the loads: their part along a motion of a position known to RANK, one digit above
LOAD_ALONG_FREE_MOTION = 1e-8
NEARLY_SINGULAR = 1e-6  # relative singular value: reactions err by gap / value, 1e-10 / 1e-6, and keep four digits

# -- couplings: what of a drawing decides whether gears fit
TYPED_AXES = 1e-9  # sine between axes that are parallel, or at right angles, by what is typed or computed of it
# relative to the largest rate: allowed residual of several drives of one coupling, far above rounding
DRIVES_DISAGREE = 1e-9
NO_PATH_DIRECTION = 1e-6  # relative to the largest slope of a path: below it the path has no direction to six digits
SAME_PLACE = 1e-9  # relative to a path's reach: closer branches coincide, given typed or assembled coordinates
TYPED_POINT = 1e-6  # relative to the distance concerned: points are typed with six digits or more

# -- open: which components no law of rigid bodies decides, and the sums that are certain
NO_SELF_STRESS = 1e-13  # relative to unit multipliers: a null vector with smaller loads in every joint is rounding
OPEN_SHARE = 1e-8  # relative to a self-stress's largest component: a null vector is known to RANK, ten times better
# sine squared between a yielding direction and the reach of the self-stresses: sine 1e-6, because components known to
# 1e-8 are summed with levers up to a hundred times as long
HELD_BY_OTHERS = 1e-12
# relative to the largest strain: RANK again; a self-stress with less strain is not decided by the stiffness
STRAINED_SELF_STRESS = 1e-9
# relative to a unit component: a smaller rest of self-stresses after a split is rounding of their parts
OPEN_AFTER_SPLIT = 1e-9
DEPENDENT_SHARES = 1e-7  # relative to a component's largest share: known to OPEN_SHARE, one digit for the elimination
ABSENT_FACTOR = 1e-9  # relative to the largest, or to unit length: a smaller factor means that the component is absent
WHOLE_FACTOR = 1e-9  # a factor this close to a whole number is that number; shares are not known better
# [rad] or relative to the size: displacements at which a determinate sum must hold too; large, so that rotating sums
# show, and several, because one degree of freedom gives two positions each and fewer positions than components admit
# accidental sums
SUM_POSES = (0.05, 0.1, 0.2, 0.4)
# relative to the largest: between positions NEIGHBOUR apart, an open force in one direction turns by NEIGHBOUR**2
ONE_DIRECTION = 1e-6
# relative to a proposed unit direction or a quaternion: smaller components are rounding, not printed
ZERO_COMPONENT = 1e-12

# -- in the plane
# sine of a direction, and of the size or a vector's length: some dozen roundings, which turning a plane in space leaves
# and every step makes anew; nothing that is typed is so small
FLAT = 64.0 * EPS
NEARLY_FLAT = 1e-3  # the same: a drawing off by less was meant to be flat, which is told

# -- small oscillations
# factor on the change of a stiffness entry or a load when model and position move by START_ROUNDING: the entry itself
# errs by some tenths of that change, so after cancellation a rest above about 64 EPS of its terms is a real stiffness
REAL_STIFFNESS_FACTOR = 8.0
# relative to the norm, times the number of motions: effect of some dozen roundings in each entry
EIGENVALUE = 64.0 * EPS
FREELY_PUSHED = 1e-9  # relative to the loads along an unconstrained motion: a sum over positions closed to OPEN_GAP
# [rad] or relative to the size: allowed distance of a start from equilibrium; frequencies keep nine digits
OFF_BALANCE = 1e-9
KINK = 1e-9  # relative to a coordinate, or 1: a position this close to a jump or kink of a law is on it (OPEN_GAP)
# relative to the largest slope within KINK: a root doubles the slope at each step, a smooth law hardly changes it
STEEP = 0.5
# relative to the stiffness and loads: allowed change along a steady motion; rounding of long displacements
STEADY_CHANGE = 1e-8

# -- orders
CANCELS = 1e-9  # relative to the sum of the bodies' own amplitudes: models typed with ten digits balance that well
# relative to the largest force or moment: if two periods differ more, orders are not known to two digits
SAME_PERIOD = 1e-2
# relative to the largest singular value: places of weights that differ by less in effect serve alike
SAME_WEIGHT = 1e-10
# relative to the largest order: limit on the highest orders for all lower ones to be reported; FFT roundings
ORDERS_SETTLED = 1e-12

NO_PART = 1e-9  # relative to the larger of two parts of an order: models typed with ten digits turn one way that well
# relative to the largest order: a smaller one alters no sum by a tenth of a percent, and is not named
NAMED_ORDER = 1e-3
LISTED_ORDER = 1e-4  # likewise: a smaller one is no digit of a table of four digits, and is listed only on request
# relative to the mean magnitude of the torque: a load that is typed with six digits to match another balances that well
NO_NET_WORK = 1e-6
# speed fluctuation: rounding of the two extreme rates is 2e-7 of their difference, six digits of a flywheel remain
EVEN_RATE = 1e-9
NO_SQUARE = 1e-12  # relative to the largest square: of a millionth of the largest load, a digit that no table shows
# relative to the heaviest product: the iteration ends at half the digits of EPS, a tenth of that is rounding
NO_WEIGHT = 1e-9
# relative to the largest effect of a product: accelerations of a cycle are sums of hundreds of terms, with ten digits
NO_EFFECT = 1e-10
LAW_FOLLOWED = 1e-6  # relative to a law's range over the cycle: six digits, as in a table
# relative to a cycle: places of breaks are known to SIDE_BY_SIDE, a hundredth of it
BESIDE_BREAK = 1e-10
# relative to the terms: a tail as small that halving hardly reduces is rounding of the numbers, not their course
RESOLVED_TO_NOISE = 1e-7
SHORTEST_PIECE = 64.0 * EPS  # relative to the cycle, or its angles: sixteen nodes are four roundings apart

# -- meetings: where a measure takes a value between its samples
# relative to the distance of samples in the scan: a jump is bracketed to 1e-10, and polynomials through samples on one
# side of it are of use only to eight halvings
DOUBTED_NEAR_JUMP = 1.0 / 256.0
EDGE_BRACKET = 1.0 / 32.0  # likewise: five halvings, from which on the edge itself is predicted
ISOLATED_SINGULAR = 1e-3  # likewise: singular positions over less are an isolated place, not a part of the course
NEAR_SINGULAR_RUN = 1e-6  # likewise: nearer to a singular position no run tells more
# factor on the slope outside of the narrowest bracket: a smooth measure's slope does not grow tenfold within so little
STEEPER_THAN_SLOPE = 10.0
# relative to the change across a bracket a thousand times as wide: a jump keeps all of it, a root of x - c 3 %
JUMP_KEEPS = 0.8
FAR_FROM_VALUE = 1e4  # factor on the value and the usual size: a pole of first order is then four digits closer than it
RISES_TO_END = 0.5  # relative to an exponential rise: a pole rises faster, a peak that was passed by far less
FLATTENS = 1.5  # power of the distance with which g grows: between a crossing (1) and a touch (2)
# factor on the steepest of the four neighbours of an interval between samples: smooth rises that their samples resolve
# grow by less from one interval to the next
SWEPT_JUMP = 10.0
# factor on the smallest distance of places: a touch within it doubles |g| at the next place or at the one after
TOUCH_DOUBLES = 3.0

# -- coordinates of Lagrange's equations
# largest over least rate of coordinates for a unit of motion: eight digits of the partials are left
COORDINATE_RATIO = 1e8
NO_OFFSET = 1e-9  # rad/s^2, or of the size: what a pose that rests leaves of accelerations is rounding
HALF_TURN = 1e-9  # relative to a quaternion's scalar part, known to 1e-15: six digits of its Rodrigues vector remain

# -- bushings: where they come to half a turn
# [rad] short of it: there the moment jumps to the other side, and which side it is on is known to the error of a run,
# which is a thousandth of this where nobody asks for more
TURNED_OVER = 1e-6
NEARLY_TURNED_OVER = 1e-3  # the same, where a run could not go on: so near to that it did not for that

# -- no inertia
# relative to the body's largest moment of inertia: a rotated tensor keeps 14 digits, typed ones keep some
NO_INERTIA = 1e-12
NO_MASS = 1e-12  # relative to the heaviest body: changes no printed digit of a sum of weights
POINT_MASS = 1e-9  # relative to m L^2: a body with a radius of gyration of 3e-5 of the model size is no point mass yet
ON_AXIS = 1e-9  # relative to the size: points typed with ten digits; closer loads act on the thin axis
ALONG = 1.0 - 1e-9  # cosine of an axis with that of the missing inertia: 4.5e-5 rad, for the spin it frees is idle
ALONG_SQUARED = 1.0 - 1e-9  # square of the same cosine, as found from the points on the axis: 3e-5 rad
# relative to the largest moment about the origin, for the size: sums of some dozen terms and rotated axes; less round
# bodies are rotated by their own motion
AXISYMMETRIC = 16.0 * EPS
# relative to the transverse moment of inertia: moments about the axis accelerate 1e3 times as much, so does their
# rounding
SPINS_LIGHTLY = 1e-3
# relative to the size: smallest radius of gyration of the artificial inertia of an idle spin (it cancels)
ARTIFICIAL_RADIUS = 1e-3
# relative to the inertia that a body carries: its artificial inertia is at least that, so that a dozen roundings of
# what it carries are a tenth of KERNEL.own_share of it
ARTIFICIAL_SHARE = 1e-2
SLENDER = 1e-6  # determinant over the cube of the trace: above, no moment is NO_INERTIA of it; a rod 200 diameters long
NO_MOMENT = 1e-9  # relative to the loads on a body: a smaller moment about its thin axis is what ON_AXIS admits

# -- gaps of poses and rates that are assembled
# relative to the size, or rad: quadratic iterations go below it at once, joints that cannot close stay above
OPEN_GAP = 1e-10
GAP_ROUNDING = 64.0 * EPS  # relative to the largest coordinate: some dozen roundings far from the origin
OPEN_RATE = 1e-10  # relative to the speed of the model and its drives over its size: as OPEN_GAP
AT_REST = 1e-6  # [rad/s] the least speed a scene is taken to have: rounding about rest opens no joint
SOLVABLE = 1e-8  # relative to the required acceleration: what may remain unsolved, one digit above RANK
NO_ACCELERATION = 1e-12  # relative to speed^2/size: smaller required accelerations are rounding of the rates
STILL = 1e-28  # [m/s^2, rad/s^2] squares of rates of 1e-14, which rounding leaves where a blow ends rates of 1
SAME_VALUE = 1e-9  # rad, m, or relative beyond 1: a held value and a drive that agree so far say the same; typed digits
NO_LENGTH = 1e-9  # relative to the size: a shorter rod's direction has one digit beyond OPEN_GAP
NEAR_DRAWING = 0.5  # a joint's gap (by L) or angle, a body's shift or turn: a drawing off by less means this very pose
# factor on the displacement to the nearest position: smallest rotations may lead this far; no body goes twice as far as
# known
FARTHER = 1.2
# relative to the size, or to the required accelerations: with a larger error a drive is not followed
DRIVE_FOLLOWED = 1e-12
CLOSED = 1e-15  # relative to the size: as closed as rounding allows
# relative to |C| |e|: square root of some dozen roundings; a smaller slope of a sum of squares is rounding
NO_SLOPE = 1e-7
POLISHED = 1e-12  # turns [rad] and shifts (by the size): nothing is left to polish
# the same: squares of steps below 1e-5 are 1e-10 and drown in what closing leaves in the sums
SUM_OF_SQUARES_LIMIT = 1e-5
SAME_SUM = 1e-13  # relative to a sum of squares: hundreds of roundings
DRAWN_IN_PLACE = 0.1  # a joint's gap (by L) or angle: a slip of the drawing is less, bodies drawn apart miss by a link
# relative to the model size: bodies moved further by the assembly are listed above the tables; places typed with three
# digits, a millimetre in a metre, close that well
MOVED = 1e-3
UNMOVED = 1e-12  # relative to the size, or rad: smaller changes of the start are rounding and not reported
PRINTED_COMPONENT = 1e-9  # relative to the size: smaller components of a chosen value are not printed

# -- contacts
# relative to the size, and to places and limits: START_ROUNDING after some hundred steps, so that contacts touching at
# an instant also touch in a run from a moved start
CONTACT_TOUCHES = 1e-12
# relative to the terms of an opening rate: thousands of roundings, left by projections and impulses
CONTACT_RATE = 1e-12
CONTACT_ACCELERATION = 1e-11  # likewise for accelerations, where loads and factors add one digit
# relative to a gap: contacts of a sequence that close within it close together; ten times the default tolerance of a
# motion, so that a start moved by its error finds the same ones
CONTACT_TOGETHER = 1e-8
# relative to a contact's own response: remainder after earlier contacts, needed to solve for its rate
CONTACT_BASIS = 1e-3
# relative to a contact's own response: with a smaller remainder it depends on others; squares, so 1e-6 of a lever
CONTACT_DEPENDS = 1e-12
# relative to the response of free bodies: less means fixed by the other joints, to hundreds of roundings
NO_ANSWER = 1e-13
SHORTEST_FLIGHT = 1e-12  # relative to the run's length: a hundred times the distinction of instants (least_step)

# -- ropes over sheaves
FLEET_ANGLE = 0.07  # rad, 4 deg: how far a rope may leave a sheave's plane (DIN 15020-1); its forces are then right to
# 1 - cos of it, 0.25 %
FLEET_SEEN = 1e-4  # rad: below, what that makes is 5e-9 of a force, as little as the loads of a run are known to
ASKEW = 1e-7  # rad: axes of two sheaves that a strand runs between, which only rounding may part
# relative to a sheave's radius: where a run fails with a strand this short, it was wound up. At a distance d from the
# rim the strand is sqrt(2 R d) long, and steps end where d is rounding, some thousand EPS of R: 1e-6
WOUND_UP = 1e-4
COUNTED_ROUND = 0.39  # rad, half of 45 deg: an arc beyond 315 deg is counted as -45 deg, one that lifts off passes 0
# rad, 225 deg: between two steps an arc that is counted anew jumps by 315 deg and more, a slack rope's end turns less
RECOUNTED = 3.93
OFF_SHEAVE = 1e-9  # rad: an arc that is less than none by more has left its sheave

# -- same instant, same place, same direction
SAME_INSTANT = 1e-9  # relative to the run's length: instants typed with ten digits
SIDE_BY_SIDE = 1e-12  # relative to the run's length: thousands of roundings of an instant; a jump between has two sides
# relative to the largest coordinate: a model of smaller extent is one place; its size is taken as 1 m
ONE_PLACE = 1e-12
SAME_CUT = 1e-9  # relative to the length of a series of cuts: places typed with ten digits
# relative to the body's size, or to coordinates along the normal: closer points count as in the cutting plane
IN_PLANE = 1e-12
LEAST_EXTENT = 1e-9  # [m] reference length of IN_PLANE if everything is at the origin
TOUCHING = 1e3  # factor on IN_PLANE: closer outlines of a cut are one
OUTLINES_APART = 1e-3  # relative to their radii: polygons of 96 sides deviate from their curves by 5e-4 of a radius
OFF_AXIS = 2e-15  # sine of a normal to a body of revolution's axis: rounding of a unit vector, 9 EPS
# relative to a unit normal: equal components; x precedes y precedes z (manual/format.md, "Sections")
EQUAL_COMPONENTS = 1e-9
MESH_DIGITS = 2.0**-21  # relative to the largest coordinate: eight steps of a float32, the precision of mesh files
PARALLEL = 1e-9  # sine between directions typed with ten digits: below, they are one line
OUTLINE_PRINCIPAL = 1e-4  # likewise for a mesh: corners have the digits of a float32, arcs are chords
# relative to the area times the cube of its extent: third moments of an outline with 180-degree symmetry, whose arcs
# are chords; a channel has about 1e-2
OUTLINE_SYMMETRIC = 1e-3
# I12 relative to sqrt(I1 I2): typed lengths; the neutral axis rotates by less than this over 1 - I1/I2
PRINCIPAL = 1e-9
UPRIGHT = 1e-9  # 1 - cosine between a body's z axis and the world's: 4.5e-5 rad, the accuracy of typed quaternions

# -- loads that are none
# relative to the largest load on a body over its mass: ten times NO_LOAD, the residual of a sweep
STARTS_MOVING = 1e-10
NO_FORCE = 1e-12  # relative to the largest load in the sum: hundreds of roundings; such a force has no line of action
NO_LOAD = 1e-11  # relative to the largest m (a - g): residual of a sweep at six unconstrained degrees of freedom
NO_ENERGY = 1e-20  # relative to the weight's work over the size: squares of speeds of 1e-10, which OPEN_RATE admits
UNBALANCED = 1e-6  # relative to a body's largest load: rounding stays far below, also near a singular position
CONSTANT = 1e-13  # relative to its size: smaller variations are hundreds of roundings, without a peak

# -- accuracy
# fractions of the time to failure: how long before it a run may stop that finds events before the failure; near a lock
# rates grow as the inverse root of the remaining time
BEFORE_FAILURE = (1e-9, 1e-6, 1e-3, 1e-2, 0.1)
CLAIMED = 1e-3  # relative to the whole: the error at the horizon, after which nothing is claimed
JUDGED = 1e-8  # relative to the whole: limit of comparison in a chart whose references diverge; half the digits remain
LOST = 1.0  # relative to the whole: a larger error makes positions meaningless; charts show no larger error
# a tolerance that is asked for: the rounding of a state's numbers, 8 EPS, shows as its five-fold in the difference of
# two runs; where what is told may err by more than a tenth of the scene, nothing is where it is told
LEAST_ASKED = 1e-14
MOST_ASKED = 0.1
LEAST_TOLERANCE = 3e-14  # local tolerance: a thirtieth of it, in the check run, is 5 EPS; below, steps follow rounding
COARSEST_RETRY = 1e-6  # local tolerance above which a collapsed run is not repeated: three digits remain
# relative to the size, or to the farthest coordinate: rounding of a place; no estimate is below
PLACE_ROUNDING = 2.0 * EPS
# relative to a state's numbers: typed digits, assembly, and the rounding of some hundred steps
START_ROUNDING = 8.0 * EPS
ROUNDING_MATTERS = 5e-10  # local tolerance: errors are about 1e-3 of it, then no more than 300 START_ROUNDING
SUM_ROUNDING = 16.0 * EPS  # relative to the largest term: sums of some dozen terms with their own roundings
UNKNOWN = 1e6  # relative error assigned where the error is unbounded or not a number
FRICTION_LACKS = 1e-6  # relative to its value: smoothed friction this close to full has all six digits of a table
WRITTEN = 1e-12  # relative to the largest: digits of exactly solved values after some thousand roundings
LEAST_RATE = 1e-5  # a radian, or the size, per requested time: slower motions are judged as if this fast
BOUNDLESS = 1e3  # a value that grows so many times over within 2**-20 of the run is on its way to infinity; where steps
# become too many, one that has grown so in the last three quarters of the time is what they follow
MOST_STEPS = 20_000_000  # steps of a run: minutes for the smallest model, half a gigabyte of records
MOST_SOLVED = 1_000  # state variables of a dense implicit system: a second per step, 50 million bytes
MOST_FOREIGN = 200_000  # steps of SciPy's methods, which take a hundred times as long
CHECK_STEPS = 4  # steps of the check run for one given step: order 1 errs there by a quarter, and 2 |A - B| by 1.5 of A
# relative to a run's longest step: shorter steps have errors of 3**-5 or less, at any order from 5 on
SHARED_STEP = 1 / 3
SAME_STEP = 1e-6  # relative to a step: events of a run from a moved start shift by no more than this
HOPELESS = 1.0  # factor on the step limit over the root of the completed part: allowed number of projected steps
# relative to a rate's size times the time: rounding of a quadrature sum, between whole and halves
INTEGRATED = 2.0 * EPS
# relative to a rate's size: its possible mean between the nodes of its integral, no more than a default tolerance; the
# integral itself errs by rounding
UNSEEN_RATE = 1e-9
QUADRATURE = 1e-14  # relative to the scale: whole against halves; planes that graze thin walls then err by as much

# -- choice of the method
STIFF = 0.5  # relative to the stability boundary: steps limited by stability are at it, others seldom above a third
EVENTFUL = 1 / 4  # fraction of the steps: a step ended by an event costs three, so half the stages are spent on events
# fraction of the steps of a method with few stages: it takes several between events, order 8 takes one
EVENTS_RARE = 1 / 8
VERNER98 = 1e-11  # tolerance: from there on order 9 misses it in 2 of 23 scenes, order 8 in 7, for as many evaluations
RADAU5 = 3e-6  # local tolerance above which three stages take less than five, with a check run at a thirtieth of it

# -- what a motion comes near to
GIMBAL = 1e-3  # rad from a lock of Euler angles: the condition of their matrix is 2e3, three digits are lost
FASTER_THAN_TIME = 4.0  # growth over the second half of a run: growth with the square of the time is fourfold

# -- pictures
# relative to its size: a value that varies less is shown once; typed with ten digits it would be constant
THROUGHOUT = 1e-9
IN_ONE_PLANE = 1e-9  # relative to a run's largest vector: out-of-plane components left by rotated axes and steps
# relative to the largest in-plane vector: larger out-of-plane components are reported; six digits, as in a table
TOLD_ACROSS = 1e-6
SAME_TURN_DRAWN = 2e-3  # relative to the largest vector: a pixel of a picture; closer rotations are drawn as one
# rad, a quarter turn: farther apart two instants do not show how a body turns from one to the other
MAX_INTERPOLATED_TURN = 1.57
NOTHING_ACTS = 100.0 * EPS  # relative to the summed forces: rounding of the sum, which has no direction to draw

# -- rest
REST_FIRST = 0.01  # rad, or relative to the size: the first step, short compared with any lever
REST_DOUBT = 0.05  # rad, or relative to the size: with a larger error the equilibrium may be another one
# rad, or relative to the size: Newton's steps bring two searches this close, other positions are farther apart
REST_SAME = 1e-6
REST_WAY = 1e-4  # likewise along indifferent directions: if two searches agree this well, no finer one is made
REST_SEARCHES_DIFFER = 0.1  # likewise: two searches farther apart have followed different paths
REST_FARTHEST = 0.5  # likewise: a longer step may skip curvature within half a revolution
REST_BENT = 0.05  # relative to a step: allowed deviation from the linear law; a fifth of it then remains at third order
REST_MISSED = 0.01  # relative to REST_BENT: allowed sideways displacement by closing the loops
REST_FINER = 0.1  # likewise for a search relative to the preceding one, which it checks
REST_STRAIGHT = 1e-6  # likewise for a step beyond REST_FARTHEST: nothing is curved there
RUN_AWAY = 1e6  # factor on the model size: a body displaced this far is unconstrained
TURNS_ON = 63.0  # rad: ten revolutions have met every angle several times
# factor on the accelerations caused by START_ROUNDING of a position: some hundred steps, so that a symmetric model
# comes to rest symmetrically, stable or not
PUSHED_BY_ROUNDING = 50.0
# relative to the terms of an acceleration, of the fastest drive: axes typed with ten digits rotate about themselves
STEADY = 1e-9
INDIFFERENT = 1024.0 * EPS  # relative to the terms of an eigenvalue: exact slopes at a position known to rounding
# relative to unit eigenvectors, perpendicular part: if larger they keep ten digits, as a block all
NEARLY_DEFECTIVE = 1e-6
# relative to the terms of an acceleration: equilibrium leaves rounding of them, jumping loads leave their part
NOT_HELD = 1e-6

# -- the range of what is computed with, SI: the largest products are of four quantities (m L^2 of an inertia is one of
# three, and the square of a moment F L one of four), 1e240; their sums over 10,000 bodies stay below the end of double
# precision, 1.8e308, and what is divided by them above its other end, 2.2e-308
LEAST_MAGNITUDE = 1e-60
MOST_MAGNITUDE = 1e60

# -- what is typed in a spec
UNIT_TYPED = 1e-2  # a unit quaternion or rotation matrix may be this far off: two digits at least
UNIT_EXACT = 1e-14  # some dozen roundings: nearer to a rotation, a matrix is taken as it stands
INERTIA_REFUSED = 1e-3  # relative to the largest moment of inertia: limit on a violated triangle inequality
# relative to the largest moment of inertia: moments typed with ten digits keep triangle inequality and symmetry this
# well
INERTIA_TYPED = 1e-9
# of a bushing's matrix, scaled to 1 on its diagonal: matrices typed with ten digits are symmetric and semidefinite so
# well
STIFFNESS_TYPED = 1e-9
# relative to mass * size^2 of a robot: smaller moments of inertia in its file are rounding of a CAD program, which
# cancels lengths known to EPS: (1e-16)^2 is far below, and no part of a robot is 1e-10 of its size
NO_IMPORTED_MOMENT = 1e-20
AT_LIMIT = 1e-9  # relative to the size, or rad: a start past a limit by less is at the limit, given ten typed digits
LEAST_STRENGTH = 1e6  # [Pa] below what bars are made of (foams aside): a strength in MPa was written without its unit
GREATEST_SAFETY = 1e3  # against buckling that is reported: no bar needs more, and in tension it has no bound
DERIVATIVE_ERROR = 0.1  # of its largest value: a derivative of measured points with a larger error is warned of
TABLE_ENDS = 1e-6  # relative to the span: a table's period and its end values are printed with seven digits
EXPECTED_RELATIVE = 1e-6  # relative to the largest expected number: default of `rel` (manual/format.md, "Expect")
EXPECTED_ABSOLUTE = 1e-9  # default of `abs`

# The kernel's thresholds (kernel/scene.py, Limits).
KERNEL: dict[str, float] = {
    # -- inertia
    "no_inertia": 1e-14,  # relative to the trace: some dozen roundings of the sums of an articulated inertia
    # square of NEARLY_SINGULAR: where the loops hold a freedom without inertia by a lever of s, s^2 of the others' is
    # what it moves, and accelerations are known to rounding / s^2
    "own_share": 1e-12,
    "much_artificial": 1e-3,  # three digits lost
    # -- friction
    # 1 minus the loop gain of friction by normal forces: dividing by it keeps eight digits of sixteen
    "friction_left": 1e-8,
    # -- rank
    "row_across": 0.01,  # a row's response across its arms counts to a tenth of the arm, in any pose
    "independent": RANK,  # what the verdicts judge by, too
    "passing": 3e-6,  # square root of `reopened`: through a singular pose a row with s left of it opens by s**2
    # relative to the rest that the start's rows have: no machine is kept from the rank of its own start
    "passing_of_start": 1e-3,
    "rounding": 8.0 * EPS,  # relative to some ten terms: a row's demand, a degree of freedom's load
    "preference": 1.01,  # 1 %: rows equal except for rounding are taken in order, which keeps the choice steady
    "pivot_drop": 1e-3,  # relative to a pivot: 5 digits of the multipliers lost, better rows are needed
    "near_singular": 0.2,  # a pivot below which the stages of a step are settled, too: their gaps grow by 1 / pivot
    "locked": 1e-4,
    "locked_step": 1e-9,  # relative to the time: a step 1e9 times shorter than the run, at a small pivot, is a lock
    # -- gaps, of the scene's size
    "closed": 1e-15,
    "nearly_closed": 1e-14,
    "reopened": 1e-11,
    "closures_lost": 1e-8,
    # -- rates that the closures change at the end of a step, of the largest
    "jump": 1e-2,  # coarse runs err by 1e-3, a blow changes rates by their own size
    "jump_of_error": 100.0,  # an accepted step errs by the tolerance, the rows' rates by some of it, over their pivot
    # relative to a rate of the model size: a step of half a radian turns it by that much; impulses change rates by more
    "jump_of_given": 0.5,
    # -- steps
    # relative to the largest rate: slower bodies judged by their own rate would cost steps for nothing
    "slow_rate": 0.01,
    # relative to sqrt(acceleration / size): a tenth of the fall time, after which a released body is in motion
    "held_rate": 0.1,
    # relative to the rate w that drives and loads impose: as a hundredth of `held_rate`, which other scenes begin with
    "balanced_rate": 1e-3,
    # what rests between them accelerates by roundings of w^2, so that a step of h w = 10 rad changes rates by this
    "imposed_rounding": 100.0 * EPS,
    # relative to a given step: the ends of 10 million steps are known to 1e-8 of one, typed durations to 1e-9
    "given_end": 1e-6,
    "least_step": 1e-14,  # relative to the time: fewer than 50 roundings of t; closer times are one instant
    "retry_ratio": 0.87,
    "singular_retries": 10,  # lengths tried; .87**10 is 1/4, more than the width of what a singular pose spoils
    "pivot_rounding": 1e-16,  # a rounding of the closures, amplified by 1 / pivot
    "pivot_noise": 3e-13,  # what ten lengths could not avoid: the gap that settling leaves, amplified likewise
    # -- events
    "one_instant": 4.0 * EPS,  # errors of event times add up: no more than the rounding of instants
    "finest": 1e-10,  # relative to a step: pulses 1e-10 of it long are found, rounding of it is not
    "window": 1e-4,  # interpolants err by 50 tolerances, 5e-8 of a step's way; a parabola about its end by a cube
    # rad: between stages a third of it apart a circle leaves what they see by 1/70 of a radius, a quarter of it is 1/32
    "seen_turn": 1.0,
    "near_kink": 1e-9,  # a load is then off by 1e-9 of what a step changes it, for 1e-9 of the step
    "no_jump": 1e-9,  # a kink's branches differ by its width in x, 1e-14, times any slope
    "leaving_first": 1e-13,  # relative to the displacement in a step: some hundred roundings
    # relative to steps so short that coordinates change by roundings; a chattering branch never leaves
    "leaving_last": 1e-3,
    "flurry": 1e-9,  # as SAME_INSTANT; a pulse a millionth of the run long has 2 events in 1e-6
    "least_load": 1e-200,  # N, N m or rad/s^2: bounds of exponentials are no closer than 1e-250
    # relative to the size, and to places and limits: residual of a gap after projection (nearly_closed)
    "touching": 1e-14,
    "friction_rounding": 1e-12,  # thousands of roundings, which loads and factors leave in a multiplier
    "still_rate": CONTACT_RATE,  # what is slower is at rest, by which its state is decided
    "unseen": 1e-4,  # relative to a load's largest value in a step: change that the stages did not see
    # -- branches that are followed
    # rows of J turn threefold with what moves, so the least pivot keeps five eighths, Newton's method contracts by 3/5
    "branch_step": 0.125,
    "branch_next_start": 0.7,  # other steps, few more; what differs then is rounding, or the branch
    # over a step of m rad of a rotation a quintic errs by m^6 / 46080: 33 steps per oscillation; a limit approached
    # more closely cannot be distinguished from one passed, which the closures show
    "branch_between": 1e-9,
    "branch_bend": 0.05,  # a sine's step is then two fifths of its period; extremes are looked for at four places in it
    # -- charts of attitudes
    # cube root of EPS: rounding of W, EPS kappa, is there what the straight last way to the half turn leaves, kappa^-2
    "half_turn": EPS ** (1 / 3),
    "chart_turn": 0.5,  # half the way there: no step passes it, and of what turns re-centred |kappa| stays below 1
    # -- stages that are solved for
    # relative to the largest coordinate or rate: the next correction of the stages would be rounding
    "newton_ends": EPS,
    "newton_rounding": 1e3 * EPS,  # what the sums of a derivative leave of stages that are solved for
    # relative to the local tolerance: allowed error of the stages in addition to a step's own error
    "newton_part": 0.1,
    "newton_noise": 1e-9,  # likewise where no tolerance is given: nine digits, because stiff systems lose some
    "newton_stalls": 5.0,  # contraction of a simplified iteration is steady: five times the best is no contraction
    "newton_diverges": 2.0,  # the first ratio may pass 1 while the stiff parts turn in; what doubles is repelled
}
