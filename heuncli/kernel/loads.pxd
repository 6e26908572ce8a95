"""Signatures of loads.py for C."""

from heuncli.kernel.algebra cimport Vec3, cross, dot, norm, scaled, sub
from heuncli.kernel.expressions cimport value
from heuncli.kernel.scene cimport (
    ACTUATOR, Body, COUPLE, FORCE, Load, SHIFT_DAMPER, SHIFT_FRICTION, SPRING, Scene, THRUST, TURN_FRICTION,
)
from heuncli.kernel.tree cimport PointMotion, direction_of, point_of, push
from libc.math cimport tanh

cdef double apply_loads(Scene *scene) noexcept nogil
cdef Vec3 given_vector(Scene *scene, Load *load) noexcept nogil
cdef void outer_load(Scene *scene, Load *load, Vec3 given, Vec3 v) noexcept nogil
cdef double pair_load(Scene *scene, Load *load, Vec3 given, Vec3 v) noexcept nogil
cdef void joint_load(Scene *scene, Load *load, Vec3 given, Vec3 v) noexcept nogil
cdef Vec3 sliding_in(Scene *scene, Load *load, Vec3 v) noexcept nogil
cdef Vec3 omega_of(Scene *scene, int body) noexcept nogil
