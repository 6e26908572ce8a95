"""Directions count by their ratios: of any length that is read they are the same, and none is lost in its square."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.errors import SpecError
from heuncli.results.results import Results
from tests.shared.scenes import solved

SCENE = """\
heun: 1
gravity: [0, 0, -10]
ground: {points: {O: [0, 0, 0]}}
bodies:
  bar:
    shapes: [{type: box, center: [0.5, 0, 0], size: [1, 0.1, 0.2], mass: 2, orientation: BOX}]
    points: {a: [0, 0, 0], b: [1, 0, 0]}
    orientation: TURN
  rod: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}, position: [0, 5, 0]}
joints:
  p: {type: pin, from: ground.O, to: bar.a, axis: [0, S, 0], to_axis: [0, S, 0]}
  q: {type: plane, from: {body: ground, at: [0, 5, 0]}, to: rod.c, normal: [0, 0, S]}
sections: {cut: {body: bar, at: [0.4, 0, 0], normal: [S, 0, 0], first_axis: [0, 0, S]}}
"""
TURNS = (
    "{axis: [0, S, 0], angle: 30 deg}", "{rodrigues: [0, 0.2, 0]}", "{quaternion: [0.96, 0, 0.28, 0]}",
    "{matrix: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}",
)  # fmt: skip


def run(size: str, turn: str = TURNS[0], box: str = "{axis: [S, 0, 0], angle: 0}") -> Results:
    return solved(SCENE.replace("TURN", turn).replace("BOX", box).replace("S,", f"{size},").replace("S]", f"{size}]"))


@pytest.mark.parametrize("size", ["1e-60", "3e-31", "7e29", "1e60"])
@pytest.mark.parametrize("turn", TURNS)
def test_of_any_length_that_is_read(size: str, turn: str) -> None:
    wanted, found = run("1", turn), run(size, turn)
    for a, b in ((wanted.joints["p"], found.joints["p"]), (wanted.sections["cut"], found.sections["cut"])):
        for name in ("force", "moment"):
            assert np.allclose(a[name], b[name], rtol=0.0, atol=1e-12)
    assert np.allclose(wanted.sections["cut"]["first_axis"], found.sections["cut"]["first_axis"], atol=1e-15)


@pytest.mark.parametrize("size", ["1e-200", "1e200", "1e-61", "5e-324"])
def test_beyond_it_is_refused_not_zero(size: str) -> None:
    with pytest.raises(SpecError) as caught:
        run(size)
    assert {problem.code for problem in caught.value.problems} == {"magnitude"}
    assert len(caught.value.problems) == 7


@pytest.mark.parametrize("large", ["1e17", "1e30", "1e60"])
def test_rodrigues_numbers_come_to_half_a_turn(large: str) -> None:
    found = run("1", f"{{rodrigues: [0, {large}, 0]}}")
    assert np.allclose(found.bodies["bar"]["rotation"][0], np.diag([-1.0, 1.0, -1.0]), rtol=0.0, atol=1e-15)


@pytest.mark.parametrize(("turn", "words"), [
    ("{matrix: [[1e60, 0, 0], [0, 1, 0], [0, 0, 1]]}", "not perpendicular and of length 1"),
    ("{quaternion: [1e60, 0, 0, 0]}", "has length 1e+60"),
    ("{quaternion: [1e-60, 0, 0, 0]}", "has length 1e-60"),
])  # fmt: skip
def test_what_has_a_length_of_its_own(turn: str, words: str) -> None:
    with pytest.raises(SpecError) as caught:
        run("1", turn)
    assert words in str(caught.value)
