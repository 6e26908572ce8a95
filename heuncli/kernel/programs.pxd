# Made of programs.py by headers.py.

cdef struct Instruction:
    int op
    int argument
cdef struct Program:
    int start
    int count
cdef struct Jet:
    double value
    double rate
    double second
cdef struct Table:
    int pieces
    int outside
    double period
    Py_ssize_t knots
    Py_ssize_t coefficients
cdef struct Bounds:
    double low
    double high
cdef struct Span:
    Bounds value
    Bounds rate
    Bounds second
cdef struct Programs:
    Instruction *code
    double *constants
    double **tables
    double *variables
    double *stack
    Jet *jets
    double *held
    int holding
    int *doubt
    Span *ranges
    Span *middles
    Span *spans
