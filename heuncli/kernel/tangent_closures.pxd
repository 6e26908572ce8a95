# Made of tangent_closures.py by headers.py.

from heuncli.kernel.algebra cimport Vec3, add, add_cross, add_scaled, centripetal, cross, dot, norm, scaled, sub
from heuncli.kernel.closures cimport carried, place_of
from heuncli.kernel.loads cimport omega_of
from heuncli.kernel.scene cimport DOT, GUIDE, TURN, Body, BodyAtState, BodyTangent, Closure, LoadTangent, MotionTangent, RowTangent, Scene
from heuncli.kernel.tangent_loads cimport opposite, push_along
from heuncli.kernel.tangent_motion cimport omega_along, point_along, swung
from heuncli.kernel.tree cimport direction_of

cdef void closures_along(Scene *scene) noexcept nogil
cdef RowTangent row_along(Scene *scene, Closure *row) noexcept nogil
cdef Vec3 acceleration_at(Scene *scene, int body, Vec3 x) noexcept nogil
cdef MotionTangent carried_along(Scene *scene, int body, Vec3 x, Vec3 change) noexcept nogil
cdef RowTangent guide_along(Scene *scene, Closure *row, Vec3 Q) noexcept nogil
cdef RowTangent rod_along(Scene *scene, Closure *row, Vec3 Q) noexcept nogil
cdef RowTangent dot_along(Scene *scene, Closure *row, Vec3 Q) noexcept nogil
cdef RowTangent turn_row_along(Scene *scene, Closure *row, Vec3 Q) noexcept nogil
cdef Vec3 alpha_at(Scene *scene, int body) noexcept nogil
cdef Vec3 alpha_along(Scene *scene, int body) noexcept nogil
