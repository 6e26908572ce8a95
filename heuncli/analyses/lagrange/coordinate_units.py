"""SI units of Lagrange's quantities along an angle and along a length."""

from __future__ import annotations

from heuncli.base.joint_kinds import is_length
from heuncli.base.named_tuples import NamedTuple


class CoordinateUnits(NamedTuple):
    """The units of a coordinate q, its rate and acceleration, and of quantities along it.

    force: of k, C and drives
    momentum: of p and h
    inertia: of its diagonal entry in the mass matrix
    """

    value: str
    rate: str
    acceleration: str
    force: str
    momentum: str
    inertia: str

    @property
    def slope(self) -> str:
        """Unit of the derivative of the inertia by the coordinate."""
        return f"{self.inertia}/{self.value}"


ANGLE = CoordinateUnits("rad", "rad/s", "rad/s²", "N·m", "N·m·s", "kg·m²")
LENGTH = CoordinateUnits("m", "m/s", "m/s²", "N", "N·s", "kg")
MIXED_INERTIA_UNIT = "kg·m"  # of an angle and a length


def get_units(coordinate: str) -> CoordinateUnits:
    """Return the units along a coordinate owner.quantity."""
    return LENGTH if is_length(coordinate) else ANGLE
