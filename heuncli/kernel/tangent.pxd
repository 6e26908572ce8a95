# Made of tangent.py by headers.py.

from heuncli.kernel.algebra cimport Quaternion, Vec3, add, add_cross, add_scaled, cross, dot, quaternion_rate, rotate_back, scaled, sub, turned
from heuncli.kernel.closures cimport push_closures
from heuncli.kernel.loads cimport omega_of
from heuncli.kernel.orthogonal cimport solve_closures
from heuncli.kernel.response cimport evaluate, find_taken
from heuncli.kernel.scene cimport SHIFT, Body, BodyAtState, BodyTangent, Closure, Counter, Freedom, FreedomTangent, Lent, Scene
from heuncli.kernel.tangent_closures cimport closures_along
from heuncli.kernel.tangent_loads cimport loads_along
from heuncli.kernel.tangent_motion cimport move_along, omega_along, swung
from heuncli.kernel.tree cimport balance, direction_of, downward, load_along, push_lent

cdef int stand_at(Scene *scene, double t, double *y, double *dy) noexcept nogil
cdef bint is_kept(Scene *scene, int j) noexcept nogil
cdef void change_along(Scene *scene, double *y, double *along, double *out) noexcept nogil
cdef void keep_along(Scene *scene) noexcept nogil
cdef void branches_along(Scene *scene) noexcept nogil
cdef void respond_along(Scene *scene) noexcept nogil
cdef void answer_along(Scene *scene) noexcept nogil
cdef void upward_along(Scene *scene) noexcept nogil
cdef double answered_along(Body *body, Freedom *freedom, double load) noexcept nogil
cdef double drives_along(Scene *scene) noexcept nogil
cdef void rates_along(Scene *scene, double *y, double *along, double *out) noexcept nogil
