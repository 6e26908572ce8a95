"""The drawing of a chart: XML, names over no other names, crosses with notes, nothing from outside."""

from __future__ import annotations

import xml.etree.ElementTree as tree
from itertools import combinations, pairwise
from random import Random

import pytest

from heuncli.app.commands.chart.figure import assign_levels, draw_figure
from heuncli.app.commands.chart.label_placement import LabelBox, crosses, is_inside, place_labels
from heuncli.base.errors import HeunError
from heuncli.base.records import replace
from heuncli.base.text_safety import escape
from heuncli.output.drawing import matplotlib_file
from heuncli.output.drawing.shapes import Line, Mark, Text, VectorDrawing, to_svg
from tests.shared.fake_charts import FAILS, TOO_LONG, chart, run

SVG = "{http://www.w3.org/2000/svg}"
FIELD = LabelBox(80.0, 100.0, 810.0, 580.0)
METHODS = ("Euler", "Heun2", "Heun3", "RK4", "DOPRI5", "DOP853", "Verner98", "Gauss4", "Gauss6", "Radau5", "Radau9")
MANY = chart(
    *(run(m, 1e-4 * (1 + i) * 3**k, 10.0 ** (-3 - k) / (i + 1), local=10.0**-k) for i, m in enumerate(METHODS)
      for k in range(5)),
    FAILS, TOO_LONG,
)  # fmt: skip


def parsed(text: str) -> tree.Element:
    return tree.fromstring(text.encode())


def test_it_is_xml_with_its_text_as_text() -> None:
    root = parsed(to_svg(draw_figure(MANY)))
    texts = [e.text or "" for e in root.iter(f"{SVG}text")]
    assert root.findtext(f"{SVG}title") == "A scene: speed versus accuracy"
    assert set(METHODS) <= set(texts) and "A scene" in texts and any("agree: motion to 1e-13" in t for t in texts)
    assert "1 ms" in texts and "1e-6" in texts


def test_nothing_comes_from_outside() -> None:
    text = to_svg(draw_figure(MANY))
    assert "script" not in text and "href" not in text and "@font" not in text and "url(" not in text
    assert text.count("http") == 1  # the name of the format


def test_it_is_the_same_every_time() -> None:
    assert to_svg(draw_figure(MANY)) == to_svg(draw_figure(MANY))


@pytest.mark.parametrize("title", ["a < b & c > d", "bell \x07, quote \" and ' ", "Ökonomie µ × é", "", "w" * 300])
def test_any_title_is_held(title: str) -> None:
    made = replace(MANY, title=title)
    root = parsed(to_svg(draw_figure(made)))
    told = root.findtext(f"{SVG}title") or ""
    assert told.startswith(escape(title))


def test_all_shapes_lie_in_the_drawing() -> None:
    made = draw_figure(MANY)
    for shape in made.shapes:
        at = shape.points if isinstance(shape, Line) else [(shape.x, shape.y)]
        assert all(0.0 <= x <= made.width and 0.0 <= y <= made.height for x, y in at)


def test_each_method_has_dashes_or_markers_of_its_own() -> None:
    looks = set()
    shapes = draw_figure(MANY).shapes
    marks = [s for s in shapes if isinstance(s, Mark)]
    for line in (s for s in shapes if isinstance(s, Line) and len(s.points) == 5 and s.width == 1.6):
        own = {(m.shape, m.is_filled) for m in marks if (m.x, m.y) in line.points}
        looks.add((line.dash, *sorted(own)[0]))
    assert len(looks) == len(METHODS)


def test_failures_are_crosses_above_the_field_with_their_reasons() -> None:
    shapes = draw_figure(MANY).shapes
    texts = [s.text for s in shapes if isinstance(s, Text)]
    assert any(t.startswith("× 1  Euler, step 0.01 s: fails at t = 0.25 s: no finite") for t in texts)
    assert any(t.startswith("× 2  Euler, step") and "not run: about 2e9 steps" in t for t in texts)
    field = max((s for s in shapes if isinstance(s, Line) and len(s.points) == 5 and s.width == 1.0), key=len)
    top = min(y for _, y in field.points)
    strokes = [s for s in shapes if isinstance(s, Line) and len(s.points) == 2 and s.width == 1.6]
    assert len(strokes) == 4 and all(y < top for s in strokes for _, y in s.points)
    without = chart(run("A", 1e-3, 1e-4))
    assert not any("×" in s.text for s in draw_figure(without).shapes if isinstance(s, Text))


def test_the_front_is_one_heavy_line_from_fast_to_accurate() -> None:
    heavy = [s for s in draw_figure(MANY).shapes if isinstance(s, Line) and s.width > 5.0]
    assert len(heavy) == 1
    assert all(a[0] < b[0] and a[1] < b[1] for a, b in pairwise(heavy[0].points))
    assert len(heavy[0].points) == sum(each.front for each in MANY.runs)


def lines(seed: int, count: int, ending: bool) -> list[tuple[str, list[tuple[float, float]]]]:
    """Falling lines, at random in the field; ending: all in one place."""
    random = Random(seed)
    found = []
    for k in range(count):
        xs = sorted(random.uniform(FIELD.left, FIELD.right) for _ in range(5))
        ys = sorted(random.uniform(FIELD.top, FIELD.bottom) for _ in range(5))
        points = list(zip(xs, ys, strict=True))
        found.append((f"Method{k}-name", [*points[:-1], (600.0, 560.0)] if ending else points))
    return found


@pytest.mark.parametrize("ending", [False, True])
@pytest.mark.parametrize("count", [1, 6, 16, 30])
@pytest.mark.parametrize("seed", range(4))
def test_no_name_stands_over_another(seed: int, count: int, ending: bool) -> None:
    given = lines(seed, count, ending)
    found = place_labels(given, FIELD, 12.0)
    assert sorted(label.text for label in found) == sorted(text for text, _ in given)
    assert not any(a.box.overlaps(b.box) for a, b in combinations(found, 2))
    for label in found:
        own = dict(given)[label.text]
        assert label.anchor in own if label.anchor is not None else is_inside(label.box, FIELD)
        assert label.box.bottom <= FIELD.bottom + 1e-9 and label.box.top >= FIELD.top - 1e-9


def test_lines_through_a_box_are_seen() -> None:
    box = LabelBox(0.0, 0.0, 2.0, 1.0)
    assert crosses(box, (-1.0, 0.5), (3.0, 0.5)) and crosses(box, (1.0, -1.0), (1.0, 3.0))
    assert crosses(box, (-1.0, -0.5), (3.0, 1.5)) and crosses(box, (0.5, 0.5), (9.0, 9.0))
    assert not crosses(box, (-1.0, 2.0), (3.0, 2.0)) and not crosses(box, (-2.0, 0.5), (-1.0, 0.5))
    assert not crosses(box, (-1.0, 0.5), (0.5, 3.0))


def test_without_its_extra_a_picture_is_refused_with_the_way_to_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(matplotlib_file.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(HeunError) as refused:
        matplotlib_file.render(VectorDrawing(10.0, 10.0, "", "", ()), "png")
    problem = refused.value.problems[0]
    assert problem.code == "missing-extra" and 'pip install "heuncli[plot]"' in str(problem.hint)


@pytest.mark.parametrize(("form", "begins"), [("png", b"\x89PNG"), ("pdf", b"%PDF")])
def test_with_its_extra_it_is_drawn_the_same_every_time(form: str, begins: bytes) -> None:
    pytest.importorskip("matplotlib")
    first, second = (matplotlib_file.render(draw_figure(MANY), form) for _ in range(2))
    assert first.startswith(begins) and first == second


def test_crosses_that_would_hide_each_other_stand_above_each_other() -> None:
    assert assign_levels([[100.0], [200.0, 300.0], [120.0], [310.0], [125.0]]) == [0, 0, 1, 1, 2]
    assert assign_levels([]) == []
