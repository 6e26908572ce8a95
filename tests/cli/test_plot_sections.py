"""`heun plot SPEC sections.NAME`: what it accepts and what it says of what it cannot draw."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.shared.command import Heun
from tests.shared.drawn_bars import CONROD, HELD_TWICE
from tests.shared.drawn_panels import read

CASES = """
cases:
  light: {set: {forces.push.vector: [0, 0, -10]}}
  heavy: {set: {forces.push.vector: [0, 0, -90]}}
"""


@pytest.fixture
def bars(folder: Path) -> Path:
    (folder / "conrod.yaml").write_text(
        CONROD.replace(
            "sections: {shank:", "sections: {middle: {body: rod, at: [0.1, 0], normal: [1, 0]}, up: {body: rod, "
            "from: b, to: a, count: 3}, shank:"
        )
    )  # fmt: skip
    (folder / "held.yaml").write_text(HELD_TWICE)
    (folder / "struck.yaml").write_text(
        HELD_TWICE + "impulses: {blow: {on: bar.C, vector: [0, 0, 1]}}\nanalysis: {type: impulse}\n"
    )
    (folder / "cases.yaml").write_text(HELD_TWICE + CASES)
    return folder


REFUSED = {
    ("conrod.yaml", "sections.shnk"): ("unknown-path", "sections.shnk", "did you mean sections.shank?"),
    ("conrod.yaml", "sections.middle"): ("bad-option", "sections.middle is a single cut", "sections.middle.M1"),
    ("conrod.yaml", "sections.shank", "sections.middle"): ("bad-option", "sections.middle is a single cut", ""),
    ("conrod.yaml", "sections.shank", "--at", "7"): ("bad-option", "--at 7", "the run goes from 0 to 0.0209"),
    ("conrod.yaml", "sections.shank", "--at", "now"): ("bad-option", "--at now", "expected a number, first, last"),
    ("conrod.yaml", "sections.shank", "--units", "kg"): ("bad-option", "kg", ""),
    ("held.yaml", "sections.along", "--at", "1"): ("bad-option", "--at 1", "there is one instant"),
    ("conrod.yaml", "sections.shank", "sections.shnk"): (
        "unknown-path",
        "series of cuts: up, shank",
        "sections.shank?",
    ),
    ("held.yaml", "conrod.yaml", "sections.along"): ("unknown-path", "sections.along", "in conrod.yaml"),
    ("held.yaml", "struck.yaml", "sections.along"): ("bad-option", "impulses (type: impulse)", "separately"),
    ("cases.yaml", "sections.along", "--case", "none"): ("unknown-case", "none", "light"),
}


@pytest.mark.parametrize("words", list(REFUSED))
def test_told_in_a_line_and_nothing_written(bars: Path, heun: Heun, words: Sequence[str]) -> None:
    before = set(bars.iterdir())
    done = heun("plot", *words, "-o", "x.svg")
    code, *parts = REFUSED[tuple(words)]
    assert (done.returncode, done.stdout) == (2, "")
    first, *hints = done.stderr.splitlines()
    assert f"[{code}]" in first
    assert len(hints) <= 1, done.stderr
    assert all(part in done.stderr for part in parts), done.stderr
    assert set(bars.iterdir()) == before


@pytest.mark.heavy
def test_nothing_is_drawn_beyond_the_horizon(folder: Path, heun: Heun) -> None:
    """Of a chaotic motion the envelope ends there, which is told; a later instant is refused."""
    (folder / "wild.yaml").write_text("""
heun: 1
gravity: [0, -9.81]
space: planar
bodies:
  a: {shapes: [{type: rod, from: [0, 0, 0], to: [0.1, 0, 0], mass: 1}], points: {o: [0, 0], e: [0.1, 0]}}
  b: {shapes: [{type: rod, from: [0, 0, 0], to: [0.1, 0, 0], mass: 1}], points: {o: [0, 0], e: [0.1, 0]}}
joints: {O: {type: pin, from: {body: ground, at: [0, 0]}, to: a.o}, E: {type: pin, from: a.e, to: b.o}}
sections: {arm: {body: b, from: o, to: e, count: 3}}
analysis: {duration: 3, samples: 5, tolerance: 1e-3, method: DOP853}
""")
    drawn = heun("plot", "wild.yaml", "sections.arm", "-o", "wild.svg")
    assert drawn.returncode == 0, drawn.stderr
    text = (folder / "wild.svg").read_text()
    assert "no results claimed or drawn from t = " in text
    horizon = float(text.partition("no results claimed or drawn from t = ")[2].split()[0])
    assert all(
        float(word.partition("t = ")[2].removesuffix(" s")) < horizon
        for panel in read(text)
        for word in panel.texts()
        if "t = " in word
    )
    late = heun("plot", "wild.yaml", "sections.arm", "--at", "2.9", "-o", "late.svg")
    assert late.returncode == 2
    assert "results are not reliable" in late.stderr
    assert not (folder / "late.svg").exists()


def test_cases_and_specs_over_each_other(bars: Path, heun: Heun) -> None:
    """A curve a run, each named; bars that run the other way have their own sign of the shear."""
    done = heun("plot", "cases.yaml", "sections.along", "--case", "all", "-o", "all.svg")
    assert done.returncode == 0, done.stderr
    (moment,) = [panel for panel in read((bars / "all.svg").read_text()) if panel.label.startswith("M1")]
    assert {"light: M1", "heavy: M1"} <= set(moment.curves)
    light, heavy = (moment.curve(f"{name}: M1")[:, 1] for name in ("light", "heavy"))
    assert heavy.min() < light.min()


def test_several_specs_are_drawn_at_common_instants(bars: Path, heun: Heun) -> None:
    (bars / "longer.yaml").write_text((bars / "conrod.yaml").read_text().replace("2*pi/w", "4*pi/w"))
    done = heun("plot", "conrod.yaml", "longer.yaml", "sections.shank", "--at", "0.005,0.01", "-o", "both.svg")
    assert (done.returncode, done.stderr) == (0, "")
    text = (bars / "both.svg").read_text()
    assert all(f"{name}: t = {time} s" in text for name in ("conrod", "longer") for time in ("0.005", "0.01"))
    done = heun("plot", "conrod.yaml", "longer.yaml", "sections.shank", "--at", "last", "-o", "last.svg")
    assert done.returncode == 2 and not (bars / "last.svg").exists()
    assert "heun: conrod: --at 0.04" in done.stderr and "one figure shows all runs at the same instants" in done.stderr
    assert "give instants that all runs reach, in seconds, or call it once for each" in done.stderr


@pytest.mark.heavy
def test_a_figure_repeats_to_the_byte_and_units_are_shown(bars: Path, heun: Heun) -> None:
    for name in ("one.svg", "two.svg"):
        assert heun("plot", "conrod.yaml", "sections.shank", "--units", "kN,mm", "-o", name).returncode == 0
    one, two = ((bars / name).read_text() for name in ("one.svg", "two.svg"))
    assert one == two
    labels = [panel.label for panel in read(one)]
    assert labels == ["N [kN]", "Q1 [kN]", "M2 [kN·mm]"]
    assert ">s [mm]<" in one


@pytest.mark.parametrize("width", ["40", "72", "160"])
def test_in_letters(bars: Path, heun: Heun, width: str) -> None:
    """Every panel, its names and notes, no wider than asked for."""
    done = heun("plot", "held.yaml", "sections.along", "--width", width)
    assert done.returncode == 0, done.stderr
    assert max(map(len, done.stdout.splitlines())) <= int(width)
    for words in ("N [N]", "Q2 [N]", "M1 [N·m]", "open", "push"):
        assert words in done.stdout


def test_no_name_of_a_spec_is_markup(bars: Path, heun: Heun) -> None:
    """Titles are text in the SVG."""
    title = '</title><script>alert(1)</script> & \\"x\\" \\u202e 🚀'
    (bars / "evil.yaml").write_text(HELD_TWICE.replace("title: Held by two pins", f'title: "{title}"'))
    done = heun("plot", "evil.yaml", "sections.along", "-o", "evil.svg")
    assert done.returncode == 0, done.stderr
    text = (bars / "evil.svg").read_text()
    assert "<script" not in text
    assert "\u202e" not in text
    assert len(read(text)) == 6


def test_a_blow_has_diagrams_of_its_impulses(bars: Path, heun: Heun) -> None:
    done = heun("plot", "struck.yaml", "sections.along", "-o", "struck.svg")
    assert done.returncode == 0, done.stderr
    text = (bars / "struck.svg").read_text()
    assert "impulses only" in text
    shown = {panel.label: panel for panel in read(text)}
    assert {"Q2 [N·s]", "M1 [N·m·s]"} <= set(shown)
    assert abs(shown["M1 [N·m·s]"].curve("M1")[:, 1]).max() > 0.0


def test_where_nothing_acts_there_is_a_note_and_no_panel(folder: Path, heun: Heun) -> None:
    """A bar that rests in one bearing, without weight: all is 0, in letters and as a file."""
    scene = HELD_TWICE.replace("-9.81", "0").replace("[20, 3, -50]", "[0, 0, 0]")
    (folder / "idle.yaml").write_text(
        scene.replace("  B: {type: pin, axis: [0, 1, 0], from: ground.B, to: bar.B}\n", "")
    )
    for output in ((), ("-o", "idle.svg")):
        done = heun("plot", "idle.yaml", "sections.along", *output)
        assert done.returncode == 0, done.stderr
        told = done.stdout or (folder / "idle.svg").read_text()
        assert "all zero, not drawn: N, Q1, Q2, T, M1, M2" in told
