"""The tips of vectors over a run, in the plane in which they are drawn, and the largest of them.

The largest is that of the components in the plane, searched between the samples.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.figures.courses import (
    FigureSource,
    NotDrawable,
    choose_instants,
    describe_number,
    find_values,
    find_vectors,
    is_varying,
)
from heuncli.output.figures.planes import Plane, choose_plane, make_axis_plane
from heuncli.output.figures.turning import TurningRun, VectorSource, find_turning_run, list_angle_paths
from heuncli.results.results import Array
from heuncli.results.results_schema import SPACE
from heuncli.scene.file_format.loads import Actuator
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import GROUND
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.labels import make_unit_labels
from heuncli.study.queries.measure_uncertainty import find_search_error, find_unit
from heuncli.study.queries.study import Study
from heuncli.study.search import extremes

MIN_PEAK_RATIO = 4.0  # of the mean over a cycle: a gas force with a higher peak fires


class TipCurve(NamedTuple):
    """The tips of a vector (n, 3) over the instants of a turning run, with their plane, name, caption and pen."""

    name: str
    path: str
    unit: str
    pen: int
    study: Study
    turning: TurningRun
    vectors: Array
    plane: Plane
    caption: str

    @property
    def x(self) -> Array:
        """The components to the right."""
        return self.plane.project(self.vectors)[0]

    @property
    def y(self) -> Array:
        """The components upwards."""
        return self.plane.project(self.vectors)[1]


class LargestVector(NamedTuple):
    """The largest vector: its two components, its magnitude in the plane with the stated error, and its instant.

    is_constant: whether all vectors have this magnitude
    """

    x: float
    y: float
    magnitude: float
    error: float
    time: float
    is_constant: bool


def make_tip_curves(
    sources: Sequence[FigureSource], paths: Sequence[str], axes: str, view: str | None
) -> Iterator[TipCurve]:
    """Yield the curves, each with its pen. Raises NotDrawable."""
    number = 0
    for source in sources:
        study = source.study
        for path in paths:
            _require_vector(study, path)
        turning = _find_turning_run(study, paths)
        for path in paths:
            vectors = find_vectors(study, path, turning.times)
            plane = (
                make_axis_plane(view)
                if view is not None
                else choose_plane(study, path, vectors, turning.times, axes, turning.path)
            )
            name = f"{source.name}: {path}" if source.name else path
            words = describe_number(source, path)
            caption = f"{source.name}: {words}" if source.name else words
            yield TipCurve(name, path, find_unit(path, study.spec), number, study, turning, vectors, plane, caption)
            number += 1


def _require_vector(study: Study, path: str) -> None:
    """Raise NotDrawable if a path is no vector over several instants."""
    numbers = study.find_numbers(path)
    if numbers.axes != (SPACE,) or not numbers.is_timed:
        message = f"polar {path}: a polar diagram needs a vector over time, and this is not one"
        raise NotDrawable(message, "for example polar joints.main, or polar foundation")
    if study.has_one_instant or len(choose_instants(study)) < 2:
        message = f"polar {path}: there is only one instant, so no curve"
        raise NotDrawable(message, "define a motion: analysis.duration")


def _find_turning_run(study: Study, paths: Sequence[str]) -> TurningRun:
    """Find the part of a run that is shown."""
    candidates = [path for path in list_angle_paths(study.spec) if path.split(".")[1] in study.results.coordinates]
    errors = [find_search_error(study, study.find_numbers(path).keys) for path in paths]
    vectors = VectorSource(
        lambda t: np.stack([find_vectors(study, path, t) for path in paths], axis=1), np.nan_to_num(errors, posinf=0.0)
    )
    return find_turning_run(study, choose_instants(study), candidates, vectors)


def list_firing_paths(spec: Spec) -> list[str]:
    """List the paths of the forces that may be those of gas: actuators with an end on the ground."""
    return [
        f"forces.{name}.value"
        for name, force in spec.forces.items()
        if isinstance(force, Actuator) and GROUND in (force.from_.body, force.to.body)
    ]


def find_firings(curve: TipCurve) -> Iterator[tuple[float, str]]:
    """Find the instants of firing in a cycle of a crank: where an actuator on the ground has a sharp peak."""
    turning, spec = curve.turning, curve.study.spec
    if not turning.path:
        return
    for path in list_firing_paths(spec):
        values = np.abs(find_values(curve.study, path, turning.times))
        if np.isfinite(values).all() and values.max() > MIN_PEAK_RATIO * values.mean():
            k = int(values.argmax())
            angle = turning.degrees[k] % (360.0 * turning.turns or math.inf)
            name = describe_object("forces", path.split(".")[1], make_unit_labels(spec))
            yield float(turning.times[k]), f"{name} fires, {angle:.0f}°"


def find_largest(curve: TipCurve) -> LargestVector | None:
    """Find the largest vector in the plane; None if none is known."""
    study, plane = curve.study, curve.plane

    def sample(times: Array) -> Array:
        x, y = plane.project(find_vectors(study, curve.path, times))
        return np.asarray((x * x + y * y)[:, None])

    search_times = study.search_times
    times = curve.turning.times
    times = np.union1d(times, search_times[(search_times >= times[0]) & (search_times <= times[-1])])
    error = find_search_error(study, study.find_numbers(curve.path).keys)
    found = extremes.search_extremes(sample, times, errors=np.array([error]), is_squared=np.array([True]), sides=(1.0,))
    time = float(found.high_at[0])
    if not np.isfinite(found.high[0]):
        return None
    x, y = map(float, plane.project(find_vectors(study, curve.path, np.array([time]))[0]))
    size, error = math.sqrt(float(found.high[0])), 0.0 if math.isnan(error) else error
    smallest = float(np.nanmin(np.hypot(curve.x, curve.y)))
    return LargestVector(x, y, size, error, time, not is_varying(smallest, size, error))
