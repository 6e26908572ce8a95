"""Speed, printed: `python -m tests.bench [PART ...] [--against PATH]`. Nothing here asserts a time.

Parts: motion, chart, chain, process, export, loads, meshes, memory, sections, causes, reduced, balance, lagrange,
pipeline, door, growth, variants, sweeps, pictures, reports, imports, pages, collectives; each line: what, error,
time; memory: megabytes; growth: counts; pages: frames a second.
figures: the few that matter in one table, with --against beside those of another checkout (tests/bench/figures.py).
honesty: no times, but true error over estimate of each kind of number, over random scenes (tests/bench/honesty.py).
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from heuncli.motion.integration.run.request import MotionTask

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the command sets it, before NumPy is loaded

import numpy as np

from heuncli.kernel.choose import KERNEL
from heuncli.motion.integration.run.runner import Runner
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.output.tables.export import to_csv, to_json
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from heuncli.study.quantities.labels import make_labels
from heuncli.study.workflow import solve
from tests.bench.auto import table
from tests.bench.balance import balanced
from tests.bench.causes import by_cause
from tests.bench.chart import chart
from tests.bench.collectives import collective_times
from tests.bench.figures import figures
from tests.bench.generated import chain
from tests.bench.growth import growth
from tests.bench.honesty import honesty
from tests.bench.imports import imports
from tests.bench.lagrange import equations
from tests.bench.load_cases import load_cases
from tests.bench.long import long
from tests.bench.memory import memory
from tests.bench.meshes import meshes
from tests.bench.pages import pages
from tests.bench.pictures import pictures
from tests.bench.pipeline import pipeline
from tests.bench.python_api import python_api
from tests.bench.reduced import reduced
from tests.bench.reports import reports
from tests.bench.sweeps import sweeps
from tests.bench.variants import variants

SCENES = Path(__file__).parent / "scenes"
REFERENCE = json.loads((SCENES / "reference.json").read_text())


def median_ms(f: Callable[[], Any], repeats: int = 15) -> float:
    """Median processor time of a call [ms]: what else the machine does counts less so."""
    found = []
    for _ in range(repeats):
        begun = time.process_time()
        f()
        found.append(time.process_time() - begun)
    return 1e3 * statistics.median(found)


def error(name: str, scene: PreparedScene, runner: Runner, times: Any, states: Any) -> float:
    """Largest distance of a centre of mass from the reference at the end [m]."""
    found = runner.evaluate(times[-1:], states[-1:]).bodies[0]
    worst = 0.0
    for i, body in enumerate(scene.mechanism.bodies):
        k = scene.layout.place[i]
        center = found["r"][k] + found["R"][k] @ (body.center - scene.layout.reference[k])
        worst = max(worst, float(np.linalg.norm(center - REFERENCE[name]["center"][body.name])))
    return worst


def motion() -> None:
    """The benchmark scenes: integration of one run alone, to 1e-9 and 1e-12 m; and with the check run.

    Each whole, as programs that reduce nothing integrate it; and reduced, where the command integrates less.
    """
    for name in ("double", "top", "chain10", "crank"):
        spec = load(str(SCENES / f"{name}.yaml"))
        setup = set_up(spec)
        scene, runners = setup.scene, {"": Runner(setup.scene.layout)}
        if setup.runner.integrated_scene.layout is not scene.layout:
            runners[" reduced"] = setup.runner
        times = np.array(spec.analysis.times)
        for how, runner in runners.items():
            for goal in (1e-9, 1e-12) if KERNEL == "compiled" else (1e-9,):
                one_motion(name, how, scene, runner, times, goal)
        study = solve(spec)
        seconds, size = study.results.work["seconds"], study.setup.scene.layout.size
        off = error(name, study.setup.scene, study.setup.runner, times, study.history.solutions.states)
        print(
            f"{name:8s} as asked, to {spec.analysis.tolerance:.0e} of {size:.3g} m: "
            f"{1e3 * seconds['integrate']:.3f} ms, "
            f"check {1e3 * seconds['check']:.3f} ms; "
            f"estimate {study.results.accuracy['estimate']['motion']:.1e}, true {off / size:.1e}"
        )


def one_motion(name: str, how: str, scene: PreparedScene, runner: Runner, times: Any, goal: float) -> None:
    """The loosest tolerance that reaches the goal [m], and what it costs."""
    repeats = 15 if KERNEL == "compiled" else 1
    for tolerance in (10.0 ** (-0.5 * k) for k in range(8, 29)):
        run = runner.run(MotionTask(times, tolerance))
        off = error(name, scene, runner, times, run.states)
        if off <= goal:
            break
    alone = median_ms(partial(runner.run, MotionTask(times, tolerance)), repeats)
    check = median_ms(partial(runner.run, MotionTask(times, tolerance / 30.0)), repeats)
    print(
        f"{name + how:8s} to {goal:.0e} m: error {off:.1e} m, {alone:7.3f} ms alone, "
        f"{1 + check / alone:.2f} times that with the check run; "
        f"{run.steps} steps, {run.evaluations} evaluations, {1e3 * alone / run.evaluations:.2f} us each"
    )


def charted() -> None:
    """Error against time of the benchmark scenes, half a decade of tolerance from point to point."""
    runs: dict[str, list[tuple[float, float]]] = {}
    for name in ("double", "top", "chain10", "crank"):
        spec = load(str(SCENES / f"{name}.yaml"))
        scene = set_up(spec).scene
        runner = Runner(scene.layout)
        times = np.array(spec.analysis.times)
        points = runs[name[0] if name != "crank" else "k"] = []
        for tolerance in (10.0 ** (-0.5 * k) for k in range(8, 27)):
            run = runner.run(MotionTask(times, tolerance))
            off = max(error(name, scene, runner, times, run.states), 1e-14)
            points.append((median_ms(partial(runner.run, MotionTask(times, tolerance)), 7), off))
    print("d double, t top, c chain10, k crank: error at the end against time of integration")
    print(chart(runs))


def chains() -> None:
    """Cost per body and evaluation from a chain of 10 to one of 1,000; 10,000 bodies read, assembled and run."""
    cost = {}
    for n in (10, 100, 1000):
        spec = load("chain.yaml", chain(n, duration=0.05))
        runner = set_up(spec).runner
        run = runner.run(MotionTask([0.05], 1e-6))
        cost[n] = median_ms(partial(runner.run, MotionTask([0.05], 1e-6)), 15) / run.evaluations / n
        print(f"chain of {n:5d}: {1e6 * cost[n]:.0f} ns a body and evaluation, {cost[n] / cost[10]:.2f} times 10's")
    begun = time.perf_counter()
    spec = load("chain.yaml", chain(10_000, duration=0.05))
    read = time.perf_counter()
    scene = set_up(spec).scene
    built = time.perf_counter()
    run = Runner(scene.layout).run(MotionTask([0.05], 1e-6))
    print(
        f"chain of 10000: read {read - begun:.2f} s, assembled and laid out {built - read:.2f} s, "
        f"0.05 s of motion in {run.seconds:.2f} s, {run.steps} steps"
    )


def process() -> None:
    """Whole processes against `import numpy`, in turn."""
    double = str(SCENES / "double.yaml")
    commands = {
        "import numpy": [sys.executable, "-c", "import numpy"],
        "heun --help": [sys.executable, "-m", "heuncli", "--help"],
        "heun run double.yaml": [sys.executable, "-m", "heuncli", "run", double],
        "heun run double.yaml --format json": [sys.executable, "-m", "heuncli", "run", double, "--format", "json"],
    }
    found: dict[str, list[float]] = {name: [] for name in commands}
    for _ in range(7):
        for name, command in commands.items():
            begun = time.perf_counter()
            subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
            found[name].append(time.perf_counter() - begun)
    bare = statistics.median(found["import numpy"])
    for name, seconds in found.items():
        middle = statistics.median(seconds)
        print(f"{name}: {1e3 * middle:.0f} ms, {middle / bare:.2f} times `import numpy`")


def export() -> None:
    """JSON and CSV, microseconds a number."""
    spec = load(str(SCENES / "chain10.yaml"), overrides={"analysis.samples": "2001"})
    results, scene = solve(spec).results, make_labels(spec)
    for name, write in (("JSON", to_json), ("CSV", lambda found: to_csv(found, scene))):
        text = write(results)
        numbers = text.count(",") + 1 if name == "JSON" else text.count("\n")
        ms = median_ms(partial(write, results), 3)
        print(f"{name}: {numbers} numbers, {ms:.0f} ms, {1e3 * ms / numbers:.2f} us a number")


def sections() -> None:
    """2,001 instants of `double` (bars as cylinders) with 50 cuts, beyond the motion."""
    text = (SCENES / "double.yaml").read_text().replace("samples: 201", "samples: 2001")
    for length, inertia in ((1.0, "[0.0842, 0.0850, 0.0017]"), (0.8, "[0.0437, 0.0440, 0.0013]")):
        given = f"mass: {length}\n    center: [0, 0, -{length / 2:.1f}]\n    inertia: {inertia}"  # a kilogram a metre
        shape = f"{{type: cylinder, from: [0, 0, 0], to: [0, 0, -{length}], radius: 0.05, mass: {length}}}"
        assert given in text
        text = text.replace(given, f"shapes: [{shape}]")
    runs = (f"  {body}: {{body: {body}, from: top, to: end, count: 25}}" for body in ("upper", "lower"))
    bare, cut = load("double.yaml", text), load("double.yaml", "\n".join([text.rstrip(), "sections:", *runs, ""]))
    pairs = [(median_ms(lambda: solve(bare), 1), median_ms(lambda: solve(cut), 1)) for _ in range(15)]
    more = statistics.median(b - a for a, b in pairs)
    print(f"2,001 instants: {statistics.median(a for a, _ in pairs):.1f} ms; with 50 cuts {more:.1f} ms more")


PARTS = {
    "motion": motion, "chart": charted, "chain": chains, "process": process, "export": export, "memory": memory,
    "sections": sections,
    "causes": by_cause, "reduced": reduced, "balance": lambda: balanced(median_ms),
    "lagrange": lambda: equations(median_ms),
    "pipeline": pipeline, "door": python_api, "growth": growth, "variants": variants, "sweeps": sweeps,
    "collectives": collective_times, "loads": load_cases, "meshes": meshes,
    "pictures": pictures, "reports": lambda: reports(median_ms),
    "imports": lambda: imports(median_ms), "pages": pages,
}  # fmt: skip

if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m tests.bench", description="Speed, printed.")
    parts = [*PARTS, "auto", "long", "figures", "honesty"]
    parser.add_argument("parts", nargs="*", choices=[*parts, []], metavar="PART", help=", ".join(parts))
    parser.add_argument("--against", type=Path, metavar="PATH", help="another checkout, whose figures stand beside")
    parser.add_argument("--only", nargs="*", default=[], metavar="TEXT", help="auto, long: scenes, methods so named")
    parser.add_argument("--periods", type=int, default=100_000, metavar="N", help="long: how many")
    parser.add_argument("--scenes", type=int, default=1000, metavar="N", help="honesty: how many")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="honesty: the first one's seed")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="J", help="honesty: processes")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="honesty: write the specs of scenes above 1 there")
    asked = parser.parse_args()
    print(f"kernel: {KERNEL}", flush=True)
    for part in asked.parts or (PARTS if asked.against is None else ()):
        if part in PARTS:
            PARTS[part]()
    if "figures" in asked.parts or asked.against is not None:
        figures(asked.against)
    if "auto" in asked.parts:
        table(asked.only)
    if "long" in asked.parts:
        long(asked.periods, asked.only)
    if "honesty" in asked.parts:
        honesty(asked.scenes, asked.seed, asked.jobs, asked.keep)
