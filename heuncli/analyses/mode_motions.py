"""Modes of a spec as motions of its bodies: rotation and displacement of the centre of mass of each.
dx = shift + turn × (x − x_c)      of a point x of a body, to first order; complex if points do not pass the
                                   pose at rest together, as on rotating shafts
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.analyses.modes import solve_modes, to_results
from heuncli.base.records import record, replace
from heuncli.motion.linearisation.oscillations import SceneModes
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.setup import attach_locations

MIN_SHARE = 0.5


@record
class BodyModes:
    """A scene with its modes, and its bodies by name.

    places (n_b, 3): the bodies' origins
    attitudes (n_b, 3, 3): with the axes as columns
    centres (n_b, 3): centres of mass
    turns, shifts (modes, n_b, 3): complex
    """

    scene: PreparedScene
    modes: SceneModes
    names: tuple[str, ...]
    places: Array
    attitudes: Array
    centres: Array
    turns: Array
    shifts: Array

    def displace_points(self, mode: int, body: int, points: Array) -> Array:
        """Return the displacements (..., 3), complex, of a body's points at world positions (..., 3)."""
        turn, shift = self.turns[mode, body], self.shifts[mode, body]
        return np.asarray(shift + np.cross(np.broadcast_to(turn, points.shape), points - self.centres[body]))

    def is_transverse(self, mode: int, direction: Array) -> bool:
        """Return whether a mode moves bodies across a direction rather than along it: centres shift across it, or
        bodies turn about it.
        """
        shifts, turns = np.abs(self.shifts[mode]) ** 2, np.abs(self.turns[mode]) ** 2
        along = np.abs(self.shifts[mode] @ direction) ** 2
        about = np.abs(self.turns[mode] @ direction) ** 2
        return bool(along.sum() <= MIN_SHARE * shifts.sum() and about.sum() >= MIN_SHARE * turns.sum())


def find_body_modes(spec: Spec, excluded: Sequence[str] = ()) -> BodyModes:
    """Return the modes of a spec, and how its bodies move.

    excluded: entries left out, as for compute_spec_modes

    Raises SolveError as that does.
    """
    with attach_locations(spec):
        spec_modes = solve_modes(spec)
        linearised_state, bodies = spec_modes.linearised_state, spec_modes.linearised_state.layout.mechanism.bodies
        order = np.array([linearised_state.layout.place[k] for k in range(len(bodies))], dtype=np.intp)
        linear_equations = linearised_state.linear
        twists = np.zeros((len(spec_modes.modes), len(bodies), 6), dtype=complex)
        for k, mode in enumerate(spec_modes.modes):
            twists[k] = linear_equations.twists[order] @ mode.shape
        attitudes, centres = linear_equations.attitudes[order], linear_equations.centres[order]
        local_centres = np.array([body.center for body in bodies]).reshape(-1, 3)
        return BodyModes(
            linearised_state.scene,
            replace(to_results(spec, spec_modes), omitted_paths=tuple(excluded)),
            tuple(body.name for body in bodies),
            centres - np.einsum("bij,bj->bi", attitudes, local_centres),
            attitudes,
            centres,
            twists[..., :3],
            twists[..., 3:],
        )
