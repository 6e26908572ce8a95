"""A trolley of weight P that crosses a beam on two supports: influence lines, and the envelopes that they make.

Where it stands at a, Q1 = -P (1 - a/L) before it and P a/L beyond, M2 = P s (L - a)/L before and P a (L - s)/L beyond.
Over the crossing Q1 at s is between -P (1 - s/L) and P s/L, M2 between 0 and P s (L - s)/L.
"""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.output.tables.measure import measure_number, parse_measure
from heuncli.study.queries.study import Study
from tests.shared.drawn_bars import panels_of
from tests.shared.drawn_panels import edges, heights, upright_at
from tests.shared.scenes import study

P, L = 200.0, 4.0
SCENE = f"""
heun: 1
title: A trolley crosses a beam
space: planar
gravity: [0, -10]
bodies:
  beam:
    shapes: [{{type: rod, from: [0, 0, 0], to: [{L}, 0, 0], mass: 1e-9}}]
    points: {{a: [0, 0], b: [{L}, 0]}}
  trolley: {{mass: {P / 10}, center: [0, 0], inertia: 1, points: {{o: [0, 0]}}}}
joints:
  A: {{type: pin, from: {{body: ground, at: [0, 0]}}, to: beam.a}}
  B: {{type: line, axis: [1, 0], from: {{body: ground, at: [{L}, 0]}}, to: beam.b}}
  rail: {{type: slide, axis: [1, 0], from: beam.a, to: trolley.o}}
drives: {{crossing: {{joint: rail, travel: "DRIVE"}}}}
sections: {{along: {{body: beam, from: a, to: b, count: 5}}}}
analysis: {{duration: 2, samples: 5}}
"""
S = np.linspace(0.01, 0.99, 197) * L


@pytest.fixture(scope="module")
def crossing() -> Study:
    return study(SCENE.replace("DRIVE", f"{L / 2.0}*t"))


@pytest.mark.parametrize("a", [0.7, 1.5, 3.3])
def test_the_corner_is_where_the_load_stands(crossing: Study, a: float) -> None:
    shown = panels_of(crossing, "along", [a / L * 2.0])
    shear, moment = shown["Q1"], shown["M2"]
    (jump,) = [step for step in upright_at(shear.curve("Q1"), a, shear.across) if abs(step[1] - step[0]) > shear.pixel]
    assert jump == pytest.approx((-P * (1.0 - a / L), P * a / L), abs=0.5 * shear.pixel)
    exact = np.where(S < a, P * S * (L - a) / L, P * a * (L - S) / L)
    assert np.abs(heights(moment.curve("M2"), S) - exact).max() <= 0.5 * moment.pixel


def test_the_envelope_is_that_of_the_influence_lines(crossing: Study) -> None:
    require_influence_lines(crossing)


def test_however_quickly_it_crosses() -> None:
    """In a fiftieth of the run, where few instants are looked at."""
    require_influence_lines(study(SCENE.replace("DRIVE", f"{L / 2.0}*(1 + tanh(200*(t - 1)))")))


def require_influence_lines(run: Study) -> None:
    """Assert that the bands are those of all places of the load."""
    shown = panels_of(run, "along")
    for name, low, high in (("Q1", -P * (1.0 - S / L), P * S / L), ("M2", 0.0 * S, P * S * (L - S) / L)):
        found = edges(shown[name].areas[f"minimum and maximum of {name}"], S)
        assert np.abs(found[0] - low).max() <= shown[name].pixel
        assert np.abs(found[1] - high).max() <= shown[name].pixel


def test_the_envelope_ends_where_the_load_turns() -> None:
    """To and fro over a part of the beam: beyond it Q1 is what the load makes there from where it is, and no more."""
    part = study(SCENE.replace("DRIVE", "2 - cos(pi*t)"))  # from 1 to 3 m and back
    shear = panels_of(part, "along")["Q1"]
    low, high = edges(shear.areas["minimum and maximum of Q1"], S)
    before, beyond = S < 1.0 - 0.01, S > 3.0 + 0.01
    least = np.where(before, -P * 0.75, np.where(beyond, P * 0.25, -P * (1.0 - S / L)))
    most = np.where(before, -P * 0.25, np.where(beyond, P * 0.75, P * S / L))
    apart = np.minimum(np.abs(S - 1.0), np.abs(S - 3.0)) > 2.0 * shear.across
    assert np.abs(low - least)[apart].max() <= shear.pixel
    assert np.abs(high - most)[apart].max() <= shear.pixel


def test_a_trolley_that_stands_still() -> None:
    """Nothing passes any place then: the band is the curve, with its corner where the trolley stands."""
    shown = panels_of(study(SCENE.replace("DRIVE", "1.5 + 0*t")), "along")
    moment = shown["M2"]
    exact = np.where(S < 1.5, P * S * (L - 1.5) / L, P * 1.5 * (L - S) / L)
    assert np.abs(heights(moment.curve("M2"), S) - exact).max() <= 0.5 * moment.pixel
    for found in edges(moment.areas["minimum and maximum of M2"], S):
        assert np.abs(found - exact).max() <= moment.pixel


@pytest.mark.parametrize("drive", [f"{L / 2.0}*(1 + tanh(200*(t - 1)))", f"{L / 2.0}*t", f"{L / 2.0}*(1 - cos(pi*t))"])
@pytest.mark.third
def test_no_shear_is_larger_than_the_load(drive: str) -> None:
    """Nor where it comes to a support, or begins there: the extremes searched along the beam and in time."""
    run = study(SCENE.replace("DRIVE", drive))
    for how in ("min", "max"):
        assert abs(measure_number(parse_measure(f"{how} sections.along.Q1"), run)[0].value) == pytest.approx(
            P, rel=1e-9
        )
    assert measure_number(parse_measure("max sections.along.M2"), run)[0].value == pytest.approx(P * L / 4.0, rel=1e-9)
