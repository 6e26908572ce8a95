"""Every worked example as a scene, in pixels and in letters: every number known; what is said of it, what is not."""

from __future__ import annotations

import re
import xml.etree.ElementTree as tree
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from heuncli.output.drawing.canvas import make_terminal_style
from heuncli.output.drawing.figure import Figure, Link, PlaceLabel, Polygon, Strokes
from heuncli.output.drawing.labels import estimate_width
from heuncli.output.drawing.layout import lay_out
from heuncli.output.drawing.letters import draw_text
from heuncli.output.drawing.shapes import Text, to_svg
from heuncli.output.drawing.style import HEIGHT_FACTOR
from heuncli.output.figures.courses import FigureSource
from heuncli.output.figures.scenes import make_assembly_figure, make_scene_figure
from heuncli.output.machine_geometry.solids import make_hull
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.quantities.table_units import Units
from heuncli.study.workflow import solve
from tests.shared.scenes import study

SPECS = sorted((Path(__file__).parents[2] / "specs").glob("*.yaml"))
REPORTS = frozenset({"motion", "joints", "impulses"})
HOSTILE = '<script>alert(1)</script> & "x" \\u202e]]> 😀'
POINT = """\
heun: 1
title: one place
ground: {points: {O: [0, 0, 0]}}
bodies:
  p: {shapes: [{type: point, at: [0, 0, 0], mass: 1}], points: {a: [0, 0, 0], b: [0, 0, 0]}}
  q: {shapes: [{type: point, at: [0, 0, 0], mass: 1}], points: {a: [0, 0, 0]}}
joints: {j: {type: ball, from: ground.O, to: p.a}, k: {type: ball, from: p.b, to: q.a}}
"""
PLATE = """\
heun: 1
title: a machine on a plate
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  plate: {shapes: [{type: box, center: [0, 0, -1], size: [1000, 1000, 2], density: 1000}], points: {o: [0, 0, 0]}}
  arm: {shapes: [{type: rod, from: [0, 0, 0], to: [0.1, 0, 0.2], mass: 1}], points: {a: [0, 0, 0]}}
joints:
  floor: {type: weld, from: ground.O, to: plate.o}
  pin: {type: pin, from: plate.o, to: arm.a, axis: [0, 1, 0]}
"""
PLATES = """\
heun: 1
title: A link and a plate
space: planar
ground: {points: {O: [0, 0], P: [0, 2]}}
bodies:
  link: {mass: 2, center: [0.5, 0], inertia: 0.25, points: {o: [0, 0], e: [1, 0]}}
  plate: {mass: 2, center: [1, 0.5], inertia: 9, points: {o: [0, 0], p: [0, 2], q: [3, 0]}}
joints:
  axle: {type: pin, from: ground.O, to: link.o}
  pivot: {type: pin, from: ground.O, to: plate.o}
"""


def texts(figure: Figure) -> list[str]:
    """What is written in the drawing of a figure, which is well-formed and has no number that is none."""
    text = to_svg(lay_out(figure))
    assert not re.search(r"\b(nan|inf)\b", text)
    return [e.text or "" for e in tree.fromstring(text.encode()).iter("{http://www.w3.org/2000/svg}text")]


def numbers_in(figure: Figure) -> Iterator[np.ndarray]:
    """The corners of outlines and the ends of strokes."""
    for panel in figure.panels:
        for item in panel.items:
            if isinstance(item, Polygon | Strokes):
                yield item.corners if isinstance(item, Polygon) else item.ends


@pytest.mark.heavy
@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
@pytest.mark.sixth
def test_every_spec_is_drawn(path: Path) -> None:
    solved = solve(load(str(path)), Options(requested_reports=REPORTS))
    source = FigureSource("", solved)
    figure = make_scene_figure(source, Units())
    written = texts(figure)
    names = [name.replace("_", " ") for name in (*solved.spec.bodies, *solved.spec.joints)]
    told = " ".join(written)
    assert all(name in told for name in names)
    if not solved.has_one_instant:  # from aside, later, and in letters
        later = solved.results.time[[0, len(solved.results.time) // 2]]
        assert texts(make_scene_figure(source, Units(), later, "40,25"))
    for encoding in ("utf-8", "ascii"):
        letters = draw_text(figure, make_terminal_style(80, encoding, has_colours=False))
        assert letters.replace("·", "").isascii() or encoding == "utf-8"  # that of N·m
        assert max(map(len, letters.splitlines())) <= 80 or "µ" in letters
    for points in numbers_in(figure):
        assert np.isfinite(points).all()
    if path in SPECS[::4]:
        assert to_svg(lay_out(make_scene_figure(source, Units()))) == to_svg(lay_out(figure))


@pytest.mark.parametrize("path", SPECS[::4], ids=lambda path: path.stem)
def test_no_words_of_labels_lie_on_each_other(path: Path) -> None:
    figure = make_assembly_figure(load(str(path)))
    names = {item.text for panel in figure.panels for item in panel.items if isinstance(item, PlaceLabel)}
    shapes = [s for s in lay_out(figure).shapes if isinstance(s, Text) and s.has_halo and s.text in names]
    boxes = [(t.x, t.y, t.x + estimate_width(t.text, t.size), t.y + HEIGHT_FACTOR * t.size) for t in shapes]
    for k, (a, b, c, d) in enumerate(boxes):
        for e, f, g, h in boxes[:k]:
            assert min(c, g) - max(a, e) < 1e-6 or min(d, h) - max(b, f) < 1e-6


def test_a_scene_of_one_place_is_drawn() -> None:
    written = texts(make_scene_figure(FigureSource("", study(POINT)), Units()))
    assert "j / k / p / q" in written


def test_what_reaches_far_beyond_the_joints_is_drawn_in_part() -> None:
    figure = make_scene_figure(FigureSource("", study(PLATE)), Units())
    assert any("only partly drawn, extending further: plate" in note for note in figure.notes)
    (panel,) = figure.panels
    assert panel.x.high - panel.x.low < 10.0
    for points in numbers_in(figure):
        assert (points[..., 0] >= panel.x.low - 1e-9).all() and (points[..., 0] <= panel.x.high + 1e-9).all()
        assert (points[..., 1] >= panel.y.low - 1e-9).all() and (points[..., 1] <= panel.y.high + 1e-9).all()


def test_bodies_without_shapes_are_links_plates_and_solids_of_their_points_and_never_their_inertia() -> None:
    figure = make_scene_figure(FigureSource("", study(PLATES)), Units())
    items = figure.panels[0].items
    outlines = {item.name: item.corners for item in items if isinstance(item, Polygon)}
    links = [(item.name, item.x, item.y, item.to_x, item.to_y) for item in items if isinstance(item, Link)]
    assert set(outlines) == {"plate"} and links == [("link", 0.0, 0.0, 1.0, 0.0)]
    assert sorted(map(tuple, outlines["plate"].tolist())) == [(0.0, 0.0), (0.0, 2.0), (3.0, 0.0)]
    solid = make_hull(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0.5, 0.5, 1.0], [0.5, 0.5, 0.2]]))
    assert solid is not None and len(solid.corners) == 5  # a pyramid: the last point is within
    assert sorted(map(len, solid.faces)) == [3, 3, 3, 3, 4] and len(solid.edges) == 8
    for face in solid.faces:  # counter-clockwise from outside
        a, b, c = solid.corners[list(face[:3])]
        assert np.cross(b - a, c - a) @ (a - [0.5, 0.5, 0.3]) > 0.0


def test_of_hundreds_of_bodies_names_are_left_out_and_it_is_said() -> None:
    text = ["heun: 1", "title: a chain", "ground: {points: {O: [0, 0, 0]}}", "bodies:"]
    count = 200
    for k in range(count):
        shape = f"{{type: rod, from: [{k}, 0, 0], to: [{k + 1}, 0, 0], mass: 1}}"
        text.append(f"  b{k}: {{shapes: [{shape}], points: {{a: [{k}, 0, 0], z: [{k + 1}, 0, 0]}}}}")
    text.append("joints:")
    ends = ["ground.O", *(f"b{k}.z" for k in range(count))]
    text += [f"  j{k}: {{type: ball, from: {ends[k]}, to: b{k}.a}}" for k in range(count)]
    path = "\n".join(text) + "\n"
    figure = make_assembly_figure(load("chain.yaml", path))
    assert any("too many bodies (200) and joints (200)" in note for note in figure.notes)
    assert not any(re.fullmatch(r"[bj]\d+", word) for word in texts(figure))
    assert len(to_svg(lay_out(figure))) < 2_000 * count


def test_what_others_wrote_is_shown_and_never_markup() -> None:
    text = POINT.replace("one place", f"'{HOSTILE}'")
    figure = make_scene_figure(FigureSource(HOSTILE, study(text)), Units())
    source = to_svg(lay_out(figure))
    assert "<script" not in source and "\u202e" not in source
    assert any('<script>alert(1)</script> & "x"' in word for word in texts(figure))
