"""Every spec that comes with heun is drawn: a load, a coordinate, an energy; finite, and in letters, too."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import pytest

from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import solve_source
from heuncli.output.drawing.canvas import TerminalStyle
from heuncli.output.drawing.layout import lay_out
from heuncli.output.drawing.letters import draw_text
from heuncli.output.drawing.shapes import to_svg
from heuncli.output.figures.histories import make_history
from heuncli.results.results_schema import EVENTS, IMPULSES
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from heuncli.study.quantities.table_units import parse_units
from tests.shared.folders import ROOT

SPECS = sorted((ROOT / "specs").glob("*.yaml"))
WRONG = re.compile(r"\b(?:nan|inf)\b", re.IGNORECASE)


def paths_of(spec: Spec) -> list[str]:
    """What is drawn of a scene."""
    joints = [f"joints.{name}.{what}" for name in list(spec.joints)[:1] for what in ("force", "moment.z")]
    body = next(iter(spec.bodies))
    return [*joints, f"bodies.{body}.center.x", f"bodies.{body}.angular_velocity", "energy.kinetic"]


@pytest.mark.heavy
@pytest.mark.parametrize("file", SPECS, ids=lambda file: file.stem)
@pytest.mark.sixth
def test_it_is_drawn(file: str) -> None:
    spec = load(str(file), checking=False)
    paths = paths_of(spec)
    source = solve_source("", spec, [*paths, "coordinates", IMPULSES, EVENTS], PlotRequest((str(file),), quiet=True))
    for name, numbers in list(source.study.results.coordinates.items())[:1]:
        paths.append(f"coordinates.{name}.{next(iter(numbers))}")
    figure = make_history([source], paths, parse_units("kN,mm,deg"))
    text = to_svg(lay_out(figure))
    root = ElementTree.fromstring(text)
    numbers = [word for shape in root for word in re.split(r"[ ,]", shape.get("points", "")) if word]
    assert numbers and all(-1.0 <= float(word) <= 10_000.0 for word in numbers)
    assert not any(WRONG.search(shape.text or "") for shape in root.iter())
    assert to_svg(lay_out(figure)) == text
    for braille in (True, False):
        lines = draw_text(figure, TerminalStyle(90, braille, has_colours=False)).splitlines()
        assert max(map(len, lines)) <= 90 and not any(WRONG.search(line) for line in lines)
