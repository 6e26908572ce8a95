"""What each kind of joint leaves free and what it carries: rows of data that everything else reads.

A freedom is a turn about, or a shift along, a direction: `axis` of `from`, `to_axis` of `to`, the two directions
perpendicular to the axis, or, in the plane, z and the one across the axis. `ball` marks joints that leave all three
turns free. Closure rows: `guides` are the directions fixed in `from` along which the `to` point cannot leave the `from`
point, `dots` pairs of directions (one of `from`, one of `to`) that stay perpendicular; theory.md 2b.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Direction = Literal["axis", "first", "second", "z", "across"]


@dataclass(frozen=True)
class Kind:
    """One kind of joint. turns/shifts: its scalar freedoms, in the order of its coordinates."""

    ball: bool
    turns: tuple[Literal["axis", "to_axis", "z"], ...]
    shifts: tuple[Direction, ...]
    guides: tuple[Direction, ...]
    dots: tuple[tuple[Direction, Direction], ...]
    in_tree: Literal["both", "forward", "never"] = "both"
    has_axis: bool = True

    @property
    def slides(self) -> bool:
        """Whether a torque, damper or friction in it means sliding; a cylinder's means turning."""
        return bool(self.shifts) and self.turns in ((), ("z",))

    @property
    def rows(self) -> int:
        """How many scalar conditions it makes."""
        return len(self.guides) + len(self.dots) if self.in_tree != "never" else 1


ALL: tuple[Direction, ...] = ("first", "second", "axis")
ACROSS: tuple[Direction, ...] = ("first", "second")
PARALLEL: tuple[tuple[Direction, Direction], ...] = (("axis", "first"), ("axis", "second"))
FIXED: tuple[tuple[Direction, Direction], ...] = (("first", "second"), ("second", "axis"), ("axis", "first"))

UPRIGHT: tuple[tuple[Direction, Direction], ...] = (("z", "axis"), ("z", "across"))

JOINTS: dict[str, Kind] = {
    "ball": Kind(True, (), (), ALL, (), has_axis=False),
    "pin": Kind(False, ("axis",), (), ALL, PARALLEL),
    "slide": Kind(False, (), ("axis",), ACROSS, FIXED),
    "cylinder": Kind(False, ("axis",), ("axis",), ACROSS, PARALLEL),
    "universal": Kind(False, ("axis", "to_axis"), (), ALL, (("axis", "axis"),)),
    "weld": Kind(False, (), (), ALL, FIXED, has_axis=False),
    "line": Kind(True, (), ("axis",), ACROSS, (), "forward"),
    "plane": Kind(True, (), ("first", "second"), ("axis",), (), "forward"),
    "rod": Kind(True, (), (), (), (), "never", has_axis=False),
    # what line and plane are in a scene declared planar: the bodies' z axes stay parallel
    "flat line": Kind(False, ("z",), ("axis",), ("across", "z"), UPRIGHT, "forward"),
    "flat plane": Kind(False, ("z",), ("across",), ("axis", "z"), UPRIGHT, "forward"),
}

# In a planar scene: what a user's kind is there, and how many conditions it makes in the plane.
PLANAR: dict[str, tuple[str, int]] = {
    "ball": ("pin", 2), "pin": ("pin", 2), "slide": ("slide", 2), "weld": ("weld", 3), "line": ("flat line", 1),
    "plane": ("flat plane", 1), "rod": ("rod", 1),
}  # fmt: skip
