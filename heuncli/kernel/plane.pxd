# Made of plane.py by headers.py.

from heuncli.kernel.algebra cimport Mat3, Sym3, Vec3
from heuncli.kernel.scene cimport SHIFT, Body, Freedom, Scene
from libc.math cimport cos, sin

cdef void move_in_plane(Scene *scene) noexcept nogil
cdef void hang_in_plane(Scene *scene, Body *body) noexcept nogil
cdef void turn_in_plane(Scene *scene, Body *body) noexcept nogil
cdef int factor_in_plane(Scene *scene) noexcept nogil
cdef int give_way_to_turn(Body *body, Freedom *freedom, double least) noexcept nogil
cdef int give_way_to_shift(Body *body, Freedom *freedom, double least) noexcept nogil
cdef void add_branch_in_plane(Body *parent, Body *body) noexcept nogil
cdef void load_in_plane(Scene *scene, bint inertial) noexcept nogil
cdef void load_all_in_plane(Scene *scene) noexcept nogil
cdef double turning_load(Body *body, double alpha, double x, double y) noexcept nogil
cdef void add_zeros_in_plane(Scene *scene) noexcept nogil
cdef void upward_in_plane(Scene *scene, bint inertial) noexcept nogil
cdef void downward_in_plane(Scene *scene, bint inertial) noexcept nogil
cdef void balance_in_plane(Scene *scene, bint inertial) noexcept nogil
