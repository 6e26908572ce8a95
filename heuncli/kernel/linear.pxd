# Made of linear.py by headers.py.

from libc.math cimport fabs

cdef bint factor_real(double *A, int n, int *pivots) noexcept nogil
cdef int largest_real(double *A, int n, int k) noexcept nogil
cdef void exchange(double *A, int n, int i, int k) noexcept nogil
cdef void solve_real(double *A, int n, int *pivots, double *x) noexcept nogil
cdef void swap(double *x, int *pivots, int n) noexcept nogil
cdef bint factor_complex(double *A, double *B, int n, int *pivots) noexcept nogil
cdef int largest_complex(double *A, double *B, int n, int k) noexcept nogil
cdef void solve_complex(double *A, double *B, int n, int *pivots, double *x, double *y) noexcept nogil
