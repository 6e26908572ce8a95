"""Section diagrams under what changes nothing, or only their scale: the world turned, faster, from the other end."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.results.results import Array
from heuncli.scene.shapes.rotations import rotation_matrix_about
from heuncli.study.queries.bars import WholeBar
from heuncli.study.queries.study import Study
from tests.shared.drawn_bars import drawn, panels_of
from tests.shared.drawn_panels import edges, heights
from tests.shared.scenes import near, study

R = rotation_matrix_about(np.array([2.0, -1.0, 3.0]) / np.sqrt(14.0), 1.1)


def flail(turned: Array | None = None, faster: float = 1.0, ends: str = "from: a, to: e") -> Study:
    """A bar with a lump and a force on it that hangs on a ball joint, spins and falls."""
    turn = np.eye(3) if turned is None else turned

    def world(*vector: float) -> list[float]:
        return [float(x) for x in turn @ np.array(vector)]

    start = turn @ rotation_matrix_about(np.array([0.0, 1.0, 0.0]), 0.6)
    c = faster
    return study(f"""
heun: 1
title: A flail
gravity: {world(0, 0, -9.81 * c**2)}
ground: {{points: {{O: {world(0.1, 0.2, 0.3)}}}}}
bodies:
  bar:
    shapes:
      - {{type: cylinder, from: [0, 0, 0], to: [0.8, 0, 0], radius: 0.02, mass: 2}}
      - {{type: point, at: [0.5, 0, 0.03], mass: 0.7}}
    points: {{a: [0, 0, 0], m: [0.3, 0.02, 0], e: [0.8, 0, 0]}}
    orientation: {{matrix: {start.tolist()}}}
    angular_velocity: {{vector: [{2 * c}, {3 * c}, {-4 * c}], frame: body}}
joints: {{O: {{type: ball, from: ground.O, to: bar.a}}}}
forces:
  push: {{type: force, on: bar.m, vector: [{5 * c**2}, {-9 * c**2}, {4 * c**2}], frame: body}}
sections: {{along: {{body: bar, {ends}, count: 6}}}}
analysis: {{duration: {0.4 / c}, samples: 3, tolerance: 1e-10}}
""")


S = np.linspace(0.003, 0.797, 99)  # no jump is at any of them
QUANTITIES = ("N", "Q1", "Q2", "T", "M1", "M2")


@pytest.fixture(scope="module")
def plain() -> Study:
    return flail()


@pytest.mark.heavy
def test_the_world_turned_leaves_them_as_they_are(plain: Study) -> None:
    """All that is drawn, to a pixel; the curves at an instant to the error of the motion."""
    turned = flail(R)
    mine, its = (WholeBar(one, "along").make_lines(0.25) for one in (plain, turned))
    for name in QUANTITIES:
        near(its[name].values, mine[name].values, 200.0, 1e-8)
    mine_drawn, its_drawn = (panels_of(one, "along") for one in (plain, turned))
    assert list(mine_drawn) == list(its_drawn) == list(QUANTITIES)
    for name in QUANTITIES:
        band = f"minimum and maximum of {name}"
        near(edges(its_drawn[name].areas[band], S), edges(mine_drawn[name].areas[band], S), mine_drawn[name].pixel, 1.0)


@pytest.mark.parametrize("c", [2.0, 0.5])
def test_faster_by_c_they_grow_by_its_square(plain: Study, c: float) -> None:
    """k -> c² k, sigma -> c sigma: the same picture, only the numbers on its axes are others."""
    fast = flail(faster=c)
    for t in (0.0, 0.17, 0.4):
        mine, its = WholeBar(plain, "along").make_lines(t), WholeBar(fast, "along").make_lines(t / c)
        for name in QUANTITIES:
            near(its[name].values, c**2 * mine[name].values, 200.0 * c**2, 1e-8)
    mine_drawn, its_drawn = panels_of(plain, "along"), panels_of(fast, "along")
    for name in QUANTITIES:
        a, b = (heights(panel[name].curve(name), S) for panel in (mine_drawn, its_drawn))
        near(b / c**2, a, mine_drawn[name].pixel, 1.0)


def test_slopes_between_loads_at_rest() -> None:
    """dM1/ds = Q2 and dM2/ds = -Q1 between loads, of the drawn curves: areas are changes of the moments."""
    beam = study("""
heun: 1
gravity: [3, -9.81, 6]
bodies:
  bar:
    shapes: [{type: cylinder, from: [0, 0, 0], to: [2, 0, 0], radius: 0.05, density: 7850}]
    points: {a: [0, 0, 0], b: [0.7, 0, 0], c: [1.5, 0, 0], d: [2, 0, 0]}
joints:
  a: {type: weld, from: {body: ground, at: [0, 0, 0]}, to: bar.a}
forces:
  p: {type: force, on: bar.b, vector: [0, 900, -300]}
  q: {type: force, on: bar.b, vector: [0, 100, -700]}
  w: {type: distributed, on: bar, from: b, to: c, vector: [0, -100, 500], to_vector: [0, 800, 0]}
  m: {type: couple, on: bar.c, vector: [100, -200, 300]}
sections: {along: {body: bar, from: a, to: d, count: 5}}
""")
    shown = panels_of(beam, "along")
    for shear, moment, sign in (("Q2", "M1", 1.0), ("Q1", "M2", -1.0)):
        for a, b in ((0.0, 0.7), (0.7, 1.5), (1.5, 2.0)):
            edge = 0.01 * shown[shear].across  # places are written to a hundredth of a pixel
            s = np.linspace(a + edge, b - edge, 801)
            q, m = (np.interp(s, *shown[name].curve(name).T) for name in (shear, moment))
            area = np.concatenate([[0.0], np.cumsum(0.5 * (q[1:] + q[:-1]) * np.diff(s))])
            off = np.abs(m - m[0] - sign * area).max()
            assert off <= shown[moment].pixel + 0.5 * shown[shear].pixel * (b - a)


@pytest.mark.heavy
def test_told_from_the_other_end_forces_turn_over() -> None:
    """From end to start: N stays, and every place is told from there; the pictures say the same of the bar."""
    mine, its = (
        WholeBar(flail(), "along").make_lines(0.1),
        WholeBar(flail(ends="from: e, to: a"), "along").make_lines(0.1),
    )
    s = np.linspace(0.01, 0.79, 50)
    s = s[(np.abs(s - 0.3) > 1e-6) & (np.abs(s - 0.5) > 1e-6)]
    for name, sign in (("N", 1.0), ("T", 1.0), ("Q1", -1.0)):  # e1 is the same, n and e2 are turned over
        found = np.interp(0.8 - s[::-1], its[name].s, its[name].values)[::-1]
        near(found, sign * np.interp(s, mine[name].s, mine[name].values), 200.0, 1e-4)


def test_figures_of_the_same_run_are_the_same(plain: Study) -> None:
    assert repr(drawn(plain, "along").words) == repr(drawn(plain, "along").words)
