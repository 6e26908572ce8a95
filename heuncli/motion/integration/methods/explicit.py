"""Explicit methods of lower order: of fixed step Euler's, Heun's two and the classical one, and an adaptive pair.

Between the ends of a fixed step the cubic through both ends is used: its error h^4 is of no lower order than theirs.
"""

from __future__ import annotations

from heuncli.motion.integration.methods.method import Method

# Euler, Institutiones calculi integralis I (1768), II.7: along the slope at the start.
EULER = Method(name="Euler", order=1, has_fixed_step=True, nodes=(0.0,), stages=(), solution=((0, 1.0),))

# Heun, Zeitschrift fuer Mathematik und Physik 45 (1900) 23-38: the mean of the slopes at both ends.
HEUN2 = Method(
    name="Heun2", order=2, has_fixed_step=True, nodes=(0.0, 1.0), stages=(((0, 1.0),),), solution=((0, 0.5), (1, 0.5))
)

# There, too: third order from two slopes that count, at 0 and 2/3 (Hairer, Norsett, Wanner, Solving ODEs I, II.1).
HEUN3 = Method(
    name="Heun3",
    order=3,
    has_fixed_step=True,
    nodes=(0.0, 1 / 3, 2 / 3),
    stages=(((0, 1 / 3),), ((1, 2 / 3),)),
    solution=((0, 1 / 4), (2, 3 / 4)),
)

# Kutta, Zeitschrift fuer Mathematik und Physik 46 (1901) 435-453.
RK4 = Method(
    name="RK4",
    order=4,
    has_fixed_step=True,
    nodes=(0.0, 0.5, 0.5, 1.0),
    stages=(((0, 0.5),), ((1, 0.5),), ((2, 1.0),)),
    solution=((0, 1 / 6), (1, 1 / 3), (2, 1 / 3), (3, 1 / 6)),
)

# Dormand and Prince, J. Comp. Appl. Math. 6 (1980) 19-26; dense output of order 4: Hairer, Norsett, Wanner, II.6.
DOPRI5 = Method(
    name="DOPRI5",
    stable=3.31,
    sample_fractions=(0.3, 0.75),
    order=5,
    nodes=(0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0),
    stages=(
        ((0, 1 / 5),),
        ((0, 3 / 40), (1, 9 / 40)),
        ((0, 44 / 45), (1, -56 / 15), (2, 32 / 9)),
        ((0, 19372 / 6561), (1, -25360 / 2187), (2, 64448 / 6561), (3, -212 / 729)),
        ((0, 9017 / 3168), (1, -355 / 33), (2, 46732 / 5247), (3, 49 / 176), (4, -5103 / 18656)),
    ),
    solution=((0, 35 / 384), (2, 500 / 1113), (3, 125 / 192), (4, -2187 / 6784), (5, 11 / 84)),
    estimates=(((0, 71 / 57600), (2, -71 / 16695), (3, 71 / 1920), (4, -17253 / 339200), (5, 22 / 525), (6, -1 / 40)),),
    error_order=5,
    dense=(
        (
            (0, -12715105075 / 11282082432),
            (2, 87487479700 / 32700410799),
            (3, -10690763975 / 1880347072),
            (4, 701980252875 / 199316789632),
            (5, -1453857185 / 822651844),
            (6, 69997945 / 29380423),
        ),
    ),
)
