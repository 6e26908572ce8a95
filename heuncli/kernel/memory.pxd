# Made of memory.py by headers.py.

cdef extern from *:
    """
    #ifndef HEUN_SOURCES
    #define HEUN_SOURCES none
    #endif
    #define HEUN_TEXT_OF(name) #name
    #define HEUN_TEXT(name) HEUN_TEXT_OF(name)
    static const char *given_HEUN_SOURCES = HEUN_TEXT(HEUN_SOURCES);
    """
    const char *HEUN_SOURCES "given_HEUN_SOURCES"

cdef class Memory:
    cdef list kept
    cdef int *ints(self, object numbers)
    cdef double *doubles(self, object numbers)
    cdef double *zeros(self, Py_ssize_t count)
    cdef double **over(self, object numbers, Py_ssize_t rows, Py_ssize_t n)
    cdef double **matrix(self, Py_ssize_t rows, Py_ssize_t n)
    cdef void *rows(self, object table, Py_ssize_t size)
