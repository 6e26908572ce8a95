"""Mutations of a spec that know its structure: one to four changes of a tree, as a slip or malice would make them."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from functools import cache
from random import Random
from typing import Any

from heuncli.scene.file_format.format_couplings import COUPLINGS
from heuncli.scene.file_format.format_loads import LOADS
from tests.faults import sources
from tests.faults.random_expressions import random_expression
from tests.faults.sources import Spot, Tree

EXTREMES: tuple[Any, ...] = (
    0, -1, 1, 2, -0.0, 1e-300, 1e-61, 1e-60, 1e-12, 1e12, 1e60, 1e61, 1e200, 1e300, 1e308, -1e308, 5e-324, math.inf,
    -math.inf,
    math.nan, 2**31, 2**63, 2**64, -(2**63), 10**30, 10**400, "1e999", "-1e999", "1e-999", "0x1F", "1_000", "٣", "²",
    ".5", "1e5",
)  # fmt: skip
COUNTS = (0, 1, 2, 3, 4, 1000, 50_000, 10**6, 10**7, 10**9, 10**18, 10**30, -1, 1.5, 1e9, "100000000")
UNITS = (
    "m", "mm", "kg", "s", "deg", "rad", "rpm", "N", "kN", "Nm", "N*m", "bar", "Pa", "m/s", "m/s^2", "kg/m^3", "1/s",
    "N/m", "J",
    "N*s", "in", "lb", "furlong", "m^^2", "m/", "/s", "m m", "m^99", "m^-1", "kg*m^2", "%", "°", "m²", "l", "\u200b",
)  # fmt: skip
OTHER_TYPES: tuple[Any, ...] = (
    None, True, False, "", " ", "x", [], {}, [[]], [{}], {"": ""}, [None], [0, 0, 0], {"x": 1}, "null", "~", "on",
    "yes", "- 1",
    "a: 1", "#", "&a", "*a", "!!x", "|", ">", "%", "@", "`", "{", "[", "é", "\u202e", "\x85", "\ufeff", "😀", "a" * 300,
    "a.b",
    "a.b.c", ".", "..", "ground", "ground.O", "t", "pi",
)  # fmt: skip
STRANGE_NAMES = (
    "", " ", "é", "1", "a b", "a.b", "t", "pi", "ground", "gravity", "drives", "motion", "x" * 80, "__class__", "<<",
    "=", "null",
    "a\nb", "a\tb", "\x1b[31m", "on", "sin", "-", "?", "\u202e", "ß", "A-1", "0x1", "1e5", "true",
)  # fmt: skip
KINDS = {
    "joints": ("ball", "pin", "slide", "cylinder", "universal", "weld", "line", "plane", "rod", "curve", "hinge",
    "fixed", "pivot"),
    "forces": (*LOADS, "torsion_spring"),
    "couplings": tuple(COUPLINGS),
    "shapes": ("rod", "cylinder", "cone", "box", "sphere", "point", "mesh", "ball"),
    "analysis": ("motion", "state", "impulse", "rest", "modes"),
}  # fmt: skip

Mutation = Callable[[Random, Tree], None]


def mutated(random: Random, most: int = 4) -> Tree:
    """Some spec, changed once to `most` times; every other one by changes after which most specs are scenes still."""
    tree = sources.tree(random.choice(sources.names()))
    mutations = random.choice((MILD, MUTATIONS))
    for _ in range(random.choice(range(1, most + 1))):
        random.choice(mutations)(random, tree)
    return tree


def spot(random: Random, tree: Tree, fits: Callable[[Any], bool] = lambda _: True) -> Spot | None:
    """Some place whose value fits."""
    found = [(box, key) for box, key in sources.spots(tree) if fits(box[key])]
    return random.choice(found) if found else None


def is_number(value: Any) -> bool:
    """A number, or a word that begins as one: with a unit, or an expression."""
    if isinstance(value, str):
        return bool(value) and value[0] in "-.0123456789"
    return isinstance(value, int | float) and not isinstance(value, bool)


def change(random: Random, tree: Tree, new: Callable[[Any], Any], fits: Callable[[Any], bool] = lambda _: True) -> None:
    """Another value at some place whose value fits."""
    if (place := spot(random, tree, fits)) is not None:
        box, key = place
        box[key] = new(box[key])


def drop(random: Random, tree: Tree) -> None:
    if (place := spot(random, tree)) is not None:
        del place[0][place[1]]


def duplicate(random: Random, tree: Tree) -> None:
    """An entry once more, under another name or next in its list."""
    if (place := spot(random, tree)) is not None:
        box, key = place
        again = copy.deepcopy(box[key])
        if isinstance(box, list):
            box.insert(key, again)
        else:
            box[f"{key}2"] = again


def rename(random: Random, tree: Tree) -> None:
    """A key misspelt, or called as another one, or strangely; its place in the order stays."""
    boxes = [(box, key) for box, key in sources.spots(tree) if isinstance(box, dict)]
    if not boxes:
        return
    box, key = random.choice(boxes)
    new = random.choice((misspelt(random, str(key)), random.choice(vocabulary()), random.choice(STRANGE_NAMES)))
    entries = [(new if k == key else k, v) for k, v in box.items()]
    box.clear()
    box.update(entries)


def misspelt(random: Random, word: str) -> str:
    """The word with a letter lost, doubled, changed or in another case."""
    if not word:
        return "x"
    i = random.randrange(len(word))
    return random.choice((
        word[:i] + word[i + 1 :], word[:i] + word[i] + word[i:], word[:i] + "x" + word[i + 1 :], word.upper(),
        word + "s",
    ))  # fmt: skip


def swap(random: Random, tree: Tree) -> None:
    """The values of two places exchanged, but for a place and what it stands in."""
    one, other = spot(random, tree), spot(random, tree)
    if one is None or other is None:
        return
    (a, i), (b, j) = one, other
    a[i], b[j] = copy.deepcopy(b[j]), copy.deepcopy(a[i])


def other_type(random: Random, tree: Tree) -> None:
    change(random, tree, lambda old: random.choice((
        copy.deepcopy(random.choice(OTHER_TYPES)), [old], {"x": old}, str(old), [old, old, old], not old,
    )))  # fmt: skip


def extreme(random: Random, tree: Tree) -> None:
    change(random, tree, lambda _: random.choice(EXTREMES), is_number)


def scaled(random: Random, tree: Tree) -> None:
    """A number many times or a little larger, or negative: mostly still a scene."""
    factor = random.choice((-1.0, 1e-9, 1e-6, 1e-3, 0.1, 0.5, 0.999999999, 1.000000001, 1.1, 2.0, 10.0, 1e3, 1e6, 1e9))
    change(
        random,
        tree,
        lambda old: factor * old if abs(old) < 1e300 else old,
        lambda v: is_number(v) and not isinstance(v, str),
    )


def moved(random: Random, tree: Tree) -> None:
    """A number a bit more or less: what was in line, in a plane or at rest no longer is."""
    by = random.choice((1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.1, 1.0)) * random.uniform(-1.0, 1.0)
    change(
        random,
        tree,
        lambda old: old + by if abs(old) < 1e300 else old,
        lambda v: is_number(v) and not isinstance(v, str),
    )


def drop_entry(random: Random, tree: Tree) -> None:
    """A joint, force, section, drive or the like is missing; nothing else of it."""
    named = (
        [value for key, value in tree.items() if isinstance(value, dict) and key != "bodies"]
        if isinstance(tree, dict)
        else []
    )
    if boxes := [value for value in named if value]:
        box = random.choice(boxes)
        del box[random.choice(list(box))]


def whole_block(random: Random, tree: Tree) -> None:
    """Forces, an analysis, sections or the like of another spec in place of those that there are."""
    donor = sources.tree(random.choice(sources.names()))
    if isinstance(tree, dict):
        key = random.choice(list(donor))
        if key != "parameters":
            tree[key] = donor[key]
        tree["parameters"] = {**donor.get("parameters", {}), **(tree.get("parameters") or {})}


def with_unit(random: Random, tree: Tree) -> None:
    change(random, tree, lambda old: f"{str(old).split(' ')[0]} {random.choice(UNITS)}", is_number)


def other_name(random: Random, tree: Tree) -> None:
    """A word that is a name or a reference becomes another one of the file, often of another kind."""
    names = references(tree)
    change(random, tree, lambda _: random.choice(names), lambda v: isinstance(v, str))


def references(tree: Tree) -> list[str]:
    """What the entries of a spec are called, alone and with their points."""
    names = ["ground"]
    for block, entries in tree.items() if isinstance(tree, dict) else ():
        if isinstance(entries, dict) and block not in ("analysis", "foundation"):
            names += [str(name) for name in entries]
            for name, entry in entries.items():
                points = entry.get("points") if isinstance(entry, dict) else None
                names += [f"{name}.{point}" for point in points] if isinstance(points, dict) else []
    return names


def length(random: Random, tree: Tree) -> None:
    """A list shorter, longer, empty, nested or turned round."""

    def new(old: list[Any]) -> list[Any]:
        return copy.deepcopy(
            random.choice((old[:-1], old[1:], [*old, 0], [], [old], old[::-1], old * 2, old * 50, old[:1]))
        )

    change(random, tree, new, lambda v: isinstance(v, list))


def block(random: Random, tree: Tree) -> None:
    """An entry of another spec, in the block of that name or somewhere else."""
    donor = sources.tree(random.choice(sources.names()))
    place = spot(random, donor, lambda v: isinstance(v, dict))
    if place is None or not isinstance(tree, dict):
        return
    box, key = place
    into = tree
    if random.random() < 0.8:
        home = next((name for name, value in donor.items() if value is box), None)
        if home is not None and isinstance(tree.setdefault(home, {}), dict):
            into = tree[home]
    elif (inner := spot(random, tree, lambda v: isinstance(v, dict))) is not None:
        into = inner[0][inner[1]]
    if isinstance(into, dict):
        into[key] = box[key]


def expression(random: Random, tree: Tree) -> None:
    """An expression in place of a number."""
    change(random, tree, lambda _: random_expression(random, variables(tree)), is_number)


def variables(tree: Tree) -> tuple[str, ...]:
    """What expressions may name: the time, parameters, coordinates and rates."""
    names = ["t", "t", "pi", "deg"]
    if isinstance(tree, dict):
        parameters, joints = tree.get("parameters"), tree.get("joints")
        names += [str(name) for name in parameters] if isinstance(parameters, dict) else []
        for name, joint in joints.items() if isinstance(joints, dict) else ():
            kind = joint.get("type") if isinstance(joint, dict) else None
            names += [
                f"{name}.{of}" for of in {"pin": ("angle", "rate"), "slide": ("travel", "speed")}.get(str(kind), ())
            ]
    return tuple(names)


def count(random: Random, tree: Tree) -> None:
    """Many samples, or many cuts, or what is no number of them."""
    if not isinstance(tree, dict):
        return
    runs = [entry for entry in _entries(tree, "sections") if "count" in entry]
    analysis = tree.get("analysis")
    if runs and random.random() < 0.5:
        random.choice(runs)["count"] = random.choice(COUNTS)
    elif isinstance(analysis, dict):
        analysis[random.choice(("samples", "duration", "tolerance", "step", "times"))] = random.choice(
            (*COUNTS, *EXTREMES)
        )


def kind(random: Random, tree: Tree) -> None:
    """Another type of a joint, force, coupling, shape or analysis."""
    if not isinstance(tree, dict):
        return
    of = random.choice(list(KINDS))
    boxes = [tree["analysis"]] if of == "analysis" and isinstance(tree.get("analysis"), dict) else _entries(tree, of)
    if of == "shapes":
        shapes = [body.get("shapes") for body in _entries(tree, "bodies")]
        boxes = [
            shape for several in shapes if isinstance(several, list) for shape in several if isinstance(shape, dict)
        ]
    if boxes:
        random.choice(boxes)["type"] = random.choice(KINDS[of])


def key_added(random: Random, tree: Tree) -> None:
    """A key that stands somewhere in some spec, with its value there, put anywhere."""
    box, key = random.choice(
        [s for s in sources.spots(sources.tree(random.choice(sources.names()))) if isinstance(s[1], str)]
    )
    place = spot(random, tree, lambda v: isinstance(v, dict))
    if place is not None:
        place[0][place[1]][key] = box[key]


def _entries(tree: Tree, of: str) -> list[dict[str, Any]]:
    entries = tree.get(of)
    return [entry for entry in entries.values() if isinstance(entry, dict)] if isinstance(entries, dict) else []


@cache
def vocabulary() -> tuple[str, ...]:
    """All keys of all specs."""
    keys = {key for name in sources.names() for _, key in sources.spots(sources.tree(name)) if isinstance(key, str)}
    return tuple(sorted(keys))


# as often as it stands here
MUTATIONS: tuple[Mutation, ...] = (
    drop, duplicate, rename, swap, other_type, extreme, scaled, scaled, scaled, with_unit, other_name, other_name,
    length, block, block, expression, expression, count, kind, kind, key_added,
)  # fmt: skip
MILD: tuple[Mutation, ...] = (
    scaled, scaled, scaled, scaled, moved, moved, kind, count, whole_block, drop_entry, expression,
)  # fmt: skip
