"""What the kernel answers, as JSON, here and in a process with the plain one that stays for all that is asked of it."""

from __future__ import annotations

import contextlib
import io
import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from heuncli.app.cli.entry import enter
from heuncli.motion.integration.methods.method import load_method_by_name
from heuncli.motion.integration.run.request import MotionTask
from heuncli.multibody.response import jacobian, multiplier_joint_loads, solve_columns, tangent
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from tests.shared.folders import ROOT, SPECS

Asked = Callable[..., Any]  # by its name, then what it is asked


def results(text: str, settings: list[str]) -> Any:
    """Of `heun run - --format json`, but for the time that it took."""
    was, sys.stdin = sys.stdin, io.TextIOWrapper(io.BytesIO(text.encode()))
    try:
        written = io.BytesIO()
        told = io.TextIOWrapper(written, write_through=True)
        with contextlib.redirect_stdout(told), contextlib.chdir(SPECS):  # where the files are that a spec names
            code = enter(["run", "-", "--format", "json", *(word for one in settings for word in ("--set", one))])
    finally:
        sys.stdin = was
    assert code == 0
    read: Any = json.loads(written.getvalue())
    del read["work"]["seconds"]
    return read


def linear_map(scene: str, text: str | None = None) -> Any:
    """Its parts at the start of a spec, or of a scene as text, for loads and multipliers of any size."""
    setup = set_up(load(str(SPECS / f"{scene}.yaml"), text))
    layout, runner = setup.scene.layout, setup.runner
    found = runner.evaluate(np.zeros(2), np.array([layout.y0, layout.y0]))
    at = runner.workspace, found.times, found.states
    multipliers = np.sin(1.0 + np.arange(2 * 3 * len(layout.rows))).reshape(2, 3, -1)
    loads = np.cos(np.arange(2 * 6 * len(layout.place))).reshape(2, -1, 6)
    answers = solve_columns(at[0], 0.0, found.states[0], loads, np.array([True, False]))
    return {
        "jacobian": jacobian(at[0], layout, *at[1:]).entries.tolist(),
        "carried": multiplier_joint_loads(*at, multipliers, len(layout.place)).tolist(),
        "columns": [answers.bodies.tolist(), answers.multipliers.tolist()],
        "tangent": tangent(at[0], 0.0, found.states[0]).tolist(),
    }


def within_steps(scene: str, method: str) -> Any:
    """A motion of a spec in its steps, and between them; `auto`: by the spec's own method."""
    setup = set_up(load(str(SPECS / f"{scene}.yaml")))
    chosen = setup.method if method == "auto" else load_method_by_name(method)
    run = setup.runner.run(MotionTask(np.linspace(0.0, 0.8, 3), 1e-6, method=chosen))
    times = np.unique(np.concatenate([np.linspace(0.0, 0.8, 17), run.ends, np.nextafter(run.ends[:-1], 1.0)]))
    states = setup.runner.resample(run, times)
    found = setup.runner.evaluate(times, states)
    return [run.ends.tolist(), run.is_projected.tolist(), states.tolist(), found.bodies.tolist(), found.rows.tolist()]


ANSWERS = {answer.__name__: answer for answer in (results, linear_map, within_steps)}


def here(name: str, *asked: Any) -> Any:
    """Of the kernel in this process."""
    return json.loads(json.dumps(ANSWERS[name](*asked), default=list))


@contextlib.contextmanager
def plain_kernel() -> Iterator[Asked]:
    """Asked like `here`: of the plain kernel, in a process of its own."""
    command = [sys.executable, "-m", "tests.shared.kernel_answers"]
    environment = {**os.environ, "HEUN_KERNEL": "pure"}
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True, cwd=ROOT, env=environment) as process:
        assert process.stdin and process.stdout
        lines_in, lines_out = process.stdin, process.stdout

        def there(name: str, *asked: Any) -> Any:
            print(json.dumps([name, *asked]), file=lines_in, flush=True)
            return json.loads(lines_out.readline())

        yield there
        lines_in.close()
        assert process.wait() == 0


def main() -> None:
    """A line of JSON for each that is read."""
    for line in sys.stdin.buffer:
        print(json.dumps(here(*json.loads(line))), flush=True)


if __name__ == "__main__":
    main()
