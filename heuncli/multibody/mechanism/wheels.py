"""A wheel as the conditions that it holds: that it touches its plane, and that it does not slip along it, or aside.

The first holds a pose, the others a speed. Multipliers are the forces ON the wheel: along the plane's normal, along its
track, along its axle's shadow on the plane. That a plane only presses is watched for
(scene/file_format/resolve_couplings.py): of more wheels than it takes nothing tells what each of them bears.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal, TypedDict

import numpy as np

from heuncli.multibody.mechanism.couplings import CoupledRow, CouplingKind, CouplingPart, Place
from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import perpendicular

# the speeds of a disc's contact, and what holds them
SPEEDS: Mapping[str, Literal["rolls", "rolls_aside"]] = MappingProxyType({"along": "rolls", "aside": "rolls_aside"})


class WheelEnds(TypedDict):
    """What all parts of a wheel have in common."""

    a: int
    b: int
    p: Place
    q: Place
    e: Place


def disc_rows(ends: WheelEnds, axle: Array, radius: float, ways: Mapping[str, bool]) -> tuple[CoupledRow, ...]:
    """The rows of a thin disc; ways: in which it does not slip."""
    kinds: list[CouplingKind] = ["touches", *(kind for way, kind in SPEEDS.items() if ways[way])]
    return tuple(row_of(CouplingPart(kind, g=axle, radius=radius, **ends)) for kind in kinds)


def ball_rows(ends: WheelEnds, radius: float) -> tuple[CoupledRow, ...]:
    """The rows of a sphere, whose lowest point touches the plane and stands still on it."""
    touches = CouplingPart("ball_touches", g=ends["e"], radius=radius, **ends)
    rolls = (CouplingPart("ball_rolls", g=g, radius=radius, **ends) for g in perpendicular(np.asarray(ends["e"])))
    return tuple(row_of(part) for part in (touches, *rolls))


def row_of(part: CouplingPart) -> CoupledRow:
    """The row of a part alone: at the start one that holds a speed asks for rates, and for no pose."""
    return CoupledRow((part,), None if part.holds_speed else 0.0)
