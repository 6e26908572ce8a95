"""Bars whose section diagrams are looked at: scenes as text, solved, and their diagrams as they are drawn."""

from __future__ import annotations

from collections.abc import Sequence

from heuncli.output.drawing.figure import Figure, Panel
from heuncli.output.figures.courses import FigureSource
from heuncli.output.figures.diagrams import make_diagrams
from heuncli.study.quantities.table_units import parse_units
from heuncli.study.queries.study import Study
from tests.shared.drawn_panels import DrawnPanel, panels

SI = parse_units("N,m,N·m")
HELD_TWICE = """
heun: 1
title: Held by two pins
gravity: [0, 0, -9.81]
ground: {points: {A: [0.5, 0, 0], B: [1.5, 0, 0]}}
bodies:
  bar:
    shapes: [{type: cylinder, from: [0, 0, 0], to: [2, 0, 0], radius: 0.02, mass: 10}]
    points: {start: [0, 0, 0], end: [2, 0, 0], A: [0.5, 0, 0], B: [1.5, 0, 0], C: [1, 0, 0]}
joints:
  A: {type: pin, axis: [0, 1, 0], from: ground.A, to: bar.A}
  B: {type: pin, axis: [0, 1, 0], from: ground.B, to: bar.B}
forces:
  push: {type: force, on: bar.C, vector: [20, 3, -50]}
sections:
  along: {body: bar, from: start, to: end, count: 9}
"""
CONROD = """
heun: 1
title: Slider-crank, conrod with its mass spread evenly
space: planar
parameters: {r: 0.05, l: 0.2, w: 300}
bodies:
  crank: {shapes: [{type: rod, from: [0, 0, 0], to: [r, 0, 0], mass: 1}], points: {o: [0, 0], a: [r, 0]}}
  rod:
    shapes: [{type: rod, from: [0, 0, 0], to: [l, 0, 0], mass: 0.6}]
    points: {a: [0, 0], b: [l, 0]}
    position: [r, 0]
  piston: {mass: 0.4, center: [0, 0], inertia: 0.001, points: {b: [0, 0]}, position: [r + l, 0]}
joints:
  main: {type: pin, from: {body: ground, at: [0, 0]}, to: crank.o}
  big: {type: pin, from: crank.a, to: rod.a}
  small: {type: pin, from: rod.b, to: piston.b}
  guide: {type: line, axis: [1, 0], from: {body: ground, at: [0, 0]}, to: piston.b}
drives: {motor: {joint: main, angle: w*t}}
sections: {shank: {body: rod, from: a, to: b, count: 9}}
analysis: {duration: 2*pi/w, samples: 9}
"""


def drawn(study: Study, name: str, at: Sequence[float] | None = None, *, tension_side: bool = False) -> Figure:
    """The figure of one section of one run."""
    return make_diagrams([FigureSource("", study)], [name], SI, at, tension_side)


def diagrams(figure: Figure) -> list[Panel]:
    """Its panels without the sketches of the bars."""
    return [panel for panel in figure.panels if not panel.is_bare]


def panels_of(study: Study, name: str, at: Sequence[float] | None = None) -> dict[str, DrawnPanel]:
    """Its panels as they are seen, by the quantity that they are of."""
    return {panel.label.partition(" ")[0]: panel for panel in panels(drawn(study, name, at))}
