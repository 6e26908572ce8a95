"""The schema of the results: one row per quantity of the JSON (manual/results.md).

From these rows follow the paths of `--measure` and `expect` with their checks, the units and components of CSV and
tables, and the manual's table of results. Shapes are stated here and never guessed from an array's length: a run of
three cuts is no vector. A word in capitals stands for a name of the scene; a name may contain dots (a point is
`body.point`). Imports nothing heavy, so that reading a spec stays fast.
"""

from __future__ import annotations

from typing import TypeAlias

from heuncli.base.named_tuples import NamedTuple


class Axis(NamedTuple):
    """One axis of an array; its elements are named by letters or, if it has none, counted from 0."""

    name: str
    letters: tuple[str, ...] = ()

    @property
    def size(self) -> int | None:
        """The number of elements; None if it depends on the run."""
        return len(self.letters) or None

    def find_index(self, word: str, size: int | None = None) -> int | None:
        """Return the index that a word of a path names, on an axis of a size if that is known; None if there is
        none.
        """
        index = self.letters.index(word) if word in self.letters else parse_index(word)
        limit = self.size if size is None else size
        return index if index is not None and (limit is None or index < limit) else None

    def make_labels(self, size: int) -> tuple[str, ...]:
        """Return the labels of the elements."""
        return self.letters or tuple(map(str, range(size)))


def parse_index(word: str) -> int | None:
    """Return the index in a list that a word of a path gives, from 0; None if the word is no such number."""
    return int(word) if word.isascii() and word.isdecimal() and len(word) <= MAX_DIGITS else None


MAX_DIGITS = 12  # of a place in a list: none is as long, and Python reads no more than 4300
SPACE = Axis("space", ("x", "y", "z"))
QUATERNION = Axis("quaternion", ("w", "x", "y", "z"))
CUT = Axis("cut")  # only in series of cuts
INSTANT = Axis("instant")
INDEX = Axis("index")  # of lists that the schema does not describe
XYZ = SPACE.letters
Shape: TypeAlias = tuple[Axis, ...]


class Quantity(NamedTuple):
    """One quantity: its path, SI unit, shape at one instant, meaning, and whether it has a value at each instant.

    Of two units the first holds where the joint or force slides, the second where it turns. Without a unit it is words,
    or a block of its own form (has_own_form), which may contain numbers.
    """

    path: str
    units: tuple[str, ...]
    shape: Shape
    meaning: str
    is_timed: bool = True
    has_own_form: bool = False

    @property
    def is_words(self) -> bool:
        """Whether it contains no number."""
        return not self.units and not self.has_own_form

    def select_unit(self, turning: bool = False) -> str:
        """Return the unit for a sliding or a turning joint or force."""
        return self.units[-1 if turning else 0]

    def instant_axes(self, in_series: bool = False) -> Shape:
        """Return the axes at one instant; a series of cuts adds the axis of the cuts."""
        return tuple(axis for axis in self.shape if in_series or axis is not CUT)


def rows(prefix: str, meaning: str, *quantities: Quantity) -> tuple[Quantity, ...]:
    """Return quantities with a prefix before their paths and one meaning for all, in their order."""
    return tuple(q._replace(path=f"{prefix}.{q.path}" if prefix else q.path, meaning=meaning) for q in quantities)


def scalar(name: str, unit: str, shape: Shape = (), is_timed: bool = True) -> Quantity:
    """Make a number at each instant; of two units, `N | N·m`, the first is for sliding, the second for turning."""
    return Quantity(name, tuple(unit.split(" | ")), shape, "", is_timed)


def vector(name: str, unit: str) -> Quantity:
    """Make components in world axes at each instant."""
    return scalar(name, unit, (SPACE,))


def cut_scalar(name: str, unit: str) -> Quantity:
    """Make a number of each cut at each instant."""
    return scalar(name, unit, (CUT,))


def cut_vector(name: str, unit: str) -> Quantity:
    """Make components of each cut in world axes at each instant."""
    return scalar(name, unit, (CUT, SPACE))


def words(name: str) -> Quantity:
    """Make a text, or names."""
    return Quantity(name, (), (), "", is_timed=False)


def block(name: str) -> Quantity:
    """Make a block that these rows do not describe: of words, and of numbers without instants."""
    return Quantity(name, (), (), "", is_timed=False, has_own_form=True)


def shares(prefix: str, *quantities: Quantity) -> tuple[Quantity, ...]:
    """Make the rows of the shares that each cause has in the force and moment (or other quantities) at a path."""
    wrench = vector("force", "N"), vector("moment", "N·m")
    meaning = "contribution of CAUSE"
    return rows(f"{prefix}.shares.CAUSE", meaning, *(quantities or wrench))


DIRECT = (
    "direct part of the contribution of CAUSE: the load itself, if it acts on the far side "
    "of the section, or on the foundation from outside"
)
# The loads of a section: along n, e1 and e2, and about them. The stresses they make.
SECTION_FORCES, SECTION_MOMENTS = ("N", "Q1", "Q2"), ("T", "M1", "M2")
RESULTANTS = SECTION_FORCES + SECTION_MOMENTS
RESULTANT_UNITS = dict.fromkeys(SECTION_FORCES, "N") | dict.fromkeys(SECTION_MOMENTS, "N·m")
DEFLECTIONS = ("w1", "w2", "slope1", "slope2")
STRESSES = ("normal_max", "normal_min", "shear_torsion", "shear_mean", "shear_max", "mises", "utilisation")
# The loads of a joint that are one number: along its axis, across it, about axes across it; of a rod.
AXIAL_FORCES, TILTING_MOMENTS = ("axial", "radial", "tension"), ("tilting",)
OPEN = "components that are open at some time"
NOT_YET = "not yet"
ROWS: tuple[Quantity, ...] = (
    *rows("", "the model, as shown by `heun model`", block("model")),
    *rows("", "completed or stopped, with a message", words("status")),
    *rows("", "output times", scalar("time", "s")),
    *rows("bodies.BODY", "of the body origin", vector("position", "m"), vector("velocity", "m/s")),
    *rows("bodies.BODY", "orientation of the body; the columns are its axes", scalar("rotation", "1", (SPACE, SPACE))),
    *rows("bodies.BODY", "orientation as unit quaternion `w`, `x`, `y`, `z`; w ≥ 0 at the start, "
        "without sign jumps", scalar("quaternion", "1", (QUATERNION,))),
    *rows("bodies.BODY", "Rodrigues vector of the orientation relative to world axes: tan(half the "
        "rotation angle) times the axis; null at 180°", vector("rodrigues", "1")),
    *rows("bodies.BODY", "of the centre of mass",
        vector("center", "m"), vector("center_velocity", "m/s"), vector("center_acceleration", "m/s²")),
    *rows("bodies.BODY", "of the body", vector("angular_velocity", "rad/s"), vector("angular_acceleration", "rad/s²")),
    *rows("bodies.BODY", "momentum; moment of momentum (16) about `foundation.about`",
        vector("momentum", "N·s"), vector("moment_of_momentum", "N·m·s")),
    *rows("points.POINT", "of a named point, `body.point`",
        vector("position", "m"), vector("velocity", "m/s"), vector("acceleration", "m/s²")),
    *rows("coordinates.JOINT", "rotation of `to` relative to `from` about the axis, counted over revolutions",
        scalar("angle", "rad"), scalar("rate", "rad/s")),
    *rows("coordinates.JOINT", "of the coordinate; for a cylinder, along its axis",
        scalar("acceleration", "m/s² | rad/s²")),
    *rows("coordinates.JOINT", "displacement of `to` relative to `from` along the axis",
        scalar("travel", "m"), scalar("speed", "m/s")),
    *rows("coordinates.JOINT", "of a cylinder about its axis", scalar("angular_acceleration", "rad/s²")),
    *rows("foundation", "total load ON the ground, moment about `about`",
        scalar("about", "m", (SPACE,), is_timed=False), vector("force", "N"), vector("moment", "N·m")),
    *rows("foundation.axis", "central axis: point nearest to `about`, direction, and moment divided by force",
        vector("point", "m"), vector("direction", "1"), scalar("pitch", "m")),
    *rows("foundation.mass_effect", "mass effect (56): +Σ m ẍ, d/dt Σ m x × ẋ and d/dt Σ I σ",
        vector("force", "N"), vector("moment_orbital", "N·m"), vector("moment_spin", "N·m")),
    *rows("foundation.supports.JOINT", "load of a joint ON the ground, moment about the `to` point",
        vector("force", "N"), vector("moment", "N·m")),
    *rows("foundation.elements.ELEMENT", "load of a force, drive or stop ON the ground, moment about `point`",
        vector("force", "N"), vector("moment", "N·m"), vector("point", "m")),
    *shares("foundation"),
    *rows("foundation.shares.CAUSE", DIRECT, vector("direct_force", "N"), vector("direct_moment", "N·m")),
    *shares("foundation.supports.JOINT"),
    *shares("foundation.elements.ELEMENT"),
    *rows("joints.JOINT", "constraint reaction of `from` ON `to`; moment about `point`, the current "
        "position of the `to` point",
        vector("point", "m"), vector("force", "N"), vector("moment", "N·m")),
    *rows("joints.JOINT", f"{OPEN}, and those set by a chosen distribution", words("open"), words("chosen")),
    *rows("joints.JOINT", "drive force or torque ON `to`, along or about the axis", scalar("drive", "N | N·m")),
    *rows("joints.JOINT", "force along the axis, force perpendicular to it, moment perpendicular to it",
        scalar("axial", "N"), scalar("radial", "N"), scalar("tilting", "N·m")),
    *rows("joints.JOINT", "mean pressure in its `bearing`: force (`radial` if the joint has an axis) / "
        "(diameter · width)",
        scalar("pressure", "Pa")),
    *rows("joints.JOINT.bearings.BEARING", "of its two [bearings](format.md#bearings), 0 the first: its point, its "
        "load ON `to` across the axis, the magnitude of that, and its load along the axis",
        vector("point", "m"), vector("radial_force", "N"), scalar("radial", "N"), scalar("axial", "N")),
    *rows("joints.JOINT.bearings.BEARING", OPEN, words("open")),
    *shares("joints.JOINT.bearings.BEARING", vector("radial_force", "N"), scalar("axial", "N")),
    *rows("joints.JOINT", "contact point of the roller, for a `curve` with a `radius`", vector("contact_point", "m")),
    *rows("joints.JOINT", "force of a rod, > 0 in tension", scalar("tension", "N")),
    *rows("joints.JOINT", "torque of a `cv` ON `to` about either shaft", scalar("torque", "N·m")),
    *shares("joints.JOINT", vector("force", "N"), vector("moment", "N·m"), scalar("drive", "N | N·m"),
        scalar("tension", "N"), scalar("torque", "N·m")),
    *rows("sensors.SENSOR", "reaction that the [sensor](format.md#sensors) reads, in its axes; moment about `point`, "
        "which is in world axes",
        vector("point", "m"), vector("force", "N"), vector("moment", "N·m")),
    *rows("sensors.SENSOR", OPEN, words("open")),
    *shares("sensors.SENSOR"),
    *rows("stops.STOP", "load of the stop ON `to`, along or about the limited coordinate; 0 without contact",
        scalar("force", "N"), scalar("moment", "N·m")),
    *rows("couplings.COUPLING", "load transmitted by the coupling; `contact`: cam force along the flank "
        "normal, > 0 in compression", scalar("force", "N"), scalar("moment", "N·m"), scalar("contact", "N")),
    *rows("couplings.COUPLING", "for a cam, angle between that normal and the follower direction",
        scalar("pressure_angle", "rad")),
    *rows("couplings.COUPLING", "for gears, the total tooth force; for a wheel, the normal force of the plane",
        scalar("normal", "N")),
    *rows("couplings.COUPLING", "for gears, the radial and axial parts of the tooth force",
        scalar("radial", "N"), scalar("axial", "N")),
    *rows("couplings.COUPLING", "for a screw with friction, output power / input power; 0 if there is no output",
        scalar("efficiency", "1")),
    *rows("couplings.COUPLING", "for a screw, about its axis", scalar("torque", "N·m")),
    *rows("couplings.COUPLING", "for a screw that may stick, about its axis: as of `forces`", scalar("reserve", "N·m")),
    *rows("couplings.COUPLING", "rope tension; if sheaves grip the rope it differs after the first of them: "
        "last tension",
        scalar("tension", "N"), scalar("last_tension", "N")),
    *rows("couplings.COUPLING", "strand tensions of a belt; a negative value would mean compression",
        scalar("tight", "N"), scalar("slack", "N")),
    *rows("couplings.COUPLING", "friction force ON a wheel that prevents slip: total, along its track, and "
        "along the axle's projection on the plane",
        scalar("friction", "N"), scalar("along", "N"), scalar("aside", "N")),
    *rows("couplings.COUPLING", "for a wheel with a friction coefficient: coefficient · normal − friction; it "
        "slips if this is negative", scalar("grip", "N")),
    *rows("couplings.COUPLING.on.END", "load ON a connected body or the ground, moment about `point`",
        vector("point", "m"), vector("force", "N"), vector("moment", "N·m")),
    *rows("couplings.COUPLING", OPEN, words("open")),
    *shares("couplings.COUPLING", scalar("force", "N"), scalar("moment", "N·m"), scalar("contact", "N"),
        scalar("normal", "N"), scalar("along", "N"), scalar("aside", "N"), scalar("torque", "N·m"),
        scalar("tension", "N"), scalar("last_tension", "N")),
    *rows("sections.SECTION", "reference point of the moments", cut_vector("point", "m")),
    *rows("sections.SECTION", "n, towards the far side of the cut, and e1; e2 = n × e1",
        vector("normal", "1"), vector("first_axis", "1")),
    *rows("sections.SECTION", OPEN, words("open")),
    *rows("sections.SECTION", "force and moment of the far side ON the near side",
        cut_vector("force", "N"), cut_vector("moment", "N·m")),
    *rows("sections.SECTION", "force along n (> 0 tension), e1, e2",
        *(cut_scalar(name, "N") for name in SECTION_FORCES)),
    *rows("sections.SECTION", "moment about n, e1, e2",
        *(cut_scalar(name, "N·m") for name in SECTION_MOMENTS)),
    *rows("sections.SECTION.line", "reduction line: a point on it, its direction, the point where the moment in "
        "the plane is zero; kind 0: a line, 1: none, 2: any",
        cut_vector("point", "m"), cut_vector("direction", "1"), cut_vector("pressure_centre", "m"),
        cut_scalar("kind", "1")),
    *rows("sections.SECTION.stress",
        "extremes over the section, [on the safe side](stresses.md); `utilisation` is `mises` over `strength`",
        *(cut_scalar(name, "1" if name == "utilisation" else "Pa") for name in STRESSES)),
    *rows("sections.SECTION.stress.points.CORNER", "at a corner of a [member](stresses.md#members), in its `web`",
        cut_scalar("normal", "Pa"), cut_scalar("shear", "Pa")),
    *rows("sections.SECTION.deflection", "of a run with [`deflection`](stresses.md#deflection): along e1, e2, and d/ds",
        *(cut_scalar(name, "rad" if name.startswith("slope") else "m") for name in DEFLECTIONS)),
    *rows("sections.SECTION", "its safety against buckling; 1000 stands for any larger one, and for tension",
        scalar("buckling", "1")),
    *rows("sections.SECTION", "kinetic energy of the far side", cut_scalar("energy", "J")),
    *rows("sections.SECTION", "for a series of cuts: distance from its first point to each cut",
        scalar("s", "m", (CUT,), is_timed=False)),
    *rows("sections.SECTION", "for a run: before or beyond the load in the plane of the cut", words("side")),
    *shares("sections.SECTION", cut_vector("force", "N"), cut_vector("moment", "N·m"),
        *(cut_scalar(name, "N") for name in SECTION_FORCES), *(cut_scalar(name, "N·m") for name in SECTION_MOMENTS)),
    *rows("sections.SECTION.shares.CAUSE", DIRECT, cut_vector("direct_force", "N"), cut_vector("direct_moment", "N·m")),
    *rows("forces.FORCE", "value as in the spec; magnitude of a vector, or of the resultant of a "
        "distributed load",
        scalar("value", "N | N·m")),
    *rows("forces.FORCE", "distance between its two points", scalar("length", "m")),
    *rows("forces.FORCE", "of a `turn_spring`", scalar("angle", "rad")),
    *rows("forces.FORCE", "for a bushing, in its axes: displacement of the `to` point and rotation of "
        "the `to` body",
        vector("shift", "m"), vector("turn", "rad")),
    *rows("forces.FORCE", "for a bushing, in its axes: load ON `to`, at its `to` point",
        vector("force", "N"), vector("moment", "N·m")),
    *rows("forces.FORCE", "rate at which its points separate or its joint moves", scalar("rate", "m/s | rad/s")),
    *rows("forces.FORCE", "power delivered to the bodies", scalar("power", "W")),
    *rows("forces.FORCE", "for friction that may stick: static friction minus magnitude of value; 0 while it slips",
        scalar("reserve", "N | N·m")),
    *rows("forces.FORCE", "`value`, of frictions that stick as one", words("open")),
    *rows("energy", "kinetic + potential − work is constant",
        scalar("kinetic", "J"), scalar("potential", "J"), scalar("work", "J")),
    *rows("momentum", "sums over the bodies: momentum, Σ m x × ẋ and Σ I σ about `foundation.about`; "
        "their time derivatives are the mass effects",
        vector("total", "N·s"), vector("moment_orbital", "N·m·s"), vector("moment_spin", "N·m·s")),
    *rows("system_vector", "Heun's B (44)", vector("total", "N·m/s")),
    *rows("system_vector.bodies", "contribution of each body", vector("BODY", "N·m/s")),
    *rows("system_vector.energy_part", "part 2 E σ of that contribution, E: rotational energy",
        vector("BODY", "N·m/s")),
    *rows("system_vector.deviation_part", "part G = T (σ × σ̇) of that contribution; 0 if the body keeps rotating about "
        "one axis: its vector then lies on the instantaneous axis", vector("BODY", "N·m/s")),
    *rows("impulses.NUMBER", "time of the impulse", scalar("time", "s", is_timed=False)),
    *rows("impulses.NUMBER", "causes: given impulses, drives whose rate jumps, ropes that became taut, stops",
        words("names")),
    *rows("impulses.NUMBER.bodies.BODY", "velocity jumps of the body",
        vector("center_velocity_jump", "m/s"), vector("angular_velocity_jump", "rad/s")),
    *rows("impulses.NUMBER", "kinetic energy before and after, and the difference",
        scalar("energy_before", "J"), scalar("energy_after", "J"), scalar("energy_jump", "J")),
    *rows("events.EVENT", "condition", words("condition")),
    *rows("events.EVENT", "1 if the condition is true at the start, else 0", scalar("begins", "1", is_timed=False)),
    *rows("events.EVENT", "times at which the condition changes, and their errors",
        scalar("time", "s", (INDEX,), is_timed=False), scalar("error", "s", (INDEX,), is_timed=False)),
    *rows("events.EVENT", "new value: 1 true, 0 false", scalar("to", "1", (INDEX,), is_timed=False)),
    *rows("certain_sums.NUMBER", "factor of each open component", block("terms")),
    *rows("certain_sums.NUMBER", "of frictions that stick as one: their sum's unit", words("unit")),
    *rows("certain_sums.NUMBER", "sum of the open components in `terms`, each multiplied by its factor",
        scalar("value", "N | N·m")),
    *rows("accuracy", "[estimates](accuracy.md#estimates); no results are claimed after the "
        "[horizon](accuracy.md#horizon) (null: none)",
        scalar("energy_drift", "1", is_timed=False), scalar("constraint_gap", "m", is_timed=False),
        scalar("balance_residual", "1", is_timed=False), scalar("horizon", "s", is_timed=False)),
    *rows("accuracy", "times near singular positions: numbers affected by rounding are null there", block("unknown")),
    *rows("accuracy.estimate", "error of any point at any time, relative to model size",
        scalar("motion", "1", is_timed=False)),
    *rows("accuracy.estimate", "error of each kind of number, relative to its own largest value; 0 if there is none",
        scalar("reactions", "1", is_timed=False), scalar("drives", "1", is_timed=False),
        scalar("foundation", "1", is_timed=False), scalar("sections", "1", is_timed=False),
        scalar("energy", "1", is_timed=False)),
    *rows("", "kernel, steps, evaluations, seconds", block("work")),
    *rows("", "as in the spec", words("title")),
    *rows("", "[labels](format.md#labels) by the paths of the results; left out if the spec has none", words("labels")),
)  # fmt: skip

# The blocks that run over the instants, in their order, and the report each belongs to; the rest always stays.
REPORT_OF = {
    "bodies": "motion",
    "points": "points",
    "coordinates": "motion",
    "foundation": "foundation",
    "joints": "joints",
    "sensors": "joints",
    "stops": "joints",
    "couplings": "joints",
    "sections": "sections",
    "forces": "forces",
    "energy": "energy",
    "momentum": "motion",
    "system_vector": "motion",
}
IMPULSES, EVENTS = "impulses", "events"  # reports of blocks without an axis of instants
REPORTS = (*dict.fromkeys(REPORT_OF.values()), IMPULSES, EVENTS)
SHARES = "shares"  # no block of its own, but beside every wrench of these:
SHARED_BLOCKS = frozenset({"foundation", "joints", "sections"})
# Magnitudes: never negative, with a kink at zero that their squares do not have.
MAGNITUDES = frozenset(
    {"radial", "tilting", "shear_torsion", "shear_mean", "shear_max", "mises", "utilisation", "pressure"}
)
BLOCKS_KNOWN_AFTER_RUN = frozenset({"certain_sums", "accuracy"})  # blocks of numbers that do not follow from the spec
# of which estimate those errors are that have none of their own
ESTIMATE_OF_ERROR_KIND = {
    "forces": "reactions",
    "axis": "foundation",
    "attitudes": "motion",
    "rodrigues": "motion",
    "strains": "motion",
    "travels": "motion",
    "deflections": "sections",
    "sensors": "reactions",
    "bearings": "reactions",
}


def independent_axes(axes: Shape) -> Shape:
    """Return the axes along which extremes are separate: a vector counts by its magnitude, a series of cuts as a whole.

    One number for an attitude, by its quaternion or its rows, would mean nothing.
    """
    axes_without_cuts = tuple(axis for axis in axes if axis is not CUT)
    return axes_without_cuts[:-1] if axes_without_cuts[-1:] == (SPACE,) else axes_without_cuts


def first_element_suffix(axes: Shape) -> str:
    """Return the path suffix of the first number of an array with these axes: `.x`, `.0.x`."""
    return "".join(f".{axis.make_labels(1)[0]}" for axis in axes)


def add_shared_reports(reports: frozenset[str]) -> frozenset[str]:
    """Return the requested reports; if these are only shares, add the reports that contain them."""
    return reports | SHARED_BLOCKS if SHARES in reports and not reports & (SHARED_BLOCKS | {IMPULSES}) else reports


def is_share(row: Quantity) -> bool:
    """Whether it is the share of a cause in another quantity."""
    return f".{SHARES}.CAUSE." in row.path


def find_report(block: str) -> str | None:
    """Return the report to which a block of the results belongs; None for a block that is always included."""
    return block if block in (IMPULSES, EVENTS) else REPORT_OF.get(block)


def find_row(path: str) -> Quantity:
    """Return the row of a path as the schema spells it."""
    return next(row for row in ROWS if row.path == path)
