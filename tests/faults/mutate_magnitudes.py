"""Specs whose numbers are of any magnitude: of a spec one to three numbers become ±10^u, 0 or a denormal, by a seed.

What heun makes of them is judged by `violation`: a documented exit code, no warning, no traceback, finite JSON.
"""

from __future__ import annotations

import io
import json
import random
import re
import sys
import warnings
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import NamedTuple

from heuncli.cli.entry import enter

SPECS = Path(__file__).parents[2] / "specs"
# a number that is no part of a name, nor of the format's version; its unit stays behind it
NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.])")
SPECIAL = ("0", "-0.0", "5e-324", "-2e-310", "1.8e308", "1e-60", "1e60", "-1e-60", "9.9e59")
CODES = frozenset({0, 1, 2, 3, 4})
UNDOUBTED = 1e-6  # a residual of the balance that is larger, and not warned of, is nonsense that passes for a result


class Mutant(NamedTuple):
    """A spec by its file's name, the seed, and the text."""

    name: str
    seed: int
    text: str


class Outcome(NamedTuple):
    """What a command left behind; fault: the exception or the warning that escaped."""

    code: int
    out: str
    err: str
    fault: str


class Captured(io.TextIOWrapper):
    """A standard output that is kept, with bytes behind it as a process has."""

    def __init__(self) -> None:
        self.kept = io.BytesIO()
        super().__init__(self.kept, encoding="utf-8")

    @property
    def text(self) -> str:
        """What was written."""
        self.flush()
        return self.kept.getvalue().decode()


def mutant(seed: int) -> Mutant:
    """The mutant of a seed."""
    draw = random.Random(seed)
    files = sorted(SPECS.glob("*.yaml"))
    path = draw.choice(files)
    lines = [line.partition(" #")[0] for line in path.read_text().splitlines() if not line.startswith("#")]
    text = "\n".join(lines).partition("\nexpect:")[0] + "\n"
    places = [found.span() for found in NUMBER.finditer(text) if not text[: found.start()].endswith("heun: ")]
    places = [(a, b) for a, b in places if "title:" not in text[text.rfind("\n", 0, a) : a]]
    for a, b in sorted(draw.sample(places, draw.randint(1, min(3, len(places)))), reverse=True):
        text = text[:a] + magnitude(draw) + text[b:]
    return Mutant(path.name, seed, text)


def magnitude(draw: random.Random) -> str:
    """A number of any magnitude, as it is written: often within what is computed with, sometimes beyond."""
    if draw.random() < 0.08:
        return draw.choice(SPECIAL)
    reach = draw.choice(((-320.0, 308.0), *[(-59.0, 59.0)] * 3, *[(-20.0, 20.0)] * 2, *[(-6.0, 6.0)] * 3))
    power = draw.uniform(*reach)
    figure = f"{10.0 ** (power % 1.0):.3f}e{int(power // 1.0)}"
    return f"-{figure}" if draw.random() < 0.2 else figure


def run(words: list[str], text: str) -> Outcome:
    """A command on a spec from standard input, with warnings as errors."""
    out, err, before = Captured(), Captured(), sys.stdin
    sys.stdin = io.TextIOWrapper(io.BytesIO(text.encode()))
    try:
        with redirect_stdout(out), redirect_stderr(err), warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            code = enter(words)
    except Exception as error:  # enter lets nothing pass
        return Outcome(70, out.text, err.text, repr(error))
    finally:
        sys.stdin = before
    fault = f"{caught[0].message} at {caught[0].filename}:{caught[0].lineno}" if caught else ""
    return Outcome(code, out.text, err.text, fault)


def violation(done: Outcome) -> str:
    """What of a run as JSON breaks the rules; empty: nothing."""
    if done.fault:
        return f"a warning: {done.fault}"
    if done.code not in CODES:
        return f"exit {done.code}: {done.err[:300]}"
    if "Traceback" in done.err:
        return "a traceback"
    if done.code >= 2:
        return "output with an error" if done.out else "" if done.err else "an error without a word"
    if not done.out.startswith("{"):
        return ""
    try:
        results = json.loads(done.out, parse_constant=lambda word: 1 / 0)
    except (ValueError, ZeroDivisionError) as error:
        return f"JSON: {error!r}"
    accuracy = results["accuracy"]
    residual = accuracy.get("balance_residual", 0.0)
    doubtful = residual is None or residual > UNDOUBTED
    return f"exit 0 with a balance to {residual}" if doubtful and "warning" not in done.err else ""


__all__ = ["Mutant", "Outcome", "mutant", "run", "violation"]
