"""Random laws with breaks, written in several ways: rates, accelerations and blows stand where the law breaks.

    python -m tests.honesty.breaks_told_again --cases 1000 [--seed FIRST]

A law is straight between points whose instants are decimals; it is held before and behind. Each is written as a table,
by `min` and `max`, by conditions, by `abs`, over the time or over a straight function of it, which rises or falls and
whose roots are no doubles. The reference computes in fractions. Runs end at a break, or behind all.
"""

from __future__ import annotations

import math
import sys
import time
from collections import Counter
from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np

from heuncli.base.errors import HeunError
from heuncli.results.results import Results
from tests.honesty.rest_poses import spread
from tests.shared.hunts import asked_of
from tests.shared.scenes import solved

ROUNDINGS = 64.0 * float(np.finfo(float).eps)
Points = list[tuple[Fraction, Fraction]]


class Law:
    """A law over x = a t + b through points of x and y, held outside them; all numbers decimals."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.a = Fraction(int(rng.choice([-30, -20, -7, -1, 1, 1, 2, 3, 7, 30])), int(rng.choice([1, 10])))
        self.b = Fraction(int(rng.choice([0, 0, 1, 3, 10, 100 if abs(self.a) >= 1 else 1])), int(rng.choice([1, 10])))
        count = int(rng.integers(2, 5))
        from_zero = np.arange(0 if rng.random() < 0.2 else 1, 100)
        instants = sorted(Fraction(int(k), 100) for k in rng.choice(from_zero, count, False))
        y = [Fraction(int(k), 10) for k in rng.integers(-30, 31, count)]
        self.by_time: Points = list(zip(instants, y, strict=True))
        self.points: Points = sorted((self.a * t + self.b, value) for t, value in self.by_time)

    def value(self, t: Fraction) -> Fraction:
        """At an instant."""
        if t <= self.by_time[0][0] or t >= self.by_time[-1][0]:
            return self.by_time[0 if t <= self.by_time[0][0] else -1][1]
        (t0, y0), (t1, y1) = next(pair for pair in pairwise(self.by_time) if pair[0][0] <= t < pair[1][0])
        return y0 + (y1 - y0) * (t - t0) / (t1 - t0)

    def rate(self, t: Fraction) -> Fraction:
        """Just behind an instant."""
        for (t0, y0), (t1, y1) in pairwise(self.by_time):
            if t0 <= t < t1:
                return (y1 - y0) / (t1 - t0)
        return Fraction(0)

    def breaks(self, last: Fraction) -> list[Fraction]:
        """The instants in (0, last] at which the rate jumps."""
        rates = [Fraction(0), *((y1 - y0) / (t1 - t0) for (t0, y0), (t1, y1) in pairwise(self.by_time)), Fraction(0)]
        jumping = zip(self.by_time, pairwise(rates), strict=True)
        return [t for (t, _), (before, after) in jumping if before != after and 0 < t <= last]


def decimal(x: Fraction) -> str:
    """A number as it is written, in brackets where it is below zero; exact, as all of them are decimals."""
    text = f"{x.numerator / x.denominator:.12g}"
    return f"({text})" if x < 0 else text


def argument(law: Law) -> str:
    """x in terms of t."""
    if law.a == -1:
        return f"{decimal(law.b)} - t"
    return f"{decimal(law.a)}*t + {decimal(law.b)}" if law.a != 1 else f"t + {decimal(law.b)}" if law.b else "t"


def slopes(law: Law) -> list[str]:
    """Of the pieces over x, as quotients of what is written."""
    return [f"({decimal(y1 - y0)}/{decimal(x1 - x0)})" for (x0, y0), (x1, y1) in pairwise(law.points)]


def by_clamps(law: Law, x: str, _: np.random.Generator) -> str:
    parts = [f"{slope}*(min(max({x}, {decimal(x0)}), {decimal(x1)}) - {decimal(x0)})"
             for slope, ((x0, _), (x1, _)) in zip(slopes(law), pairwise(law.points), strict=True)]  # fmt: skip
    return " + ".join([decimal(law.points[0][1]), *parts])


def by_conditions(law: Law, x: str, rng: np.random.Generator) -> str:
    text = decimal(law.points[-1][1])
    for slope, ((x0, y0), (x1, _)) in reversed(list(zip(slopes(law), pairwise(law.points), strict=True))):
        line = f"{decimal(y0)} + {slope}*({x} - {decimal(x0)})"
        text = f"({line} if {x} {rng.choice(['<', '<='])} {decimal(x1)} else {text})"
    first_x, first_y = law.points[0]
    return f"{decimal(first_y)} if {x} {rng.choice(['<', '<='])} {decimal(first_x)} else {text}"


def by_magnitudes(law: Law, x: str, _: np.random.Generator) -> str:
    """|x - x0| - |x - x1| is x1 - x0 and its opposite outside, and rises by twice between."""
    parts = [f"{slope}/2*(abs({x} - {decimal(x0)}) - abs({decimal(x1)} - ({x})) + {decimal(x1 - x0)})"
             for slope, ((x0, _), (x1, _)) in zip(slopes(law), pairwise(law.points), strict=True)]  # fmt: skip
    return " + ".join([decimal(law.points[0][1]), *parts])


def by_table(law: Law, x: str, _: np.random.Generator) -> str:
    return f"table(law, {x})"


FORMS: dict[str, Callable[[Law, str, np.random.Generator], str]] = {
    "table": by_table, "clamps": by_clamps, "conditions": by_conditions, "magnitudes": by_magnitudes,
}  # fmt: skip


def scene(law: Law, key: str, text: str, times: list[float]) -> dict[str, Any]:
    """A wheel whose angle or rate follows a law."""
    numbers = [[float(decimal(v[k]).strip("()")) for v in law.points] for k in range(2)]
    return {
        "ground": {"points": {"O": [0, 0, 0]}},
        "bodies": {"w": {"mass": 1, "center": [0, 0, 0], "inertia": [2, 2, 2], "points": {"o": [0, 0, 0]}}},
        "joints": {"a": {"type": "pin", "from": "ground.O", "to": "w.o", "axis": [0, 0, 1]}},
        "tables": {"law": {"x": numbers[0], "y": numbers[1], "outside": "hold"}},
        "drives": {"d": {"joint": "a", key: text}}, "analysis": {"times": times},
    }  # fmt: skip


def judged(seed: int) -> list[tuple[str, str, float]]:
    """For every form of a law what it is ("right", or what is wrong), and the largest deviation over rounding."""
    rng = np.random.default_rng([seed, 51])
    law = Law(rng)
    key = "angle" if rng.random() < 0.5 else "rate"
    ends = [t for t, _ in law.by_time if t > 0]
    last = ends[int(rng.integers(len(ends)))] if rng.random() < 0.5 else Fraction(1)
    asked = sorted({Fraction(0), last, *(t for t in ends if t < last), *(last * k / 7 for k in range(1, 7))})
    times = [t.numerator / t.denominator for t in asked]
    found = []
    for name, form in FORMS.items():
        text = form(law, argument(law), rng)
        try:
            results = solved(scene(law, key, text, times))
        except HeunError as error:
            found.append((name, f"refused: {error.problems[0].message}", math.inf))
            continue
        what, off = compared(law, key, asked, results)
        found.append((name, what, off))
    return found


def compared(law: Law, key: str, asked: list[Fraction], results: Results) -> tuple[str, float]:
    """What of a run is wrong, and the largest deviation over rounding."""
    own = results.coordinates["a"]
    size = float(1 + max(abs(law.points[0][0]), abs(law.points[-1][0]), max(abs(y) for _, y in law.points)))
    steep = float(1 + max(abs(law.rate(t)) for t, _ in law.by_time))
    pairs = {"angle": [("angle", law.value), ("rate", law.rate)],
             "rate": [("rate", law.value), ("acceleration", law.rate)]}  # fmt: skip
    worst = 0.0
    for quantity, of in pairs[key]:
        wanted = np.array([float(of(t)) for t in asked])
        off = np.abs(own[quantity] - wanted) / (ROUNDINGS * size * steep)
        k = int(np.argmax(off))
        worst = max(worst, float(off[k]))
        if off[k] > 1.0:
            return f"{quantity} at {float(asked[k])!r} is {own[quantity][k]!r}, not {wanted[k]!r}", worst
    blows = [float(blow["time"]) for blow in results.impulses]
    breaks = [float(t) for t in law.breaks(asked[-1])] if key == "angle" else []
    if len(blows) != len(breaks):
        return f"blows at {blows}, not {breaks}", math.inf
    slow = float(abs(law.a))
    for there, right in zip(blows, breaks, strict=True):
        off = abs(there - right) / (ROUNDINGS * (1.0 + size / slow))
        worst = max(worst, off)
        if off > 1.0:
            return f"a blow at {there!r}, not {right!r}", worst
    return "right", worst


def main() -> int:
    """Run the cases; 1 if one is wrong."""
    asked = asked_of("tests.honesty.breaks_told_again", __doc__)
    counts: Counter[str] = Counter()
    offs: list[float] = []
    begun = time.perf_counter()
    for seed in range(asked.seed, asked.seed + asked.cases):
        for form, what, off in judged(seed):
            counts["right" if what == "right" else "wrong"] += 1
            offs.append(off)
            if what != "right":
                print(f"{seed} {form}: {what}", flush=True)
    print(f"{asked.cases} laws from {asked.seed}: {dict(counts)}, {time.perf_counter() - begun:.0f} s")
    print(f"deviation over rounding: {spread(offs)}")
    return int(set(counts) != {"right"})


if __name__ == "__main__":
    sys.exit(main())
