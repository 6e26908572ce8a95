"""Two opposite loads on a beam, close to each other: no shear is larger than the one, nor is one of the other sign."""

from __future__ import annotations

import pytest

from heuncli.study.queries.measure import find_peak
from tests.shared.scenes import study

P, CLOSE = 1000.0, (1e-14, 1e-12, 2e-12, 3e-12, 5e-12, 1e-11, 3e-11, 1e-10, 3e-10, 1e-9, 1e-6)
BEAM = f"""
heun: 1
title: Two loads, nearly at one place
space: planar
ground: {{points: {{A: [0, 0], B: [1, 0]}}}}
bodies:
  beam:
    shapes: [{{type: box, center: [0.5, 0, 0], size: [1, 0.1, 0.1], mass: 1}}]
    points: {{A: [0, 0], B: [1, 0], p: [FIRST, 0], q: [SECOND, 0]}}
joints:
  A: {{type: pin, from: ground.A, to: beam.A}}
  B: {{type: line, axis: [1, 0], from: ground.B, to: beam.B}}
forces:
  down: {{type: force, on: beam.p, vector: [0, {-P}]}}
  up: {{type: force, on: beam.q, vector: [0, {P}]}}
sections: {{beam: {{body: beam, from: A, to: B, count: 11}}}}
"""


@pytest.mark.parametrize("first", [2e-12, 0.1, 0.37, 0.4])
@pytest.mark.parametrize("apart", CLOSE)
@pytest.mark.third
def test_no_shear_is_larger_than_the_load(first: float, apart: float) -> None:
    """They are a couple P d, which the supports take by P d / L: Q1 = -P d outside, P - P d between them."""
    solved = study(BEAM.replace("FIRST", repr(first)).replace("SECOND", repr(first + apart)))
    greatest, least = (find_peak(solved, "sections.beam.Q1", how).value for how in ("max", "min"))
    rounding = 1e-12 * P
    assert -P * apart - rounding <= least <= rounding
    assert least - rounding <= greatest <= P + rounding
    if apart > 1e-7:
        assert greatest == pytest.approx(P - P * apart, abs=rounding)
    assert abs(find_peak(solved, "sections.beam.M2", "max").value) <= P * apart + rounding
