"""`heun sensitivity` against closed forms, and against exact derivatives of a triangle of forces."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
import sympy

from tests.shared.command import Heun
from tests.shared.folders import SPECS
from tests.shared.variant_scenes import CANTILEVER, IN_BAR, PENDULUM, ROOT, TENSION, TWO_BARS

DEG = math.pi / 180.0


def told(heun: Heun, text: str, measure: str, *more: str) -> Any:
    """What one measure hangs on, of JSON."""
    done = heun("sensitivity", "-", *more, "--measure", measure, "--format", "json", text=text)
    assert done.returncode == 0, done.stderr
    (found,) = json.loads(done.stdout)["measures"]
    return found


def by_name(found: Any) -> dict[str, Any]:
    return {each["name"]: each for each in found["derivatives"]}


def hold(found: Any, exact: dict[str, float], share: float = 1e-5) -> None:
    """The derivatives per SI unit are within their errors of the exact ones, and these of use."""
    known = by_name(found)
    for name, value in exact.items():
        one = known[name]
        assert abs(one["derivative_si"] - value) <= one["error_si"], name
        assert one["error_si"] <= share * abs(value), name
        relative = value * one["si"] / found["value"]
        assert abs(one["relative"] - relative) <= one["relative_error"], name


def test_a_pendulum(heun: Heun) -> None:
    """T = m g (3 - 2 cos a), whatever the length; what is not used changes no bit."""
    found = told(heun, PENDULUM, TENSION)
    a, m, g = 40.0 * DEG, 2.0, 9.81
    bracket = 3.0 - 2.0 * math.cos(a)
    hold(found, {"a": 2.0 * m * g * math.sin(a), "m": g * bracket, "g": m * bracket})
    known = by_name(found)
    assert abs(known["L"]["derivative_si"]) <= known["L"]["error_si"] < 1e-5
    assert (known["idle"]["kind"], known["idle"]["derivative"], known["idle"]["error"]) == ("nothing", 0.0, 0.0)
    assert [each["name"] for each in found["derivatives"]] == ["g", "m", "a", "L", "idle"] or (
        [each["name"] for each in found["derivatives"]] == ["m", "g", "a", "L", "idle"]
    )


def test_a_bar_held_at_its_root(heun: Heun) -> None:
    found = told(heun, CANTILEVER, ROOT)
    a, F, L = 40.0 * DEG, 200.0, 0.5
    hold(found, {"F": -L * math.sin(a), "L": -F * math.sin(a), "a": -F * L * math.cos(a)}, 1e-6)
    one = by_name(found)["F"]  # given in kN
    assert one["derivative"] == pytest.approx(1e3 * one["derivative_si"], rel=1e-15) and one["unit"] == "kN"


@pytest.mark.long
def test_a_bearing(heun: Heun) -> None:
    """(7850 pi r^2 L + M) g/2 + 2/3 m (g + e n^2): specs/rotor.yaml."""
    found = told(heun, (SPECS / "rotor.yaml").read_text(), "max joints.right.radial")
    n, g, L, M, m, e = 100.0 * math.pi, 9.81, 0.6, 12.0, 0.02, 0.04
    line = 7850.0 * math.pi * 0.015**2
    exact = {
        "n": 4.0 / 3.0 * m * e * n, "g": (line * L + M) / 2.0 + 2.0 / 3.0 * m, "L": line * g / 2.0, "M": g / 2.0,
        "m": 2.0 / 3.0 * (g + e * n * n), "e": 2.0 / 3.0 * m * n * n,
    }  # fmt: skip
    hold(found, exact)
    assert [each["name"] for each in found["derivatives"]] == ["n", "g", "M", "m", "e", "L"]


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.third
def test_exact_derivatives_of_a_triangle_of_forces(heun: Heun, seed: int) -> None:
    """Of a state: the load of the second bar, its formula differentiated by a computer algebra."""
    rng = np.random.default_rng(seed)
    p, d = rng.uniform(0.4, 1.5, 2)
    b = rng.uniform(1.15 * abs(p - d) + 0.1, 0.9 * (p + d))
    values = {"p": float(p), "b": float(b), "d": float(d), "W": float(rng.uniform(1.0, 1e4))}
    names = sympy.symbols("p b d W", positive=True)
    P, B, D, W = names
    x = (P**2 - B**2 + D**2) / (2 * D)
    formula = W * sympy.Abs(x) * B / (D * sympy.sqrt(P**2 - x**2))
    at = dict(zip(names, values.values(), strict=True))
    sets = [word for name, value in values.items() for word in ("--set", f"{name}={value!r}")]
    found = told(heun, TWO_BARS, IN_BAR, *sets)
    hold(found, {str(name): float(sympy.diff(formula, name).evalf(30, subs=at)) for name in names}, 1e-4)


def test_a_dotted_key_and_what_is_named_alone(heun: Heun) -> None:
    found = told(heun, PENDULUM.replace("mass: m", "mass: 2 kg"), TENSION, "bodies.bob.shapes.0.mass")
    hold(found, {"bodies.bob.shapes.0.mass": 9.81 * (3.0 - 2.0 * math.cos(40.0 * DEG))})
    assert len(found["derivatives"]) == 1


@pytest.mark.parametrize(
    ("measure", "name", "set_", "kind", "code"),
    [
        ("joints.root.force.z", "at_once", "at_once=1.2", "refused", "not-smooth"),
        ("joints.root.force.z", "at_once", "at_once=1.5", "nothing", None),
        ("model.redundant", "F", "F=3", "refused", "no-error"),
    ],
)
def test_what_has_no_derivative(heun: Heun, measure: str, name: str, set_: str, kind: str, code: str | None) -> None:
    (one,) = told(heun, CANTILEVER, measure, name, "--set", set_)["derivatives"]
    assert one["kind"] == kind and one.get("code") == code
    assert (one["derivative"] is None) == (kind == "refused")


def test_where_it_bends_both_sides_are_told(heun: Heun) -> None:
    """The magnitude of a force along one line, where it passes zero: -1 and 1."""
    (one,) = told(heun, CANTILEVER, "joints.root.force", "side", "--set", "F=0")["derivatives"]
    assert one["kind"] == "kink" and one["derivative"] is None
    for (value, error), exact in ((one["left"], -1.0), (one["right"], 1.0)):
        assert abs(value - exact) <= error < 1e-4


@pytest.mark.parametrize("distance", [1e-2, 1e-4, 1e-6])
def test_a_jump_beside_the_value_is_not_taken_for_a_slope(heun: Heun, distance: float) -> None:
    """Whichever steps are chosen: what is told beside a jump is 0, or nothing."""
    (one,) = told(heun, CANTILEVER, "joints.root.force.z", "at_once", "--set", f"at_once={1.2 - distance!r}")[
        "derivatives"
    ]
    assert one["derivative"] == 0.0 or one["kind"] == "refused"


def test_at_a_bound_one_side_tells(heun: Heun) -> None:
    """A ball falls from h and leaves the floor with e sqrt(2 g h); e is 1 at most."""
    text = """\
heun: 1
parameters: {e: 1, h: 0.5}
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies: {ball: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}}
joints: {guide: {type: slide, axis: [0, 0, 1], from: ground.O, to: ball.c, initial: {travel: h}}}
stops: {floor: {joint: guide, travel: [0, null], restitution: e}}
analysis: {duration: 0.5}
"""
    (one,) = told(heun, text, "final coordinates.guide.speed", "e")["derivatives"]
    assert one["kind"] == "one-sided" and one["code"]
    assert abs(one["derivative"] - math.sqrt(2.0 * 9.81 * 0.5)) <= one["error"] < 1e-3


def spread(found: Any, names: Sequence[str]) -> dict[str, Any]:
    assert [one["name"] for one in found["spread"]["contributions"]] == list(names)
    return {one["name"]: one for one in found["spread"]["contributions"]}


def test_a_spread_that_is_linear(heun: Heun) -> None:
    """F L sin a: contributions, worst case and root of squares by hand."""
    found = told(heun, CANTILEVER, ROOT, "--spread", "F=2N,L=1mm,a=0.1deg")
    a, F, L = 40.0 * DEG, 200.0, 0.5
    exact = {"F": L * math.sin(a) * 2.0, "L": F * math.sin(a) * 1e-3, "a": F * L * math.cos(a) * 0.1 * DEG}
    each = spread(found, ["F", "L", "a"])
    for name, size in exact.items():
        assert abs(each[name]["size"] - size) <= each[name]["error"] and not each[name]["by_variants"]
    total = found["spread"]
    assert abs(total["worst"] - sum(exact.values())) <= total["worst_error"]
    assert abs(total["root_sum_square"] - math.hypot(*exact.values())) <= total["root_sum_square_error"]
    low, high = ((F - k * 2.0) * (L - k * 1e-3) * math.sin(a - k * 0.1 * DEG) for k in (-1.0, 1.0))
    assert total["corners"] == pytest.approx([-low, -high], rel=1e-12)


def test_a_spread_that_is_not_is_told_by_the_variants(heun: Heun) -> None:
    """At 90 degrees the derivative is 0, and 30 degrees to either side take F L (1 - cos 30 deg) away."""
    found = told(heun, CANTILEVER, ROOT, "--spread", "a=30deg", "--set", "a=90 deg")
    one = spread(found, ["a"])["a"]
    loss = 100.0 * (1.0 - math.cos(30.0 * DEG))
    assert one["by_variants"] and one["size"] == pytest.approx(loss, rel=1e-9)
    assert (one["below"], one["above"]) == (pytest.approx(loss, rel=1e-9), pytest.approx(loss, rel=1e-9))


FORCE = """\
heun: 1
title: A force that follows a formula
parameters: {{x: {x!r}, y: 5, F: "{formula}"}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  a: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{o: [0, 0, 0]}}}}
joints: {{w: {{type: weld, from: ground.O, to: a.o}}}}
forces: {{f: {{type: force, on: a.o, vector: [-F, 0, 0]}}}}
"""


def test_what_ends_and_derivative_do_not_show_is_searched(heun: Heun) -> None:
    """sin 20 x + y about x = 0: both ends lie where it is 0 again, the derivative says 3.14; it moves by 1 each way."""
    text = FORCE.format(x=0.0, formula="sin(20*x)+y")
    total = told(heun, text, "joints.w.force.x", "x", "y", "--spread", f"x={math.pi / 20.0!r},y=0.01")["spread"]
    assert abs(total["worst"] - 1.01) <= total["worst_error"] < 0.01
    one, other = total["contributions"]
    assert one["by_variants"] and not other["by_variants"]
    assert abs(one["least"][0] + math.pi / 40.0) < 2e-3 and abs(one["greatest"][0] - math.pi / 40.0) < 2e-3


def test_numbers_that_matter_only_together(heun: Heun) -> None:
    """x y about 0 and 5: 5 t alone, and 5.5 t with y at its end."""
    text = FORCE.format(x=0.0, formula="x*y")
    total = told(heun, text, "joints.w.force.x", "x", "y", "--spread", "x=0.2,y=0.5")["spread"]
    assert abs(total["worst"] - 1.1) <= total["worst_error"] and total["worst"] >= 1.1 - 1e-9


@pytest.mark.parametrize("seed", range(6))
def test_the_worst_case_covers_measures_that_are_not_monotone(heun: Heun, seed: int) -> None:
    """Two waves: no less than the true largest change, but for the stated error."""
    rng = np.random.default_rng([77, seed])
    a, w, p = rng.uniform(0.2, 2.0), rng.uniform(2.0, 25.0), rng.uniform(0.0, 6.0)
    x0, t = rng.uniform(-1.0, 1.0), rng.uniform(0.05, 0.4)
    text = FORCE.format(x=float(x0), formula=f"{a!r}*sin({w!r}*x+{p!r})+0.3*x+y")
    total = told(heun, text, "joints.w.force.x", "x", "--spread", f"x={t!r}")["spread"]
    x = np.linspace(x0 - t, x0 + t, 20_001)
    m = a * np.sin(w * x + p) + 0.3 * x
    true = float(np.abs(m - (a * math.sin(w * x0 + p) + 0.3 * x0)).max())
    assert true - total["worst"] <= total["worst_error"] + 1e-9
    assert total["worst"] <= 1.05 * true + total["worst_error"]
