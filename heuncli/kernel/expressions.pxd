# The structs and functions of expressions.py for the compiled modules beside it; what they mean is said there.

cdef enum:
    CONST, VAR
    ADD, SUB, MUL, DIV, POW, ATAN2, HYPOT, MIN, MAX
    NEG, POWER, ABS, SIGN, STEP
    SIN, COS, TAN, ASIN, ACOS, ATAN
    SINH, COSH, TANH, EXP, LOG, SQRT
    TABLE, KNOT, JUMP, UNLESS
    LT, LE, GT, GE, EQ, NE
    HOLD, INTEGRAL

cdef enum:
    NODES = 8

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

cdef double value(Programs *programs, Program program) noexcept nogil
cdef double compare(int op, double a, double b) noexcept nogil
cdef double piecewise(int op, double a, int n) noexcept nogil
cdef double trigonometric(int op, double a) noexcept nogil
cdef double exponential(int op, double a) noexcept nogil
cdef double power(double x, int n) noexcept nogil
cdef double real_power(double x, double y) noexcept nogil
cdef double length(double a, double b) noexcept nogil
cdef int takes_two(int op) noexcept nogil
cdef double on_branch(Programs *programs, Py_ssize_t at, double branch, double a, double b) noexcept nogil
cdef double angle_on(double branch, double y, double x) noexcept nogil
cdef double side_of_cut(double y) noexcept nogil
cdef Table table_at(Programs *programs, Py_ssize_t at, Py_ssize_t k) noexcept nogil
cdef double in_range(double *c, Table table, double x) noexcept nogil
cdef int piece(double *c, Table table, double x) noexcept nogil
cdef double piece_counted(double *c, Table table, double x) noexcept nogil
cdef Program integrated(Programs *programs, Py_ssize_t at) noexcept nogil
cdef Table summed_at(Programs *programs, Py_ssize_t at, Py_ssize_t k) noexcept nogil
cdef double integral(Programs *programs, Py_ssize_t at, Py_ssize_t k, double t) noexcept nogil

cdef class Expressions:
    cdef Programs programs
    cdef tuple memory
    cdef dict counts
    cdef Py_ssize_t variables
    cdef Py_ssize_t held

cdef size_t where(object memory)
