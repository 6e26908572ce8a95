"""Rodrigues' numbers of attitudes: their algebra, and Lagrange's form of no. 20 against the kernel's accelerations.

The formulas are those of kernel/attitudes.py itself, taken as plain Python. Lagrange's equations are independent: made
of kinetic and potential energy alone, derivatives by complex steps, which have no differences to lose digits in.
"""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest

from heuncli.base.tolerances import EPS
from heuncli.results.results import Array
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from tests.shared.bars import double
from tests.shared.folders import KERNEL as FOLDER
from tests.shared.scenes import near

STEP = 1e-30


def plain() -> ModuleType:
    """kernel/attitudes.py as plain Python, whichever kernel runs."""
    spec = importlib.util.spec_from_file_location("plain_attitudes", FOLDER / "attitudes.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


CHART = plain()


def numbers(a: object) -> Array:
    """The components of the kernel's vectors and quaternions."""
    names = ("w", "x", "y", "z") if hasattr(a, "w") else ("x", "y", "z")
    return np.array([getattr(a, name) for name in names])


def quaternion_of(kappa: Array) -> object:
    return CHART.Quaternion(*(np.array([1.0, *kappa]) / math.sqrt(1.0 + kappa @ kappa)))


def vector(a: Array) -> object:
    return CHART.Vec3(*(float(x) for x in a))


def hat(a: Array) -> Array:
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def rotation(kappa: Array) -> Array:
    """R = 1 + 2 (hat + hat^2) / (1 + kappa^2), of complex numbers, too."""
    return np.eye(3) + 2.0 / (1.0 + kappa @ kappa) * (hat(kappa) + hat(kappa) @ hat(kappa))


def spin(kappa: Array, rate: Array) -> Array:
    """The angular velocity, world axes, (42) corrected."""
    return 2.0 / (1.0 + kappa @ kappa) * (rate + np.cross(kappa, rate))


@pytest.mark.parametrize("case", range(5))
def test_composition(case: int) -> None:
    """kappa of R(b) R(a) is (b + a + b x a) / (1 - a . b); counted from a it is b."""
    a, b = np.random.default_rng(case).normal(size=(2, 3))
    turned = CHART.rotate_quaternion(vector(b), quaternion_of(a))
    near(np.linalg.norm(numbers(turned)), 1.0, 1.0, 1e-15)
    none = CHART.Quaternion(1.0, 0.0, 0.0, 0.0)
    whole = numbers(CHART.kappa_of(turned, none))
    near(whole, (b + a + np.cross(b, a)) / (1.0 - a @ b), float(np.linalg.norm(whole)), 1e-13)
    near(rotation(whole), rotation(b) @ rotation(a), 1.0, 1e-14)
    near(numbers(CHART.kappa_of(turned, quaternion_of(a))), b, 1.0, 1e-14 * (1.0 + b @ b))


@pytest.mark.parametrize("case", range(5))
def test_rates(case: int) -> None:
    """W^-1 undoes W, and the second derivative is that of a motion kappa(t): by complex steps."""
    kappa, rate, second = np.random.default_rng(case).normal(size=(3, 3))
    sigma = spin(kappa, rate)
    near(numbers(CHART.angular_velocity(vector(kappa), vector(rate))), sigma, 1.0, 1e-14)
    near(numbers(CHART.kappa_rate(vector(kappa), vector(sigma))), rate, 1.0, 1e-13)
    R, dR = rotation(kappa), rotation(kappa + 1j * STEP * rate).imag / STEP
    near(dR, hat(sigma) @ R, 1.0, 1e-13)
    sigmadot = spin(kappa + 1j * STEP * rate, rate + 1j * STEP * second).imag / STEP
    near(numbers(CHART.kappa_acceleration(vector(kappa), vector(rate), vector(sigmadot))), second, 1.0, 1e-12)


def by_complex_steps(f: Callable[[Array], Array], x: Array) -> Array:
    """The derivatives of f, as columns."""
    return np.array([f(x + 1j * STEP * e).imag / STEP for e in np.eye(len(x))]).T


MASS, CENTER = (1.0, 0.8), (np.array([0, 0, -0.5]), np.array([0, 0, -0.4]))
MOMENTS, END = (np.diag([0.0842, 0.0850, 0.0017]), np.diag([0.0437, 0.0440, 0.0013])), np.array([0, 0, -1.0])


def energies(q: Array, rates: Array) -> tuple[complex, complex]:
    """Kinetic and potential energy of the two bars, from kappa and its rate alone."""
    kinetic, potential, x, v = 0.0, 0.0, np.zeros(3), np.zeros(3)
    for k in range(2):
        R, sigma = rotation(q[3 * k :][:3]), spin(q[3 * k :][:3], rates[3 * k :][:3])
        arm, body = R @ CENTER[k], R.T @ sigma
        at, speed = x + arm, v + np.cross(sigma, arm)
        kinetic += 0.5 * MASS[k] * (speed @ speed) + 0.5 * (body @ MOMENTS[k] @ body)
        potential += 9.81 * MASS[k] * at[2]
        x, v = x + R @ END, v + np.cross(sigma, R @ END)
    return kinetic, potential


def lagrange(q: Array, rates: Array) -> tuple[Array, float]:
    """kappaddot by d/dt dE/dkappadot - dE/dkappa = -dV/dkappa; E is quadratic in the rates, so eps = its matrix.

    With it the condition of eps, by which its rounding grows: far from the drawn attitude kappa moves little.
    """
    six = np.eye(6)

    def energy(x: Array, u: Array) -> complex:
        return energies(x, u)[0]

    def momenta(x: Array, u: Array) -> Array:
        return np.array([energy(x, u + e) - energy(x, u) - energy(x, e) for e in six])

    eps = np.array([momenta(q, e) for e in six])
    change = momenta(q + 1j * STEP * rates, rates).imag / STEP
    forces = by_complex_steps(lambda x: np.array([energies(x, rates)[0] - energies(x, rates)[1]]), q)[0]
    return np.linalg.solve(eps, forces - change), float(np.linalg.cond(eps))


def test_lagrange_form_against_the_kernel() -> None:
    """Two bars on balls at random: the kernel's accelerations, carried to kappa, are Lagrange's of no. 20."""
    runner = set_up(load("double.yaml", double("{duration: 1}"))).runner
    layout = runner.layout
    random = np.random.default_rng(20)
    for _ in range(4):
        q, rates = random.normal(size=(2, 6))
        y = layout.y0.copy()
        for k, row in enumerate(layout.tables["bodies"]):
            y[row["attitude_at"] :][:4] = numbers(quaternion_of(q[3 * k :][:3]))
            y[row["rate_at"] :][:3] = spin(q[3 * k :][:3], rates[3 * k :][:3])
        alpha = runner.evaluate(np.zeros(1), y[None, :]).bodies["alpha"][0]
        found = [
            numbers(CHART.kappa_acceleration(vector(q[3 * k :][:3]), vector(rates[3 * k :][:3]), vector(alpha[k])))
            for k in range(2)
        ]
        wanted, condition = lagrange(q, rates)
        near(np.concatenate(found), wanted, float(np.abs(wanted).max()), 8.0 * EPS * condition)
