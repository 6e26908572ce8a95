"""The inertia and the forces over a range, as a table, as JSON, and in long form."""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.commands.lagrange.kinds import units_of
from heuncli.commands.lagrange.page import number
from heuncli.commands.lagrange.results import InertiaCourse
from heuncli.foreign_text import shown
from heuncli.report.page_width import fit
from heuncli.report.table_units import Units
from heuncli.report.text_table import WIDTH, TextColumn, TextTable, head, plain
from heuncli.version import VERSION

COURSE = "OVER  ε and half its slope: C = ½ dε/dq q'²; k by cause at q' = {rate:.6g} {unit}, loads as at the start"


def write(found: InertiaCourse, shown_in: Units) -> str:
    """The page of a course as text, in units."""
    lines = [("heun", f"{VERSION}  {found.title}")]
    own = units_of(found.name)
    unit, size = shown_in.of(own.value)
    low, high = int(np.argmin(found.epsilon)), int(np.argmax(found.epsilon))
    least, most = (f"{found.epsilon[i]:.6g} {own.inertia} at {found.values[i] * size:.6g} {unit}" for i in (low, high))
    lines.append(("inertia", f"ε mean {found.mean:.6g} {own.inertia}, least {least}, largest {most}"))
    above = "".join(f"{label.ljust(7)}  {shown(text)}\n" for label, text in lines)
    return above + "\n" + "".join(plain(part, WIDTH) for part in fit(table(found, shown_in), WIDTH))


def table(found: InertiaCourse, shown_in: Units) -> TextTable:
    """A row a value."""
    own = units_of(found.name)
    named = [
        (found.name, own.value, found.values),
        ("ε", own.inertia, found.epsilon),
        ("½ dε/dq", own.slope, found.half),
    ]
    named += [(name, own.force, k) for name, k in {"k": found.total, **found.forces}.items()]
    heads, columns = [], []
    for name, unit, values in named:
        shown_unit, size = shown_in.of(unit)
        heads.append(head(name, shown_unit))
        columns.append(values * size)
    sizes = [float(np.abs(column).max(initial=0.0)) for column in columns]
    rows = tuple(tuple(number(x, size) for x, size in zip(row, sizes, strict=True)) for row in np.array(columns).T)
    unit, size = shown_in.of(own.rate)
    return TextTable(COURSE.format(rate=found.rate * size, unit=unit), tuple(map(TextColumn, heads)), rows)


def block(found: InertiaCourse) -> dict[str, Any]:
    """As JSON has it: what lists over coordinates are of an instant, with an axis of the values before."""
    return {
        "title": found.title,
        "over": {"coordinate": found.name, "values": found.values.tolist()},
        "coordinates": [found.name],
        "units": [units_of(found.name).value],
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


def to_csv(found: InertiaCourse) -> str:
    """A line a value and quantity."""
    own = units_of(found.name)
    lines = ["coordinate,at,quantity,component,unit,value"]
    for i, value in enumerate(found.values.tolist()):
        head = f"{found.name},{value!r}"
        lines.append(f"{head},epsilon,,{own.inertia},{float(found.epsilon[i])!r}")
        lines.append(f"{head},half_slope,,{own.slope},{float(found.half[i])!r}")
        lines.append(f"{head},force,,{own.force},{float(found.total[i])!r}")
        lines += [f"{head},force,{name},{own.force},{float(k[i])!r}" for name, k in found.forces.items()]
    return "\n".join(lines) + "\n"
