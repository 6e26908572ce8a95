"""Find where the forces of couplings are drawn: one ON each loaded body, at a point of its line of action.

    at = P + F x M / |F|^2        point of a force F whose moment about P is M, without the component of M along F
A force whose counterpart acts at the same point on another body is drawn once, on the body that is listed first. For a
belt the pulls of both strands on the second pulley are drawn: their sum with the pretension is the bearing load.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.machine_geometry.machine import Machine
from heuncli.output.machine_geometry.pitch_lines import BeltGeometry
from heuncli.output.machine_geometry.poses import Poses
from heuncli.results.results import Array

RELATIVE_TOLERANCE = 1e-9  # of the largest force or coordinate: below it, sums of forces and distances count as zero


class CouplingForce(NamedTuple):
    """A coupling's force ON a body or the ground: points of action and components, (n, 3), world axes.

    Components are nan where they are indeterminate.
    """

    name: str
    body: str
    points: Array
    forces: Array


def iter_coupling_forces(
    machine: Machine, poses: Poses, blocks: Mapping[str, Mapping[str, Any]]
) -> Iterator[CouplingForce]:
    """Yield the forces of all couplings at the instants of the poses.

    blocks: the results of the couplings, `couplings`
    """
    belts = {belt.name: belt for belt in machine.belts}
    for name, block in blocks.items():
        if name in belts:
            yield from _iter_belt_forces(belts[name], poses, block)
            continue
        unique_forces: list[CouplingForce] = []
        for body, values in block.get("on", {}).items():
            point, force, moment = (np.asarray(values[key]).reshape(-1, 3) for key in ("point", "force", "moment"))
            pull = CouplingForce(name, body, point + offset_to_line(force, moment), force)
            if np.any(force != 0.0) and not any(are_opposite(pull, other) for other in unique_forces):
                unique_forces.append(pull)
        yield from unique_forces


def offset_to_line(force: Array, moment: Array) -> Array:
    """Compute the vector (n, 3) from the moment's reference point to the force's line of action; zero where it is
    unknown.
    """
    square = np.sum(force * force, axis=1, keepdims=True)
    return np.nan_to_num(np.cross(force, moment) / np.where(square > 0.0, square, 1.0))


def are_opposite(first: CouplingForce, second: CouplingForce) -> bool:
    """Return whether two forces are opposite and act at the same point at all instants; they must be nan at the same
    ones.
    """
    size, reach = (float(np.abs(np.nan_to_num(x)).max()) for x in (second.forces, second.points))
    remainder, separation = first.forces + second.forces, first.points - second.points
    both_open = np.isnan(first.forces) & np.isnan(second.forces)
    balanced = np.abs(np.where(both_open, 0.0, remainder)) <= RELATIVE_TOLERANCE * size
    return bool(balanced.all() and (np.abs(separation) <= RELATIVE_TOLERANCE * reach).all())


def _iter_belt_forces(belt: BeltGeometry, poses: Poses, block: Mapping[str, Any]) -> Iterator[CouplingForce]:
    """Yield the pulls of both strands on the second pulley, each along its strand and away from the pulley."""
    if "tight" not in block:
        return
    driven = np.asarray(block["force"]).reshape(-1) >= 0.0
    tight, slack = (np.asarray(block[key]).reshape(-1) for key in ("tight", "slack"))
    for k, pull in enumerate((np.where(driven, tight, slack), np.where(driven, slack, tight))):
        point, far_end = belt.strands[k][:: 1 if k == 0 else -1]  # the first strand leaves the second pulley
        direction = poses.trace_direction(belt.carrier, (far_end - point) / np.linalg.norm(far_end - point))
        yield CouplingForce(
            belt.name, belt.pulley_bodies[1], poses.trace_point(belt.carrier, point), pull[:, None] * direction
        )
