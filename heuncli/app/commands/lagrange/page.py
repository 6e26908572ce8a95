"""The Lagrange side of an instant as tables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from operator import attrgetter

import numpy as np

from heuncli.analyses.lagrange.kinds import ANGLE, LENGTH, units_of
from heuncli.analyses.lagrange.results import LagrangeResults, StateSpace
from heuncli.analyses.lagrange.section_forces import cuts
from heuncli.output.tables.page_width import fit
from heuncli.output.tables.text_table import WIDTH, TextColumn, TextTable, head, labelled, plain
from heuncli.results.results import Array
from heuncli.study.quantities.labels import distinguish
from heuncli.study.quantities.table_units import Units
from heuncli.version import VERSION

HEADING = "LAGRANGE  {at}: coordinates q and rates q'; ε q'' + C = k + drive"
MASS = "MASS  ε = ∂²E/∂q'∂q', and the inertia that is seen: with the other coordinates held, and with them free"
RECIPROCAL = "RECIPROCAL  η = 1/ε: E = p η p / 2"
FORCES = "FORCES  k along each coordinate, by cause; C: what the masses' accelerations at q'' = 0 do there"
CHRISTOFFEL = "CHRISTOFFEL  γ(i; l, k) = (∂ε_il/∂q_k + ∂ε_ik/∂q_l − ∂ε_lk/∂q_i) / 2 and α(i; l, k) = −Σ η_ij γ(j; l, k)"
BLOWS = "BLOWS  ε [q'] = h + drives; r': what the piece beyond a cut does on the rest in the blow"
SECTIONS = "SECTIONS  s' along each coordinate: what the piece beyond the cut does on the rest"
STATE_SPACE = "STATE SPACE  x' = A x + B u: A by the states, B by the inputs"
OUTPUTS = "OUTPUTS  y = C x + D u"
OWN_ROWS = ("k", "C")  # behind those of the causes
SI = Units()
SHOWN = 6  # coordinates, of which matrices are written out
ROUNDING = 1e-13  # of what a number is summed from, or of the largest of a matrix: less is told as 0
MIXED = ". Angles in {}, {}; lengths in {}, {}"
COLUMNS: tuple[tuple[str, attrgetter[str]], ...] = (
    ("q", attrgetter("value")), ("q'", attrgetter("rate")), ("p = ∂E/∂q'", attrgetter("momentum")),
    ("C", attrgetter("force")), ("k", attrgetter("force")), ("drive", attrgetter("force")),
    ("q''", attrgetter("acceleration")),
)  # fmt: skip


def write(found: LagrangeResults, only: Sequence[str] = (), units: Units = SI) -> str:
    """The page as text; only: parts, as forms.KEYS names them."""
    above = labelled([("heun", f"{VERSION}  {found.title}"), *energy_lines(found, units)])
    asked = [table for part, table in tables(found, units) if not only or part in only]
    return "\n".join([above, *("".join(plain(part, WIDTH) for part in fit(table, WIDTH)) for table in asked)])


def energy_lines(found: LagrangeResults, units: Units) -> Iterator[tuple[str, str]]:
    """Label and text of the lines above the tables."""
    unit, size = units.of("J")
    free, mixed, driven = (size * part for part in found.energies)
    parts = (
        f": free {free:.6g}, mixed {mixed:.6g}, driven {driven:.6g} {unit}"
        if any(found.driven) and free and not np.isnan(free)
        else ""
    )
    yield "energy", f"E = {size * found.energy:.6g} {unit}, F = {size * found.reciprocal_energy:.6g} {unit}{parts}"
    yield "", f"ε q'' + C = k + drive is met to {found.residual:.1g} of what its terms are summed from"
    for note in found.notes:
        yield "", note


def tables(found: LagrangeResults, units: Units) -> Iterator[tuple[str, TextTable]]:
    """The parts that are told, a table each; matrices of few coordinates."""
    yield "equations", equations(found, units)
    yield "mass", seen(found)
    if len(found.names) <= SHOWN:
        yield "reciprocal", reciprocal(found)
        yield "forces", forces(found, units)
        if found.gamma is not None:
            yield "christoffel", christoffel(found)
    if found.sections:
        yield "sections", sections(found, units)
    if found.blows:
        yield "blows", blows(found, units)
    if found.state_space is not None:
        yield from (("state_space", table) for table in linear_tables(found.state_space))


def linear_tables(linear: StateSpace) -> Iterator[TextTable]:
    """A and B, and C and D, side by side."""
    for heading, left, right, rows in (
        (STATE_SPACE, linear.A, linear.B, [f"d/dt {name}" for name in linear.states]),
        (OUTPUTS, linear.C, linear.D, linear.outputs),
    ):
        whole = np.hstack([left, right])
        sizes = np.abs(whole).max(axis=1, initial=0.0)
        told = tuple(
            (name, *(number(x, size) for x in row)) for name, row, size in zip(rows, whole, sizes, strict=True)
        )
        yield TextTable(heading, (TextColumn("", "left"), *map(TextColumn, (*linear.states, *linear.inputs))), told)


def number(value: float | None, scale: float = 0.0) -> str:
    """Six digits; 0 of what is rounding beside a scale."""
    if value is None or np.isnan(value):
        return ""
    return "0" if abs(value) <= ROUNDING * scale else f"{value:.6g}"


def label(found: LagrangeResults, i: int) -> str:
    """A coordinate, with whether a drive moves it."""
    return f"{found.names[i]}{'  driven' if found.driven[i] else ''}"


def equations(found: LagrangeResults, units: Units) -> TextTable:
    """A row a coordinate, in units by the columns' heads, or by the heading where angles and lengths meet."""
    columns = (found.values, found.rates, found.momenta, found.coriolis, found.total, found.drives, found.accelerations)
    none = np.zeros(len(found.names))
    scales = (none, none, none, found.scale, found.scale, found.scale, np.abs(found.eta) @ found.scale)
    rows = []
    for i, name in enumerate(found.names):
        own = units_of(name)
        sizes = [units.of(unit(own))[1] for _, unit in COLUMNS]
        cells = (number(x[i] * by, scale[i] * by) for x, scale, by in zip(columns, scales, sizes, strict=True))
        rows.append((label(found, i), *cells))
    heading, kinds = HEADING.format(at=found.at), {units_of(name) for name in found.names}
    if len(kinds) == 1:
        heads = [head(name, units.of(unit(own))[0]) for own in kinds for name, unit in COLUMNS]
    else:
        heads = [name for name, _ in COLUMNS]
        heading += MIXED.format(*(units.of(unit)[0] for own in (ANGLE, LENGTH) for unit in (own.value, own.force)))
    return TextTable(heading, (TextColumn("coordinate", "left"), *map(TextColumn, heads)), tuple(rows))


def seen(found: LagrangeResults) -> TextTable:
    """The mass matrix where it is small, and the inertias that are seen."""
    shows = len(found.names) <= SHOWN and {one.name for one in found.seen} == set(found.names)
    sizes = beside_diagonal(found.epsilon)
    rows = []
    for one in found.seen:
        own = []
        if shows:
            i = found.names.index(one.name)
            own = [number(x, size) for x, size in zip(found.epsilon[i], sizes[i], strict=True)]
        rows.append((one.name, *own, one.unit, number(one.locked), number(one.free)))
    columns = [TextColumn(f"ε {name}") for name in found.names] if shows else []
    heads = (TextColumn("seen at", "left"), *columns, TextColumn("unit", "left"), TextColumn("others held"))
    return TextTable(MASS, (*heads, TextColumn("others free")), tuple(rows))


def beside_diagonal(matrix: Array) -> Array:
    """How large the entries of a positive definite matrix can be: the root of the product of the diagonal's two."""
    root = np.sqrt(np.diag(matrix))
    return np.asarray(np.outer(root, root))


def reciprocal(found: LagrangeResults) -> TextTable:
    """The inverse of the mass matrix."""
    named = zip(found.names, found.eta, beside_diagonal(found.eta), strict=True)
    rows = tuple((name, *map(number, row, sizes)) for name, row, sizes in named)
    return TextTable(RECIPROCAL, (TextColumn("", "left"), *map(TextColumn, found.names)), rows)


def forces(found: LagrangeResults, units: Units) -> TextTable:
    """k by cause."""
    shown = [units.of(units_of(name).force) for name in found.names]

    def row(cause: str, k: Array) -> tuple[str, ...]:
        told = zip(k, found.scale, shown, strict=True)
        return cause, *(number(x * by, size * by) for x, size, (_, by) in told)

    rows = [row(distinguish(cause, OWN_ROWS), k) for cause, k in found.forces.items()]
    rows += [row(name, k) for name, k in zip(OWN_ROWS, (found.total, found.coriolis), strict=True)]
    heads = (TextColumn(head(name, unit)) for name, (unit, _) in zip(found.names, shown, strict=True))
    return TextTable(FORCES, (TextColumn("cause", "left"), *heads), tuple(rows))


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


def sections(found: LagrangeResults, units: Units) -> TextTable:
    """s' of each cut."""
    shown = [units.of(units_of(name).force) for name in found.names]
    sizes = [by for _, by in shown]
    rows = [(cut, *cells(s, sizes, own.reach)) for name, own in found.sections.items() for cut, s in cuts(name, own)]
    heads = (TextColumn(head(name, unit)) for name, (unit, _) in zip(found.names, shown, strict=True))
    return TextTable(SECTIONS, (TextColumn("section", "left"), *heads), tuple(rows))


def blows(found: LagrangeResults, units: Units) -> TextTable:
    """Of each blow h, what drives exert, the jumps of the rates, and what sections pass on."""
    own = [units_of(name) for name in found.names]
    impulses, rates = ([units.of(unit)[1] for unit in by] for by in ([x.momentum for x in own], [x.rate for x in own]))
    rows = []
    for blow in found.blows:
        at = f"t = {blow.t:.6g} s"
        rows += [(at, "h", *cells(blow.h, impulses)), (at, "[q']", *cells(blow.jumps, rates))]
        rows += [(at, "drives", *cells(blow.drives, impulses))] if blow.drives.any() else []
        for section, passed in blow.sections.items():
            rows += [(at, f"r' {cut}", *cells(r, impulses, passed.reach)) for cut, r in cuts(section, passed)]
    unit, size = units.of("J")
    notes = [f"F = h η h / 2 = {blow.reciprocal_energy * size:.6g} {unit}" for blow in found.blows]
    for kind in sorted(set(own)):
        told = ", ".join(units.of(unit)[0] for unit in (kind.momentum, kind.rate))
        notes.append(f"along {'lengths' if kind is LENGTH else 'angles'}: {told}")
    heads = (TextColumn("blow", "left", once=True), TextColumn("", "left"), *map(TextColumn, found.names))
    return TextTable(BLOWS, heads, tuple(rows), tuple(notes))


def cells(values: Array | None, sizes: Sequence[float], reach: Array | float = 0.0) -> list[str]:
    """Numbers along the coordinates in the units shown, 0 of rounding beside a reach; `open` where none is unique."""
    if values is None:
        return ["open"] * len(sizes)
    by = np.array(sizes)
    return [number(x, size) for x, size in zip(values * by, reach * by, strict=True)]
