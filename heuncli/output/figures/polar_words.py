"""What is said of vectors over a run: whose loads, in which axes, the largest with its direction and its instant."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.output.drawing.ticks import short
from heuncli.output.figures.certain import certain
from heuncli.output.figures.courses import Pictured
from heuncli.output.figures.planes import component
from heuncli.output.figures.tips import Largest, TipCurve
from heuncli.study.quantities.table_units import Units


def seen(sources: Sequence[Pictured], curves: Sequence[TipCurve], axes: str) -> Iterator[str]:
    """What of each run is seen, whose loads these are, and in which axes."""
    for source in sources:
        curve = next(curve for curve in curves if curve.study is source.study)
        name = source.name or str(source.study.results.spec.get("path", ""))
        yield f"{name}: {curve.turning.in_words}"
    yield _axes_in_words(axes, curves)


def _axes_in_words(axes: str, curves: Sequence[TipCurve]) -> str:
    """Whose loads these are, in which axes."""
    joints = [curve for curve in curves if curve.path.startswith("joints.")]
    told = ["of a joint: what `from` exerts ON `to`"] if joints else []
    told += ["of the foundation: ON it"] if any(curve.path.startswith("foundation.") for curve in curves) else []
    if axes == "world" or not joints:
        return "; ".join([*told, "world axes"])
    bodies = {_body_of(curve, axes) for curve in joints}
    return "; ".join([*told, f"joints in the axes of {', '.join(sorted(bodies))} (`{axes}`)"])


def _body_of(curve: TipCurve, axes: str) -> str:
    """The body whose axes a joint's loads are told in."""
    joint = curve.study.spec.joints[curve.path.split(".")[1]]
    return joint.a if axes == "from" else joint.b


def notes_of(curve: TipCurve, largest: Largest | None, units: Units) -> Iterator[str]:
    """The largest with its direction and instant; what is not drawn."""
    unit, size = units.of(curve.unit)
    if largest is None:
        yield f"{curve.name}: open or not known, and not drawn"
        return
    told = f"{certain(size * largest.size, size * largest.error)} {unit}"
    yield f"{curve.name}: {f'{told} all along' if largest.steady else f'largest {told} {_where(curve, largest)}'}"
    across = component(curve.vectors, curve.plane.across)
    along = float(np.nanmax(np.abs(across), initial=0.0))
    if along > tolerances.TOLD_ACROSS * largest.size:
        yield f"{curve.name}: across the plane up to {size * along:.4g} {unit}, not drawn"
    if np.isnan(curve.x + curve.y).any():
        yield f"{curve.name}: open or not known in parts, and not drawn there"
    elif np.isnan(across).any():
        yield f"{curve.name}: open or not known across the plane, which is not drawn"
    if "1" in curve.plane.names:
        words = (f"({', '.join(f'{x:.4g}' for x in e + 0.0)})" for e in (curve.plane.right, curve.plane.up))
        yield f"{curve.name}: directions 1 and 2 are {' and '.join(words)}"


def _where(curve: TipCurve, largest: Largest) -> str:
    """The direction, the instant and the crank's angle of the largest."""
    first, second = curve.plane.names
    way = f"towards {_degrees(math.degrees(math.atan2(largest.y, largest.x)), 360.0)} from {first} to {second}"
    when = f"at t = {short(largest.at, 5)} s"
    turning = curve.turning
    if turning.path:
        angle = float(np.interp(largest.at, turning.times, turning.counted))
        when += f", {turning.path} = {_degrees(angle, 360.0 * turning.turns)}"
    return f"{way}, {when}"


def _degrees(angle: float, whole: float) -> str:
    """An angle to four digits, of a circle or a cycle within that; whole: 0 where it is counted on."""
    told = float(f"{angle % whole if whole else angle:.4g}")
    return f"{0.0 if whole and told >= whole else told:g}°"
