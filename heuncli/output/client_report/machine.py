"""The chapters on the machine: its figure, and the model in words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from heuncli.output.client_report.report_data import ReportData
from heuncli.output.documents.document import Drawing, Part, Sentence
from heuncli.output.figures.courses import FigureSource, is_claimed
from heuncli.output.figures.scenes import make_scene_figure
from heuncli.output.tables.model_text import make_description_parts
from heuncli.study.workflow import describe

ASSUMPTIONS = (
    "Bodies are rigid. Joints are ideal, without clearance, compliance or friction unless the spec states otherwise; "
    "rods are massless. Only gravity and the loads stated in the spec act."
)
DESCRIBED_KEYS = ("names", "notes")  # keys of a model's description that results do not have


def make_drawing_parts(data: ReportData) -> list[Part]:
    """Make the figure of the machine at the instant of the greatest joint force of the first case."""
    run = data.runs[0]
    if not is_claimed(run.study):
        return [Sentence("No positions are claimed: all output times are past the horizon.")]
    case = f", load case {run.name}" if run.name else ""
    figure = make_scene_figure(FigureSource("", run.study), data.units)
    return [Drawing(figure._replace(title="", words=()), f"The machine{case}, {figure.words[0]}")]


def make_model_parts(data: ReportData) -> list[Part]:
    """Make the description of the model that was solved, in the words of `heun model`."""
    study = data.runs[0].study
    description = describe(study.spec, reduce=data.reduce)
    # as it was solved
    model: Mapping[str, Any] = study.results.model | {key: description[key] for key in DESCRIBED_KEYS}
    return [Sentence(ASSUMPTIONS), *make_description_parts(model)]
