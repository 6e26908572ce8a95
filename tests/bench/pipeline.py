"""What a pipeline waits for: a folder of a thousand specs, published cases, the schema; how large a golden file is."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.shared.folders import ROOT

SPECS = 1000
STATE = """\
heun: 1
title: Scene {n}
gravity: [0, 0, -9.81]
parameters: {{m: {m} kg, L: 1.5}}
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{bar: {{mass: m, center: [L/2, 0, 0], inertia: [0.01, 0.2, 0.2], points: {{a: [0, 0, 0], b: [L, 0, 0]}}}}}}
joints: {{foot: {{type: weld, from: ground.O, to: bar.a}}}}
forces: {{push: {{type: force, on: bar.b, vector: [0, 0, -100]}}}}
analysis: {{type: state}}
expect: [{{of: joints.foot.force.z, is: m*9.81 + 100}}]
"""


def pipeline() -> None:
    """Print them, whole processes."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for n in range(SPECS):
            (folder / f"{n:04}.yaml").write_text(STATE.format(n=n, m=1 + n % 7))
        for jobs in ("1", "2"):
            print(
                f"heun check of {SPECS} specs of a state, {jobs} at once: {took('check', name, '--jobs', jobs):.2f} s"
            )
        took("check", str(ROOT / "specs" / "double.yaml"), "--golden", name, "--update", "--force")
        size = (next(folder.rglob("double.json"))).stat().st_size
        print(f"golden file of double.yaml: {size / 1e3:.1f} kB")
    for jobs in ("1", "2"):
        print(f"heun check --references, {jobs} at once: {took('check', '--references', '--jobs', jobs):.2f} s")
    print(f"heun schema: {took('schema'):.2f} s; --results: {took('schema', '--results'):.2f} s")


def took(*words: str) -> float:
    """How long a command takes [s]."""
    begun = time.perf_counter()
    subprocess.run([sys.executable, "-m", "heuncli", *words], check=True, capture_output=True)
    return time.perf_counter() - begun
