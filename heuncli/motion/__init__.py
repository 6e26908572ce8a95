"""What happens over time, and the linear equations about one state.

Neighbours use: `integration.run` (one run), `integration.check` (a second, finer run and the error that it shows),
`integration.trajectory` (the motion as a function of time), `linearisation` (M, C, K and their derivatives).
"""
