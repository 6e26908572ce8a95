"""Scenes that more than one part of the thresholds needs, and what reading or solving them says."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from heuncli.base.errors import HeunError
from heuncli.results.results import Results
from heuncli.scene.file_format.load import load
from tests.shared.scenes import solved


def read(text: str) -> str:
    """The code of the first error, else of the first warning, else `fine`."""
    try:
        spec = load("scene.yaml", text)
    except HeunError as error:
        return f"refused: {error.problems[0].code}"
    return f"warned: {spec.warnings[0].code}" if spec.warnings else "fine"


def bar(more: str = "", tail: str = "", inertia: str = "[0.08, 0.08, 0.001]", kind: str = "ball") -> str:
    """A bar of 1 m and 1 kg that hangs from the origin."""
    return f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar: {{mass: 1, center: [0, 0, -0.5], inertia: {inertia}, points: {{top: [0, 0, 0], end: [0, 0, -1]}}{more}}}
joints:
  pivot: {{type: {kind}, from: ground.O, to: bar.top}}
{tail}"""


BAR_SIZE = 1.25  # m, of the scene: twice the largest distance of O, top, centre and end from their mean


WEIGHT = 9.81


def verdict(text: str, right: Callable[[Results], None] = lambda found: None) -> str:
    """The code of a refusal, else the first warning's first words, else `fine`; numbers are held against `right`."""
    try:
        found = solved(text)
    except HeunError as error:
        return f"refused: {error.problems[0].code}"
    right(found)
    return f"warned: {found.warnings[0].split(' at ')[0]}" if found.warnings else "fine"


def four_bar(p: Sequence[float], q: Sequence[float], more: str = "", tail: str = "") -> str:
    """Bars of 1 kg in the plane, from (0, 0) to p and from (1, 0) to q, and a coupler from p to q."""
    P, Q = (f"[{float(x)!r}, {float(y)!r}, 0]" for x, y in (p, q))
    return f"""
heun: 1
space: planar
gravity: [0, -9.81, 0]
ground: {{points: {{A: [0, 0, 0], B: [1, 0, 0]}}}}
bodies:
  left: {{shapes: [{{type: rod, from: [0, 0, 0], to: {P}, mass: 1}}], points: {{f: [0, 0, 0], t: {P}}}{more}}}
  right: {{shapes: [{{type: rod, from: [1, 0, 0], to: {Q}, mass: 1}}], points: {{f: [1, 0, 0], t: {Q}}}}}
  top: {{shapes: [{{type: rod, from: {P}, to: {Q}, mass: 1}}], points: {{l: {P}, r: {Q}}}}}
joints:
  A: {{type: pin, from: ground.A, to: left.f}}
  B: {{type: pin, from: ground.B, to: right.f}}
  C: {{type: pin, from: left.t, to: top.l}}
  D: {{type: pin, from: top.r, to: right.t}}
{tail}"""
