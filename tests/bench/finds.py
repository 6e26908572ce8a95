"""What `heun find` takes: crossings, runs, processor time."""

from __future__ import annotations

import json
import tempfile
import time
from pathlib import Path

from heuncli.app.cli.entry import enter
from tests.shared.folders import SPECS

FINDS = (
    ("rotor", "n=500:6000rpm", "max joints.right.radial = 0.2 kN"),
    ("four_bar", "w=20:300rpm", "max abs joints.crank.drive = 1 Nm"),
    ("ladder", "tilt=5:80deg", "first events.until.time = 1.2 s"),
    ("engine", "n=1000:6000rpm", "max joints.wrist.force = 20 kN"),
)


def finds() -> None:
    """Print it."""
    print(f"\n{'find':28s}{'crossings':>10s}{'runs':>8s}{'[ms]':>8s}")
    for name, unknown, condition in FINDS:
        crossings, runs, ms = search(name, unknown, condition)
        print(f"{name + ' ' + unknown:28s}{crossings:10d}{runs:8d}{ms:8.1f}")


def search(name: str, unknown: str, condition: str) -> tuple[int, int, float]:
    """How many crossings a search finds, in how many runs, and its processor time [ms], set-up and all."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "found.json"
        begun = time.process_time()
        assert enter(["find", str(SPECS / f"{name}.yaml"), unknown, condition, "-o", str(out)]) == 0
        ms = 1e3 * (time.process_time() - begun)
        told = json.loads(out.read_text())
    return len(told["crossings"]), told["runs"], ms
