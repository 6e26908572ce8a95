"""Where rounding has the say the run goes on if it can, and says what its numbers are worth."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.motion.integration.methods.method import DRIVE_DETERMINED
from heuncli.study.compose.warnings import warn_unbalanced
from heuncli.study.solve.error_estimates import Weights
from heuncli.study.solve.load_errors import LoadErrors
from tests.shared.scenes import near, solved, study


def slider_crank(angle: float, rod: float, more: str) -> str:
    """A crank of 1 m at an angle, a rod to a slider on the x axis: on the outer branch, at 90 degrees folded."""
    pin = f"[{math.cos(angle)!r}, {math.sin(angle)!r}, 0]"
    end = f"[{math.cos(angle) + math.sqrt(rod * rod - math.sin(angle) ** 2)!r}, 0, 0]"
    return f"""
heun: 1
gravity: [0, -9.81, 0]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  crank:
    shapes: [{{type: rod, from: [0, 0, 0], to: {pin}, mass: 1}}]
    points: {{o: [0, 0, 0], p: {pin}}}
    MOVES
  rod: {{shapes: [{{type: rod, from: {pin}, to: {end}, mass: 1}}], points: {{p: {pin}, b: {end}}}}}
  slider: {{shapes: [{{type: box, center: {end}, size: [0.1, 0.1, 0.1], mass: 1}}], points: {{b: {end}}}}}
joints:
  A: {{type: pin, from: ground.O, to: crank.o, axis: [0, 0, 1]}}
  C: {{type: pin, from: crank.p, to: rod.p, axis: [0, 0, 1]}}
  D: {{type: pin, from: rod.b, to: slider.b, axis: [0, 0, 1]}}
  E: {{type: slide, from: ground.O, to: slider.b, axis: [1, 0, 0]}}
{more}
"""


@pytest.mark.heavy
def test_folded_it_goes_on_as_well_as_it_can() -> None:
    """Crank and rod of one length, folded: 1e-12 cannot be had past the dead centre, and that is said."""
    text = slider_crank(math.pi / 2 + 1e-3, 1.0, "analysis: {duration: 1, samples: 21, tolerance: 1e-12}")
    found = solved(text.replace("MOVES", "angular_velocity: [0, 0, 3]"))
    near(found.bodies["slider"]["center"], 0.0, 1.0, 1e-7)
    assert any(w.startswith("tolerance 1e-12 not reached") for w in found.warnings)
    # a step that ends beside the dead centre leaves some of `passing`, 3e-6, of the rates to chance
    assert 1e-12 < found.accuracy["estimate"]["motion"] < 1e-4


def test_a_lock_is_still_a_lock() -> None:
    """A rod too short to pass: no coarser run makes it fit."""
    text = slider_crank(0.3, 0.9, "drives: {m: {joint: A, angle: 2*t}}\nanalysis: {duration: 2, samples: 21}")
    with pytest.raises(SolveError, match="cannot be assembled"):
        solved(text.replace("    MOVES\n", ""))


@pytest.mark.heavy
@pytest.mark.parametrize("longer", [1e-9, 1e-10, 1e-11])
def test_which_branch_is_followed_may_be_rounding(longer: float) -> None:
    """A rod longer by a hair only: at the dead centre its two branches are a hair apart, which is always told.

    Whether the two runs part there is a matter of rounding. If they do, nothing is claimed from there on, and the
    sentence says why; if not, it says that the motion goes on. Whatever is claimed lies on a branch of the closed form.
    Where it is followed and not integrated the hair is seen, and the motion stays on its branch.
    """
    more = "drives: {m: {joint: A, angle: 2*t}}\nanalysis: {duration: 0.8, samples: 26}"
    text = slider_crank(0.3, 1 + longer, more).replace("    MOVES\n", "")
    followed = solved(text)
    if followed.model["method"] == DRIVE_DETERMINED.name:
        outer = np.cos(0.3 + 2 * followed.time) + np.sqrt((1 + longer) ** 2 - np.sin(0.3 + 2 * followed.time) ** 2)
        near(followed.bodies["slider"]["center"][:, 0], outer, 1.0, 1e-9)
        assert followed.accuracy["horizon"] is None and followed.accuracy["estimate"]["motion"] <= 1e-9
    found = solved(text, reduce=False)
    dead = (math.pi / 2 - 0.3) / 2
    (told,) = [w for w in found.warnings if w.startswith("singular position at t = ") and "two motions" in w]
    near(float(told.split("t = ")[1].split(" s")[0]), dead, 1.0, 1e-4)
    horizon, angle, x = found.accuracy["horizon"], 0.3 + 2 * found.time, found.bodies["slider"]["center"][:, 0]
    outer, inner = (np.cos(angle) + way * np.sqrt((1 + longer) ** 2 - np.sin(angle) ** 2) for way in (1, -1))
    before = found.time < dead
    near(x[before], outer[before], 1.0, 1e-9)
    claimed = ~before & (found.time < (np.inf if horizon is None else horizon))
    assert min(float(np.abs(x - branch)[claimed].max(initial=0.0)) for branch in (outer, inner)) < 1e-3
    if horizon is None:
        assert "heun follows the smooth one" in told and found.accuracy["estimate"]["motion"] <= 1e-9
    else:
        assert "rounding decides which one is followed" in told and horizon >= dead - 0.05


def two_bars_in_line(gravity: str) -> str:
    """Two bars in line between fixed pins: what pulls across them needs boundless reactions."""
    bars = "".join(
        f"  {name}: {{shapes: [{{type: rod, from: [0, 0, 0], to: [1, 0, 0], mass: 1}}], "
        "points: {x: [0, 0, 0], y: [1, 0, 0]}}\n"
        for name in "ab"
    )
    return f"""
heun: 1
gravity: {gravity}
ground: {{points: {{A: [0, 0, 0], B: [2, 0, 0]}}}}
bodies:
{bars}joints:
  A: {{type: pin, from: ground.A, to: a.x, axis: [0, 0, 1]}}
  M: {{type: pin, from: a.y, to: b.x, axis: [0, 0, 1]}}
  B: {{type: pin, from: b.y, to: ground.B, axis: [0, 0, 1]}}
analysis: {{duration: 1, samples: 5}}
"""


def test_at_rest_no_energy_drifts() -> None:
    """Pulled along themselves they do not move, so nothing is relative to their motion."""
    found = solved(two_bars_in_line("[-9.81, 0, 0]"))
    assert np.abs(found.points["a.y"]["position"] - [1, 0, 0]).max() < 1e-7
    assert found.accuracy["energy_drift"] == 0.0


def test_what_cannot_stay_in_line_is_refused() -> None:
    """Pulled across, they would have to stop as soon as they move: rates are not deleted untold."""
    with pytest.raises(SolveError, match="no finite force resists it"):
        solved(two_bars_in_line("[0, -9.81, 0]"))


def test_loads_that_do_not_balance_are_told() -> None:
    assert warn_unbalanced(1e-12) == []
    (told,) = warn_unbalanced(0.9)
    assert told.startswith("force balance error 0.9 of the largest force")


PENDULUM = """
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: PLACE}}
bodies: {bar: {mass: 2, center: PLACE, inertia: [0.1, 0.2, 0.3], points: {o: PLACE}}}
joints: {pivot: {type: pin, from: ground.O, to: bar.o, axis: [1, 1, 1], initial: {rate: 3}}}
analysis: {type: state}
"""


def find_roundings(place: tuple[float, ...]) -> tuple[float, float]:
    """Return the rounding that is stated of the foundation's forces and moments, without differences of runs."""
    run = study(PENDULUM.replace("PLACE", str(list(place))))
    errors = LoadErrors(run.setup, weights=Weights(0.0, 1.0))
    errors.add(run.history.solutions.select(np.array([0, 0])), *np.ones((2, 1), dtype=bool))
    stated = errors.errors()
    return stated["foundation", "N"], stated["foundation", "N·m"]


def find_worst_moment(lever: tuple[float, ...], force_error: float) -> float:
    """Return the largest component of d x e over all e whose components are +-force_error, in exact arithmetic."""
    x, y, z = map(Fraction, lever)
    moments = [
        moment
        for a, b, c in product([-Fraction(force_error), Fraction(force_error)], repeat=3)
        for moment in (y * c - z * b, z * a - x * c, x * b - y * a)
    ]
    return float(max(moments))


@pytest.mark.parametrize("place", [(500.0, 0.0, 0.0), (300.0, -400.0, 0.0), (300.0, 400.0, 0.0), (-3e5, 4e5, 2e5)])
def test_the_rounding_of_the_foundation_s_moment_covers_both_products(place: tuple[float, ...]) -> None:
    """(d x F)_z = d_x F_y - d_y F_x: if each component of F may be off by e, it is off by (|d_x| + |d_y|) e."""
    force_rounding, moment_rounding = find_roundings(place)
    worst = find_worst_moment(place, force_rounding)
    assert worst <= moment_rounding <= 3.0 * worst
