"""What `method: auto` takes beside every listed method: `python -m tests.bench auto [--only TEXT ...]`.

Evaluations of the right-hand side that a run takes whose true error, against a much finer run, is just what was asked:
each method's tolerance (or step) is tuned until it is, half a decade (a factor of the root of 2) at a time. auto's is
not: its run is the one that is told at the tolerance asked for. Beside it the same of the method that auto took, tuned,
and of the best that is asked in the same way, `--method NAME` at the same tolerance: of the run that is told, whose
estimate is below it. So it is seen what is the method's and what the tolerance's.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from heuncli.base.errors import HeunError
from heuncli.base.method_rows import DEFAULT, METHODS
from heuncli.motion.integration.check.estimate import evaluate_run
from heuncli.motion.integration.check.run_comparison import MotionPoints, find_motion_error, interleave
from heuncli.motion.integration.integrated_scene import find_discontinuities
from heuncli.motion.integration.methods.method import Method, load_method_by_name
from heuncli.motion.integration.run.request import MotionTask
from heuncli.motion.integration.run.runner import Runner
from heuncli.motion.integration.trajectory import Trajectory
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.options import Options
from heuncli.study.model.setup import Setup, set_up
from heuncli.study.workflow import solve
from tests.bench.stiff import STIFF_SCENES
from tests.shared.folders import ROOT

ASKED = (1e-4, 1e-6, 1e-9, 1e-12)
FINEST = 3e-15  # local tolerance of the reference
MOST = 2.0  # times auto's evaluations: a method that needs more is not looked at further
LISTED = [row.name for row in METHODS if row.kind != "SciPy" and row.attitude == "quaternion"]


class Scene(NamedTuple):
    """A scene ready to run, and where it is at the asked instants by a much finer run."""

    name: str
    setup: Setup
    jumps: list[float]
    exact: Trajectory

    @property
    def runner(self) -> Runner:
        return self.setup.runner

    def run(self, method: Method, local: float, most_evaluations: float) -> tuple[int, float]:
        """Evaluations and true error of one run; no error where it takes more, or fails."""
        most = int(most_evaluations)
        with suppress(HeunError):
            request = MotionTask(
                self.exact.times, local, method, self.jumps, most_steps=most // max(len(method.nodes) - 1, 1) + 10
            )
            run = self.runner.run(request)
            return run.evaluations, self.error(run)
        return most, math.inf

    def error(self, run: Trajectory) -> float:
        """Largest distance of any point from the reference, of the scene's size."""
        n = min(len(run.times), len(self.exact.times))
        both = interleave(self.exact.times[:n], [run.states[:n], self.exact.states[:n]])
        layout = self.runner.layout
        found = evaluate_run(self.runner, self.exact, *both, self.jumps)
        twice = find_motion_error(MotionPoints(layout), found.bodies, 2, layout.size)
        return 0.5 * float(twice.max())


def scenes() -> Iterator[tuple[str, str | None]]:
    """All specs and benchmark scenes, and stiff ones: a name, and the text where it is no file."""
    for path in (*sorted(ROOT.glob("specs/*.yaml")), *sorted(ROOT.glob("tests/bench/scenes/*.yaml"))):
        yield str(path.relative_to(ROOT)), None
    yield from STIFF_SCENES.items()


def prepared(name: str, text: str | None) -> Scene | None:
    """A scene whose motion is integrated, with its reference; None of any other."""
    spec = load(str(ROOT / name), text)
    if spec.analysis.type != "motion":
        return None
    setup = set_up(spec)
    if any(condition.ends for condition in spec.analysis.conditions):
        return None  # where it ends is no matter of the method
    if setup.method is None or setup.method.is_determined:
        return None
    times = np.array(spec.analysis.times)
    jumps = find_discontinuities(setup.scene.mechanism, float(times[-1]))
    method = load_method_by_name("Radau9" if name in STIFF_SCENES else DEFAULT)
    for local in (FINEST * 10.0**k for k in range(4)):
        with suppress(HeunError):
            exact = setup.runner.run(MotionTask(times, local, discontinuities=jumps, method=method))
            return Scene(name, setup, jumps, exact)
    return None


def tuned(scene: Scene, method: Method, asked: float, most: float) -> float:
    """The fewest evaluations by which a method keeps an error, as its tolerance, or its step, gets smaller."""
    last = float(scene.exact.times[-1])
    steps = (last * 2.0 ** (-0.5 * k) for k in range(4, 50))
    for local in steps if method.has_fixed_step else (10.0 ** (-0.5 * k) for k in range(2, 29)):
        taken, off = scene.run(method, local, most)
        if off <= asked:
            return taken
        if taken > most:
            break
    return math.inf


def as_asked(scene: Scene, spec: Spec, method: Method, asked: float, most: float) -> float:
    """Evaluations of the run that is told by a method at a tolerance; none where its estimate or its error is above."""
    if method.has_fixed_step or not math.isfinite(scene.run(method, asked, most)[1]):
        return math.inf
    with suppress(HeunError):
        study = solve(spec, Options(tolerance=asked, method=method.name, requested_reports=frozenset({"motion"})))
        checked = study.history.checked_run
        if checked is not None and checked.motion <= asked and scene.error(checked.run) <= asked:
            return checked.run.evaluations
    return math.inf


def table(only: list[str]) -> None:
    """Scene by scene and accuracy by accuracy."""
    print(
        f"{'scene':28} {'asked':>6}  {'auto':16}{'evals':>8} {'true':>7}  {'best tuned':>22} {'ratio':>6}  "
        f"{'auto tuned':>10} {'ratio':>6}  {'best as asked':>22} {'ratio':>6}"
    )
    worst = dict.fromkeys(ASKED, 0.0)
    for name, text in scenes():
        if only and not any(part in name for part in only):
            continue
        scene = prepared(name, text)
        if scene is None:
            continue
        for asked in ASKED:
            worst[asked] = max(worst[asked], line(scene, text, asked))
    print("largest ratio to the best at the tolerance asked for:", *(f"{a:.0e}: {r:.2f}" for a, r in worst.items()))


def line(scene: Scene, text: str | None, asked: float) -> float:
    """One of them; the ratio to the best method at the tolerance asked for."""
    spec = load(str(ROOT / scene.name), text)
    try:
        study = solve(spec, Options(tolerance=asked, requested_reports=frozenset({"motion"})))
    except HeunError as error:
        print(f"{scene.name:28} {asked:6.0e}  {error.problems[0].code}")
        return 0.0
    checked = study.history.checked_run
    assert checked is not None
    taken, own = checked.run.evaluations, checked.run.method.name
    most = MOST * taken
    found = {name: tuned(scene, load_method_by_name(name), asked, most) for name in LISTED}
    best = min(found, key=lambda one: found[one])
    given = {name: as_asked(scene, spec, load_method_by_name(name), asked, most) for name in LISTED}
    first = min(given, key=lambda one: given[one])
    short = scene.name.removeprefix("tests/bench/")
    print(
        f"{short:28} {asked:6.0e}  {own:16}{taken:8d} {scene.error(checked.run):7.0e}  "
        f"{best:>13} {found[best]:8.0f} {taken / found[best]:6.2f}  {found[own]:10.0f} {taken / found[own]:6.2f}  "
        f"{first:>13} {given[first]:8.0f} {taken / given[first]:6.2f}",
        flush=True,
    )
    return taken / given[first]
