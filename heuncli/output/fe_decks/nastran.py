"""Load cases for Nastran: bulk data in large fields, a subcase each.

    GRAV    a load along its vector: force m A N, so that N is g - a
    RFORCE  A [rev/s]: force -m w x (w x x), outwards; RACC [rev/s2]: force +m u x x along the acceleration, against
            d'Alembert's, so that it is given with the opposite sign
All dialects agree on the sign of A, not on that of RACC. OptiStruct's load is along the angular acceleration, "opposite
to the inertia forces" (its reference, RFORCE, comment 1), as in the formula of MSC and Simcenter; MYSTRAN's is against
it (RFORCE_PROC). So RACC has a set of its own, whose factor in LOAD turns it round, and the reactions tell.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.analyses.load_cases.model import LoadCase, LoadCases
from heuncli.base.records import replace
from heuncli.output.fe_decks.naming import DeckNames, DeckNodes, NodeLoad, step_name
from heuncli.output.fe_decks.readme import heading_of, parts_of, readme
from heuncli.results.results import Array

MARK = "$"
TIE = (
    "Tie each point to the nodes of its bore: RBE3 with the point as its reference grid (spreads the load) or RBE2 "
    "with the point as the independent grid (keeps the bore rigid)."
)
CARDS = (
    "GRAV is a load along its vector, g - a at the body's origin. RFORCE is about the axis through 0, 0, 0, its A in "
    "revolutions per second, outwards; METHOD 2 is right for coupled masses (1 where elements have a ZOFFS). Each has "
    "a set of its own, which LOAD adds up.",
    "RACC is in revolutions per second squared. OptiStruct makes of it a load along the angular acceleration, as "
    "MSC and Simcenter have it in their formula: so it stands here with the opposite sign. MYSTRAN makes a load "
    "against it: there the last factor of LOAD is -1. The reactions of the holding vanish with the right one.",
    "PARAM,INREL stays off: the inertia is in the cards.",
)
TURN = 2.0 * math.pi
FIELD = 16
SETS = 10  # numbers of load sets that a case takes: the sum, then forces, GRAV, RFORCE of A, of RACC


def written(cases: LoadCases, names: DeckNames) -> Iterator[str]:
    """The deck in pieces."""
    nodes = DeckNodes(cases, names)
    yield from readme(cases, nodes, MARK, TIE, (*CARDS, _rounding(cases)))
    yield "SOL 101\nCEND\nECHO = NONE\nOLOAD = ALL\nSPCFORCES = ALL\n$ SPC = 1\n"
    for k, case in enumerate(cases.cases, start=1):
        yield f"SUBCASE {k}\n  SUBTITLE = {step_name(k, case)}\n  LOAD = {SETS * k}\n"
    yield "BEGIN BULK\n$ INCLUDE 'mesh.bdf'\n"
    for node in nodes.nodes:
        yield from card("GRID", [node.number, "", *node.at.tolist(), ""])
    for k, case in enumerate(cases.cases, start=1):
        yield from _case(cases, case, nodes, k)
    yield "ENDDATA\n"


def _case(cases: LoadCases, case: LoadCase, nodes: DeckNodes, k: int) -> Iterator[str]:
    yield from heading_of(case, k, MARK)
    first, field = SETS * k, case.field
    used: list[int] = []
    for load in nodes.loads(case):
        yield from parts_of(load, cases.units, MARK)
        yield from _forces(load, first + 1)
        used = [first + 1]
    if field.linear.any():
        used.append(first + 2)
        yield from card("GRAV", [first + 2, 0, 1.0, *(-field.linear).tolist()])
    for number, turning, rate in ((3, field.angular_velocity, True), (4, field.angular_acceleration, False)):
        size = float(np.sqrt(turning @ turning))
        if size > 0.0:
            used.append(first + number)
            axis, a = (turning / size).tolist(), size / TURN
            end = [2] if rate else [1, -a]
            yield from card("RFORCE", [first + number, 0, 0, a if rate else 0.0, *axis, *end])
    if not used:  # LOAD has to add up something
        used.append(first + 2)
        yield from card("GRAV", [first + 2, 0, 0.0, 1.0, 0.0, 0.0])
    yield from _sum(first, used)


def _sum(first: int, used: Sequence[int]) -> Iterator[str]:
    """The sets of a case added up: they must not have one number."""
    yield from card("LOAD", [first, 1.0, *(part for one in used for part in (1.0, one))])


def _forces(load: NodeLoad, number: int) -> Iterator[str]:
    for name, value in (("FORCE", load.force), ("MOMENT", load.moment)):
        if value.any():
            yield from card(name, [number, load.node.number, 0, 1.0, *value.tolist()])


def card(name: str, fields: Sequence[int | float | str]) -> Iterator[str]:
    """A card in large fields, four a line."""
    texts = [real(value) if isinstance(value, float) else str(value) for value in fields]
    lines = [texts[i : i + 4] for i in range(0, len(texts), 4)]
    for i, line in enumerate(lines):
        begin = f"{name}*" if i == 0 else "*"
        yield (begin.ljust(8) + "".join(text.rjust(FIELD) for text in line)).rstrip() + "\n"
    if len(lines) % 2:
        yield "*\n"


def real(value: float) -> str:
    """A number in 16 columns, with as many digits as they hold: twelve at least."""
    value = value + 0.0
    plain = repr(value)
    short = f"{value:.13g}"
    for text in (plain, short if "." in short else f"{short}.0"):
        if len(text) <= FIELD and "e" not in text:
            return text
    for digits in range(14, 0, -1):
        mantissa, _, exponent = f"{value:.{digits}e}".partition("e")
        text = f"{mantissa}{int(exponent):+d}"
        if len(text) <= FIELD:
            return text
    raise AssertionError(value)


def _rounding(cases: LoadCases) -> str:
    """What the cards' digits leave of the sums."""
    left = max((cases.body.balance(_as_read(case)).relative for case in cases.cases), default=0.0)
    told = f"{left:.1e}" if left else "0"
    return f"Numbers as large fields hold them: the sums of the cards are {told} of the largest."


def _as_read(case: LoadCase) -> LoadCase:
    """The case as its cards are read."""

    def read(vector: Array) -> Array:
        return np.array([value_of(real(x)) for x in vector.tolist()])

    actions = tuple(replace(a, at=read(a.at), force=read(a.force), moment=read(a.moment)) for a in case.actions)
    f = case.field
    field = replace(f, origin=read(f.linear), gravity=np.zeros(3))
    return replace(case, actions=actions, field=field)


def value_of(text: str) -> float:
    """A number of a card: of an exponent only the sign is written."""
    head, sign, tail = text[1:].rpartition("-") if "-" in text[1:] else text[1:].rpartition("+")
    return float(text) if not sign else float(f"{text[0]}{head}e{sign}{tail}")


def notes(cases: LoadCases, names: DeckNames) -> list[str]:
    """Where a dialect decides about a sign."""
    if any(case.field.angular_acceleration.any() for case in cases.cases):
        return ["RACC is signed as OptiStruct, MSC and Simcenter read it, MYSTRAN the other way round"]
    return []
