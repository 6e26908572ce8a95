# Made of jacobian.py by headers.py.

from heuncli.kernel.columns cimport put
from heuncli.kernel.scene cimport BodyTangent, Scene
from heuncli.kernel.stepping cimport Tangent
from heuncli.kernel.tangent cimport change_along, stand_at
from heuncli.kernel.tangent_closures cimport row_along
from heuncli.kernel.tangent_motion cimport move_along

cdef void find_jacobian(Scene *scene, double t, double *y, Tangent *tangent) noexcept nogil
cdef void find_motions(Scene *scene, double *y, Py_ssize_t n, double *out) noexcept nogil
