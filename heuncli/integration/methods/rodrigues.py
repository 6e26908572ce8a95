"""DOP853 with attitudes held by Rodrigues' numbers within a step (kernel/attitudes.py).

Global: kappa and its rate, counted from the attitude as drawn: Heun's no. 20, in Lagrange's form. Re-centred: kappa
from the start of each step, and the angular velocity.
"""

from __future__ import annotations

from heuncli.integration.methods.dop853 import DOP853
from heuncli.integration.methods.method import GLOBAL, RECENTRED
from heuncli.records import replace

DOP853_GLOBAL = replace(DOP853, name="DOP853-rodrigues", attitude=GLOBAL)
DOP853_RECENTRED = replace(DOP853, name="DOP853-recentred", attitude=RECENTRED)
