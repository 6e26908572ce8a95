"""The machine as it was solved: the model in words, and its drawing."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from heuncli.output.client_report.parts import Drawing, Facts, Listing, Part, Sentence
from heuncli.output.client_report.reported import Reported
from heuncli.output.figures.courses import Pictured, is_claimed
from heuncli.output.figures.scenes import scene
from heuncli.output.tables.model_text import LISTS, facts
from heuncli.study.workflow import describe

ASSUMED = (
    "Bodies are rigid. Joints are ideal, without play, give or friction but for what the spec states; rods are without "
    "mass. Nothing acts but gravity and the loads that the spec states."
)
BESIDE = ("names", "notes")  # of a model, what runs do without


def drawing_parts(of: Reported) -> list[Part]:
    """The machine at its first instant, of the first case."""
    run = of.runs[0]
    if not is_claimed(run.study):
        return [Sentence("Nothing is claimed of where it is at the instants of the run: all are beyond its horizon.")]
    case = f", load case {run.name}" if run.name else ""
    figure = scene(Pictured("", run.study), of.units)._replace(title="")
    return [Drawing(figure, f"The machine at the start{case}")]


def model_parts(of: Reported) -> list[Part]:
    """The model that was solved, in the words of `heun model`."""
    study = of.runs[0].study
    told = describe(study.spec, reduce=of.reduce)
    model: Mapping[str, Any] = study.results.model | {key: told[key] for key in BESIDE}  # as it was solved
    parts: list[Part] = [Sentence(ASSUMED), Facts([fact for fact in facts(model) if fact[1]])]
    for key, title in LISTS:
        if model.get(key):
            parts.append(Listing(title, [str(sentence) for sentence in model[key]]))
    return parts
