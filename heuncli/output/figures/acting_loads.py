"""The loads that act at an instant as arrows to one scale: forces and moments of joints, couplings and applied
loads.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.kinetostatics.actions import AppliedLoad
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.multibody.mechanism.loads import PointLoad
from heuncli.output.drawing.figure import Arrow, Item, PlaceLabel, Strokes, Symbol
from heuncli.output.drawing.ticks import format_short
from heuncli.output.figures.machine_items import to_pair
from heuncli.output.machine_geometry.coupling_forces import iter_coupling_forces
from heuncli.output.machine_geometry.machine import Machine
from heuncli.output.machine_geometry.poses import Poses
from heuncli.output.machine_geometry.views import SceneView
from heuncli.results.path_words import IMPULSE_UNITS
from heuncli.results.results import Array, Block
from heuncli.scene.file_format.names import GROUND
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.study import Study

JOINTS_PEN, APPLIED_PEN, COUPLED_PEN = 1, 3, 5
JOINT_REPORTS = frozenset({"joints"})
LONGEST_ARROW = 0.2  # share of the figure's larger side: largest force
HIGHEST_DISTRIBUTED = 0.08  # share: largest density of a distributed load
MIN_ARROW = 0.004  # share: a shorter arrow is seen from its end
MIN_LOAD = 1e-4  # of the largest load: smaller ones are not drawn
MIN_FACING = 0.95  # cosine to the line of sight, from which a moment is drawn
MAX_VALUES = 16  # with more arrows there are no values
N_DISTRIBUTED_ARROWS = 9  # arrows of a distributed load
DIGITS = 3  # of the values
KINDS = (
    (JOINTS_PEN, 'joint reactions, "from" on "to"'),
    (COUPLED_PEN, "couplings"),
    (APPLIED_PEN, "applied"),
)


class ActingLoad(NamedTuple):
    """A force or a moment, or its impulse in an impact, at a place (3,), world axes.

    is_moment: whether it is a moment
    """

    name: str
    place: Array
    vector: Array
    pen: int
    is_moment: bool = False

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

    def find_unit(self, units: Units, *, moments: bool = False) -> tuple[str, float]:
        """Return the display unit, and how many of it are one SI unit."""
        unit = "N·m" if moments else "N"
        return units.find(IMPULSE_UNITS[unit] if self.is_impact else unit)


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
    loads, spreads = (
        [*_iter_joint_loads(results.joints, (0,)), *_iter_coupling_loads(machine, poses, results.couplings)],
        [],
    )
    for applied in recovery.loads:
        if isinstance(applied.load, PointLoad) and applied.action.spread:
            spreads.append(_make_distributed_load(applied, recovery.states))
        elif isinstance(applied.load, PointLoad):
            is_moment = applied.load.is_couple
            vector = applied.action.moment if is_moment else applied.action.force
            loads.append(
                ActingLoad(applied.load.name, applied.action.to_end.position[0], vector[0], APPLIED_PEN, is_moment)
            )
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
    shown = [
        pull
        for pull in known_loads
        if pull.magnitude > max(rounding[pull.is_moment], MIN_LOAD * largest[pull.is_moment])
    ]
    unknown_names = dict.fromkeys(pull.name for pull in loads if not math.isfinite(pull.magnitude))
    return ActingLoads(
        shown, [distributed for distributed in spreads if distributed.densities.any()], list(unknown_names)
    )


def _iter_joint_loads(block: Block, index: tuple[int, ...]) -> Iterator[ActingLoad]:
    """Yield the forces and moments of the joints in a block of results; index: of the instant in its arrays."""
    for name, joint_block in block.items():
        place = np.asarray(joint_block["point"])[index]
        yield ActingLoad(name, place, np.asarray(joint_block["force"])[index], JOINTS_PEN)
        yield ActingLoad(name, place, np.asarray(joint_block["moment"])[index], JOINTS_PEN, is_moment=True)


def _iter_coupling_loads(machine: Machine, poses: Poses, blocks: Block) -> Iterator[ActingLoad]:
    """Yield the forces of couplings in a block of results at the first instant of some poses."""
    first = poses.first
    for pull in iter_coupling_forces(machine, first, blocks):
        yield ActingLoad(pull.name, pull.points[0], pull.forces[0], COUPLED_PEN)


def _iter_applied_impulses(study: Study) -> Iterator[ActingLoad]:
    """Yield the impulses that are applied at the beginning."""
    for name, impulse in study.spec.impulses.items():
        if impulse.point is not None and impulse.body != GROUND:
            body = study.results.bodies[impulse.body]
            rotation = body["rotation"][0]
            vector = rotation @ np.array(impulse.vector) if impulse.in_body else np.array(impulse.vector)
            place = body["position"][0] + rotation @ np.array(impulse.point)
            yield ActingLoad(name, place, vector, APPLIED_PEN, impulse.kind == "couple")


def _make_distributed_load(applied: AppliedLoad, states: BodyStates) -> DistributedLoad:
    """Make a distributed load at the first of some instants."""
    first, second = applied.action.spread
    body = applied.action.to_end.body
    ends = [states.x[0, body] + states.R[0, body] @ part.spread.start for part in (first, second)]
    densities = [part.force[0] / part.spread.half_length for part in (first, second)]
    return DistributedLoad(applied.load.name, np.array(ends), np.array(densities))


class DrawnLoads(NamedTuple):
    """Loads as they are drawn.

    scale: length of 1 N in the unit of the figure
    notes: what the items do not show
    """

    scale: float
    items: Sequence[Item]
    notes: Sequence[str]


def draw_loads(loads: ActingLoads, view: SceneView, size: float, side: float, units: Units) -> DrawnLoads:
    """Draw the arrows.

    size: number of the figure's units in a metre
    side: larger side of the machine in that unit
    """
    forces, moments = loads.select(moments=False), loads.select(moments=True)
    scale = LONGEST_ARROW * side / max((pull.magnitude for pull in forces), default=math.inf)
    has_values = len(loads.loads) <= MAX_VALUES
    items = [
        item
        for distributed in loads.distributed
        for item in _draw_distributed_load(distributed, loads, view, size, side, units)
    ]
    for pull in forces:
        items += _draw_force(pull, view, size, scale, MIN_ARROW * side)
        tip = size * view.project(pull.place) + scale * view.project(pull.vector)
        if has_values:
            items.append(_make_value_label(pull, tip, *loads.find_unit(units)))
    facing = [pull for pull in moments if abs(float(view.compute_depth(pull.vector))) >= MIN_FACING * pull.magnitude]
    for pull in facing:
        place = size * view.project(pull.place)
        symbol = "turning" if float(view.compute_depth(pull.vector)) > 0.0 else "turning back"
        items.append(Symbol(*to_pair(place), symbol, (1.0, 0.0), pull.pen, f"moment of {pull.name}"))
        if has_values:
            items.append(_make_value_label(pull, place, *loads.find_unit(units, moments=True)))
    hidden_names = [pull.name for pull in moments if not any(pull is distributed for distributed in facing)]
    notes = (
        [f"moments not drawn, as their axes are not along the line of sight: {', '.join(hidden_names)}"]
        if hidden_names
        else []
    )
    return DrawnLoads(scale, items, notes)


def _draw_force(pull: ActingLoad, view: SceneView, size: float, scale: float, min_length: float) -> Iterator[Item]:
    """Draw an arrow, or its head or tail if it points along the line of sight."""
    x, y = (size * view.project(pull.place)).tolist()
    by_x, by_y = (scale * view.project(pull.vector)).tolist()
    if math.hypot(by_x, by_y) > min_length:
        yield Arrow(x, y, by_x, by_y, pull.pen, description=f"force: {pull.name}")
    else:
        symbol = "toward" if float(view.compute_depth(pull.vector)) > 0.0 else "away"
        yield Symbol(x, y, symbol, (1.0, 0.0), pull.pen, pull.name)


def _make_value_label(pull: ActingLoad, place: Array, unit: str, factor: float) -> PlaceLabel:
    """Label the magnitude, and the name of applied loads and couplings, which have no other label."""
    applied = pull.pen != JOINTS_PEN
    text = f"{pull.name} " * applied + f"{format_short(factor * pull.magnitude, DIGITS)} {unit}"
    return PlaceLabel(*to_pair(place), text, pull.name if applied else "", pull.pen, is_optional=not applied)


def _draw_distributed_load(
    distributed: DistributedLoad, loads: ActingLoads, view: SceneView, size: float, side: float, units: Units
) -> Iterator[Item]:
    """Draw a distributed load: arrows that end on the body, to their own scale, and the line through their tails."""
    densest = max(float(np.linalg.norm(density)) for other in loads.distributed for density in other.densities)
    shares = np.linspace(0.0, 1.0, N_DISTRIBUTED_ARROWS)[:, None]
    heads = size * view.project(distributed.ends[0] + shares * (distributed.ends[1] - distributed.ends[0]))
    arrows = (
        HIGHEST_DISTRIBUTED
        * side
        / densest
        * view.project(distributed.densities[0] + shares * (distributed.densities[1] - distributed.densities[0]))
    )
    tails = heads - arrows
    for tail, arrow in zip(tails.tolist(), arrows.tolist(), strict=True):
        yield Arrow(tail[0], tail[1], arrow[0], arrow[1], APPLIED_PEN)
    yield Strokes(np.stack([tails[:-1], tails[1:]], axis=1), APPLIED_PEN)
    (force, of_force), (length, of_length) = units.find("N"), units.find("m")
    values = [
        format_short(of_force / of_length * float(np.linalg.norm(density)), DIGITS) for density in distributed.densities
    ]
    text = f"{distributed.name} {' to '.join(dict.fromkeys(values))} {force}/{length}"
    yield PlaceLabel(*to_pair(tails[N_DISTRIBUTED_ARROWS // 2]), text, distributed.name, APPLIED_PEN)


def draw_key(loads: ActingLoads, scale: float, x: float, y: float, step: float, units: Units) -> Iterator[Item]:
    """Draw an arrow of a round number with its words for each kind of load, from a place downwards."""
    forces = loads.select(moments=False)
    kinds = [(pen, words) for pen, words in KINDS if any(pull.pen == pen for pull in forces)]
    unit, factor = loads.find_unit(units)
    for number, (pen, words) in enumerate(kinds):
        value = round_down(factor * max(pull.magnitude for pull in forces))
        yield Arrow(x, y - number * step, scale * value / factor, 0.0, pen, f"{format_short(value)} {unit}: {words}")


def round_down(value: float) -> float:
    """Return the largest of 1, 2, 5, 10, 20, ... that is not above half the value."""
    power = 10.0 ** math.floor(math.log10(0.5 * value))
    return next(m * power for m in (5.0, 2.0, 1.0) if m * power <= 0.5 * value * (1.0 + 1e-12))
