"""The comments at the top of a deck: what it contains, what it needs, and how accurate it is."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from textwrap import wrap

import numpy as np

from heuncli.analyses.load_cases.assembly import BALANCE_TOLERANCE
from heuncli.analyses.load_cases.model import LoadCase, LoadCases
from heuncli.output.fe_decks.naming import DeckNodes, NodeLoad, plain_text
from heuncli.results.results import Array

WIDTH = 72  # characters of a comment line with its mark; Nastran's cards have 80 columns
INDENT = " " * 10
SUPPORT_NOTE = (
    "Hold the mesh at points whose six conditions keep it from moving and no more (three, two and one at three "
    "points). The reactions there must vanish, beside the loads: that is the check of mass, units and signs at once."
)
OUT_OF_PLANE_NOTE = (
    "The scene moves in the plane, and points or masses lie off the plane z = 0: what acts along z or about x and y is "
    "not told, and the mesh's holding has to bear it."
)


def readme(cases: LoadCases, nodes: DeckNodes, mark: str, tie: str, cards: Sequence[str]) -> Iterator[str]:
    """Yield the comment lines.

    mark: what begins a comment
    tie: how to tie the points to a mesh
    cards: notes on the cards and their signs
    """
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
        ("Mesh", _mesh_lines(cases)),
        ("Cases", [line for k, case in enumerate(cases.cases, start=1) for line in _case_lines(cases, case, k)]),
        ("Points", [f"{node.number} {plain_text(node.label)}" for node in nodes.nodes]),
        ("Known", [_accuracy_note(cases)]),
        ("Split", [f"reactions that are open are split: {plain_text(cases.split)}"] if cases.split else []),
        (
            "Plane",
            [OUT_OF_PLANE_NOTE]
            if any(body.compute_sums(case).relative > BALANCE_TOLERANCE for case in cases.cases)
            else [],
        ),
        ("Spread", [DISTRIBUTED_NOTE] if _has_distributed_loads(cases) else []),
        ("Tie", [tie]),
        ("Hold", [SUPPORT_NOTE]),
        ("Inertia", cards),
    ]
    for head, lines in parts:
        for i, line in enumerate(lines):
            yield from format_comment(line, mark, head if i == 0 else "", hanging=bool(head))


DISTRIBUTED_NOTE = (
    "A distributed load stands as forces at the ends of ten pieces of its line, statically equal piece by piece: "
    "section loads are exact at these points. What it is per length there stands in the comments of its case; a mesh "
    "may bear that instead."
)


def format_comment(text: str, mark: str, keyword: str = "", *, hanging: bool = True) -> list[str]:
    """Format a text as comment lines of bounded width; keyword: the word at its left."""
    indent = INDENT if hanging else ""
    lines = wrap(text, WIDTH - len(mark) - len(indent), break_long_words=True, break_on_hyphens=False) or [""]
    return [
        f"{mark} {(keyword.ljust(len(indent)) if i == 0 and keyword else indent)}{line}\n"
        for i, line in enumerate(lines)
    ]


def _mesh_lines(cases: LoadCases) -> list[str]:
    """Describe the mass properties that the mesh must have, for the body's inertia comes from the mesh."""
    _, length, mass, _ = cases.units
    body, I = cases.body, cases.body.inertia
    first = [
        "has to have, for its own mass makes the weight and the inertia:",
        f"mass {format_number(body.mass)} {mass}, center of mass {format_vector(body.center)} {length},",
    ]
    if body.planar:  # a plane body may have no other moments in the spec
        return [*first, f"about it Izz {format_number(float(I[2, 2]))} {mass} {length}2"]
    return [
        *first,
        f"about it Ixx Iyy Izz {format_vector(np.diag(I))} {mass} {length}2,",
        f"Ixy Iyz Izx {format_vector(-np.array([I[0, 1], I[1, 2], I[2, 0]]))} (products, the sum of m x y)",
    ]


def _case_lines(cases: LoadCases, case: LoadCase, number: int) -> Iterator[str]:
    sums = cases.body.balance(case)
    yield f"{number}  {plain_text(case.name)}, t = {case.time:.9g} s"
    if case.averaging_time is not None:
        yield (
            f"a blow as its mean over {case.averaging_time:.6g} s; the peak of a half sine is pi/2 of "
            "it. Weight and the other "
            "loads of that instant are not in it"
        )
    force, moment = (
        _format_imbalance(sums.force, sums.largest_force),
        _format_imbalance(sums.moment, sums.largest_moment),
    )
    yield f"forces sum up to {force}, moments to {moment} of the largest"


def _format_imbalance(imbalance: Array, largest: float) -> str:
    return f"{float(np.abs(imbalance).max()) / largest:.1e}" if imbalance.any() else "0"


def _accuracy_note(cases: LoadCases) -> str:
    if not cases.estimate:
        return "each load to rounding; every case balances by itself"
    return (
        f"each load to {cases.estimate:.1e} of the run's largest reaction, as heun estimates; the sums vanish beyond "
        "that, for the loads of an instant are answered together"
    )


def _has_distributed_loads(cases: LoadCases) -> bool:
    return any(action.per_length is not None for case in cases.cases for action in case.actions)


def part_lines(load: NodeLoad, units: Sequence[str], mark: str) -> Iterator[str]:
    """Yield comments on the actions of which a point's load is the sum."""
    for part in load.parts:
        cause = "from outside" if part.source == "outside" else f"by {plain_text(part.source)}"
        per_length_text = (
            "" if part.per_length is None else f", {format_vector(part.per_length)} {units[0]}/{units[1]} there"
        )
        yield from format_comment(
            f"{load.node.number}: {part.kind} {plain_text(part.name)}, {cause}{per_length_text}", mark, hanging=False
        )


def case_heading(case: LoadCase, k: int, mark: str) -> list[str]:
    """Return the comment before the cards of a case."""
    return format_comment(f"-- case {k}: {plain_text(case.name)}, t = {case.time:.9g} s", mark, hanging=False)


def format_number(value: float) -> str:
    """Format a number for reading, and for comparison with that of a mesh."""
    return f"{value + 0.0:.9g}"


def format_vector(values: Array) -> str:
    """Format a vector for reading."""
    return f"({', '.join(map(format_number, values.tolist()))})"


MAX_NUMBER_LENGTH = 20  # characters of a number that Abaqus and CalculiX read: beyond that, the exponent would be lost


def exact(value: float) -> str:
    """Format a number with a decimal point and all its digits if they fit, otherwise with thirteen."""
    text = repr(float(value) + 0.0)
    mantissa, e, exponent = text.partition("e")
    text = f"{mantissa}{'' if '.' in mantissa else '.0'}{e}{exponent}"
    return text if len(text) <= MAX_NUMBER_LENGTH else f"{value:.12e}"
