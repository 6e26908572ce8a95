"""The inertia and the forces over a range, as a table, as JSON, and in long form."""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.analyses.lagrange.kinds import LENGTH, units_of
from heuncli.analyses.lagrange.results import InertiaCourse
from heuncli.app.commands.lagrange.page import number
from heuncli.output.tables.page_width import fit
from heuncli.output.tables.text_table import WIDTH, TextColumn, TextTable, head, labelled, plain
from heuncli.study.quantities.labels import distinguish
from heuncli.study.quantities.table_units import Units
from heuncli.version import VERSION

TOTAL = "k"
COURSE = "OVER  ε and half its slope: C = ½ dε/dq q'²; k by cause at q' = {rate:.6g} {unit}, loads as at the start"


def write(found: InertiaCourse, shown_in: Units) -> str:
    """The page of a course as text, in units."""
    lines = [("heun", f"{VERSION}  {found.title}")]
    own = units_of(found.name)
    unit, size = shown_in.of(own.value)
    low, high = int(np.argmin(found.epsilon)), int(np.argmax(found.epsilon))
    least, most = (f"{found.epsilon[i]:.6g} {own.inertia} at {found.values[i] * size:.6g} {unit}" for i in (low, high))
    mean = "has no mean that settles" if np.isnan(found.mean) else f"mean {found.mean:.6g} {own.inertia} over the range"
    lines.append(("inertia", f"ε {mean}; of the values least {least}, largest {most}"))
    return labelled(lines) + "\n" + "".join(plain(part, WIDTH) for part in fit(table(found, shown_in), WIDTH))


def table(found: InertiaCourse, shown_in: Units) -> TextTable:
    """A row a value."""
    own = units_of(found.name)
    per = np.abs(found.values).max() if own is LENGTH else 1.0
    most = float(found.epsilon.max())
    named = [
        (found.name, own.value, found.values, 0.0),
        ("ε", own.inertia, found.epsilon, 0.0),
        ("½ dε/dq", own.slope, found.half, most / per),
    ]
    forces = [(TOTAL, found.total), *((distinguish(name, (TOTAL,)), k) for name, k in found.forces.items())]
    named += [(name, own.force, k, found.reach) for name, k in forces]
    heads, cells = [], []
    for name, unit, values, scale in named:
        shown_unit, size = shown_in.of(unit)
        heads.append(head(name, shown_unit))
        largest = max(scale, float(np.abs(values).max(initial=0.0)))
        cells.append([number(x * size, largest * size) for x in values])
    rows = tuple(zip(*cells, strict=True))
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
        "mean": None if np.isnan(found.mean) else found.mean,
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
