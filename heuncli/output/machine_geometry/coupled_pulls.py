"""Where the forces of couplings stand as they are drawn: one ON each body that is loaded, on its line of action.

    at = P + F x M / |F|^2        the place of a force F whose moment about P is M, less what of M is along F
What acts on one body and the opposite on another at the same place is drawn once, on the one told first. Of a belt the
pulls of both strands on the second pulley are drawn: their sum with the pretension is what its bearing has.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.machine_geometry.machine import Machine
from heuncli.output.machine_geometry.pitch_lines import BeltLook
from heuncli.output.machine_geometry.poses import Poses
from heuncli.results.results import Array

SAME = 1e-9  # of the largest: forces and places that are opposite, or one


class CoupledPull(NamedTuple):
    """A force of a coupling ON a body or the ground: its places and components (n, 3), world axes; nan where open."""

    name: str
    on: str
    places: Array
    forces: Array


def coupled_pulls(machine: Machine, poses: Poses, blocks: Mapping[str, Mapping[str, Any]]) -> Iterator[CoupledPull]:
    """The forces of all couplings at the instants of the poses; blocks: their results, `couplings`."""
    belts = {belt.name: belt for belt in machine.belts}
    for name, block in blocks.items():
        if name in belts:
            yield from _of_belt(belts[name], poses, block)
            continue
        told: list[CoupledPull] = []
        for body, own in block.get("on", {}).items():
            point, force, moment = (np.asarray(own[key]).reshape(-1, 3) for key in ("point", "force", "moment"))
            pull = CoupledPull(name, body, point + off_line(force, moment), force)
            if np.any(force != 0.0) and not any(opposite(pull, other) for other in told):
                told.append(pull)
        yield from told


def off_line(force: Array, moment: Array) -> Array:
    """From the point of a moment (n, 3) to the line of action of its force (n, 3); none where either is open."""
    square = np.sum(force * force, axis=1, keepdims=True)
    return np.nan_to_num(np.cross(force, moment) / np.where(square > 0.0, square, 1.0))


def opposite(one: CoupledPull, other: CoupledPull) -> bool:
    """Whether one force is the counterpart of another at all instants, open where that is."""
    size, reach = (float(np.abs(np.nan_to_num(x)).max()) for x in (other.forces, other.places))
    left, apart = one.forces + other.forces, one.places - other.places
    both_open = np.isnan(one.forces) & np.isnan(other.forces)
    balanced = np.abs(np.where(both_open, 0.0, left)) <= SAME * size
    return bool(balanced.all() and (np.abs(apart) <= SAME * reach).all())


def _of_belt(belt: BeltLook, poses: Poses, block: Mapping[str, Any]) -> Iterator[CoupledPull]:
    """The pulls of both strands on the second pulley, of which each runs away from it or towards it."""
    if "tight" not in block:
        return
    driven = np.asarray(block["force"]).reshape(-1) >= 0.0
    tight, slack = (np.asarray(block[key]).reshape(-1) for key in ("tight", "slack"))
    for k, pull in enumerate((np.where(driven, tight, slack), np.where(driven, slack, tight))):
        on, from_ = belt.strands[k][:: 1 if k == 0 else -1]  # as they run the first leaves the second pulley
        way = poses.directions(belt.carrier, (from_ - on) / np.linalg.norm(from_ - on))
        yield CoupledPull(belt.name, belt.pulled[1], poses.ways(belt.carrier, on), pull[:, None] * way)
