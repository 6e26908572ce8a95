"""Beams of symbeam, all along: V(x) and M(x) as they are printed, against cuts anywhere and against what is drawn.

The case `beams` that comes with heun holds reactions and a cut in every stretch; its expressions are evaluated here at
hundreds of places. What is drawn is read back from the SVG.
"""

from __future__ import annotations

import re
from functools import cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pytest

from heuncli.analyses.published.cases import read_case, spec_of
from heuncli.output.figures.courses import FigureSource
from heuncli.output.figures.diagrams import make_diagrams
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.bars import WholeBar
from heuncli.study.queries.study import Study
from tests.shared.drawn_panels import heights, panels, upright_at
from tests.shared.scenes import near, study

WHERE = re.compile(r"example (\d+), V\(x\) and M\(x\) from (\S+) to (\S+)")


class Span(NamedTuple):
    """From where to where an expression holds, and those of V and M as they are printed."""

    low: float
    high: float
    V: str
    M: str

    def of(self, what: str, x: np.ndarray) -> np.ndarray:
        """V or M at places along the beam."""
        return valued(getattr(self, what), x) + 0.0 * x


@cache
def beams() -> Study:
    return study(spec_of("beams"))


def valued(text: str, x: np.ndarray | float = 0.0) -> np.ndarray:
    """A printed expression."""
    return np.asarray(eval(text, {}, {**beams().spec.parameters, "x": x}))


@cache
def spans() -> dict[int, list[Span]]:
    """Of each example its stretches."""
    found: dict[int, list[Span]] = {}
    for table in read_case("beams").tables:
        if (where := WHERE.fullmatch(table.where)) is not None:
            low, high = (float(valued(text)) for text in where.groups()[1:])
            found.setdefault(int(where[1]), []).append(Span(low, high, *(number.text for number in table.numbers)))
    return found


def parts(number: int) -> list[tuple[str, float, float]]:
    """The bodies of an example, from where to where."""
    own = {name: body.points for name, body in beams().spec.bodies.items() if re.fullmatch(rf"e{number}[ab]?", name)}
    return [(name, points["left"][0], points["right"][0]) for name, points in own.items()]


EXAMPLES = (1, 3, 4, 6, 9, 12, 13, 14, 15)
numbered = pytest.mark.parametrize("number", EXAMPLES)


def test_all_of_them_are_looked_at() -> None:
    assert tuple(spans()) == EXAMPLES
    assert sum(map(len, spans().values())) == 23
    assert sum(len(parts(number)) for number in EXAMPLES) == len(beams().spec.bodies)


@numbered
def test_shear_and_moment_all_along(number: int) -> None:
    """Anywhere along each beam, on both sides of what acts there."""
    for name, a, b in parts(number):
        own = WholeBar(beams(), name).make_lines(0.0)
        size = {"Q1": 40.0, "M2": 100.0}
        for span in spans()[number]:
            inside = (own["Q1"].s + a > span.low + 1e-9) & (own["Q1"].s + a < span.high - 1e-9)
            x = own["Q1"].s[inside] + a
            assert (len(x) > 20) == (span.low < b - 1e-9 and span.high > a + 1e-9)
            near(own["Q1"].values[inside], span.of("V", x), size["Q1"], 1e-13)
            near(own["M2"].values[inside], span.of("M", x), size["M2"], 1e-13)


@numbered
def test_what_is_drawn_is_that(number: int) -> None:
    """Read back from the SVG: every curve to half a pixel, and upright lines where V or M jumps."""
    for name, a, b in parts(number):
        drawn = {p.label[:2]: p for p in panels(make_diagrams([FigureSource("", beams())], [name], Units({})))}
        for quantity, of in (("Q1", "V"), ("M2", "M")):
            inside = [span for span in spans()[number] if span.low < b - 1e-9 and span.high > a + 1e-9]
            x = {span: np.linspace(max(span.low, a), min(span.high, b), 203)[1:-1] for span in inside}
            if not any(np.abs(span.of(of, x[span])).max() > 0.0 for span in inside):
                assert quantity not in drawn, "it is 0 all along"
                continue
            panel = drawn[quantity]
            for span in inside:
                off = heights(panel.curve(quantity), x[span] - a) - span.of(of, x[span])
                assert np.abs(off).max() <= 0.5 * panel.pixel
            for left, right in pairwise(inside):
                at = np.array([left.high])
                before, beyond = (float(span.of(of, at)[0]) for span in (left, right))
                jump = upright_at(panel.curve(quantity), left.high - a, panel.across)
                if abs(beyond - before) > 4.0 * panel.pixel:
                    (told,) = [step for step in jump if abs(step[1] - step[0]) > 2.0 * panel.pixel]
                    assert told == pytest.approx((before, beyond), abs=0.5 * panel.pixel)
