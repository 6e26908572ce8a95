"""The inertia and the forces over a range, as a table, as JSON, and in long form."""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.commands.lagrange.page import number
from heuncli.commands.lagrange.results import InertiaCourse
from heuncli.foreign_text import shown
from heuncli.report.page_width import fit
from heuncli.report.text_table import WIDTH, TextColumn, TextTable, plain
from heuncli.version import VERSION

COURSE = "OVER  ε and half its slope: C = ½ dε/dq q'²; k by cause at q' = {rate:.6g} {unit}, loads as at the start"


def write(found: InertiaCourse) -> str:
    """The page of a course as text."""
    lines = [("heun", f"{VERSION}  {found.title}")]
    kind, length = ("kg", "m") if found.is_length else ("kg·m²", "rad")
    low, high = int(np.argmin(found.epsilon)), int(np.argmax(found.epsilon))
    least, most = (f"{found.epsilon[i]:.6g} {kind} at {found.values[i]:.6g} {length}" for i in (low, high))
    lines.append(("inertia", f"ε mean {found.mean:.6g} {kind}, least {least}, largest {most}"))
    head = "".join(f"{label.ljust(7)}  {shown(text)}\n" for label, text in lines)
    return head + "\n" + "".join(plain(part, WIDTH) for part in fit(table(found), WIDTH))


def table(found: InertiaCourse) -> TextTable:
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


def block(found: InertiaCourse) -> dict[str, Any]:
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


def to_csv(found: InertiaCourse) -> str:
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
