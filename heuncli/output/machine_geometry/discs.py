"""What is round and turns: wheels, gears, pulleys, sheaves, in their body's axes, with spokes that show the turning."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.machine_geometry.solids import Surface
from heuncli.results.results import Array
from heuncli.scene.file_format.models import Shape, Vec
from heuncli.scene.shapes.rotations import perpendicular

CORNERS = 48  # of a circle
THICK = 0.06  # of its radius: how far a disc goes on either side of its rim
BEFORE = 1.02  # times as far out as a face stand the marks on it, else it hides them
NEAR = (0.5, 1.2)  # of the radius: corners so far off the axis are of the wheel that a body is there


class Disc(NamedTuple):
    """A circle about an axis of unit length; spins: with its body, so that spokes tell how it turns.

    solid: a body without shapes is drawn as that disc.
    """

    centre: Array
    axis: Array
    radius: float
    solid: bool = True
    spins: bool = True

    @property
    def rim(self) -> Array:
        """The circle, (CORNERS + 1, 3)."""
        e, f = perpendicular(self.axis)
        turn = np.linspace(0.0, 2.0 * np.pi, CORNERS + 1)[:, None]
        found: Array = self.centre + self.radius * (np.cos(turn) * e + np.sin(turn) * f)
        return found

    @property
    def shape(self) -> Shape:
        """A disc, thin as a coin."""
        half = THICK * self.radius * self.axis
        return Shape("cylinder", from_=vec(self.centre - half), to=vec(self.centre + half), radius=self.radius)

    def spokes(self, surfaces: tuple[Surface, ...]) -> Iterator[Array]:
        """Lines (2, 3) from rim to rim, across both faces of what its body's surfaces make of it."""
        ends = np.array([-1.0, 1.0])[:, None]
        for height in self.faces(surfaces):
            for way in perpendicular(self.axis):
                yield self.centre + BEFORE * height * self.axis + self.radius * ends * way

    def faces(self, surfaces: tuple[Surface, ...]) -> tuple[float, ...]:
        """How far along the axis its faces stand: those of the corners about its rim; without any its own plane."""
        off = np.concatenate([np.zeros((0, 3)), *(surface.corners for surface in surfaces)]) - self.centre
        up = off @ self.axis
        away = np.sqrt(np.maximum(np.sum(off * off, axis=1) - up * up, 0.0))
        own = up[(away >= NEAR[0] * self.radius) & (away <= NEAR[1] * self.radius)]
        return (float(own.min()), float(own.max())) if len(own) else (0.0,)


def vec(x: Array) -> Vec:
    """Three numbers."""
    a, b, c = x.tolist()
    return a, b, c


def direction(axis: Vec) -> Array:
    """An axis at length 1."""
    v = np.array(axis)
    return np.asarray(v / np.sqrt(v @ v))
