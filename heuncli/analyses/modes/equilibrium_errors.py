"""Uncertainty of the modes about an equilibrium: the difference to the modes about neighbouring poses within its error.

Along an indifferent direction the equilibrium is known only as well as the path to it
(loads/equilibrium/verification.py), and
frequencies change along it.
"""

from __future__ import annotations

import numpy as np

from heuncli.base.errors import SolveError
from heuncli.base.records import replace
from heuncli.motion.linearisation.oscillations import Mode, find_modes
from heuncli.motion.linearisation.steady_motion import LinearisedState, linearise_scene
from heuncli.results.results import Array

DIFFERENCE_FACTOR = 2.0  # times the difference of two poses, as for errors of loads (study/solve/error_extents.py)


def widen_errors(
    modes: list[Mode], linearised_state: LinearisedState, neighbour_states: tuple[Array, ...]
) -> list[Mode]:
    """Return the modes with errors that cover those at neighbouring states (n_state,); growth within the error is
    dropped.
    """
    neighbour_eigenvalues = [
        values for state in neighbour_states if len(values := compute_eigenvalues(linearised_state, state))
    ]
    return [mode if mode.kind == "free" else widen_error(mode, neighbour_eigenvalues) for mode in modes]


def compute_eigenvalues(linearised_state: LinearisedState, state: Array) -> Array:
    """Return the eigenvalues of all motions about another state, (m,) [1/s]; empty if its laws have no slope there."""
    try:
        neighbour = linearise_scene(
            linearised_state.scene, linearised_state.runner, linearised_state.t, state, linearised_state.holding
        )
    except SolveError:
        return np.zeros(0, dtype=complex)
    return np.array([mode.eigenvalue for mode in find_modes(neighbour.system, neighbour.indifferent)])


def widen_error(mode: Mode, neighbour_eigenvalues: list[Array]) -> Mode:
    """Return a mode whose error covers the nearest eigenvalue in each of the arrays (m,)."""
    distance = max((float(np.abs(values - mode.eigenvalue).min()) for values in neighbour_eigenvalues), default=0.0)
    error, value = mode.error + DIFFERENCE_FACTOR * distance, mode.eigenvalue
    if abs(value.real) > error:
        return replace(mode, error=error)
    kind = "oscillation" if value.imag else "decay"
    return replace(mode, kind=kind, eigenvalue=complex(0.0, value.imag), error=error)
