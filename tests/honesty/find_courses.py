"""`heun find` on random courses whose meetings, edges and jumps are known in closed form, by the whole command.

    python -m tests.honesty.find_courses --cases 1000 [--seed FIRST] [--kind KIND] [--direct]

The measure is a force that a spec gives as an expression of the parameter x; the reference is solved by mpmath with 40
digits and shares nothing with heun. With --direct Python evaluates the formula, with the error that such a run states,
and heun's search alone is looked at: a hundred times faster. Prints what is missed or falsely told, the mean number of
variants of each kind, and how the true errors of places are spread over the stated ones.
"""

from __future__ import annotations

import argparse
import json
import math
import tempfile
from collections import Counter, defaultdict
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import mpmath as mp
import numpy as np

from heuncli.analyses.find.results import FindResults
from heuncli.analyses.find.study import find_meetings
from heuncli.analyses.variants.conditions import Comparison
from heuncli.analyses.variants.parameters import DesignVariable
from heuncli.analyses.variants.samples import Sample
from heuncli.app.cli.entry import enter
from heuncli.app.commands.find.as_json import to_block
from heuncli.output.documents.as_data import dump_json

Rng = np.random.Generator
EPS = 2.0**-52
STATED = 1e-12  # of a force, by a run that is one instant
RELATIONS = ("=", "<", ">", "<=", ">=")
BINS = (1e-3, 1e-2, 0.1, 0.3, 0.5, 0.8, 1.0, 2.0, 10.0)
ROUNDINGS = 8.0  # of x and of the expression: what a place is not told better than
PROBES = 60  # places at which it is looked whether an inequality is met

SPEC = """\
heun: 1
title: A force that follows a formula
parameters: {{x: {start!r}, F: "{formula}"}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  a: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{o: [0, 0, 0]}}}}
joints:
  w: {{type: weld, from: ground.O, to: a.o}}
forces:
  f: {{type: force, on: a.o, vector: [-F, 0, 0]}}
analysis: {{type: state}}
"""


class KnownCourse(NamedTuple):
    """A formula of x over an interval, and what is true of it.

    value: what it is held against; f: in mpmath (None outside of its domain); roots: where it passes the value;
    touches: where it comes to it from one side; breaks: where it jumps or has a pole; edges: where it ends; rounding:
    by how much x itself is not known at each root, where the formula magnifies roundings.
    """

    kind: str
    formula: str
    low: float
    high: float
    value: float
    f: Callable[[Any], Any]
    roots: tuple[Any, ...] = ()
    touches: tuple[Any, ...] = ()
    breaks: tuple[Any, ...] = ()
    edges: tuple[Any, ...] = ()
    flat: tuple[tuple[float, float], ...] = ()


class Verdict(NamedTuple):
    """What is wrong with what is told (empty: nothing), the runs it took, and true over stated errors of places."""

    wrong: list[str]
    runs: int
    ratios: list[float]
    told: Any


def inside(low: float, high: float, roots: Any) -> tuple[Any, ...]:
    return tuple(sorted(root for root in roots if low < root < high))


def ends(rng: Rng) -> tuple[float, float]:
    low = float(rng.choice([0.0, -1.0, rng.uniform(-5.0, 5.0), 100.0]))
    return low, low + float(10.0 ** rng.uniform(-0.5, 1.5))


def place(rng: Rng, low: float, high: float) -> float:
    return low + float(rng.uniform(0.08, 0.92)) * (high - low)


def resonance(rng: Rng) -> KnownCourse:
    """An amplitude over the frequency: 1/sqrt((1 - r^2)^2 + (2 z r)^2), r = x/c."""
    low, width = float(rng.uniform(0.05, 0.5)), float(rng.uniform(1.2, 8.0))
    c, z = float(low + rng.uniform(0.15, 0.85) * width), float(10.0 ** rng.uniform(-3.5, -0.4))
    formula = f"1/sqrt((1-(x/{c!r})**2)**2+(2*{z!r}*x/{c!r})**2)"
    C, Z = mp.mpf(c), mp.mpf(z)
    f = lambda x: 1 / mp.sqrt((1 - (x / C) ** 2) ** 2 + (2 * Z * x / C) ** 2)  # noqa: E731
    peak = float(1 / (2 * Z * mp.sqrt(1 - Z * Z)))
    value = float(rng.choice([peak * rng.uniform(0.3, 0.999), math.exp(rng.uniform(math.log(0.3), math.log(peak)))]))
    if rng.random() < 0.1:
        value = peak * float(rng.uniform(1.0001, 2.0))
    b, V = 2 * Z * Z - 1, mp.mpf(value)
    under = b * b - 1 + 1 / V**2
    squares = [-b - mp.sqrt(under), -b + mp.sqrt(under)] if under >= 0 else []
    return KnownCourse(
        "resonance", formula, low, low + width, value, f,
        inside(low, low + width, [C * mp.sqrt(s) for s in squares if s > 0]),
    )  # fmt: skip


def rational(rng: Rng) -> KnownCourse:
    """A cubic over a parabola that may have zeros: poles."""
    low, high = -1.0, float(rng.uniform(0.5, 3.0))
    p = [round(float(c), 3) for c in rng.normal(size=4)]
    a, c = place(rng, low, high), float(10.0 ** rng.uniform(-2.5, 0.5) * rng.choice([1.0, -1.0]))
    formula = f"({p[0]!r}*x**3+{p[1]!r}*x**2+{p[2]!r}*x+{p[3]!r})/((x-{a!r})**2+{c!r})"
    A, C = mp.mpf(a), mp.mpf(float(c))
    P = [mp.mpf(each) for each in p]
    f = lambda x: mp.polyval(P, x) / ((x - A) ** 2 + C)  # noqa: E731
    value = float(f(mp.mpf(place(rng, low, high)))) if rng.random() < 0.7 else float(rng.normal())
    V = mp.mpf(value)
    q = [0, V, -2 * A * V, V * (A * A + C)]
    found = mp.polyroots([x - y for x, y in zip(P, q, strict=True)], maxsteps=500, extraprec=200)
    roots = [mp.re(root) for root in found if abs(mp.im(root)) < mp.mpf(10) ** -25]
    poles = [A - mp.sqrt(-C), A + mp.sqrt(-C)] if C < 0 else []
    return KnownCourse("rational", formula, low, high, value, f, inside(low, high, roots), (), inside(low, high, poles))


def pole(rng: Rng) -> KnownCourse:
    """k/(x - p)^n beyond all bounds; n = 1 changes its sign."""
    low, high = ends(rng)
    p, k, n = place(rng, low, high), float(rng.normal()) or 1.0, int(rng.choice([1, 2]))
    reach = float(10.0 ** rng.uniform(-7.0, -0.3)) * (high - low)
    value = k / reach**n * float(rng.choice([1.0, -1.0] if n == 1 else [1.0]))
    P, K, V = mp.mpf(p), mp.mpf(k), mp.mpf(value)
    f = lambda x: K / (x - P) ** n if x != P else None  # noqa: E731
    roots = [P + K / V] if n == 1 else [P - mp.sqrt(K / V), P + mp.sqrt(K / V)]
    return KnownCourse(
        f"pole {n}", f"{k!r}/(x-{p!r})**{n}", low, high, value, f, inside(low, high, roots), (),
        (P,) if n == 1 else (),
    )  # fmt: skip


def edge(rng: Rng, inverse: bool) -> KnownCourse:
    """k sqrt(x - e), or its inverse, on one side of e alone."""
    low, high = ends(rng)
    e, k, way = place(rng, low, high), float(rng.uniform(0.1, 10.0)), float(rng.choice([1.0, -1.0]))
    room = (high - e) if way > 0.0 else (e - low)
    distance = float(10.0 ** rng.uniform(-11.0, 0.2)) * room
    E, K = mp.mpf(e), mp.mpf(k)
    W = mp.mpf(way)
    body = f"sqrt(x-{e!r})" if way > 0.0 else f"sqrt({e!r}-x)"
    if inverse:
        f = lambda x: K / mp.sqrt(W * (x - E)) if W * (x - E) > 0 else None  # noqa: E731
        value = k / math.sqrt(distance)
        root = E + W * (K / mp.mpf(value)) ** 2
    else:
        f = lambda x: K * mp.sqrt(W * (x - E)) if W * (x - E) >= 0 else None  # noqa: E731
        value = k * math.sqrt(distance)
        root = E + W * (mp.mpf(value) / K) ** 2
    return KnownCourse(
        "1/sqrt edge" if inverse else "sqrt edge", f"{k!r}/{body}" if inverse else f"{k!r}*{body}",
        low, high, value, f, inside(low, high, [root]), (), (), (E,),
    )  # fmt: skip


def sqrt_edge(rng: Rng) -> KnownCourse:
    return edge(rng, inverse=False)


def inverse_edge(rng: Rng) -> KnownCourse:
    return edge(rng, inverse=True)


def touch(rng: Rng) -> KnownCourse:
    """k |x - c|^p + v against v, or against a little less or more than v."""
    low, high = ends(rng)
    c, k = place(rng, low, high), float(rng.choice([1.0, -1.0]) * 10.0 ** rng.uniform(-2.0, 2.0))
    p = rng.choice([1.0, 1.5, 2.0, 2.0, 4.0])
    v = float(rng.choice([0.0, 0.0, rng.uniform(-5.0, 5.0)]))
    off = 0.0 if rng.random() < 0.6 else float(rng.choice([1.0, -1.0]) * 10.0 ** rng.uniform(-8.0, -0.5))
    value = v + k * off
    C, K, V, P = mp.mpf(c), mp.mpf(k), mp.mpf(v), mp.mpf(float(p))
    f = lambda x: K * abs(x - C) ** P + V  # noqa: E731
    formula = f"{k!r}*abs(x-{c!r})**{float(p)!r}+{v!r}"
    rest = (mp.mpf(value) - V) / K
    near = rest ** (1 / P) if rest > 0 else mp.mpf(0)
    roots = inside(low, high, [C - near, C + near]) if rest > 0 else ()
    return KnownCourse("touch", formula, low, high, value, f, roots, (C,) if rest == 0 else ())


def plateau(rng: Rng) -> KnownCourse:
    """A ramp between two levels, against one within, or against one of both."""
    low, high = ends(rng)
    a, b = sorted((place(rng, low, high), place(rng, low, high)))
    one, two = (float(each) for each in rng.uniform(-5.0, 5.0, 2))
    slope = (two - one) / (b - a)
    line = f"({one!r}+{slope!r}*(x-{a!r}))"
    least, most = min(one, two), max(one, two)
    formula = f"min(max({line}, {least!r}), {most!r})"
    A, ONE, S = mp.mpf(a), mp.mpf(one), mp.mpf(slope)
    f = lambda x: min(max(ONE + S * (x - A), mp.mpf(least)), mp.mpf(most))  # noqa: E731
    value = float(rng.choice([one, two, rng.uniform(least, most), least - 1.0]))
    level = A + (mp.mpf(value) - ONE) / S
    if value == one:
        return KnownCourse("plateau", formula, low, high, value, f, flat=((low, float(level)),))
    if value == two:
        return KnownCourse("plateau", formula, low, high, value, f, flat=((float(level), high),))
    roots = inside(low, high, [level]) if least < value < most else ()
    return KnownCourse("plateau", formula, low, high, value, f, roots)


def jump(rng: Rng) -> KnownCourse:
    """Two lines with a jump between them."""
    low, high = ends(rng)
    j = place(rng, low, high)
    a, b, c, d = (float(each) for each in rng.normal(size=4))
    formula = f"({a!r}+{b!r}*(x-{j!r})) if x < {j!r} else ({c!r}+{d!r}*(x-{j!r}))"
    J = mp.mpf(j)
    f = lambda x: mp.mpf(a) + mp.mpf(b) * (x - J) if x < J else mp.mpf(c) + mp.mpf(d) * (x - J)  # noqa: E731
    value = float(rng.choice([rng.normal(), 0.5 * (a + c), a + 1e-3 * b]))
    V = mp.mpf(value)
    roots = [*inside(low, j, [J + (V - mp.mpf(a)) / mp.mpf(b)]), *inside(j, high, [J + (V - mp.mpf(c)) / mp.mpf(d)])]
    return KnownCourse(
        "jump", formula, low, high, value, f, tuple(roots), (), (J,) if (a - value) * (c - value) < 0 else ()
    )


def kink(rng: Rng) -> KnownCourse:
    """The larger magnitude of two lines."""
    low, high = ends(rng)
    a, b = place(rng, low, high), place(rng, low, high)
    k, m = (float(each) for each in rng.uniform(0.2, 4.0, 2))
    f = lambda x: max(mp.mpf(k) * abs(x - mp.mpf(a)), mp.mpf(m) * abs(x - mp.mpf(b)))  # noqa: E731
    formula = f"max({k!r}*abs(x-{a!r}), {m!r}*abs(x-{b!r}))"
    value = float(f(mp.mpf(place(rng, low, high)))) * float(rng.choice([1.0, 0.8]))
    V = mp.mpf(value)
    roots = [mp.mpf(p) + w * V / mp.mpf(s) for p, s in ((a, k), (b, m)) for w in (-1, 1)]
    tiny = mp.mpf(10) ** -30
    return KnownCourse("kink", formula, low, high, value, f, inside(low, high, [x for x in roots if f(x) - V < tiny]))


def zero(rng: Rng) -> KnownCourse:
    """A polynomial of known zeros, some of them double."""
    low, high = -1.0, 1.0
    count = int(rng.integers(1, 4))
    found = sorted(float(x) for x in rng.uniform(-0.95, 0.95, count))
    if min((b - a for a, b in pairwise(found)), default=1.0) < 0.02:
        return zero(rng)
    powers = [int(each) for each in rng.choice([1, 1, 1, 2, 3], count)]
    k = float(10.0 ** rng.uniform(-3.0, 3.0))
    formula = f"{k!r}" + "".join(f"*(x-({x!r}))**{n}" for x, n in zip(found, powers, strict=True))
    f = lambda x: mp.mpf(k) * mp.fprod((x - mp.mpf(r)) ** n for r, n in zip(found, powers, strict=True))  # noqa: E731
    odd = tuple(mp.mpf(x) for x, n in zip(found, powers, strict=True) if n % 2)
    even = tuple(mp.mpf(x) for x, n in zip(found, powers, strict=True) if n % 2 == 0)
    return KnownCourse("zero", formula, low, high, 0.0, f, odd, even)


def steep(rng: Rng) -> KnownCourse:
    """Continuous, and as good as upright at one place: a power below 1, or a switch that is smoothed."""
    low, high = ends(rng)
    c, v = place(rng, low, high), float(rng.choice([0.0, rng.normal()]))
    C, V = mp.mpf(c), mp.mpf(v)
    if rng.random() < 0.5:
        p = float(rng.uniform(0.1, 0.9))
        f = lambda x: V + mp.sign(x - C) * abs(x - C) ** mp.mpf(p)  # noqa: E731
        formula = f"{v!r}+sign(x-{c!r})*abs(x-{c!r})**{p!r}"
    else:
        s = float(10.0 ** rng.uniform(1.0, 8.0)) / (high - low)
        f = lambda x: V + mp.tanh(mp.mpf(s) * (x - C))  # noqa: E731
        formula = f"{v!r}+tanh({s!r}*(x-{c!r}))"
    return KnownCourse("steep", formula, low, high, v, f, (C,))


def wave(rng: Rng) -> KnownCourse:
    """A sine of up to two turns, above or below a slope."""
    low, high = 0.0, 1.0
    w, p = float(rng.uniform(1.0, 12.0)), float(rng.uniform(0.0, 6.0))
    value = float(rng.uniform(-1.2, 1.2))
    f = lambda x: mp.sin(mp.mpf(w) * x + mp.mpf(p))  # noqa: E731
    roots: list[Any] = []
    if abs(value) < 1.0:
        first = mp.asin(mp.mpf(value))
        for turn in range(-2, 5):
            for base in (first, mp.pi - first):
                roots.append((base + 2 * mp.pi * turn - mp.mpf(p)) / mp.mpf(w))
    return KnownCourse("wave", f"sin({w!r}*x+{p!r})", low, high, value, f, inside(low, high, roots))


def gap(rng: Rng) -> KnownCourse:
    """Two branches on both sides of a stretch where there is none."""
    low, high = ends(rng)
    a, b = sorted((place(rng, low, high), place(rng, low, high)))
    b = max(b, a + 0.02 * (high - low))
    A, B = mp.mpf(a), mp.mpf(b)
    f = lambda x: 1 / mp.sqrt((x - A) * (x - B)) if (x - A) * (x - B) > 0 else None  # noqa: E731
    value = float(10.0 ** rng.uniform(-1.0, 5.0)) / (high - low)
    s = mp.sqrt(((A - B) / 2) ** 2 + 1 / mp.mpf(value) ** 2)
    return KnownCourse(
        "gap", f"1/sqrt((x-{a!r})*(x-{b!r}))", low, high, value, f,
        inside(low, high, [(A + B) / 2 - s, (A + B) / 2 + s]), (), (), inside(low, high, (A, B)),
    )  # fmt: skip


KINDS: dict[str, Callable[[Rng], KnownCourse]] = {
    "resonance": resonance, "rational": rational, "pole": pole, "sqrt_edge": sqrt_edge, "inverse_edge": inverse_edge,
    "touch": touch, "plateau": plateau, "jump": jump, "kink": kink, "zero": zero, "steep": steep, "wave": wave,
    "gap": gap,
}  # fmt: skip


def course_of(seed: int, kind: str = "all") -> tuple[KnownCourse, str]:
    """A course and the relation that is looked for."""
    mp.mp.dps = 40
    names = [*KINDS] if kind == "all" else [kind]
    rng = np.random.default_rng([seed, 2301])
    course = KINDS[names[seed % len(names)]](rng)
    relation = "=" if rng.random() < 0.5 else str(rng.choice(RELATIONS[1:]))
    return course, relation


def found_in(course: KnownCourse, relation: str, folder: Path) -> Any:
    """What the command tells of it."""
    spec, out = folder / "course.yaml", folder / "found.json"
    start = next(
        x for x in np.linspace(course.low, course.high, 1009)[1:-1].tolist() if course.f(mp.mpf(x)) is not None
    )
    spec.write_text(SPEC.format(start=start, formula=course.formula), encoding="utf-8")
    condition = f"joints.w.force.x {relation} {course.value!r}"
    words = [
        "find",
        str(spec),
        f"x={course.low!r}:{course.high!r}",
        condition,
        "--format",
        "json",
        "-o",
        str(out),
        "-q",
    ]
    assert enter(words) == 0, course
    return json.loads(out.read_text(encoding="utf-8"))


def found_directly(course: KnownCourse, relation: Any) -> Any:
    """What the search tells of the formula itself, evaluated by Python."""
    names = {each: getattr(math, each) for each in ("sqrt", "sin", "tanh")}
    names |= {"abs": abs, "min": min, "max": max, "sign": lambda x: (x > 0.0) - (x < 0.0)}
    code = compile(course.formula, "formula", "eval")

    def ask(x: float) -> Sample:
        try:
            m = float(eval(code, names, {"x": x}))
        except (ValueError, ZeroDivisionError, OverflowError):
            return Sample(x, None, why=("not-computable", "not a finite number"))
        return Sample(x, m - course.value, max(STATED * abs(m), 8.0 * EPS * (abs(m) + abs(course.value))))

    found = find_meetings(ask, course.low, course.high, relation, scan_count=7, max_evaluations=300, value=course.value)
    condition = Comparison("f", relation, course.value, "N")
    interval = DesignVariable("x", course.low, course.high, "")
    return json.loads(dump_json(to_block(FindResults("", condition, interval, found, 7))))


def judged(seed: int, kind: str = "all", *, direct: bool = False) -> tuple[KnownCourse, str, Verdict]:
    """A random course, the relation, and what is wrong with what is told of it."""
    course, relation = course_of(seed, kind)
    if direct:
        told = found_directly(course, relation)
    else:
        with tempfile.TemporaryDirectory() as made:
            told = found_in(course, relation, Path(made))
    wrong: list[str] = []
    ratios: list[float] = []
    if not told["complete"]:
        wrong.append("not complete")
    _crossings(course, told, wrong, ratios)
    _touches(course, told, wrong)
    _jumps(course, told, wrong)
    _edges(course, told, wrong)
    if relation != "=":
        _met(course, relation, told, wrong)
    return course, relation, Verdict(wrong, told["runs"], ratios, told)


def _rounding(course: KnownCourse, x: Any) -> float:
    """By how much a place is not known: x is rounded, and so is what the formula takes of it."""
    return ROUNDINGS * EPS * max(abs(float(x)), abs(course.low), abs(course.high))


def _crossings(course: KnownCourse, told: Any, wrong: list[str], ratios: list[float]) -> None:
    """Every root within the error of a crossing, and every crossing within its error of a root."""
    open_ = [(t["from"], t["to"]) for t in told["touches"]] + list(course.flat) + left_open(told)
    for root in course.roots:
        near = [abs(float(mp.mpf(one["x"]) - root)) - one["error"] for one in told["crossings"]]
        reach = _rounding(course, root)
        if min(near, default=math.inf) > reach and not any(a - reach <= root <= b + reach for a, b in open_):
            wrong.append("missed a crossing")
    for one in told["crossings"]:
        off = min(
            (abs(float(mp.mpf(one["x"]) - x)) for x in (*course.roots, *course.touches, *course.edges)),
            default=math.inf,
        )
        off = min(
            [off, *(0.0 if a <= one["x"] <= b else min(abs(one["x"] - a), abs(one["x"] - b)) for a, b in course.flat)]
        )
        if off > one["error"] + _rounding(course, one["x"]):
            wrong.append("false crossing" if off > 1e-6 * (course.high - course.low) else "crossing out of its error")
        if one["error"] > 0.0:
            ratios.append(max(off - _rounding(course, one["x"]), 0.0) / one["error"])


def left_open(told: Any) -> list[tuple[float, float]]:
    """Where it is said that a meeting is not excluded."""
    return [(one["from"]["x"], one["to"]["x"]) for one in told["not_excluded"]]


def _touches(course: KnownCourse, told: Any, wrong: list[str]) -> None:
    close = 1e-9 * (course.high - course.low)
    for x in course.touches:
        reached = [(one["from"], one["to"]) for one in told["touches"]]
        reached += left_open(told)
        reached += [(one["x"] - one["error"], one["x"] + one["error"]) for one in told["crossings"]]
        if not any(a - close <= x <= b + close for a, b in reached):
            wrong.append("missed a touch")
    for one in told["touches"]:
        if course.value == 0.0:
            zeros = (*course.touches, *course.roots, *(x for pair in course.flat for x in pair))
            if not any(one["from"] - close <= x <= one["to"] + close for x in zeros):
                wrong.append("false touch")
            continue
        size = max(abs(course.value), abs(one["measure"]))
        known = course.f(mp.mpf(one["x"]))
        if known is None or abs(float(known - mp.mpf(course.value))) > 1e-11 * size + 1e-18 * abs(
            told["greatest"]["measure"]
        ):
            wrong.append("false touch")


def _jumps(course: KnownCourse, told: Any, wrong: list[str]) -> None:
    for one in told["jumps"]:
        reach = _rounding(course, one["to"]["x"])
        if not any(one["from"]["x"] - reach <= x <= one["to"]["x"] + reach for x in course.breaks):
            wrong.append("false jump")
    for x in course.breaks:
        if course.kind.startswith(("pole", "rational")):
            continue  # it need not pass the value there for the search to be right: roots are looked at above
        if not any(one["from"]["x"] <= x <= one["to"]["x"] for one in told["jumps"]):
            at = [*told["touches"], *told["crossings"]]
            if not any(abs(one["x"] - float(x)) <= 1e-9 * (course.high - course.low) for one in at):
                wrong.append("missed a jump")


def _edges(course: KnownCourse, told: Any, wrong: list[str]) -> None:
    """The edges of what is solved, within rounding."""
    ends_ = [x for one in told["unsolved"] for x in (one["from"], one["to"]) if course.low < x < course.high]
    for e in course.edges:
        if min((abs(float(mp.mpf(x) - e)) for x in ends_), default=math.inf) > _rounding(course, e):
            wrong.append("edge not at its place")
    for x in ends_:
        if course.edges and min(abs(float(mp.mpf(x) - e)) for e in course.edges) > _rounding(course, x):
            wrong.append("false edge")


def _met(course: KnownCourse, relation: str, told: Any, wrong: list[str]) -> None:
    """Met at all places within the stretches that are told and at no other, but for the errors of their ends."""
    compare = {
        "<": lambda g: g < 0, ">": lambda g: g > 0, "<=": lambda g: g <= 0, ">=": lambda g: g >= 0,
    }[relation]  # fmt: skip
    stretches = [(one["from"], one["to"]) for one in told["met"]]
    marks = [*course.roots, *course.touches, *course.breaks, *course.edges]
    rng = np.random.default_rng(7)
    places = [*rng.uniform(course.low, course.high, PROBES).tolist()]
    for mark in marks:  # close by what is known, too
        places += [float(mark) + way * 10.0**-k * (course.high - course.low) for k in (2, 4, 6) for way in (-1, 1)]
    for x in places:
        if not course.low < x < course.high or any(a <= x <= b for a, b in (*course.flat, *left_open(told))):
            continue
        value = course.f(mp.mpf(x))
        if value is None:
            continue
        gap_ = float(value - mp.mpf(course.value))
        if abs(gap_) <= 1e-11 * max(abs(course.value), abs(float(value))):
            continue
        edges = [edge for pair in stretches for edge in pair]
        if any(abs(x - edge["x"]) <= edge["error"] + _rounding(course, x) for edge in edges):
            continue
        is_told = any(a["x"] < x < b["x"] for a, b in stretches)
        if is_told != compare(gap_):
            wrong.append("told as met" if is_told else "not told as met")
            return


def binned(ratios: list[float]) -> str:
    counts = Counter(next((f"<= {b:g}" for b in BINS if r <= b), f"> {BINS[-1]:g}") for r in ratios)
    return ", ".join(
        f"{name}: {counts[name]}" for name in [*(f"<= {b:g}" for b in BINS), f"> {BINS[-1]:g}"] if counts[name]
    )


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.honesty.find_courses", description=__doc__)
    parser.add_argument("--kind", choices=["all", *KINDS], default="all")
    parser.add_argument("--cases", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0, help="of the first case")
    parser.add_argument("--direct", action="store_true", help="without runs")
    asked = parser.parse_args()
    found: dict[str, Counter[str]] = defaultdict(Counter)
    runs: dict[str, list[int]] = defaultdict(list)
    ratios: list[float] = []
    for seed in range(asked.seed, asked.seed + asked.cases):
        course, relation, verdict = judged(seed, asked.kind, direct=asked.direct)
        kind = course.kind
        runs[kind].append(verdict.runs)
        ratios += verdict.ratios
        for wrong in sorted(set(verdict.wrong)) or ["right"]:
            found[kind][wrong] += 1
        found[kind]["(not excluded said)"] += bool(verdict.told["not_excluded"])
        if verdict.wrong:
            roots = ", ".join(mp.nstr(x, 17) for x in (*course.roots, *course.touches))
            print(seed, kind, f"x={course.low!r}:{course.high!r}", relation, repr(course.value), course.formula,
                  verdict.wrong, f"roots {roots}", f"{verdict.runs} runs", flush=True)  # fmt: skip
    for kind in sorted(found):
        print(f"{kind:14s} {sum(runs[kind]) / len(runs[kind]):6.1f} variants  {dict(found[kind])}")
    every = [n for each in runs.values() for n in each]
    total = sum((each for each in found.values()), Counter())
    print(f"all {asked.cases}: {sum(every) / len(every):.1f} variants; {dict(total)}")
    print(f"true over stated error of places: {binned(ratios)}")


if __name__ == "__main__":
    main()
