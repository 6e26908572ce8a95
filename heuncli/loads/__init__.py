"""What the mechanism carries in a known motion, and the poses in which its loads balance.

Neighbours use: `kinetostatics` (reactions in joints and on the foundation, section forces, stresses, energy),
`redundancy` (which components are indeterminate, which sums are determinate), `equilibrium` (rest poses).
"""
