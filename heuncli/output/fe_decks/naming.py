"""Make texts of a scene safe for decks, and number the points.

A deck is a program: a line that begins with a title or a name would be a card. So foreign text appears in comments
only, in printable ASCII, on one line, without the letters that end a comment. Step names are reduced to letters, digits
and _.
"""

from __future__ import annotations

import re

from heuncli.analyses.load_cases.model import LoadCase, LoadCases, PointAction
from heuncli.analyses.load_cases.solid_mesh import SolidMesh
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.results.results import Array

SET_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,31}\Z")
MAX_TEXT_LENGTH, MAX_NAME_LENGTH = 200, 60  # characters of a text in a comment, and of a step name


class DeckNames(NamedTuple):
    """The names in a deck.

    first_node: the number of the first point
    elements: the mesh's set of all elements
    mesh: in the deck's units, if some of the loads act at its nodes
    """

    first_node: int
    elements: str
    mesh: SolidMesh | None = None


def explain_invalid_set(name: str) -> str:
    """Return why a word cannot name a set in all programs; empty if it can."""
    return "" if SET_NAME.match(name) else "expected a letter, then letters, digits and _, at most 32"


def plain_text(text: str) -> str:
    """Make foreign text safe for a comment: one line of ASCII without $ and !, which begin and end commands in some
    programs.
    """
    safe_text = escape(text).encode("ascii", "backslashreplace").decode().replace("$", "\\x24").replace("!", "\\x21")
    return safe_text if len(safe_text) <= MAX_TEXT_LENGTH else safe_text[:MAX_TEXT_LENGTH] + " ..."


def step_name(number: int, case: LoadCase) -> str:
    """Make the name of a case's step: letters, digits and _, with its number first, so that names are unique."""
    return f"C{number}_{re.sub('[^A-Za-z0-9]+', '_', case.name).strip('_')}"[:MAX_NAME_LENGTH]


class DeckNode(NamedTuple):
    """A point of the body that carries loads: its number, its place, and a label."""

    number: int
    place: Array
    label: str


class NodeLoad(NamedTuple):
    """The total load at a point in a case: force and moment (3,), and the actions of which it is the sum."""

    node: DeckNode
    force: Array
    moment: Array
    parts: tuple[PointAction, ...]


class DeckNodes:
    """The points that carry loads in some case, numbered in order of appearance."""

    def __init__(self, cases: LoadCases, names: DeckNames) -> None:
        self._by_place: dict[tuple[float, ...], DeckNode] = {}
        for case in cases.cases:
            for action in case.actions:
                what = f"{action.kind} {action.name}"
                self._add_node(action.at, names, f"{action.point}, where {what} acts" if action.point else what)
        self.nodes = [*self._by_place.values()]

    def _add_node(self, point: Array, names: DeckNames, label: str) -> None:
        key = tuple((point + 0.0).tolist())
        if key not in self._by_place:
            self._by_place[key] = DeckNode(names.first_node + len(self._by_place), point + 0.0, label)

    def find_loads(self, case: LoadCase) -> list[NodeLoad]:
        """Sum the loads at each point in a case."""
        actions_by_node: dict[int, list[PointAction]] = {}
        for action in case.actions:
            actions_by_node.setdefault(self._by_place[tuple((action.at + 0.0).tolist())].number, []).append(action)
        by_number = {node.number: node for node in self.nodes}
        return [
            NodeLoad(by_number[number], sum((part.force for part in actions), 0.0 * actions[0].force),
                     sum((part.moment for part in actions), 0.0 * actions[0].moment), tuple(actions))
            for number, actions in actions_by_node.items()
        ]  # fmt: skip
