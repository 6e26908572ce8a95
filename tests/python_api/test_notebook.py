"""What a notebook shows of a solved scene: its tables as a part of a page, diagrams, frames."""

from __future__ import annotations

import builtins
import importlib.util
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import heuncli
from tests.shared.folders import SPECS

HOSTILE = "</h3><script>alert(1)</script>&lt;\" onload='x' \u202e"
SCENE: dict[str, Any] = {
    "heun": 1,
    "title": HOSTILE,
    "gravity": [0, 0, -9.81],
    "ground": {"points": {"O": [0, 0, 0]}},
    "bodies": {"bar": {"mass": 1, "center": [0, 0, -0.5], "inertia": [0.08, 0.08, 0.001], "points": {"t": [0, 0, 0]}}},
    "joints": {"pivot": {"type": "pin", "axis": [1, 0, 0], "from": "ground.O", "to": "bar.t", "initial": {"angle": 1}}},
    "analysis": {"duration": 1, "samples": 11},
}
TAGS = {"div", "style", "h3", "small", "p", "ul", "li", "table", "thead", "tbody", "tr", "th", "td"}


class Fragment(HTMLParser):
    """The elements and texts of a part of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.texts: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts += [data] if self.open[-1:] != ["style"] else []


@pytest.fixture(scope="module")
def study() -> heuncli.Solved:
    return heuncli.solve(SCENE)


def test_a_hostile_title_is_text(study: heuncli.Solved) -> None:
    shown = Fragment(study._repr_html_())
    assert not shown.open and {tag for tag, _ in shown.tags} <= TAGS
    assert {name for _, attrs in shown.tags for name in attrs} <= {"class", "colspan", "scope", "aria-label"}
    assert HOSTILE.replace("\u202e", "\\u202e") in shown.texts
    drawn = study.plot("joints.pivot.force")._repr_svg_()
    assert "<script" not in drawn and "\u202e" not in drawn
    assert {each.tag.rpartition("}")[2] for each in ElementTree.fromstring(drawn).iter()} & {"script"} == set()
    assert HOSTILE.replace("\u202e", "") not in drawn and "\u202e" not in str(study)


def test_the_cells_are_those_of_the_tables() -> None:
    study = heuncli.solve(SPECS / "overhang.yaml")
    shown = {text.strip() for text in Fragment(study._repr_html_()).texts}
    words = [word for line in str(study).splitlines()[1:] for word in line.split("  ") if word.strip()]
    numbers = {word.strip() for word in words if word.strip().lstrip("-")[:1].isdecimal()}
    assert len(numbers) > 10 and numbers <= {part.strip() for text in shown for part in [text, *text.split("  ")]}


def test_tables_at_instants(study: heuncli.Solved) -> None:
    some = study.at([0.25, 0.75])
    assert "0.25" in str(some) and "0.75" in some._repr_html_() and np.array_equal(some.time, [0.25, 0.75])
    assert "between the samples" not in str(some)


def test_a_diagram_and_its_files(study: heuncli.Solved, tmp_path: Path) -> None:
    diagram = study.plot("joints.pivot.force.z", "joints.pivot.force.y", units="kN")
    assert diagram.svg.startswith("<?xml") and diagram._repr_svg_().startswith("<svg") and "[kN]" in diagram.svg
    diagram.save(tmp_path / "a.svg")
    assert (tmp_path / "a.svg").read_text(encoding="utf-8") == diagram.svg
    assert "pivot, angle" in study.plot("coordinates.pivot.rate", over="coordinates.pivot.angle").svg.lower()
    with pytest.raises(heuncli.UsageError, match=r"accepted file extensions: .svg, .png, .pdf"):
        diagram.save(tmp_path / "a.gif")


@pytest.fixture
def without_pandas(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    found, own = importlib.util.find_spec, builtins.__import__

    def refuse(name: str, *more: Any, **named: Any) -> Any:
        if name.partition(".")[0] == "pandas":
            raise ImportError(name)
        return own(name, *more, **named)

    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name, *more: None if name == "pandas" else found(name, *more)
    )
    monkeypatch.setattr(builtins, "__import__", refuse)
    yield


@pytest.mark.usefixtures("without_pandas")
def test_without_pandas_there_is_a_plain_refusal(study: heuncli.Solved) -> None:
    with pytest.raises(heuncli.UsageError) as caught:
        study.frame()
    (problem,) = caught.value.problems
    assert problem.code == "missing-extra" and problem.hint.startswith('pip install "heuncli[pandas]"')


@pytest.mark.heavy
def test_a_frame(study: heuncli.Solved) -> None:
    pandas = pytest.importorskip("pandas")
    frame = study.frame("joints.pivot.force", "energy.kinetic")
    assert isinstance(frame, pandas.DataFrame)
    assert [*frame.columns] == [*(f"joints.pivot.force.{axis}" for axis in "xyz"), "energy.kinetic"]
    assert (frame.index.name, [*frame.index]) == ("time", [*study.time])
    assert np.array_equal(frame["joints.pivot.force.z"], study["joints.pivot.force.z"])
    assert frame.attrs["units"]["energy.kinetic"] == "J"
    assert frame.attrs["errors"]["joints.pivot.force.x"] == study["joints.pivot.force"].error
    assert [*study.frame("energy.kinetic", units=True).columns] == ["energy.kinetic [J]"]
    frame.loc[0.0, "energy.kinetic"] = 7.0  # its own numbers, not those of the run
    assert study["energy.kinetic"][0] != 7.0
    whole = heuncli.solve(SPECS / "struck_door.yaml").frame()
    assert whole.shape[0] == 51 and "joints.low.force.x" in whole and not [c for c in whole if c.startswith("impulses")]
