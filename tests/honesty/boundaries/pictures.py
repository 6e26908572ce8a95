"""What pictures say: that a number stays as it is, that a plane holds a vector, that a motion comes back, what acts."""

from __future__ import annotations

import functools
import math

import numpy as np

from heuncli.base.tolerances import EPS
from heuncli.output.figures.acting_loads import collect_loads
from heuncli.output.figures.courses import NotDrawable, TurningRun, VectorSource, find_turning_run, is_varying
from heuncli.output.figures.polar import make_notes
from heuncli.output.figures.scenes import compute_poses, pose_machine
from heuncli.output.figures.tips import LargestVector, TipCurve, choose_plane, make_axis_plane
from heuncli.output.web_page.frames import choose_frames
from heuncli.results.results import Array
from heuncli.study.quantities.table_units import Units
from heuncli.study.queries.study import Study
from tests.honesty.boundaries.part import Part, Row
from tests.honesty.boundaries.scenes import WEIGHT, bar
from tests.shared.scenes import near, study

ANGLE = "coordinates.pivot.angle"


@functools.cache
def turned() -> Study:
    """A bar that is turned twice, in two seconds."""
    tail = "drives: {d: {joint: pivot, angle: 2*pi*t}}\nanalysis: {duration: 2, samples: 9}"
    return study(bar(tail=tail, kind="pin, axis: [1, 0, 0]"))


def told_once(x: float) -> str:
    """A number between 1 - x and 1."""
    return "varies" if is_varying(1.0 - x, 1.0, 0.0) else "throughout"


def out_of_the_plane(x: float) -> str:
    """Two vectors that stand x of the larger one out of the plane of x and y."""
    vectors = np.array([[1.0, 0.5, x], [-0.3, 0.8, -x]])
    try:
        plane = choose_plane(turned(), "foundation.force", vectors, np.array([0.0, 2.0]), "world", "")
    except NotDrawable:
        return "no plane"
    return "".join(plane.names)


def across(x: float) -> str:
    """A vector of 1 N in the plane and x N across it."""
    vectors = np.array([[1.0, 0.0, x], [0.0, 0.5, 0.0]])
    whole = TurningRun(np.array([0.0, 2.0]), "", np.zeros(0), 0)
    curve = TipCurve("F", "foundation.force", "N", 0, turned(), whole, vectors, make_axis_plane("z"), "F")
    notes = make_notes(curve, LargestVector(1.0, 0.0, 1.0, 0.0, 0.0, is_constant=False), Units())
    return "told" if any("normal to the plane" in note for note in notes) else "silent"


def from_turn_to_turn(x: float) -> str:
    """A vector of 1 N that grows by x N a turn."""

    def growing(times: Array) -> Array:
        return (1.0 + x * times)[:, None, None] * np.array([[1.0, 0.0, 0.0]])

    run = turned()
    found = find_turning_run(run, run.results.time, [ANGLE], VectorSource(growing, np.zeros(1)))
    return "the last turn" if found.turns == 1 else "the whole run"


def carried(x: float) -> str:
    """A bar whose weight, but for x of it, a distributed load carries."""
    load = f"{{type: distributed, on: bar, from: top, to: end, vector: [0, 0, {WEIGHT * (1.0 - x)!r}]}}"
    run = study(bar(tail=f"forces: {{f: {load}}}", kind="weld"))
    poses = compute_poses(run, np.zeros(1))
    pulls = collect_loads(run, pose_machine(run.setup.scene, run.spec, poses, None, Units()).machine, poses).loads
    if not pulls:
        return "nothing"
    (pull,) = pulls
    near(pull.vector, [0.0, 0.0, x * WEIGHT], 4.0 * EPS * WEIGHT, 1.0)
    return pull.name


def between_frames(x: float) -> str:
    """A bar that turns by x rad from the first of two frames to the second."""
    tail = f"drives: {{d: {{joint: pivot, angle: {x!r}*t}}}}\nanalysis: {{duration: 1, samples: 2}}"
    frames = choose_frames(study(bar(tail=tail, kind="pin, axis: [1, 0, 0]")), np.zeros(0), 2)
    assert frames.times.tolist() == [0.0, 1.0]
    told = [f"up to {math.degrees(x):.0f}°" in sentence for sentence in frames.notes]
    return "torn" if told == [True] else "followed"


PART = Part(
    headings=("pictures",),
    rows=(
        Row("THROUGHOUT", told_once, "throughout", "varies"),
        Row("IN_ONE_PLANE", out_of_the_plane, "xy", "no plane"),
        Row("TOLD_ACROSS", across, "silent", "told"),
        Row("SAME_TURN_DRAWN", from_turn_to_turn, "the last turn", "the whole run"),
        Row("MAX_INTERPOLATED_TURN", between_frames, "followed", "torn"),
        Row("NOTHING_ACTS", carried, "nothing", "pivot"),
    ),
)
