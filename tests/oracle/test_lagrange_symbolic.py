"""Lagrange's equations of four mechanisms, derived by SymPy from their energies, to twelve digits."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest
import sympy

from tests.shared.lagrange import told

DIGITS = 1e-12
G = 9.81
pytestmark = pytest.mark.heavy


class Derived:
    """e, C, k and the symbols of an energy T(q, q') and a potential V(q), at numbers."""

    def __init__(self, q: list[Any], u: list[Any], T: Any, V: Any, at: dict[Any, float]) -> None:
        exact = {symbol: sympy.Rational(str(value)) for symbol, value in at.items()}
        f = len(q)
        e = sympy.hessian(T, u)

        def number(x: Any) -> float:
            return float(sympy.N(x.subs(exact), 25))

        self.epsilon = np.array([[number(e[i, j]) for j in range(f)] for i in range(f)])
        self.gamma = np.array([
            number((e[i, j].diff(q[k]) + e[i, k].diff(q[j]) - e[j, k].diff(q[i])) / 2)
            for i, j, k in product(range(f), repeat=3)
        ]).reshape(f, f, f)  # fmt: skip
        self.forces = np.array([number(-V.diff(x)) for x in q])
        rates = np.array([at[x] for x in u])
        self.coriolis = np.einsum("ilk,l,k->i", self.gamma, rates, rates)


def against(derived: Derived, scene: str, names: tuple[str, ...]) -> None:
    found = told(scene, coordinates=names, christoffel=True)
    assert found.gamma is not None
    for ours, theirs in (
        (found.epsilon, derived.epsilon), (found.gamma, derived.gamma), (found.coriolis, derived.coriolis),
        (found.total_force, derived.forces),
    ):  # fmt: skip
        assert np.abs(ours - theirs).max() <= DIGITS * max(np.abs(theirs).max(), np.abs(derived.epsilon).max())


def speed(place: list[Any], q: list[Any], u: list[Any]) -> Any:
    """The square of a point's velocity."""
    return sum(sum(c.diff(x) * v for x, v in zip(q, u, strict=True)) ** 2 for c in place)


def symbols(f: int) -> tuple[list[Any], list[Any]]:
    return list(sympy.symbols(f"q:{f}")), list(sympy.symbols(f"u:{f}"))


HEAD = f"heun: 1\ngravity: [0, 0, -{G}]\nground: {{points: {{O: [0, 0, 0]}}}}\n"


def test_an_arm_that_turns_and_slides() -> None:
    """A sleeve turns about a shaft across it, a rod slides along it, a weight swings at its end."""
    q, u = symbols(3)
    phi, s, theta = q
    m1, J1, m2, c, J2, m3, l, J3, k, s0 = 1.5, 0.2, 0.8, 0.3, 0.1, 0.6, 0.5, 0.05, 40.0, 0.4
    end = [(s + 0.7) * sympy.cos(phi), (s + 0.7) * sympy.sin(phi)]
    rod = [(s + c) * sympy.cos(phi), (s + c) * sympy.sin(phi)]
    bob = [end[0] + l * sympy.cos(phi + theta), end[1] + l * sympy.sin(phi + theta)]
    T = (J1 * u[0] ** 2 + m2 * speed(rod, q, u) + J2 * u[0] ** 2 + m3 * speed(bob, q, u) + J3 * (u[0] + u[2]) ** 2) / 2
    V = G * (m2 * rod[1] + m3 * bob[1]) + k * (s - s0) ** 2 / 2
    at = dict(zip(q, (0.6, 0.25, -0.9), strict=True)) | dict(zip(u, (1.3, -0.4, 2.1), strict=True))
    scene = (
        HEAD
        + f"""
bodies:
  sleeve: {{mass: {m1}, center: [0, 0, 0], inertia: [1, {J1}, 1], points: {{o: [0, 0, 0]}}}}
  rod: {{mass: {m2}, center: [{c}, 0, 0], inertia: [1, {J2}, 1], points: {{o: [0, 0, 0], e: [0.7, 0, 0]}}}}
  bob: {{mass: {m3}, center: [{l}, 0, 0], inertia: [1, {J3}, 1], points: {{o: [0, 0, 0]}}}}
joints:
  A: {{type: pin, axis: [0, -1, 0], from: ground.O, to: sleeve.o, initial: {{angle: 0.6, rate: 1.3}}}}
  B: {{type: slide, axis: [1, 0, 0], from: sleeve.o, to: rod.o, initial: {{travel: 0.25, speed: -0.4}}}}
  C: {{type: pin, axis: [0, -1, 0], from: rod.e, to: bob.o, initial: {{angle: -0.9, rate: 2.1}}}}
forces: {{k: {{type: torque, joint: B, value: -{k}*(B.travel - {s0})}}}}
analysis: {{type: state}}
"""
    )
    against(Derived(q, u, T, V, at), scene, ("A.angle", "B.travel", "C.angle"))


def test_a_pendulum_on_a_turning_column() -> None:
    """Two pins across each other in space, a body of three inertias."""
    q, u = symbols(2)
    psi, theta = q
    m, l, J = 2.0, 0.4, (0.3, 0.2, 0.1)
    # the body hangs along -z, its axes x, y, z are turned by psi about z and by theta about -y
    place = [l * sympy.sin(theta) * sympy.cos(psi), l * sympy.sin(theta) * sympy.sin(psi), -l * sympy.cos(theta)]
    w = (sympy.sin(theta) * u[0], -u[1], sympy.cos(theta) * u[0])
    column = 0.05
    T = (m * speed(place, q, u) + sum(j * x**2 for j, x in zip(J, w, strict=True)) + column * u[0] ** 2) / 2
    V = m * G * place[2]
    at = dict(zip(q, (0.3, 0.8), strict=True)) | dict(zip(u, (2.0, -1.1), strict=True))
    scene = (
        HEAD
        + f"""
bodies:
  column: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, {column}], points: {{o: [0, 0, 0]}}}}
  rod: {{mass: {m}, center: [0, 0, -{l}], inertia: {list(J)}, points: {{o: [0, 0, 0]}}}}
joints:
  A: {{type: pin, axis: [0, 0, 1], from: ground.O, to: column.o, initial: {{angle: 0.3, rate: 2}}}}
  B: {{type: pin, axis: [0, -1, 0], from: column.o, to: rod.o, initial: {{angle: 0.8, rate: -1.1}}}}
analysis: {{type: state}}
"""
    )
    against(Derived(q, u, T, V, at), scene, ("A.angle", "B.angle"))


def test_a_pole_on_a_cart() -> None:
    q, u = symbols(2)
    x, theta = q
    M, m, c, J = 1.0, 0.2, 0.3, 0.006
    place = [x - c * sympy.sin(theta), c * sympy.cos(theta)]
    T = (M * u[0] ** 2 + m * speed(place, q, u) + J * u[1] ** 2) / 2
    at = {x: 0.1, theta: 0.4, u[0]: 0.7, u[1]: -1.9}
    scene = (
        HEAD
        + f"""
bodies:
  cart: {{mass: {M}, center: [0, 0, 0], inertia: [1, 1, 1], points: {{c: [0, 0, 0]}}}}
  pole: {{mass: {m}, center: [0, 0, {c}], inertia: [1, {J}, 1], points: {{foot: [0, 0, 0]}}}}
joints:
  rail: {{type: slide, axis: [1, 0, 0], from: ground.O, to: cart.c, initial: {{travel: 0.1, speed: 0.7}}}}
  hinge: {{type: pin, axis: [0, -1, 0], from: cart.c, to: pole.foot, initial: {{angle: 0.4, rate: -1.9}}}}
analysis: {{type: state}}
"""
    )
    against(Derived(q, u, T, m * G * place[1], at), scene, ("rail.travel", "hinge.angle"))


def test_a_slider_crank_with_its_weights() -> None:
    """The closed chain by its one coordinate: rod and slider follow from the crank."""
    q, u = symbols(1)
    (phi,) = q
    r, l, e = sympy.Rational(1, 10), sympy.Rational(3, 10), sympy.Rational(1, 50)
    m1, m2, m3, J1, J2 = 1.0, 0.8, 1.5, 0.004, 0.009
    beta = sympy.asin((e - r * sympy.sin(phi)) / l)
    pin = [r * sympy.cos(phi), r * sympy.sin(phi)]
    rod = [
        pin[0] + 0.12 * sympy.cos(beta) - 0.03 * sympy.sin(beta),
        pin[1] + 0.12 * sympy.sin(beta) + 0.03 * sympy.cos(beta),
    ]
    crank = [0.06 * sympy.cos(phi), 0.06 * sympy.sin(phi)]
    slider = [pin[0] + l * sympy.cos(beta), e + 0 * phi]
    spin = beta.diff(phi) * u[0]
    T = m1 * speed(crank, q, u) + J1 * u[0] ** 2 + m2 * speed(rod, q, u) + J2 * spin**2 + m3 * speed(slider, q, u)
    V = G * (m1 * crank[1] + m2 * rod[1])
    scene = (
        HEAD.replace(f"[0, 0, -{G}]", f"[0, -{G}, 0]").replace("O: [0, 0, 0]", "O: [0, 0, 0], B: [0, 0.02, 0]")
        + f"""
bodies:
  crank: {{mass: {m1}, center: [0.06, 0, 0], inertia: [1, 1, {J1}], points: {{o: [0, 0, 0], e: [0.1, 0, 0]}}}}
  rod: {{mass: {m2}, center: [0.12, 0.03, 0], inertia: [1, 1, {J2}], points: {{o: [0, 0, 0], e: [0.3, 0, 0]}}}}
  slider: {{mass: {m3}, center: [0, 0, 0], inertia: [1, 1, 1], near: {{position: [0.35, 0.02, 0]}},
           points: {{o: [0, 0, 0]}}}}
joints:
  A: {{type: pin, axis: [0, 0, 1], from: ground.O, to: crank.o, initial: {{angle: 0.9, rate: 7}}}}
  B: {{type: line, axis: [0, 0, 1], from: crank.e, to: rod.o}}
  C: {{type: pin, axis: [0, 0, 1], from: rod.e, to: slider.o}}
  D: {{type: slide, axis: [1, 0, 0], from: ground.B, to: slider.o}}
analysis: {{type: state}}
"""
    )
    against(Derived(q, u, T / 2, V, {phi: 0.9, u[0]: 7.0}), scene, ("A.angle",))
