"""The kinds of joints, one row each: everything else reads the rows, nothing branches on a kind's name.

A joint holds the point of `to` in one of a few ways, and leaves `to` to turn in one of a few ways, both seen from the
axes of `from`. The two together are its freedoms, its closure rows when it is cut, with the forces and moments that
they carry (manual/theory.md, "Joints as rows"), and what the assembly asks of it. What is left of a row is how users
speak of the joint.

Directions: `axis` and the two across it, `first` and `second`, are fixed in `from`, `to_axis` in `to`; in a scene
declared planar `z` is the world's and `across` is z × axis. Lies below the spec, and so needs no NumPy.
"""

from __future__ import annotations

from typing import Literal

from heuncli.base.named_tuples import NamedTuple

Direction = Literal["axis", "to_axis", "first", "second", "z", "across"]
Motion = Literal["turning", "sliding"]


class Hold(NamedTuple):
    """How the `to` point is held. asks: the gap that the assembly closes.

    guides: the directions along which it cannot leave the `from` point, and so those of the forces, a closure row each;
    shifts: those along which it can. A distance has one row, along the line between the points.
    """

    asks: Literal["point", "line", "plane", "distance", "curve"]
    guides: tuple[Direction, ...]
    shifts: tuple[Direction, ...] = ()


class Turn(NamedTuple):
    """How `to` may turn. asks: what the assembly asks of its attitude.

    dots: pairs of directions d of `from` and e of `to` that stay perpendicular, a closure row each, with the moment
    e × d; turns: the axes about which it is free, where it is not free altogether (`ball`).
    sum_of_dots: one closure row more: the sum of such products, each so many times, stays zero, with e a direction of
    `from` as the bend at the start turned it. As no axes in a row leave the turns that it leaves, the tree has a ball
    there, and the row beside it.
    """

    asks: Literal["free", "axis", "square", "alike", "all"]
    dots: tuple[tuple[Direction, Direction], ...]
    turns: tuple[Direction, ...] = ()
    ball: bool = False
    sum_of_dots: tuple[tuple[float, Direction, Direction], ...] = ()


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
ALIKE = Turn("alike", (), sum_of_dots=((-0.5, "first", "second"), (0.5, "second", "first")))  # by the bend alone
NOT_AT_ALL = Turn("all", (("first", "second"), ("second", "axis"), ("axis", "first")))
ABOUT_Z = Turn("free", (("z", "axis"), ("z", "across")), ("z",))  # upright as drawn: in the plane nothing tilts it

# What of these moves in a plane, where that is all that is left of a scene: no condition across it. The axis stands
# along the plane's normal, which is then z, or lies across it, in the plane; what has no axis is as if it stood along.
HELD_ALONG = {
    POINT: Hold("point", ("first", "second")), LINE: Hold("point", ("first", "second")),
    PLANE: Hold("plane", (), ("first", "second")), DISTANCE: DISTANCE,
    CURVE: Hold("curve", ("across",), ("axis",)), CURVE_IN_PLANE: Hold("curve", ("across",), ("axis",)),
}  # fmt: skip
TURNS_ALONG = {
    FREE: Turn("free", (), ("z",)), ABOUT_AXIS: Turn("axis", (), ("axis",)), ABOUT_TWO: Turn("axis", (), ("axis",)),
    NOT_AT_ALL: Turn("all", (("first", "second"),)), ABOUT_Z: Turn("free", (), ("z",)),
}  # fmt: skip
HELD_ACROSS = {
    POINT: Hold("point", ("axis", "across")), LINE: Hold("line", ("across",), ("axis",)),
    PLANE: Hold("plane", ("axis",), ("across",)), LINE_IN_PLANE: Hold("line", ("across",), ("axis",)),
    PLANE_IN_PLANE: Hold("plane", ("axis",), ("across",)),
}  # fmt: skip
TURNS_ACROSS = {
    FREE: Turn("free", (), ("z",)), ABOUT_Z: Turn("free", (), ("z",)),
    ABOUT_AXIS: Turn("all", (("axis", "across"),)), ABOUT_TWO: Turn("all", (("axis", "across"),)),
    NOT_AT_ALL: Turn("all", (("axis", "across"),)),
}  # fmt: skip


class Kind(NamedTuple):
    """One kind of joint; a row of JOINTS. What is left out is what most kinds have not."""

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
    # what acts in it: kinds of loads, and the motions on which they act
    loads: tuple[Literal["torque", "turn_spring", "damper", "friction"], ...] = ()
    motions: tuple[Motion, ...] = ()
    # what it is in a scene declared planar, None: it cannot be there
    planar: str | None = None
    # what may take its place and hold less, the gentlest first: in space and in a planar scene
    looser: tuple[str, ...] = ()
    looser_in_plane: tuple[str, ...] = ()
    # what it is called elsewhere; and by users, where that is not its name
    synonyms: tuple[str, ...] = ()
    spoken: str | None = None

    @property
    def guides(self) -> tuple[Direction, ...]:
        """Directions, fixed in `from`, of the forces that it carries."""
        return self.hold.guides

    @property
    def dots(self) -> tuple[tuple[Direction, Direction], ...]:
        """Pairs of directions whose products are the moments that it carries."""
        return self.turn.dots

    @property
    def shifts(self) -> tuple[Direction, ...]:
        """Directions of its free shifts, in the order of its coordinates."""
        return self.hold.shifts

    @property
    def turns(self) -> tuple[Direction, ...]:
        """Axes of its free turns, in the order of its coordinates; none where all are free."""
        return self.turn.turns

    @property
    def ball(self) -> bool:
        """Whether it leaves all three turns free."""
        return self.turn.ball

    @property
    def turns_alike(self) -> bool:
        """Whether it leaves the bend of its two axes free, and neither turns about its own beside the other."""
        return bool(self.turn.sum_of_dots)

    @property
    def ball_in_tree(self) -> bool:
        """Whether the tree leaves all three turns free, whatever closure rows hold of them."""
        return self.ball or self.turns_alike

    @property
    def keeps_distance(self) -> bool:
        """Whether it holds the distance of its points, along whose line its force, and its drive's, acts."""
        return self.hold is DISTANCE

    @property
    def follows_path(self) -> bool:
        """Whether its point runs along a path, across which its force acts, and which it alone can hold."""
        return self.hold.asks == "curve"

    @property
    def rows(self) -> int:
        """How many scalar conditions it makes."""
        return 1 if self.keeps_distance else len(self.guides) + len(self.dots) + self.turns_alike

    @property
    def is_rigid(self) -> bool:
        """Whether it leaves nothing free: its two bodies are one."""
        return self.rows == 6

    @property
    def rows_in_plane(self) -> int:
        """How many of them concern the motion in the plane of a planar scene."""
        return 1 if self.keeps_distance else 3 - len(self.turns) - len(self.shifts)

    @property
    def has_axis(self) -> bool:
        """Whether it needs a direction."""
        return self.axis_key is not None

    @property
    def has_one_axis(self) -> bool:
        """Whether its loads act about or along its axis, and not on the whole motion: about two, or in a plane."""
        return self.axis_key == "axis" and self.to_axis != "required" and not self.turns_alike

    @property
    def wanders(self) -> bool:
        """Whether the place where it loads its `from` body moves over that body."""
        return bool(self.shifts)

    def moved_by(self, load: str) -> tuple[Motion, ...]:
        """The motions on which a load of this kind acts: a row of the kernel's table of loads each."""
        return ("turning",) if load == "turn_spring" else self.motions

    def takes(self, load: str) -> bool:
        """Whether a load of this kind may act in it."""
        return load in self.loads


# what users write
TYPES: dict[str, Kind] = {
    kind.name: kind
    for kind in (
        Kind(
            "ball", POINT, FREE, loads=("damper",), motions=("turning",), planar="pin", looser=("line",),
            synonyms=("spherical", "sphere", "socket", "ballsocket"),
        ),
        Kind(
            "pin", POINT, ABOUT_AXIS, axis_key="axis", to_axis="optional", coordinates=("angle",), drives=("angle",),
            loads=("torque", "turn_spring", "damper", "friction"), motions=("turning",), planar="pin",
            looser=("universal", "ball", "cylinder", "line"),  # a pin with side play is a line
            looser_in_plane=("flat line",),
            synonyms=("revolute", "hinge", "pivot", "rotational", "rotary", "bearing"),
        ),
        Kind(
            "slide", LINE, NOT_AT_ALL, axis_key="axis", to_axis="optional", coordinates=("travel",),
            drives=("travel",), loads=("torque", "damper", "friction"), motions=("sliding",), planar="slide",
            looser=("cylinder", "line"), looser_in_plane=("flat line",),
            synonyms=("prismatic", "translational", "slider", "sliding", "guide"),
        ),
        Kind(
            "cylinder", LINE, ABOUT_AXIS, axis_key="axis", to_axis="optional", coordinates=("angle", "travel"),
            drives=("travel",), loads=("turn_spring", "damper", "friction"), motions=("turning", "sliding"),
            looser=("line",),
            synonyms=("cylindrical",),
        ),
        Kind(
            "universal", POINT, ABOUT_TWO, axis_key="axis", to_axis="required", loads=("turn_spring", "damper"),
            motions=("turning",), looser=("ball",), synonyms=("cardan", "hooke", "u"),
        ),
        Kind(
            "cv", POINT, ALIKE, axis_key="axis", to_axis="optional", loads=("damper",), motions=("turning",),
            looser=("ball",), synonyms=("constant_velocity", "constantvelocity", "homokinetic", "rzeppa"),
        ),
        Kind(
            "weld", POINT, NOT_AT_ALL, planar="weld", looser=("ball",), looser_in_plane=("pin",),
            synonyms=("fixed", "rigid", "lock"),
        ),
        Kind(
            "line", LINE, FREE, "forward", axis_key="axis", loads=("damper",), motions=("sliding",),
            planar="flat line", synonyms=("inline", "in_line", "pointonline"),
        ),
        Kind(
            "plane", PLANE, FREE, "forward", axis_key="normal", loads=("damper",), motions=("sliding",),
            planar="flat plane", synonyms=("inplane", "in_plane", "planar", "pointonplane"),
        ),
        Kind(
            "curve", CURVE, FREE, "forward", coordinates=("travel",), drives=("travel",), loads=("damper", "friction"),
            motions=("sliding",), planar="flat curve",
            synonyms=("path", "track", "pointoncurve", "point_on_curve"),
        ),
        Kind("rod", DISTANCE, FREE, "never", drives=("length",), planar="rod",
             synonyms=("distance", "link", "cable", "rope")),
    )
}  # fmt: skip
# with what line and plane are in a scene declared planar: the bodies' z axes stay parallel; and with a pin of what has
# no inertia to turn about it, the angle of which no law determines
JOINTS: dict[str, Kind] = TYPES | {
    kind.name: kind
    for kind in (
        Kind("flat line", LINE_IN_PLANE, ABOUT_Z, "forward", axis_key="axis", motions=("sliding",), spoken="line"),
        Kind("flat plane", PLANE_IN_PLANE, ABOUT_Z, "forward", axis_key="normal", motions=("sliding",),
             spoken="plane"),
        Kind("flat curve", CURVE_IN_PLANE, ABOUT_Z, "forward", coordinates=("travel",), motions=("sliding",),
             spoken="curve"),
        Kind("spun pin", POINT, ABOUT_AXIS, motions=("turning",), looser_in_plane=("flat line",), spoken="pin"),
    )
}  # fmt: skip
# with what they all are where a scene is solved in its plane (multibody/reduction/plane/step.py)
FLAT: dict[tuple[str, bool], Kind] = {
    (kind.name, along): kind._replace(
        name=f"{kind.name} {'along' if along else 'across'} the normal", hold=held[kind.hold], turn=turns[kind.turn],
        coordinates=tuple(x for x in kind.coordinates if kind.follows_path or x == ("angle" if along else "travel")),
        spoken=kind.spoken or kind.name,
    )
    for kind in JOINTS.values()
    for along, held, turns in ((True, HELD_ALONG, TURNS_ALONG), (False, HELD_ACROSS, TURNS_ACROSS))
    if kind.hold in held and kind.turn in turns
}  # fmt: skip
JOINTS |= {kind.name: kind for kind in FLAT.values()}
LENGTHS = frozenset(("travel", "length", "dx", "dy", "dz"))  # of the coordinates; all others are angles
RATES = {"angle": "rate", "travel": "speed"}  # of the coordinates
SYNONYMS = {word: kind.name for kind in TYPES.values() for word in kind.synonyms}


def taking(load: str) -> list[Kind]:
    """The kinds in which a load of this kind may act."""
    return [kind for kind in TYPES.values() if kind.takes(load)]


def named(kinds: list[Kind], last: str) -> str:
    """Kinds in words: "pin, slide and cylinder"; last: "and" or "or"."""
    names = [kind.name for kind in kinds]
    return f" {last} ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def is_length(coordinate: str) -> bool:
    """Whether a coordinate, owner.quantity, is a length."""
    return coordinate.rpartition(".")[2] in LENGTHS
