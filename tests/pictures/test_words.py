"""Words in panels: over no other words or marks, within the field, and told below where there is no room."""

from __future__ import annotations

import re
from itertools import combinations

import numpy as np
import pytest

from heuncli.output.drawing.canvas import TerminalStyle
from heuncli.output.drawing.figure import Arrow, Figure, Panel, PlaceLabel, Scaling, Spot, Trace, VerticalMark
from heuncli.output.drawing.labels import WordBox, estimate_width
from heuncli.output.drawing.layout import lay_out
from heuncli.output.drawing.letters import draw_text
from heuncli.output.drawing.shapes import Area, Mark, Text
from heuncli.output.drawing.style import BASE_FACTOR, HEIGHT_FACTOR, LEFT, RIGHT, SMALL_SIZE, WIDTH

NARROW = WordBox(LEFT, 0.0, WIDTH - RIGHT, 400.0)


def figure(seed: int, spots: int, uprights: int) -> Figure:
    """A panel with a curve, and many marks with words that tell each from all others."""
    random = np.random.default_rng(seed)
    x = np.linspace(0.0, 1.0, 300)
    y = np.cumsum(random.normal(size=300))
    at = np.sort(random.choice(300, spots))
    items = [
        *(
            VerticalMark(float(t), f"blow {k}", f"blow {k} at {t:.3g} s")
            for k, t in enumerate(random.uniform(size=uprights))
        ),
        Trace("course", x, y),
        *(Spot(float(x[i]), float(y[i]), f"{k}: {y[i]:.4g}", 0, note=f"spot {k}") for k, i in enumerate(at)),
    ]
    scale = Scaling("force [N]", float(y.min()) - 1.0, float(y.max()) + 1.0)
    return Figure("Words", [], [Panel(Scaling("t [s]", 0.0, 1.0), scale, tuple(items))])


def box(text: Text) -> WordBox:
    """Where a text stands."""
    if text.is_vertical:
        top = text.y - estimate_width(text.text, text.size)
        return WordBox(
            text.x - BASE_FACTOR * text.size, top, text.x - BASE_FACTOR * text.size + HEIGHT_FACTOR * text.size, text.y
        )
    top = text.y - BASE_FACTOR * text.size
    return WordBox(text.x, top, text.x + estimate_width(text.text, text.size), top + HEIGHT_FACTOR * text.size)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize(("spots", "uprights"), [(4, 3), (40, 20), (300, 80)])
@pytest.mark.third
def test_words_stand_over_no_words_and_no_marks(seed: int, spots: int, uprights: int) -> None:
    shapes = lay_out(figure(seed, spots, uprights)).shapes
    words = [box(shape) for shape in shapes if isinstance(shape, Text) and shape.has_halo]
    marks = [WordBox(m.x - m.size, m.y - m.size, m.x + m.size, m.y + m.size) for m in shapes if isinstance(m, Mark)]
    assert len(words) >= 4 and not any(a.overlaps(b) for a, b in combinations(words, 2))
    assert not any(word.overlaps(mark) for word in words for mark in marks)
    assert all(NARROW.left <= word.left and word.right <= NARROW.right for word in words)


@pytest.mark.parametrize("spots", [4, 60])
def test_every_word_is_in_the_panel_or_told_below(spots: int) -> None:
    texts = [shape for shape in lay_out(figure(1, spots, 4)).shapes if isinstance(shape, Text)]
    inside = [text.text for text in texts if text.has_halo]
    below = " ".join(text.text for text in texts if text.size == SMALL_SIZE and not text.has_halo)
    lost = [k for k in range(spots) if not any(text.startswith(f"{k}: ") for text in inside)]
    told = [int(k) for k in re.findall(r"spot (\d+)", below)]
    more = int(found[1]) if (found := re.search(r"and (\d+) more", below)) else 0
    assert set(told) <= set(lost) and len(told) + more >= len(lost)
    assert bool(lost) == ("for lack of space" in below)


def test_two_marks_at_one_place_have_their_words_apart() -> None:
    y = np.array([0.0, 1.0])
    spots = (Spot(0.0, 1.0, "127.96 at 0 s", 0), Spot(0.0, 1.0, "128.01 at 0 s", 1))
    panel = Panel(Scaling("t [s]", 0.0, 1.0), Scaling("force [N]", -1.0, 2.0), (Trace("a", y, y), *spots))
    texts = [shape for shape in lay_out(Figure("", [], [panel])).shapes if isinstance(shape, Text) and shape.has_halo]
    assert {text.text for text in texts} == {"127.96 at 0 s", "128.01 at 0 s"}
    assert not box(texts[0]).overlaps(box(texts[1]))


@pytest.mark.parametrize("x", np.linspace(-0.1, 0.1, 9))
@pytest.mark.parametrize("down", [1.0, -1.0])
def test_labels_hide_no_head_of_an_arrow(x: float, down: float) -> None:
    arrow = Arrow(x, 0.6 * down, 0.0, -0.55 * down, 0, description="load")  # its head reaches where words would stand
    items = (arrow, PlaceLabel(0.0, 0.0, "place"))
    panel = Panel(Scaling("x [m]", -1.0, 1.0), Scaling("y [m]", -1.0, 1.0), items)
    shapes = lay_out(Figure("", [], [panel])).shapes
    (word,) = [box(shape) for shape in shapes if isinstance(shape, Text) and shape.text == "place"]
    (head,) = [shape.points for shape in shapes if isinstance(shape, Area)]
    assert not word.overlaps(WordBox(*np.min(head, axis=0), *np.max(head, axis=0)))


@pytest.mark.parametrize("braille", [True, False])
@pytest.mark.parametrize("seed", range(4))
def test_in_letters_words_stand_whole(seed: int, *, braille: bool) -> None:
    shown = draw_text(figure(seed, 12, 5), TerminalStyle(100, braille, has_colours=False))
    panel, _, below = shown.partition("for lack of space")
    for k in range(5):
        assert f"blow {k}" in panel or f"blow {k} at" in below
    for k in range(12):
        assert re.search(rf"(?<!\d){k}: -?\d", panel) or f"spot {k}" in below.replace("\n ", "")
    assert all(len(line) <= 100 for line in shown.splitlines())
