"""Structs and signatures of steps.py for C."""

from heuncli.kernel.algebra cimport Vec3, norm
from heuncli.kernel.chosen cimport choose_afresh, put_chosen, take_chosen
from heuncli.kernel.closures cimport slack
from heuncli.kernel.response cimport evaluate, must_choose_anew, settle
from heuncli.kernel.scene cimport Body, Group, Scene
from heuncli.kernel.selection cimport select_independent_rows
from libc.math cimport fabs, pow, sqrt

cdef enum:
    REACHED, MORE, COLLAPSED, NOT_A_NUMBER, CLOSURES_LOST, ROPE_SLACK
    ACCEPTED, AGAIN

cdef struct Method:
    int stages                # evaluations a step; the derivative at its end is one more, and the next step's first
    int extra                 # further stages of the dense output
    int dense_rows            # rows of the interpolating polynomial beside the three that every method has
    int estimates             # rows of the error estimate: the finer, and (2) a coarser one to weigh it by
    double exponent           # 1 / order of the error estimate in h
    int *begin                # of each row: stages, solution, extra stages, estimates (coarser first), dense
    int *stage                # which stages a row combines
    double *coefficient
    double *node

cdef struct Run:
    int n                     # length of the state
    int group_count
    int energy_group          # the group of the drives' work; -1: none
    int following             # 1: the steps are given by `ends` and `settled`, none is judged
    int fresh                 # 1: a piece begins
    int last                  # 1: this step reaches the end of the piece
    int near                  # 1: the stages are settled, too
    int rejected_before       # 1: the last attempt was rejected
    int dodges                # other lengths tried for this step, to keep its stages off a singular pose
    int rope                  # 1 + the row of the rope that would push
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
    double rate               # the scene's largest
    double energy_scale       # sum m size^2
    double error
    double gap                # the largest that closures were left with [m]
    double best               # the least trouble of the lengths tried, and its length
    double best_h
    double pivot_at_start     # of the closures, where the step starts
    Group *groups
    double *weights           # of the components: 1, or 1 / size
    double *y
    double *z                 # the solution tried
    double *carry             # small parts of y that its digits do not hold
    double *z_carry
    double **K                # derivatives at the stages
    double *coarse            # error estimates
    double *fine
    double **dense            # rows of the interpolating polynomial
    double *stage             # a state under way
    double *times
    double **samples
    double *ends              # of the steps done, or of those to be followed
    double *settled           # of each whether it was near
    double *pivots            # of each the least pivot of the closures
    double **passed           # at each end what the next step starts from: put_record

cdef void combine(Method *method, int row, double **K, int n, double *out) noexcept nogil
cdef double clipped(Run *run, double t) noexcept nogil
cdef double step_error(Method *method, Run *run) noexcept nogil
cdef double group_error(Method *method, Run *run, int b) noexcept nogil
cdef double norm_of(Run *run, double *x, int begin, int end) noexcept nogil
cdef double first_step(Scene *scene, Method *method, Run *run) noexcept nogil
cdef double manhattan(Vec3 a) noexcept nogil
cdef double load_rate(Scene *scene, Run *run) noexcept nogil
cdef int begin_piece(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void put_record(Scene *scene, Run *run, double *out) noexcept nogil
cdef void take_record(Scene *scene, Run *run, double *record) noexcept nogil
cdef void propose(Run *run) noexcept nogil
cdef int blocked(Scene *scene, Run *run) noexcept nogil
cdef bint near_singular(Scene *scene, Run *run) noexcept nogil
cdef int attempt(Scene *scene, Method *method, Run *run) noexcept nogil
cdef int rope_slack(Scene *scene, Run *run) noexcept nogil
cdef int judge(Scene *scene, Method *method, Run *run, int trouble) noexcept nogil
cdef int dodge(Scene *scene, Run *run, double error, int trouble) noexcept nogil
cdef double singular_noise(Scene *scene, Run *run) noexcept nogil
cdef void interpolant(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void interpolate(Run *run, int rows, double x, double *out) noexcept nogil
cdef void sample(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void sample_reached(Run *run) noexcept nogil
cdef double growth(Method *method, Run *run) noexcept nogil
cdef int accept(Scene *scene, Method *method, Run *run) noexcept nogil
cdef int land(Scene *scene, Run *run) noexcept nogil
cdef bint jumped(Scene *scene, Run *run) noexcept nogil
cdef int run_steps(Scene *scene, Method *method, Run *run) noexcept nogil
