"""What acts at an instant, as arrows to one scale: forces of joints, what is applied from outside; their moments."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.loads.kinetostatics.actions import AppliedLoad
from heuncli.loads.kinetostatics.bodies import BodyStates
from heuncli.multibody.mechanism.model import PointLoad
from heuncli.output.drawing.figure import Arrow, Item, PlaceLabel, Strokes, Symbol
from heuncli.output.drawing.ticks import short
from heuncli.output.figures.machine_items import on_paper
from heuncli.output.machine_geometry.coupled_pulls import coupled_pulls
from heuncli.output.machine_geometry.machine import Machine
from heuncli.output.machine_geometry.poses import Poses
from heuncli.output.machine_geometry.views import SceneView
from heuncli.results.results import Array, Block
from heuncli.results.results_schema import AT_A_BLOW
from heuncli.scene.file_format.names import GROUND
from heuncli.study.ask.study import Study
from heuncli.study.quantities.table_units import Units

JOINTS_PEN, APPLIED_PEN, COUPLED_PEN = 1, 3, 5
LOADS = frozenset({"joints"})
LONGEST = 0.2  # of the picture's larger side: the arrow of the largest
HIGHEST = 0.08  # of it: a distributed load where it is densest
LEAST = 0.004  # of it: what is shorter is seen from its end
SMALL = 1e-4  # of the largest: what is less is not drawn
FACING = 0.95  # of a moment that must be about the line of sight to be drawn
MOST_VALUES = 16  # arrows whose values are written beside them
TEETH = 9  # arrows of a distributed load
DIGITS = 3  # of these values
KINDS = (
    (JOINTS_PEN, "of joints, from ON to"),
    (COUPLED_PEN, "of couplings"),
    (APPLIED_PEN, "applied"),
)


class Pull(NamedTuple):
    """A force or a moment, or in a blow the impulse of one, at a place (3,), world axes."""

    name: str
    place: Array
    vector: Array
    pen: int
    turns: bool = False

    @property
    def size(self) -> float:
        """Its magnitude."""
        return float(np.linalg.norm(self.vector))


class SpreadLoad(NamedTuple):
    """A distributed load: its ends (2, 3) and what it is at them (2, 3) [N/m], world axes."""

    name: str
    ends: Array
    densities: Array


class Pulls(NamedTuple):
    """What acts at an instant; the joints whose force or moment is open there; whether it is that of a blow."""

    all: Sequence[Pull]
    spreads: Sequence[SpreadLoad]
    open: Sequence[str]
    struck: bool = False

    def of(self, *, turning: bool) -> list[Pull]:
        """The forces, or the moments."""
        return [pull for pull in self.all if pull.turns == turning]

    def unit(self, units: Units, *, turning: bool = False) -> tuple[str, float]:
        """The unit shown, and how many of it one in SI is."""
        unit = "N·m" if turning else "N"
        return units.of(AT_A_BLOW[unit] if self.struck else unit)


NOTHING = Pulls((), (), ())


def pulls_of(study: Study, machine: Machine, poses: Poses) -> Pulls:
    """What acts at the first instant of some poses; in a blow what strikes, and what joints and couplings answer."""
    if study.spec.analysis.type == "impulse" and study.results.impulses:
        struck = study.results.impulses[0]
        found = [
            *_joints(struck["joints"], ()),
            *_couplings(machine, poses, struck.get("couplings", {})),
            *_blows(study),
        ]
        return _pulls(found, [], {False: 0.0, True: 0.0})._replace(struck=True)
    alone, times = study.of_one_instant, poses.times[:1]
    recovery = study.recovery if alone else study.recovery_at(times, LOADS)
    told = study.results if alone else study.reports_at(times, LOADS)
    found, spreads = [*_joints(told.joints, (0,)), *_couplings(machine, poses, told.couplings)], []
    for own in recovery.loads:
        if isinstance(own.load, PointLoad) and own.action.spread:
            spreads.append(_spread(own, recovery.states))
        elif isinstance(own.load, PointLoad):
            turns = own.load.kind == "couple"
            vector = own.action.moment if turns else own.action.force
            found.append(Pull(own.load.name, own.action.to.position[0], vector[0], APPLIED_PEN, turns))
    of = study.load_magnitudes
    rounding = {
        turns: max(tolerances.NOTHING_ACTS * of.by_unit.get(unit, 0.0), of.errors.get(("reactions", unit), 0.0))
        for turns, unit in ((False, "N"), (True, "N·m"))
    }
    return _pulls(found, spreads, rounding)


def _pulls(found: Sequence[Pull], spreads: Sequence[SpreadLoad], rounding: dict[bool, float]) -> Pulls:
    """Those that are known and more than rounding."""
    known = [pull for pull in found if math.isfinite(pull.size)]
    largest = {turns: max((p.size for p in known if p.turns == turns), default=0.0) for turns in (False, True)}
    shown = [pull for pull in known if pull.size > max(rounding[pull.turns], SMALL * largest[pull.turns])]
    lost = dict.fromkeys(pull.name for pull in found if not math.isfinite(pull.size))
    return Pulls(shown, [one for one in spreads if one.densities.any()], list(lost))


def _joints(block: Block, at: tuple[int, ...]) -> Iterator[Pull]:
    """The forces and moments of the joints in a block of results; at: the place of the instant in its arrays."""
    for name, own in block.items():
        place = np.asarray(own["point"])[at]
        yield Pull(name, place, np.asarray(own["force"])[at], JOINTS_PEN)
        yield Pull(name, place, np.asarray(own["moment"])[at], JOINTS_PEN, turns=True)


def _couplings(machine: Machine, poses: Poses, blocks: Block) -> Iterator[Pull]:
    """The forces of couplings in a block of results at the first instant of some poses."""
    first = poses.first
    for pull in coupled_pulls(machine, first, blocks):
        yield Pull(pull.name, pull.places[0], pull.forces[0], COUPLED_PEN)


def _blows(study: Study) -> Iterator[Pull]:
    """The impulses that strike at the beginning."""
    for name, blow in study.spec.impulses.items():
        if blow.point is not None and blow.body != GROUND:
            body = study.results.bodies[blow.body]
            rotation = body["rotation"][0]
            vector = rotation @ np.array(blow.vector) if blow.in_body else np.array(blow.vector)
            place = body["position"][0] + rotation @ np.array(blow.point)
            yield Pull(name, place, vector, APPLIED_PEN, blow.kind == "couple")


def _spread(own: AppliedLoad, states: BodyStates) -> SpreadLoad:
    """A distributed load at the first of some instants."""
    first, second = own.action.spread
    body = own.action.to.body
    ends = [states.x[0, body] + states.R[0, body] @ part.spread.start for part in (first, second)]
    densities = [part.force[0] / part.spread.half_length for part in (first, second)]
    return SpreadLoad(own.load.name, np.array(ends), np.array(densities))


class DrawnPulls(NamedTuple):
    """Pulls as they are drawn: how long one N is, in the unit of the picture, the items, and what they do not tell."""

    scale: float
    items: Sequence[Item]
    notes: Sequence[str]


def drawn(pulls: Pulls, view: SceneView, size: float, side: float, units: Units) -> DrawnPulls:
    """The arrows; size: of the picture's unit in a metre; side: the larger one of what is drawn, in that unit."""
    forces, moments = pulls.of(turning=False), pulls.of(turning=True)
    scale = LONGEST * side / max((pull.size for pull in forces), default=math.inf)
    valued = len(pulls.all) <= MOST_VALUES
    items = [item for one in pulls.spreads for item in _comb(one, pulls, view, size, side, units)]
    for pull in forces:
        items += _force(pull, view, size, scale, LEAST * side)
        tip = size * view.flat(pull.place) + scale * view.flat(pull.vector)
        if valued:
            items.append(_value(pull, tip, *pulls.unit(units)))
    facing = [pull for pull in moments if abs(float(view.depth(pull.vector))) >= FACING * pull.size]
    for pull in facing:
        place = size * view.flat(pull.place)
        symbol = "turning" if float(view.depth(pull.vector)) > 0.0 else "turning back"
        items.append(Symbol(*on_paper(place), symbol, (1.0, 0.0), pull.pen, f"moment of {pull.name}"))
        if valued:
            items.append(_value(pull, place, *pulls.unit(units, turning=True)))
    hidden = [pull.name for pull in moments if not any(pull is one for one in facing)]
    notes = [f"not drawn, as they do not turn in the picture: the moments of {', '.join(hidden)}"] if hidden else []
    return DrawnPulls(scale, items, notes)


def _force(pull: Pull, view: SceneView, size: float, scale: float, least: float) -> Iterator[Item]:
    """An arrow, or its head or tail where it points along the line of sight."""
    x, y = (size * view.flat(pull.place)).tolist()
    by_x, by_y = (scale * view.flat(pull.vector)).tolist()
    if math.hypot(by_x, by_y) > least:
        yield Arrow(x, y, by_x, by_y, pull.pen, told=f"force: {pull.name}")
    else:
        symbol = "toward" if float(view.depth(pull.vector)) > 0.0 else "away"
        yield Symbol(x, y, symbol, (1.0, 0.0), pull.pen, pull.name)


def _value(pull: Pull, place: Array, unit: str, of_it: float) -> PlaceLabel:
    """Its magnitude, and the name of what is applied, or of a coupling, which nothing else names."""
    applied = pull.pen != JOINTS_PEN
    text = f"{pull.name} " * applied + f"{short(of_it * pull.size, DIGITS)} {unit}"
    return PlaceLabel(*on_paper(place), text, pull.name if applied else "", pull.pen, spare=not applied)


def _comb(one: SpreadLoad, pulls: Pulls, view: SceneView, size: float, side: float, units: Units) -> Iterator[Item]:
    """A distributed load: arrows that end on the body, to a scale of their own, and the line of their tails."""
    densest = max(float(np.linalg.norm(density)) for each in pulls.spreads for density in each.densities)
    shares = np.linspace(0.0, 1.0, TEETH)[:, None]
    on = size * view.flat(one.ends[0] + shares * (one.ends[1] - one.ends[0]))
    by = HIGHEST * side / densest * view.flat(one.densities[0] + shares * (one.densities[1] - one.densities[0]))
    tails = on - by
    for tail, way in zip(tails.tolist(), by.tolist(), strict=True):
        yield Arrow(tail[0], tail[1], way[0], way[1], APPLIED_PEN)
    yield Strokes(np.stack([tails[:-1], tails[1:]], axis=1), APPLIED_PEN)
    (force, of_force), (length, of_length) = units.of("N"), units.of("m")
    values = [short(of_force / of_length * float(np.linalg.norm(density)), DIGITS) for density in one.densities]
    text = f"{one.name} {' to '.join(dict.fromkeys(values))} {force}/{length}"
    yield PlaceLabel(*on_paper(tails[TEETH // 2]), text, one.name, APPLIED_PEN)


def key(pulls: Pulls, scale: float, x: float, y: float, step: float, units: Units) -> Iterator[Item]:
    """An arrow of a round number of each kind that is there, with its words, from a place on, a step apart."""
    forces = pulls.of(turning=False)
    kinds = [(pen, words) for pen, words in KINDS if any(pull.pen == pen for pull in forces)]
    unit, of_it = pulls.unit(units)
    for number, (pen, words) in enumerate(kinds):
        value = round_below(of_it * max(pull.size for pull in forces))
        yield Arrow(x, y - number * step, scale * value / of_it, 0.0, pen, f"{short(value)} {unit}: {words}")


def round_below(value: float) -> float:
    """The largest of 1, 2, 5, 10, 20, ... that is not above half a number."""
    power = 10.0 ** math.floor(math.log10(0.5 * value))
    return next(m * power for m in (5.0, 2.0, 1.0) if m * power <= 0.5 * value * (1.0 + 1e-12))
