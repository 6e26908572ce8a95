"""The formats of load cases, a row each, and what decks share: safe names and nodes, numbers, the comments at the top.

A new format is a module of this folder and a row here. For a format, say ansys, its module has
`write_ansys(cases, names)`, which yields the text in pieces; and `list_ansys_notes(cases, names)` if there is
something that the user has to know.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from importlib import import_module
from textwrap import wrap
from typing import Any

import numpy as np

from heuncli.analyses.load_cases.assembly import BALANCE_TOLERANCE
from heuncli.analyses.load_cases.model import LoadCase, LoadCases, PointAction
from heuncli.analyses.load_cases.solid_mesh import SolidMesh
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.text_safety import escape
from heuncli.results.results import Array

SET_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,31}\Z")
MAX_TEXT_LENGTH, MAX_NAME_LENGTH = 200, 60  # characters of a text in a comment, and of a step name
MAX_NUMBER_LENGTH = 20  # characters of a number that Abaqus and CalculiX read: beyond that, the exponent would be lost
WIDTH = 72  # characters of a comment line with its mark; Nastran's cards have 80 columns
INDENT = " " * 10
SUPPORT_NOTE = (
    "Support the mesh statically determinately: six constraints (three, two and one at three points). The reactions "
    "there must be negligible against the loads: this checks mass, units and signs together."
)
OUT_OF_PLANE_NOTE = (
    "Planar model with points or masses outside the plane z = 0: loads along z or about x and y are not given; the "
    "mesh supports must carry them."
)
DISTRIBUTED_NOTE = (
    "A distributed load is given as forces at the ends of ten segments of its line, statically equivalent in each: "
    "section loads are exact at these points. The load per length there is in the comments of its case; it can be "
    "applied to the mesh instead."
)


class DeckNames(NamedTuple):
    """The names in a deck.

    first_node: the number of the first point
    elements: the mesh's set of all elements
    mesh: in the deck's units, if some of the loads act at its nodes
    """

    first_node: int
    elements: str
    mesh: SolidMesh | None = None


class Deck(NamedTuple):
    """A format of load cases.

    name: as `--format` takes it
    module: of this folder, which writes it
    is_static: whether it takes forces only; another one takes impulses, too
    """

    name: str
    module: str
    is_static: bool = True

    def iter_text(self, cases: LoadCases, names: DeckNames) -> Iterable[str]:
        """Yield the text, in pieces."""
        pieces: Iterable[str] = getattr(self._import_module(), f"write_{self.name}")(cases, names)
        return pieces

    def list_notes(self, cases: LoadCases, names: DeckNames) -> list[str]:
        """Return sentences on steps that the user must do by hand after import."""
        function: Callable[[LoadCases, DeckNames], list[str]] | None
        function = getattr(self._import_module(), f"list_{self.name}_notes", None)
        return function(cases, names) if function is not None else []

    def _import_module(self) -> Any:
        return import_module(f"heuncli.output.fe_decks.{self.module}")


ROWS = (
    Deck("csv", "plain_data", is_static=False),
    Deck("json", "plain_data", is_static=False),
    Deck("ansys", "ansys"),
    Deck("nastran", "nastran"),
    Deck("calculix", "abaqus"),
    Deck("abaqus", "abaqus"),
)
DECKS = {row.name: row for row in ROWS}


def explain_invalid_set(name: str) -> str:
    """Return why a word cannot name a set in all programs; empty if it can."""
    return "" if SET_NAME.match(name) else "expected a letter, then letters, digits and _, at most 32"


def make_plain_text(text: str) -> str:
    """Make foreign text safe for a comment: one line of ASCII without $ and !, which some programs read as commands."""
    safe_text = escape(text).encode("ascii", "backslashreplace").decode().replace("$", "\\x24").replace("!", "\\x21")
    return safe_text if len(safe_text) <= MAX_TEXT_LENGTH else safe_text[:MAX_TEXT_LENGTH] + " ..."


def make_step_name(number: int, case: LoadCase) -> str:
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
    """The points that carry loads in some case, numbered in order of appearance, each point (3,) once."""

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


def iter_header(cases: LoadCases, nodes: DeckNodes, mark: str, tie: str, cards: Sequence[str]) -> Iterator[str]:
    """Yield the comment lines at the top of a deck.

    mark: what begins a comment
    tie: how to tie the points to a mesh
    cards: notes on the cards and their signs
    """
    force, length, _, time = cases.units
    body, name = cases.body, make_plain_text(cases.body.name)
    title = f": {make_plain_text(cases.title)}" if cases.title else ""
    spec = make_plain_text(cases.spec) or "a spec"
    is_unbalanced = any(body.compute_sums(case).relative > BALANCE_TOLERANCE for case in cases.cases)
    paragraphs: list[tuple[str, Iterable[str]]] = [
        ("", [f"Load cases of the body {name}{title}"]),
        (
            "",
            [f"generated by heun {cases.version} from {spec}, SHA-256 {cases.digest}"],
        ),
        ("Units", [f"{', '.join(cases.units)}, rad; moments {force} {length}, accelerations {length}/{time}2"]),
        ("Axes", ["body axes; the mesh must use them, with the body's origin at 0, 0, 0"]),
        ("Mesh", _describe_mesh(cases)),
        ("Cases", [line for k, case in enumerate(cases.cases, start=1) for line in _describe_case(cases, case, k)]),
        ("Points", [f"{node.number} {make_plain_text(node.label)}" for node in nodes.nodes]),
        ("Accuracy", [_describe_accuracy(cases)]),
        ("Split", [f"distribution of indeterminate reactions: {make_plain_text(cases.split)}"] if cases.split else []),
        ("Plane", [OUT_OF_PLANE_NOTE] if is_unbalanced else []),
        ("Spread", [DISTRIBUTED_NOTE] if _has_distributed_loads(cases) else []),
        ("Tie", [tie]),
        ("Supports", [SUPPORT_NOTE]),
        ("Inertia", cards),
    ]
    for keyword, lines in paragraphs:
        for i, line in enumerate(lines):
            yield from format_comment(line, mark, keyword if i == 0 else "", is_indented=bool(keyword))


def format_comment(text: str, mark: str, keyword: str = "", *, is_indented: bool = True) -> list[str]:
    """Format a text as comment lines of bounded width; keyword: the word at the left of its first line."""
    indent = INDENT if is_indented else ""
    lines = wrap(text, WIDTH - len(mark) - len(indent), break_long_words=True, break_on_hyphens=False) or [""]
    return [
        f"{mark} {(keyword.ljust(len(indent)) if i == 0 and keyword else indent)}{line}\n"
        for i, line in enumerate(lines)
    ]


def _describe_mesh(cases: LoadCases) -> list[str]:
    """Describe the mass properties that the mesh must have: in the other program, inertia loads come from the mesh."""
    _, length, mass, _ = cases.units
    body, I = cases.body, cases.body.inertia
    first = [
        "must have the following, as its mass produces weight and inertia loads:",
        f"mass {format_number(body.mass)} {mass}, center of mass {format_vector(body.center)} {length},",
    ]
    if body.planar:  # a plane body may have no other moments in the spec
        return [*first, f"about it Izz {format_number(float(I[2, 2]))} {mass} {length}2"]
    return [
        *first,
        f"about it Ixx Iyy Izz {format_vector(np.diag(I))} {mass} {length}2,",
        f"Ixy Iyz Izx {format_vector(-np.array([I[0, 1], I[1, 2], I[2, 0]]))} (products, the sum of m x y)",
    ]


def _describe_case(cases: LoadCases, case: LoadCase, number: int) -> Iterator[str]:
    """Yield the lines on a case: its name and instant, what an impulse became, and how well the loads balance."""
    sums = cases.body.balance(case)
    yield f"{number}  {make_plain_text(case.name)}, t = {case.time:.9g} s"
    if case.averaging_time is not None:
        yield (
            f"an impulse as its mean force over {case.averaging_time:.6g} s; the peak of a half sine is pi/2 times "
            "that. Weight and other loads at that time are not included"
        )
    force, moment = (
        _format_imbalance(sums.force, sums.largest_force),
        _format_imbalance(sums.moment, sums.largest_moment),
    )
    yield f"forces sum to {force}, moments to {moment} of the largest"


def _format_imbalance(imbalance: Array, largest: float) -> str:
    return f"{float(np.abs(imbalance).max()) / largest:.1e}" if imbalance.any() else "0"


def _describe_accuracy(cases: LoadCases) -> str:
    if not cases.estimate:
        return "each load to rounding error; every case is self-balanced"
    return (
        f"each load to an estimated {cases.estimate:.1e} of the run's largest reaction; the sums are balanced more "
        "closely, as all loads at one time are solved together"
    )


def _has_distributed_loads(cases: LoadCases) -> bool:
    return any(action.per_length is not None for case in cases.cases for action in case.actions)


def iter_part_lines(load: NodeLoad, units: Sequence[str], mark: str) -> Iterator[str]:
    """Yield comments on the actions of which a point's load is the sum."""
    for part in load.parts:
        cause = "external" if part.source == "outside" else f"by {make_plain_text(part.source)}"
        per_length_text = (
            "" if part.per_length is None else f", {format_vector(part.per_length)} {units[0]}/{units[1]} there"
        )
        yield from format_comment(
            f"{load.node.number}: {part.kind} {make_plain_text(part.name)}, {cause}{per_length_text}",
            mark,
            is_indented=False,
        )


def format_case_heading(case: LoadCase, k: int, mark: str) -> list[str]:
    """Format the comment before the cards of a case; k: its number, from 1."""
    return format_comment(f"-- case {k}: {make_plain_text(case.name)}, t = {case.time:.9g} s", mark, is_indented=False)


def format_number(value: float) -> str:
    """Format a number of a comment with nine digits, for comparison with that of a mesh."""
    return f"{value + 0.0:.9g}"


def format_vector(values: Array) -> str:
    """Format a vector of a comment as (x, y, z)."""
    return f"({', '.join(map(format_number, values.tolist()))})"


def format_exact(value: float) -> str:
    """Format a number with a decimal point and all its digits if they fit, otherwise with thirteen."""
    text = repr(float(value) + 0.0)
    mantissa, e, exponent = text.partition("e")
    text = f"{mantissa}{'' if '.' in mantissa else '.0'}{e}{exponent}"
    return text if len(text) <= MAX_NUMBER_LENGTH else f"{value:.12e}"
