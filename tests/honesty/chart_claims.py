"""The errors of motion that a chart tells of random chains of masses, against matrix exponentials.

    python -m tests.honesty.chart_claims --cases 100 [--seed FIRST]

Of a linear motion y' = A y a Runge-Kutta step is a rational function of h A, which is known of each method of given
step; so its error is known without a run. A method that chooses its steps is run, and its states compared.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator

import numpy as np
from scipy.linalg import expm

from heuncli.analyses.work_precision.plan import ChartOptions, make_motion
from heuncli.analyses.work_precision.results import ChartRun
from heuncli.analyses.work_precision.study import chart
from heuncli.motion.integration.methods.method import load_method_by_name
from heuncli.motion.integration.run.request import MotionTask
from heuncli.scene.file_format.load import load
from tests.shared.chains import DRAWN, Array, chain
from tests.shared.hunts import asked_of

SAMPLES, REACH = 11, 12.0  # of the motion, over the largest eigenvalue
STEPS = (40, 80)  # of the motion
TOLERANCES = (1e-4, 1e-7)
CHOOSING = ("DOPRI5", "DOP853", "Verner98", "Radau5", "Radau9")
ROUNDED = 1e-12  # of the size: some 100 steps' rounding, and that of the exponential
SHARE = 1e-3  # of an error: the step is T / 40 to a few rounding errors, which errors of 1e-10 show


def taylor(order: int) -> Callable[[Array], Array]:
    """What an explicit method of as many stages as its order makes of z = h A."""

    def step(z: Array) -> Array:
        term = found = np.eye(len(z))
        for k in range(1, order + 1):
            term = term @ z / k
            found = found + term
        return found

    return step


def pade2(z: Array) -> Array:
    I = np.eye(len(z))
    return np.linalg.solve(I - z / 2 + z @ z / 12, I + z / 2 + z @ z / 12)


def pade3(z: Array) -> Array:
    even, odd = np.eye(len(z)) + z @ z / 10, z / 2 + z @ z @ z / 120
    return np.linalg.solve(even - odd, even + odd)


GIVEN_STEPS = {
    "Euler": taylor(1), "Heun2": taylor(2), "Heun3": taylor(3), "RK4": taylor(4), "Gauss4": pade2, "Gauss6": pade3,
}  # fmt: skip


def off(travels: Array, exact: Array, size: float) -> float:
    """The largest distance of any mass from where it should be, of the scene's size; (samples, n) each."""
    return float(np.abs(np.cumsum(travels - exact, axis=1)).max()) / size


def errors(seed: int) -> Iterator[tuple[str, float, float, float]]:
    """Of each run of a chart: its name, the error that is told, the right one, and what the reference may err."""
    _, A = chain(seed, "{duration: 1, samples: 2}")
    n = len(A) // 2
    duration = REACH / float(np.abs(np.linalg.eigvals(A)).max())
    spec = load("chain.yaml", chain(seed, f"{{duration: {duration!r}, samples: {SAMPLES}}}")[0])
    start = np.concatenate([np.full(n, DRAWN), np.zeros(n)])
    times = np.linspace(0.0, duration, SAMPLES)
    exact = np.array([expm(A * t) @ start for t in times])[:, :n]

    found = chart(spec, ChartOptions(tuple(GIVEN_STEPS), steps=tuple(duration / k for k in STEPS)))
    doubt = found.reference.error["motion"] or 0.0
    for run in found.runs:
        count = round(duration / run.row.local)
        if run.steps != count:  # a load had its largest between two stages, and a step was laid there
            continue
        R = GIVEN_STEPS[run.row.method](A * duration / count)
        each = np.linalg.matrix_power(R, count // (SAMPLES - 1))
        made = [start]
        for _ in range(SAMPLES - 1):
            made.append(each @ made[-1])
        yield f"{run.row.method} {count}", told(run), off(np.array(made)[:, :n], exact, found.size), doubt

    found = chart(spec, ChartOptions(CHOOSING, TOLERANCES))
    doubt = found.reference.error["motion"] or 0.0
    runner = make_motion(spec, None).setup.runner
    for run in found.runs:
        method, local = run.row.method, run.row.local
        own = runner.run(MotionTask(times, local, method=load_method_by_name(method)))
        travels = runner.evaluate(times, own.states).freedoms["q"]
        yield f"{method} {local:g}", told(run), off(travels, exact, found.size), doubt


def told(run: ChartRun) -> float:
    """The error of the motion that a chart tells; not a number where it tells none."""
    value = run.error["motion"]
    return math.nan if value is None else value


def is_right(told: float, right: float, doubt: float) -> bool:
    """Within what the reference says of itself, or told as a bound that holds."""
    return abs(told - right) <= 2.0 * doubt + SHARE * right + ROUNDED


def main() -> None:
    asked = asked_of("tests.honesty.chart_claims", __doc__)
    count = wrong = 0
    for seed in range(asked.seed, asked.seed + asked.cases):
        for name, claimed, right, doubt in errors(seed):
            count += 1
            if not is_right(claimed, right, doubt):
                wrong += 1
                print(f"{seed} {name}: {claimed:.6g} told, {right:.6g} right, reference {doubt:.2g}")
    sys.stdout.write(f"{count} runs of {asked.cases} scenes, {wrong} told wrong\n")


if __name__ == "__main__":
    main()
