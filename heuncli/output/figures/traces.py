"""The paths of named points over a run, as thin curves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.drawing.figure import PlaceLabel, Trace
from heuncli.output.figures.courses import FigureSource, choose_instants
from heuncli.output.figures.posed_machine import PosedMachine, to_pair
from heuncli.output.machine_geometry.poses import compute_poses
from heuncli.results.results import Array
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.labels import Labels

CENTER = "center"  # the centre of mass, unless the spec has a point of that name
MAX_REPORTED = 8  # paths of points that the spec reports
SAME_PATH = 1e-6  # of a path's size: closer paths are drawn once


class PointPath(NamedTuple):
    """A named point and its positions over the run, (n, 3), world axes."""

    name: str
    body: str
    positions: Array


def make_paths(source: FigureSource, names: Sequence[str]) -> list[PointPath]:
    """Make the paths of points, `body.point`, over the run up to its horizon."""
    study = source.study
    if not names or study.has_one_instant:
        return []
    poses = compute_poses(study, choose_instants(study))
    centers = {body.name: np.asarray(body.center) for body in study.setup.scene.mechanism.bodies}
    paths = []
    for name in names:
        body, _, point = name.partition(".")
        named_points = study.spec.bodies[body].points
        place = np.array(named_points[point]) if point in named_points else centers[body]
        paths.append(
            PointPath(name, body, np.array([poses.locate_points(body, place, k) for k in range(len(poses.times))]))
        )
    return paths


def make_reported_paths(source: FigureSource) -> list[PointPath]:
    """Make the paths of the points that the spec reports and that move: each path once, and of many the first ones."""
    spec = source.study.spec
    if "points" not in (spec.report.results or ()):
        return []
    paths: list[PointPath] = []
    for path in make_paths(
        source, [f"{body}.{point}" for body, body_spec in spec.bodies.items() for point in body_spec.points]
    ):
        size = float(np.ptp(path.positions, axis=0).max())
        if size > 0.0 and not any(
            np.allclose(path.positions, other.positions, rtol=0.0, atol=SAME_PATH * size) for other in paths
        ):
            paths.append(path)
    return paths[:MAX_REPORTED]


def project_path(posed_machine: PosedMachine, path: PointPath) -> Array:
    """Project a path to the view, (n, 2) in the unit of the figure."""
    return np.asarray(posed_machine.size * posed_machine.view.project(path.positions))


def draw_paths(posed_machine: PosedMachine, paths: Sequence[PointPath]) -> Iterator[Trace]:
    """Draw the paths."""
    for path in paths:
        x, y = project_path(posed_machine, path).T
        yield Trace(path.name, x, y, posed_machine.pens[path.body], is_thin=True)


def label_paths(posed_machine: PosedMachine, paths: Sequence[PointPath], labels: Labels) -> Iterator[PlaceLabel]:
    """Yield the labels of the points at the beginning of their paths."""
    for path in paths:
        point = path.name.partition(".")[2]
        text = describe_object("points", path.name, labels)
        if point == CENTER and point not in posed_machine.spec.bodies[path.body].points:
            text = f"{describe_object('bodies', path.body, labels)}, centre of mass"
        yield PlaceLabel(*to_pair(project_path(posed_machine, path)[0]), text, text, posed_machine.pens[path.body])
