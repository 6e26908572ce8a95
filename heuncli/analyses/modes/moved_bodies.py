"""The modes of a spec as motions of its bodies: of each the turn and the shift of its centre of mass.

dx = shift + turn × (x − x_c)      of a point x of a body, to the first order; complex where points do not pass the
                                   pose at rest together, as on turning shafts
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from heuncli.analyses.modes.study import looked_for, told
from heuncli.base.records import record, replace
from heuncli.motion.linearisation.modes import SceneModes
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.error_places import placed

HALF = 0.5


@record
class MovedBodies:
    """A scene with its modes, and its bodies by their names.

    places (n_b, 3): of the bodies' origins; attitudes (n_b, 3, 3), their columns the axes; centres (n_b, 3) of mass;
    turns, shifts (modes, n_b, 3), complex.
    """

    scene: PreparedScene
    modes: SceneModes
    names: tuple[str, ...]
    places: Array
    attitudes: Array
    centres: Array
    turns: Array
    shifts: Array

    def moved(self, mode: int, body: int, points: Array) -> Array:
        """How far points (..., 3) of the world go with a body, (..., 3) complex."""
        turn, shift = self.turns[mode, body], self.shifts[mode, body]
        return np.asarray(shift + np.cross(np.broadcast_to(turn, points.shape), points - self.centres[body]))

    def moves_across(self, mode: int, direction: Array) -> bool:
        """Whether a mode moves bodies across a direction rather than along it: centres shift so, or turns about it."""
        shifts, turns = np.abs(self.shifts[mode]) ** 2, np.abs(self.turns[mode]) ** 2
        along = np.abs(self.shifts[mode] @ direction) ** 2
        about = np.abs(self.turns[mode] @ direction) ** 2
        return bool(along.sum() <= HALF * shifts.sum() and about.sum() >= HALF * turns.sum())


def moved_bodies(spec: Spec, without: Sequence[str] = ()) -> MovedBodies:
    """The modes of a spec, and how its bodies move; without: as of `modes`. Raises SolveError as that does."""
    with placed(spec):
        found = looked_for(spec)
        here, bodies = found.here, found.here.layout.mechanism.bodies
        order = np.array([here.layout.place[k] for k in range(len(bodies))], dtype=np.intp)
        own = here.found
        twists = np.zeros((len(found.modes), len(bodies), 6), dtype=complex)
        for k, mode in enumerate(found.modes):
            twists[k] = own.twists[order] @ mode.shape
        attitudes, centres = own.attitudes[order], own.centres[order]
        inside = np.array([body.center for body in bodies]).reshape(-1, 3)
        return MovedBodies(
            here.scene, replace(told(spec, found), without=tuple(without)), tuple(body.name for body in bodies),
            centres - np.einsum("bij,bj->bi", attitudes, inside), attitudes, centres, twists[..., :3], twists[..., 3:],
        )  # fmt: skip
