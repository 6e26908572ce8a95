"""Write load cases for Nastran: bulk data in large fields, a subcase each.

    GRAV    a load along its vector: force m A N, so that N is g - a
    RFORCE  A [rev/s]: force -m w x (w x x), outwards; RACC [rev/s2]: force +m u x x along the acceleration, against
            d'Alembert's, so that it is given with the opposite sign
All dialects agree on the sign of A, but not on that of RACC. OptiStruct's load is along the angular acceleration,
"opposite to the inertia forces" (its reference, RFORCE, comment 1), as in the formula of MSC and Simcenter; MYSTRAN's
is against it (RFORCE_PROC). So RACC has a set of its own, whose factor in LOAD reverses it, and the reactions show
which is right.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.analyses.load_cases.model import LoadCase, LoadCases
from heuncli.base.records import replace
from heuncli.output.fe_decks.decks import (
    DeckNames,
    DeckNodes,
    NodeLoad,
    format_case_heading,
    iter_header,
    iter_part_lines,
    make_step_name,
)
from heuncli.results.results import Array

MARK = "$"
TIE_NOTE = (
    "Tie each point to the nodes of its bore: RBE3 with the point as its reference grid (spreads the load) or RBE2 "
    "with the point as the independent grid (keeps the bore rigid)."
)
CARD_NOTES = (
    "GRAV acts along its vector, g - a at the body's origin. RFORCE acts outwards about the axis through 0, 0, 0, with "
    "A in revolutions per second; METHOD 2 is correct for coupled masses (1 where elements have a ZOFFS). Each has its "
    "own set; LOAD adds them.",
    "RACC is in revolutions per second squared. OptiStruct, like the formula of MSC and Simcenter, applies it as a "
    "load along the angular acceleration, so it is written here with the opposite sign. MYSTRAN applies it against: "
    "use -1 as the last factor of LOAD there. With the right sign the support reactions vanish.",
    "Keep PARAM,INREL off: the cards contain the inertia loads.",
)
FULL_TURN = 2.0 * math.pi
FIELD_WIDTH = 16
SETS_PER_CASE = 10  # load set numbers reserved for a case: the sum, then forces, GRAV, RFORCE of A, of RACC


def write_nastran(cases: LoadCases, names: DeckNames) -> Iterator[str]:
    """Yield the text of the deck, in pieces."""
    nodes = DeckNodes(cases, names)
    yield from iter_header(cases, nodes, MARK, TIE_NOTE, (*CARD_NOTES, _describe_rounding(cases)))
    yield "SOL 101\nCEND\nECHO = NONE\nOLOAD = ALL\nSPCFORCES = ALL\n$ SPC = 1\n"
    for k, case in enumerate(cases.cases, start=1):
        yield f"SUBCASE {k}\n  SUBTITLE = {make_step_name(k, case)}\n  LOAD = {SETS_PER_CASE * k}\n"
    yield "BEGIN BULK\n$ INCLUDE 'mesh.bdf'\n"
    for node in nodes.nodes:
        yield from iter_card_lines("GRID", [node.number, "", *node.place.tolist(), ""])
    for k, case in enumerate(cases.cases, start=1):
        yield from _iter_case_cards(cases, case, nodes, k)
    yield "ENDDATA\n"


def _iter_case_cards(cases: LoadCases, case: LoadCase, nodes: DeckNodes, k: int) -> Iterator[str]:
    """Yield the cards of the case number k: forces, GRAV, RFORCE of A and of RACC, and their sum."""
    yield from format_case_heading(case, k, MARK)
    load_set, field = SETS_PER_CASE * k, case.field
    used: list[int] = []
    for load in nodes.find_loads(case):
        yield from iter_part_lines(load, cases.units, MARK)
        cards = list(_iter_force_cards(load, load_set + 1))
        used = [load_set + 1] if cards else used
        yield from cards
    if field.linear.any():
        used.append(load_set + 2)
        yield from iter_card_lines("GRAV", [load_set + 2, 0, 1.0, *(-field.linear).tolist()])
    for number, rotation, is_speed in ((3, field.angular_velocity, True), (4, field.angular_acceleration, False)):
        if rotation.any():
            used.append(load_set + number)
            turns, axis = _split_rotation(rotation)
            speed, last_fields = (turns, [2]) if is_speed else (0.0, [1, -turns])  # METHOD; then the value of RACC
            yield from iter_card_lines("RFORCE", [load_set + number, 0, 0, speed, *axis, *last_fields])
    if not used:  # LOAD needs at least one set
        used.append(load_set + 2)
        yield from iter_card_lines("GRAV", [load_set + 2, 0, 0.0, 1.0, 0.0, 0.0])
    yield from _iter_sum_card(load_set, used)


def _split_rotation(rotation: Array) -> tuple[float, list[float]]:
    """Return the revolutions per second (or s²) of a rotation (3,) [rad/s], and its axis, as cards have them."""
    size = float(np.sqrt(rotation @ rotation))
    return size / FULL_TURN, (rotation / size).tolist()


def _iter_sum_card(first: int, used: Sequence[int]) -> Iterator[str]:
    """Yield the card that adds up the sets of a case; they need different numbers."""
    yield from iter_card_lines("LOAD", [first, 1.0, *(part for load_set in used for part in (1.0, load_set))])


def _iter_force_cards(load: NodeLoad, number: int) -> Iterator[str]:
    for name, value in (("FORCE", load.force), ("MOMENT", load.moment)):
        if value.any():
            yield from iter_card_lines(name, [number, load.node.number, 0, 1.0, *value.tolist()])


def iter_card_lines(name: str, fields: Sequence[int | float | str]) -> Iterator[str]:
    """Yield the lines of a card in large fields, four a line."""
    texts = [format_real(value) if isinstance(value, float) else str(value) for value in fields]
    lines = [texts[i : i + 4] for i in range(0, len(texts), 4)]
    for i, line in enumerate(lines):
        begin = f"{name}*" if i == 0 else "*"
        yield (begin.ljust(8) + "".join(text.rjust(FIELD_WIDTH) for text in line)).rstrip() + "\n"
    if len(lines) % 2:
        yield "*\n"


def format_real(value: float) -> str:
    """Format a number in 16 columns, with as many digits as fit: at least twelve."""
    value = value + 0.0
    plain = repr(value)
    short = f"{value:.13g}"
    for text in (plain, short if "." in short else f"{short}.0"):
        if len(text) <= FIELD_WIDTH and "e" not in text:
            return text
    for digits in range(14, 0, -1):
        mantissa, _, exponent = f"{value:.{digits}e}".partition("e")
        text = f"{mantissa}{int(exponent):+d}"
        if len(text) <= FIELD_WIDTH:
            return text
    raise AssertionError(value)


def _describe_rounding(cases: LoadCases) -> str:
    """Describe the imbalance of the sums due to the digits of the cards."""
    imbalance = max((cases.body.balance(_round_as_written(case)).relative for case in cases.cases), default=0.0)
    imbalance_text = f"{imbalance:.1e}" if imbalance else "0"
    return f"Numbers are rounded to large fields: the cards sum to {imbalance_text} of the largest."


def _round_as_written(case: LoadCase) -> LoadCase:
    """Return the case with the numbers of its cards."""

    def round_vector(vector: Array) -> Array:
        return np.array([parse_real(format_real(x)) for x in vector.tolist()])

    def round_rotation(rotation: Array) -> Array:
        if not rotation.any():
            return rotation
        turns, axis = _split_rotation(rotation)
        return FULL_TURN * parse_real(format_real(turns)) * round_vector(np.array(axis))

    actions = tuple(
        replace(a, at=round_vector(a.at), force=round_vector(a.force), moment=round_vector(a.moment))
        for a in case.actions
    )
    f = case.field
    field = replace(
        f,
        origin=round_vector(f.linear),
        gravity=np.zeros(3),
        angular_velocity=round_rotation(f.angular_velocity),
        angular_acceleration=round_rotation(f.angular_acceleration),
    )
    return replace(case, actions=actions, field=field)


def parse_real(text: str) -> float:
    """Parse a number of a card; an exponent is written as its sign and digits only."""
    head, sign, tail = text[1:].rpartition("-") if "-" in text[1:] else text[1:].rpartition("+")
    return float(text) if not sign else float(f"{text[0]}{head}e{sign}{tail}")


def list_nastran_notes(cases: LoadCases, names: DeckNames) -> list[str]:
    """Warn if a sign depends on the dialect."""
    if any(case.field.angular_acceleration.any() for case in cases.cases):
        return ["RACC has the sign for OptiStruct, MSC and Simcenter; MYSTRAN needs the opposite sign"]
    return []
