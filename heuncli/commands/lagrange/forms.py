"""The Lagrange side of an instant as JSON, in long form, and as a script of matrices."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from heuncli.commands.lagrange.results import LagrangeResults, StateSpace
from heuncli.version import VERSION

CSV_COLUMNS = "name,quantity,component,unit,value"
ALWAYS = ("title", "time", "coordinates", "units", "driven", "notes")
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


def struck(found: LagrangeResults, section: str) -> dict[str, Any]:
    """r' of a section in the first blow, if something strikes."""
    return {"r": found.blows[0].sections[section]} if found.blows else {}
