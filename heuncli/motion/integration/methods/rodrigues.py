"""DOP853 with attitudes held by Rodrigues' numbers within a step (kernel/attitudes.py).

Global: kappa and its rate, counted from the attitude as drawn: Heun's no. 20, in Lagrange's form. Re-centred: kappa
from the start of each step, and the angular velocity.

How far a step may turn is bounded by the chart and not by the tolerance: of what turns fast a finer run takes the same
steps and errs alike. So the check run goes by quaternions.
"""

from __future__ import annotations

from heuncli.base.records import replace
from heuncli.motion.integration.methods.dop853 import DOP853
from heuncli.motion.integration.methods.method import GLOBAL, RECENTRED

DOP853_GLOBAL = replace(DOP853, name="DOP853-rodrigues", attitude=GLOBAL, check=DOP853)
DOP853_RECENTRED = replace(DOP853, name="DOP853-recentred", attitude=RECENTRED, check=DOP853)
