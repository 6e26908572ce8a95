# Made of loads.py by headers.py.

from heuncli.kernel.algebra cimport Vec3, cross, dot, norm, scaled, sub
from heuncli.kernel.expressions cimport value
from heuncli.kernel.scene cimport ACTUATOR, COUPLE, FORCE, SHIFT_DAMPER, SHIFT_FRICTION, SPRING, THRUST, TURN_FRICTION, TURN_SPRING, Body, Counter, Load, PointMotion, Scene
from heuncli.kernel.tree cimport direction_of, point_of, push
from libc.math cimport atan2, tanh

cdef double apply_loads(Scene *scene) noexcept nogil
cdef Vec3 given_vector(Scene *scene, Load *load) noexcept nogil
cdef void outer_load(Scene *scene, Load *load, Vec3 given, Vec3 v) noexcept nogil
cdef double pair_load(Scene *scene, Load *load, Vec3 given, Vec3 v) noexcept nogil
cdef double joint_load(Scene *scene, Load *load, Vec3 given, Vec3 v) noexcept nogil
cdef double turned_by(Scene *scene, Load *load) noexcept nogil
cdef Vec3 sliding_in(Scene *scene, Load *load, Vec3 v) noexcept nogil
cdef Vec3 omega_of(Scene *scene, int body) noexcept nogil
