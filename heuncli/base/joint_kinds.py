"""The kinds of joints, one row each: all other code reads the rows, nothing branches on a kind's name.

A joint constrains the point of `to` in one of a few ways (Hold), and the rotation of `to` in one of a few ways (Turn),
both in the axes of `from`. Together they give its degrees of freedom, its closure rows when it is cut, with the forces
and moments that these transmit (manual/theory.md, "Joints as rows"), and its conditions for the assembly. The other
fields of a row are how users speak of the joint.

Directions: `axis` and the two perpendicular to it, `first` and `second`, are fixed in `from`, `to_axis` in `to`; in a
scene declared planar `z` is the world's and `across` is z × axis. The spec depends on this module, so it does not
import NumPy.
"""

from __future__ import annotations

from typing import Literal

from heuncli.base.load_kinds import LOAD_KINDS
from heuncli.base.named_tuples import NamedTuple

Direction = Literal["axis", "to_axis", "first", "second", "z", "across"]
Motion = Literal["turning", "sliding"]


class Hold(NamedTuple):
    """The constraint of a joint on the position of the `to` point.

    gap_type: what the assembly brings the point to: the `from` point, or its line, plane, distance or curve
    held_directions: directions along which the point cannot leave the `from` point, and so those of the forces; one
    closure row each (a "guide" in manual/theory.md, "Joints as rows")
    shifts: directions along which it is free

    A distance has one row, along the line between the points.
    """

    gap_type: Literal["point", "line", "plane", "distance", "curve"]
    held_directions: tuple[Direction, ...]
    shifts: tuple[Direction, ...] = ()


class Turn(NamedTuple):
    """The constraint of a joint on the rotation of `to`.

    condition: the condition that the assembly sets on its orientation: none ("free"), one common axis ("axis"), axes at
    right angles ("square"), shafts that turn alike at any bend ("alike"), the same attitude ("all")
    perpendicular_pairs: pairs of directions d of `from` and e of `to` that stay perpendicular; one closure row each (a
    "dot" in manual/theory.md, "Joints as rows"), with the moment e × d
    turns: the axes about which it is free, where it is not entirely free (`ball`)
    weighted_pairs: one more closure row: a weighted sum of such products d·e stays zero, where e is a direction of
    `from` carried along by the bend at the start. No chain of axes leaves just these rotations free, so the tree has a
    ball joint there and this row in addition.
    """

    condition: Literal["free", "axis", "square", "alike", "all"]
    perpendicular_pairs: tuple[tuple[Direction, Direction], ...]
    turns: tuple[Direction, ...] = ()
    ball: bool = False
    weighted_pairs: tuple[tuple[float, Direction, Direction], ...] = ()


POINT = Hold("point", ("first", "second", "axis"))
LINE = Hold("line", ("first", "second"), ("axis",))
PLANE = Hold("plane", ("axis",), ("first", "second"))
DISTANCE = Hold("distance", ())
CURVE = Hold("curve", ("first", "second"), ("axis",))  # across and along the curve where the point is
LINE_IN_PLANE = Hold("line", ("across", "z"), ("axis",))
CURVE_IN_PLANE = Hold("curve", ("across", "z"), ("axis",))
PLANE_IN_PLANE = Hold("plane", ("axis", "z"), ("across",))

FREE = Turn("free", (), ball=True)
ABOUT_AXIS = Turn("axis", (("axis", "first"), ("axis", "second")), ("axis",))
ABOUT_TWO = Turn("square", (("axis", "to_axis"),), ("axis", "to_axis"))
CONSTANT_VELOCITY = Turn(
    "alike", (), weighted_pairs=((-0.5, "first", "second"), (0.5, "second", "first"))
)  # by the bend alone
NO_ROTATION = Turn("all", (("first", "second"), ("second", "axis"), ("axis", "first")))
ABOUT_Z = Turn("free", (("z", "axis"), ("z", "across")), ("z",))  # the body stays parallel to the plane

# What of these moves in a plane, where that is all that is left of a scene: no condition across it. The axis stands
# along the plane's normal, which is then z, or lies across it, in the plane; what has no axis is as if it stood along.
HOLDS_AXIS_NORMAL = {
    POINT: Hold("point", ("first", "second")), LINE: Hold("point", ("first", "second")),
    PLANE: Hold("plane", (), ("first", "second")), DISTANCE: DISTANCE,
    CURVE: Hold("curve", ("across",), ("axis",)), CURVE_IN_PLANE: Hold("curve", ("across",), ("axis",)),
}  # fmt: skip
TURNS_AXIS_NORMAL = {
    FREE: Turn("free", (), ("z",)), ABOUT_AXIS: Turn("axis", (), ("axis",)), ABOUT_TWO: Turn("axis", (), ("axis",)),
    NO_ROTATION: Turn("all", (("first", "second"),)), ABOUT_Z: Turn("free", (), ("z",)),
}  # fmt: skip
HOLDS_AXIS_IN_PLANE = {
    POINT: Hold("point", ("axis", "across")), LINE: Hold("line", ("across",), ("axis",)),
    PLANE: Hold("plane", ("axis",), ("across",)), LINE_IN_PLANE: Hold("line", ("across",), ("axis",)),
    PLANE_IN_PLANE: Hold("plane", ("axis",), ("across",)),
}  # fmt: skip
TURNS_AXIS_IN_PLANE = {
    FREE: Turn("free", (), ("z",)), ABOUT_Z: Turn("free", (), ("z",)),
    ABOUT_AXIS: Turn("all", (("axis", "across"),)), ABOUT_TWO: Turn("all", (("axis", "across"),)),
    NO_ROTATION: Turn("all", (("axis", "across"),)),
}  # fmt: skip


class JointKind(NamedTuple):
    """One kind of joint: a row of JOINTS. Defaults hold for most kinds."""

    name: str
    hold: Hold
    turn: Turn
    # the tree of joints that carries the motion: a joint in it carries a body from either of its ends, from `from` only
    in_tree: Literal["both", "forward", "never"] = "both"
    # keys: of the direction in `from`, and whether one in `to` may or must be given
    axis_key: Literal["axis", "normal"] | None = None
    to_axis: Literal["never", "optional", "required"] = "never"
    # coordinates, which may be held at the start, and those of them that a drive may prescribe
    coordinates: tuple[Literal["angle", "travel"], ...] = ()
    drives: tuple[Literal["angle", "travel", "length"], ...] = ()
    # what acts in it: kinds of loads (load_kinds.py), and the motions on which they act
    loads: tuple[str, ...] = ()
    motions: tuple[Motion, ...] = ()
    # what it is in a scene declared planar, None: it cannot be there
    planar: str | None = None
    # kinds with fewer constraints that may replace it, those that remove fewest first: in space and in a planar scene
    weaker_kinds: tuple[str, ...] = ()
    weaker_planar_kinds: tuple[str, ...] = ()
    # what it is called elsewhere; and by users, where that is not its name
    synonyms: tuple[str, ...] = ()
    display_name: str | None = None

    @property
    def held_directions(self) -> tuple[Direction, ...]:
        """Directions, fixed in `from`, of the forces that it transmits."""
        return self.hold.held_directions

    @property
    def perpendicular_pairs(self) -> tuple[tuple[Direction, Direction], ...]:
        """Pairs of directions whose cross products are the moments that it transmits."""
        return self.turn.perpendicular_pairs

    @property
    def shifts(self) -> tuple[Direction, ...]:
        """Directions of its free translations, in the order of its coordinates."""
        return self.hold.shifts

    @property
    def turns(self) -> tuple[Direction, ...]:
        """Axes of its free rotations, in the order of its coordinates; empty where all are free."""
        return self.turn.turns

    @property
    def is_ball(self) -> bool:
        """Whether all three rotations are free."""
        return self.turn.ball

    @property
    def is_constant_velocity(self) -> bool:
        """Whether it is a constant-velocity joint: its two axes may bend, but neither turns about itself relative to
        the other.
        """
        return bool(self.turn.weighted_pairs)

    @property
    def is_ball_in_tree(self) -> bool:
        """Whether the tree leaves all three rotations free, even if closure rows constrain them."""
        return self.is_ball or self.is_constant_velocity

    @property
    def keeps_distance(self) -> bool:
        """Whether it holds the distance of its points; its force, and its drive's, acts along their line."""
        return self.hold is DISTANCE

    @property
    def follows_path(self) -> bool:
        """Whether its point runs along a path; its force acts across the path."""
        return self.hold.gap_type == "curve"

    @property
    def row_count(self) -> int:
        """The number of scalar constraints it makes."""
        return (
            1
            if self.keeps_distance
            else len(self.held_directions) + len(self.perpendicular_pairs) + self.is_constant_velocity
        )

    @property
    def is_rigid(self) -> bool:
        """Whether it leaves no degree of freedom: its two bodies move as one."""
        return self.row_count == 6

    @property
    def planar_row_count(self) -> int:
        """The number of constraints on the motion in the plane of a planar scene."""
        return 1 if self.keeps_distance else 3 - len(self.turns) - len(self.shifts)

    @property
    def has_axis(self) -> bool:
        """Whether it needs a direction."""
        return self.axis_key is not None

    @property
    def has_one_axis(self) -> bool:
        """Whether its loads act about or along a single axis: neither about two axes nor in a plane."""
        return self.axis_key == "axis" and self.to_axis != "required" and not self.is_constant_velocity

    @property
    def carries_tilting(self) -> bool:
        """Whether it holds its one axis against every tilting moment, as two bearings do."""
        return self.has_one_axis and self.turn.condition in ("axis", "all")

    @property
    def has_moving_contact(self) -> bool:
        """Whether the point where it loads its `from` body moves over that body."""
        return bool(self.shifts)

    @property
    def load_unit(self) -> Literal["N", "N·m"]:
        """The unit of loads that act in it: N·m if it turns."""
        return "N·m" if "turning" in self.motions else "N"

    def motions_for_load(self, load: str) -> tuple[Motion, ...]:
        """Return the motions on which a load of this kind acts: one row of the kernel's table of loads each."""
        known: tuple[Motion, ...] = ("turning", "sliding")
        return tuple(x for x, _ in zip(known, LOAD_KINDS[load].kernel_laws, strict=False) if x in self.motions)

    def accepts_load(self, load: str) -> bool:
        """Whether a load of this kind may act in it."""
        return load in self.loads


# what users write
TYPES: dict[str, JointKind] = {
    kind.name: kind
    for kind in (
        JointKind(
            "ball", POINT, FREE, loads=("damper",), motions=("turning",), planar="pin", weaker_kinds=("line",),
            synonyms=("spherical", "sphere", "socket", "ballsocket"),
        ),
        JointKind(
            "pin", POINT, ABOUT_AXIS, axis_key="axis", to_axis="optional", coordinates=("angle",), drives=("angle",),
            loads=("torque", "turn_spring", "damper", "friction"), motions=("turning",), planar="pin",
            weaker_kinds=("universal", "ball", "cylinder", "line"),  # a pin with side play is a line
            weaker_planar_kinds=("flat line",),
            synonyms=("revolute", "hinge", "pivot", "rotational", "rotary", "bearing"),
        ),
        JointKind(
            "slide", LINE, NO_ROTATION, axis_key="axis", to_axis="optional", coordinates=("travel",),
            drives=("travel",), loads=("torque", "damper", "friction"), motions=("sliding",), planar="slide",
            weaker_kinds=("cylinder", "line"), weaker_planar_kinds=("flat line",),
            synonyms=("prismatic", "translational", "slider", "sliding", "guide"),
        ),
        JointKind(
            "cylinder", LINE, ABOUT_AXIS, axis_key="axis", to_axis="optional", coordinates=("angle", "travel"),
            drives=("travel",), loads=("turn_spring", "damper", "friction"), motions=("turning", "sliding"),
            weaker_kinds=("line",),
            synonyms=("cylindrical",),
        ),
        JointKind(
            "universal", POINT, ABOUT_TWO, axis_key="axis", to_axis="required", loads=("turn_spring", "damper"),
            motions=("turning",), weaker_kinds=("ball",), synonyms=("cardan", "hooke", "u"),
        ),
        JointKind(
            "cv", POINT, CONSTANT_VELOCITY, axis_key="axis", to_axis="optional", loads=("damper",),
            motions=("turning",),
            weaker_kinds=("ball",), synonyms=("constant_velocity", "constantvelocity", "homokinetic", "rzeppa"),
        ),
        JointKind(
            "weld", POINT, NO_ROTATION, planar="weld", weaker_kinds=("ball",), weaker_planar_kinds=("pin",),
            synonyms=("fixed", "rigid", "lock"),
        ),
        JointKind(
            "line", LINE, FREE, "forward", axis_key="axis", loads=("damper",), motions=("sliding",),
            planar="flat line", synonyms=("inline", "in_line", "pointonline"),
        ),
        JointKind(
            "plane", PLANE, FREE, "forward", axis_key="normal", loads=("damper",), motions=("sliding",),
            planar="flat plane", synonyms=("inplane", "in_plane", "planar", "pointonplane"),
        ),
        JointKind(
            "curve", CURVE, FREE, "forward", coordinates=("travel",), drives=("travel",), loads=("damper", "friction"),
            motions=("sliding",), planar="flat curve",
            synonyms=("path", "track", "pointoncurve", "point_on_curve"),
        ),
        JointKind("rod", DISTANCE, FREE, "never", drives=("length",), planar="rod",
             synonyms=("distance", "link", "cable", "rope")),
    )
}  # fmt: skip
# with what line and plane are in a scene declared planar: the bodies' z axes stay parallel; and with a pin of what has
# no inertia to turn about it, the angle of which no law determines
JOINTS: dict[str, JointKind] = TYPES | {
    kind.name: kind
    for kind in (
        JointKind(
            "flat line", LINE_IN_PLANE, ABOUT_Z, "forward", axis_key="axis", motions=("sliding",), display_name="line"
        ),
        JointKind(
            "flat plane",
            PLANE_IN_PLANE,
            ABOUT_Z,
            "forward",
            axis_key="normal",
            motions=("sliding",),
            display_name="plane",
        ),
        JointKind(
            "flat curve",
            CURVE_IN_PLANE,
            ABOUT_Z,
            "forward",
            coordinates=("travel",),
            motions=("sliding",),
            display_name="curve",
        ),
        JointKind(
            "spun pin", POINT, ABOUT_AXIS, motions=("turning",), weaker_planar_kinds=("flat line",), display_name="pin"
        ),
    )
}
# the kinds as they are in a scene solved in its plane (multibody/reduction/plane/step.py)
FLAT: dict[tuple[str, bool], JointKind] = {
    (kind.name, along): kind._replace(
        name=f"{kind.name} {'along' if along else 'across'} the normal",
        hold=held[kind.hold],
        turn=turns[kind.turn],
        coordinates=tuple(x for x in kind.coordinates if kind.follows_path or x == ("angle" if along else "travel")),
        display_name=kind.display_name or kind.name,
    )
    for kind in JOINTS.values()
    for along, held, turns in (
        (True, HOLDS_AXIS_NORMAL, TURNS_AXIS_NORMAL),
        (False, HOLDS_AXIS_IN_PLANE, TURNS_AXIS_IN_PLANE),
    )
    if kind.hold in held and kind.turn in turns
}
JOINTS |= {kind.name: kind for kind in FLAT.values()}
LENGTHS = frozenset(("travel", "length", "dx", "dy", "dz"))  # of the coordinates; all others are angles
RATES = {"angle": "rate", "travel": "speed"}  # of the coordinates
SYNONYMS = {word: kind.name for kind in TYPES.values() for word in kind.synonyms}


def kinds_accepting_load(load: str) -> list[JointKind]:
    """Return the kinds in which a load of this kind may act."""
    return [kind for kind in TYPES.values() if kind.accepts_load(load)]


PINS_IN_PLACE = {"ball": "three pins", "universal": "two pins"}  # kinds that turn about several axes, as pins in a row


def propose_pins(kind: JointKind, hint: str) -> str:
    """Return a hint, or for a joint of several rotations the pins in a row that have an angle each."""
    pins = PINS_IN_PLACE.get(kind.name)
    if pins is None:
        return hint
    where = "heun explain howto, Ball with angles"
    return f"replace the {kind.name} by {pins} in a row, with bodies of mass: 0 between: {where}"


def format_kind_names(kinds: list[JointKind], last: str) -> str:
    """Return the names of kinds as words, "pin, slide and cylinder"; last: "and" or "or"."""
    names = [kind.name for kind in kinds]
    return f" {last} ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def is_length(coordinate: str) -> bool:
    """Whether a coordinate, owner.quantity, is a length."""
    return coordinate.rpartition(".")[2] in LENGTHS
