"""The Lagrange side of an instant as JSON, in long form, and as a script of matrices."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from heuncli.analyses.lagrange.kinds import MIXED, units_of
from heuncli.analyses.lagrange.results import LagrangeResults, StateSpace
from heuncli.analyses.lagrange.section_forces import lists
from heuncli.base.joint_kinds import is_length
from heuncli.version import VERSION

CSV_COLUMNS = "name,quantity,component,unit,value"
ALWAYS = ("title", "time", "coordinates", "units", "driven", "notes")
PARTS = ("free", "mixed", "driven")  # of the energy
KEYS = {  # of JSON, by what --only names
    "equations": ("values", "rates", "accelerations", "momenta", "coriolis", "drives", "energy", "reciprocal_energy",
                  "residual"),
    "mass": ("epsilon", "seen", "left_out"),
    "reciprocal": ("eta",),
    "forces": ("forces", "coriolis_matrix"),
    "christoffel": ("gamma", "alpha"),
    "sections": ("sections",),
    "blows": ("blows",),
    "partials": ("partials",),
    "state_space": ("state_space",),
}  # fmt: skip


def beside_nan(x: float) -> float | None:
    """A number, or None."""
    return None if np.isnan(x) else float(x)


def block(found: LagrangeResults, only: Sequence[str] = ()) -> dict[str, Any]:
    """As JSON has it: lists over the coordinates; gamma and alpha by i, l, k. only: parts, by KEYS."""
    whole = everything(found)
    kept = {*ALWAYS, *(key for part in only for key in KEYS[part])}
    return {key: value for key, value in whole.items() if not only or key in kept}


def everything(found: LagrangeResults) -> dict[str, Any]:
    """All parts."""
    return {
        "title": found.title,
        "time": found.t,
        "coordinates": list(found.names),
        "units": [units_of(name).value for name in found.names],
        "driven": list(found.driven),
        "values": [beside_nan(x) for x in found.values],
        "rates": found.rates.tolist(),
        "accelerations": found.accelerations.tolist(),
        "epsilon": found.epsilon.tolist(),
        "eta": found.eta.tolist(),
        "gamma": None if found.gamma is None else found.gamma.tolist(),
        "alpha": None if found.alpha is None else found.alpha.tolist(),
        "momenta": found.momenta.tolist(),
        "energy": {
            "total": found.energy,
            **{name: beside_nan(x) for name, x in zip(PARTS, found.energies, strict=True)},
        },
        "reciprocal_energy": found.reciprocal_energy,
        "forces": {"total": found.total.tolist(), "shares": {name: k.tolist() for name, k in found.forces.items()}},
        "drives": found.drives.tolist(),
        "coriolis": found.coriolis.tolist(),
        "coriolis_matrix": found.coriolis_matrix.tolist(),
        "residual": found.residual,
        "seen": {one.name: {"unit": one.unit, "locked": one.locked, "free": one.free} for one in found.seen},
        "sections": {name: {"s": lists(own), **struck(found, name)} for name, own in found.sections.items()},
        "blows": [
            {
                "time": blow.t,
                "h": blow.h.tolist(),
                "drives": blow.drives.tolist(),
                "jumps": blow.jumps.tolist(),
                "reciprocal_energy": blow.reciprocal_energy,
                "sections": {name: lists(own) for name, own in blow.sections.items()},
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
    for i, name in enumerate(found.names):
        units = units_of(name)
        for quantity, unit, values in (
            ("value", units.value, found.values), ("rate", units.rate, found.rates),
            ("acceleration", units.acceleration, found.accelerations), ("momentum", units.momentum, found.momenta),
            ("coriolis", units.force, found.coriolis), ("force", units.force, found.total),
            ("drive", units.force, found.drives),
        ):  # fmt: skip
            lines.append(f"{name},{quantity},,{unit},{float(values[i])!r}")
        for cause, k in found.forces.items():
            lines.append(f"{name},force,{cause},{units.force},{float(k[i])!r}")
        for j, other in enumerate(found.names):
            unit = units.inertia if is_length(name) == is_length(other) else MIXED
            lines.append(f"{name},epsilon,{other},{unit},{float(found.epsilon[i, j])!r}")
    return "\n".join(lines) + "\n"


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


def struck(found: LagrangeResults, section: str) -> dict[str, Any]:
    """r' of a section in the first blow, if something strikes."""
    return {"r": lists(found.blows[0].sections[section])} if found.blows else {}
