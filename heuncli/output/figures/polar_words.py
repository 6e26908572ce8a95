"""Sentences on vectors over a run: whose loads, in which axes, the largest one with its direction and instant."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.output.drawing.ticks import format_short
from heuncli.output.figures.courses import FigureSource, describe_number
from heuncli.output.figures.history_curves import format_number
from heuncli.output.figures.planes import project_vectors
from heuncli.output.figures.tips import LargestVector, TipCurve
from heuncli.study.quantities.digits import UNKNOWN
from heuncli.study.quantities.reader_numbers import ReaderStyle, choose_reader_style
from heuncli.study.quantities.table_units import Units


def describe_runs(sources: Sequence[FigureSource], curves: Sequence[TipCurve]) -> Iterator[str]:
    """Yield a sentence for each run: the instants that are shown, and the angle that keeps turning."""
    for source in sources:
        curve = next(curve for curve in curves if curve.study is source.study)
        turning = curve.turning
        text = turning.describe(describe_number(source, turning.path) if turning.path else "")
        yield f"{source.name}: {text}" if source.name else text


def describe_frame(curve: TipCurve, axes: str) -> str:
    """Describe what a curve's loads act on, and in which axes they are drawn."""
    if curve.path.startswith("joints."):
        joint = curve.study.spec.joints[curve.path.split(".")[1]]
        frame = "world axes" if axes == "world" else f"in the axes of {_find_body(curve, axes)}"
        return f"reaction of {joint.a} on {joint.b}, {frame}"
    return "force on the foundation, world axes" if curve.path.startswith("foundation.") else "world axes"


def format_magnitude(largest: LargestVector, style: ReaderStyle) -> str:
    """Format the magnitude with its unit; `?` if its error is as large."""
    if largest.magnitude <= largest.error:
        return f"{UNKNOWN} {style.unit}"
    return format_number(largest.magnitude, largest.error, style)


def describe_angle(curve: TipCurve, largest: LargestVector) -> str:
    """Return the crank angle of the largest vector, else its instant."""
    turning = curve.turning
    if not turning.path:
        return f"{format_short(largest.time, 4)} s"
    angle = float(np.interp(largest.time, turning.times, turning.degrees))
    return _format_degrees(angle, 360.0 * turning.turns)


def _find_body(curve: TipCurve, axes: str) -> str:
    """Return the body in whose axes a joint's loads are given."""
    joint = curve.study.spec.joints[curve.path.split(".")[1]]
    return joint.a if axes == "from" else joint.b


def make_notes(curve: TipCurve, largest: LargestVector | None, units: Units) -> Iterator[str]:
    """Yield the largest vector with its direction and instant, and what is not drawn."""
    style = choose_reader_style(curve.unit, 0.0 if largest is None else largest.magnitude, units)
    if largest is None:
        yield f"{curve.caption}: open or unknown, not drawn"
        return
    magnitude_text = format_magnitude(largest, style)
    if largest.is_constant:
        yield f"{curve.caption}: {magnitude_text} at all times"
    else:
        yield f"{curve.caption}: largest {magnitude_text} {_describe_largest(curve, largest)}"
    normal_components = project_vectors(curve.vectors, curve.plane.normal)
    largest_normal = float(np.nanmax(np.abs(normal_components), initial=0.0))
    if largest_normal > max(tolerances.TOLD_ACROSS * largest.magnitude, largest.error):
        yield f"{curve.caption}: normal to the plane up to {style.size * largest_normal:.4g} {style.unit}, not drawn"
    if np.isnan(curve.x + curve.y).any():
        yield f"{curve.caption}: partly open or unknown, not drawn there"
    elif np.isnan(normal_components).any():
        yield f"{curve.caption}: normal component open or unknown, not drawn"
    if "1" in curve.plane.names:
        words = (f"({', '.join(f'{x:.4g}' for x in e + 0.0)})" for e in (curve.plane.right, curve.plane.upward))
        yield f"{curve.caption}: directions 1 and 2 are {' and '.join(words)}"


def _describe_largest(curve: TipCurve, largest: LargestVector) -> str:
    """Describe the direction, the instant and the crank angle of the largest vector."""
    first, second = curve.plane.names
    direction = _format_degrees(math.degrees(math.atan2(largest.y, largest.x)), 360.0)
    direction_text = f"at {direction} from {first} to {second}"
    when = f"at t = {format_short(largest.time, 4)} s"
    turning = curve.turning
    if turning.path:
        caption = describe_number(FigureSource("", curve.study), turning.path)
        when += f", {caption} = {describe_angle(curve, largest)}"
    return f"{direction_text}, {when}"


def _format_degrees(angle: float, cycle: float) -> str:
    """Format an angle to four digits.

    cycle: degrees after which it starts again at 0; 0 if it does not
    """
    rounded = float(f"{angle % cycle if cycle else angle:.4g}")
    return f"{0.0 if cycle and rounded >= cycle else rounded:g}°"
