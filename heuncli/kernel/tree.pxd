cdef void kinematics(int *I, double *P, double *W, int *C, double *N, double *X, double *S, double t, double *y, Py_ssize_t o) noexcept nogil
cdef double loads(int *I, double *P, double *W, int *C, double *N, double *X, double *S) noexcept nogil
cdef int factor(int *I, double *P, double *W) noexcept nogil
cdef void upward(int *I, double *P, double *W) noexcept nogil
cdef void downward(int *I, double *P, double *W, int bias) noexcept nogil
cdef void derivative(int *I, double *W, double *y, Py_ssize_t o, double *z, Py_ssize_t k, double power) noexcept nogil
cdef void balance(int *I, double *P, double *W) noexcept nogil
cdef void push(int *I, double *W, Py_ssize_t b, Py_ssize_t X, Py_ssize_t F, Py_ssize_t M, double sign) noexcept nogil
