"""Write and read the description of a sweep as a store holds it: JSON, and the draws as doubles."""

from __future__ import annotations

import json

import numpy as np

from heuncli.analyses.sweep_store.rows import SweepHead
from heuncli.analyses.variants.measures import MeasureLabel
from heuncli.analyses.variants.parameters import ParameterAxis, RandomVariable
from heuncli.analyses.variants.plans import Draws, Plan

DOUBLES = np.dtype("<f8")


def write_head(head: SweepHead) -> tuple[str, bytes | None]:
    """Return a head as JSON, and the draws, None if there are none."""
    plan, draws = head.plan, head.plan.draws
    block = head._asdict() | {
        "measures": [tuple(one) for one in head.measures],
        "plan": plan._asdict() | {"draws": None if draws is None else draws._asdict() | {"values": draws.values.shape}},
    }
    return json.dumps(block), None if draws is None else draws.values.astype(DOUBLES).tobytes()


def read_head(text: str, values: bytes | None) -> SweepHead:
    """Return the stored head."""
    block = json.loads(text)
    plan = block["plan"]
    axes, columns = (
        tuple(ParameterAxis(name, tuple(values), unit) for name, values, unit in plan[key])
        for key in ("axes", "columns")
    )
    draws = None
    if plan["draws"] is not None and values is not None:
        draws_block = plan["draws"]
        values_by_row = np.frombuffer(values, DOUBLES).reshape(draws_block["values"])
        draws = Draws(
            **{
                **draws_block,
                "laws": tuple(RandomVariable(*law) for law in draws_block["laws"]),
                "values": values_by_row,
            }
        )
    measures = tuple(MeasureLabel(*one) for one in block["measures"])
    stored_plan = Plan(**{**plan, "axes": axes, "columns": columns, "draws": draws})
    return SweepHead(**{**block, "measures": measures, "plan": stored_plan})
