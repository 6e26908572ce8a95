"""The Lagrange side as tables, as JSON, and in long form."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any

import numpy as np

from heuncli.commands.lagrange.results import InertiaCourse, LagrangeResults, StateSpace
from heuncli.foreign_text import shown
from heuncli.report.page_width import fit
from heuncli.report.text_table import WIDTH, TextColumn, TextTable, plain
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
CSV_COLUMNS = "name,quantity,component,unit,value"


def write(found: LagrangeResults) -> str:
    """The page as text."""
    lines = [("heun", f"{VERSION}  {found.title}"), *energy_lines(found)]
    head = "".join(f"{label.ljust(6)}  {shown(text)}\n" for label, text in lines)
    return "\n".join([head, *("".join(plain(part, WIDTH) for part in fit(table, WIDTH)) for table in tables(found))])


def energy_lines(found: LagrangeResults) -> Iterator[tuple[str, str]]:
    """Label and text of the lines above the tables."""
    free, mixed, driven = found.energies
    parts = f": free {free:.6g}, mixed {mixed:.6g}, driven {driven:.6g} J" if any(found.driven) and free else ""
    yield "energy", f"E = {found.energy:.6g} J, F = {found.reciprocal_energy:.6g} J{parts}"
    yield "", f"ε q'' + C = k + drive is met to {found.residual:.1g} of what its terms are summed from"
    for note in found.notes:
        yield "", note


def tables(found: LagrangeResults) -> list[TextTable]:
    """What is told, a table each."""
    made = [equations(found), seen(found)]
    if len(found.names) <= SHOWN:
        made.append(matrix(RECIPROCAL, found, found.eta))
        made.append(forces(found))
        if found.gamma is not None:
            made.append(christoffel(found))
    if found.sections:
        made.append(sections(found))
    if found.blows:
        made.append(blows(found))
    if found.state_space is not None:
        made += linear_tables(found.state_space)
    return made


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
    rows = []
    for i in range(len(found.names)):
        given = (found.values[i], found.rates[i], found.momenta[i])
        rows.append((
            label(found, i), *(number(x) for x in given), *(number(x, found.scale[i]) for x in forces[:, i]),
            number(found.accelerations[i]),
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


def struck(found: LagrangeResults, section: str) -> dict[str, Any]:
    """r' of a section in the first blow, if something strikes."""
    return {"r": found.blows[0].sections[section]} if found.blows else {}


COURSE = "OVER  ε and half its slope: C = ½ dε/dq q'²; k by cause at q' = {rate:.6g} {unit}, loads as at the start"


def write_course(found: InertiaCourse) -> str:
    """The page of a course as text."""
    lines = [("heun", f"{VERSION}  {found.title}")]
    kind, length = ("kg", "m") if found.is_length else ("kg·m²", "rad")
    low, high = int(np.argmin(found.epsilon)), int(np.argmax(found.epsilon))
    least, most = (f"{found.epsilon[i]:.6g} {kind} at {found.values[i]:.6g} {length}" for i in (low, high))
    lines.append(("inertia", f"ε mean {found.mean:.6g} {kind}, least {least}, largest {most}"))
    head = "".join(f"{label.ljust(7)}  {shown(text)}\n" for label, text in lines)
    return head + "\n" + "".join(plain(part, WIDTH) for part in fit(course_table(found), WIDTH))


def course_table(found: InertiaCourse) -> TextTable:
    """A row a value."""
    unit = "m" if found.is_length else "rad"
    kind, force = ("kg", "N") if found.is_length else ("kg·m²", "N·m")
    heads = [f"{found.name} [{unit}]", f"ε [{kind}]", f"½ dε/dq [{kind}/{unit}]", f"k [{force}]"]
    columns = [found.values, found.epsilon, found.half, found.total]
    for cause, k in found.forces.items():
        heads.append(f"{cause} [{force}]")
        columns.append(k)
    sizes = [float(np.abs(column).max(initial=0.0)) for column in columns]
    rows = tuple(tuple(number(x, size) for x, size in zip(row, sizes, strict=True)) for row in np.array(columns).T)
    heading = COURSE.format(rate=found.rate, unit=f"{unit}/s")
    return TextTable(heading, tuple(TextColumn(head) for head in heads), rows)


def course_block(found: InertiaCourse) -> dict[str, Any]:
    """As JSON has it: what lists over coordinates are of an instant, with an axis of the values before."""
    return {
        "title": found.title,
        "over": {"coordinate": found.name, "values": found.values.tolist()},
        "coordinates": [found.name],
        "units": ["m" if found.is_length else "rad"],
        "driven": [found.driven],
        "rates": [[found.rate]] * len(found.values),
        "epsilon": found.epsilon[:, None, None].tolist(),
        "eta": (1.0 / found.epsilon)[:, None, None].tolist(),
        "gamma": found.half[:, None, None, None].tolist(),
        "momenta": (found.epsilon * found.rate)[:, None].tolist(),
        "coriolis": (found.half * found.rate**2)[:, None].tolist(),
        "half_slope": found.half.tolist(),
        "forces": {
            "total": found.total[:, None].tolist(),
            "shares": {name: k[:, None].tolist() for name, k in found.forces.items()},
        },
        "mean": found.mean,
    }


def course_csv(found: InertiaCourse) -> str:
    """A line a value and quantity."""
    unit = "m" if found.is_length else "rad"
    kind, force = ("kg", "N") if found.is_length else ("kg·m²", "N·m")
    lines = ["coordinate,at,quantity,component,unit,value"]
    for i, value in enumerate(found.values.tolist()):
        head = f"{found.name},{value!r}"
        lines.append(f"{head},epsilon,,{kind},{float(found.epsilon[i])!r}")
        lines.append(f"{head},half_slope,,{kind}/{unit},{float(found.half[i])!r}")
        lines.append(f"{head},force,,{force},{float(found.total[i])!r}")
        lines += [f"{head},force,{name},{force},{float(k[i])!r}" for name, k in found.forces.items()]
    return "\n".join(lines) + "\n"


def block(found: LagrangeResults) -> dict[str, Any]:
    """As JSON has it: lists over the coordinates; gamma and alpha by i, l, k."""
    return {
        "title": found.title,
        "time": found.t,
        "coordinates": list(found.names),
        "units": ["m" if is_length else "rad" for is_length in found.lengths],
        "driven": list(found.driven),
        "values": [None if np.isnan(x) else float(x) for x in found.values],
        "rates": found.rates.tolist(),
        "accelerations": found.accelerations.tolist(),
        "epsilon": found.epsilon.tolist(),
        "eta": found.eta.tolist(),
        "gamma": None if found.gamma is None else found.gamma.tolist(),
        "alpha": None if found.alpha is None else found.alpha.tolist(),
        "momenta": found.momenta.tolist(),
        "energy": dict(zip(("total", "free", "mixed", "driven"), (found.energy, *found.energies), strict=True)),
        "reciprocal_energy": found.reciprocal_energy,
        "forces": {"total": found.total.tolist(), "shares": {name: k.tolist() for name, k in found.forces.items()}},
        "drives": found.drives.tolist(),
        "coriolis": found.coriolis.tolist(),
        "coriolis_matrix": found.coriolis_matrix.tolist(),
        "residual": found.residual,
        "seen": {one.name: {"unit": one.unit, "locked": one.locked, "free": one.free} for one in found.seen},
        "sections": {name: {**own, **struck(found, name)} for name, own in found.sections.items()},
        "blows": [
            {
                "time": blow.t,
                "h": blow.h.tolist(),
                "drives": blow.drives.tolist(),
                "jumps": blow.jumps.tolist(),
                "reciprocal_energy": blow.reciprocal_energy,
                "sections": dict(blow.sections),
            }
            for blow in found.blows
        ],
        "partials": dict(found.partials),
        "left_out": list(found.left_out),
        "state_space": None if found.state_space is None else linear_block(found.state_space),
        "notes": list(found.notes),
    }


def to_csv(found: LagrangeResults) -> str:
    """In long form, a line a number; of matrices the component names the second coordinate."""
    lines = [CSV_COLUMNS]
    units = {True: ("m", "m/s", "m/s²", "kg·m/s", "N"), False: ("rad", "rad/s", "rad/s²", "N·m·s", "N·m")}
    for i, name in enumerate(found.names):
        q, rate, acceleration, momentum, force = units[found.lengths[i]]
        for quantity, unit, values in (
            ("value", q, found.values), ("rate", rate, found.rates),
            ("acceleration", acceleration, found.accelerations),
            ("momentum", momentum, found.momenta), ("coriolis", force, found.coriolis), ("force", force, found.total),
            ("drive", force, found.drives),
        ):  # fmt: skip
            lines.append(f"{name},{quantity},,{unit},{float(values[i])!r}")
        for cause, k in found.forces.items():
            lines.append(f"{name},force,{cause},{force},{float(k[i])!r}")
        for j, other in enumerate(found.names):
            lines.append(f"{name},epsilon,{other},{mixed(found, i, j)},{float(found.epsilon[i, j])!r}")
    return "\n".join(lines) + "\n"


def mixed(found: LagrangeResults, i: int, j: int) -> str:
    """The unit of an entry of the mass matrix."""
    return ("kg·m²", "kg·m", "kg")[int(found.lengths[i]) + int(found.lengths[j])]


def linear_block(linear: StateSpace) -> dict[str, Any]:
    """A state space as JSON has it."""
    return {
        "A": linear.A.tolist(), "B": linear.B.tolist(), "C": linear.C.tolist(), "D": linear.D.tolist(),
        "states": list(linear.states), "inputs": list(linear.inputs), "outputs": list(linear.outputs),
        "units": dict(linear.units), "offset": linear.offset.tolist(),
    }  # fmt: skip


def to_m(linear: StateSpace) -> str:
    """A state space as a script for Matlab and Octave."""
    lines = ["% " + part for part in (f"heun {VERSION}", "x' = A x + B u, y = C x + D u")]
    for name, matrix in (("A", linear.A), ("B", linear.B), ("C", linear.C), ("D", linear.D)):
        rows = "; ".join(" ".join(repr(float(x)) for x in row) for row in matrix)
        size = f"zeros({matrix.shape[0]}, {matrix.shape[1]})"
        lines.append(f"{name} = [{rows}];" if matrix.size else f"{name} = {size};")
    for label, names in (("states", linear.states), ("inputs", linear.inputs), ("outputs", linear.outputs)):
        lines.append(f"{label} = {{{', '.join(repr(name) for name in names)}}};")
    lines.append(f"offset = [{'; '.join(repr(float(x)) for x in linear.offset)}];")
    return "\n".join(lines) + "\n"
