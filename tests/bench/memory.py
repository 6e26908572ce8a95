"""The most that whole processes hold in memory, with much to be written down: many samples, and many cuts."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

SCENES, SPECS = Path(__file__).parent / "scenes", Path(__file__).parents[2] / "specs"
CHIMNEY = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {foot: [0, 0, 0]}}
bodies:
  chimney:
    shapes: [{type: rod, from: [0, 0, 0], to: [0, 0, 30], mass: 1000}]
    points: {foot: [0, 0, 0], top: [0, 0, 30]}
joints: {foot: {type: pin, from: ground.foot, to: chimney.foot, axis: [0, 1, 0], initial: {angle: 0.5}}}
sections: {shaft: {body: chimney, from: foot, to: top, count: 10000}}
analysis: {duration: 0.5, samples: 201}
"""


def memory() -> None:
    """The peaks, and the processor time, as JSON and as CSV."""
    with tempfile.TemporaryDirectory() as folder:
        chimney = Path(folder) / "chimney.yaml"
        chimney.write_text(CHIMNEY)
        many = ["--set", "analysis.samples=100000"]
        scenes = {
            "100,000 samples of double": [str(SCENES / "double.yaml"), *many],
            "100,000 of a closed chain": [str(SPECS / "four_bar.yaml"), *many, "--only", "joints,motion"],
            "100,000 of it by cause": [str(SPECS / "four_bar.yaml"), *many, "--only", "joints,shares"],
            "10,000 cuts": [str(chimney)],
        }
        for name, words in scenes.items():
            for form in ("json", "csv"):
                written = ["--format", form, "-o", str(Path(folder) / "out")]
                run = subprocess.Popen([sys.executable, "-m", "heuncli", "run", *words, *written])
                _, status, used = os.wait4(run.pid, 0)
                assert status == 0
                print(f"{name}, {form}: {used.ru_maxrss / 1e3:.0f} MB, {used.ru_utime + used.ru_stime:.1f} s")
