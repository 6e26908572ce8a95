"""A scene as a tree of bodies, assembled, and reduced to the smallest one of the same motion.

Neighbours use: `mechanism.model.Mechanism` (arrays of a scene), `tree.prepare` (the spanning tree and what the kernel
needs), `assembly` and `coupled_start` (a start that closes all joints), `reduction` (smaller scenes), `response` (the
linear map from loads to accelerations), `stages` (steps of a set-up, kept for variants).
"""
