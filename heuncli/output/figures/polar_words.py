"""Sentences on vectors over a run: whose loads, in which axes, the largest one with its direction and instant."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.output.drawing.ticks import format_short
from heuncli.output.figures.certain import format_certain
from heuncli.output.figures.courses import FigureSource
from heuncli.output.figures.planes import project_vectors
from heuncli.output.figures.tips import LargestVector, TipCurve
from heuncli.study.quantities.table_units import Units


def describe_runs(sources: Sequence[FigureSource], curves: Sequence[TipCurve], axes: str) -> Iterator[str]:
    """Yield what is shown of each run, whose loads these are, and in which axes."""
    for source in sources:
        curve = next(curve for curve in curves if curve.study is source.study)
        name = source.name or str(source.study.results.spec.get("path", ""))
        yield f"{name}: {curve.turning.description}"
    yield _describe_axes(axes, curves)


def _describe_axes(axes: str, curves: Sequence[TipCurve]) -> str:
    """Describe whose loads these are, and in which axes."""
    joints = [curve for curve in curves if curve.path.startswith("joints.")]
    phrases = ["joint: reaction of `from` on `to`"] if joints else []
    phrases += ["foundation: force on it"] if any(curve.path.startswith("foundation.") for curve in curves) else []
    if axes == "world" or not joints:
        return "; ".join([*phrases, "world axes"])
    bodies = {_find_body(curve, axes) for curve in joints}
    return "; ".join([*phrases, f"joints in the axes of {', '.join(sorted(bodies))} (`{axes}`)"])


def _find_body(curve: TipCurve, axes: str) -> str:
    """Return the body in whose axes a joint's loads are given."""
    joint = curve.study.spec.joints[curve.path.split(".")[1]]
    return joint.a if axes == "from" else joint.b


def make_notes(curve: TipCurve, largest: LargestVector | None, units: Units) -> Iterator[str]:
    """Yield the largest vector with its direction and instant, and what is not drawn."""
    unit, size = units.find(curve.unit)
    if largest is None:
        yield f"{curve.name}: open or unknown, not drawn"
        return
    magnitude_text = f"{format_certain(size * largest.magnitude, size * largest.error)} {unit}"
    if largest.is_constant:
        yield f"{curve.name}: {magnitude_text} at all times"
    else:
        yield f"{curve.name}: largest {magnitude_text} {_describe_largest(curve, largest)}"
    normal_components = project_vectors(curve.vectors, curve.plane.normal)
    largest_normal = float(np.nanmax(np.abs(normal_components), initial=0.0))
    if largest_normal > tolerances.TOLD_ACROSS * largest.magnitude:
        yield f"{curve.name}: normal to the plane up to {size * largest_normal:.4g} {unit}, not drawn"
    if np.isnan(curve.x + curve.y).any():
        yield f"{curve.name}: partly open or unknown, not drawn there"
    elif np.isnan(normal_components).any():
        yield f"{curve.name}: normal component open or unknown, not drawn"
    if "1" in curve.plane.names:
        words = (f"({', '.join(f'{x:.4g}' for x in e + 0.0)})" for e in (curve.plane.right, curve.plane.upward))
        yield f"{curve.name}: directions 1 and 2 are {' and '.join(words)}"


def _describe_largest(curve: TipCurve, largest: LargestVector) -> str:
    """Describe the direction, the instant and the crank angle of the largest vector."""
    first, second = curve.plane.names
    direction_text = (
        f"at {_format_degrees(math.degrees(math.atan2(largest.y, largest.x)), 360.0)} from {first} to {second}"
    )
    when = f"at t = {format_short(largest.time, 5)} s"
    turning = curve.turning
    if turning.path:
        angle = float(np.interp(largest.time, turning.times, turning.degrees))
        when += f", {turning.path} = {_format_degrees(angle, 360.0 * turning.turns)}"
    return f"{direction_text}, {when}"


def _format_degrees(angle: float, cycle: float) -> str:
    """Format an angle to four digits.

    cycle: degrees after which it starts again at 0; 0 if it does not
    """
    rounded = float(f"{angle % cycle if cycle else angle:.4g}")
    return f"{0.0 if cycle and rounded >= cycle else rounded:g}°"
