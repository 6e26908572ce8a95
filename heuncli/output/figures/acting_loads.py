"""The loads that act at an instant as arrows to one scale: forces as arrows, moments in space as double arrows.

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
from heuncli.output.drawing.figure import Arrow, KeyArrow, PlaceLabel, Strokes, Symbol
from heuncli.output.drawing.ticks import format_short
from heuncli.output.figures.posed_machine import to_pair
from heuncli.output.machine_geometry.coupling_forces import iter_coupling_forces
from heuncli.output.machine_geometry.joint_symbols import find_guided_actuators
from heuncli.output.machine_geometry.machine import Machine
from heuncli.output.machine_geometry.poses import Poses
from heuncli.output.machine_geometry.views import SceneView
from heuncli.results.path_words import IMPULSE_UNITS
from heuncli.results.results import Array, Block
from heuncli.scene.file_format.names import GROUND
from heuncli.study.compose.recovery import Recovery
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.reader_numbers import PREFIXES, ReaderStyle, choose_prefix, choose_reader_style
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.study import Study

JOINTS_PEN, APPLIED_PEN, COUPLED_PEN = 1, 3, 5
JOINT_REPORTS = frozenset({"joints"})
LONGEST_ARROW = 0.2  # share of the figure's larger side: largest force
LONGEST_MOMENT = 0.14  # share: largest moment
HIGHEST_DISTRIBUTED = 0.08  # share: largest density of a distributed load
MIN_ARROW = 0.004  # share: a shorter arrow is not drawn, or is seen from its end
MIN_VISIBLE_PART = 0.2  # of an arrow's length: with less it is seen from its end
MIN_LOAD = 1e-4  # of the largest load: smaller ones are not drawn
MIN_LABELLED = 0.01  # of the largest load: smaller ones have no value
MIN_MOMENT = 0.01  # of the largest moment: smaller ones are not drawn
READABLE = (0.1, 1e4)  # the largest number in chosen units; beyond, the unit is chosen by size
MIN_FACING = 0.95  # cosine to the line of sight, from which a moment is drawn as a turn
N_DISTRIBUTED_ARROWS = 9  # arrows of a distributed load
DIGITS = 3  # of the values of distributed loads
KINDS = ((JOINTS_PEN, 'joint on "to" body'), (COUPLED_PEN, "coupling"), (APPLIED_PEN, "applied load"))


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
        return [pull for pull in self.loads if pull.is_moment == moments]

    def find_largest(self, *, moments: bool) -> float:
        """Return the largest magnitude of the forces, or of the moments."""
        return max((pull.magnitude for pull in self.select(moments=moments)), default=0.0)

    def choose_style(self, units: Units, *, moments: bool) -> ReaderStyle:
        """Choose how the magnitudes are written: in the chosen units unless these make the numbers long or small."""
        unit, largest = "N·m" if moments else "N", self.find_largest(moments=moments)
        unit = IMPULSE_UNITS[unit] if self.is_impact else unit
        style = choose_reader_style(unit, largest, units)
        is_readable = READABLE[0] <= style.size * largest < READABLE[1]
        return style if is_readable or unit not in PREFIXES else choose_reader_style(unit, largest, Units())

    def drop_slight_moments(self, size: float) -> ActingLoads:
        """Drop the moments of joints and bushings that are slight beside the forces on a machine of a size [m]."""
        slight = MIN_MOMENT * size * self.find_largest(moments=False)
        return self._replace(
            loads=[p for p in self.loads if not (p.is_moment and p.is_incidental and p.magnitude < slight)]
        )

    @property
    def names(self) -> set[str]:
        """The names of all loads that are drawn."""
        return {pull.name for pull in self.loads} | {spread.name for spread in self.distributed}


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
    known_loads = [pull for pull in loads if math.isfinite(pull.magnitude)]
    largest = {
        is_moment: max((p.magnitude for p in known_loads if p.is_moment == is_moment), default=0.0)
        for is_moment in (False, True)
    }
    smallest = {False: MIN_LOAD * largest[False], True: MIN_MOMENT * largest[True]}
    shown = [pull for pull in known_loads if pull.magnitude > max(rounding[pull.is_moment], smallest[pull.is_moment])]
    unknown_names = dict.fromkeys(pull.name for pull in loads if not math.isfinite(pull.magnitude))
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
    for pull in iter_coupling_forces(machine, first, blocks):
        yield ActingLoad(pull.name, pull.points[0], pull.forces[0], COUPLED_PEN, kind="couplings")


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


class LoadScales(NamedTuple):
    """Lengths of 1 N and of 1 N·m in the unit of the figure."""

    force: float
    moment: float

    def find(self, load: ActingLoad) -> float:
        """Return the scale of a load."""
        return self.moment if load.is_moment else self.force


def choose_scales(loads: ActingLoads, side: float) -> LoadScales:
    """Choose the scales of the arrows; side: larger side of the machine in the unit of the figure."""
    largest = [loads.find_largest(moments=moments) or math.inf for moments in (False, True)]
    return LoadScales(LONGEST_ARROW * side / largest[0], LONGEST_MOMENT * side / largest[1])


def draw_loads(
    loads: ActingLoads, view: SceneView, size: float, side: float, scales: LoadScales
) -> Iterator[Arrow | Strokes | Symbol]:
    """Draw the arrows.

    size: number of the figure's units in a metre
    side: larger side of the machine in that unit
    """
    for distributed in loads.distributed:
        yield from _draw_distributed_load(distributed, loads, view, size, side)
    for pull in loads.loads:
        place, arrow = size * view.project(pull.place), scales.find(pull) * view.project(pull.vector)
        depth, length = float(view.compute_depth(pull.vector)), scales.find(pull) * pull.magnitude
        description = f"{'moment' if pull.is_moment else 'force'}: {pull.name}"
        if pull.is_moment and abs(depth) >= MIN_FACING * pull.magnitude:
            symbol = "turning" if depth > 0.0 else "turning back"
            yield Symbol(*to_pair(place), symbol, (1.0, 0.0), pull.pen, f"moment of {pull.name}")
        elif float(np.hypot(*arrow)) > max(MIN_VISIBLE_PART * length, MIN_ARROW * side):
            yield Arrow(*to_pair(place), *to_pair(arrow), pull.pen, "", description, pull.is_moment)
        elif length > MIN_ARROW * side:
            yield Symbol(*to_pair(place), "toward" if depth > 0.0 else "away", (1.0, 0.0), pull.pen, pull.name)


def label_loads(
    loads: ActingLoads, view: SceneView, size: float, side: float, scales: LoadScales, labels: Labels, units: Units
) -> Iterator[PlaceLabel]:
    """Label the loads with names and magnitudes, the largest first; those below 1 % of the largest have none."""
    (force, of_force), (length, of_length) = units.find("N"), units.find("m")
    if loads.distributed and not units.is_chosen("N"):
        densest = max(float(np.linalg.norm(density)) for own in loads.distributed for density in own.densities)
        force, of_force = choose_prefix("N", densest / of_length)
    for distributed in loads.distributed:
        tail = _find_tails(distributed, loads, view, size, side)[0][N_DISTRIBUTED_ARROWS // 2]
        values = [
            format_short(of_force / of_length * float(np.linalg.norm(density)), DIGITS)
            for density in distributed.densities
        ]
        name = describe_object("forces", distributed.name, labels)
        text = f"{name} {' to '.join(dict.fromkeys(values))} {force}/{length}"
        yield PlaceLabel(*to_pair(tail), text, name, APPLIED_PEN)
    forces, moments = ({id(p): text for p, text in _iter_values(loads, units, moments=m)} for m in (False, True))
    moment_texts = {(p.kind, p.name): moments[id(p)] for p in loads.loads if id(p) in moments}
    with_force = {(p.kind, p.name) for p in loads.loads if id(p) in forces}
    for pull in sorted(loads.loads, key=lambda load: -load.magnitude / loads.find_largest(moments=load.is_moment)):
        value, key = (moments if pull.is_moment else forces).get(id(pull)), (pull.kind, pull.name)
        if value is None or pull.is_reaction or (pull.is_moment and key in with_force):
            continue
        place = size * view.project(pull.place)
        faces = pull.is_moment and abs(float(view.compute_depth(pull.vector))) >= MIN_FACING * pull.magnitude
        tip = place if faces else place + scales.find(pull) * view.project(pull.vector)
        both = [value, moment_texts.pop(key)] if not pull.is_moment and key in moment_texts else [value]
        name = describe_object(pull.kind, pull.name, labels)
        yield PlaceLabel(*to_pair(tip), f"{name} {' / '.join(both)}", name, pull.pen)


def _iter_values(loads: ActingLoads, units: Units, *, moments: bool) -> Iterator[tuple[ActingLoad, str]]:
    """Yield the forces or moments that have a value, with its words."""
    style, largest = loads.choose_style(units, moments=moments), loads.find_largest(moments=moments)
    for pull in loads.select(moments=moments):
        if pull.magnitude >= MIN_LABELLED * largest:
            yield pull, f"{style.write(pull.magnitude)} {style.unit}"


def _find_tails(
    distributed: DistributedLoad, loads: ActingLoads, view: SceneView, size: float, side: float
) -> tuple[Array, Array]:
    """Return the tails and the arrows of a distributed load, (n, 2) each."""
    densest = max(float(np.linalg.norm(density)) for other in loads.distributed for density in other.densities)
    shares = np.linspace(0.0, 1.0, N_DISTRIBUTED_ARROWS)[:, None]
    heads = size * view.project(distributed.ends[0] + shares * (distributed.ends[1] - distributed.ends[0]))
    densities = distributed.densities[0] + shares * (distributed.densities[1] - distributed.densities[0])
    arrows = HIGHEST_DISTRIBUTED * side / densest * view.project(densities)
    return heads - arrows, arrows


def _draw_distributed_load(
    distributed: DistributedLoad, loads: ActingLoads, view: SceneView, size: float, side: float
) -> Iterator[Arrow | Strokes]:
    """Draw a distributed load: arrows that end on the body, to their own scale, and the line through their tails."""
    tails, arrows = _find_tails(distributed, loads, view, size, side)
    for tail, arrow in zip(tails.tolist(), arrows.tolist(), strict=True):
        yield Arrow(tail[0], tail[1], arrow[0], arrow[1], APPLIED_PEN)
    yield Strokes(np.stack([tails[:-1], tails[1:]], axis=1), APPLIED_PEN)


def iter_key_arrows(
    loads: ActingLoads, arrows: Sequence[Arrow], scales: LoadScales, units: Units
) -> Iterator[KeyArrow]:
    """Yield an arrow of a round number with its words for each kind of forces and of moments among drawn arrows."""
    drawn = {(arrow.pen, arrow.is_double) for arrow in arrows if arrow.description}
    for moments, scale in ((False, scales.force), (True, scales.moment)):
        if not loads.select(moments=moments):
            continue
        style = loads.choose_style(units, moments=moments)
        value = round_down(style.size * loads.find_largest(moments=moments))
        text = f"{format_short(value)} {style.unit}"
        for pen, words in KINDS:
            if (pen, moments) in drawn:
                yield KeyArrow(scale * value / style.size, pen, f"{text} {words}", is_double=moments)


def round_down(value: float) -> float:
    """Return the largest of 1, 2, 5, 10, 20, ... that is not above half the value."""
    power = 10.0 ** math.floor(math.log10(0.5 * value))
    return next(m * power for m in (5.0, 2.0, 1.0) if m * power <= 0.5 * value * (1.0 + 1e-12))
