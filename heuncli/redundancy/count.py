"""How many conditions of the joints hold what others hold already, and how many freedoms are left."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heuncli import tolerances
from heuncli.integration.runner import Runner
from heuncli.kinetostatics.bodies import body_states
from heuncli.tree.layout import Layout
from heuncli.tree.prepare import PreparedScene

if TYPE_CHECKING:
    from heuncli.redundancy.self_stress import SelfStress


def freedoms_of_tree(layout: Layout) -> int:
    """Freedoms of the tree alone: scalar ones that are not driven, three for each ball."""
    return sum(1 for f in layout.freedoms if f.q >= 0) + 3 * int(layout.bodies["ball"].sum())


class Redundancy(NamedTuple):
    """How many conditions hold what others hold: near the start (a singular pose does not count), and just at it.

    dependent: the same near the start, in a planar scene with those across the plane, which are not counted; closed:
    how many rows take part at the start.
    """

    generic: int
    at_start: int
    dependent: int
    closed: int
    stress: SelfStress | None


def redundancy(scene: PreparedScene, runner: Runner) -> Redundancy:
    """Count what is held twice."""
    layout = scene.layout
    if not layout.rows:
        return Redundancy(0, 0, 0, 0, None)
    from heuncli.redundancy.neighbours import neighbours  # a tree starts faster without them
    from heuncli.redundancy.self_stress import self_stress

    here = runner.recovered(np.zeros(1), layout.y0[None, :])
    closed = int(here.rows["closed"][0].sum())
    stress = self_stress(runner, here, body_states(layout, here))
    assert stress is not None
    near = neighbours(runner, 0.0, here.states[0], (tolerances.NEIGHBOUR,))
    if near is None:
        return Redundancy(int(stress.count[0]), int(stress.count[0]), int(stress.dependent[0]), closed, stress)
    beside = self_stress(runner, near, body_states(layout, near))
    assert beside is not None
    at_start = int(stress.count[0])
    dependent = min(stress.dependent[0], beside.dependent.min())
    return Redundancy(int(min(at_start, beside.count.min())), at_start, int(dependent), closed, beside)
