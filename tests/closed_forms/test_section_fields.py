"""Largest stresses against the fields themselves, dense over the section: never below them, and not far above.

Shear by Jourawski, in the circle with the directions that its edge asks for; Saint-Venant's torsion; bending and
tension linear.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from heuncli.loads.kinetostatics.stress import MODULI, compute_stresses
from heuncli.results.results import Array

Place = tuple[Array, Array]
NAMES = ("N", "Q1", "Q2", "T", "M1", "M2")


def disc(R: float, r: float, count: int = 30) -> Place:
    """Places over a ring, its edges and the lines along both axes among them."""
    rho, phi = np.meshgrid(np.linspace(r, R, count), np.linspace(0.0, 2.0 * math.pi, 721))
    return rho * np.cos(phi), rho * np.sin(phi)


def in_circle(load: dict[str, float], R: float, at: Place) -> tuple[Array, Array]:
    """Shear stress: T r/J, and 4/3 Q/A (1 - (y/R)^2) along Q with -xy/R^2 of it across, y along Q: in balance."""
    x, y = at
    Q, A, J = np.array([load["Q1"], load["Q2"]]), math.pi * R**2, 0.5 * math.pi * R**4
    along = (Q[0] * x + Q[1] * y) / R**2
    k = 4.0 / 3.0 / A
    return k * (Q[0] - along * x) - load["T"] / J * y, k * (Q[1] - along * y) + load["T"] / J * x


def in_ring(load: dict[str, float], R: float, r: float, at: Place) -> tuple[Array, Array]:
    """Shear stress: T rho/J, and Q S/(I b) along Q, b and S of the ring's chord."""
    x, y = at
    Q = np.array([load["Q1"], load["Q2"]])
    size = math.hypot(*Q) or 1.0
    height = (Q[0] * x + Q[1] * y) / size
    outer = np.sqrt(np.maximum(R**2 - height**2, 0.0))
    inner = np.sqrt(np.maximum(r**2 - height**2, 0.0))
    I = 0.25 * math.pi * (R**4 - r**4)
    with np.errstate(invalid="ignore"):
        mean = np.where(outer > 0.0, (outer**3 - inner**3) / (3.0 * I * (outer - inner)), 0.0)
    return Q[0] * mean - 0.5 * load["T"] / I * y, Q[1] * mean + 0.5 * load["T"] / I * x


def in_rectangle(load: dict[str, float], b: float, h: float, at: Place) -> tuple[Array, Array]:
    """Shear stress: 3/2 Q/A with a parabola each way, and the torsion's."""
    x, y = at
    t1, t2, J = torsion(b, h, x, y)
    k = 1.5 / (b * h)
    return (
        k * load["Q1"] * (1.0 - (2.0 * x / b) ** 2) + load["T"] / J * t1,
        k * load["Q2"] * (1.0 - (2.0 * y / h) ** 2) + load["T"] / J * t2,
    )


def torsion(b: float, h: float, x: Array, y: Array, terms: int = 60) -> tuple[Array, Array, float]:
    """Stresses along both axes by a twist of 1/G a length, and J; series of cosines along the short side."""
    if b > h:
        t2, t1, J = torsion(h, b, y, x, terms)
        return -t1, -t2, J  # mirrored: a twist the other way round
    n = (2 * np.arange(terms) + 1).reshape(-1, *[1] * x.ndim)
    sign = (-1.0) ** ((n - 1) // 2)
    p, q = n * math.pi * x / b, n * math.pi * np.abs(y) / b
    far = n * math.pi * h / (2.0 * b)
    grown = np.exp(q - far) / (1.0 + np.exp(-2.0 * far))
    cosh, sinh = grown * (1.0 + np.exp(-2.0 * q)), grown * (1.0 - np.exp(-2.0 * q))
    c = 8.0 * b / math.pi**2
    along1 = -np.sign(y) * c * np.sum(sign / n**2 * sinh * np.cos(p), axis=0)
    along2 = 2.0 * x - c * np.sum(sign / n**2 * cosh * np.sin(p), axis=0)
    along2 = np.where(np.abs(y) < 0.5 * h, along2, 0.0)
    n = n.reshape(-1)
    J = b**3 * h / 3.0 * (1.0 - 192.0 * b / (math.pi**5 * h) * float(np.sum(np.tanh(n * math.pi * h / (2 * b)) / n**5)))
    return along1, along2, J


def random_load(rng: np.random.Generator, size: float) -> dict[str, float]:
    """Loads whose stresses are about as large, some of them absent."""
    scale = np.array([1.0, 1.0, 1.0, size, size, size]) * 10.0 ** rng.uniform(-1.0, 1.0, 6)
    values = scale * rng.normal(size=6) * (rng.random(6) > 0.35)
    return dict(zip(NAMES, values.tolist(), strict=True))


def ratios(kind: str, sizes: dict[str, float], load: dict[str, float], at: Place, tau: tuple[Array, Array]) -> Array:
    """Shear and von Mises stress as they are told, over the largest of the dense fields."""
    m = MODULI[kind](sizes)
    told = compute_stresses(m, {name: np.array([value]) for name, value in load.items()}, None)
    sigma = load["N"] / m.area + load["M1"] / m.I1 * at[1] - load["M2"] / m.I2 * at[0]
    square = tau[0] ** 2 + tau[1] ** 2
    field = np.sqrt([square.max(), (sigma**2 + 3.0 * square).max()])
    given = np.array([told["shear_max"][0], told["mises"][0]])
    return np.where(field > 0.0, given / np.where(field > 0.0, field, 1.0), 1.0)


def family(kind: str, count: int, draw: Callable[[np.random.Generator], tuple[dict[str, float], float]]) -> Array:
    found = []
    for seed in range(count):
        rng = np.random.default_rng(seed)
        sizes, size = draw(rng)
        load = random_load(rng, size)
        if kind == "rectangle":
            b, h = sizes["width"], sizes["height"]
            x, y = np.meshgrid(np.linspace(-0.5 * b, 0.5 * b, 81), np.linspace(-0.5 * h, 0.5 * h, 81))
            found.append(ratios(kind, sizes, load, (x, y), in_rectangle(load, b, h, (x, y))))
        else:
            R, r = sizes["radius"], sizes.get("inner_radius", 0.0)
            at = disc(R, r)
            found.append(ratios(kind, sizes, load, at, in_ring(load, R, r, at) if r else in_circle(load, R, at)))
    return np.array(found)


def test_circles() -> None:
    """The largest of the field itself, to what a step of half a degree misses."""
    found = family("circle", 30, lambda rng: ({"radius": 0.02}, 0.01))
    assert found.min() > 1.0 - 1e-12
    assert found.max() < 1.0 + 2e-4


def test_tubes() -> None:
    """Thick and thin ones."""
    found = family("tube", 30, lambda rng: ({"radius": 0.02, "inner_radius": 0.02 * rng.uniform(0.01, 0.999)}, 0.01))
    assert found.min() > 1.0 - 1e-12
    assert found.max() < 1.1


def test_rectangles() -> None:
    found = family(
        "rectangle", 20, lambda rng: ({"width": 0.02, "height": 0.02 * 10.0 ** rng.uniform(-1.0, 1.0)}, 0.005)
    )
    assert found.min() > 1.0 - 1e-12
    assert found.max() < 1.05
