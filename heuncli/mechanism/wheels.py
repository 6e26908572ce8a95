"""A wheel as the conditions that it holds: that it touches its plane, and that it does not slip along it, or aside.

The first holds a pose, the others a speed. Multipliers are the forces ON the wheel: along the plane's normal (with the
opposite sign where the wheel may lift, for it then only presses), along its track, along its axle's shadow.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal, TypedDict

import numpy as np

from heuncli.mechanism.couplings import CoupledRow, CouplingPart, Place
from heuncli.results import Array
from heuncli.shapes.rotations import perpendicular

# the speeds of a disc's contact, and what holds them
SPEEDS: Mapping[str, Literal["rolls", "rolls_aside"]] = MappingProxyType({"along": "rolls", "aside": "rolls_aside"})


class Ends(TypedDict):
    """What all parts of a wheel have in common."""

    a: int
    b: int
    p: Place
    q: Place
    e: Place


def disc_rows(
    ends: Ends, axle: Array, radius: float, ways: Mapping[str, bool], *, held: bool
) -> tuple[CoupledRow, ...]:
    """The rows of a thin disc; ways: in which it does not slip; held: the plane pulls, too."""
    touches = touching(CouplingPart("touches", g=axle, radius=radius, **ends), held=held)
    return (
        touches,
        *(
            CoupledRow((CouplingPart(kind, g=axle, radius=radius, **ends),), 0.0)
            for way, kind in SPEEDS.items()
            if ways[way]
        ),
    )


def ball_rows(ends: Ends, radius: float, *, held: bool) -> tuple[CoupledRow, ...]:
    """The rows of a sphere, whose lowest point touches the plane and stands still on it."""
    touches = touching(CouplingPart("ball_touches", g=ends["e"], radius=radius, **ends), held=held)
    across = perpendicular(np.asarray(ends["e"]))
    return (touches, *(CoupledRow((CouplingPart("ball_rolls", g=g, radius=radius, **ends),), 0.0) for g in across))


def touching(part: CouplingPart, *, held: bool) -> CoupledRow:
    """The row of a contact; one that may lift is as that of a rope: its multiplier is never above zero."""
    if held:
        return CoupledRow((part,), 0.0)
    return CoupledRow((part.times(-1.0),), 0.0, tension_only=True)
