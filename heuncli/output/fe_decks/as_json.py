"""Load cases as JSON: the body, and each case with its loads, the acceleration of its origin, and what is left over."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from heuncli.analyses.load_cases.model import LoadCase, LoadCases
from heuncli.output.fe_decks.naming import DeckNames
from heuncli.output.tables.export import dump


def written(cases: LoadCases, names: DeckNames) -> Iterator[str]:
    """One object."""
    body = cases.body
    yield dump({
        "heun": 1,
        "title": cases.title,
        "spec": {"path": cases.spec, "sha256": cases.digest},
        "version": cases.version,
        "units": dict(zip(("force", "length", "mass", "time"), cases.units, strict=True)),
        "axes": "body",
        "body": {"name": body.name, "mass": body.mass, "center": body.center, "inertia": body.inertia},
        "estimate": {"reactions": cases.estimate},
        **({"split": cases.split} if cases.split else {}),
        "cases": [_case(cases, case) for case in cases.cases],
    })  # fmt: skip


def _case(cases: LoadCases, case: LoadCase) -> dict[str, Any]:
    sums, f = cases.body.sums(case), case.field
    field: dict[str, Any] = {
        "acceleration": f.origin, "gravity": f.gravity, "angular_velocity": f.angular_velocity,
        "angular_acceleration": f.angular_acceleration,
    }  # fmt: skip
    if case.struck:
        field = {"velocity_jump": f.origin, "angular_velocity_jump": f.angular_acceleration}
    return {
        "name": case.name,
        "time": case.time,
        "blow": case.struck,
        **({"blow_over": case.over} if case.over is not None else {}),
        "loads": [
            {"kind": one.kind, "name": one.name, "by": one.by, "point": one.point or None, "position": one.at,
             "force": one.force, "moment": one.moment,
             **({"force_per_length": one.per_length} if one.per_length is not None else {})}
            for one in case.actions
        ],
        "origin": field,
        "sums": {"force": sums.force, "moment": sums.moment, "relative": cases.body.balance(case).relative},
    }  # fmt: skip
