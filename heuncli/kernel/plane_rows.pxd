# Made of plane_rows.py by headers.py.

from heuncli.kernel.algebra cimport Vec3
from heuncli.kernel.scene cimport DOT, GUIDE, Body, CarriedInPlane, Closure, Freedom, Scene
from libc.math cimport sqrt

cdef Vec3 turned_in_plane(Scene *scene, int body, Vec3 a) noexcept nogil
cdef Vec3 place_in_plane(Scene *scene, int body, Vec3 q) noexcept nogil
cdef CarriedInPlane carried_in_plane(Scene *scene, int body, Vec3 at) noexcept nogil
cdef void measure_in_plane(Scene *scene, Closure *row) noexcept nogil
cdef void guide_in_plane(Scene *scene, Closure *row) noexcept nogil
cdef void dot_in_plane(Scene *scene, Closure *row) noexcept nogil
cdef void rod_in_plane(Scene *scene, Closure *row) noexcept nogil
cdef double demanded_in_plane(Scene *scene, Closure *row) noexcept nogil
cdef void unit_load_in_plane(Scene *scene, Closure *row, int body, double sign) noexcept nogil
cdef void spread_in_plane(Scene *scene, Closure *row) noexcept nogil
cdef void climb_in_plane(Scene *scene, Body *body) noexcept nogil
