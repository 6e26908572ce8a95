"""Loads of one variable that act in a short span of it, or from an edge on: as text, and as laws between edges."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from random import Random
from typing import NamedTuple

from scipy.interpolate import CubicSpline, PchipInterpolator

from tests.oracle.switched import Law

AMPLE = 7.0  # half-widths beyond which a bell is nothing


class Span(NamedTuple):
    """The variable's name, the span's beginning and width, and the load's largest value."""

    v: str
    a: float
    w: float
    F: float


class Shape(NamedTuple):
    """laws: one more than edges; narrow: the width of a law that is no polynomial; table: its entry in the scene."""

    text: str
    edges: tuple[float, ...]
    laws: tuple[Law, ...]
    narrow: float = math.inf
    table: str = ""


def nothing(_: float) -> float:
    return 0.0


def constant(F: float) -> Law:
    return lambda v: F


def window(r: Random, span: Span) -> Shape:
    """On and off."""
    v, a, w, F = span
    b = a + w
    text = r.choice([
        f"{F!r} if {a!r} < {v} < {b!r} else 0", f"{F!r}*(step({v} - {a!r}) - step({v} - {b!r}))",
        f"0 if {v} < {a!r} or {v} > {b!r} else {F!r}", f"{F!r}*step({v} - {a!r})*step({b!r} - {v})",
    ])  # fmt: skip
    return Shape(text, (a, b), (nothing, constant(F), nothing))


def ramp(r: Random, span: Span) -> Shape:
    """Up within the span, and on."""
    v, a, w, F = span
    k = F / w
    text = r.choice([f"{k!r}*min(max({v} - {a!r}, 0), {w!r})", f"{k!r}*max(0, min({v} - {a!r}, {w!r}))"])
    return Shape(text, (a, a + w), (nothing, lambda x: k * (x - a), constant(k * w)))


def roof(r: Random, span: Span) -> Shape:
    """Up and down in straight lines."""
    v, a, w, F = span
    c, k = a + w / 2, 2 / w
    text = f"{F!r}*max(0, 1 - {k!r}*abs({v} - {c!r}))"
    up, down = (lambda x: F * (1 + k * (x - c))), (lambda x: F * (1 - k * (x - c)))
    return Shape(text, (c - 1 / k, c, c + 1 / k), (nothing, up, down, nothing))


def edge(r: Random, span: Span) -> Shape:
    """From one value to another."""
    v, a, _, F = span
    if r.random() < 0.5:
        return Shape(f"{F!r}*step({v} - {a!r})", (a,), (nothing, constant(F)))
    return Shape(f"{F!r}*sign({v} - {a!r})", (a,), (constant(-F), constant(F)))


def bell(r: Random, span: Span) -> Shape:
    """Smooth."""
    v, a, w, F = span
    c, s = a + w / 2, w / 4

    def law(x: float) -> float:
        return F * math.exp(-(((x - c) / s) ** 2))

    text = f"{F!r}*exp(-(({v} - {c!r})/{s!r})**2)"
    return Shape(text, (c - AMPLE * s, c + AMPLE * s), (nothing, law, nothing), s)


def table(r: Random, span: Span) -> Shape:
    """Through some knots, from nothing to nothing."""
    v, a, w, F = span
    kind, count = r.choice(["linear", "pchip", "cubic"]), r.randint(3, 6)
    x = [a + w * (k + 0.6 * r.random()) / count for k in range(count)]
    y = [0.0, *(F * r.uniform(0.3, 1) for _ in range(count - 2)), 0.0]
    if kind == "linear":
        laws = [line(b, p, (q - p) / (d - b)) for (b, d), (p, q) in zip(pairwise(x), pairwise(y), strict=True)]
    else:
        c = (PchipInterpolator(x, y) if kind == "pchip" else CubicSpline(x, y)).c
        laws = [cubic(b, tuple(c[:, k].tolist())) for k, b in enumerate(x[:-1])]
    name = f"T{r.randrange(10**9)}"
    entry = f"  {name}: {{x: {x}, y: {y}, interpolation: {kind}, outside: hold}}\n"
    return Shape(f"table({name}, {v})", tuple(x), (nothing, *laws, nothing), table=entry)


def line(x0: float, y0: float, slope: float) -> Law:
    return lambda x: y0 + slope * (x - x0)


def cubic(x0: float, c: tuple[float, ...]) -> Law:
    return lambda x: ((c[0] * (x - x0) + c[1]) * (x - x0) + c[2]) * (x - x0) + c[3]


Maker = Callable[[Random, Span], Shape]
SHORT: list[Maker] = [window, roof, bell, table]
LASTING: list[Maker] = [ramp, edge]
