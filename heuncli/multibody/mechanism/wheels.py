"""A wheel as its conditions: it touches its plane, and does not slip along its track or sideways.

The first constrains a pose, the others a speed. Multipliers are the forces ON the wheel: along the plane's normal,
along its track, along the projection of its axle on the plane. That a plane only pushes is monitored
(scene/file_format/resolve_couplings.py): the loads of more wheels than necessary are indeterminate.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal, TypedDict

import numpy as np

from heuncli.multibody.mechanism.couplings import CoupledRow, CouplingKind, CouplingPart, Place
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import perpendicular_pair

# the speeds of a disc's contact, and what holds them
SPEEDS: Mapping[str, Literal["rolls", "rolls_aside"]] = MappingProxyType({"along": "rolls", "aside": "rolls_aside"})


class WheelEnds(TypedDict):
    """The fields that all parts of a wheel share."""

    a: int
    b: int
    p: Place
    q: Place
    e: Place


def disc_rows(ends: WheelEnds, axle: Array, radius: float, no_slip: Mapping[str, bool]) -> tuple[CoupledRow, ...]:
    """Make the rows of a thin disc; no_slip: the directions in which it does not slip."""
    kinds: list[CouplingKind] = ["touches", *(kind for direction, kind in SPEEDS.items() if no_slip[direction])]
    return tuple(make_row(CouplingPart(kind, g=axle, radius=radius, **ends)) for kind in kinds)


def ball_rows(ends: WheelEnds, radius: float) -> tuple[CoupledRow, ...]:
    """Make the rows of a sphere, whose lowest point touches the plane and is at rest on it."""
    touches = CouplingPart("ball_touches", g=ends["e"], radius=radius, **ends)
    rolls = (CouplingPart("ball_rolls", g=g, radius=radius, **ends) for g in perpendicular_pair(np.asarray(ends["e"])))
    return tuple(make_row(part) for part in (touches, *rolls))


def make_row(part: CouplingPart) -> CoupledRow:
    """Make the row of a single part; one that constrains a speed sets a condition on the rates at the start, none on
    the pose.
    """
    return CoupledRow((part,), None if part.constrains_speed else 0.0)
