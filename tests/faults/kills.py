"""`python -m tests.faults.kills --cases 50`: sweeps killed at random instants, a worker or the process itself.

After every few kills the sweep is run to its end: all of its rows must be those of a sweep that nobody disturbs, each
once, and no kill may lose an answer that was kept. Prints how much was kept at each kill.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from tests.shared.sweeps import COUNT, STORE, SWINGING, held, killed, rows, timed

A_STORE = 4  # kills of one store


def main(words: Sequence[str]) -> int:
    """Run the cases; 1 if something is not as it should be."""
    parser = argparse.ArgumentParser(prog="python -m tests.faults.kills", description=__doc__)
    parser.add_argument("--cases", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args(words)
    drawn = random.Random(asked.seed)
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "swinging.yaml").write_text(SWINGING)
        undisturbed, seconds = timed(Path(name))
    kills, wrong = 0, 0
    while kills < asked.cases:
        with tempfile.TemporaryDirectory() as name:
            done, is_wrong = ended(Path(name), drawn, undisturbed, seconds)
        kills, wrong = kills + done, wrong + is_wrong
    print(f"{kills} kills, {wrong} stores wrong")
    return int(wrong > 0)


def ended(folder: Path, drawn: random.Random, undisturbed: str, seconds: float) -> tuple[int, bool]:
    """Kill a sweep until it comes to its end in spite of that, or some times; how often, and whether a row is wrong."""
    (folder / "swinging.yaml").write_text(SWINGING)
    kept: list[int] = []
    while len(kept) < A_STORE and COUNT not in kept:
        worker, after = drawn.random() < 0.5, drawn.uniform(-0.2, 1.0) * seconds
        kept.append(killed(folder, after, worker))
        who = "worker" if worker else "sweep"
        print(f"{who} at {after:.2f} of {seconds:.2f} s: {kept[-1]} of {COUNT} kept", flush=True)
    right = rows(folder, "--store", STORE) == undisturbed and kept == sorted(kept)
    right &= held(folder) == (COUNT, [(1, number) for number in range(COUNT)])
    return len(kept), not right


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
