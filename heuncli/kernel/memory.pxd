"""Signatures of memory.py for C."""

cdef class Memory:
    cdef list kept
    cdef int *ints(self, object numbers) except NULL
    cdef double *doubles(self, object numbers) except NULL
    cdef double *zeros(self, Py_ssize_t count) except NULL
    cdef double **over(self, object numbers, Py_ssize_t rows, Py_ssize_t n) except NULL
    cdef double **matrix(self, Py_ssize_t rows, Py_ssize_t n) except NULL
    cdef void *rows(self, object table, Py_ssize_t size) except NULL

cdef extern from *:  # heuncli/build.py gives it
    """
    #ifndef HEUN_SOURCES
    #define HEUN_SOURCES none
    #endif
    #define HEUN_TEXT_OF(name) #name
    #define HEUN_TEXT(name) HEUN_TEXT_OF(name)
    static const char *heun_sources = HEUN_TEXT(HEUN_SOURCES);
    """
    const char *HEUN_SOURCES "heun_sources"
