"""Random courses of a load, kept in a golden file, and true changes of them that leave the extremes where they are.

A weld carries the load, so that its force is the course, and the reference is the course itself: dense samples of the
formula in NumPy. A change has to be found where it is above what both runs state; the same course told otherwise
(other samples, another order of terms) must not be.

    python -m tests.honesty.golden_courses --cases 1000
"""

from __future__ import annotations

import argparse
import collections
import math
import random
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from heuncli.output.snapshots.changes import find_changes
from heuncli.output.snapshots.golden_file import RunSnapshot
from heuncli.output.snapshots.take_snapshot import take_run_snapshot
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve

DENSE = np.linspace(0.0, 1.0, 200_001)
LEAST_WIDTH = 0.012  # of a pulse that has to be seen between fixed instants, of a run of length 1
KINDS = ("shift", "second peak", "frequency", "phase", "sign", "one sample", "same")
SCENE = """
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{a: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{o: [0, 0, 0]}}}}}}
joints: {{w: {{type: weld, from: ground.O, to: a.o}}}}
{tables}
forces: {{f: {{type: force, on: a.o, vector: ["{law}", 0, 0]}}}}
analysis: {{duration: 1, samples: {samples}}}
"""


class Pulse(NamedTuple):
    """A triangle or a bell: its height, its middle, half its width."""

    height: float
    at: float
    width: float
    bell: bool

    @property
    def law(self) -> str:
        """As a spec writes it."""
        x = f"(t-{self.at!r})/{self.width!r}"
        return f"{self.height!r}*" + (f"exp(-({x})**2)" if self.bell else f"max(0,1-abs({x}))")

    def values(self) -> np.ndarray:
        """At the dense instants."""
        x = (DENSE - self.at) / self.width
        return self.height * (np.exp(-(x**2)) if self.bell else np.maximum(0.0, 1.0 - np.abs(x)))


class Course(NamedTuple):
    """Pulses, a wave (height, frequency, phase), and a table of samples."""

    pulses: tuple[Pulse, ...]
    wave: tuple[float, float, float]
    table: tuple[float, ...]

    def spec(self, samples: int, *, turned: bool = False) -> str:
        """The scene; turned: with its terms in another order."""
        height, frequency, phase = self.wave
        terms = [pulse.law for pulse in self.pulses]
        terms.append(f"{height!r}*sin(2*pi*{frequency!r}*t+{phase!r})")
        terms += ["table(c, t)"] if self.table else []
        x = ", ".join(f"{k / (len(self.table) - 1)!r}" for k in range(len(self.table)))
        tables = f"tables: {{c: {{x: [{x}], y: [{', '.join(map(repr, self.table))}]}}}}" if self.table else ""
        return SCENE.format(law=" + ".join(terms[::-1] if turned else terms), tables=tables, samples=samples)

    def values(self) -> np.ndarray:
        """At the dense instants."""
        height, frequency, phase = self.wave
        found = height * np.sin(2.0 * np.pi * frequency * DENSE + phase)
        for pulse in self.pulses:
            found = found + pulse.values()
        if self.table:
            found = found + np.interp(DENSE, np.linspace(0.0, 1.0, len(self.table)), self.table)
        return found


class Case(NamedTuple):
    """Two courses, what changed, and whether that has to be found; size: the largest change."""

    kind: str
    before: Course
    after: Course
    size: float
    told: bool


class Outcome(NamedTuple):
    """A case with what was told: how many changes; excess: the largest change over the stated error of both."""

    case: Case
    changes: int
    excess: float

    @property
    def is_right(self) -> bool:
        """Whether a change was found where one has to be, and none where there is none."""
        return self.changes == 0 if self.case.kind == "same" else self.changes > 0 or not self.case.told


def drawn(seed: int) -> Case:
    """One case."""
    draw = random.Random(seed)
    kind = KINDS[seed % len(KINDS)]
    great = Pulse(100.0, draw.uniform(0.08, 0.92), draw.uniform(LEAST_WIDTH, 0.06), draw.random() < 0.5)
    small = Pulse(
        draw.uniform(20.0, 60.0), draw.uniform(0.08, 0.92), draw.uniform(LEAST_WIDTH, 0.06), draw.random() < 0.5
    )
    while abs(small.at - great.at) < 4.0 * (small.width + great.width):
        small = small._replace(at=draw.uniform(0.02, 0.98), width=0.5 * small.width + 0.5 * LEAST_WIDTH)
    waved = kind in ("frequency", "phase", "sign") or draw.random() < 0.3
    wave = (draw.uniform(1.0, 8.0) if waved else 0.0, draw.uniform(0.5, 9.0), draw.uniform(0.0, 6.0))
    table = tuple(draw.uniform(-5.0, 5.0) for _ in range(101)) if kind == "one sample" else ()
    before = Course((great, small), wave, table)
    step = 10.0 ** draw.uniform(-5.0, 0.0)
    after = changed(before, kind, step, draw)
    difference = after.values() - before.values()
    size = float(np.abs(difference).max())
    return Case(kind, before, after, size, size > 1e-5)


def changed(course: Course, kind: str, step: float, draw: random.Random) -> Course:
    """The course with a change of some size, relative to what is usual of its kind."""
    great, small = course.pulses
    height, frequency, phase = course.wave
    if kind == "shift":
        side = math.copysign(1.0, 0.5 - small.at)
        return course._replace(pulses=(great, small._replace(at=small.at + side * 0.1 * step)))
    if kind == "second peak":
        return course._replace(pulses=(great, small._replace(height=small.height + 39.0 * step * 0.9)))
    if kind == "frequency":
        return course._replace(wave=(height, frequency * (1.0 + 0.5 * step), phase))
    if kind == "phase":
        return course._replace(wave=(height, frequency, phase + step))
    if kind == "sign":
        return course._replace(wave=(-height, frequency, phase))
    if kind == "one sample":
        k = draw.choice([k for k in range(1, 100) if k % 10])
        table = list(course.table)
        table[k] += 4.0 * step
        return course._replace(table=tuple(table))
    return course


def kept(text: str) -> RunSnapshot:
    """The numbers of a scene as a golden file holds them."""
    wanted = frozenset({"joints"})
    return take_run_snapshot(solve(load("course.yaml", text), Options(requested_reports=wanted)), wanted)


def look_at(case: Case) -> Outcome:
    """What heun tells of a case."""
    same = case.kind == "same"
    one, other = kept(case.before.spec(101)), kept(case.after.spec(57 if same else 101, turned=same))
    number, later = (run.numbers["joints.w.force.x"] for run in (one, other))
    found = [change for change in find_changes(one, other) if change.path.startswith("joints.w.force")]
    return Outcome(case, len(found), case.size / (number.error + later.error))


def outcomes(seeds: range) -> Iterator[Outcome]:
    """Of many cases."""
    for seed in seeds:
        yield look_at(drawn(seed))


def main() -> int:
    """Print how many cases were told rightly, by kind, and the sizes of changes that were not found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=700)
    parser.add_argument("--first", type=int, default=0)
    asked = parser.parse_args()
    by_kind: dict[str, collections.Counter[str]] = {}
    sizes: collections.Counter[int] = collections.Counter()
    wrong = 0
    for outcome in outcomes(range(asked.first, asked.first + asked.cases)):
        word = "found" if outcome.changes else "not found"
        by_kind.setdefault(outcome.case.kind, collections.Counter())[word] += 1
        if outcome.changes and outcome.excess > 0.0:
            sizes[math.floor(math.log10(outcome.excess))] += 1
        if not outcome.is_right:
            wrong += 1
            print("WRONG", outcome.case.kind, f"size {outcome.case.size:.3g}, {outcome.excess:.3g} times the errors")
    for kind, counts in by_kind.items():
        print(f"{kind:12} {dict(counts)}")
    print("found, by powers of ten of change over stated error:", dict(sorted(sizes.items())))
    print(f"{wrong} wrong of {asked.cases}")
    return int(wrong > 0)


if __name__ == "__main__":
    raise SystemExit(main())
