"""What the results hold, as the paths of expectations name it: shape and dimension of every quantity (contract 3)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from heuncli.expressions import units as u
from heuncli.spec.names import Names
from heuncli.spec.rules.registry import Scene
from heuncli.spec.rules.sections import is_run

XYZ = ("x", "y", "z")
TURNING: u.Dimension = (0, 0, -2)
Shape = tuple[int | None, ...]  # None: not known before the run


class Quantity(NamedTuple):
    """Numbers: the dimensions they may have (none: any), their shape at one instant, whether they run over instants."""

    dimensions: tuple[u.Dimension, ...] = ()
    shape: Shape = ()
    timed: bool = True


class Each(NamedTuple):
    """Something of each entry of some blocks, by its name."""

    blocks: tuple[str, ...]
    inner: Any


class OfPoints(NamedTuple):
    """Something of each point of each body."""

    inner: Any


class Astray(NamedTuple):
    """The first word of a path that leads nowhere (empty: it ends too early), with those that would lead on."""

    word: str
    known: list[str]


def number(*dimensions: u.Dimension) -> Quantity:
    return Quantity(dimensions)


def vector(*dimensions: u.Dimension) -> Quantity:
    return Quantity(dimensions, (3,))


WRENCH = {"force": vector(u.FORCE), "moment": vector(u.MOMENT)}
STRESSES = ("normal_max", "normal_min", "shear_torsion", "shear_mean", "mises")
# None: of a form of its own, not looked into before the run.
RESULTS: dict[str, Any] = {
    "model": None,
    "status": None,
    "time": number(u.TIME),
    "bodies": Each(
        ("bodies",),
        {
            "position": vector(u.LENGTH), "velocity": vector(u.VELOCITY), "rotation": Quantity((u.NUMBER,), (3, 3)),
            "center": vector(u.LENGTH), "center_velocity": vector(u.VELOCITY),
            "center_acceleration": vector(u.ACCELERATION), "angular_velocity": vector(u.RATE),
            "angular_acceleration": vector(TURNING),
        },
    ),
    "points": OfPoints(
        {"position": vector(u.LENGTH), "velocity": vector(u.VELOCITY), "acceleration": vector(u.ACCELERATION)}
    ),
    "coordinates": Each(
        ("joints",),
        {
            "angle": number(u.ANGLE), "rate": number(u.RATE), "acceleration": number(TURNING, u.ACCELERATION),
            "travel": number(u.LENGTH), "speed": number(u.VELOCITY), "angular_acceleration": number(TURNING),
        },
    ),
    "foundation": {
        "about": Quantity((u.LENGTH,), (3,), timed=False),
        **WRENCH,
        "axis": {"point": vector(u.LENGTH), "direction": vector(u.NUMBER), "pitch": number(u.LENGTH)},
        "mass_effect": {
            "force": vector(u.FORCE), "moment_orbital": vector(u.MOMENT), "moment_spin": vector(u.MOMENT),
        },
        "supports": Each(("joints",), WRENCH),
        "elements": Each(("forces", "drives"), {**WRENCH, "point": vector(u.LENGTH)}),
        "shares": None,
    },
    "joints": Each(
        ("joints",),
        {
            "point": vector(u.LENGTH), **WRENCH, "open": None, "drive": number(u.FORCE, u.MOMENT),
            "axial": number(u.FORCE), "radial": number(u.FORCE), "tilting": number(u.MOMENT),
            "tension": number(u.FORCE), "shares": None,
        },
    ),
    "sections": Each(
        ("sections",),
        {
            "point": vector(u.LENGTH), "normal": vector(u.NUMBER), "first_axis": vector(u.NUMBER), "open": None,
            **WRENCH, **dict.fromkeys(("N", "Q1", "Q2"), number(u.FORCE)),
            **dict.fromkeys(("T", "M1", "M2"), number(u.MOMENT)),
            "line": {"point": vector(u.LENGTH), "direction": vector(u.NUMBER), "pressure_centre": vector(u.LENGTH)},
            "stress": {**dict.fromkeys(STRESSES, number(u.PRESSURE)), "utilisation": number(u.NUMBER)},
            "s": Quantity((u.LENGTH,), timed=False), "side": None, "shares": None,
        },
    ),
    "forces": Each(
        ("forces",),
        {
            "value": number(u.FORCE, u.MOMENT), "length": number(u.LENGTH), "rate": number(u.RATE, u.VELOCITY),
            "power": number(u.POWER),
        },
    ),
    "energy": dict.fromkeys(("kinetic", "potential", "work"), number(u.MOMENT)),
    "system_vector": {"total": vector(u.POWER), "bodies": Each(("bodies",), vector(u.POWER))},
    "impulses": None,
    "certain_sums": None,
    "accuracy": None,
    "work": None,
    "title": None,
}  # fmt: skip
OF_ALL_CUTS = ("normal", "first_axis")  # in a run of cuts not one a cut


def outcome(path: str, scene: Scene) -> Quantity | Astray | None:
    """What a path leads to; None where that is seen only after the run."""
    words = path.split(".")
    found = follow(words, RESULTS, scene.names)
    if not isinstance(found, Led):
        return found
    quantity = found.quantity
    if words[0] == "sections":
        section = scene.document.sections.get(words[1])
        if section is None:
            return None
        if is_run(section) and words[2] not in OF_ALL_CUTS:
            quantity = quantity._replace(shape=(None, *quantity.shape))
    return part(quantity, found.rest)


class Led(NamedTuple):
    """A quantity, and the words that say which of its numbers are meant."""

    quantity: Quantity
    rest: list[str]


def follow(words: list[str], node: Any, names: Names) -> Led | Astray | None:
    """The quantity that the first words lead to."""
    if node is None or isinstance(node, Quantity):
        return Led(node, words) if node is not None else None
    below: Mapping[str, Any]
    if isinstance(node, OfPoints):
        below = {body: dict.fromkeys(points, node.inner) for body, points in names.points.items()}
    elif isinstance(node, Each):
        below = {name: node.inner for block in node.blocks for name in names.entries[block]}
    else:
        below = node
    if not words or words[0] not in below:
        return Astray(words[0] if words else "", list(below))
    return follow(words[1:], below[words[0]], names)


def part(quantity: Quantity, words: list[str]) -> Quantity | Astray:
    """What is left of a quantity where list places are named: of its shape, or the instant first."""
    sizes, timed = quantity.shape, quantity.timed
    if timed and len(words) == len(sizes) + 1:
        sizes, timed = (None, *sizes), False
    if len(words) > len(sizes):
        return Astray(words[len(sizes)], [])
    for word, size in zip(words, sizes, strict=False):
        letters = XYZ if size == len(XYZ) else ()  # instants and cuts are counted
        place = letters.index(word) if word in letters else int(word) if word.isdecimal() else None
        if place is None or (size is not None and place >= size):
            return Astray(word, list(letters) or ["0, 1, 2, ..."])
    return quantity._replace(shape=sizes[len(words) :], timed=timed)
