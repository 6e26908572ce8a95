# The structs and functions of expressions.py for the compiled modules beside it; what they mean is said there.

cdef enum:
    CONST, VAR
    ADD, SUB, MUL, DIV, POW, ATAN2, HYPOT, MIN, MAX
    NEG, POWER, ABS, SIGN, STEP
    SIN, COS, TAN, ASIN, ACOS, ATAN
    SINH, COSH, TANH, EXP, LOG, SQRT
    TABLE, KNOT, JUMP, UNLESS
    LT, LE, GT, GE, EQ, NE
    HOLD

cdef enum:
    FREE, HELD, TAKEN

cdef enum:
    REFUSED, EXTENDED, PERIODIC

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

cdef struct Programs:
    Instruction *code
    double *constants
    double *variables
    double *stack
    Jet *jets
    double *held
    int holding

cdef double value(Programs *programs, Program program) noexcept nogil
cdef Jet jet(Programs *programs, Program program, double t) noexcept nogil

cdef class Expressions:
    cdef Programs programs
    cdef tuple memory
    cdef Py_ssize_t instructions
    cdef Py_ssize_t variables
    cdef Py_ssize_t held
