"""A blow is the limit of a short steep force: half sines of 1 ms, 0.1 ms and 0.01 ms with the blow's impulse.

What differs is of the first order in the force's duration: ten times less each, in the motion behind it, and in what
joints, foundation and cuts take up in that time (less what they carry anyway, which is of the same order).
"""

from __future__ import annotations

import itertools
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest

from heuncli.results.results import Array, Results
from tests.shared.golden_a import GOLDEN_A
from tests.shared.scenes import solved

pytestmark = pytest.mark.heavy  # the plain kernel has the same bits

AT = 0.2  # [s] the blow's instant
DURATIONS = (1e-3, 1e-4, 1e-5)
POINTS = 201  # of Simpson's rule over a half sine: off by 1e-9 of it
SCENES = {
    "chain": (
        GOLDEN_A.replace("mass: 2, center: [0.5, 0.1, -0.05], inertia: [0.2, 0.5, 0.6]",
                         "shapes: [{type: box, center: [0.5, 0.1, 0], size: [1.2, 0.3, 0.2], density: 20}]")
        .replace("points: {base: [0, 0, 0]},", "points: {base: [0, 0, 0], struck: [0.9, 0, 0.3]},"),
        "two.struck", (1.0, 2.0, -1.0), "one", [0.45, 0.1, 0.0]),
    "loop": (
        """
heun: 1
gravity: [0, -9.81, 0]
ground: {points: {A: [0, 0, 0], D: [0.5, 0, 0]}}
bodies:
  crank:
    shapes: [{type: box, center: [0.1, 0, 0], size: [0.3, 0.04, 0.02], density: 2000}]
    points: {A: [0, 0, 0], B: [0.2, 0, 0]}
  coupler:
    shapes: [{type: box, center: [0.25, 0, 0], size: [0.6, 0.05, 0.02], density: 1500}]
    points: {B: [0, 0, 0], C: [0.5, 0, 0], struck: [0.2, 0.1, 0]}
    near: {position: [0.1, 0.17, 0]}
  rocker:
    shapes: [{type: box, center: [0.15, 0, 0], size: [0.4, 0.04, 0.02], density: 2000}]
    points: {D: [0, 0, 0], C: [0.3, 0, 0]}
    near: {position: [0.5, 0, 0], orientation: {axis: [0, 0, 1], angle: 70 deg}}
joints:
  A: {type: pin, from: ground.A, to: crank.A, axis: [0, 0, 1], initial: {angle: 60 deg, rate: 4}}
  B: {type: pin, from: crank.B, to: coupler.B, axis: [0, 0, 1]}
  C: {type: line, from: coupler.C, to: rocker.C, axis: [0, 0, 1]}
  D: {type: pin, from: ground.D, to: rocker.D, axis: [0, 0, 1]}
""", "coupler.struck", (3.0, -4.0, 0.5), "coupler", [0.3, 0.0, 0.0]),
}  # fmt: skip


class Taken(NamedTuple):
    """What a blow, or a short force, has done by the end of it: rates, and impulses by place."""

    rates: Array
    joints: Array
    foundation: Array
    cut: Array


def scene(name: str, more: str) -> str:
    text, _, _, body, at = SCENES[name]
    return text + f"sections: {{cut: {{body: {body}, at: {at}, normal: [1, 0.2, 0]}}}}\n" + more


def rates_of(found: Results, k: int) -> Array:
    return np.concatenate([np.concatenate([b["center_velocity"][k], b["angular_velocity"][k]])
                           for b in found.bodies.values()])  # fmt: skip


def impulses_of(blocks: dict[str, Any], what: tuple[str, ...] = ("force", "moment")) -> Array:
    return np.stack([b[w] for b in blocks.values() for w in what], axis=-2)


@cache
def struck(name: str) -> Taken:
    _, on, vector, _, _ = SCENES[name]
    blow = f"impulses: {{blow: {{on: {on}, vector: {list(vector)}, time: {AT}}}}}\n"
    found = solved(scene(name, blow + f"analysis: {{times: [0, {AT}], tolerance: 1e-12}}\n"))
    (hit,) = found.impulses
    ground = np.stack([hit["foundation"]["force"], hit["foundation"]["moment"]])
    return Taken(rates_of(found, 1), impulses_of(hit["joints"]), ground, impulses_of(hit["sections"]))


@cache
def pushed(name: str, duration: float) -> Taken:
    """The same impulse by a half sine from the blow's instant on; loads by Simpson's rule."""
    _, on, vector, _, _ = SCENES[name]
    shape = f"sin(pi*(t - {AT})/{duration})*step(t - {AT})*step({AT} + {duration} - t)*pi/(2*{duration})"
    parts = ", ".join(f'"({v})*{shape}"' for v in vector)
    times = AT + duration * np.linspace(0.0, 1.0, POINTS)
    asked = ", ".join(repr(float(t)) for t in [0.0, *times])
    push = f"forces: {{push: {{type: force, on: {on}, vector: [{parts}]}}}}\n"
    found = solved(scene(name, push + f"analysis: {{times: [{asked}], tolerance: 1e-12}}\n"))
    weights = np.full(POINTS, 2.0)
    weights[1::2] = 4.0
    weights[[0, -1]] = 1.0
    weights *= duration / (3 * (POINTS - 1))

    def summed(values: Array) -> Array:
        return np.asarray(np.tensordot(weights, values[1:], axes=1))

    ground = np.stack([found.foundation["force"], found.foundation["moment"]], axis=-2)
    joints, cut = impulses_of(found.joints), impulses_of(found.sections)
    return Taken(rates_of(found, POINTS), summed(joints), summed(ground), summed(cut))


@pytest.mark.parametrize("what", Taken._fields)
@pytest.mark.parametrize("name", SCENES)
def test_the_differences_shrink_with_the_duration(name: str, what: str) -> None:
    wanted = getattr(struck(name), what)
    size = float(np.nanmax(np.abs(wanted)))
    off = [float(np.nanmax(np.abs(getattr(pushed(name, d), what) - wanted))) for d in DURATIONS]
    assert off[0] < 0.5 * size
    for longer, shorter in itertools.pairwise(off):
        # halves of a per cent: the next order is a thousandth of the rates' 4 to 40 rad/s; Simpson's 1e-9 is no part
        assert shorter == pytest.approx(longer / 10, rel=0.1), off
