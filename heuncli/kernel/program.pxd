cdef enum:
    CONST, VAR, ADD, SUB, MUL, DIV, POW, NEG, POWER
    SIN, COS, TAN, ASIN, ACOS, ATAN, ATAN2, SINH, COSH, TANH, EXP, LOG, SQRT
    ABS, SIGN, MIN, MAX, STEP, HYPOT
    LT, LE, GT, GE, EQ, NE
    UNLESS, JUMP, TABLE, KNOT

cdef double value(int *code, double *constants, Py_ssize_t start, Py_ssize_t count, double *x, double *stack) noexcept nogil
cdef void jet(int *code, double *constants, Py_ssize_t start, Py_ssize_t count, double t, double *stack, double *out) noexcept nogil
