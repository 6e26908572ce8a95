"""Questions that take many solutions, or another one than a run: a folder or a file an analysis.

A folder has a `study` module that finds the numbers and `results` that hold them; none writes a table. `variants`
solves a scene with other values and `sweep_store` keeps the answers; `find`, `sensitivity`, `tune` and `balancing` use
it. Commands of the same names stand in `app/commands`.
"""
