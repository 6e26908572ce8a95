"""The figure of a chart: runs where their time and error say, the front, failures with notes, nothing from outside."""

from __future__ import annotations

import xml.etree.ElementTree as tree
from itertools import pairwise

import numpy as np
import pytest

from heuncli.base.errors import HeunError
from heuncli.base.records import replace
from heuncli.base.text_safety import escape
from heuncli.base.tolerances import LOST
from heuncli.output.documents.as_text import draw_figure
from heuncli.output.documents.document import make_panels
from heuncli.output.drawing import drawing_files
from heuncli.output.drawing.figure import Figure, Panel, Spot, Strokes, Trace
from heuncli.output.drawing.layout import lay_out
from heuncli.output.drawing.shapes import Area, Line, VectorDrawing, to_svg
from heuncli.output.drawing.style import find_pen
from heuncli.output.figures.work_precision import FAILURES_TITLE, REFERENCE_LABEL, make_work_precision_figure
from tests.shared.fake_charts import FAILS, REFERENCE, TOO_LONG, chart, run

SVG = "{http://www.w3.org/2000/svg}"
METHODS = ("Euler", "Heun2", "Heun3", "RK4", "DOPRI5", "DOP853", "Verner98", "Gauss4", "Gauss6", "Radau5", "Radau9")
MANY = chart(
    *(run(m, 1e-4 * (1 + i) * 3**k, 10.0 ** (-3 - k) / (i + 1), local=10.0**-k) for i, m in enumerate(METHODS)
      for k in range(5)),
    FAILS, TOO_LONG,
)  # fmt: skip
FIGURE = make_work_precision_figure(MANY)


def svg(figure: Figure = FIGURE) -> str:
    return to_svg(lay_out(figure))


def spots(panel: Panel) -> list[Spot]:
    return [item for item in panel.items if isinstance(item, Spot)]


def test_it_is_xml_with_its_text_as_text() -> None:
    root = tree.fromstring(svg().encode())
    texts = [e.text or "" for e in root.iter(f"{SVG}text")]
    assert root.findtext(f"{SVG}title") == "A scene: speed against accuracy" == texts[0]
    assert set(METHODS) <= set(texts) and any("agree: motion to 1e-13" in t for t in texts)
    assert "1e−6" in texts and "10" in texts and "processor time of the integration only [ms]" in texts


def test_nothing_comes_from_outside() -> None:
    text = svg()
    assert "script" not in text and "href" not in text and "@font" not in text and "url(" not in text
    assert text.count("http") == 1  # the name of the format


@pytest.mark.parametrize("title", ["a < b & c > d", "bell \x07, quote \" and ' ", "Ökonomie µ × é", "", "w" * 300])
def test_any_title_is_held(title: str) -> None:
    root = tree.fromstring(svg(make_work_precision_figure(replace(MANY, title=title))).encode())
    assert (root.findtext(f"{SVG}title") or "").startswith(escape(title))


def test_all_shapes_lie_in_the_drawing() -> None:
    made = lay_out(FIGURE)
    for shape in made.shapes:
        at = shape.points if isinstance(shape, Line | Area) else [(shape.x, shape.y)]
        assert all(0.0 <= x <= made.width and 0.0 <= y <= made.height for x, y in at)


def test_curves_pass_through_the_runs() -> None:
    traces = {item.name: item for item in FIGURE.panels[-1].items if isinstance(item, Trace)}
    for name, runs in MANY.runs_by_method.items():
        completed = [one for one in runs if one.status == "completed"]
        assert traces[name].x.tolist() == [1e3 * (one.seconds or 0.0) for one in completed]
        assert traces[name].y.tolist() == [one.error["motion"] for one in completed]


def test_each_method_has_a_look_of_its_own() -> None:
    looks = {(find_pen(pen).colour, find_pen(pen).dash, shape) for _, pen, shape in FIGURE.marks}
    assert len(looks) == len(METHODS) and len({look[::2] for look in looks}) == len(METHODS)
    assert len({find_pen(k).letter for k in range(26)}) == 26
    assert len({(find_pen(k).colour, find_pen(k).dash) for k in range(26)}) == 26


def test_failures_stand_in_rows_of_their_own_with_their_reasons() -> None:
    failures, errors = FIGURE.panels
    assert failures.title == FAILURES_TITLE and (failures.x.low, failures.x.high) == (errors.x.low, errors.x.high)
    assert [(spot.x, spot.y) for spot in spots(failures)] == [(0.1, 1.0), (failures.x.high, 0.0)]
    assert dict(failures.y.tick_texts) == {1.0: "× 1", 0.0: "× 2"}
    assert any(t.startswith("× 1  Euler, step 0.01 s: fails at t = 0.25 s: no finite") for t in FIGURE.notes)
    assert any(t.startswith("× 2  Euler, step") and "not run: about 2e9 steps" in t for t in FIGURE.notes)
    without = make_work_precision_figure(chart(run("A", 1e-3, 1e-4)))
    assert len(without.panels) == 1 and not any("×" in note for note in without.notes)


def test_the_front_is_filled_and_joined_from_fast_to_accurate() -> None:
    strokes = next(item for item in FIGURE.panels[-1].items if isinstance(item, Strokes)).ends
    points = np.concatenate([strokes[:, 0], strokes[-1:, 1]])
    assert all(a[0] < b[0] and a[1] > b[1] for a, b in pairwise(points.tolist()))
    filled = sorted((spot.x, spot.y) for spot in spots(FIGURE.panels[-1]) if spot.is_filled)
    assert filled == [tuple(point) for point in points.tolist()] and len(filled) == sum(one.front for one in MANY.runs)


@pytest.mark.parametrize("error", [1e300, 50.0])
def test_what_is_lost_stands_at_the_border(error: float) -> None:
    figure = make_work_precision_figure(chart(run("A", 1e-3, error), run("A", 1e-2, 1e-8)))
    assert figure.panels[-1].y.high == LOST == spots(figure.panels[-1])[0].y
    assert any(note.startswith("At the upper edge") for note in figure.notes)


def test_charts_of_failures_alone_and_without_an_error_of_the_reference_can_be_drawn() -> None:
    assert "× 1" in svg(make_work_precision_figure(chart(FAILS, TOO_LONG)))
    exact = replace(REFERENCE, error={**REFERENCE.error, "motion": None})
    assert REFERENCE_LABEL in svg() and REFERENCE_LABEL not in svg(
        make_work_precision_figure(chart(run("A", 1e-3, 1e-4), reference=exact))
    )


def test_below_the_table_letters_stand_where_time_and_error_say() -> None:
    made = make_work_precision_figure(chart(run("A", 1e-3, 1e-4), run("A", 1e-2, 1e-8), run("B", 1e-1, 1e-4), FAILS))
    lines = draw_figure(make_panels(made)[0].figure).splitlines()
    assert lines[0] == "a A   b B   c Euler" and max(map(len, lines)) <= 100
    row = {line.split("│")[0].strip(): line.partition("│")[2] for line in lines if "│" in line}
    assert row["0.0001"].index("a") < row["1e−8"].index("a") < row["0.0001"].index("b")
    assert "c" in row["× 1"] and "[ms]" in lines[-1] and "Judged" not in "".join(lines)


def test_without_its_extra_a_picture_is_refused_with_the_way_to_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drawing_files.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(HeunError) as refused:
        drawing_files.render_by_matplotlib(VectorDrawing(10.0, 10.0, "", "", ()), "png")
    problem = refused.value.problems[0]
    assert problem.code == "missing-extra" and 'pip install "heuncli[plot]"' in str(problem.hint)


@pytest.mark.parametrize(("form", "begins"), [("png", b"\x89PNG"), ("pdf", b"%PDF")])
def test_with_its_extra_it_is_drawn_the_same_every_time(form: str, begins: bytes) -> None:
    pytest.importorskip("matplotlib")
    first, second = (
        drawing_files.render_by_matplotlib(lay_out(make_work_precision_figure(MANY)), form) for _ in range(2)
    )
    assert first.startswith(begins) and first == second and svg() == svg(make_work_precision_figure(MANY))
