"""Structs and signatures of dense.py for C."""

from heuncli.kernel.attitudes cimport chart_slopes, leave_chart, nearing
from heuncli.kernel.jacobian cimport Tangent
from heuncli.kernel.response cimport evaluate, settle
from heuncli.kernel.scene cimport Freedom, Group, Scene

cdef enum:                    # what a step tried comes to
    STANDS, AGAIN_TO, TURNS_OVER, CHATTERS

cdef enum:
    MOST_LANDINGS = 6         # on one event: each finds its place to the square of the error of the one before

cdef struct Collocation:      # an implicit method: its stages Z = T W, A^-1 = T L T^-1
    int stages
    int pair_count            # pairs of L
    double real               # number of L; 0: it has none
    double *parts             # real and imaginary part of each pair
    double *into              # T^-1 by rows
    double *back              # T by rows
    double *end               # what of the stages makes the end of a step
    double *error             # what of them makes the estimate

cdef struct Factors:          # of a dense matrix A + i B, by rows
    double *A
    double *B
    int *pivots

cdef struct Newton:           # the iteration for the stages of a step
    int solved                # 1: there are stages
    int elsewhere             # 1: the last that was evaluated is not the end of the step
    double reach              # the largest coordinate
    double rate               # and rate, by which corrections are measured
    Tangent tangent           # at the start of the step
    Factors real              # of L - h J
    Factors pairs[2]
    double **Z                # of each stage what its state is beyond the start
    double **known            # the same from 1 on, then the first rows of the interpolating polynomial
    double **W
    double **step             # a correction of W
    double *error

cdef struct Method:
    int stages                # evaluations a step; the derivative at its end is one more, and the next step's first
    int extra                 # further stages of the dense output
    int dense_rows            # rows of the interpolating polynomial beside the three that every method has
    int estimates             # rows of the error estimate: the finer, and (2) a coarser one to weigh it by
    int fixed                 # 1: the steps are given (Run.step), none is judged
    int by_step               # 1: an asked instant within a step is reached by a step of its own from the step's start
    int implicit              # 1: the stages are solved for (collocation.py)
    int attitude              # held within a step: 0 quaternion, 1 Rodrigues' parameters, 2 the same from the step's start
    double exponent           # 1 / order of the error estimate in h
    int *begin                # of each row: stages, solution, extra stages, estimates (coarser first), dense
    int *stage                # which stages a row combines
    double *coefficient
    double *node
    Collocation collocation   # of an implicit one

cdef struct Course:           # of the coordinates over a stretch of time, for the expressions that hang on them
    int degree                # of their polynomials
    int late                  # 1: events are where they are certain, not where margins are zero
    int slot                  # a branch that turns
    int undecided             # 1: bounds left open whether all values were seen
    double begin              # the instant of x = 0
    double length             # from there to x = 1
    double latest             # the last instant that counts
    double finest             # part of it down to which events are told apart
    double event              # x of the event
    double crossed_by         # an end of a part by which branches have turned ...
    double crossing           # ... and where, somewhere before it
    double **value            # of each variable its coefficients in Bernstein's form over the stretch
    double **rate             # and those of its rate, and of the rate of that
    double **second
    double *work
    double *begins            # of the parts to be looked at
    double *ends
    double *promise           # and what they may hold
    double *before            # branches put aside
    double *turned            # branches behind the event
    double *resting           # 1: a branch whose margin rests at zero, which is passed over ...
    double rests_from         # ... between these x
    double rests_to

cdef struct Branch:           # of a motion that its drives determine, at the start of the step under way
    double length             # by which shifts are measured
    double pivot              # least of what is left of an independent row
    double moved              # the most that any coordinate moves in the step
    double energy             # kinetic and potential
    double *reach             # of each freedom, then each closure row: how far a unit of its drive moves any; -1: none
    double *marks             # of each counted angle a direction across its axis, in b

cdef struct Run:
    int n                     # length of the state
    int group_count
    int energy_group          # the group of the drives' work; -1: none
    int determined            # 1: nothing is integrated, the closures tell where everything is
    int following             # 1: the steps are given by `ends` and `settled`, none is judged
    int fresh                 # 1: a piece begins
    int last                  # 1: this step reaches the end of the piece
    int near                  # 1: the stages are settled, too
    int rejected_before       # 1: the last attempt was rejected
    int dodges                # other lengths tried for this step, to keep its stages off a singular pose
    int contact               # 1 + the one-sided row that closes or opens
    int watching              # 1: contacts are watched
    int halting               # 1: the loop is left where a piece begins and where branches turn
    int late                  # 1: events are met late by the rounding of an instant, to see what that makes
    int seeing                # 1: stages are looked at for events
    int has_cut               # 1: the step under way ends at `cut`
    int has_interpolant       # 1: the dense output of the step tried is there
    int landings              # attempts to end this step on an event
    int contact_landings      # the same where a contact closes or opens
    int turns                 # 1: branches turn at the end of the step under way
    int at_once               # turns of branches since the time went on
    int flurry                # events since flurry_begin
    int stiff_after           # steps held short by stability after which the loop is left; 0: not looked at
    int easy_after            # steps on end that were not, after which their count begins anew
    int look_after            # steps after which it is left in any case, twice as many the next time; 0: never
    int stiff_steps           # the counts
    int easy_steps
    int half_turn             # 1 + the body whose attitude has come to the end of its chart
    int undecided             # steps of which bounds could not decide what they hold
    int on_grid               # given steps done since `grid`
    int steps
    int evaluations
    int rejected
    int most                  # steps of one call
    int done                  # of them
    int next_sample
    int sample_count
    double t
    double h                  # of the step under way
    double proposed
    double stop               # where the step under way ends
    double before_end         # the last instant at which the piece's expressions hold
    double end
    double tolerance
    double step               # the step of a method of fixed step; 0: adaptive
    double grid               # the instant from which given steps are counted
    double stable             # h |lambda| from which a step counts as held short by stability
    double swiftness          # that of the step tried
    double rate               # the scene's largest
    double energy_scale       # sum m size^2
    double error
    double nearing            # largest angular velocity that a stage saw, by the way to the chart's end [1/s]
    double gap                # the largest that closures were left with [m]
    double best               # the least trouble of the lengths tried, and its length
    double best_h
    double pivot_at_start     # of the closures, where the step starts
    double cut
    double flurry_begin
    Course course
    Branch branch
    Newton newton
    Group *groups
    double *weights           # of the components: 1, or 1 / size
    double *y
    double *z                 # the solution tried
    double *carry             # small parts of y that its digits do not hold
    double *z_carry
    double **K                # derivatives at the stages
    double **beside           # the same of steps to asked instants within the step under way
    double *coarse            # error estimates
    double *fine
    double **dense            # rows of the interpolating polynomial
    double *stage             # a state under way
    double *chart_y           # y, z and K in the numbers that steps are taken in: the same, or those of a chart of attitudes
    double *chart_z
    double **chart_K
    double *ways              # of each body, how far its attitude may turn before it leaves the chart [rad]
    double *times
    double **samples
    double *ends              # of the steps done, or of those to be followed
    double *settled           # of each whether it was near
    double *pivots            # of each the least pivot of the closures
    double *turned            # of each whether branches turned at its end
    double **branches         # of each the branches that were held
    double **passed           # at each end what the next step starts from: put_record

cdef void combine(Method *method, int row, double **K, int n, double *out) noexcept nogil
cdef double clipped(Run *run, double t) noexcept nogil
cdef int evaluate_stage(Scene *scene, Method *method, Run *run, int s, bint near) noexcept nogil
cdef void enter_slopes(Scene *scene, Method *method, Run *run, double *state, int s) noexcept nogil
cdef void hermite(Method *method, Run *run) noexcept nogil
cdef void quintic(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void interpolant(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void through_stages(Method *method, Run *run) noexcept nogil
cdef void need_interpolant(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void interpolate(Scene *scene, Method *method, Run *run, double x, double *out) noexcept nogil
