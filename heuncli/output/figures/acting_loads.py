"""Collect the loads that act at an instant: which are drawn, where they act, and on which body.

Drawn are the loads of joints and their drives, of couplings, and all applied loads: from outside, between two points or
bodies, and in joints. A load between two bodies is drawn ON the body of its `to` end, or, if that is the ground, on the
other one; one that acts along the guide of a piston is drawn on both.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.kinetostatics.actions import AppliedLoad
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.multibody.mechanism.loads import GROUND as ON_GROUND
from heuncli.multibody.mechanism.loads import PointLoad
from heuncli.output.figures.curves import choose_number_style
from heuncli.output.machine_geometry.machine import Machine, iter_coupling_forces
from heuncli.output.machine_geometry.marks import find_guided_actuators
from heuncli.output.machine_geometry.poses import Poses
from heuncli.results.path_words import IMPULSE_UNITS
from heuncli.results.results import Array, Block
from heuncli.scene.file_format.names import GROUND
from heuncli.study.compose.recovery import Recovery
from heuncli.study.quantities.digits import ReaderStyle
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.study import Study

JOINTS_PEN, APPLIED_PEN, COUPLED_PEN = 1, 3, 5
JOINT_REPORTS = frozenset({"joints"})
MIN_LOAD = 1e-4  # of the largest load: smaller ones are not drawn
MIN_MOMENT = 0.01  # of the largest moment: smaller ones are not drawn


class ActingLoad(NamedTuple):
    """A force or a moment, or its impulse in an impact, at a place (3,), world axes.

    is_moment: whether it is a moment
    kind: the block of the results that has it: joints, couplings, forces, drives
    is_reaction: whether it is the opposite of one that is drawn, too
    is_incidental: whether it is a moment that comes with a force, as of a joint
    """

    name: str
    place: Array
    vector: Array
    pen: int
    is_moment: bool = False
    kind: str = "joints"
    is_reaction: bool = False
    is_incidental: bool = False

    @property
    def magnitude(self) -> float:
        """Its magnitude."""
        return float(np.linalg.norm(self.vector))


class DistributedLoad(NamedTuple):
    """A distributed load: its ends (2, 3) and its densities there (2, 3) [N/m], world axes."""

    name: str
    ends: Array
    densities: Array


class ActingLoads(NamedTuple):
    """The loads that act at an instant.

    indeterminate: joints whose force or moment is open
    is_impact: whether they are the impulses of an impact
    """

    loads: Sequence[ActingLoad]
    distributed: Sequence[DistributedLoad]
    indeterminate: Sequence[str]
    is_impact: bool = False

    def select(self, *, moments: bool) -> list[ActingLoad]:
        """Return the forces, or the moments."""
        return [load for load in self.loads if load.is_moment == moments]

    def find_largest(self, *, moments: bool) -> float:
        """Return the largest magnitude of the forces, or of the moments."""
        return max((load.magnitude for load in self.select(moments=moments)), default=0.0)

    def choose_style(self, units: Units, *, moments: bool) -> ReaderStyle:
        """Choose how the magnitudes are written."""
        unit, largest = "N·m" if moments else "N", self.find_largest(moments=moments)
        unit = IMPULSE_UNITS[unit] if self.is_impact else unit
        return choose_number_style(unit, largest, units)

    def drop_slight_moments(self, size: float) -> ActingLoads:
        """Drop the moments of joints and bushings that are slight beside the forces on a machine of a size [m]."""
        slight = MIN_MOMENT * size * self.find_largest(moments=False)
        return self._replace(
            loads=[p for p in self.loads if not (p.is_moment and p.is_incidental and p.magnitude < slight)]
        )

    @property
    def names(self) -> set[str]:
        """The names of all loads that are drawn."""
        return {load.name for load in self.loads} | {spread.name for spread in self.distributed}


NO_LOADS = ActingLoads((), (), ())


def collect_loads(study: Study, machine: Machine, poses: Poses) -> ActingLoads:
    """Collect the loads at the first instant of some poses; in an impact its impulses, and those of joints and
    couplings.
    """
    if study.spec.analysis.type == "impulse" and study.results.impulses:
        impulse = study.results.impulses[0]
        loads = [
            *_iter_joint_loads(impulse["joints"], ()),
            *_iter_coupling_loads(machine, poses, impulse.get("couplings", {})),
            *_iter_applied_impulses(study),
        ]
        return _select_loads(loads, [], {False: 0.0, True: 0.0})._replace(is_impact=True)
    is_single, times = study.has_one_instant, poses.times[:1]
    recovery = study.recovery if is_single else study.find_recovery(times, JOINT_REPORTS)
    results = study.results if is_single else study.compute_reports(times, JOINT_REPORTS)
    loads = [
        *_iter_joint_loads(results.joints, (0,)),
        *_iter_drive_loads(recovery),
        *_iter_coupling_loads(machine, poses, results.couplings),
        *_iter_applied_loads(recovery, find_guided_actuators(study.spec)),
    ]
    spreads = [_make_distributed_load(own, recovery.states) for own in recovery.loads if own.action.spread]
    magnitudes = study.load_magnitudes
    rounding = {
        is_moment: max(
            tolerances.NOTHING_ACTS * magnitudes.by_unit.get(unit, 0.0), magnitudes.errors.get(("reactions", unit), 0.0)
        )
        for is_moment, unit in ((False, "N"), (True, "N·m"))
    }
    return _select_loads(loads, spreads, rounding)


def _select_loads(
    loads: Sequence[ActingLoad], spreads: Sequence[DistributedLoad], rounding: dict[bool, float]
) -> ActingLoads:
    """Select the loads that are known and larger than rounding."""
    known_loads = [load for load in loads if math.isfinite(load.magnitude)]
    largest = {
        is_moment: max((p.magnitude for p in known_loads if p.is_moment == is_moment), default=0.0)
        for is_moment in (False, True)
    }
    smallest = {False: MIN_LOAD * largest[False], True: MIN_MOMENT * largest[True]}
    shown = [load for load in known_loads if load.magnitude > max(rounding[load.is_moment], smallest[load.is_moment])]
    unknown_names = dict.fromkeys(load.name for load in loads if not math.isfinite(load.magnitude))
    return ActingLoads(
        shown, [distributed for distributed in spreads if distributed.densities.any()], list(unknown_names)
    )


def _iter_joint_loads(block: Block, index: tuple[int, ...]) -> Iterator[ActingLoad]:
    """Yield the forces and moments of the joints in a block of results; index: of the instant in its arrays."""
    for name, joint_block in block.items():
        place = np.asarray(joint_block["point"])[index]
        yield ActingLoad(name, place, np.asarray(joint_block["force"])[index], JOINTS_PEN)
        yield ActingLoad(name, place, np.asarray(joint_block["moment"])[index], JOINTS_PEN, True, is_incidental=True)


def _iter_drive_loads(recovery: Recovery) -> Iterator[ActingLoad]:
    """Yield what drives exert, at the first of some instants; a rod's force is its drive's and is drawn with it."""
    for own in recovery.joints:
        drive = own.joint.drive
        if drive is None or drive.quantity == "length":
            continue
        is_moment = drive.quantity == "angle"
        vector = (own.drive_moment if is_moment else own.drive_force)[0]
        yield ActingLoad(drive.name, own.point[0], vector, APPLIED_PEN, is_moment, "drives")


def _iter_applied_loads(recovery: Recovery, guided: frozenset[str]) -> Iterator[ActingLoad]:
    """Yield the forces and moments of applied loads at the first of some instants, without distributed ones.

    guided: actuators that are drawn as a pair of arrows
    """
    for applied in recovery.loads:
        action = applied.action
        if action.spread:
            continue
        is_on_from = action.to_end.body == ON_GROUND and action.from_end is not None
        end = action.from_end if is_on_from and action.from_end is not None else action.to_end
        force, moment = (action.force, action.moment) if not is_on_from else (-action.force, action.opposite_moment)
        if not (isinstance(applied.load, PointLoad) and applied.load.is_couple):
            yield ActingLoad(applied.load.name, end.position[0], force[0], APPLIED_PEN, kind="forces")
        if moment[0].any():
            is_incidental = bool(force[0].any())
            yield ActingLoad(
                applied.load.name, end.position[0], moment[0], APPLIED_PEN, True, "forces", is_incidental=is_incidental
            )
        if applied.load.name in guided and action.from_end is not None:
            other = action.to_end if is_on_from else action.from_end
            yield ActingLoad(
                applied.load.name, other.position[0], -force[0], APPLIED_PEN, kind="forces", is_reaction=True
            )


def _iter_coupling_loads(machine: Machine, poses: Poses, blocks: Block) -> Iterator[ActingLoad]:
    """Yield the forces of couplings in a block of results at the first instant of some poses."""
    first = poses.first
    for load in iter_coupling_forces(machine, first, blocks):
        yield ActingLoad(load.name, load.points[0], load.forces[0], COUPLED_PEN, kind="couplings")


def _iter_applied_impulses(study: Study) -> Iterator[ActingLoad]:
    """Yield the impulses that are applied at the beginning."""
    for name, impulse in study.spec.impulses.items():
        if impulse.point is not None and impulse.body != GROUND:
            body = study.results.bodies[impulse.body]
            rotation = body["rotation"][0]
            vector = rotation @ np.array(impulse.vector) if impulse.in_body else np.array(impulse.vector)
            place = body["position"][0] + rotation @ np.array(impulse.point)
            yield ActingLoad(name, place, vector, APPLIED_PEN, impulse.kind == "couple", "forces")


def _make_distributed_load(applied: AppliedLoad, states: BodyStates) -> DistributedLoad:
    """Make a distributed load at the first of some instants."""
    first, second = applied.action.spread
    body = applied.action.to_end.body
    ends = [states.x[0, body] + states.R[0, body] @ part.spread.start for part in (first, second)]
    densities = [part.force[0] / part.spread.half_length for part in (first, second)]
    return DistributedLoad(applied.load.name, np.array(ends), np.array(densities))
