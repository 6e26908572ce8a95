"""What a deck says of itself, in comments at its top: of what it is, what it needs, how well it is known."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from textwrap import wrap

import numpy as np

from heuncli.analyses.load_cases.gathered import BALANCED
from heuncli.analyses.load_cases.model import LoadCase, LoadCases
from heuncli.output.fe_decks.naming import DeckNodes, NodeLoad, plain_text
from heuncli.results.results import Array

WIDTH = 72  # of a comment with its mark: the cards of Nastran have 80 columns
INDENT = " " * 10
HOLD = (
    "Hold the mesh at points whose six conditions keep it from moving and no more (three, two and one at three "
    "points). The reactions there must vanish, beside the loads: that is the check of mass, units and signs at once."
)
NO_PLANE = (
    "The scene moves in the plane, and points or masses lie off the plane z = 0: what acts along z or about x and y is "
    "not told, and the mesh's holding has to bear it."
)


def readme(cases: LoadCases, nodes: DeckNodes, mark: str, tie: str, cards: Sequence[str]) -> Iterator[str]:
    """The comment lines; mark: what begins a comment; tie: how the points are tied to a mesh; cards: their signs."""
    force, length, _, time = cases.units
    body, name = cases.body, plain_text(cases.body.name)
    title = f": {plain_text(cases.title)}" if cases.title else ""
    parts: list[tuple[str, Iterable[str]]] = [
        ("", [f"Load cases of the body {name}{title}"]),
        ("", [f"by heun {cases.version} of {plain_text(cases.spec) or 'a spec'}, SHA-256 {cases.digest}"]),
        (
            "Units",
            [f"{', '.join(cases.units)}, rad; moments {force} {length}, accelerations {length}/{time}2"],
        ),
        ("Axes", ["those of the body; the mesh is drawn in them, with the body's origin at 0, 0, 0"]),
        ("Mesh", _mesh(cases)),
        ("Cases", [line for k, case in enumerate(cases.cases, start=1) for line in _case(cases, case, k)]),
        ("Points", [f"{node.number} {plain_text(node.label)}" for node in nodes.nodes]),
        ("Known", [_known(cases)]),
        ("Split", [f"reactions that are open are split: {plain_text(cases.split)}"] if cases.split else []),
        ("Plane", [NO_PLANE] if any(body.sums(case).relative > BALANCED for case in cases.cases) else []),
        ("Spread", [SPREAD] if _has_lines(cases) else []),
        ("Tie", [tie]),
        ("Hold", [HOLD]),
        ("Inertia", cards),
    ]
    for head, lines in parts:
        for i, line in enumerate(lines):
            yield from comment(line, mark, head if i == 0 else "", hanging=bool(head))


SPREAD = (
    "A distributed load stands as forces at the ends of ten pieces of its line, statically equal piece by piece: "
    "section loads are exact at these points. What it is per length there stands in the comments of its case; a mesh "
    "may bear that instead."
)


def comment(text: str, mark: str, head: str = "", *, hanging: bool = True) -> list[str]:
    """A text as comment lines of bounded width; head: the word at its left."""
    indent = INDENT if hanging else ""
    lines = wrap(text, WIDTH - len(mark) - len(indent), break_long_words=True, break_on_hyphens=False) or [""]
    return [
        f"{mark} {(head.ljust(len(indent)) if i == 0 and head else indent)}{line}\n" for i, line in enumerate(lines)
    ]


def _mesh(cases: LoadCases) -> list[str]:
    """What the mesh has to weigh, for the body's inertia is the mesh's."""
    _, length, mass, _ = cases.units
    body, I = cases.body, cases.body.inertia
    first = [
        "has to have, for its own mass makes the weight and the inertia:",
        f"mass {number(body.mass)} {mass}, center of mass {vector(body.center)} {length},",
    ]
    if body.planar:  # of a body in the plane a spec may tell no more
        return [*first, f"about it Izz {number(float(I[2, 2]))} {mass} {length}2"]
    return [
        *first,
        f"about it Ixx Iyy Izz {vector(np.diag(I))} {mass} {length}2,",
        f"Ixy Iyz Izx {vector(-np.array([I[0, 1], I[1, 2], I[2, 0]]))} (products, the sum of m x y)",
    ]


def _case(cases: LoadCases, case: LoadCase, k: int) -> Iterator[str]:
    sums = cases.body.balance(case)
    yield f"{k}  {plain_text(case.name)}, t = {case.time:.9g} s"
    if case.over is not None:
        yield (
            f"a blow as its mean over {case.over:.6g} s; the peak of a half sine is pi/2 of it. Weight and the other "
            "loads of that instant are not in it"
        )
    force, moment = _left(sums.force, sums.largest_force), _left(sums.moment, sums.largest_moment)
    yield f"forces sum up to {force}, moments to {moment} of the largest"


def _left(left: Array, largest: float) -> str:
    return f"{float(np.abs(left).max()) / largest:.1e}" if left.any() else "0"


def _known(cases: LoadCases) -> str:
    if not cases.estimate:
        return "each load to rounding; every case balances by itself"
    return (
        f"each load to {cases.estimate:.1e} of the run's largest reaction, as heun estimates; the sums vanish beyond "
        "that, for the loads of an instant are answered together"
    )


def _has_lines(cases: LoadCases) -> bool:
    return any(action.per_length is not None for case in cases.cases for action in case.actions)


def parts_of(load: NodeLoad, units: Sequence[str], mark: str) -> Iterator[str]:
    """What a point's load is made of, as comments."""
    for one in load.parts:
        by = "from outside" if one.by == "outside" else f"by {plain_text(one.by)}"
        spread = "" if one.per_length is None else f", {vector(one.per_length)} {units[0]}/{units[1]} there"
        yield from comment(f"{load.node.number}: {one.kind} {plain_text(one.name)}, {by}{spread}", mark, hanging=False)


def heading_of(case: LoadCase, k: int, mark: str) -> list[str]:
    """A line before the cards of a case."""
    return comment(f"-- case {k}: {plain_text(case.name)}, t = {case.time:.9g} s", mark, hanging=False)


def number(value: float) -> str:
    """A number to be read, and compared with that of a mesh."""
    return f"{value + 0.0:.9g}"


def vector(values: Array) -> str:
    """A vector to be read."""
    return f"({', '.join(map(number, values.tolist()))})"


LONGEST = 20  # characters of a number that Abaqus and CalculiX read: what is beyond, the exponent, would be lost


def exact(value: float) -> str:
    """A number with all its digits if there is room, thirteen else, with a point."""
    text = repr(float(value) + 0.0)
    mantissa, e, exponent = text.partition("e")
    text = f"{mantissa}{'' if '.' in mantissa else '.0'}{e}{exponent}"
    return text if len(text) <= LONGEST else f"{value:.12e}"
