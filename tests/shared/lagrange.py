"""The Lagrange side of scenes as tests ask for it, and the two mechanisms that most of its closed forms are of."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from heuncli.analyses.lagrange.results import LagrangeResults
from heuncli.analyses.lagrange.study import LagrangeOptions, solve_lagrange
from heuncli.scene.file_format.load import load
from tests.oracle.values import to_yaml

ROD = "shapes: [{type: rod, from: [0, 0, 0], to: [0, 0, -1], mass: 1}], points: {o: [0, 0, 0], e: [0, 0, -1]}"
DOUBLE = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  a: {{{rod}}}
  b: {{{rod}}}
joints:
  A: {{type: pin, axis: [0, -1, 0], from: ground.O, to: a.o, initial: {{angle: 0.7, rate: {u[0]}}}}}
  B: {{type: pin, axis: [0, -1, 0], from: a.e, to: b.o, initial: {{angle: -1.1, rate: {u[1]}}}}}
sections: {{cut: {{body: b, at: [0, 0, -0.4], normal: [0, 0, -1]}}}}
{more}
"""


def double(more: str = "analysis: {type: state}", u: tuple[float, float] = (1.5, -2.0)) -> str:
    """Two uniform rods of 1 m and 1 kg, one on the other, at relative angles 0.7 and -1.1."""
    return DOUBLE.format(rod=ROD, u=u, more=more)


def told(scene: str | Path | Mapping[str, Any], **asked: Any) -> LagrangeResults:
    """The Lagrange side of a scene: a file, a text, or the oracle's dict."""
    if isinstance(scene, Path):
        return solve_lagrange(load(str(scene)), LagrangeOptions(**asked))
    return solve_lagrange(
        load("scene.yaml", scene if isinstance(scene, str) else to_yaml(scene)), LagrangeOptions(**asked)
    )
