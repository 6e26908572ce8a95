"""A rope's driven length neither jumps nor vanishes on the way, as that of a driven rod."""

from __future__ import annotations

import pytest

from heuncli.errors import SpecError
from heuncli.spec.load import load

SCENE = """heun: 1
space: planar
ground: {{points: {{O: [0, 0]}}}}
bodies: {{a: {{mass: 1, center: [0, 0], inertia: 1, points: {{p: [0, 0]}}, position: [0, -2]}}}}
joints: {{guide: {{type: slide, from: ground.O, to: a.p, axis: [0, 1]}}}}
couplings: {{r: {{type: rope, through: [ground.O, a.p], length: {}}}}}
analysis: {{duration: 1, samples: 3}}
"""


@pytest.mark.parametrize(
    ("length", "code"), [("2 if t < 0.5 else 1", "drive-jumps"), ("2 - 3*t", "drive-length"), ("2 - t", "")]
)
def test_driven_lengths(length: str, code: str) -> None:
    text = SCENE.format(length)
    if not code:
        assert load("rope.yaml", text).couplings
        return
    with pytest.raises(SpecError) as found:
        load("rope.yaml", text)
    assert [problem.code for problem in found.value.problems] == [code]
