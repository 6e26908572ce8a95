"""Examples of symbeam (in the readme of its examples, github.com/amcc1996/symbeam): beams with V(x) and M(x).

Published as expressions, whose values are exact; its V has the sign of heun's Q1, its M that of M2, its couples turn
about z. The beams between two hinges are bodies of their own. Its distributed loads that are linear are posed as such;
the examples with quadratic ones (5, 10, 11) cannot be posed. Where letters stand for numbers: l = L = 2, q = 3, P = 5,
M = 7. What is drawn is read back from the SVG.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pytest

from heuncli.pictures.bars import WholeBar
from heuncli.pictures.courses import Pictured
from heuncli.pictures.diagrams import diagrams
from heuncli.report.table_units import Units
from heuncli.study.ask.study import Study
from tests.shared.drawn_panels import heights, panels, upright_at
from tests.shared.scenes import near, study

l = L = 2.0
q, P, M = 3.0, 5.0, 7.0
Expression = Callable[[np.ndarray], np.ndarray]


class Span(NamedTuple):
    """From where to where, and V(x), M(x) there as they are printed."""

    low: float
    high: float
    V: Expression
    M: Expression


class Beam(NamedTuple):
    """A beam as the reference builds it; loads: (from, to, at from, at to) upwards; reactions (at, force, moment)."""

    length: float
    supports: dict[float, str]
    spans: Sequence[Span]
    reactions: Sequence[tuple[float, float, float]]
    loads: Sequence[tuple[float, float, float, float]] = ()
    forces: Sequence[tuple[float, float]] = ()
    moments: Sequence[tuple[float, float]] = ()


BEAMS = {
    1: Beam(
        l,
        {0: "roller", l: "pin"},
        [
            Span(0, l / 2, lambda x: -7 * l * q / 24 + q * x**2 / l, lambda x: 7 * l * q * x / 24 - q * x**3 / (3 * l)),
            Span(
                l / 2,
                l,
                lambda x: -13 * l * q / 24 + q * x,
                lambda x: -(l**2) * q / 24 + 13 * l * q * x / 24 - q * x**2 / 2,
            ),
        ],
        [(0, 7 * l * q / 24, 0), (l, 11 * l * q / 24, 0)],
        loads=[(0, l / 2, 0, -q), (l / 2, l, -q, -q)],
    ),
    3: Beam(
        l,
        {0: "fixed", l / 2: "hinge", l: "roller"},
        [
            Span(0, l / 4, lambda x: -5 * l * q / 4 + 0 * x, lambda x: -3 * l**2 * q / 8 + 5 * l * q * x / 4),
            Span(l / 4, l / 2, lambda x: -l * q / 4 + 0 * x, lambda x: -(l**2) * q / 8 + l * q * x / 4),
            Span(
                l / 2,
                l,
                lambda x: -3 * l * q / 4 + q * x,
                lambda x: -(l**2) * q / 4 + 3 * l * q * x / 4 - q * x**2 / 2,
            ),
        ],
        [(0, 5 * l * q / 4, 3 * l**2 * q / 8), (l, l * q / 4, 0)],
        loads=[(l / 2, l, -q, -q)],
        forces=[(l / 4, -q * l)],
    ),
    4: Beam(
        6,
        {0: "fixed", 2: "hinge", 4: "roller"},
        [
            Span(0, 2, lambda x: 5 * x**2 / 8 - 65 / 6, lambda x: -5 * x**3 / 24 + 65 * x / 6 - 20),
            Span(2, 4, lambda x: 5 * x**2 / 8 - 65 / 6, lambda x: -5 * x**3 / 24 + 65 * x / 6 - 20),
            Span(4, 6, lambda x: 5 * x - 30, lambda x: -5 * x**2 / 2 + 30 * x - 90),
        ],
        [(0, 65 / 6, 20), (4, 55 / 6, 0)],
        loads=[(0, 2, 0, -5 / 2), (2, 4, -5 / 2, -5), (4, 6, -5, -5)],
        moments=[(4, 20)],
    ),
    6: Beam(
        3,
        {0.5: "pin", 2.5: "roller"},
        [
            Span(0, 0.5, lambda x: P + 0 * x, lambda x: -P * x),
            Span(0.5, 2.5, lambda x: 0 * x, lambda x: -0.5 * P + 0 * x),
            Span(2.5, 3, lambda x: -P + 0 * x, lambda x: P * x - 3.0 * P),
        ],
        [(0.5, P, 0), (2.5, P, 0)],
        forces=[(0, -P), (3, -P)],
    ),
    9: Beam(
        6,
        {0: "fixed", 4: "hinge", 6: "roller"},
        [
            Span(0, 2, lambda x: 5 * x**2 / 2 - 30, lambda x: -5 * x**3 / 6 + 30 * x - 80),
            Span(
                2,
                4,
                lambda x: -5 * x**2 / 2 + 20 * x - 50,
                lambda x: 5 * x**3 / 6 - 10 * x**2 + 50 * x - 280 / 3,
            ),
            Span(4, 6, lambda x: -10 + 0 * x, lambda x: 10 * x - 40),
        ],
        [(0, 30, 80), (6, -10, 0)],
        loads=[(0, 2, 0, -10), (2, 4, -10, 0)],
        moments=[(6, 20)],
    ),
    12: Beam(
        L,
        {0: "fixed"},
        [Span(0, L, lambda x: -P + 0 * x, lambda x: -L * P + P * x)],
        [(0, P, L * P)],
        forces=[(L, -P)],
    ),
    13: Beam(
        L,
        {0: "fixed"},
        [Span(0, L, lambda x: 0 * x, lambda x: M + 0 * x)],
        [(0, 0, -M)],
        moments=[(L, M)],
    ),
    14: Beam(
        l,
        {0: "pin", l: "roller"},
        [
            Span(0, l / 2, lambda x: -P / 2 + 0 * x, lambda x: P * x / 2),
            Span(l / 2, l, lambda x: P / 2 + 0 * x, lambda x: P * l / 2 - P * x / 2),
        ],
        [(0, P / 2, 0), (l, P / 2, 0)],
        forces=[(l / 2, -P)],
    ),
    15: Beam(
        l,
        {0: "pin", l: "roller"},
        [
            Span(0, l / 4, lambda x: -P / 2 + 0 * x, lambda x: P * x / 2),
            Span(l / 4, l / 2, lambda x: -3 * P / 2 + 0 * x, lambda x: -3 * P * l / 4 + 3 * P * x / 2),
            Span(l / 2, 3 * l / 4, lambda x: P / 2 + 0 * x, lambda x: P * l / 4 - P * x / 2),
            Span(3 * l / 4, 7 * l / 8, lambda x: 7 * P / 2 + 0 * x, lambda x: 5 * P * l / 2 - 7 * P * x / 2),
            Span(7 * l / 8, l, lambda x: 7 * P / 2 + 0 * x, lambda x: 7 * P * l / 2 - 7 * P * x / 2),
        ],
        [(0, P / 2, 0), (l, 7 * P / 2, 0)],
        forces=[(l / 4, P), (l / 2, -2 * P), (3 * l / 4, -3 * P)],
        moments=[(l / 4, P * l / 2), (7 * l / 8, -P * l)],
    ),
}
JOINTS = {
    "fixed": "{{type: weld, from: {{body: ground, at: [{x}, 0]}}, to: {{body: {on}, at: [{x}, 0]}}}}",
    "pin": "{{type: pin, from: {{body: ground, at: [{x}, 0]}}, to: {{body: {on}, at: [{x}, 0]}}}}",
    "roller": ("{{type: line, axis: [1, 0], from: {{body: ground, at: [{x}, 0]}}, to: {{body: {on}, at: [{x}, 0]}}}}"),
    "hinge": "{{type: pin, from: {{body: {before}, at: [{x}, 0]}}, to: {{body: {on}, at: [{x}, 0]}}}}",
}


def bodies_of(beam: Beam) -> list[tuple[str, float, float]]:
    """The parts between the hinges: names, from where, to where."""
    hinges = [x for x, kind in beam.supports.items() if kind == "hinge"]
    ends = [0.0, *hinges, beam.length]
    return [(f"b{k}", a, b) for k, (a, b) in enumerate(pairwise(ends))]


def scene(beam: Beam) -> str:
    """The beam as a spec: massless but for what a body needs, without gravity."""
    parts = bodies_of(beam)

    def on(x: float) -> str:
        return next(name for name, a, b in parts if a <= x < b or x == b == beam.length)

    lines = ["heun: 1", "title: A beam of symbeam", "space: planar", "bodies:"]
    for name, a, b in parts:
        shape = f"{{type: box, center: [{(a + b) / 2}, 0, 0], size: [{b - a}, 0.1, 0.1], mass: 1}}"
        lines.append(f"  {name}: {{shapes: [{shape}], points: {{a: [{a}, 0], b: [{b}, 0]}}}}")
    lines.append("joints:")
    for k, (x, kind) in enumerate(beam.supports.items()):
        before = f"b{int(on(x)[1:]) - 1}"
        lines.append(f"  j{k}: {JOINTS[kind].format(x=x, on=on(x), before=before)}")
    lines.append("forces:")
    for k, (a, b, first, last) in enumerate(beam.loads):
        ends = f"from: [{a}, 0], to: [{b}, 0], vector: [0, {first}], to_vector: [0, {last}]"
        lines.append(f"  q{k}: {{type: distributed, on: {on(a)}, {ends}}}")
    for k, (x, force) in enumerate(beam.forces):
        lines.append(f"  f{k}: {{type: force, on: {{body: {on(x)}, at: [{x}, 0]}}, vector: [0, {force}]}}")
    for k, (x, moment) in enumerate(beam.moments):
        lines.append(f"  m{k}: {{type: couple, on: {{body: {on(x)}, at: [{x}, 0]}}, vector: [0, 0, {moment}]}}")
    lines.append("sections:")
    lines += [f"  {name}: {{body: {name}, from: a, to: b, count: 5}}" for name, _, _ in parts]
    return "\n".join(lines) + "\n"


@cache
def solved_beam(number: int) -> Study:
    return study(scene(BEAMS[number]))


numbered = pytest.mark.parametrize("number", list(BEAMS))


@numbered
def test_reactions(number: int) -> None:
    """As printed, to rounding; a fixed end's moment turns about z."""
    beam, results = BEAMS[number], solved_beam(number).results
    size = max(abs(force) for _, force, _ in beam.reactions) + max(abs(moment) for *_, moment in beam.reactions)
    joints = dict(zip(beam.supports, results.joints.values(), strict=True))
    for x, force, moment in beam.reactions:
        near(joints[x]["force"][0, 1], force, size, 1e-13)
        near(joints[x]["moment"][0, 2], moment, size, 1e-13)


@numbered
def test_shear_and_moment_all_along(number: int) -> None:
    """Anywhere along each beam, on both sides of what acts there."""
    beam = BEAMS[number]
    for name, a, b in bodies_of(beam):
        own = WholeBar(solved_beam(number), name).at(0.0)
        size = {"Q1": 40.0, "M2": 100.0}
        for span in beam.spans:
            inside = (own["Q1"].s + a > span.low + 1e-9) & (own["Q1"].s + a < span.high - 1e-9)
            x = own["Q1"].s[inside] + a
            assert (len(x) > 20) == (span.low < b - 1e-9 and span.high > a + 1e-9)
            near(own["Q1"].values[inside], span.V(x), size["Q1"], 1e-13)
            near(own["M2"].values[inside], span.M(x), size["M2"], 1e-13)


@numbered
def test_what_is_drawn_is_that(number: int) -> None:
    """Read back from the SVG: every curve to half a pixel, and upright lines where V or M jumps."""
    beam = BEAMS[number]
    for name, a, b in bodies_of(beam):
        drawn = {p.label[:2]: p for p in panels(diagrams([Pictured("", solved_beam(number))], [name], Units({})))}
        for quantity, of in (("Q1", "V"), ("M2", "M")):
            inside = [span for span in beam.spans if span.low < b - 1e-9 and span.high > a + 1e-9]
            x = {span: np.linspace(max(span.low, a), min(span.high, b), 203)[1:-1] for span in inside}
            if not any(np.abs(getattr(span, of)(x[span])).max() > 0.0 for span in inside):
                assert quantity not in drawn, "it is 0 all along"
                continue
            panel = drawn[quantity]
            for span in inside:
                off = heights(panel.curve(quantity), x[span] - a) - getattr(span, of)(x[span])
                assert np.abs(off).max() <= 0.5 * panel.pixel
            for left, right in pairwise(inside):
                at = np.array([left.high])
                before, beyond = (float(getattr(span, of)(at)[0]) for span in (left, right))
                jump = upright_at(panel.curve(quantity), left.high - a, panel.across)
                if abs(beyond - before) > 4.0 * panel.pixel:
                    (told,) = [step for step in jump if abs(step[1] - step[0]) > 2.0 * panel.pixel]
                    assert told == pytest.approx((before, beyond), abs=0.5 * panel.pixel)
