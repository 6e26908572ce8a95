"""manual/signs.md, "Signs at a glance": a bar of weight 9.81 N hanging at rest."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.results.results import Results
from tests.shared.bars import HEAD
from tests.shared.scenes import near, solved

EXACT = 1e-14


def bar(support: str = "ball") -> Results:
    axis = ", axis: [0, 0, 1]" if support == "pin" else ""
    return solved(
        HEAD
        + f"""
bodies:
  bar:
    shapes: [{{type: cylinder, from: [0, 0, 0], to: [0, 0, -2], radius: 0.01, mass: 1}}]
    points: {{top: [0, 0, 0], end: [0, 0, -2]}}
joints: {{pivot: {{type: {support}, from: ground.O, to: bar.top{axis}}}}}
sections:
  along: {{body: bar, from: top, to: end, count: 5}}
  root: {{body: bar, at: top, normal: [0, 0, -1], side: beyond}}
"""
    )


@pytest.mark.parametrize("support", ["ball", "pin", "weld"])
def test_signs(support: str) -> None:
    found = bar(support)
    near(found.joints["pivot"]["force"][0], [0, 0, 9.81], 9.81, EXACT)
    near(found.foundation["force"][0], [0, 0, -9.81], 9.81, EXACT)
    near(found.foundation["supports"]["pivot"]["force"][0], [0, 0, -9.81], 9.81, EXACT)
    root, along = found.sections["root"], found.sections["along"]
    near([root["force"][0], along["force"][0, 0]], [[0, 0, -9.81]] * 2, 9.81, EXACT)
    near([root["N"][0], along["N"][0, 0]], [9.81, 9.81], 9.81, EXACT)


def test_the_pull_falls_off_downwards() -> None:
    """N = m g (1 − s/L), no shear, no moment; e1 = x."""
    run = bar().sections["along"]
    near(run["s"], [0, 0.5, 1, 1.5, 2], 1.0, EXACT)
    near(run["N"][0], 9.81 * np.array([1, 0.75, 0.5, 0.25, 0]), 9.81, EXACT)
    near(run["normal"][0], [0, 0, -1], 1.0, EXACT)
    near(run["first_axis"][0], [1, 0, 0], 1.0, EXACT)
    for name in ("Q1", "Q2", "T", "M1", "M2"):
        near(run[name], 0.0, 9.81, EXACT)
    assert run["side"] == ["beyond", None, None, None, None]


def test_a_beam_of_the_usual_book() -> None:
    """For a bar along +x with e1 = y up: Q1 = −V, M2 = +M (sagging positive). Two supports, load in the middle."""
    found = solved("""
heun: 1
gravity: [0, -10, 0]
ground: {points: {O: [0, 0, 0], R: [2, 0, 0]}}
bodies:
  beam:
    shapes: [{type: box, center: [1, 0, 0], size: [2, 0.1, 0.1], mass: 4}]
    points: {a: [0, 0, 0], m: [1, 0, 0], b: [2, 0, 0]}
joints:
  left: {type: ball, from: ground.O, to: beam.a}
  right: {type: line, from: ground.R, to: beam.b, axis: [1, 0, 0]}
forces: {load: {type: force, on: beam.m, vector: [0, -30, 0]}}
sections: {run: {body: beam, from: a, to: b, count: 5, first_axis: [0, 1, 0]}}
""")
    run = found.sections["run"]
    near(run["s"], [0, 0.5, 1, 1, 1.5, 2], 1.0, EXACT)
    assert run["side"] == ["beyond", None, "before", "beyond", None, "before"]
    V = np.array([35.0, 25, 15, -15, -25, -35])  # of the book: what the left part is pushed up by, less its loads
    M = np.array([0.0, 15, 25, 25, 15, 0])
    near(-run["Q1"][0], V, 35.0, EXACT)
    near(run["M2"][0], M, 35.0, EXACT)
    near(found.joints["left"]["force"][0], [0, 35, 0], 35.0, EXACT)
    near(found.joints["right"]["force"][0], [0, 35, 0], 35.0, EXACT)
