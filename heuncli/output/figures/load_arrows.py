"""Draw the loads that act as arrows to one scale, with their values, and the key that explains the arrows.

Forces are arrows, moments double arrows; what is seen from its end is a symbol. Distributed loads have their own scale.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.axes import format_short
from heuncli.output.drawing.figure import Arrow, KeyArrow, PlaceLabel, Strokes, Symbol
from heuncli.output.figures.acting_loads import (
    APPLIED_PEN,
    COUPLED_PEN,
    JOINTS_PEN,
    ActingLoad,
    ActingLoads,
    DistributedLoad,
)
from heuncli.output.figures.posed_machine import to_pair
from heuncli.output.figures.windows import Window
from heuncli.output.machine_geometry.views import SceneView
from heuncli.results.results import Array
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.labels import Labels
from heuncli.study.quantities.table_units import Units, choose_prefix

LONGEST_ARROW = 0.2  # share of the figure's larger side: largest force
LONGEST_MOMENT = 0.14  # share: largest moment
HIGHEST_DISTRIBUTED = 0.08  # share: largest density of a distributed load
MIN_ARROW = 0.004  # share: a shorter arrow is not drawn, or is seen from its end
MIN_REACTION = 0.02  # share: a shorter arrow of the reaction to a load is not drawn
MIN_VISIBLE_PART = 0.2  # of an arrow's length: with less it is seen from its end
MIN_LABELLED = 0.01  # of the largest load: smaller ones have no value
MIN_FACING = 0.95  # cosine to the line of sight, from which a moment is drawn as a turn
N_DISTRIBUTED_ARROWS = 9  # arrows of a distributed load
DIGITS = 3  # of the values of distributed loads
KINDS = ((JOINTS_PEN, 'joint on "to" body'), (COUPLED_PEN, "coupling"), (APPLIED_PEN, "applied load"))


class LoadDrawing(NamedTuple):
    """The loads of a figure, its view, and the scales of their arrows.

    per_si: number of the figure's units in a metre
    side: larger side of the machine in that unit
    force_scale, moment_scale: lengths of 1 N and of 1 N·m in that unit
    """

    loads: ActingLoads
    view: SceneView
    per_si: float
    side: float
    force_scale: float
    moment_scale: float

    def find_place(self, load: ActingLoad) -> Array:
        """Return where a load acts, (2,) in the unit of the figure."""
        return np.asarray(self.per_si * self.view.project(load.place))

    def find_scale(self, load: ActingLoad) -> float:
        """Return the scale of a load."""
        return self.moment_scale if load.is_moment else self.force_scale

    def find_arrow(self, load: ActingLoad) -> Array:
        """Return the arrow of a load, (2,)."""
        return np.asarray(self.find_scale(load) * self.view.project(load.vector))

    def faces_viewer(self, load: ActingLoad) -> bool:
        """Whether a load is a moment about the line of sight, which is drawn as a turn."""
        return load.is_moment and abs(float(self.view.compute_depth(load.vector))) >= MIN_FACING * load.magnitude


def scale_loads(loads: ActingLoads, view: SceneView, per_si: float, side: float) -> LoadDrawing:
    """Choose the scales of the arrows, so that the largest force and moment have a fixed length in the figure."""
    largest = [loads.find_largest(moments=moments) or math.inf for moments in (False, True)]
    return LoadDrawing(loads, view, per_si, side, LONGEST_ARROW * side / largest[0], LONGEST_MOMENT * side / largest[1])


def draw_loads(drawing: LoadDrawing, window: Window) -> Iterator[Arrow | Strokes | Symbol]:
    """Draw the arrows, without reactions far outside the window, such as on a far anchor on the ground."""
    for distributed in drawing.loads.distributed:
        yield from _draw_distributed_load(distributed, drawing)
    for load in drawing.loads.loads:
        place, arrow = drawing.find_place(load), drawing.find_arrow(load)
        depth, length = float(drawing.view.compute_depth(load.vector)), drawing.find_scale(load) * load.magnitude
        description = f"{'moment' if load.is_moment else 'force'}: {load.name}"
        if load.is_reaction and (length < MIN_REACTION * drawing.side or not window.is_near(place)):
            continue
        if drawing.faces_viewer(load):
            symbol = "turning" if depth > 0.0 else "turning back"
            yield Symbol(*to_pair(place), symbol, (1.0, 0.0), load.pen, f"moment of {load.name}")
        elif float(np.hypot(*arrow)) > max(MIN_VISIBLE_PART * length, MIN_ARROW * drawing.side):
            yield Arrow(*to_pair(place), *to_pair(arrow), load.pen, "", description, load.is_moment)
        elif length > MIN_ARROW * drawing.side:
            yield Symbol(*to_pair(place), "toward" if depth > 0.0 else "away", (1.0, 0.0), load.pen, load.name)


def label_loads(drawing: LoadDrawing, labels: Labels, units: Units) -> Iterator[PlaceLabel]:
    """Label the loads with names and magnitudes, the largest first; those below 1 % of the largest have none."""
    loads = drawing.loads
    yield from _label_distributed_loads(drawing, labels, units)
    forces, moments = ({id(p): text for p, text in _iter_values(loads, units, moments=m)} for m in (False, True))
    moment_texts = {(p.kind, p.name): moments[id(p)] for p in loads.loads if id(p) in moments}
    with_force = {(p.kind, p.name) for p in loads.loads if id(p) in forces}
    for load in sorted(loads.loads, key=lambda load: -load.magnitude / loads.find_largest(moments=load.is_moment)):
        value, key = (moments if load.is_moment else forces).get(id(load)), (load.kind, load.name)
        if value is None or load.is_reaction or (load.is_moment and key in with_force):
            continue
        place = drawing.find_place(load)
        tip = place if drawing.faces_viewer(load) else place + drawing.find_arrow(load)
        both = [value, moment_texts.pop(key)] if not load.is_moment and key in moment_texts else [value]
        name = describe_object(load.kind, load.name, labels)
        yield PlaceLabel(*to_pair(tip), f"{name} {' / '.join(both)}", name, load.pen)


def _label_distributed_loads(drawing: LoadDrawing, labels: Labels, units: Units) -> Iterator[PlaceLabel]:
    """Label the distributed loads with their names and densities."""
    (force, of_force), (length, of_length) = units.find("N"), units.find("m")
    if drawing.loads.distributed and not units.is_chosen("N"):
        force, of_force = choose_prefix("N", _find_densest(drawing.loads) / of_length)
    for distributed in drawing.loads.distributed:
        tail = _find_tails(distributed, drawing)[0][N_DISTRIBUTED_ARROWS // 2]
        values = [
            format_short(of_force / of_length * float(np.linalg.norm(density)), DIGITS)
            for density in distributed.densities
        ]
        name = describe_object("forces", distributed.name, labels)
        text = f"{name} {' to '.join(dict.fromkeys(values))} {force}/{length}"
        yield PlaceLabel(*to_pair(tail), text, name, APPLIED_PEN)


def _iter_values(loads: ActingLoads, units: Units, *, moments: bool) -> Iterator[tuple[ActingLoad, str]]:
    """Yield the forces or moments that have a value, with its words."""
    style, largest = loads.choose_style(units, moments=moments), loads.find_largest(moments=moments)
    for load in loads.select(moments=moments):
        if load.magnitude >= MIN_LABELLED * largest:
            yield load, f"{style.write(load.magnitude)} {style.unit}"


def _find_densest(loads: ActingLoads) -> float:
    """Return the largest density of the distributed loads [N/m]."""
    return max(float(np.linalg.norm(density)) for own in loads.distributed for density in own.densities)


def _find_tails(distributed: DistributedLoad, drawing: LoadDrawing) -> tuple[Array, Array]:
    """Return the tails and the arrows of a distributed load, (n, 2) each."""
    shares = np.linspace(0.0, 1.0, N_DISTRIBUTED_ARROWS)[:, None]
    places = distributed.ends[0] + shares * (distributed.ends[1] - distributed.ends[0])
    densities = distributed.densities[0] + shares * (distributed.densities[1] - distributed.densities[0])
    scale = HIGHEST_DISTRIBUTED * drawing.side / _find_densest(drawing.loads)
    arrows = scale * drawing.view.project(densities)
    return drawing.per_si * drawing.view.project(places) - arrows, arrows


def _draw_distributed_load(distributed: DistributedLoad, drawing: LoadDrawing) -> Iterator[Arrow | Strokes]:
    """Draw a distributed load: arrows that end on the body, to their own scale, and the line through their tails."""
    tails, arrows = _find_tails(distributed, drawing)
    for tail, arrow in zip(tails.tolist(), arrows.tolist(), strict=True):
        yield Arrow(tail[0], tail[1], arrow[0], arrow[1], APPLIED_PEN)
    yield Strokes(np.stack([tails[:-1], tails[1:]], axis=1), APPLIED_PEN)


def iter_key_arrows(drawing: LoadDrawing, arrows: Sequence[Arrow], units: Units) -> Iterator[KeyArrow]:
    """Yield an arrow of a round number with its words for each kind of forces and of moments among drawn arrows."""
    loads, drawn = drawing.loads, {(arrow.pen, arrow.is_double) for arrow in arrows if arrow.description}
    for moments, scale in ((False, drawing.force_scale), (True, drawing.moment_scale)):
        if not loads.select(moments=moments):
            continue
        style = loads.choose_style(units, moments=moments)
        value = round_down(style.per_si * loads.find_largest(moments=moments))
        text = f"{format_short(value)} {style.unit}"
        for pen, words in KINDS:
            if (pen, moments) in drawn:
                yield KeyArrow(scale * value / style.per_si, pen, f"{text} {words}", is_double=moments)


def round_down(value: float) -> float:
    """Return the largest of 1, 2, 5, 10, 20, ... that is not above half the value."""
    power = 10.0 ** math.floor(math.log10(0.5 * value))
    return next(m * power for m in (5.0, 2.0, 1.0) if m * power <= 0.5 * value * (1.0 + 1e-12))
