# Made of following.py by headers.py.

from heuncli.kernel.algebra cimport Quaternion, Vec3, add_scaled, cross, dot, norm, rotate_back, scaled, slightly_turned, sub, transform
from heuncli.kernel.closures cimport place_of
from heuncli.kernel.columns cimport apply_none, prescribe, stand_still
from heuncli.kernel.course cimport set_time
from heuncli.kernel.dense cimport clipped, interpolate, need_interpolant
from heuncli.kernel.enclosure cimport enclose
from heuncli.kernel.events cimport see
from heuncli.kernel.jets cimport jet
from heuncli.kernel.landing cimport begin_to_see, see_stage
from heuncli.kernel.loads cimport turned_by
from heuncli.kernel.programs cimport Bounds, Jet, Program
from heuncli.kernel.response cimport evaluate, respond, settle
from heuncli.kernel.scene cimport SHIFT, SPRING, TURN_SPRING, Body, Counter, Freedom, Load, Scene
from heuncli.kernel.selection cimport order_all
from heuncli.kernel.stepping cimport Branch, Method, Run
from heuncli.kernel.tree cimport coordinates, direction_of, kinematics
from libc.math cimport INFINITY, atan2, fabs, sqrt

cdef enum:
    LOOKED_AT = 2

cdef bint is_determined(Scene *scene) noexcept nogil
cdef void stand_here(Scene *scene, Run *run) noexcept nogil
cdef void measure_reach(Scene *scene, Branch *branch) noexcept nogil
cdef double farthest(Scene *scene, Branch *branch, double found) noexcept nogil
cdef double moved_by_drives(Scene *scene, Run *run) noexcept nogil
cdef bint bends_between(Scene *scene, Run *run) noexcept nogil
cdef bint bends(Scene *scene, Run *run, Program program) noexcept nogil
cdef double room(Scene *scene, Run *run) noexcept nogil
cdef int follow(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void shorten_to(Run *run, double part) noexcept nogil
cdef void predict(Scene *scene, Run *run) noexcept nogil
cdef bint left_branch(Scene *scene, Run *run, double gap) noexcept nogil
cdef void carry_on(Scene *scene, Run *run, double *x) noexcept nogil
cdef Vec3 across(Vec3 n) noexcept nogil
cdef Vec3 seen_from(Scene *scene, int body, Vec3 a) noexcept nogil
cdef double mechanical_energy(Scene *scene) noexcept nogil
cdef void see_between(Scene *scene, Method *method, Run *run) noexcept nogil
cdef void find_between(Scene *scene, Run *run, double *x) noexcept nogil
