"""`python -m tests.faults.kills --cases 50`: sweeps killed at random instants, a worker or the process itself.

After every few kills the sweep is run to its end: all of its rows must be those of a sweep that nobody disturbs, each
once, and no kill may lose an answer that was kept. Prints how much was kept at each kill.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from tests.shared.sweeps import COUNT, STORE, SWINGING, held, killed, rows

A_STORE = 3  # kills of one store


def main(words: Sequence[str]) -> int:
    """Run the cases; 1 if something is not as it should be."""
    parser = argparse.ArgumentParser(prog="python -m tests.faults.kills", description=__doc__)
    parser.add_argument("--cases", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args(words)
    drawn = random.Random(asked.seed)
    with tempfile.TemporaryDirectory() as name:
        undisturbed, seconds = whole(Path(name))
    wrong = 0
    for begin in range(0, asked.cases, A_STORE):
        count = min(A_STORE, asked.cases - begin)
        with tempfile.TemporaryDirectory() as name:
            wrong += store_is_wrong(Path(name), drawn, count, undisturbed, seconds)
    print(f"{asked.cases} kills, {wrong} stores wrong")
    return int(wrong > 0)


def whole(folder: Path) -> tuple[str, float]:
    """The rows of a sweep that nobody disturbs, and what it takes [s]."""
    (folder / "swinging.yaml").write_text(SWINGING)
    begun = time.monotonic()
    return rows(folder), time.monotonic() - begun


def store_is_wrong(folder: Path, drawn: random.Random, kills: int, undisturbed: str, seconds: float) -> bool:
    """Kill a sweep some times, then let it end; whether anything is wrong with it."""
    (folder / "swinging.yaml").write_text(SWINGING)
    kept: list[int] = []
    for _ in range(kills):
        worker, after = drawn.random() < 0.5, drawn.uniform(0.0, seconds)
        kept.append(killed(folder, after, worker))
        print(f"{'worker' if worker else 'sweep'} at {after:.2f} s: {kept[-1]} of {COUNT} kept", flush=True)
    ended = rows(folder, "--store", STORE)
    right = ended == undisturbed and kept == sorted(kept)
    return not (right and held(folder) == (COUNT, [(1, number) for number in range(COUNT)]))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
