"""One number over the instants of a run as a curve, and the angle in which the run turns, to draw it over.

A motion may reverse many times between two samples. A course therefore has the samples, the instants of the search for
extremes, both sides of every jump, and further instants between them if these are few. It is interrupted where the
number is not known.

A cycle is one turn or two, as of four-stroke engines. The motion is periodic if the cycle before is equal at the same
angles. A run that is not periodic, or has only one cycle, is shown as a whole.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import HeunError, Problem
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import record
from heuncli.output.drawing.axes import format_short
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.names import GROUND
from heuncli.study.quantities.captions import describe_path
from heuncli.study.quantities.labels import make_labels
from heuncli.study.queries import curves
from heuncli.study.queries.curves import MAX_SEARCH_INSTANTS, choose_curve_instants, sample_numbers
from heuncli.study.queries.measure import NotOneNumber, Peak, find_peak, make_several_error
from heuncli.study.queries.measure_uncertainty import find_unit, measure_uncertainty
from heuncli.study.queries.study import Study
from heuncli.study.search.grid import find_jump_sides

CASE_SUFFIX = " (case "  # at the end of a title
VISIBLE_JUMP = 0.01  # share of the range: larger jumps are drawn as jumps
TURN = 2.0 * math.pi
MIN_SPAN = 0.25 * TURN  # an angle that turns less is no crank angle
N_INSTANTS = 721  # instants of the curves
N_COMPARED = 128  # angles at which two cycles are compared
TURN_TOLERANCE = 1e-6  # of a turn: tolerance for a run that ends with a whole turn


@record
class FigureSource:
    """A solved scene in a figure, and its name there (file and case); empty if it is the only one."""

    name: str
    study: Study


def make_title(sources: Sequence[FigureSource]) -> str:
    """Return the title of one or several runs; their cases are shown in the legend."""
    titles = [source.study.results.title for source in sources]
    if len(titles) == 1:
        return titles[0]
    return " · ".join(dict.fromkeys(title.rpartition(CASE_SUFFIX)[0] or title for title in titles))


def describe_number(source: FigureSource, path: str) -> str:
    """Describe a path in words, with the first letter in capital."""
    text = describe_path(path, make_labels(source.study.spec))
    return f"{text[:1].upper()}{text[1:]}"


class NumberCourse(NamedTuple):
    """A number over some instants (n,): its path, SI unit, stated error, lowest and highest value."""

    path: str
    unit: str
    times: Array
    values: Array
    error: float | None
    low: Peak
    high: Peak


def is_claimed(study: Study) -> bool:
    """Return whether the first instant of a run is before its horizon."""
    horizon = study.results.horizon
    return study.has_one_instant or horizon is None or bool(study.results.time[0] < horizon)


def require_claimed(study: Study) -> None:
    """Raise NotDrawable if all instants of a run are beyond its horizon."""
    if not is_claimed(study):
        horizon, first = study.results.horizon, study.results.time[0]
        message = f"no results are claimed from t = {horizon:.6g} s on, and the first output time is t = {first:.6g} s"
        raise NotDrawable(message, "use earlier output times or a smaller --tolerance")


def choose_instants(study: Study, max_search_instants: int = MAX_SEARCH_INSTANTS) -> Array:
    """Choose the instants of curves, as `choose_curve_instants` does.

    Raises NotDrawable if the horizon is before all of them.
    """
    require_claimed(study)
    return choose_curve_instants(study, max_search_instants)


def is_varying(low: float, high: float, error: float) -> bool:
    """Return whether a number with an error varies, given its lowest and highest value."""
    return high - low > max(tolerances.THROUGHOUT * max(abs(low), abs(high)), 2.0 * error)


def find_jumps(course: NumberCourse) -> Array:
    """Find the instants at which a course visibly jumps."""
    step = np.abs(np.diff(course.values))
    is_visible = step > VISIBLE_JUMP * (course.high.value - course.low.value)
    return np.asarray(course.times[:-1][find_jump_sides(course.times) & is_visible])


def make_course(study: Study, path: str, times: Array) -> NumberCourse:
    """Make the course of a number; for a vector that of its magnitude. Raises NotOneNumber, SpecError
    [unknown-path].
    """
    require_one_number(study, path)
    low, high = (find_peak(study, path, how) for how in ("min", "max"))
    values = find_values(study, path, times)
    error = measure_uncertainty(study, path, "abs", high.value)
    return NumberCourse(path, find_unit(path, study.spec), times, values, error, low, high)


def require_one_number(study: Study, path: str) -> None:
    """Raise NotOneNumber for a path without instants, or with several numbers that are no vector at each instant."""
    numbers = study.find_numbers(path)
    if not numbers.is_timed:
        raise NotOneNumber(f"{path} does not vary with time", f"use heun run SPEC --measure {path}")
    if numbers.axes and not (numbers.is_vector and len(numbers.axes) == 1):
        raise make_several_error(path, numbers)


def find_values(study: Study, path: str, times: Array) -> Array:
    """Return the number at a path at some instants, (n,); for a vector its magnitude."""
    values = curves.sample_values(study, path, times)
    if study.find_numbers(path).is_vector:
        return np.asarray(np.sqrt(np.einsum("nk,nk->n", values, values)))
    return values.reshape(len(times))


def find_vectors(study: Study, path: str, times: Array) -> Array:
    """Return the vectors at a path at some instants of the run, (n, 3)."""
    return curves.sample_values(study, path, times)


class NotDrawable(HeunError):
    """The requested quantity cannot be drawn in this kind of figure."""

    exit_code = 2

    def __init__(self, message: str, hint: str) -> None:
        super().__init__(Problem("bad-option", message, hint=hint))


class VectorSource(NamedTuple):
    """Vectors that are evaluated at instants: (n,) to (n, k, 3), and their errors (k,)."""

    evaluate: Callable[[Array], Array]
    errors: Array


class TurningRun(NamedTuple):
    """The instants of a run that are shown, and the angle in which it keeps turning.

    path: of the angle, empty if there is none
    turns: number of turns of the cycle, 0 if the motion is not periodic
    """

    times: Array
    path: str
    angles: Array
    turns: int

    @property
    def direction(self) -> float:
        """1 if the angle rises, -1 if it falls."""
        return 1.0 if self.angles[-1] > self.angles[0] else -1.0

    @property
    def degrees(self) -> Array:
        """The angles in degrees; in a periodic motion they start at the zero of the cycle."""
        degrees = np.degrees(self.angles)
        if self.turns:
            cycle = 360.0 * self.turns
            degrees = degrees - cycle * math.floor(float(min(degrees[0], degrees[-1])) / cycle + TURN_TOLERANCE)
        return np.asarray(degrees)

    def describe(self, angle_name: str) -> str:
        """Describe the part of the run that is shown; angle_name: words for its angle."""
        span = f"t = {format_short(float(self.times[0]), 4)} to {format_short(float(self.times[-1]), 4)} s"
        if not self.turns:
            return f"the whole run, {span}"
        return f"the last {'revolution' if self.turns == 1 else 'two revolutions'} of {angle_name}, {span}"


def list_angle_paths(spec: Spec) -> list[str]:
    """Return the paths of the angles in which a scene may turn: driven ones, else those against the ground, else
    all.
    """
    turning = {name: joint for name, joint in spec.joints.items() if "angle" in JOINTS[joint.kind].coordinates}
    driven = [drive.joint for drive in spec.drives.values() if drive.joint in turning]
    grounded = [name for name, joint in turning.items() if GROUND in (joint.a, joint.b)]
    return [f"coordinates.{name}.angle" for name in dict.fromkeys(driven or grounded or turning)]


def find_turning_run(study: Study, times: Array, candidates: Sequence[str], vectors: VectorSource) -> TurningRun:
    """Find how a run turns, by the angle among the candidates that turns farthest.

    times (n,): the instants of the whole run
    """
    whole_run, farthest = TurningRun(times, "", np.zeros(0), 0), MIN_SPAN
    for path in candidates:
        angles = sample_numbers(study, path, times)
        if np.isfinite(angles).all() and is_monotonic(angles) and find_span(angles) > farthest:
            whole_run, farthest = TurningRun(times, path, angles, 0), find_span(angles)
    for turns in (1, 2):
        if whole_run.path and is_periodic(study, whole_run, turns, vectors):
            return select_last_turns(study, whole_run, turns)
    return whole_run


def is_monotonic(angles: Array) -> bool:
    """Return whether angles only rise or only fall."""
    steps = np.diff(angles)
    return bool((steps >= 0.0).all() or (steps <= 0.0).all())


def find_span(angles: Array) -> float:
    """Return the angle from the first to the last."""
    return abs(float(angles[-1] - angles[0])) if len(angles) else 0.0


def is_periodic(study: Study, whole_run: TurningRun, turns: int, vectors: VectorSource) -> bool:
    """Return whether the last `turns` turns equal those before them."""
    angle = whole_run.direction * TURN * turns
    if find_span(whole_run.angles) < 2.0 * abs(angle) - TURN_TOLERANCE * TURN:
        return False
    last_cycles = refine_from(study, whole_run, float(find_instants(whole_run, whole_run.angles[-1:] - 2.0 * angle)[0]))
    angles_back = angle * np.linspace(1.0, 0.0, N_COMPARED)
    last, before = (
        vectors.evaluate(find_instants(last_cycles, last_cycles.angles[-1] - angles_back - k * angle)) for k in (0, 1)
    )
    size, differences = (np.nanmax(np.abs(values), axis=(0, 2), initial=0.0) for values in (last, last - before))
    # each by its own size
    return bool((differences <= np.maximum(tolerances.SAME_TURN_DRAWN * size, 2.0 * vectors.errors)).all())


def select_last_turns(study: Study, whole_run: TurningRun, turns: int) -> TurningRun:
    """Return the last `turns` turns of a run."""
    angle = whole_run.direction * TURN * turns
    last_cycles = refine_from(study, whole_run, float(find_instants(whole_run, whole_run.angles[-1:] - 2.0 * angle)[0]))
    begin = float(find_instants(last_cycles, last_cycles.angles[-1:] - angle)[0])
    return refine_from(study, whole_run, begin)._replace(turns=turns)


def refine_from(study: Study, whole_run: TurningRun, begin: float) -> TurningRun:
    """Return a run from an instant on, with closely spaced instants."""
    even_times = np.linspace(begin, whole_run.times[-1], N_INSTANTS)
    times = np.unique(np.concatenate([even_times, whole_run.times[whole_run.times > begin]]))
    return TurningRun(times, whole_run.path, sample_numbers(study, whole_run.path, times), 0)


def find_instants(turning: TurningRun, angles: Array) -> Array:
    """Return the instants at which a run has some angles, by linear interpolation, (n,)."""
    order = slice(None, None, int(turning.direction))
    return np.asarray(np.interp(angles, turning.angles[order], turning.times[order]))
