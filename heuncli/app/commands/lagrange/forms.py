"""Convert Lagrange's equations at an instant to JSON, to long form, and to a script of matrices."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from heuncli.analyses.lagrange.equations import to_lists
from heuncli.analyses.lagrange.results import (
    MIXED_INERTIA_UNIT,
    InertiaCurve,
    LagrangeResults,
    StateSpace,
    get_units,
)
from heuncli.base.joint_kinds import is_length
from heuncli.output.documents.as_data import make_columns
from heuncli.output.documents.document import Cell
from heuncli.version import VERSION

CSV_COLUMNS = make_columns("name quantity component unit value")
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


def nan_to_none(x: float) -> float | None:
    """Return the number, or None for nan."""
    return None if np.isnan(x) else float(x)


def to_block(results: LagrangeResults, parts: Sequence[str] = ()) -> dict[str, Any]:
    """Return the results as the JSON has them: lists over the coordinates; gamma and alpha by i, l, k.

    parts: the parts to keep, by KEYS; empty: all
    """
    whole = make_full_block(results)
    keys = {*ALWAYS, *(key for part in parts for key in KEYS[part])}
    return {key: value for key, value in whole.items() if not parts or key in keys}


def make_full_block(results: LagrangeResults) -> dict[str, Any]:
    """Return all parts of the JSON."""
    return {
        "title": results.title,
        "time": results.t,
        "coordinates": list(results.names),
        "units": [get_units(name).value for name in results.names],
        "driven": list(results.is_driven),
        "values": [nan_to_none(x) for x in results.values],
        "rates": results.rates.tolist(),
        "accelerations": results.accelerations.tolist(),
        "epsilon": results.epsilon.tolist(),
        "eta": results.eta.tolist(),
        "gamma": None if results.gamma is None else results.gamma.tolist(),
        "alpha": None if results.alpha is None else results.alpha.tolist(),
        "momenta": results.momenta.tolist(),
        "energy": {
            "total": results.energy,
            **{name: nan_to_none(x) for name, x in zip(PARTS, results.energies, strict=True)},
        },
        "reciprocal_energy": results.reciprocal_energy,
        "forces": {
            "total": results.total_force.tolist(),
            "shares": {name: k.tolist() for name, k in results.forces.items()},
        },
        "drives": results.drives.tolist(),
        "coriolis": results.coriolis.tolist(),
        "coriolis_matrix": results.coriolis_matrix.tolist(),
        "residual": results.residual,
        "seen": {
            inertia.name: {"unit": inertia.unit, "locked": inertia.others_locked, "free": inertia.others_free}
            for inertia in results.apparent_inertias
        },
        "sections": {
            name: {"s": to_lists(section), **make_impulse_block(results, name)}
            for name, section in results.sections.items()
        },
        "blows": [
            {
                "time": impulse.t,
                "h": impulse.h.tolist(),
                "drives": impulse.drives.tolist(),
                "jumps": impulse.jumps.tolist(),
                "reciprocal_energy": impulse.reciprocal_energy,
                "sections": {name: to_lists(section) for name, section in impulse.sections.items()},
            }
            for impulse in results.impulses
        ],
        "partials": dict(results.partials),
        "left_out": list(results.left_out),
        "state_space": None if results.state_space is None else make_state_space_block(results.state_space),
        "notes": list(results.notes),
    }


def iter_records(results: LagrangeResults) -> Iterator[tuple[Cell, ...]]:
    """Yield the results in long form, one number per row; for matrices the component names the second coordinate."""
    for i, name in enumerate(results.names):
        units = get_units(name)
        for quantity, unit, values in (
            ("value", units.value, results.values), ("rate", units.rate, results.rates),
            ("acceleration", units.acceleration, results.accelerations), ("momentum", units.momentum, results.momenta),
            ("coriolis", units.force, results.coriolis), ("force", units.force, results.total_force),
            ("drive", units.force, results.drives),
        ):  # fmt: skip
            yield name, quantity, "", unit, float(values[i])
        for cause, k in results.forces.items():
            yield name, "force", cause, units.force, float(k[i])
        for j, other in enumerate(results.names):
            unit = units.inertia if is_length(name) == is_length(other) else MIXED_INERTIA_UNIT
            yield name, "epsilon", other, unit, float(results.epsilon[i, j])


def make_state_space_block(linear: StateSpace) -> dict[str, Any]:
    """Return a state space as the JSON has it."""
    return {
        "A": linear.A.tolist(), "B": linear.B.tolist(), "C": linear.C.tolist(), "D": linear.D.tolist(),
        "states": list(linear.states), "inputs": list(linear.inputs), "outputs": list(linear.outputs),
        "units": dict(linear.units), "offset": linear.offset.tolist(),
    }  # fmt: skip


def to_m(linear: StateSpace) -> str:
    """Return a state space as a script for Matlab and Octave."""
    lines = ["% " + part for part in (f"heun {VERSION}", "x' = A x + B u, y = C x + D u")]
    for name, matrix in (("A", linear.A), ("B", linear.B), ("C", linear.C), ("D", linear.D)):
        rows = "; ".join(" ".join(repr(float(x)) for x in row) for row in matrix)
        size = f"zeros({matrix.shape[0]}, {matrix.shape[1]})"
        lines.append(f"{name} = [{rows}];" if matrix.size else f"{name} = {size};")
    for label, names in (("states", linear.states), ("inputs", linear.inputs), ("outputs", linear.outputs)):
        lines.append(f"{label} = {{{', '.join(repr(name) for name in names)}}};")
    lines.append(f"offset = [{'; '.join(repr(float(x)) for x in linear.offset)}];")
    return "\n".join(lines) + "\n"


def make_impulse_block(results: LagrangeResults, section: str) -> dict[str, Any]:
    """Return r' of a section in the first impulse, or nothing if there is no impulse."""
    return {"r": to_lists(results.impulses[0].sections[section])} if results.impulses else {}


COURSE_CSV_COLUMNS = make_columns("coordinate at quantity component unit value")


def to_course_block(course: InertiaCurve) -> dict[str, Any]:
    """Return the course as the JSON has it: lists over the coordinates have an additional first axis over the
    values.
    """
    return {
        "title": course.title,
        "over": {"coordinate": course.name, "values": course.values.tolist()},
        "coordinates": [course.name],
        "units": [get_units(course.name).value],
        "driven": [course.is_driven],
        "rates": [[course.rate]] * len(course.values),
        "epsilon": course.epsilon[:, None, None].tolist(),
        "eta": (1.0 / course.epsilon)[:, None, None].tolist(),
        "gamma": course.half[:, None, None, None].tolist(),
        "momenta": (course.epsilon * course.rate)[:, None].tolist(),
        "coriolis": (course.half * course.rate**2)[:, None].tolist(),
        "half_slope": course.half.tolist(),
        "forces": {
            "total": course.total_force[:, None].tolist(),
            "shares": {name: k[:, None].tolist() for name, k in course.forces.items()},
        },
        "mean": None if np.isnan(course.mean) else course.mean,
    }


def iter_course_records(course: InertiaCurve) -> Iterator[tuple[Cell, ...]]:
    """Yield the course in long form, one row per value and quantity."""
    unit_set = get_units(course.name)
    for i, value in enumerate(course.values.tolist()):
        lead = (course.name, value)
        yield *lead, "epsilon", "", unit_set.inertia, float(course.epsilon[i])
        yield *lead, "half_slope", "", unit_set.slope, float(course.half[i])
        yield *lead, "force", "", unit_set.force, float(course.total_force[i])
        for name, k in course.forces.items():
            yield *lead, "force", name, unit_set.force, float(k[i])
