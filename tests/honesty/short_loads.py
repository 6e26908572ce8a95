"""Scenes at random with short loads: in coordinates, rates and time, from a millionth of their range to all of it.

    python -m tests.honesty.short_loads FIRST COUNT

prints of so many scenes what each says of its error, and what that is against the motion from edge to edge
(tests/oracle/switched.py).
"""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Callable
from itertools import pairwise
from random import Random
from typing import NamedTuple

import numpy as np

from heuncli.base.errors import HeunError, SolveError
from tests.oracle.freedoms import MACHINES, Machine
from tests.oracle.spans import LASTING, SHORT, Span
from tests.oracle.switched import Chatters, Laborious, Load, Motion, Vector
from tests.shared.scenes import study

SAMPLES = 6
FACTOR = 2.0  # of what is told: an estimate, no bound
ROUNDING = 1e-14  # of the size, beside it
ABRUPT = 1e-10  # of the largest: more may not hang on how two integrations of the same motion are rounded
INSTANT = 1e-6  # s: the instant of a chattering, by the digits in which it is told


class Scene(NamedTuple):
    """without: the last state without the short loads; motion: a new one at a local tolerance."""

    machine: str
    text: str
    kinds: tuple[str, ...]
    last: float
    without: Vector
    motion: Callable[[float], Motion]


class Drawn(NamedTuple):
    """A scene with its motion at the samples and how far that may be wrong; or the instant from which it chatters."""

    scene: Scene
    wanted: Vector
    doubt: Vector
    crossings: int
    chatters: float | None = None


def scene(seed: int) -> Drawn:
    """A scene whose motion its edges do not make uncertain: drawn again as long as they do."""
    r = Random(seed)
    while True:
        one = draw(r, MACHINES[seed % len(MACHINES)](r))
        times = np.linspace(0.0, one.last, SAMPLES)[1:].tolist()
        fine, rough = one.motion(1e-13), one.motion(1e-11)
        start = fine.y
        try:
            wanted, other = np.vstack([start, fine.run(times)]), np.vstack([start, rough.run(times)])
        except Laborious:
            continue
        except Chatters as end:
            return Drawn(one, start[None, :], start, fine.crossings, end.at)
        doubt = np.abs(wanted - other).max(axis=0)
        if np.all(doubt <= ABRUPT * np.maximum(np.abs(wanted).max(axis=0), 1.0)):
            changed = np.abs(wanted[-1, :-1] - one.without[:-1]).max()
            doubt[:-1] += rounding(fine) * changed
            doubt[-1] += rounding(fine) * np.abs(wanted[:, -1]).max()
            return Drawn(one, wanted, doubt, fine.crossings)


def rounding(motion: Motion) -> float:
    """What the digits of their edges leave open of the loads: a short way between two places far from zero."""
    pieces = [(load.edges, b - a) for load in motion.loads for a, b in pairwise(load.edges)]
    return sum(4e-16 * max(map(abs, edges)) / width for edges, width in pieces)


def draw(r: Random, machine: Machine) -> Scene:
    """Some lasting loads, and in the ranges of the motion they make one to three more."""
    last = r.uniform(0.5, 2.0)
    lasting = list(always(r, machine))
    plain = Motion(machine, [load for _, load in lasting], 1e-11)
    start = plain.y
    free = np.vstack([start, plain.run(np.linspace(0.0, last, 60).tolist()[1:])])
    texts = [(load.on, text) for text, load in lasting] + list(enumerate(machine.springs))
    loads, tables, kinds = [load for _, load in lasting], "", []
    count = len(loads) + r.choice([1, 1, 2, 3])
    while len(loads) < count:
        kind, number, on = r.choice("txxu"), r.randrange(len(machine.names)), r.randrange(len(machine.names))
        n = len(machine.names)
        column = {"t": np.array([0.0, last]), "x": free[:, number], "u": free[:, n + number]}[kind]
        way = float(np.ptp(column))
        if way < 1e-3:
            continue
        shape = r.choice(SHORT if r.random() < 0.8 else LASTING)
        name, place, rate = machine.names[number]
        w = way * 10 ** r.uniform(-6, 0)
        span = Span({"t": "t", "x": f"{name}.{place}", "u": f"{name}.{rate}"}[kind],
                    float(column.min()) + (way - w) * r.random(), w, 1.0)  # fmt: skip
        F = strength(Load(on, kind, number, (), ()), machine, free, w if shape in SHORT else last)
        made = shape(r, span._replace(F=r.choice([-1, 1]) * F * r.uniform(0.05, 0.8)))
        loads.append(Load(on, kind, number, made.edges, made.laws, made.narrow))
        texts.append((on, made.text))
        tables += made.table
        kinds.append(f"{shape.__name__} in {kind}, {w / way:.0e}")
    forces = "".join(f'  f{k}: {{type: torque, joint: j{j}, value: "{text}"}}\n' for k, (j, text) in enumerate(texts))
    text = machine.text + (f"tables:\n{tables}" if tables else "")
    text += f"forces:\n{forces}analysis: {{duration: {last!r}, samples: {SAMPLES}}}\n"
    return Scene(machine.name, text, tuple(kinds), last, free[-1], lambda rtol: Motion(machine, loads, rtol))


def always(r: Random, machine: Machine) -> list[tuple[str, Load]]:
    """Constant pushes, and springs of single bodies."""
    found: list[tuple[str, Load]] = []
    for j, (name, place, _) in enumerate(machine.names):
        F = float(machine.inertia[j]) * r.uniform(-2, 2)
        k = float(machine.inertia[j]) * 10 ** r.uniform(0, 2)
        if r.random() < 0.4:
            found.append((repr(F), Load(j, "t", 0, (), (lambda v, F=F: F,))))
        if machine.name in ("block", "wheel") and r.random() < 0.5:
            found.append((f"-{k!r}*{name}.{place}", Load(j, "x", j, (), (lambda v, k=k: -k * v,))))
    return found


def strength(load: Load, machine: Machine, free: Vector, way: float) -> float:
    """What would change all there is of motion over so long a way of its variable: by its impulse, or its work."""
    n, m = len(machine.names), float(machine.inertia[load.on])
    u = max(float(np.abs(free[:, n + load.on]).max()), 0.3)
    if load.kind == "t":
        return m * u / way
    if load.kind == "x":
        return 0.5 * m * u * max(float(np.abs(free[:, n + load.number]).max()), 0.3) / way
    return 3 * m * u  # of rates: about what accelerates


class Verdict(NamedTuple):
    """What came out: errors of the coordinates and of the work, over what was told of them; what the loads did."""

    off: float
    work: float
    effect: float
    told: float
    evaluations: int


def judged(drawn: Drawn) -> Verdict:
    """The scene solved, against its motion."""
    run = study(drawn.scene.text, time_limit=60)
    found, wanted = run.results, drawn.wanted
    n = len(found.coordinates)
    told, off = found.accuracy["estimate"]["motion"], 0.0
    for k, c in enumerate(found.coordinates.values()):
        x = c["angle"] if "angle" in c else c["travel"]
        size = max(1.0, float(np.abs(x).max())) if "angle" in c else run.setup.scene.layout.size
        error = float(np.abs(x - wanted[:, k]).max()) - 3 * drawn.doubt[k]
        off = max(off, error / (size * (told + ROUNDING)))
    energy = found.energy
    largest = max(float(np.abs(energy[e]).max()) for e in ("kinetic", "potential", "work"))
    work = float(np.abs(energy["work"] - wanted[:, 2 * n]).max()) - 3 * drawn.doubt[2 * n]
    work /= largest * (found.accuracy["estimate"]["energy"] + ROUNDING)
    effect = float(np.abs(wanted[-1] - drawn.scene.without)[: 2 * n].max())
    return Verdict(max(off, 0.0), max(work, 0.0), effect, told, found.work["evaluations"])


def tells_chatter(drawn: Drawn) -> str:
    """What is told where no motion goes on; empty if it is that, with its instant."""
    try:
        study(drawn.scene.text, time_limit=20)
    except HeunError as error:
        problem = error.problems[0]
        at = re.search(r"t = ([\d.e+-]+) s", problem.message)
        close = at is not None and drawn.chatters is not None and abs(float(at[1]) - drawn.chatters) <= INSTANT
        return "" if "chatter" in problem.code and close and isinstance(error, SolveError) else str(problem)
    return "runs on"


def line_of(drawn: Drawn) -> tuple[bool, str, Verdict | None]:
    """Whether the scene was missed, and what is printed of it."""
    if drawn.chatters is not None:
        wrong = tells_chatter(drawn)
        return bool(wrong), f"chatters at {drawn.chatters!r}: {wrong or 'told'}", None
    try:
        found = judged(drawn)
    except HeunError as error:
        return True, f"FAILED: {str(error)[:200]!r}", None
    bad = max(found.off, found.work) > FACTOR
    told = f"off {found.off:.3g}, work {found.work:.3g} of told {found.told:.1e}; effect {found.effect:.1e}"
    cost = f"{drawn.crossings} crossings, {found.evaluations} evaluations"
    return bad, f"{'MISSED: ' if bad else ''}{told}; {cost}", found


def main() -> None:
    """Print the figures."""
    first, count = map(int, sys.argv[1:])
    missed, chattering, found = 0, 0, []
    for seed in range(first, first + count):
        begun = time.perf_counter()
        drawn = scene(seed)
        between = time.perf_counter()
        bad, line, verdict = line_of(drawn)
        seconds = f"{between - begun:.2f} + {time.perf_counter() - between:.2f} s"
        print(f"{seed} {drawn.scene.machine} {', '.join(drawn.scene.kinds)}: {line}; {seconds}", flush=True)
        missed, chattering = missed + bad, chattering + (drawn.chatters is not None)
        found += [(verdict, seed)] if verdict is not None else []
    acting = sum(verdict.effect > 1e-6 for verdict, _ in found)
    print(f"{count} scenes, {missed} missed, {chattering} chatter; the loads move {acting} by more than 1e-6")
    for what in ("off", "work"):
        print(f"largest {what}, of told: {sorted(((getattr(v, what), seed) for v, seed in found), reverse=True)[:4]}")


if __name__ == "__main__":
    main()
