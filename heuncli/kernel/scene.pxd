"""The structs of scene.py for C, field by field in the same order (a test compares them), and the scene they make."""

from heuncli.kernel.algebra cimport Ldl3, Mat3, Sym3, Vec3
from heuncli.kernel.expressions cimport Program, Programs

cdef enum:
    TURN_IN_PARENT, TURN_IN_BODY, SHIFT

cdef enum:
    FORCE, COUPLE, SPRING, ACTUATOR, TORQUE, THRUST, TURN_SPRING, TURN_DAMPER, SHIFT_DAMPER, TURN_FRICTION, SHIFT_FRICTION

cdef enum:
    GUIDE, DOT, ROD, TURN

cdef enum:
    CARRIES, APART, LEANS

cdef struct Body:
    int parent
    int ball
    int attitude_at
    int rate_at
    int first_freedom
    int end_freedom
    int answer_at
    int framed
    double mass
    Vec3 first_moment
    Sym3 inertia
    Vec3 joint_in_parent
    Mat3 frame
    Mat3 R
    Vec3 r
    Vec3 omega
    Vec3 v
    Vec3 arm
    Vec3 alpha_bias
    Vec3 a_bias
    Vec3 alpha_zero
    Vec3 a_zero
    Vec3 mc
    Vec3 gyroscopic
    Vec3 centrifugal
    Vec3 M_applied
    Vec3 f_applied
    Sym3 A
    Mat3 C
    Sym3 K
    Ldl3 turning
    Mat3 G
    Vec3 M_branch
    Vec3 f_branch
    Vec3 alpha
    Vec3 a
    Vec3 M_joint
    Vec3 f_joint

cdef struct Freedom:
    int kind
    int q_at
    int u_at
    int driven
    int answer_at
    int body
    Program program
    Vec3 direction
    double offset
    Vec3 s
    Vec3 U_turn
    Vec3 U_shift
    double D
    double q
    double u
    double udot
    double drive

cdef struct Load:
    int kind
    int a
    int b
    int in_body
    int freedom
    int counter
    Program x
    Program y
    Program z
    Vec3 p
    Vec3 q
    Vec3 vector
    double stiffness
    double length
    double coefficient
    Vec3 axis
    double speed
    double factor
    double offset
    Vec3 across
    Vec3 mark
    Vec3 force
    Vec3 moment
    Vec3 at
    Vec3 from_at
    double value
    double span
    double rate
    double power

cdef struct Closure:
    int kind
    int a
    int b
    int freedom
    Program program
    int path
    int path_count
    int column
    int answers
    int answer_count
    int filled_count
    int couplings
    int coupling_count
    int rank
    Vec3 e
    Vec3 g
    Vec3 p
    Vec3 q
    double length
    double weight
    double measure
    Vec3 f
    Vec3 m
    Vec3 Q
    double gap
    double rate
    double gamma
    double multiplier
    double demand
    double prescribed_rate
    double prescribed_second
    double answer
    double doubt
    int mode
    int pivot_at
    int chosen
    int support_count
    int coupled_count
    double reflector
    double pose_scale

cdef struct Contact:
    int row
    int sense
    int opens
    int unused
    double start
    double start_rate
    double least
    double most
    double level
    double highest
    double bent
    double before
    double first
    double fastest
    double rate_bent
    double rate_before
    double rate_first

cdef struct Counter:
    int a
    int b
    int at
    int unused
    Vec3 axis
    double counted

cdef struct Variable:
    int freedom
    int is_rate

cdef struct Watch:
    Program program
    int curved
    int condition
    double low
    double high
    double scale
    double rounding

cdef struct Lent:
    int body
    int unused
    double root
    Vec3 axis
    Vec3 n
    double z

cdef struct Group:
    int coordinates
    int rates
    int end
    int unused
    double rate
    double trial

cdef struct Island:
    int rows
    int row_count
    int freedoms
    int freedom_count

cdef struct Limits:
    int dodges
    int unused
    double no_inertia
    double own_share
    double much_lent
    double across
    double independent
    double passing
    double passing_of_start
    double rounding
    double preference
    double pivot_drop
    double near_singular
    double locked
    double locked_step
    double closed
    double nearly_closed
    double reopened
    double lost
    double jump
    double jump_of_error
    double jump_of_given
    double slow_rate
    double held_rate
    double least_step
    double given_end
    double dodge
    double pivot_rounding
    double one_instant
    double finest
    double window
    double near_kink
    double no_jump
    double leaving_first
    double leaving_last
    double flurry
    double least_load
    double touching
    double unseen
    double pivot_noise
    double branch_step
    double branch_beside
    double branch_bend
    double half_turn
    double chart_turn
    double newton_ends
    double newton_rounding
    double newton_part
    double newton_noise
    double newton_stalls
    double newton_diverges

cdef struct BodyAtState:
    Sym3 inertia
    Vec3 alpha
    Vec3 a
    Vec3 M
    Vec3 f

cdef struct BodyTangent:
    int moves
    int unused
    Vec3 turn
    Vec3 arm
    Vec3 r
    Vec3 spin
    Vec3 omega
    Vec3 v
    Vec3 alpha
    Vec3 a
    Vec3 M
    Vec3 f

cdef struct FreedomTangent:
    double q
    double u
    double udot
    double load
    Vec3 s

cdef struct Scene:
    int body_count
    int freedom_count
    int load_count
    int closure_count
    int counter_count
    int variable_count
    int lent_count
    int island_count
    int watch_count
    int contact_count         # one-sided rows
    int held_count            # branches of expressions that are held over a step
    int angle_count           # of them those of atan2
    int answer_count          # freedoms, a ball's three turns among them
    int selected_count        # independent closure rows
    int driven                # something is driven: the work of drives counts
    int flat                  # bodies turn about z and shift across it: plane.py moves them
    int work_at               # where the work stands in the state; -1: it is not asked for
    Vec3 gravity
    double size
    Limits limits
    double rank_of_gap        # what of a row the gap of a pose may feign [1/m]
    double least_row          # what has to be left of a row for it to be chosen
    double pivot_chosen       # least pivot of the closures when their rows were chosen
    double pivot              # now
    double pivot_of_step      # least since the step began
    double gap                # of the state recovered last, over all rows [m]
    double lent_part          # root of the part of the inertias in `lents` that is lent
    double own_share          # least pivot of 1 - T: of the inertia in a motion, how much is not lent
    double pivot_recovered    # least of the independent rows there, as they were selected: geometry alone, squared
    double load_size          # |D^(-1/2) e|: what the freedoms would answer without closures, in the measure of M
    double residual           # largest J Vdot + gamma of all rows there, of the terms it is the sum of
    Body *bodies
    Freedom *freedoms
    Load *loads
    Closure *closures
    Counter *counters
    Variable *variables
    Lent *lents
    Island *islands
    Watch *watches
    Contact *contacts
    int *is_angle             # which branches are those of atan2
    double *least             # of each variable what the stages of a step saw
    double *most
    Programs *programs
    int *indices              # paths, answers and couplings of the closure rows
    int *selected             # independent rows, ascending
    int *envelope             # first coupled row of each of them
    int *support              # which answers the reflectors have something of, as their numbers stand in `columns`
    int *coupled              # of the independent rows: places of earlier ones that fill them, where their couplings stand
    int *taken                # which answers are pivots of reflectors already
    double *measure           # of each answer in an island: 1 of a shift, 1 / length of a turn; 0: in none, or driven
    double *e                 # load that each freedom answers
    double *root              # D^(-1/2) of each answer
    double *spread            # one vector over all answers
    double *columns           # e_r of all rows, one after the other; then the reflectors that make R of them
    double *R                 # R' over the independent rows, the diagonal inverted
    double *J                 # one island's rows of J on its freedoms, scaled
    double *y                 # a number an independent row
    double *own               # 1 - T of the lent inertias, and its Cholesky factor
    BodyAtState *at_state     # what stands at the state whose directions are looked at
    BodyTangent *tangents     # of the bodies, along one direction
    FreedomTangent *freedom_tangents
    double *multipliers       # at the state
    double *slopes            # of the variables of the expressions, along the direction
    int sloping               # some of them are not 0
    double *along             # a direction of the state
