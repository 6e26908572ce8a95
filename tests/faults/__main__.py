"""`python -m tests.faults`: many random cases, and what does not hold of them, each with a line to replay it."""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence

from tests.faults import sources
from tests.faults.cases import KINDS, case
from tests.faults.pool import Judged, judged
from tests.faults.worker import LAWS

EVERY = 1000  # cases between two lines of progress


def main(words: Sequence[str]) -> int:
    """Run the cases; 1 if something does not hold of one."""
    parser = argparse.ArgumentParser(prog="python -m tests.faults", description=__doc__)
    parser.add_argument("--cases", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=0, help="of the first case; the others count on from it")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--kind", choices=(*KINDS, LAWS), help="this alone; laws are not among the others")
    parser.add_argument("--replay", metavar="KIND:SEED", help="run one case, with its files and all that it says")
    parser.add_argument("--quick", action="store_true", help="no progress")
    asked = parser.parse_args(words)
    if asked.replay:
        kind, _, seed = asked.replay.partition(":")
        return replay(kind, int(seed))
    table = Tally()
    try:
        for k, one in enumerate(judged(drawn(asked.cases, asked.seed, asked.kind), asked.jobs), 1):
            table.add(one)
            if k % EVERY == 0 and not asked.quick:
                told = f"{k} of {asked.cases}: {table.wrong} with violations, {time.strftime('%H:%M:%S')}"
                print(told, file=sys.stderr, flush=True)
    except KeyboardInterrupt:
        print("interrupted")  # what was found until then stands
    print(table)
    return int(table.wrong > 0)


def drawn(cases: int, seed: int, kind: str | None) -> Iterator[tuple[str, int]]:
    """The kinds in turn, by their shares."""
    kinds = [kind] if kind else [name for name, of in KINDS.items() for _ in range(of.share)]
    for k in range(cases):
        yield kinds[k % len(kinds)], seed + k


def replay(kind: str, seed: int) -> int:
    """Run one case in sight."""
    if kind != LAWS:
        of = case(kind, seed)
        print("\n".join(f"# {name}\n{content.decode(errors='backslashreplace')}" for name, content in of.files.items()
                        if name not in sources.tables() or kind == "bytes"))  # fmt: skip
        print("\n".join("$ heun " + " ".join(argv) for argv in of.commands))
        from tests.faults.shown import show

        show(of)
    (one,) = judged([(kind, seed)])
    print(one.code, f"{one.seconds:.2f} s, {one.memory:.0f} MB", *one.violations, sep="\n")
    return int(bool(one.violations))


class Tally:
    """Verdicts counted by kind and exit code, the worst, and all violations."""

    def __init__(self) -> None:
        self.codes: defaultdict[str, Counter[int | None]] = defaultdict(Counter)
        self.seconds: dict[str, tuple[float, int]] = {}
        self.memory: dict[str, tuple[float, int]] = {}
        self.wrong = 0

    def add(self, one: Judged) -> None:
        self.codes[one.kind][one.code] += 1
        self.seconds[one.kind] = max(self.seconds.get(one.kind, (0.0, 0)), (one.seconds, one.seed))
        self.memory[one.kind] = max(self.memory.get(one.kind, (0.0, 0)), (one.memory, one.seed))
        if one.violations:
            self.wrong += 1
            for what in one.violations:
                print(f"--replay {one.kind}:{one.seed}  ({one.command})  {what}", flush=True)

    def __str__(self) -> str:
        found = {code for of in self.codes.values() for code in of}
        codes = sorted(found, key=lambda code: -1 if code is None else code)
        exits = [f"exit {'none' if code is None else code}" for code in codes]
        heads = ["kind", "cases", *exits, "longest", "largest"]
        rows = [heads]
        for kind, of in self.codes.items():
            (seconds, slow), (memory, large) = self.seconds[kind], self.memory[kind]
            worst = [f"{seconds:.2f} s ({slow})", f"{memory:.0f} MB ({large})"]
            rows.append([kind, str(of.total()), *(str(of[code]) for code in codes), *worst])
        widths = [max(len(row[k]) for row in rows) for k in range(len(heads))]
        lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
        return "\n".join([*lines, f"cases with violations: {self.wrong}"])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
