"""The machine as it was solved: the model in words, and its drawing."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from heuncli.client_report.parts import Drawing, Facts, Listing, Part
from heuncli.client_report.reported import Reported
from heuncli.pictures.courses import Pictured
from heuncli.pictures.scenes import scene
from heuncli.report.model_text import LISTS, facts
from heuncli.study.workflow import describe

TIMED = frozenset({"integrates"})  # how long a run takes on the machine at hand


def drawing_parts(of: Reported) -> list[Part]:
    """The machine at its first instant, of the first case."""
    run = of.runs[0]
    case = f", load case {run.name}" if run.name else ""
    figure = scene(Pictured("", run.study), of.units)._replace(title="")
    return [Drawing(figure, f"The machine at the start{case}")]


def model_parts(of: Reported) -> list[Part]:
    """The model, as `heun model` tells it."""
    model: Mapping[str, Any] = describe(of.runs[0].study.spec, reduce=of.reduce)
    parts: list[Part] = [Facts([fact for fact in facts(model) if fact[1]])]
    for key, title in LISTS:
        if key not in TIMED and model.get(key):
            parts.append(Listing(title, [str(sentence) for sentence in model[key]]))
    return parts
