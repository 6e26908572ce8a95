"""What the results hold: one row a quantity of the JSON (contract section 3).

From these rows follow the paths of `--measure` and `expect` with their checks, the units and components of CSV and
tables, and the README's table of results. Shapes are stated here and never guessed from an array's length: a run of
three cuts is no vector. A word in capitals stands for a name of the scene; a name may hold dots (a point is
`body.point`). Imports nothing heavy, so that reading a spec stays light.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from typing import NamedTuple, TypeAlias


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
        index = self.letters.index(word) if word in self.letters else int(word) if word.isdecimal() else None
        most = self.size if size is None else size
        return index if index is not None and (most is None or index < most) else None

    def labels(self, size: int) -> tuple[str, ...]:
        """What the places are called."""
        return self.letters or tuple(map(str, range(size)))


SPACE = Axis("space", ("x", "y", "z"))
CUT = Axis("cut")  # only in runs of cuts
INSTANT = Axis("instant")
INDEX = Axis("index")  # of lists that the schema does not describe
XYZ = SPACE.letters
Shape: TypeAlias = tuple[Axis, ...]


class Quantity(NamedTuple):
    """One quantity: its path, SI unit, shape at one instant, meaning, and whether it runs over the instants.

    Of two units the first holds where the joint or force slides, the second where it turns. Without a unit it is words.
    """

    path: str
    units: tuple[str, ...]
    shape: Shape
    meaning: str
    timed: bool = True

    def unit(self, turning: bool = False) -> str:
        """The unit of the one that slides or of the one that turns."""
        return self.units[-1 if turning else 0]

    def axes(self, run: bool = False) -> Shape:
        """The axes of one instant: that of the cuts only in a run of them."""
        return tuple(axis for axis in self.shape if run or axis is not CUT)


def scalar(path: str, unit: str, meaning: str) -> Quantity:
    """A number at each instant."""
    return Quantity(path, tuple(unit.split(" | ")), (), meaning)


def vector(path: str, unit: str, meaning: str) -> Quantity:
    """Three components at each instant, in world axes."""
    return Quantity(path, (unit,), (SPACE,), meaning)


def cut_scalar(path: str, unit: str, meaning: str) -> Quantity:
    """A number at each instant, of each cut."""
    return Quantity(path, (unit,), (CUT,), meaning)


def cut_vector(path: str, unit: str, meaning: str) -> Quantity:
    """Three components at each instant, of each cut, in world axes."""
    return Quantity(path, (unit,), (CUT, SPACE), meaning)


def constant(path: str, unit: str, shape: Shape, meaning: str) -> Quantity:
    """What does not run over the instants."""
    return Quantity(path, (unit,), shape, meaning, timed=False)


def words(path: str, meaning: str) -> Quantity:
    """Text, or names, or a block of its own form: no number, or known after the run only."""
    return Quantity(path, (), (), meaning, timed=False)


ROWS: tuple[Quantity, ...] = (
    words("model", "what was solved: see `heun model`"),
    words("status", "`code`: completed or stopped, and a `message`"),
    scalar("time", "s", "the instants"),
    vector("bodies.BODY.position", "m", "of the body's origin"),
    vector("bodies.BODY.velocity", "m/s", "of the body's origin"),
    Quantity("bodies.BODY.rotation", ("1",), (SPACE, SPACE), "matrix; its columns are the body axes"),
    vector("bodies.BODY.center", "m", "of the centre of mass"),
    vector("bodies.BODY.center_velocity", "m/s", "of the centre of mass"),
    vector("bodies.BODY.center_acceleration", "m/s²", "of the centre of mass"),
    vector("bodies.BODY.angular_velocity", "rad/s", "of the body"),
    vector("bodies.BODY.angular_acceleration", "rad/s²", "of the body"),
    vector("points.POINT.position", "m", "of a named point, `body.point`"),
    vector("points.POINT.velocity", "m/s", "of a named point, `body.point`"),
    vector("points.POINT.acceleration", "m/s²", "of a named point, `body.point`"),
    scalar("coordinates.JOINT.angle", "rad", "turning of `to` against `from`; counts full turns"),
    scalar("coordinates.JOINT.rate", "rad/s", "turning of `to` against `from`; counts full turns"),
    scalar("coordinates.JOINT.acceleration", "m/s² | rad/s²", "of a slide or cylinder along, of a pin about the axis"),
    scalar("coordinates.JOINT.travel", "m", "sliding of `to` against `from`"),
    scalar("coordinates.JOINT.speed", "m/s", "sliding of `to` against `from`"),
    scalar("coordinates.JOINT.angular_acceleration", "rad/s²", "of a cylinder about its axis"),
    constant("foundation.about", "m", (SPACE,), "point about which its moments are taken"),
    vector("foundation.force", "N", "total ON the ground, moment about `about`"),
    vector("foundation.moment", "N·m", "total ON the ground, moment about `about`"),
    vector("foundation.axis.point", "m", "central axis: its point nearest `about`; none where there is no force"),
    vector("foundation.axis.direction", "1", "central axis: its direction"),
    scalar("foundation.axis.pitch", "m", "central axis: moment along it over force"),
    vector("foundation.mass_effect.force", "N", "+Σ m ẍ, (56)"),
    vector("foundation.mass_effect.moment_orbital", "N·m", "rate of Σ m x × ẋ, x from `about`"),
    vector("foundation.mass_effect.moment_spin", "N·m", "rate of Σ I σ"),
    vector("foundation.supports.JOINT.force", "N", "of a joint ON the ground, about the joint's `to` point"),
    vector("foundation.supports.JOINT.moment", "N·m", "of a joint ON the ground, about the joint's `to` point"),
    vector("foundation.elements.ELEMENT.force", "N", "of a load or drive ON the ground, about `point`"),
    vector("foundation.elements.ELEMENT.moment", "N·m", "of a load or drive ON the ground, about `point`"),
    vector("foundation.elements.ELEMENT.point", "m", "of a load or drive ON the ground, about `point`"),
    words("foundation.shares", "by cause: not yet"),
    vector("joints.JOINT.point", "m", "the joint's `to` point, now"),
    vector("joints.JOINT.force", "N", "of the constraint, `from` ON `to`, about `point`"),
    vector("joints.JOINT.moment", "N·m", "of the constraint, `from` ON `to`, about `point`"),
    words("joints.JOINT.open", "components that are open at some instant"),
    words("joints.JOINT.chosen", "components that a chosen split gives"),
    scalar("joints.JOINT.drive", "N | N·m", "of the drive ON `to`, along or about the axis"),
    scalar("joints.JOINT.axial", "N", "of the force: along the axis"),
    scalar("joints.JOINT.radial", "N", "of the force: magnitude across the axis"),
    scalar("joints.JOINT.tilting", "N·m", "of the moment: magnitude across the axis"),
    scalar("joints.JOINT.tension", "N", "of a rod, > 0 pulls"),
    words("joints.JOINT.shares", "by cause: not yet"),
    cut_vector("sections.SECTION.point", "m", "about which its moments are taken"),
    vector("sections.SECTION.normal", "1", "n, into the piece cut off; e1"),
    vector("sections.SECTION.first_axis", "1", "n, into the piece cut off; e1"),
    words("sections.SECTION.open", "components that are open at some instant"),
    cut_vector("sections.SECTION.force", "N", "the piece ON the remainder, about `point`"),
    cut_vector("sections.SECTION.moment", "N·m", "the piece ON the remainder, about `point`"),
    cut_scalar("sections.SECTION.N", "N", "along n, > 0 tension"),
    cut_scalar("sections.SECTION.Q1", "N", "shear along e1, e2"),
    cut_scalar("sections.SECTION.Q2", "N", "shear along e1, e2"),
    cut_scalar("sections.SECTION.T", "N·m", "torsion about n"),
    cut_scalar("sections.SECTION.M1", "N·m", "bending about e1, e2"),
    cut_scalar("sections.SECTION.M2", "N·m", "bending about e1, e2"),
    cut_vector("sections.SECTION.line.point", "m", "Heun's reduction line"),
    cut_vector("sections.SECTION.line.direction", "1", "Heun's reduction line"),
    cut_vector("sections.SECTION.line.pressure_centre", "m", "where the moment in the plane is zero"),
    cut_scalar("sections.SECTION.line.kind", "1", "0: a line, 1: none, 2: any"),
    cut_scalar("sections.SECTION.stress.normal_max", "Pa", "over the section's edge, tension positive"),
    cut_scalar("sections.SECTION.stress.normal_min", "Pa", "over the section's edge, tension positive"),
    cut_scalar("sections.SECTION.stress.shear_torsion", "Pa", "largest of torsion; mean of Q1, Q2"),
    cut_scalar("sections.SECTION.stress.shear_mean", "Pa", "largest of torsion; mean of Q1, Q2"),
    cut_scalar("sections.SECTION.stress.mises", "Pa", "von Mises, on the safe side"),
    cut_scalar("sections.SECTION.stress.utilisation", "1", "`mises` over `strength`"),
    constant("sections.SECTION.s", "m", (CUT,), "of a run: place of each cut from its first point"),
    words("sections.SECTION.side", "of a run: before or beyond a joint, force or point mass in the cut's plane"),
    words("sections.SECTION.shares", "by cause: not yet"),
    scalar("forces.FORCE.value", "N | N·m", "as in the spec; > 0 pushes apart"),
    scalar("forces.FORCE.length", "m", "of its line"),
    scalar("forces.FORCE.rate", "m/s | rad/s", "of its length, or of sliding or turning in its joint"),
    scalar("forces.FORCE.power", "W", "put into the bodies"),
    scalar("energy.kinetic", "J", "kinetic + potential − work is constant"),
    scalar("energy.potential", "J", "kinetic + potential − work is constant"),
    scalar("energy.work", "J", "kinetic + potential − work is constant"),
    vector("system_vector.total", "N·m/s", "Heun's B (44)"),
    vector("system_vector.bodies.BODY", "N·m/s", "Heun's B (44)"),
    constant("impulses.NUMBER.time", "s", (), "of a blow: not yet"),
    words("impulses.NUMBER.names", "of a blow: not yet"),
    vector("impulses.NUMBER.bodies.BODY.center_velocity_jump", "m/s", "of a blow: not yet"),
    vector("impulses.NUMBER.bodies.BODY.angular_velocity_jump", "rad/s", "of a blow: not yet"),
    scalar("impulses.NUMBER.energy_jump", "J", "of a blow: not yet"),
    words("certain_sums.NUMBER.terms", "factor of each open component: a number, or one an instant"),
    scalar("certain_sums.NUMBER.value", "N | N·m", "their certain sum"),
    constant("accuracy.energy_drift", "1", (), "of the largest kinetic energy"),
    constant("accuracy.constraint_gap", "m", (), "largest gap of any loop"),
    constant("accuracy.balance_residual", "1", (), "of a body's largest load"),
    constant("accuracy.horizon", "s", (), "nothing is claimed from then on; null: none"),
    constant("accuracy.estimate.motion", "1", (), "error of any point, of the scene's size"),
    constant("accuracy.estimate.reactions", "1", (), "of the largest reaction"),
    words("work", "kernel, steps, evaluations and seconds it took"),
    words("title", "as in the spec"),
)  # fmt: skip

# The blocks that run over the instants, in their order, and the report each belongs to; the rest always stays.
REPORT_OF = {
    "bodies": "motion",
    "points": "points",
    "coordinates": "motion",
    "foundation": "foundation",
    "joints": "joints",
    "sections": "sections",
    "forces": "forces",
    "energy": "energy",
    "system_vector": "motion",
}
REPORTS = tuple(dict.fromkeys(REPORT_OF.values()))
AFTER_THE_RUN = frozenset({"impulses", "certain_sums", "accuracy"})  # of numbers that no spec foretells
NAMES = ("BODY", "POINT", "JOINT", "ELEMENT", "SECTION", "FORCE", "NUMBER")
AT_A_BLOW = {"N": "N·s", "N·m": "N·m·s"}  # units of the loads in `impulses`
STRUCK = ("foundation", "joints", "sections")  # what a blow has besides its own quantities, as at one instant

Node: TypeAlias = "dict[str, Node | Quantity]"


def _tree() -> Node:
    """The rows by the words of their paths."""
    tree: Node = {}
    for row in ROWS:
        _plant(tree, row.path.split("."), row)
    for row in ROWS:
        first, *_ = row.path.split(".")
        if first in STRUCK:
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


def quantity(keys: Iterable[str]) -> Quantity | None:
    """The row of what stands in the results under these keys; None where there is none."""
    node: Node | Quantity | None = TREE
    for key in keys:
        if not isinstance(node, dict):
            return None
        node = below(node, key)
    return node if isinstance(node, Quantity) else None


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
