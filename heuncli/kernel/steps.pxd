# Made of steps.py by headers.py.

from heuncli.kernel.algebra cimport Vec3, norm
from heuncli.kernel.attitudes cimport at_half_turn, drop_small_parts, enter_chart, leave_chart, measure_ways, nearing
from heuncli.kernel.chosen cimport choose_afresh, put_chosen, take_chosen
from heuncli.kernel.collocation cimport collocate, collocate_to
from heuncli.kernel.contacts cimport opened_by_others, pushed_at_once, start_contacts, turned_over
from heuncli.kernel.dense cimport AGAIN_TO, CHATTERS, STANDS, TURNS_OVER, clipped, combine, enter_slopes, interpolate, need_interpolant
from heuncli.kernel.events cimport follow_angles, take_branches
from heuncli.kernel.expressions cimport HELD, TAKEN, value
from heuncli.kernel.following cimport find_between, follow, is_determined, stand_here
from heuncli.kernel.judging cimport ACCEPTED, AGAIN, CHATTERING, CLOSURES_LOST, COLLAPSED, HALF_TURN, LET_GO, MORE, NOT_A_NUMBER, REACHED, ROPE_SLACK, STIFF, STRUCK, TURNED, UNSOLVED, growth, judge, norm_of
from heuncli.kernel.landing cimport begin_to_see, in_flurry, meet, see_stage
from heuncli.kernel.response cimport evaluate, evaluate_settled, must_choose_anew, settle, settle_evaluated
from heuncli.kernel.scene cimport Body, Group, Scene
from heuncli.kernel.selection cimport select_independent_rows
from heuncli.kernel.stages cimport step_to, take_stages
from heuncli.kernel.stepping cimport Method, Run
from heuncli.kernel.stiffness cimport estimate_swiftness, is_held_short
from heuncli.kernel.tree cimport coordinates
from libc.math cimport fabs, pow, sqrt

cdef int begin_piece(Scene *scene, Method *method, Run *run) noexcept nogil
cdef double first_step(Scene *scene, Method *method, Run *run) noexcept nogil
cdef double load_rate(Scene *scene, Run *run) noexcept nogil
cdef double manhattan(Vec3 a) noexcept nogil
cdef void put_record(Scene *scene, Run *run, double *out) noexcept nogil
cdef void take_record(Scene *scene, Run *run, double *record) noexcept nogil
cdef void propose(Scene *scene, Run *run) noexcept nogil
cdef int blocked(Scene *scene, Run *run) noexcept nogil
cdef bint near_singular(Scene *scene, Run *run) noexcept nogil
cdef int attempt(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void enter(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void leave(Scene *scene, Method *method, Run *run) noexcept nogil
cdef bint leaves_chart(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void sample(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void sample_by_steps(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void sample_reached(Run *run) noexcept nogil
cdef int accept(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void keep_rates(Run *run) noexcept nogil
cdef void propose_next(Method *method, Run *run) noexcept nogil
cdef void put_down(Scene *scene, Run *run) noexcept nogil
cdef bint turn_branches(Scene *scene, Run *run) noexcept nogil
cdef int land(Scene *scene, Run *run) noexcept nogil
cdef bint stands_at_end(Scene *scene, Run *run) noexcept nogil
cdef bint jumped(Scene *scene, Run *run) noexcept nogil
cdef int verdict(Scene *scene, Run *run) noexcept nogil
cdef int try_step(Scene *scene, Method *method, Run *run) noexcept nogil
cdef int leave_for(Scene *scene, Run *run, int met) noexcept nogil
cdef int run_steps(Scene *scene, Method *method, Run *run) noexcept nogil
