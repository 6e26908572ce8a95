"""Means of loads that jump, bend, or are narrow, as a golden file holds them, against quadrature with 30 digits.

    python -m tests.honesty.golden_means --cases 1000

A weld carries the load, so that its force is the course. Prints the true error of the mean and of the first moment over
the stated one.
"""

from __future__ import annotations

import argparse
import random
from collections.abc import Callable
from typing import Any, NamedTuple

import mpmath as mp

from tests.honesty.golden_courses import SCENE, kept

PATH = "joints.w.force.x"


class Term(NamedTuple):
    """A law as a spec writes it, its values, and where it is not smooth."""

    law: str
    f: Callable[[Any], Any]
    breaks: tuple[float, ...] = ()


def step(draw: random.Random) -> Term:
    at, height = draw.uniform(0.01, 0.99), draw.uniform(-5.0, 5.0)
    return Term(f"({height!r} if t > {at!r} else 0)", lambda t: mp.mpf(height) if t > at else mp.mpf(0), (at,))


def tooth(draw: random.Random) -> Term:
    """Two laws that meet nowhere."""
    at, a, b = draw.uniform(0.01, 0.99), draw.uniform(-5.0, 5.0), draw.uniform(1.0, 9.0)
    law = f"({a!r}*t if t < {at!r} else cos({b!r}*t))"
    return Term(law, lambda t: a * t if t < at else mp.cos(b * t), (at,))


def window(draw: random.Random) -> Term:
    """A load that acts for a short time."""
    width, height = 10.0 ** draw.uniform(-3.0, -0.5), draw.uniform(1.0, 5.0)
    at = draw.uniform(0.01, 0.99 - width)
    law = f"({height!r} if t > {at!r} and t < {at + width!r} else 0)"
    return Term(law, lambda t: mp.mpf(height) if at < t < at + width else mp.mpf(0), (at, at + width))


def bend(draw: random.Random) -> Term:
    at, height = draw.uniform(0.0, 1.0), draw.uniform(-5.0, 5.0)
    return Term(f"{height!r}*abs(t-{at!r})", lambda t: height * abs(t - at), (at,))


def root(draw: random.Random) -> Term:
    """A load whose slope is without bounds where it begins."""
    at, height = draw.uniform(0.0, 0.9), draw.uniform(-5.0, 5.0)
    return Term(f"{height!r}*sqrt(max(t-{at!r}, 0))", lambda t: height * mp.sqrt(t - at) if t > at else 0, (at,))


def bell(draw: random.Random) -> Term:
    width, at, height = 10.0 ** draw.uniform(-2.0, -0.3), draw.uniform(0.0, 1.0), draw.uniform(-5.0, 5.0)
    law = f"{height!r}*exp(-((t-{at!r})/{width!r})**2)"
    near = tuple(x for k in (-6, -2, 0, 2, 6) if 0.0 < (x := at + k * width) < 1.0)
    return Term(law, lambda t: height * mp.exp(-(((t - at) / width) ** 2)), near)


def wave(draw: random.Random) -> Term:
    w, p = draw.uniform(1.0, 60.0), draw.uniform(0.0, 6.0)
    return Term(f"sin({w!r}*t+{p!r})", lambda t: mp.sin(w * t + p), tuple(k / 10.0 for k in range(1, 10)))


TERMS = (step, tooth, window, bend, root, bell, wave)


class Outcome(NamedTuple):
    """The laws of a case, and true over stated errors of mean and moment; None: no mean is told."""

    laws: str
    kinds: tuple[str, ...]
    ratios: tuple[float, float] | None


def look_at(seed: int) -> Outcome:
    """What is told of a sum of one to three laws."""
    draw = random.Random(seed)
    kinds = draw.sample(TERMS, draw.randint(1, 3))
    terms = [kind(draw) for kind in kinds]
    law = " + ".join(term.law for term in terms)
    number = kept(SCENE.format(law=law, tables="", samples=draw.choice([11, 57, 101]))).numbers[PATH]
    names = tuple(kind.__name__ for kind in kinds)
    if number.mean is None or number.moment is None or number.mean_error is None:
        return Outcome(law, names, None)
    mp.mp.dps = 30
    places = sorted({0.0, 1.0, *(x for term in terms for x in term.breaks if 0.0 < x < 1.0)})
    f = lambda t: -sum(term.f(t) for term in terms)  # noqa: E731
    mean, moment = mp.quad(f, places), mp.quad(lambda t: (2 * t - 1) * f(t), places)
    stated = number.mean_error + number.error
    return Outcome(law, names, (abs(float(number.mean - mean)) / stated, abs(float(number.moment - moment)) / stated))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=100)
    parser.add_argument("--first", type=int, default=0)
    asked = parser.parse_args()
    bins, untold, wrong = [0] * 6, 0, 0
    for seed in range(asked.first, asked.first + asked.cases):
        outcome = look_at(seed)
        if outcome.ratios is None:
            untold += 1
            continue
        worst = max(outcome.ratios)
        bins[sum(worst > edge for edge in (0.01, 0.1, 0.5, 1.0, 10.0))] += 1
        if not worst <= 1.0:
            wrong += 1
            print(seed, outcome.kinds, f"{worst:.3g}", outcome.laws, flush=True)
    print(f"no mean told: {untold}; true over stated <= 0.01, 0.1, 0.5, 1, 10, more: {bins}")
    return int(wrong > 0)


if __name__ == "__main__":
    raise SystemExit(main())
