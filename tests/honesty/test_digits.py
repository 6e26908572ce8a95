"""What a table prints is what is known: no rounding with digits, no 0 for a load, `?` for what is not known."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import pytest

from heuncli.output.documents.as_text import format_plain
from heuncli.output.documents.document import format_cell
from heuncli.output.tables import measure
from heuncli.output.tables.page import make_page
from heuncli.study.quantities.labels import make_labels
from heuncli.study.queries.expectations import compare
from heuncli.study.queries.study import Study
from tests.shared.folders import SPECS
from tests.shared.scenes import near, study

pytestmark = pytest.mark.heavy  # a family at random: with the compiled kernel, which has the same bits


def tables(run: Study) -> str:
    """The tables of a run: of one instant, or of extremes."""
    page = make_page(run.results, make_labels(run.spec), run.magnitudes)
    if len(run.results.time) == 1:
        return "\n".join(map(format_plain, page.make_tables_at_instants(run.results)))
    extremes = run.search_extremes(page.make_search(), None, whole=True)
    return "\n".join(map(format_plain, page.make_tables_of_extremes(extremes)))


def row(text: str, title: str, label: str) -> list[str]:
    """The cells of the first row with this label after a line that begins so."""
    lines = text.splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith(title))
    return next(line.split() for line in lines[start + 1 :] if line.split()[:1] == [label])


MASS, LENGTH, SPIN = 2.0, 1.0, 10.0


def pull(x: float) -> float:
    """N of a rod that spins at SPIN about its centre, at x from there: the pieces beyond pull, the whole does not."""
    return MASS * SPIN**2 * (LENGTH**2 / 4.0 - x**2) / (2.0 * LENGTH)


def rod(more: str, analysis: str = "duration: 1, samples: 5") -> str:
    """A rod along x that spins about z, with cuts at and near its middle."""
    return f"""
heun: 1
{more}
bodies:
  rod:
    shapes: [{{type: rod, from: [-0.5, 0, 0], to: [0.5, 0, 0], mass: {MASS}}}]
    points: {{a: [-0.5, 0, 0], b: [0.5, 0, 0], c: [0, 0, 0]}}
    angular_velocity: [0, 0, {SPIN}]
sections:
  middle: {{body: rod, at: [0.05, 0, 0], normal: [1, 0, 0]}}
  beside: {{body: rod, at: [0.1, 0, 0], normal: [1, 0, 0]}}
  along: {{body: rod, from: a, to: b, count: 5}}
analysis: {{{analysis}}}
"""


ON_A_PIN = """
ground: {points: {O: [0, 0, 0]}}
joints: {p: {type: pin, from: ground.O, to: rod.c, axis: [0, 0, 1]}}
"""
FREE = ["", "gravity: [0, 0, -9.81]", "gravity: [3, -7, 2]"]


@pytest.mark.parametrize("more", [ON_A_PIN, *FREE])
@pytest.mark.parametrize("analysis", ["duration: 1, samples: 5", "duration: 1, samples: 2", "type: state"])
def test_a_rotor_about_its_centre_shows_what_its_pieces_pull(more: str, analysis: str) -> None:
    run = study(rod(more, analysis))
    text = tables(run)
    for name, x in (("middle", 0.05), ("beside", 0.1)):
        near(run.results.sections[name]["N"], pull(x), pull(0.0), 1e-9)
        told = [float(word) for word in row(text, "SECTION", name)[-1:]] if analysis == "type: state" else None
        told = told or [float(word) for word in row(text, name, "N")[2:6]]
        assert told == pytest.approx([pull(x)] * len(told), rel=1e-12), text
    assert "?" not in text
    assert run.results.accuracy["balance_residual"] < 1e-14


def test_the_balance_of_a_rotor_is_relative_to_what_its_pieces_pull() -> None:
    """Nothing acts on it, and its centre is at rest: what is left of the sums is rounding of m w^2 r."""
    for axis in np.random.default_rng(3).normal(size=(20, 3)).tolist():
        run = study(rod("", "type: state").replace(f"[0, 0, {SPIN}]", f"{[1e3 * x for x in axis]}"))
        assert run.results.accuracy["balance_residual"] < 1e-14


def test_a_body_thrown_free_shows_its_section_loads() -> None:
    """Nothing acts but its weight, no joint has a load: by Euler's equations of a free body, at hand."""
    run = study("""
heun: 1
gravity: [0, 0, -9.81]
bodies:
  box:
    shapes: [{type: box, center: [0, 0, 0], size: [1, 0.2, 0.1], mass: 3}]
    points: {c: [0, 0, 0]}
    velocity: [3, 0, 5]
    angular_velocity: [1, 2, 3]
sections: {cut: {body: box, at: [0.1, 0, 0], normal: [1, 0, 0]}}
analysis: {duration: 1, samples: 5}
""")
    sides = np.array([1.0, 0.2, 0.1])
    inertia = 3.0 / 12.0 * (np.sum(sides**2) - sides**2)
    w = np.einsum("tji,tj->ti", run.results.bodies["box"]["rotation"], run.results.bodies["box"]["angular_velocity"])
    turning = -np.cross(w, inertia * w) / inertia
    arm = np.array([0.3, 0.0, 0.0])  # of the piece's centre
    force = -1.2 * (np.cross(turning, arm) + np.cross(w, np.cross(w, arm)))
    text = tables(run)
    for name, exact in zip(("N", "Q1", "Q2"), force.T, strict=True):
        near(run.results.sections["cut"][name], exact, np.abs(force).max(), 1e-9)
        cells = row(text, "cut", name)
        assert [float(cell) for cell in cells[2:4]] == pytest.approx([exact[0], exact[-1]], abs=6e-6)
        assert len(cells[2].lstrip("-0.")) >= 4
    assert "?" not in text
    assert run.results.accuracy["estimate"]["sections"] < 1e-8


def turning(seed: int) -> str:
    """A block on a pin through its centre, about any axis, driven evenly; a second one bolted to the ground."""
    random = np.random.default_rng(seed)
    axis, size = random.normal(size=3).tolist(), random.uniform(0.1, 2.0, 3).tolist()
    rate, mass = 10.0 ** random.uniform(-1.0, 3.0), 10.0 ** random.uniform(-3.0, 3.0)
    place = (10.0 ** random.uniform(-1.0, 3.0) * random.normal(size=3)).tolist()
    return f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: {place}}}}}
bodies:
  block:
    shapes: [{{type: box, center: [0, 0, 0], size: {size}, mass: {mass}}}]
    points: {{c: [0, 0, 0]}}
  still:
    shapes: [{{type: box, center: [0, 0, 0], size: {size}, mass: {mass}}}]
    points: {{c: [0, 0, 0]}}
joints:
  p: {{type: pin, from: ground.O, to: block.c, axis: {axis}}}
  w: {{type: weld, from: ground.O, to: still.c}}
drives: {{motor: {{joint: p, angle: "{rate}*t"}}}}
analysis: {{ANALYSIS}}
"""


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("analysis", ["type: state", "duration: 0.5, samples: 3"])
def test_what_is_nought_but_for_rounding_is_not_printed(seed: int, analysis: str) -> None:
    """Turning evenly about its centre the block has no acceleration, and the foundation no inertia loads."""
    text = tables(study(turning(seed).replace("ANALYSIS", analysis)))
    words = {word for line in text.splitlines() for word in line.split()}
    moving = {f"{symbol}{end}" for symbol in ("v", "a", "α") for end in "xyz"} | {"|v|", "|a|", "|α|", "acceleration"}
    assert not words & moving, text
    effect = text[text.index("MASS EFFECT") :].splitlines()[1:4]
    assert not any("F" in line.split()[0] for line in effect if line.strip()), text


def test_a_peak_between_the_samples_is_shown() -> None:
    """The force is nought at all three samples."""
    run = study("""
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {a: {mass: 1, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {p: [0, 0, 0]}}}
joints: {w: {type: weld, from: ground.O, to: a.p}}
forces: {f: {type: force, on: a.p, vector: ["0.4*sin(2*pi*t)", 0, 0]}}
analysis: {duration: 1, samples: 3}
""")
    text = tables(run)
    assert row(text, "w  weld", "Fx") == ["Fx", "N", "0", "0", "-0.4", "0.25", "0.4", "0.75"]
    assert row(text, "FORCES", "value")[2:7] == ["0", "0", "0", "0", "0.4"]


def pendulum(samples: str, expect: str = "[]") -> str:
    """manual/theory.md, "Chaos": two uniform rods, 2.5 rad and 2.5 rad from rest: horizon about 14.6 s."""
    bar = """{mass: 1, center: [0, -0.5, 0], inertia: [0.08333333333333333, 0, 0.08333333333333333],
      points: {top: [0, 0, 0], end: [0, -1, 0]}, orientation: {axis: [0, 0, 1], angle: 2.5}}"""
    return f"""
heun: 1
gravity: [0, -9.81, 0]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{upper: {bar}, lower: {bar}}}
joints:
  p: {{type: pin, from: ground.O, to: upper.top, axis: [0, 0, 1]}}
  q: {{type: pin, from: upper.end, to: lower.top, axis: [0, 0, 1]}}
analysis: {{{samples}}}
expect: {expect}
"""


EXPECTED = """
  - {of: joints.p.force.x, at: 20, is: 0, abs: 1e9}
  - {of: joints.p.force, peak: abs, is: 0, abs: 1e9}
  - {of: joints.q.force.y, is: null, at: 20}
  - {of: joints.p.force.x, at: 1, is: 0, abs: 1e9}
"""


def test_beyond_the_horizon_of_a_pendulum_nothing_is_told() -> None:
    run = study(pendulum("duration: 20, samples: 41", EXPECTED))
    horizon: Any = run.results.accuracy["horizon"]
    assert 13.0 < horizon < 16.0

    def told(words: str) -> str:
        return measure.format_measures([measure.parse_measure(words)], run, "table").strip()

    for words in ("max", "min", "max abs", "final", "at 19.99", f"at {horizon!r}"):
        assert told(f"{words} joints.p.force.x") == told(f"{words} energy.kinetic") == "?"
    assert float(told("at 5 coordinates.p.angle")) == pytest.approx(-0.439854790363542, abs=1e-6)
    assert [compare(run, item).is_met for item in run.spec.expect] == [False, False, False, True]
    text = tables(run)
    cells = row(text, "p  pin", "Fx")
    assert cells[3] == "?"
    assert all(math.isfinite(float(cell)) for cell in (cells[2], *cells[4:]))
    assert max(float(cells[5]), float(cells[7])) < horizon
    assert row(text, "ENERGY", "kinetic")[3] == "?"
    assert np.isfinite(run.results.joints["p"]["force"]).all()  # what JSON and CSV carry


class Cell(NamedTuple):
    """A cell of a table, and what one unit of the last decimal is worth at most, in its table and unit of measure."""

    text: str
    unit: float


def numbers(run: Study, at: list[float]) -> dict[tuple[str, str, int], Cell]:
    """The cells of the tables at some instants, by heading, column and line."""
    page = make_page(run.results, make_labels(run.spec), run.magnitudes)
    cells: dict[tuple[str, str, int], Cell] = {}
    for k, table in enumerate(page.make_tables_at_instants(run.resample(np.array(at)))):
        units = [column.title.partition("[")[2] for column in table.columns]
        lines = [tuple(map(format_cell, line)) for line in table.rows if not isinstance(line, str)]
        for n, column in enumerate(table.columns):
            alike = [line[m] for line in lines for m, unit in enumerate(units) if unit == units[n]]
            last = max(map(last_place, alike))
            for i, line in enumerate(lines):
                cells[f"{k} {table.heading[:20]}", column.title, i] = Cell(line[n], last)
    return cells


def last_place(text: str) -> float:
    """What one unit of a number's last digit is worth; 0 for words and for nought."""
    mantissa, _, exponent = text.partition("e")
    is_number = text != "0" and mantissa.lstrip("-")[:1].isdigit()
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2])) if is_number else 0.0


STIFF = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  arm:
    shapes: [{type: rod, from: [0, 0, 0], to: [1, 0, 0], mass: 5}]
    points: {o: [0, 0, 0], m: [0.5, 0, 0], e: [1, 0, 0]}
  light: {mass: 0.01, center: [0.05, 0, 0], inertia: [1e-5, 1e-5, 1e-5], points: {p: [0, 0, 0]}}
joints:
  hinge: {type: pin, from: ground.O, to: arm.o, axis: [0, 1, 0], initial: {rate: 1}}
  guide: {type: ball, from: arm.m, to: light.p}
forces:
  strut: {type: spring, from: arm.e, to: {body: ground, at: [1, 0, -1]}, stiffness: 8e5, length: 0.99, damping: 400}
analysis: {duration: 1, samples: 11}
"""


@pytest.mark.parametrize("name", ["double", "top", "lamp", "wingnut", "four_bar", "slider_crank", "cardan", "stiff"])
@pytest.mark.third
def test_every_digit_of_a_table_is_right(name: str) -> None:
    """Against a run at 1e-13, at instants of no meaning: to one unit of the last place of either."""
    text = STIFF if name == "stiff" else (SPECS / f"{name}.yaml").read_text()
    run, fine = study(text), study(text, tolerance=1e-13)
    at = np.sort(np.random.default_rng(5).uniform(0.0, run.results.time[-1], 4)).tolist()
    cells, exact = numbers(run, at), numbers(fine, at)
    compared = [key for key, cell in cells.items() if key in exact and "?" not in (cell.text, exact[key].text)]
    assert len(compared) > 0.8 * len(cells)
    for key in compared:
        cell, right = cells[key], exact[key]
        if cell.text != right.text and cell.text[-1:].isdigit():
            allowed = 1.01 * (cell.unit + right.unit)
            assert abs(float(cell.text) - float(right.text)) <= allowed, (key, cell, right)
