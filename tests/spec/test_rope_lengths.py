"""A rope's driven length neither jumps nor vanishes on the way, as that of a driven rod."""

from __future__ import annotations

import pytest

from heuncli.base.errors import SolveError, SpecError
from heuncli.scene.file_format.load import load
from tests.shared.scenes import near, solved

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


def test_a_taut_rope_whose_points_coincide_is_refused_and_a_slack_one_falls_into_it() -> None:
    text = SCENE.replace("space: planar", "space: planar\ngravity: [0, -8]").replace("[0, -2]", "[0, 0]")
    with pytest.raises(SolveError) as found:
        solved(text.replace(", length: {}", "").format())
    (problem,) = found.value.problems
    assert (problem.code, problem.location and problem.location.path) == ("no-length", "couplings.r.through.1")
    r = solved(text.format("1, tension_only: true, restitution: 0"))  # after half a second it is taut, and bears
    near(r.bodies["a"]["position"][:, 1], [0.0, -1.0, -1.0], 1.0)
    near(r.couplings["r"]["tension"], [0.0, 8.0, 8.0], 8.0)
