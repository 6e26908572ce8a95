"""DOP853 with attitudes represented by Rodrigues parameters within a step (kernel/attitudes.py).

Global: kappa and its rate, counted from the attitude as drawn: Heun's no. 20, in Lagrange's form. Re-centred: kappa
from the start of each step, and the angular velocity.

The chart, not the tolerance, bounds the rotation in a step: for fast rotations a finer run takes the same steps and has
the same error. So the check run uses quaternions.
"""

from __future__ import annotations

from heuncli.base.records import replace
from heuncli.motion.integration.methods.dop853 import DOP853
from heuncli.motion.integration.methods.method import GLOBAL, RECENTRED

DOP853_GLOBAL = replace(DOP853, name="DOP853-rodrigues", attitude=GLOBAL, check=DOP853)
DOP853_RECENTRED = replace(DOP853, name="DOP853-recentred", attitude=RECENTRED, check=DOP853)
