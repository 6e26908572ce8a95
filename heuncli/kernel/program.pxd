cdef enum:
    CONST, VAR
    ADD, SUB, MUL, DIV, POW, ATAN2, HYPOT, MIN, MAX
    NEG, POWER, ABS, SIGN, STEP
    SIN, COS, TAN, ASIN, ACOS, ATAN
    SINH, COSH, TANH, EXP, LOG, SQRT
    TABLE, KNOT, JUMP, UNLESS
    LT, LE, GT, GE, EQ, NE

cdef double value(int *code, double *constants, Py_ssize_t start, Py_ssize_t count, double *x, double *stack) noexcept nogil
cdef void jet(int *code, double *constants, Py_ssize_t start, Py_ssize_t count, double t, double *stack, double *out) noexcept nogil
