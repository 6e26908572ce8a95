"""What the results hold: one row a quantity of the JSON (manual/results.md).

From these rows follow the paths of `--measure` and `expect` with their checks, the units and components of CSV and
tables, and the manual's table of results. Shapes are stated here and never guessed from an array's length: a run of
three cuts is no vector. A word in capitals stands for a name of the scene; a name may hold dots (a point is
`body.point`). Imports nothing heavy, so that reading a spec stays light.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from functools import lru_cache
from typing import TypeAlias

from heuncli.base.named_tuples import NamedTuple


class Axis(NamedTuple):
    """One axis of an array; its places are spelled by letters or, where it has none, counted from 0."""

    name: str
    letters: tuple[str, ...] = ()

    @property
    def size(self) -> int | None:
        """How many places it has; None where only the run tells."""
        return len(self.letters) or None

    def index_of(self, word: str, size: int | None = None) -> int | None:
        """The place that a word of a path names, on an axis of this size if it is known; None: there is no such."""
        index = self.letters.index(word) if word in self.letters else counted(word)
        most = self.size if size is None else size
        return index if index is not None and (most is None or index < most) else None

    def labels(self, size: int) -> tuple[str, ...]:
        """What the places are called."""
        return self.letters or tuple(map(str, range(size)))


def counted(word: str) -> int | None:
    """The place in a list that a word of a path gives by its number, from 0; None where it is no such number."""
    return int(word) if word.isascii() and word.isdecimal() and len(word) <= MOST_DIGITS else None


MOST_DIGITS = 12  # of a place in a list: none is as long, and Python reads no more than 4300
SPACE = Axis("space", ("x", "y", "z"))
QUATERNION = Axis("quaternion", ("w", "x", "y", "z"))
CUT = Axis("cut")  # only in runs of cuts
INSTANT = Axis("instant")
INDEX = Axis("index")  # of lists that the schema does not describe
XYZ = SPACE.letters
Shape: TypeAlias = tuple[Axis, ...]


class Quantity(NamedTuple):
    """One quantity: its path, SI unit, shape at one instant, meaning, and whether it runs over the instants.

    Of two units the first holds where the joint or force slides, the second where it turns. Without a unit it is words,
    or a block of its own form (own_form), in which there may be numbers.
    """

    path: str
    units: tuple[str, ...]
    shape: Shape
    meaning: str
    timed: bool = True
    own_form: bool = False

    @property
    def is_words(self) -> bool:
        """Whether there is no number in it."""
        return not self.units and not self.own_form

    def unit(self, turning: bool = False) -> str:
        """The unit of the one that slides or of the one that turns."""
        return self.units[-1 if turning else 0]

    def axes(self, run: bool = False) -> Shape:
        """The axes of one instant: that of the cuts only in a run of them."""
        return tuple(axis for axis in self.shape if run or axis is not CUT)


def at(place: str, meaning: str, *quantities: Quantity) -> tuple[Quantity, ...]:
    """Quantities that stand in one place of the results and share a meaning, in their order."""
    return tuple(q._replace(path=f"{place}.{q.path}" if place else q.path, meaning=meaning) for q in quantities)


def scalar(name: str, unit: str, shape: Shape = (), timed: bool = True) -> Quantity:
    """A number at each instant; of two units, `N | N·m`, the first is of what slides, the second of what turns."""
    return Quantity(name, tuple(unit.split(" | ")), shape, "", timed)


def vector(name: str, unit: str) -> Quantity:
    """Components in world axes at each instant."""
    return scalar(name, unit, (SPACE,))


def cut_scalar(name: str, unit: str) -> Quantity:
    """A number of each cut at each instant."""
    return scalar(name, unit, (CUT,))


def cut_vector(name: str, unit: str) -> Quantity:
    """Components of each cut in world axes at each instant."""
    return scalar(name, unit, (CUT, SPACE))


def words(name: str) -> Quantity:
    """Text, or names."""
    return Quantity(name, (), (), "", timed=False)


def own_form(name: str) -> Quantity:
    """A block that these rows do not describe: of words, and of numbers that do not run over the instants."""
    return Quantity(name, (), (), "", timed=False, own_form=True)


def shares(place: str, *quantities: Quantity) -> tuple[Quantity, ...]:
    """The shares of the causes in the wrench that stands in a place, which they add up to."""
    wrench = vector("force", "N"), vector("moment", "N·m")
    meaning = "the part that CAUSE has in it: `gravity`, a force by its name, `drives` or `motion`"
    return at(f"{place}.shares.CAUSE", meaning, *(quantities or wrench))


DIRECT = (
    "of that part the load itself: for a section where it stands on the piece, for the foundation where it is applied "
    "from outside"
)
# The loads of a section: along n, e1 and e2, and about them. The stresses they make.
SECTION_FORCES, SECTION_MOMENTS = ("N", "Q1", "Q2"), ("T", "M1", "M2")
RESULTANTS = SECTION_FORCES + SECTION_MOMENTS
RESULTANT_UNITS = dict.fromkeys(SECTION_FORCES, "N") | dict.fromkeys(SECTION_MOMENTS, "N·m")
STRESSES = ("normal_max", "normal_min", "shear_torsion", "shear_mean", "shear_max", "mises", "utilisation")
# The loads of a joint that are one number: along its axis, across it, about axes across it; of a rod.
AXIAL_FORCES, TILTING_MOMENTS = ("axial", "radial", "tension"), ("tilting",)
OPEN = "the components that are open at some instant"
NOT_YET = "not yet"
ROWS: tuple[Quantity, ...] = (
    *at("", "what was solved, as `heun model` tells it", own_form("model")),
    *at("", "completed or stopped, and a message", words("status")),
    *at("", "the instants", scalar("time", "s")),
    *at("bodies.BODY", "of the body's origin", vector("position", "m"), vector("velocity", "m/s")),
    *at("bodies.BODY", "attitude of the body; the columns are its axes", scalar("rotation", "1", (SPACE, SPACE))),
    *at("bodies.BODY", "the attitude as unit quaternion `w`, `x`, `y`, `z`; w ≥ 0 at the start, its sign does not jump",
        scalar("quaternion", "1", (QUATERNION,))),
    *at("bodies.BODY", "Rodrigues' vector of the attitude: tan(half the turn) times its axis, of the turn from the "
        "world's axes; null at half a turn", vector("rodrigues", "1")),
    *at("bodies.BODY", "of the centre of mass",
        vector("center", "m"), vector("center_velocity", "m/s"), vector("center_acceleration", "m/s²")),
    *at("bodies.BODY", "of the body", vector("angular_velocity", "rad/s"), vector("angular_acceleration", "rad/s²")),
    *at("bodies.BODY", "momentum; moment of momentum (16) about `foundation.about`",
        vector("momentum", "N·s"), vector("moment_of_momentum", "N·m·s")),
    *at("points.POINT", "of a named point, `body.point`",
        vector("position", "m"), vector("velocity", "m/s"), vector("acceleration", "m/s²")),
    *at("coordinates.JOINT", "turning of `to` against `from` about the axis, turns counted",
        scalar("angle", "rad"), scalar("rate", "rad/s")),
    *at("coordinates.JOINT", "of the coordinate; of a cylinder along its axis",
        scalar("acceleration", "m/s² | rad/s²")),
    *at("coordinates.JOINT", "sliding of `to` against `from` along the axis",
        scalar("travel", "m"), scalar("speed", "m/s")),
    *at("coordinates.JOINT", "of a cylinder about its axis", scalar("angular_acceleration", "rad/s²")),
    *at("foundation", "total ON the ground, its moment about `about`",
        scalar("about", "m", (SPACE,), timed=False), vector("force", "N"), vector("moment", "N·m")),
    *at("foundation.axis", "central axis: its point nearest to `about`, its direction, moment over force",
        vector("point", "m"), vector("direction", "1"), scalar("pitch", "m")),
    *at("foundation.mass_effect", "mass effect (56): +Σ m ẍ, the rates of Σ m x × ẋ and of Σ I σ",
        vector("force", "N"), vector("moment_orbital", "N·m"), vector("moment_spin", "N·m")),
    *at("foundation.supports.JOINT", "of a joint ON the ground, its moment about the `to` point",
        vector("force", "N"), vector("moment", "N·m")),
    *at("foundation.elements.ELEMENT", "of a force, drive or stop ON the ground, its moment about `point`",
        vector("force", "N"), vector("moment", "N·m"), vector("point", "m")),
    *shares("foundation"),
    *at("foundation.shares.CAUSE", DIRECT, vector("direct_force", "N"), vector("direct_moment", "N·m")),
    *shares("foundation.supports.JOINT"),
    *shares("foundation.elements.ELEMENT"),
    *at("joints.JOINT", "of the constraint alone, `from` ON `to`; `point`, about which the moment is, is where the "
        "`to` point is now",
        vector("point", "m"), vector("force", "N"), vector("moment", "N·m")),
    *at("joints.JOINT", f"{OPEN}, and those that a chosen split gives", words("open"), words("chosen")),
    *at("joints.JOINT", "force or torque of the drive ON `to`, along or about the axis", scalar("drive", "N | N·m")),
    *at("joints.JOINT", "the force along the axis, the force across it, the moment across it",
        scalar("axial", "N"), scalar("radial", "N"), scalar("tilting", "N·m")),
    *at("joints.JOINT", "mean pressure of its `bearing`: force (with an axis `radial`) / (diameter · width)",
        scalar("pressure", "Pa")),
    *at("joints.JOINT", "of a `curve` with a `radius`, where the roller touches", vector("contact_point", "m")),
    *at("joints.JOINT", "force of a rod, > 0 where it pulls", scalar("tension", "N")),
    *at("joints.JOINT", "of a `cv`, ON `to` about either shaft", scalar("torque", "N·m")),
    *shares("joints.JOINT", vector("force", "N"), vector("moment", "N·m"), scalar("drive", "N | N·m"),
        scalar("tension", "N"), scalar("torque", "N·m")),
    *at("stops.STOP", "of the stop ON `to`, along or about the coordinate that it limits; 0 where it is free",
        scalar("force", "N"), scalar("moment", "N·m")),
    *at("couplings.COUPLING", "the load that the coupling carries; `contact`: of a cam along the normal of its flank, "
        "above zero where it presses", scalar("force", "N"), scalar("moment", "N·m"), scalar("contact", "N")),
    *at("couplings.COUPLING", "of a cam, the angle between that normal and the way of the follower",
        scalar("pressure_angle", "rad")),
    *at("couplings.COUPLING", "of gears all of the tooth force; of a wheel what the plane presses it with",
        scalar("normal", "N")),
    *at("couplings.COUPLING", "of gears, the parts of the tooth force beside the tangential one",
        scalar("radial", "N"), scalar("axial", "N")),
    *at("couplings.COUPLING", "of a screw with friction, the power that comes out by the power that goes in; 0 where "
        "none comes out", scalar("efficiency", "1")),
    *at("couplings.COUPLING", "of a screw, about its axis", scalar("torque", "N·m")),
    *at("couplings.COUPLING", "of a rope; where sheaves hold it, behind the first of them another one: the last",
        scalar("tension", "N"), scalar("last_tension", "N")),
    *at("couplings.COUPLING", "of a belt, the pulls of its strands; below zero one would have to push",
        scalar("tight", "N"), scalar("slack", "N")),
    *at("couplings.COUPLING", "of a wheel: what keeps it from slipping, in all, along its track and along its axle's "
        "shadow on the plane, ON the wheel", scalar("friction", "N"), scalar("along", "N"), scalar("aside", "N")),
    *at("couplings.COUPLING", "of a wheel with a coefficient of friction, coefficient · normal − friction: it slips "
        "where that is below zero", scalar("grip", "N")),
    *at("couplings.COUPLING.on.END", "what it exerts ON a body, or the ground, that it loads: the moment about `point`",
        vector("point", "m"), vector("force", "N"), vector("moment", "N·m")),
    *at("couplings.COUPLING", OPEN, words("open")),
    *shares("couplings.COUPLING", scalar("force", "N"), scalar("moment", "N·m"), scalar("contact", "N"),
        scalar("normal", "N"), scalar("along", "N"), scalar("aside", "N"), scalar("torque", "N·m"),
        scalar("tension", "N"), scalar("last_tension", "N")),
    *at("sections.SECTION", "the point about which moments are taken", cut_vector("point", "m")),
    *at("sections.SECTION", "n, into the piece that is cut off, and e1; e2 = n × e1",
        vector("normal", "1"), vector("first_axis", "1")),
    *at("sections.SECTION", OPEN, words("open")),
    *at("sections.SECTION", "of the piece ON the remainder", cut_vector("force", "N"), cut_vector("moment", "N·m")),
    *at("sections.SECTION", "force along n (> 0 tension), e1, e2",
        *(cut_scalar(name, "N") for name in SECTION_FORCES)),
    *at("sections.SECTION", "moment about n, e1, e2",
        *(cut_scalar(name, "N·m") for name in SECTION_MOMENTS)),
    *at("sections.SECTION.line", "reduction line: a point of it, its direction, where the moment in the plane is "
        "zero; kind 0: a line, 1: none, 2: any",
        cut_vector("point", "m"), cut_vector("direction", "1"), cut_vector("pressure_centre", "m"),
        cut_scalar("kind", "1")),
    *at("sections.SECTION.stress",
        "extremes over the section, [on the safe side](stresses.md); `utilisation` is `mises` over `strength`",
        *(cut_scalar(name, "1" if name == "utilisation" else "Pa") for name in STRESSES)),
    *at("sections.SECTION", "kinetic energy of the piece", cut_scalar("energy", "J")),
    *at("sections.SECTION", "of a run of cuts: from its first point to each cut",
        scalar("s", "m", (CUT,), timed=False)),
    *at("sections.SECTION", "of a run: before or beyond what acts in the plane of the cut", words("side")),
    *shares("sections.SECTION", cut_vector("force", "N"), cut_vector("moment", "N·m"),
        *(cut_scalar(name, "N") for name in SECTION_FORCES), *(cut_scalar(name, "N·m") for name in SECTION_MOMENTS)),
    *at("sections.SECTION.shares.CAUSE", DIRECT, cut_vector("direct_force", "N"), cut_vector("direct_moment", "N·m")),
    *at("forces.FORCE", "its value as in the spec; of a vector its size, of a distributed load that of the resultant",
        scalar("value", "N | N·m")),
    *at("forces.FORCE", "distance of its two points", scalar("length", "m")),
    *at("forces.FORCE", "of a turn_spring", scalar("angle", "rad")),
    *at("forces.FORCE", "of a bushing, in its axes: how far its `to` point has shifted, and its `to` body turned",
        vector("shift", "m"), vector("turn", "rad")),
    *at("forces.FORCE", "of a bushing, in its axes: what it exerts ON `to`, at its `to` point",
        vector("force", "N"), vector("moment", "N·m")),
    *at("forces.FORCE", "at which its points part, or its joint moves", scalar("rate", "m/s | rad/s")),
    *at("forces.FORCE", "that it puts into the bodies", scalar("power", "W")),
    *at("energy", "kinetic + potential − work is constant",
        scalar("kinetic", "J"), scalar("potential", "J"), scalar("work", "J")),
    *at("momentum", "sums over the bodies: momentum, Σ m x × ẋ and Σ I σ about `foundation.about`; their rates are "
        "the mass effects",
        vector("total", "N·s"), vector("moment_orbital", "N·m·s"), vector("moment_spin", "N·m·s")),
    *at("system_vector", "Heun's B (44)", vector("total", "N·m/s")),
    *at("system_vector.bodies", "each body's part in it", vector("BODY", "N·m/s")),
    *at("system_vector.energy_part", "of that part 2 E σ, E the energy of its spin", vector("BODY", "N·m/s")),
    *at("system_vector.deviation_part", "and G = T (σ × σ̇); 0 where the body turns on about one axis: its vector then "
        "lies on the momentary axis", vector("BODY", "N·m/s")),
    *at("impulses.NUMBER", "its instant", scalar("time", "s", timed=False)),
    *at("impulses.NUMBER", "what struck: blows, drives whose rate jumps, ropes that caught, stops", words("names")),
    *at("impulses.NUMBER.bodies.BODY", "jumps of the body's velocities",
        vector("center_velocity_jump", "m/s"), vector("angular_velocity_jump", "rad/s")),
    *at("impulses.NUMBER", "kinetic energy before and after, and the difference",
        scalar("energy_before", "J"), scalar("energy_after", "J"), scalar("energy_jump", "J")),
    *at("events.EVENT", "what is watched", words("condition")),
    *at("events.EVENT", "1 where the condition is true at the start, else 0", scalar("begins", "1", timed=False)),
    *at("events.EVENT", "the instants at which it changes, and their errors",
        scalar("time", "s", (INDEX,), timed=False), scalar("error", "s", (INDEX,), timed=False)),
    *at("events.EVENT", "what it becomes there: 1 true, 0 not", scalar("to", "1", (INDEX,), timed=False)),
    *at("certain_sums.NUMBER", "the factor of each open component", own_form("terms")),
    *at("certain_sums.NUMBER", "sum of the open components in `terms`, each times its factor",
        scalar("value", "N | N·m")),
    *at("accuracy", "[estimates](accuracy.md#estimates); nothing is claimed after the "
        "[horizon](accuracy.md#horizon) (null: none)",
        scalar("energy_drift", "1", timed=False), scalar("constraint_gap", "m", timed=False),
        scalar("balance_residual", "1", timed=False), scalar("horizon", "s", timed=False)),
    *at("accuracy", "instants beside singular poses: what rounding reaches is null there", own_form("unknown")),
    *at("accuracy.estimate", "error of any point at any instant, over the scene's size",
        scalar("motion", "1", timed=False)),
    *at("accuracy.estimate", "the same of each kind of number, over its own largest; 0 where there is none",
        scalar("reactions", "1", timed=False), scalar("drives", "1", timed=False),
        scalar("foundation", "1", timed=False), scalar("sections", "1", timed=False),
        scalar("energy", "1", timed=False)),
    *at("", "kernel, steps, evaluations, seconds", own_form("work")),
    *at("", "as in the spec", words("title")),
)  # fmt: skip

# The blocks that run over the instants, in their order, and the report each belongs to; the rest always stays.
REPORT_OF = {
    "bodies": "motion",
    "points": "points",
    "coordinates": "motion",
    "foundation": "foundation",
    "joints": "joints",
    "stops": "joints",
    "couplings": "joints",
    "sections": "sections",
    "forces": "forces",
    "energy": "energy",
    "momentum": "motion",
    "system_vector": "motion",
}
BLOWS, EVENTS = "impulses", "events"  # the reports of what does not run over the instants
REPORTS = (*dict.fromkeys(REPORT_OF.values()), BLOWS, EVENTS)
SHARES = "shares"  # no block of its own, but beside every wrench of these:
SHARED = frozenset({"foundation", "joints", "sections"})
# Magnitudes: never negative, with a kink at zero that their squares do not have.
MAGNITUDES = frozenset(
    {"radial", "tilting", "shear_torsion", "shear_mean", "shear_max", "mises", "utilisation", "pressure"}
)
AFTER_THE_RUN = frozenset({"certain_sums", "accuracy"})  # of numbers that no spec foretells
ESTIMATES = {
    "foundation": "foundation", "joints": "reactions", "stops": "reactions",
    "couplings": "reactions", "sections": "sections", "energy": "energy",
}  # fmt: skip
# of which estimate those errors are that have none of their own
KIND_OF = {
    "forces": "reactions",
    "axis": "foundation",
    "attitudes": "motion",
    "rodrigues": "motion",
    "strains": "motion",
    "travels": "motion",
}
ATTITUDES = {"rotation": "attitudes", "quaternion": "attitudes", "rodrigues": "rodrigues"}
TRAVELS = ("travel", "speed", "acceleration")  # along a path by whatever its tables are over, elsewhere as places
OF_A_LOAD = dict.fromkeys(("length", "angle", "rate"), "motion") | dict.fromkeys(("shift", "turn"), "strains")
NAMES = ("BODY", "POINT", "JOINT", "ELEMENT", "STOP", "COUPLING", "END", "SECTION", "FORCE", "CAUSE", "EVENT", "NUMBER")
BY_CAUSE = "by cause"  # of kinds of errors
AT_A_BLOW = {"N": "N·s", "N·m": "N·m·s"}  # units of the loads in `impulses`
# what a blow has besides its own quantities, as at one instant; of impulses no stresses, pressures, energies are told
STRUCK = ("foundation", "joints", "stops", "couplings", "sections", "certain_sums")
UNSTRUCK = ("joints.JOINT.pressure", "sections.SECTION.stress.", "sections.SECTION.energy")

Node: TypeAlias = "dict[str, Node | Quantity]"


def _tree() -> Node:
    """The rows by the words of their paths."""
    tree: Node = {}
    for row in ROWS:
        _plant(tree, row.path.split("."), row)
    for row in ROWS:
        first, *_ = row.path.split(".")
        if first in STRUCK and not row.path.startswith(UNSTRUCK):
            units = tuple(AT_A_BLOW.get(unit, unit) for unit in row.units)
            path = f"impulses.NUMBER.{row.path}"
            _plant(tree, path.split("."), row._replace(path=path, units=units))
    return tree


def _plant(tree: Node, path: Sequence[str], row: Quantity) -> None:
    for word in path[:-1]:
        below = tree.setdefault(word, {})
        assert isinstance(below, dict), row.path
        tree = below
    tree[path[-1]] = row


TREE = _tree()


def below(node: Node, key: str) -> Node | Quantity | None:
    """What stands under a key: a word of the schema, or a name of the scene."""
    if key in node:
        return node[key]
    return next((node[name] for name in NAMES if name in node), None)


def under(keys: Iterable[str]) -> Node | Quantity | None:
    """What stands in the results under these keys: a row, or those of a block; None where there is none."""
    node: Node | Quantity | None = TREE
    for key in keys:
        if not isinstance(node, dict):
            return None
        node = below(node, key)
    return node


def quantity(keys: Iterable[str]) -> Quantity | None:
    """The row of what stands in the results under these keys; None where there is none."""
    return _quantity(tuple(keys))


@lru_cache(maxsize=10_000)  # the paths of a scene, which every look at some of its instants goes through
def _quantity(keys: tuple[str, ...]) -> Quantity | None:
    node = under(keys)
    return node if isinstance(node, Quantity) else None


def is_no_number(keys: Sequence[str]) -> bool:
    """Whether what stands under these keys is a block, or words, be it empty."""
    return _is_no_number(tuple(keys))


@lru_cache(maxsize=10_000)
def _is_no_number(keys: tuple[str, ...]) -> bool:
    rows = (quantity(keys[:n]) for n in range(1, len(keys) + 1))
    return isinstance(under(keys), dict) or any(row is not None and row.is_words for row in rows)


def beside_magnitudes(axes: Shape) -> Shape:
    """The axes beside which numbers have no extreme: a vector counts by its magnitude, a run of cuts as a whole.

    One number for an attitude, by its quaternion or its rows, would mean nothing.
    """
    left = tuple(axis for axis in axes if axis is not CUT)
    return left[:-1] if left[-1:] == (SPACE,) else left


def spelled_first(axes: Shape) -> str:
    """The words that name the first number of what has these axes: `.x`, `.0.x`."""
    return "".join(f".{axis.labels(1)[0]}" for axis in axes)


def with_shared(wanted: frozenset[str]) -> frozenset[str]:
    """The reports that are wanted; of shares alone, those that they stand in."""
    return wanted | SHARED if SHARES in wanted and not wanted & (SHARED | {BLOWS}) else wanted


def is_share(row: Quantity) -> bool:
    """Whether it is what a cause does of something else."""
    return f".{SHARES}.CAUSE." in row.path


def names_shares(words: list[str]) -> bool:
    """Whether a path leads to shares by cause: not every `shares` in it does, for a joint or body may be called so."""
    if words[:1] == [BLOWS]:
        return names_shares(words[2:])
    if words[:1] == ["foundation"]:
        inner = words[1:2] in (["supports"], ["elements"])  # a name behind them may have its block before it
        return (
            SHARES in words[3 : 5 if words[2:3] in (["drives"], ["couplings"]) else 4]
            if inner
            else words[1:2] == [SHARES]
        )
    return words[2:3] == [SHARES]


def kind_of_error(kind: str, name: str, number: str) -> str:
    """Of which estimate (of `accuracy.estimate`) the error of a quantity is, by the words of its path.

    Shares by cause have their own: they may be larger than what they add up to, and err by more. Numbers of
    a blow are of the kinds that they have at an instant.
    """
    if kind == BLOWS:
        kind, _, name = name.partition(".")[2].partition(".")
    words = name.split(".")  # `shares.CAUSE` of the foundation, else `NAME.shares.CAUSE`: a NAME may be `shares`, too
    by_cause = words[-2:-1] == [SHARES] and (kind == "foundation" or len(words) > 2)
    if by_cause and kind in SHARED | {"couplings"}:
        return f"{kind_of_error(kind, '.'.join(words[:-2]), number.removeprefix('direct_'))} {BY_CAUSE}"
    if kind == "joints" and number == "drive":
        return "drives"
    if kind == "foundation" and name.startswith("supports."):
        return "reactions"
    if kind == "foundation" and name == "axis":
        return "axis"
    if kind == "forces":
        return OF_A_LOAD.get(number, "forces")
    if number.startswith("energy_"):
        return "energy"
    if kind == "bodies" and number in ATTITUDES:
        return ATTITUDES[number]
    if kind == "coordinates" and number in TRAVELS:
        return "travels"
    return ESTIMATES.get(kind, "motion")


def report_of(block: str) -> str | None:
    """The report to which a block of the results belongs; None where it always stays."""
    return block if block in (BLOWS, EVENTS) else REPORT_OF.get(block)


def leading_key(known: Collection[str], path: Sequence[str]) -> tuple[str | None, list[str]]:
    """The key that the most leading words of a path spell together, and the words behind it; None if there is none."""
    for used in range(min(len(path), 8), 0, -1):
        if (key := ".".join(path[:used])) in known:
            return key, list(path[used:])
    return None, list(path)


def unknown_key(known: Collection[str], path: Sequence[str]) -> str:
    """The leading words of a path that spell none of the keys: two of them where there are keys in two words."""
    dotted = any(key.startswith(f"{path[0]}.") for key in known)
    return ".".join(path[: 2 if dotted else 1])


def row_of(path: str) -> Quantity:
    """The row of a path as the schema spells it."""
    return next(row for row in ROWS if row.path == path)
