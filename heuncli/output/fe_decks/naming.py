"""Words of a scene as decks may hold them, and the numbers of the points.

A deck is a program: a line that a title or a name begins would be a card. So what others wrote stands in comments
alone, in printable ASCII, on one line, without the letters that end a comment; what names a step is spelled anew.
"""

from __future__ import annotations

import re

from heuncli.analyses.load_cases.model import LoadCase, LoadCases, PointAction
from heuncli.analyses.load_cases.solid_mesh import SolidMesh
from heuncli.base.foreign_text import shown
from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Array

SET_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,31}\Z")
LONGEST_TEXT, LONGEST_NAME = 200, 60  # letters of a title in a comment, of the name of a step


class DeckNames(NamedTuple):
    """What a deck calls things: the number of the first point, and the mesh's set of all elements.

    mesh: in the deck's units, where some of the loads stand at its nodes.
    """

    first_node: int
    elements: str
    mesh: SolidMesh | None = None


def unfit_set(name: str) -> str:
    """What keeps a word from being the name of a set in all programs; nothing where it can be."""
    return "" if SET_NAME.match(name) else "expected a letter, then letters, digits and _, at most 32"


def plain_text(text: str) -> str:
    """What others wrote, for a comment: one line of ASCII; $ and ! begin and end commands in some programs."""
    kept = shown(text).encode("ascii", "backslashreplace").decode().replace("$", "\\x24").replace("!", "\\x21")
    return kept if len(kept) <= LONGEST_TEXT else kept[:LONGEST_TEXT] + " ..."


def step_name(number: int, case: LoadCase) -> str:
    """The name of a case's step: letters, digits and _, with its number before it, so that no two are the same."""
    return f"C{number}_{re.sub('[^A-Za-z0-9]+', '_', case.name).strip('_')}"[:LONGEST_NAME]


class DeckNode(NamedTuple):
    """A point of the body that carries loads: its number, its place, and what it is."""

    number: int
    at: Array
    label: str


class NodeLoad(NamedTuple):
    """What acts at a point in a case, all together: force and moment (3,), and of what it is made."""

    node: DeckNode
    force: Array
    moment: Array
    parts: tuple[PointAction, ...]


class DeckNodes:
    """The points that carry loads in some case, numbered as they are met."""

    def __init__(self, cases: LoadCases, names: DeckNames) -> None:
        self._by_place: dict[tuple[float, ...], DeckNode] = {}
        for case in cases.cases:
            for action in case.actions:
                what = f"{action.kind} {action.name}"
                self._take(action.at, names, f"{action.point}, where {what} acts" if action.point else what)
        self.nodes = [*self._by_place.values()]

    def _take(self, at: Array, names: DeckNames, label: str) -> None:
        place = tuple((at + 0.0).tolist())
        if place not in self._by_place:
            self._by_place[place] = DeckNode(names.first_node + len(self._by_place), at + 0.0, label)

    def loads(self, case: LoadCase) -> list[NodeLoad]:
        """What acts at each point in a case."""
        found: dict[int, list[PointAction]] = {}
        for action in case.actions:
            found.setdefault(self._by_place[tuple((action.at + 0.0).tolist())].number, []).append(action)
        by_number = {node.number: node for node in self.nodes}
        return [
            NodeLoad(by_number[number], sum((one.force for one in own), 0.0 * own[0].force),
                     sum((one.moment for one in own), 0.0 * own[0].moment), tuple(own))
            for number, own in found.items()
        ]  # fmt: skip
