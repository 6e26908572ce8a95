"""The ways of named points over a run, as thin curves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import PlaceLabel, Trace
from heuncli.output.figures.courses import Pictured, instants
from heuncli.output.figures.machine_items import Stood, on_paper
from heuncli.output.machine_geometry.poses import poses_of
from heuncli.results.results import Array

CENTER = "center"  # a body's point of that name is its centre of mass, where the spec names none so
MOST = 8  # ways that are drawn because the spec reports its points
SAME_WAY = 1e-6  # of how far a way goes: two that are nearer are drawn as one


class Traced(NamedTuple):
    """A named point and its way over the run, (n, 3), world axes."""

    name: str
    body: str
    way: Array


def traced(source: Pictured, names: Sequence[str]) -> list[Traced]:
    """The ways of points, `body.point`, over the run, up to its horizon."""
    study = source.study
    if not names or study.of_one_instant:
        return []
    poses = poses_of(study, instants(study))
    centers = {body.name: np.asarray(body.center) for body in study.setup.scene.mechanism.bodies}
    found = []
    for name in names:
        body, _, point = name.partition(".")
        own = study.spec.bodies[body].points
        place = np.array(own[point]) if point in own else centers[body]
        found.append(Traced(name, body, np.array([poses.at(body, place, k) for k in range(len(poses.times))])))
    return found


def reported(source: Pictured) -> list[Traced]:
    """Those that the spec reports and that move: each way once, and of many the first."""
    spec = source.study.spec
    if "points" not in (spec.report or ()):
        return []
    found: list[Traced] = []
    for one in traced(source, [f"{body}.{point}" for body, own in spec.bodies.items() for point in own.points]):
        size = float(np.ptp(one.way, axis=0).max())
        if size > 0.0 and not any(np.allclose(one.way, other.way, rtol=0.0, atol=SAME_WAY * size) for other in found):
            found.append(one)
    return found[:MOST]


def seen(stood: Stood, one: Traced) -> Array:
    """A way as it is seen, (n, 2) in the unit of the picture."""
    return np.asarray(stood.size * stood.view.flat(one.way))


def curves(stood: Stood, ways: Sequence[Traced]) -> Iterator[Trace]:
    """The curves."""
    for one in ways:
        x, y = seen(stood, one).T
        yield Trace(one.name, x, y, stood.pens[one.body], thin=True)


def names(stood: Stood, ways: Sequence[Traced]) -> Iterator[PlaceLabel]:
    """The names of the points, where their ways begin."""
    for one in ways:
        yield PlaceLabel(*on_paper(seen(stood, one)[0]), one.name, one.name, stood.pens[one.body])
