cdef int evaluate(int *I, double *P, double *W, int *C, double *N, double *X, double *S, double t, double *y, Py_ssize_t o, double *z, Py_ssize_t k) noexcept nogil
cdef double settle(int *I, double *P, double *W, int *C, double *N, double *X, double *S, double t, double *y, Py_ssize_t o) noexcept nogil
cdef int select(int *I, double *P, double *W, int *C, double *N, double *X, double *S, double t, double *y, Py_ssize_t o, int fresh) noexcept nogil
cdef void push_closures(int *I, double *P, double *W) noexcept nogil
cdef int slack(int *I, double *W) noexcept nogil
