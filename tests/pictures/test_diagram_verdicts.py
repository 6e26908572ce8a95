"""What of a section is not drawn, or drawn as open: by the stated errors and the laws, not by how small it looks."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.output.drawing.canvas import TerminalStyle
from heuncli.output.drawing.figure import Arrow, Blank, Symbol, Trace
from heuncli.output.drawing.letters import draw_text as in_letters
from heuncli.output.figures.courses import FigureSource
from heuncli.output.figures.diagrams import make_diagrams
from heuncli.scene.shapes.rotations import cross_vectors
from heuncli.scene.shapes.section_axes import make_first_axis
from heuncli.study.quantities.digits import StatedErrors
from heuncli.study.queries.bars import WholeBar
from tests.shared.drawn_bars import HELD_TWICE, SI, diagrams, drawn, panels_of
from tests.shared.scenes import study

CANTILEVER = """
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar:
    shapes: [{{type: cylinder, from: [0, 0, 0], to: [1, 0, 0], radius: 0.02, mass: 1}}]
    points:
      {{o: [0, 0, 0], up: [1, 0.1, 0], down: [1, -0.1, 0], front: [1, 0, 0.1], back: [1, 0, -0.1], end: [1, 0, 0]}}
    orientation: {{axis: [3, 1, 2], angle: 50 deg}}
joints: {{wall: {{type: weld, from: ground.O, to: bar.o}}}}
forces: {{{forces}}}
sections: {{along: {{body: bar, from: o, to: end, count: 3}}}}
"""


def test_noise_is_named_as_nothing_and_not_drawn() -> None:
    """A beam askew in space, bent in one plane: what else there is of it is rounding, and told to be 0."""
    pushed = study(CANTILEVER.format(forces="p: {type: force, on: bar.end, vector: [0, -7, 0], frame: body}"))
    noise = WholeBar(pushed, "along").make_lines(0.0)
    assert max(np.abs(noise[name].values).max() for name in ("N", "Q2", "T", "M1")) > 0.0, "no rounding to be seen"
    figure = drawn(pushed, "along")
    assert [panel.y.label for panel in diagrams(figure)] == ["Q1 [N]", "M2 [N·m]"]
    assert figure.notes == ["along: all zero, not drawn: N, Q2, T, M1"]


@pytest.mark.parametrize("size", [1.0, 1e-18, 1e18])
def test_what_is_small_by_itself_is_no_noise(size: float) -> None:
    """Loads of 1e-18 N that are all there is are drawn as those of 1 N: only the numbers on the axis differ."""
    force = f"p: {{type: force, on: bar.end, vector: [0, {-7 * size!r}, 0], frame: body}}"
    shown = panels_of(study(CANTILEVER.format(forces=force)), "along")
    assert list(shown) == ["Q1", "M2"]
    x = np.linspace(0.0, 1.0, 11)
    panel = shown["M2"]
    assert np.abs(np.interp(x, *panel.curve("M2").T) + 7 * size * (1 - x)).max() <= 0.5 * panel.pixel


def test_what_no_law_decides_is_drawn_as_open_where_it_is() -> None:
    """Between two fixed pins N, Q1, T and M2 are open; outside they are 0, which is drawn, and not noise."""
    twice = study(HELD_TWICE)
    figure = drawn(twice, "along")
    assert [panel.y.label for panel in diagrams(figure)] == [f"{q} [N]" for q in ("N", "Q1", "Q2")] + [
        f"{q} [N·m]" for q in ("T", "M1", "M2")
    ]
    for panel in diagrams(figure):
        blanks = [item for item in panel.items if isinstance(item, Blank)]
        (line,) = [item for item in panel.items if isinstance(item, Trace)]
        if panel.y.label[:2] in ("Q2", "M1"):
            assert not blanks
            assert np.isfinite(line.y).all()
            continue
        (blank,) = blanks
        assert (blank.low, blank.high, blank.text) == (pytest.approx(0.5), pytest.approx(1.5), "open")
        between = (line.x > 0.5) & (line.x < 1.5)
        assert np.isnan(line.y[between]).all()
        assert (line.y[(line.x < 0.5) | (line.x > 1.5)] == 0.0).all()
    assert any(note.startswith("open: ") for note in figure.notes)


def test_in_letters_there_are_no_hatches_and_signs_are_plain() -> None:
    """Where a terminal shows no braille: the curve alone has its letter, and the minus is one that it has."""
    text = in_letters(drawn(study(HELD_TWICE), "along"), TerminalStyle(80, has_braille=False, has_colours=False))
    shear = text.partition("Q2 [N]")[2].partition("T [")[0].splitlines()
    assert "\N{MINUS SIGN}" not in text
    assert any("a" in line and "+" in line for line in shear)
    assert sum(line.count(".") > 8 for line in shear) <= 1  # the zero line


def test_open_all_along_is_told_as_open() -> None:
    """Of a bar between its two pins nothing else is left to draw."""
    scene = HELD_TWICE.replace("from: start, to: end", "from: A, to: B")
    panel = next(panel for panel in drawn(study(scene), "along").panels if panel.y.label.startswith("N "))
    (blank,) = [item for item in panel.items if isinstance(item, Blank)]
    assert (blank.low, blank.high) == (pytest.approx(0.0), pytest.approx(1.0))
    assert all(np.isnan(item.y).all() for item in panel.items if isinstance(item, Trace))


def with_errors(errors: dict[str, float], monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What the diagrams of a bent and twisted bar say where its forces and moments are known to such errors."""
    forces = (
        "p: {type: force, on: bar.end, vector: [0.01, -7, 0], frame: body}, "
        "c: {type: couple, on: bar.end, vector: [0.02, 0, 0], frame: body}"
    )
    own = StatedErrors({("sections", unit): error for unit, error in errors.items()}, {"N": 1e-12, "N·m": 1e-12})
    monkeypatch.setattr(WholeBar, "stated_errors", own)
    figure = make_diagrams([FigureSource("", study(CANTILEVER.format(forces=forces)))], ["along"], SI)
    words = [item.text for panel in figure.panels for item in panel.items if isinstance(item, Blank)]
    return [*(panel.y.label.partition(" ")[0] for panel in diagrams(figure)), *words, *figure.notes]


def test_the_stated_error_decides(monkeypatch: pytest.MonkeyPatch) -> None:
    """N = 0.01 N and T = 0.02 N m are something, nothing beside others, or not known, by what errors are stated."""
    zero = "along: all zero, not drawn: Q2, M1"
    assert with_errors({"N": 1e-6, "N·m": 1e-6}, monkeypatch) == ["N", "Q1", "T", "M2", zero]
    within = "along: zero within the stated error (5e-02 N, 5e-02 N·m), not drawn: N, T"
    assert with_errors({"N": 0.05, "N·m": 0.05}, monkeypatch) == ["Q1", "M2", zero, within.replace("e-0", "e-")]
    unknown = "unknown: the stated error is as large as the values"
    told = with_errors({"N": 10.0, "N·m": 10.0}, monkeypatch)
    assert told == ["N", "Q1", "T", "M2", *[unknown] * 4, zero]


def test_which_side_is_in_tension() -> None:
    """By what heun means by e1, e2 and M': stress that pulls on the side of e1 makes M2 < 0, on that of e2 M1 > 0."""
    rng = np.random.default_rng(5)
    for n in rng.normal(size=(20, 3)):
        n /= np.linalg.norm(n)
        e1 = make_first_axis(n, None)
        e2 = cross_vectors(n, e1)
        y = rng.uniform(-1.0, 1.0, size=(400, 2))
        y = np.concatenate([y, -y, y * [-1.0, 1.0], y * [1.0, -1.0]])  # two axes of symmetry
        arms = y @ np.stack([e1, e2])
        pulled_at_e1, pulled_at_e2 = (np.sum(np.cross(arms, y[:, k, None] * n), axis=0) for k in (0, 1))
        assert pulled_at_e1 @ e2 < 0.0
        assert abs(pulled_at_e1 @ e1) < 1e-9
        assert pulled_at_e2 @ e1 > 0.0
        assert abs(pulled_at_e2 @ e2) < 1e-9


@pytest.mark.parametrize(
    ("pulled", "pushed", "quantity", "positive", "up"),
    [
        ("up", "down", "M2", False, True),  # e1 = body y
        ("down", "up", "M2", True, False),
        ("front", "back", "M1", True, True),  # e2 = body z
        ("back", "front", "M1", False, False),
    ],
)
def test_moments_are_drawn_on_the_side_in_tension(
    pulled: str, pushed: str, quantity: str, positive: bool, up: bool
) -> None:
    """A bar pulled at its end above its axis and pushed below: above it is in tension, whatever the sign there is."""
    forces = (
        f"a: {{type: force, on: bar.{pulled}, vector: [3, 0, 0], frame: body}}, "
        f"b: {{type: force, on: bar.{pushed}, vector: [-3, 0, 0], frame: body}}"
    )
    bent = study(CANTILEVER.format(forces=forces))
    values = WholeBar(bent, "along").make_lines(0.0)[quantity].values
    assert (values > 0.0).all() == positive
    assert np.abs(values) == pytest.approx(0.6, rel=1e-12)
    (panel,) = diagrams(drawn(bent, "along", tension_side=True))
    assert panel.title.endswith({"M2": "e1 up", "M1": "e2 up"}[quantity])
    (line,) = [item for item in panel.items if isinstance(item, Trace)]
    assert (line.y > 0.0).all() == up
    assert bool(panel.y.tick_texts) == (quantity == "M2")
    assert all(float(text.replace("−", "-")) == pytest.approx(-at) for at, text in panel.y.tick_texts), (
        "the axis tells the values themselves"
    )


def test_a_couple_on_a_bar_is_sketched_as_a_turn_and_a_force_as_an_arrow() -> None:
    couple = "p: {type: couple, on: bar.end, vector: [0, 0, 5]}"
    for force, counts in ((couple, (1, 0)), ("p: {type: force, on: bar.end, vector: [0, -7, 0]}", (0, 1))):
        sketch = drawn(study(CANTILEVER.format(forces=force)), "along").panels[0]
        turns = [item for item in sketch.items if isinstance(item, Symbol) and item.symbol == "turning"]
        assert (len(turns), sum(isinstance(item, Arrow) for item in sketch.items)) == counts
