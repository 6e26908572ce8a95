"""What a picture costs beside the run that it is of: whole processes by turns, processor time."""

from __future__ import annotations

import statistics
import tempfile
from pathlib import Path

from tests.bench.figures import HERE, HEUN, processor_seconds

OF = {
    "double": "joints.pivot.force", "engine": "joints.main.force", "rotor": "joints.left.force",
    "bouncing_ball": "bodies.ball.velocity.z", "crane": "joints.luff.force",
}  # fmt: skip
TURNS = 15


def pictures() -> None:
    """Print the medians, and of each turn the quotient."""
    with tempfile.TemporaryDirectory() as name:
        for spec, path in OF.items():
            file = str(HERE / "specs" / f"{spec}.yaml")
            commands = {
                "run": ["run", file, "--quiet"],
                "SVG": ["plot", file, path, "--quiet", "-o", str(Path(name) / "x.svg")],
                "letters": ["plot", file, path, "--quiet"],
            }
            took: dict[str, list[float]] = {of: [] for of in commands}
            for _ in range(TURNS):
                for of, words in commands.items():
                    took[of].append(processor_seconds([*HEUN, *words], HERE)[0])
            run = statistics.median(took["run"])
            told = (
                f"as {of} {statistics.median(a / b for a, b in zip(took[of], took['run'], strict=True)):.2f} times that"
                for of in ("SVG", "letters")
            )
            print(f"plot {spec}.yaml {path}: run {1e3 * run:.0f} ms, {', '.join(told)}", flush=True)
