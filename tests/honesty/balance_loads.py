"""Shafts under random loads in their angle, with jumps, kinks, flares and tables: orders, mean, work and flywheel.

    python -m tests.honesty.balance_loads --cases 3000 [--first SEED]

prints how many numbers were compared, and how far off they are against what heun says of them, in powers of ten. The
reference is exact: piecewise polynomials and waves integrated by hand, Gaussians by their error functions, all with 40
digits (mpmath). The same shaft is told otherwise, too: turned backwards, about the reversed axis, from another angle.
"""

from __future__ import annotations

import argparse
import math
import random
from collections import Counter
from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

import mpmath as mp

from heuncli.analyses.balancing.results import BalanceOptions, BalanceResults, FlywheelRequest
from heuncli.analyses.balancing.study import balance
from heuncli.scene.file_format.load import load

DIGITS = 40
with mp.workdps(DIGITS):
    TURN = 2 * mp.pi
ORDERS = (1, 2, 3, 7, 24, 30, 101)
RATE = 20.0
SCENE = """
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{s: {{mass: 10, center: [0, 0, 0], inertia: [{J}, {J}, {J}], points: {{o: [0, 0, 0]}}}}}}
joints: {{p: {{type: pin, from: ground.O, to: s.o, axis: [0, 0, {axis}], initial: {{angle: {begin}, rate: {rate}}}}}}}
{tables}
forces: {{f: {{type: torque, joint: p, value: "{law}"}}}}
analysis: {{duration: 0.1, samples: 3}}
"""


class Part(NamedTuple):
    """A summand of the load: as the law has it, its table if it has one, its integral a(k) = ∫ f e^{-ikφ} over a turn.

    work: ∫ f from 0 to an angle within [0, 2π]; corners: angles in [0, 2π) at which it bends or jumps.
    """

    law: str
    table: str
    integral: Callable[[int], Any]
    work: Callable[[Any], Any]
    corners: tuple[float, ...]
    value: Callable[[Any], Any]


def wrapped() -> str:
    """The angle within [0, 2π), as a law of one between -2π and 4π."""
    return "(p.angle + 2*pi*(step(-p.angle) - step(p.angle - 2*pi)))"


def polynomial_piece(
    a: Any, b: Any, c: tuple[float, float, float]
) -> tuple[Callable[[int], Any], Callable[[Any], Any]]:
    """∫ (c0 + c1 x + c2 x²) e^{-ikx} over [a, b], and ∫ of it from a to an angle, x from a on."""

    def upto(x: Any) -> Any:
        h = min(max(x - a, mp.mpf(0)), b - a)
        return c[0] * h + c[1] * h**2 / 2 + c[2] * h**3 / 3

    def integral(k: int) -> Any:
        if k == 0:
            return upto(b)
        s, h = mp.mpc(0, -k), b - a

        # by parts: ∫ f e^{sx} = [f/s - f'/s² + f''/s³] e^{sx}
        def primitive(x: Any) -> Any:
            f, f1, f2 = c[0] + c[1] * x + c[2] * x**2, c[1] + 2 * c[2] * x, 2 * c[2]
            return (f / s - f1 / s**2 + f2 / s**3) * mp.exp(s * x)

        return mp.exp(s * a) * (primitive(h) - primitive(mp.mpf(0)))

    return integral, upto


def window(r: random.Random) -> Part:
    """A tool that works from one angle to another, a millionth of a turn to a third of it, by a square of the way."""
    width = 10.0 ** r.uniform(-5.0, 0.3)
    a = r.uniform(0.1, 6.2 - width)
    b = a + width
    scale = r.choice([1.0, 1.0 / width])
    c = tuple(scale * r.uniform(-100.0, 100.0) for _ in range(3))
    c = (c[0], c[1] / width, c[2] / width**2)
    x = f"({wrapped()} - {a!r})"
    law = f"({c[0]!r} + {c[1]!r}*{x} + {c[2]!r}*{x}**2 if {wrapped()} > {a!r} and {wrapped()} < {b!r} else 0)"
    integral, upto = polynomial_piece(mp.mpf(a), mp.mpf(b), c)

    def value(x: Any) -> Any:
        h = x - mp.mpf(a)
        return c[0] + c[1] * h + c[2] * h**2 if mp.mpf(a) < x < mp.mpf(b) else mp.mpf(0)

    return Part(law, "", integral, upto, (a, b), value)


def wave(r: random.Random) -> Part:
    """A wave of any order up to 300."""
    n, size, phase = r.choice([1, 2, 5, 30, 101, 300]), r.uniform(-50.0, 50.0), r.uniform(0.0, 6.0)

    def integral(k: int) -> Any:
        return mp.pi * size * mp.exp(mp.mpc(0, -phase)) if k == n else mp.mpf(0)

    def work(x: Any) -> Any:
        return size * (mp.sin(n * x - phase) + mp.sin(phase)) / n

    return Part(
        f"{size!r}*cos({n}*p.angle - {phase!r})", "", integral, work, (), lambda x: size * mp.cos(n * x - mp.mpf(phase))
    )


def flare(r: random.Random) -> Part:
    """A Gaussian, from a millionth to a fifth of a radian wide: nothing in its law tells where it is."""
    w, at = 10.0 ** r.uniform(-6.0, -0.7), r.uniform(2.0, 4.3)
    size = r.uniform(-50.0, 50.0) / r.choice([1.0, w])

    def integral(k: int) -> Any:
        return size * w * mp.sqrt(mp.pi) * mp.exp(mp.mpc(0, -k * mp.mpf(at))) * mp.exp(-((mp.mpf(k) * w) ** 2) / 4)

    def work(x: Any) -> Any:
        return size * w * mp.sqrt(mp.pi) / 2 * (mp.erf((x - at) / w) + mp.erf(mp.mpf(at) / w))

    law = f"{size!r}*exp(-(({wrapped()} - {at!r})/{w!r})**2)"
    return Part(law, "", integral, work, (at,), lambda x: size * mp.exp(-(((x - mp.mpf(at)) / w) ** 2)))


def held_table(r: random.Random) -> Part:
    """A table of straight pieces over a part of the turn, held outside."""
    count = r.randint(2, 8)
    x = sorted(r.uniform(0.2, 6.0) for _ in range(count))
    y = [r.uniform(-80.0, 80.0) for _ in x]
    name = f"t{r.randrange(10**9)}"
    pieces = [(0.0, x[0], y[0], y[0])]
    pieces += [(a, b, f, g) for a, b, f, g in zip(x[:-1], x[1:], y[:-1], y[1:], strict=True)]
    own = [polynomial_piece(mp.mpf(a), mp.mpf(b), (f, (g - f) / (mp.mpf(b) - mp.mpf(a)), 0.0)) for a, b, f, g in pieces]
    own.append(polynomial_piece(mp.mpf(x[-1]), TURN, (y[-1], 0.0, 0.0)))

    def value(at: Any) -> Any:
        for a, b, f, g in pieces:
            if at <= b:
                return f + (g - f) * (at - mp.mpf(a)) / (mp.mpf(b) - mp.mpf(a))
        return mp.mpf(y[-1])

    return Part(
        f"table({name}, {wrapped()})", f"  {name}: {{x: {x!r}, y: {y!r}, outside: hold}}\n",
        lambda k: sum((one(k) for one, _ in own), mp.mpf(0)), lambda at: sum((upto(at) for _, upto in own), mp.mpf(0)),
        (0.0, *x), value,
    )  # fmt: skip


KINDS = (window, window, wave, flare, held_table)


class Case(NamedTuple):
    """A shaft with its load."""

    parts: tuple[Part, ...]
    J: float

    def text(self, axis: int = 1, rate: float = RATE, begin: float = 0.0) -> str:
        """The scene; the angle is counted about the axis, so that the same law stands for the same load."""
        tables = "".join(part.table for part in self.parts)
        law = " + ".join(part.law for part in self.parts)
        return SCENE.format(
            J=self.J, axis=axis, rate=rate, begin=begin, law=law, tables=f"tables:\n{tables}" if tables else ""
        )


def drawn(seed: int) -> Case:
    """A case at random."""
    r = random.Random(seed)
    with mp.workdps(DIGITS):
        return Case(tuple(r.choice(KINDS)(r) for _ in range(r.randint(1, 3))), r.uniform(1.0, 9.0))


class Compared(NamedTuple):
    """A number with its reference and what heun says of its error."""

    what: str
    value: float
    wanted: float
    error: float

    @property
    def share(self) -> float:
        """The true error in stated ones."""
        if self.value == self.wanted:
            return 0.0
        return abs(self.value - self.wanted) / self.error if self.error > 0.0 else 1e99


def compared(case: Case, *, axis: int = 1, rate: float = RATE, begin: float = 0.0) -> list[Compared]:
    """Amplitudes and phases of some orders, mean, ΔE and the wheel."""
    asked = BalanceOptions(rate=rate, turns=1, orders=ORDERS, flywheel=FlywheelRequest("", 0.01))
    found = balance(load("scene.yaml", case.text(axis, rate, begin)), asked)
    with mp.workdps(DIGITS):
        return [*of_orders(case, found), *of_wheel(case, found, abs(rate))]


def of_orders(case: Case, found: BalanceResults) -> list[Compared]:
    """Both parts of some orders, and the mean."""
    rows = {row.order: row for row in found.orders["load"]}
    numbers = []
    for k in ORDERS:
        a = sum((part.integral(k) for part in case.parts), mp.mpf(0)) / mp.pi
        row = rows[float(k)]
        size, phase = float(row.amplitude[0]), float(row.phase[0])
        numbers += [
            Compared(f"order {k}", size * math.cos(phase), float(mp.re(a)), row.error),
            Compared(f"order {k}", size * math.sin(phase), -float(mp.im(a)), row.error),
        ]
    mean = float(mp.re(sum((part.integral(0) for part in case.parts), mp.mpf(0))) / TURN)
    numbers.append(Compared("mean", found.mean["load"], mean, found.mean_error["load"]))
    return numbers


def of_wheel(case: Case, found: BalanceResults, rate: float) -> list[Compared]:
    """ΔE between the lowest and the highest of the work less its mean, and the textbook's wheel."""
    wheel = found.flywheel
    assert wheel is not None
    mean = mp.re(sum((part.integral(0) for part in case.parts), mp.mpf(0))) / TURN
    work = [case_work(case, x) - mean * x for x in turning_points(case, mean)]
    energy = max(work) - min(work)
    textbook = energy / (mp.mpf(0.01) * mp.mpf(rate) ** 2) - mp.mpf(case.J)
    return [
        Compared("energy", wheel.energy, float(energy), wheel.error["energy"]),
        Compared("textbook", wheel.textbook, float(textbook), wheel.error["textbook"]),
    ]


def case_work(case: Case, x: Any) -> Any:
    """The work of all parts up to an angle."""
    return sum((part.work(x) for part in case.parts), mp.mpf(0))


def turning_points(case: Case, mean: Any) -> list[Any]:
    """Angles at which the work less its mean may be extreme: corners, and where the load passes its mean."""
    corners = sorted({0.0, *(x for part in case.parts for x in part.corners)})
    ends = [mp.mpf(x) for x in corners] + [TURN]
    found = [*ends]

    def load_at(x: Any) -> Any:
        return sum((part.value(x) for part in case.parts), mp.mpf(0)) - mean

    for a, b in pairwise(ends):
        if b - a < mp.mpf(10) ** -30:
            continue
        places = [a + (b - a) * mp.mpf(j) / 600 for j in range(601)]
        # beside flares the ways are looked at by powers of ten, too
        places += [a + (b - a) * mp.mpf(10) ** (-j / mp.mpf(8)) for j in range(1, 80)]
        places += [b - (b - a) * mp.mpf(10) ** (-j / mp.mpf(8)) for j in range(1, 80)]
        places = sorted(set(places))
        values = [load_at(x) for x in places[1:-1]]
        for x, y, f, g in zip(places[1:-2], places[2:-1], values[:-1], values[1:], strict=True):
            if f * g < 0:
                low, high, at_low = x, y, f
                for _ in range(60):
                    middle = (low + high) / 2
                    at = load_at(middle)
                    if at * at_low > 0:
                        low, at_low = middle, at
                    else:
                        high = middle
                found.append(low)
    return found


def main() -> None:
    """Compare so many cases."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--cases", type=int, default=100)
    parser.add_argument("--first", type=int, default=0)
    asked = parser.parse_args()
    shares: Counter[str] = Counter()
    worst: list[tuple[float, int, Compared]] = []
    for seed in range(asked.first, asked.first + asked.cases):
        for own in compared(drawn(seed)):
            shares["0" if own.share == 0.0 else f"1e{math.ceil(math.log10(own.share)):+d}"] += 1
            if own.share > 1.0:
                worst.append((own.share, seed, own))
    print(f"{sum(shares.values())} numbers of {asked.cases} cases; true over stated error, up to:")
    for name, count in sorted(shares.items(), key=lambda item: -math.inf if item[0] == "0" else float(item[0])):
        print(f"  {name:>6} {count}")
    for share, seed, own in sorted(worst, key=lambda item: -item[0])[:20]:
        print(f"beyond: seed {seed}, {own}, {share:.3g}")


if __name__ == "__main__":
    main()
