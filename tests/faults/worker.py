"""A process that runs cases one after another: `python -m tests.faults.worker`, told KIND:SEED a line, answers in JSON.

Impure: works in a folder of its own, and takes this process's standard output and error to catch what is written there.
"""

from __future__ import annotations

import contextlib
import json
import os
import resource
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

from tests.faults import outcome
from tests.faults.cases import Case, case
from tests.faults.invariant import violations
from tests.faults.outcome import Noise, Outcome

MOST_MEMORY = 3 * 2**30  # bytes of address space: beyond it a case would take the machine's memory from others
REPEATED = 40  # of so many cases one is run twice: the bytes must be the same
MEASURED = ("model", "chart")  # say how long something took
LAWS = "laws"


def verdict(kind: str, seed: int, noise: Noise | None = None) -> dict[str, Any]:
    """One case run and judged."""
    if kind == LAWS:
        from tests.faults.laws import judged  # with the oracle's transformations

        return judged(seed)
    of = case(kind, seed)
    done = executed(of, noise)
    found: list[str] = []
    for k, one in enumerate(done):
        last = k == len(of.commands) - 1
        before = done[0].code if k and not of.given and one.argv[0] in ("run", "model") else None
        found += violations(one, before, of.codes if last else None)
    if seed % REPEATED == 0 and not found:
        found += _repeated(of, done[-1])
    return {
        "code": done[-1].code, "seconds": max(one.seconds for one in done), "memory": max(one.memory for one in done),
        "violations": found, "command": " ".join(done[-1].argv),
    }  # fmt: skip


def executed(of: Case, noise: Noise | None = None) -> list[Outcome]:
    """The command lines of a case, in this folder, up to the first that fails."""
    _lay_out(of)
    done: list[Outcome] = []
    for argv in of.commands:
        one = outcome.run(argv, of.files.get("spec.yaml", b""))
        done.append(one._replace(noise=noise.taken()) if noise is not None else one)
        if one.code != 0:
            break
    return done


def _repeated(of: Case, first: Outcome) -> list[str]:
    _lay_out(of)
    again = outcome.run(first.argv, of.files.get("spec.yaml", b""))
    if first.code == 4 or again.code == 4 or first.argv[0] in MEASURED:  # times are no matter of the spec
        return []
    same = again.code == first.code and without_seconds(again.out) == without_seconds(first.out)
    return [] if same else [f"run again it says otherwise: exit codes {first.code}, {again.code}"]


def without_seconds(out: bytes) -> bytes:
    """Output without the times that the run itself took."""
    begin = out.find(b'"seconds": {')
    return out if begin < 0 else out[:begin] + out[out.find(b"}", begin) :]


def inner(folder: str) -> Path:
    """A folder in it, so that `..` is nobody else's."""
    path = Path(folder) / "here"
    path.mkdir()
    return path


def _lay_out(of: Case) -> None:
    """The files of a case in this folder, and nothing else."""
    for path in Path().iterdir():
        shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()
    for name, content in of.files.items():
        Path(name).write_bytes(content)


def main() -> None:
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    requests = os.fdopen(os.dup(0))
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as beside:
        os.chdir(inner(folder))
        noise = Noise(Path(beside) / "noise")
        for line in requests:
            kind, seed = line.strip().split(":")
            print(json.dumps(verdict(kind, int(seed), noise)), file=answers)
        os.chdir("/")


if __name__ == "__main__":
    with contextlib.suppress(BrokenPipeError):
        sys.exit(main())
