"""How well the modes about a rest pose are known: what those about the poses beside it, in its stated error, differ by.

Of what nothing holds the pose is known as well as the way there (loads/equilibrium/finer.py), and frequencies change
along it.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.errors import SolveError
from heuncli.base.records import replace
from heuncli.motion.linearisation.oscillations import Mode, oscillations
from heuncli.motion.linearisation.steady_motion import Looked, look
from heuncli.results.results import Array

DIFFERENCE = 2.0  # times that between two poses: as errors of loads are estimated (study/solve/error_extents.py)


def as_known(modes: list[Mode], here: Looked, beside: tuple[Array, ...]) -> list[Mode]:
    """The modes, their errors covering those at other states (n_state,) of the pose; a growth within them is none."""
    others = [values for state in beside if len(values := eigenvalues_at(here, state))]
    return [mode if mode.kind == "free" else wider(mode, others) for mode in modes]


def eigenvalues_at(here: Looked, state: Array) -> Array:
    """Those of all motions about another state, (m,) [1/s]; none where its laws have no slope."""
    try:
        there = look(here.scene, here.runner, here.t, state, here.holding)
    except SolveError:
        return np.zeros(0, dtype=complex)
    return np.array([mode.eigenvalue for mode in oscillations(there.system, there.loose)])


def wider(mode: Mode, others: list[Array]) -> Mode:
    """A mode whose error covers the nearest eigenvalues of others (m,)."""
    off = max((float(np.abs(values - mode.eigenvalue).min()) for values in others), default=0.0)
    error, value = mode.error + DIFFERENCE * off, mode.eigenvalue
    if abs(value.real) > error:
        return replace(mode, error=error)
    kind = "oscillation" if value.imag else "decay"
    return replace(mode, kind=kind, eigenvalue=complex(0.0, value.imag), error=error)
