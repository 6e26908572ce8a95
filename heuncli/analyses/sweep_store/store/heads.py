"""What a sweep is of, as a store keeps it: JSON, and beside it what was drawn, as doubles."""

from __future__ import annotations

import json

import numpy as np

from heuncli.analyses.sweep_store.rows import SweepHead, SweptMeasure
from heuncli.analyses.variants.axes import Drawn, ParameterAxis
from heuncli.analyses.variants.plans import Draws, Plan

DOUBLES = np.dtype("<f8")


def texts_of_head(head: SweepHead) -> tuple[str, bytes | None]:
    """A head as JSON, and the values that are drawn, None where none are."""
    plan, draws = head.plan, head.plan.draws
    block = head._asdict() | {
        "measures": [tuple(one) for one in head.measures],
        "plan": plan._asdict() | {"draws": None if draws is None else draws._asdict() | {"values": draws.values.shape}},
    }
    return json.dumps(block), None if draws is None else draws.values.astype(DOUBLES).tobytes()


def head_of_texts(text: str, values: bytes | None) -> SweepHead:
    """The head that was kept."""
    block = json.loads(text)
    plan = block["plan"]
    axes, columns = (tuple(ParameterAxis(name, tuple(texts)) for name, texts in plan[of]) for of in ("axes", "columns"))
    draws = None
    if plan["draws"] is not None and values is not None:
        given = plan["draws"]
        drawn = np.frombuffer(values, DOUBLES).reshape(given["values"])
        draws = Draws(**{**given, "laws": tuple(Drawn(*law) for law in given["laws"]), "values": drawn})
    measures = tuple(SweptMeasure(*one) for one in block["measures"])
    made = Plan(**{**plan, "axes": axes, "columns": columns, "draws": draws})
    return SweepHead(**{**block, "measures": measures, "plan": made})
