# Made of tangent_loads.py by headers.py.

from heuncli.kernel.algebra cimport Vec3, add, add_cross, add_scaled, cross, dot, norm, scaled, sub
from heuncli.kernel.jets cimport slope
from heuncli.kernel.loads cimport omega_of, sliding_in
from heuncli.kernel.scene cimport ACTUATOR, COUPLE, FORCE, SHIFT_DAMPER, SHIFT_FRICTION, SPRING, THRUST, TURN_FRICTION, TURN_SPRING, Body, BodyTangent, Load, LoadTangent, PointMotion, Scene
from heuncli.kernel.tangent_motion cimport omega_along, point_along, swung
from heuncli.kernel.tree cimport direction_of, point_of
from libc.math cimport NAN, tanh

cdef double loads_along(Scene *scene) noexcept nogil
cdef Vec3 given_along(Scene *scene, Load *load) noexcept nogil
cdef void push_along(Scene *scene, int body, Vec3 at, Vec3 force, LoadTangent d) noexcept nogil
cdef LoadTangent opposite(LoadTangent d) noexcept nogil
cdef double outer_along(Scene *scene, Load *load, Vec3 given, PointMotion there) noexcept nogil
cdef double pair_along(Scene *scene, Load *load, double given, PointMotion there) noexcept nogil
cdef double joint_along(Scene *scene, Load *load, double given, PointMotion there) noexcept nogil
cdef Vec3 sliding_along(Scene *scene, Load *load, PointMotion there) noexcept nogil
cdef double angle_along(Scene *scene, Load *load) noexcept nogil
cdef double resistance(Load *load, double speed) noexcept nogil
cdef double resistance_along(Load *load, double speed) noexcept nogil
