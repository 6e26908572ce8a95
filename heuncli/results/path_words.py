"""The words of paths into the results: split and joined, followed through the schema; the kinds of their errors."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence
from functools import lru_cache
from typing import TypeAlias

from heuncli.results.results_schema import IMPULSES, ROWS, SHARED_BLOCKS, SHARES, Quantity, parse_index

NO_RUN = "@ gives a position along a series of cuts (section with from, to and count): leave it out"
NUMBER = r"(?:\d+(?:\.\d+)?|\.\d+)(?:e[+-]?\d+)?"
POSITION_WORD = re.compile(
    rf"@(?P<at>start|end|{NUMBER})(?P<unit>[^\W\d_]*)(?::(?P<side>\w*))?(?=\.|\Z)", re.IGNORECASE
)
INDEX_WORD = re.compile(r"(?P<cut>\d+):(?P<side>\w*)\Z", re.ASCII)


def split_path(path: str) -> list[str]:
    """Split a path into words. A position is one word, even with points in its number; it begins with @."""
    head, separator, _ = path.partition("@")
    if not separator:
        return path.split(".")
    match = POSITION_WORD.match(path, len(head))
    end = len(path) if match is None else match.end()
    words = [*head.removesuffix(".").split("."), path[len(head) : end]]
    return words + path[end + 1 :].split(".") if end < len(path) else words


def join_path(words: Sequence[str]) -> str:
    """Join words to a path."""
    return ".".join(words).replace(".@", "@")


def find_position_word(words: Sequence[str]) -> str | None:
    """Return the word of a path that begins with @, a position along a series of cuts; None if there is none."""
    return next((word for word in words if word.startswith("@")), None)


def is_cut_word(word: str) -> bool:
    """Return whether a word means a position or a cut, and not a component."""
    return word.startswith("@") or INDEX_WORD.match(word) is not None or parse_index(word) is not None


Node: TypeAlias = "dict[str, Node | Quantity]"  # the rows by the words of their paths

# words of the schema that stand for a name of the scene, or a number
NAMES = (
    "BODY", "POINT", "JOINT", "ELEMENT", "STOP", "COUPLING", "END", "SECTION", "SENSOR", "CORNER", "FORCE", "CAUSE",
    "EVENT", "BEARING", "NUMBER",
)  # fmt: skip
BEARINGS = "bearings"  # of a joint
IMPULSE_UNITS = {"N": "N·s", "N·m": "N·m·s"}  # units of the loads in `impulses`
# blocks that an impulse has as an instant has them, and the quantities in them that no impulse has
IMPULSE_BLOCKS = ("foundation", "joints", "sensors", "stops", "couplings", "sections", "certain_sums")
NOT_IN_IMPULSES = ("joints.JOINT.pressure", "sections.SECTION.stress.", "sections.SECTION.energy",
    "sections.SECTION.deflection.", "sections.SECTION.buckling")  # fmt: skip

# kinds of errors: by block, and where a quantity of a block has its own
ESTIMATE_OF_BLOCK = {
    "foundation": "foundation", "joints": "reactions", "sensors": "sensors", "stops": "reactions",
    "couplings": "reactions", "sections": "sections", "energy": "energy",
}  # fmt: skip
ATTITUDES = {"rotation": "attitudes", "quaternion": "attitudes", "rodrigues": "rodrigues"}
TRAVELS = ("travel", "speed", "acceleration")  # along a path by whatever its tables are over, elsewhere as places
LOAD_ERROR_KINDS = dict.fromkeys(("length", "angle", "rate"), "motion") | dict.fromkeys(("shift", "turn"), "strains")
BY_CAUSE = "by cause"  # ending of the kinds of errors of shares


def _make_tree() -> Node:
    """Arrange the rows by the words of their paths."""
    tree: Node = {}
    for row in ROWS:
        _insert_row(tree, row.path.split("."), row)
    for row in ROWS:
        first, *_ = row.path.split(".")
        if first in IMPULSE_BLOCKS and not row.path.startswith(NOT_IN_IMPULSES):
            units = tuple(IMPULSE_UNITS.get(unit, unit) for unit in row.units)
            path = f"impulses.NUMBER.{row.path}"
            _insert_row(tree, path.split("."), row._replace(path=path, units=units))
    return tree


def _insert_row(tree: Node, path: Sequence[str], row: Quantity) -> None:
    """Insert a row into the tree at the words of its path."""
    for word in path[:-1]:
        child = tree.setdefault(word, {})
        assert isinstance(child, dict), row.path
        tree = child
    tree[path[-1]] = row


TREE = _make_tree()


def find_child(node: Node, key: str) -> Node | Quantity | None:
    """Return the node under a key: a word of the schema, or a name of the scene."""
    if key in node:
        return node[key]
    return next((node[name] for name in NAMES if name in node), None)


def find_node(keys: Iterable[str]) -> Node | Quantity | None:
    """Return the row, or the block of rows, under these keys; None if there is none."""
    node: Node | Quantity | None = TREE
    for key in keys:
        if not isinstance(node, dict):
            return None
        node = find_child(node, key)
    return node


def find_quantity(keys: Iterable[str]) -> Quantity | None:
    """Return the row of the quantity under these keys; None if there is none."""
    return _find_quantity(tuple(keys))


@lru_cache(maxsize=10_000)  # the paths of a scene, each of which every part of its instants asks for
def _find_quantity(keys: tuple[str, ...]) -> Quantity | None:
    """Return the row at some keys, or None."""
    node = find_node(keys)
    return node if isinstance(node, Quantity) else None


def is_block_or_words(keys: Sequence[str]) -> bool:
    """Return whether these keys lead to a block or to words, not to numbers; also if the block is empty."""
    return _is_no_number(tuple(keys))


@lru_cache(maxsize=10_000)
def _is_no_number(keys: tuple[str, ...]) -> bool:
    """Return whether keys lead to a block, or to or through words."""
    rows = (find_quantity(keys[:n]) for n in range(1, len(keys) + 1))
    return isinstance(find_node(keys), dict) or any(row is not None and row.is_words for row in rows)


def names_shares(words: list[str]) -> bool:
    """Return whether a path leads to shares by cause: not every `shares` in it does, for a joint or body may have that
    name.
    """
    if words[:1] == [IMPULSES]:
        return names_shares(words[2:])
    if words[:1] == ["foundation"]:
        inner = words[1:2] in (["supports"], ["elements"])  # a name behind them may have its block before it
        return (
            SHARES in words[3 : 5 if words[2:3] in (["drives"], ["couplings"]) else 4]
            if inner
            else words[1:2] == [SHARES]
        )
    return words[4:5] == [SHARES] if words[2:3] == [BEARINGS] else words[2:3] == [SHARES]


def error_kind_of_path(kind: str, name: str, number: str) -> str:
    """Return the kind of estimate (in `accuracy.estimate`) for the error of a quantity, by the words of its path.

    Shares by cause have their own: they may be larger than their sum, and have larger errors. Numbers of an impulse
    have the kinds that they have at an instant.
    """
    if kind == IMPULSES:
        kind, _, name = name.partition(".")[2].partition(".")
    words = name.split(".")  # `shares.CAUSE` of the foundation, else `NAME.shares.CAUSE`: a NAME may be `shares`, too
    by_cause = words[-2:-1] == [SHARES] and (kind == "foundation" or len(words) > 2)
    if by_cause and kind in SHARED_BLOCKS | {"couplings", "sensors"}:
        return f"{error_kind_of_path(kind, '.'.join(words[:-2]), number.removeprefix('direct_'))} {BY_CAUSE}"
    if kind == "joints" and number == "drive":
        return "drives"
    if kind == "joints" and BEARINGS in words[1:]:
        return BEARINGS
    if kind == "foundation" and name.startswith("supports."):
        return "reactions"
    if kind == "foundation" and name == "axis":
        return "axis"
    if kind == "sections" and (number == "buckling" or words[-1] == "deflection"):
        return "deflections"
    if kind == "forces":
        return LOAD_ERROR_KINDS.get(number, "forces")
    if number.startswith("energy_"):
        return "energy"
    if kind == "bodies" and number in ATTITUDES:
        return ATTITUDES[number]
    if kind == "coordinates" and number in TRAVELS:
        return "travels"
    return ESTIMATE_OF_BLOCK.get(kind, "motion")


def split_leading_key(known_keys: Collection[str], path: Sequence[str]) -> tuple[str | None, list[str]]:
    """Return the longest key that the leading words of a path spell, and the words behind it; None if there is none."""
    for used in range(min(len(path), 8), 0, -1):
        if (key := ".".join(path[:used])) in known_keys:
            return key, list(path[used:])
    return None, list(path)


def find_unknown_key(known_keys: Collection[str], path: Sequence[str]) -> str:
    """Return the leading words of a path that spell no key: two of them where there are keys of two words."""
    dotted = any(key.startswith(f"{path[0]}.") for key in known_keys)
    return ".".join(path[: 2 if dotted else 1])
