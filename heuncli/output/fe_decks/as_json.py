"""Write load cases as JSON: the body, and each case with its loads, the acceleration of its origin, and the unbalanced
sums.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from heuncli.analyses.load_cases.model import LoadCase, LoadCases
from heuncli.output.documents.as_json import dump_json
from heuncli.output.fe_decks.naming import DeckNames


def written(cases: LoadCases, names: DeckNames) -> Iterator[str]:
    """Yield one JSON object."""
    body = cases.body
    yield dump_json({
        "heun": 1,
        "title": cases.title,
        "spec": {"path": cases.spec, "sha256": cases.digest},
        "version": cases.version,
        "units": dict(zip(("force", "length", "mass", "time"), cases.units, strict=True)),
        "axes": "body",
        "body": {"name": body.name, "mass": body.mass, "center": body.center, "inertia": body.inertia},
        "estimate": {"reactions": cases.estimate},
        **({"split": cases.split} if cases.split else {}),
        "cases": [_case_to_dict(cases, case) for case in cases.cases],
    })  # fmt: skip


def _case_to_dict(cases: LoadCases, case: LoadCase) -> dict[str, Any]:
    sums, f = cases.body.compute_sums(case), case.field
    field: dict[str, Any] = {
        "acceleration": f.origin, "gravity": f.gravity, "angular_velocity": f.angular_velocity,
        "angular_acceleration": f.angular_acceleration,
    }  # fmt: skip
    if case.is_impulse:
        field = {"velocity_jump": f.origin, "angular_velocity_jump": f.angular_acceleration}
    return {
        "name": case.name,
        "time": case.time,
        "blow": case.is_impulse,
        **({"blow_over": case.averaging_time} if case.averaging_time is not None else {}),
        "loads": [
            {"kind": one.kind, "name": one.name, "by": one.source, "point": one.point or None, "position": one.at,
             "force": one.force, "moment": one.moment,
             **({"force_per_length": one.per_length} if one.per_length is not None else {})}
            for one in case.actions
        ],
        "origin": field,
        "sums": {"force": sums.force, "moment": sums.moment, "relative": cases.body.balance(case).relative},
    }  # fmt: skip
