# Made of tangent_motion.py by headers.py.

from heuncli.kernel.algebra cimport Vec3, add, add_cross, add_scaled, cross, rotate, scaled, sub, transform
from heuncli.kernel.scene cimport SHIFT, TURN_IN_BODY, TURN_IN_PARENT, Body, BodyAtState, BodyTangent, Freedom, FreedomTangent, PointMotion, Scene, Variable

cdef void move_along(Scene *scene, double *y, double *along) noexcept nogil
cdef void coordinates_along(Scene *scene, double *along) noexcept nogil
cdef bint is_moved(Scene *scene, Body *body, double *along) noexcept nogil
cdef void stand(BodyTangent *d) noexcept nogil
cdef void hang_along(Scene *scene, Body *body, BodyTangent *d) noexcept nogil
cdef Vec3 sliding(Scene *scene, Body *body) noexcept nogil
cdef void shift_along(Scene *scene, Body *body, BodyTangent *d) noexcept nogil
cdef void orient_along(Scene *scene, Body *body, BodyTangent *d) noexcept nogil
cdef void turn_along(Freedom *freedom, FreedomTangent *own, BodyTangent *d) noexcept nogil
cdef void ball_along(Body *body, BodyTangent *d, double *y, double *along) noexcept nogil
cdef void resist_along(Body *body, BodyAtState *at, BodyTangent *d) noexcept nogil
cdef Vec3 swung(Scene *scene, int body, Vec3 a) noexcept nogil
cdef Vec3 omega_along(Scene *scene, int body) noexcept nogil
cdef PointMotion point_along(Scene *scene, int body, Vec3 q) noexcept nogil
