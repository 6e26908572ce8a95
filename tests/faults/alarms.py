"""`python -m tests.faults.alarms --every 0.001`: the alarm of a time limit rings at many instants of many commands.

The limit itself is far, so that nothing but the alarm ends the command, and the alarm rings after some time of the
processor, so that a machine that does much else changes nothing. Each case is a process of its own, forked before heun
has read a spec: validators are built while it rings, and with --cold libraries are imported. A command that is ended
leaves exit code 4, one message, and nothing half written; one that comes to its end first leaves what it leaves
undisturbed. Prints what is otherwise, and how many cases ended how.
"""

from __future__ import annotations

import argparse
import importlib
import os
import random
import resource
import shutil
import signal
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from heuncli.app.cli import timeout
from heuncli.app.cli.entry import enter
from heuncli.base import signals
from tests.shared.folders import SPECS

COMMANDS = (
    "run slider_crank.yaml --format json -o out.json",
    "validate slider_crank.yaml",
    "check slider_crank.yaml --golden golden --update",
    "report slider_crank.yaml -o out.html",
    "tune slider_crank.yaml w=500:900rpm --minimise max_force --evaluations 20 --jobs 1",
    "tune slider_crank.yaml w=500:900rpm --minimise max_force --evaluations 20 --jobs 2",
    "sweep slider_crank.yaml w=500:900/3rpm --measure max_force --jobs 2",
    "find slider_crank.yaml w=500:900rpm max_force=1kN",
    "modes governor.yaml",
    "export loads conrod.yaml --body rod --at first,last -q -o out.bdf",
    "plot slider_crank.yaml scene -o out.svg",
    "show slider_crank.yaml -o out.html",
    "chart double.yaml --methods RK4,DOP853 --tolerances 1e-4 --steps 0.01",
    "diff crankshaft.yaml crankshaft_stiff.yaml",
    "balance six_cylinder.yaml",
    "lagrange slider_crank.yaml --over main.angle=0:360deg",
)
QUOTED = {"max_force": "max joints.main.force", "max_force=1kN": "max joints.main.force = 1 kN"}
OTHERWISE = {"tune", "sweep", "chart"}  # a variant or a method is lost to the alarm; chart tells times
PARTIAL = {*OTHERWISE, "check"}  # these tell what is done also where the time is up
LIBRARIES = ("numpy", "pydantic", "yaml", "heuncli.study.workflow")
SCIPY = ("scipy.optimize", "scipy.stats")
FAR = "3600"  # s
FOREIGN = ("Traceback", "[bug]", "ignored in", "TimeUp", "Call-back", "Warning")


class Left(NamedTuple):
    """What a command left behind: exit code, both outputs, new files with their contents, and what it took [s]."""

    code: int
    out: str
    err: str
    files: dict[str, bytes]
    seconds: float = 0.0


def main(words: Sequence[str]) -> int:
    """Run the cases; 1 if something is not as it should be."""
    parser = argparse.ArgumentParser(prog="python -m tests.faults.alarms", description=__doc__)
    parser.add_argument("--every", type=float, help="ring at all multiples of these seconds")
    parser.add_argument("--each", type=int, default=4, help="else so many instants of each command, at random")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", default="", help="these commands: run,check,...")
    parser.add_argument("--cold", action="store_true", help="libraries are imported while it rings")
    asked = parser.parse_args(words)
    if not asked.cold:
        for module in LIBRARIES + SCIPY * ("tune" in asked.only or not asked.only):
            importlib.import_module(module)
    drawn = random.Random(asked.seed)
    codes: Counter[int] = Counter()
    wrong = 0
    for line in COMMANDS:
        if asked.only and line.split()[0] not in asked.only.split(","):
            continue
        undisturbed = left_by(line, None)
        if undisturbed.code or any(word in undisturbed.err for word in FOREIGN):
            print(f"{line}: {undisturbed}")
            return 1
        for at in instants(undisturbed.seconds, asked.every, asked.each, drawn):
            left = left_by(line, at)
            codes[left.code] += 1
            for fault in faults_of(line, left, undisturbed):
                wrong += 1
                print(f"{line}: rung at {at:.4f} s: {fault}\n{left.err}", flush=True)
    print(f"{sum(codes.values())} alarms, {wrong} wrong; exit codes {dict(sorted(codes.items()))}")
    return int(wrong > 0)


def instants(whole: float, every: float | None, each: int, drawn: random.Random) -> list[float]:
    """When it rings [s of the processor]; whole: what the command takes undisturbed."""
    if every is None:
        return [drawn.uniform(0.0, whole) for _ in range(each)]
    return [number * every for number in range(1, int(whole / every))]


def faults_of(line: str, left: Left, undisturbed: Left) -> list[str]:
    """What is not as it should be, in words."""
    found = [f"{word} on standard error" for word in FOREIGN if word in left.err]
    if left.code == 0:
        same = (left.out, left.files.keys()) == (undisturbed.out, undisturbed.files.keys())
        if not same and line.split()[0] not in OTHERWISE:
            found.append("other results than undisturbed")
    elif left.code == 4:
        if "time-limit" not in left.err + left.out and not line.startswith("tune"):
            found.append("no message")
        if left.files or (left.out and line.split()[0] not in PARTIAL):
            found.append(f"output of {len(left.out)} characters, files {sorted(left.files)}")
    elif not (line.startswith("sweep") and left.code == 1):
        found.append(f"exit code {left.code}")
    return found


def left_by(line: str, at: float | None) -> Left:
    """What a command leaves whose alarm rings once it has had the processor for so long [s]; None: it does not ring."""
    limit = "--time-limit"
    words = [QUOTED.get(word, word) for word in line.split()]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name, "specs")
        folder.mkdir()
        for word in words:
            if (SPECS / word).is_file():
                shutil.copy(SPECS / word, folder)
        before = {path.name for path in folder.rglob("*")}
        child = os.fork()
        if child == 0:
            _become(name, folder, at, lambda: enter([*words, limit, FAR]))
        _, status, used = os.wait4(child, 0)
        new = {
            str(path.relative_to(folder)): path.read_bytes()
            for path in folder.rglob("*")
            if path.is_file() and path.name not in before
        }
        texts = [Path(name, stream).read_text(encoding="utf-8", errors="replace") for stream in ("out", "err")]
    code = os.waitstatus_to_exitcode(status)
    return Left(code, texts[0], texts[1], new, used.ru_utime + used.ru_stime)


def _become(name: str, folder: Path, at: float | None, work: Callable[[], int]) -> None:
    """The life of the process of a case."""
    code = 99
    try:
        for stream, number in (("out", 1), ("err", 2)):
            os.dup2(os.open(Path(name, stream), os.O_WRONLY | os.O_CREAT), number)
        os.chdir(folder)
        own = os.getpid()

        def timer(seconds: float) -> Callable[[], None]:
            """As timeout._timer, by processor time; in processes forked from this one from their beginning."""
            if at is None:
                return lambda: None
            used = resource.getrusage(resource.RUSAGE_SELF)
            left = at - (used.ru_utime + used.ru_stime) if os.getpid() == own else at / 4.0
            signal.signal(signal.SIGPROF, timeout._handle_alarm)
            signal.setitimer(signal.ITIMER_PROF, max(left, 1e-6), timeout.ALARM_INTERVAL)
            told, sys.unraisablehook = sys.unraisablehook, hush

            def undo() -> None:
                signal.setitimer(signal.ITIMER_PROF, 0.0)
                sys.unraisablehook = told

            return undo

        told = sys.unraisablehook

        def hush(what: sys.UnraisableHookArgs) -> None:
            if not isinstance(what.exc_value, timeout.TimeUp):
                told(what)

        timeout._start_timer = timer
        signals.install_handlers()
        code = work()
        sys.stdout.flush()
    finally:
        sys.stderr.flush()
        os._exit(code)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
