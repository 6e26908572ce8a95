# Made of tree.py by headers.py.

from heuncli.kernel.algebra cimport Mat3, Quaternion, Vec3, add, add_both, add_cross, add_matrix, add_scaled, add_symmetric, add_transformed, attitude, both_levers, cross, dot, factor, lever, lever_rows, multiple_of_unit, product, quaternion_rate, rotate, rotate_back, rotation, scaled, skew, solve, solve_columns, sub, sub_dyad, sub_product, sub_square, trace, transform, turned, unit_matrix
from heuncli.kernel.jets cimport jet
from heuncli.kernel.plane cimport add_zeros_in_plane, balance_in_plane, downward_in_plane, factor_in_plane, load_all_in_plane, load_in_plane, move_in_plane, upward_in_plane
from heuncli.kernel.programs cimport Jet
from heuncli.kernel.scene cimport SHIFT, TURN_IN_BODY, TURN_IN_PARENT, Body, Freedom, Lent, PointMotion, Scene, Variable

cdef void coordinates(Scene *scene, double t, double *y) noexcept nogil
cdef void kinematics(Scene *scene, double t, double *y) noexcept nogil
cdef void hang(Scene *scene, Body *body) noexcept nogil
cdef void orient(Scene *scene, Body *body) noexcept nogil
cdef void turn(Body *body, Freedom *freedom) noexcept nogil
cdef void velocity_terms(Body *body) noexcept nogil
cdef Vec3 direction_of(Scene *scene, int body, Vec3 a) noexcept nogil
cdef PointMotion point_of(Scene *scene, int body, Vec3 q) noexcept nogil
cdef void push(Scene *scene, int body, Vec3 at, Vec3 force, Vec3 moment) noexcept nogil
cdef int factor_tree(Scene *scene) noexcept nogil
cdef void lend(Scene *scene, Lent *lent) noexcept nogil
cdef int eliminate_ball(Body *body, double least) noexcept nogil
cdef int eliminate(Body *body, Freedom *freedom, double least) noexcept nogil
cdef double load_along(Freedom *freedom, Vec3 M, Vec3 f) noexcept nogil
cdef void add_branch(Body *parent, Body *body) noexcept nogil
cdef void put_loads(Scene *scene, bint inertial) noexcept nogil
cdef void put_all_loads(Scene *scene) noexcept nogil
cdef void add_zeros(Scene *scene) noexcept nogil
cdef void push_lent(Scene *scene, Lent *lent) noexcept nogil
cdef void upward(Scene *scene, bint inertial) noexcept nogil
cdef double answered(Body *body, Freedom *freedom) noexcept nogil
cdef void pass_up(Body *parent, Body *body, bint inertial) noexcept nogil
cdef void downward(Scene *scene, bint inertial) noexcept nogil
cdef void derivative(Scene *scene, double *y, double *dy, double power) noexcept nogil
cdef void balance(Scene *scene, bint inertial) noexcept nogil
cdef void newton_euler(Body *body, bint inertial) noexcept nogil
