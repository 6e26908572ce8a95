"""The Lagrange side of an instant as tables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any

import numpy as np

from heuncli.commands.lagrange.results import LagrangeResults, StateSpace
from heuncli.report.page_width import fit
from heuncli.report.text_table import WIDTH, TextColumn, TextTable, labelled, plain
from heuncli.results import Array
from heuncli.version import VERSION

HEADING = "LAGRANGE  {at}: coordinates q and rates q'; ε q'' + C = k + drive. Angles in rad, N·m; lengths in m, N"
MASS = "MASS  ε = ∂²E/∂q'∂q', and the inertia that is seen: with the other coordinates held, and with them free"
RECIPROCAL = "RECIPROCAL  η = 1/ε: E = p η p / 2"
FORCES = "FORCES  k along each coordinate, by cause; C: what the masses' accelerations at q'' = 0 do there"
CHRISTOFFEL = "CHRISTOFFEL  γ(i; l, k) = (∂ε_il/∂q_k + ∂ε_ik/∂q_l − ∂ε_lk/∂q_i) / 2 and α(i; l, k) = −Σ η_ij γ(j; l, k)"
BLOWS = "BLOWS  ε [q'] = h + drives; r': what the piece beyond a cut does on the rest in the blow"
SECTIONS = "SECTIONS  s' along each coordinate: what the piece beyond the cut does on the rest"
STATE_SPACE = "STATE SPACE  x' = A x + B u: A by the states, B by the inputs"
OUTPUTS = "OUTPUTS  y = C x + D u"
SHOWN = 6  # coordinates, of which matrices are written out
ROUNDING = 1e-13  # of what a number is summed from, or of the largest of a matrix: less is told as 0
COLUMNS = ("q", "q'", "p = ∂E/∂q'", "C", "k", "drive", "q''")


def write(found: LagrangeResults, only: Sequence[str] = ()) -> str:
    """The page as text; only: parts, as forms.KEYS names them."""
    head = labelled([("heun", f"{VERSION}  {found.title}"), *energy_lines(found)])
    asked = [table for part, table in tables(found) if not only or part in only]
    return "\n".join([head, *("".join(plain(part, WIDTH) for part in fit(table, WIDTH)) for table in asked)])


def energy_lines(found: LagrangeResults) -> Iterator[tuple[str, str]]:
    """Label and text of the lines above the tables."""
    free, mixed, driven = found.energies
    parts = f": free {free:.6g}, mixed {mixed:.6g}, driven {driven:.6g} J" if any(found.driven) and free else ""
    yield "energy", f"E = {found.energy:.6g} J, F = {found.reciprocal_energy:.6g} J{parts}"
    yield "", f"ε q'' + C = k + drive is met to {found.residual:.1g} of what its terms are summed from"
    for note in found.notes:
        yield "", note


def tables(found: LagrangeResults) -> Iterator[tuple[str, TextTable]]:
    """The parts that are told, a table each; matrices of few coordinates."""
    yield "equations", equations(found)
    yield "mass", seen(found)
    if len(found.names) <= SHOWN:
        yield "reciprocal", matrix(RECIPROCAL, found, found.eta)
        yield "forces", forces(found)
        if found.gamma is not None:
            yield "christoffel", christoffel(found)
    if found.sections:
        yield "sections", sections(found)
    if found.blows:
        yield "blows", blows(found)
    if found.state_space is not None:
        yield from (("state_space", table) for table in linear_tables(found.state_space))


def linear_tables(linear: StateSpace) -> Iterator[TextTable]:
    """A and B, and C and D, side by side."""
    for heading, left, right, rows in (
        (STATE_SPACE, linear.A, linear.B, [f"d/dt {name}" for name in linear.states]),
        (OUTPUTS, linear.C, linear.D, linear.outputs),
    ):
        whole = np.hstack([left, right])
        size = float(np.abs(whole).max(initial=0.0))
        cells = tuple((name, *(number(x, size) for x in row)) for name, row in zip(rows, whole, strict=True))
        yield TextTable(heading, (TextColumn("", "left"), *map(TextColumn, (*linear.states, *linear.inputs))), cells)


def number(value: float | None, scale: float = 0.0) -> str:
    """Six digits; 0 of what is rounding beside a scale."""
    if value is None or np.isnan(value):
        return ""
    return "0" if abs(value) <= ROUNDING * scale else f"{value:.6g}"


def label(found: LagrangeResults, i: int) -> str:
    """A coordinate, with whether a drive moves it."""
    return f"{found.names[i]}{'  driven' if found.driven[i] else ''}"


def equations(found: LagrangeResults) -> TextTable:
    """A row a coordinate."""
    forces = np.array([found.coriolis, found.total, found.drives])
    reached = np.abs(found.eta) @ found.scale
    rows = []
    for i in range(len(found.names)):
        given = (found.values[i], found.rates[i], found.momenta[i])
        rows.append((
            label(found, i), *(number(x) for x in given), *(number(x, found.scale[i]) for x in forces[:, i]),
            number(found.accelerations[i], reached[i]),
        ))  # fmt: skip
    heads = (TextColumn("coordinate", "left"), *(TextColumn(name) for name in COLUMNS))
    return TextTable(HEADING.format(at=found.at), heads, tuple(rows))


def seen(found: LagrangeResults) -> TextTable:
    """The mass matrix where it is small, and the inertias that are seen."""
    shows = len(found.names) <= SHOWN and {one.name for one in found.seen} == set(found.names)
    size = float(np.abs(found.epsilon).max())
    rows = []
    for one in found.seen:
        own = [number(x, size) for x in found.epsilon[found.names.index(one.name)]] if shows else []
        rows.append((one.name, *own, one.unit, number(one.locked), number(one.free)))
    columns = [TextColumn(f"ε {name}") for name in found.names] if shows else []
    heads = (TextColumn("seen at", "left"), *columns, TextColumn("unit", "left"), TextColumn("others held"))
    return TextTable(MASS, (*heads, TextColumn("others free")), tuple(rows))


def matrix(heading: str, found: LagrangeResults, values: Array) -> TextTable:
    """A matrix by coordinates."""
    size = float(np.abs(values).max())
    rows = tuple((name, *(number(x, size) for x in row)) for name, row in zip(found.names, values, strict=True))
    return TextTable(heading, (TextColumn("", "left"), *(TextColumn(name) for name in found.names)), rows)


def forces(found: LagrangeResults) -> TextTable:
    """k by cause."""

    def row(cause: str, k: Array) -> tuple[str, ...]:
        return cause, *(number(x, size) for x, size in zip(k, found.scale, strict=True))

    rows = [row(cause, k) for cause, k in found.forces.items()]
    rows += [row("k", found.total), row("C", found.coriolis)]
    return TextTable(FORCES, (TextColumn("cause", "left"), *(TextColumn(name) for name in found.names)), tuple(rows))


def christoffel(found: LagrangeResults) -> TextTable:
    """The symbols that are not 0, each pair l, k once."""
    assert found.gamma is not None and found.alpha is not None
    sizes = [float(np.abs(x).max(initial=0.0)) for x in (found.gamma, found.alpha)]
    rows = []
    f = len(found.names)
    for i, j, k in product(range(f), repeat=3):
        if k < j:
            continue
        both = [number(x[i, j, k], size) for x, size in zip((found.gamma, found.alpha), sizes, strict=True)]
        if both != ["0", "0"]:
            rows.append((found.names[i], found.names[j], found.names[k], *both))
    heads = (*(TextColumn(name, "left") for name in ("i", "l", "k")), TextColumn("γ"), TextColumn("α"))
    return TextTable(CHRISTOFFEL, heads, tuple(rows), () if rows else ("all are 0",))


def sections(found: LagrangeResults) -> TextTable:
    """s' of each cut."""
    rows = []
    for name, own in found.sections.items():
        for cut, s in cuts_of(own["s"]):
            rows.append((name + cut, *(["open"] * len(found.names) if s is None else [number(x) for x in s])))
    return TextTable(SECTIONS, (TextColumn("section", "left"), *(TextColumn(n) for n in found.names)), tuple(rows))


def blows(found: LagrangeResults) -> TextTable:
    """Of each blow h, what drives exert, the jumps of the rates, and what sections pass on."""
    rows = []
    for blow in found.blows:
        at = f"t = {blow.t:.6g} s"
        named = [("h", blow.h), ("[q']", blow.jumps)]
        named += [("drives", blow.drives)] if any(found.driven) else []
        rows += [(at, name, *map(number, values)) for name, values in named]
        for section, own in blow.sections.items():
            for cut, r in cuts_of(own):
                cells = ["open"] * len(found.names) if r is None else [number(x) for x in r]
                rows.append((at, f"r' {section}{cut}", *cells))
    notes = tuple(f"F = h η h / 2 = {blow.reciprocal_energy:.6g} J" for blow in found.blows)
    heads = (TextColumn("blow", "left", once=True), TextColumn("", "left"), *map(TextColumn, found.names))
    return TextTable(BLOWS, heads, tuple(rows), notes)


def cuts_of(s: Any) -> list[tuple[str, Sequence[float] | None]]:
    """The cuts of a section with their numbers: none of a single one."""
    if s is None or not isinstance(s[0], (list, type(None))):
        return [("", s)]
    return [(f".{k}", own) for k, own in enumerate(s)]
