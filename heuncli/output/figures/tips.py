"""The tips of vectors over a run, in the plane that they are drawn in, and the largest of them.

The largest is that of the parts in the plane, searched between the samples.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.figures.courses import Pictured, instants, varies, vectors_at
from heuncli.output.figures.planes import Plane, plane_of, plane_seen_along
from heuncli.output.figures.refusals import NotDrawable
from heuncli.output.figures.turning import TurnedVectors, TurningRun, angles_of, turning_of
from heuncli.results.results import Array
from heuncli.results.results_schema import SPACE
from heuncli.study.ask.measure import stated_error
from heuncli.study.ask.study import Study
from heuncli.study.quantities.stated import unit_of
from heuncli.study.search import extremes


class TipCurve(NamedTuple):
    """The tips of a vector: (n, 3), in a plane, over the instants of a turning; named in the legend, with its pen."""

    name: str
    path: str
    unit: str
    pen: int
    study: Study
    turning: TurningRun
    vectors: Array
    plane: Plane

    @property
    def x(self) -> Array:
        """To the right."""
        return self.plane.project(self.vectors)[0]

    @property
    def y(self) -> Array:
        """Up."""
        return self.plane.project(self.vectors)[1]


class Largest(NamedTuple):
    """The largest vector: its two parts, its magnitude in the plane and its stated error, its instant.

    steady: whether all are as large.
    """

    x: float
    y: float
    size: float
    error: float
    at: float
    steady: bool


def tip_curves(sources: Sequence[Pictured], paths: Sequence[str], axes: str, view: str | None) -> Iterator[TipCurve]:
    """The curves, each with its pen. Raises NotDrawable."""
    number = 0
    for source in sources:
        study = source.study
        for path in paths:
            _require_vector(study, path)
        turning = _turning(study, paths)
        for path in paths:
            vectors = vectors_at(study, path, turning.times)
            plane = (
                plane_seen_along(view)
                if view is not None
                else plane_of(study, path, vectors, turning.times, axes, turning.path)
            )
            name = f"{source.name}: {path}" if source.name else path
            yield TipCurve(name, path, unit_of(path, study.spec), number, study, turning, vectors, plane)
            number += 1


def _require_vector(study: Study, path: str) -> None:
    """Raise NotDrawable where there is no vector over the instants."""
    numbers = study.numbers(path)
    if numbers.axes != (SPACE,) or not numbers.timed:
        message = f"polar {path}: a polar diagram is of a vector over the instants, and this is none"
        raise NotDrawable(message, "such as polar joints.main, or polar foundation")
    if study.of_one_instant or len(instants(study)) < 2:
        message = f"polar {path}: there is one instant, and so no curve"
        raise NotDrawable(message, "give the scene a motion: analysis.duration")


def _turning(study: Study, paths: Sequence[str]) -> TurningRun:
    """What is seen of a run."""
    candidates = [path for path in angles_of(study.spec) if path.split(".")[1] in study.results.coordinates]
    errors = [stated_error(study, study.numbers(path).keys) for path in paths]
    looked_at = TurnedVectors(
        lambda t: np.stack([vectors_at(study, path, t) for path in paths], axis=1), np.nan_to_num(errors, posinf=0.0)
    )
    return turning_of(study, instants(study), candidates, looked_at)


def largest_of(curve: TipCurve) -> Largest | None:
    """The largest vector in the plane; None where none is known."""
    study, plane = curve.study, curve.plane

    def sample(times: Array) -> Array:
        x, y = plane.project(vectors_at(study, curve.path, times))
        return np.asarray((x * x + y * y)[:, None])

    looked_at = study.search_times
    times = curve.turning.times
    times = np.union1d(times, looked_at[(looked_at >= times[0]) & (looked_at <= times[-1])])
    error = stated_error(study, study.numbers(curve.path).keys)
    found = extremes.search(sample, times, errors=np.array([error]), even=np.array([True]), sides=(1.0,))
    at = float(found.high_at[0])
    if not np.isfinite(found.high[0]):
        return None
    x, y = map(float, plane.project(vectors_at(study, curve.path, np.array([at]))[0]))
    size, error = math.sqrt(float(found.high[0])), 0.0 if math.isnan(error) else error
    least = float(np.nanmin(np.hypot(curve.x, curve.y)))
    return Largest(x, y, size, error, at, not varies(least, size, error))
