"""What must hold of every command line, whatever stands in the spec: one function that judges an outcome."""

from __future__ import annotations

import csv
import io
import json
import math
import re
from collections.abc import Iterable, Iterator
from typing import Any

from tests.faults.outcome import Outcome

DOCUMENTED = frozenset({0, 1, 2, 3, 4, 5})  # 70 is a bug, 130 and 141 come from outside
ERRORS = frozenset({2, 3, 4, 5})
PROBLEM = re.compile(r".+ \[[a-z0-9-]+\]")
USAGE = re.compile(r"Usage: heun .*|Try 'heun .*|Error: .+")  # in the words of the option parser
BESIDE = re.compile(r"  hint: .+|warning: .+|heun: .+")
CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")
SECONDS = {"validate": 2.0, "model": 5.0, "modes": 5.0, "check": 5.0, "methods": 2.0}
WITH_LIMIT = 1.0  # second beyond --time-limit
MEGABYTES = {"validate": 500.0}
MOST = 1500.0  # megabytes, of any command
UNBALANCED = 1e-6  # of the largest load of a body
NOT_NUMBERS = re.compile(rb"(?<![\w.])(nan|inf|NaN|Infinity)(?![\w.])")


def violations(done: Outcome, code_of_validate: int | None = None, codes: frozenset[int] | None = None) -> list[str]:
    """What an outcome is not as it must be, a sentence each.

    code_of_validate: what `validate` of the same spec ended with. codes: those that this command may end with.
    """
    return list(_violations(done, code_of_validate, codes))


def _violations(done: Outcome, code_of_validate: int | None, codes: frozenset[int] | None) -> Iterator[str]:
    err = done.err.decode("utf-8", "backslashreplace")
    if done.code not in DOCUMENTED:
        yield f"exit code {done.code}: {_line(err, 'bug in heun')}"
    elif codes is not None and done.code not in codes:
        yield f"exit code {done.code}, expected {sorted(codes)}: {_line(err, '[')}"
    if "Traceback" in err or 'File "' in err:
        yield f"traceback: {_line(err, 'Traceback')}"
    if re.search(r"\w+Warning\b", err):
        yield f"warning of Python: {_line(err, 'Warning')}"
    if done.noise and not any("/dev/stdout" in word for word in done.argv):
        yield f"past Python: {done.noise[:200]!r}"
    if code_of_validate == 0 and done.code == 2:
        yield f"validate is fine, and {done.argv[0]} ends with 2: {_line(err, '[')}"
    if done.code in ERRORS:
        if done.out and done.argv[0] != "check":  # which tells the results of the other specs
            yield f"standard output with exit code {done.code}: {done.out[:80]!r}"
        yield from _form(err)
    elif done.code != 0 and not (err or done.out):
        yield f"exit code {done.code} without a word"
    if found := CONTROL.search(err):
        yield f"control character {found[0]!r} on standard error: {_line(err, found[0])!r}"
    if done.code in (0, 1):
        yield from _output(done)
    yield from _size(done)


def _line(err: str, word: str) -> str:
    """The line of standard error that tells most."""
    lines = [line for line in err.splitlines() if word in line] or err.splitlines() or [""]
    return lines[0][:300]


def _form(err: str) -> Iterator[str]:
    """An error is told as problems with their codes, hints below them."""
    lines = err.splitlines()
    usage = any(line.startswith("Error: ") for line in lines)
    if not usage and not any(PROBLEM.fullmatch(line) for line in lines):
        yield f"no problem is told: {err[:200]!r}"
    for line in lines:
        if line and not (PROBLEM.fullmatch(line) or BESIDE.fullmatch(line) or (usage and USAGE.fullmatch(line))):
            yield f"a line of no known form: {line[:200]!r}"
            return


def _output(done: Outcome) -> Iterator[str]:
    """What is told is numbers, or null or a word in their place."""
    form = _format(done.argv)
    text = done.out.decode("utf-8", "backslashreplace")
    if found := CONTROL.search(text.replace("\r\n", "\n")):
        yield f"control character {found[0]!r} on standard output"
    if not text or "--help" in done.argv or "--version" in done.argv:
        return
    if form == "json":
        yield from _json(text, b"warning" in done.err or "--quiet" in done.argv or "-q" in done.argv)
    elif form == "csv" and done.argv[0] == "run" and not any(word.startswith("--measure") for word in done.argv):
        yield from _csv(io.TextIOWrapper(io.BytesIO(done.out), "utf-8", "backslashreplace", newline=""))
    elif (found_there := NOT_NUMBERS.search(re.sub(rb'"[^"]*"', b"", done.out))) and not _asked(done, found_there[0]):
        yield f"{found_there[0].decode()} on standard output"


def _asked(done: Outcome, word: bytes) -> bool:
    """Whether a word that is no number stands on the command line itself, as a title may."""
    alone = rf"(?<![\w.]){word.decode()}(?![\w.])"
    return any(re.search(alone, each) for each in done.argv)


def _format(argv: tuple[str, ...]) -> str:
    form = "table"
    for word, after in zip(argv, (*argv[1:], ""), strict=True):
        if word == "--format":
            form = after
        elif word.startswith("--format="):
            form = word.partition("=")[2]
    return form


def _json(text: str, warned: bool) -> Iterator[str]:
    def fail(word: str) -> Any:
        raise ValueError(f"{word} in JSON")

    try:
        told = json.loads(text, parse_constant=fail)
    except ValueError as reason:
        yield f"no JSON: {reason}"
        return
    residual = told.get("accuracy", {}).get("balance_residual", 0.0) if isinstance(told, dict) else 0.0
    if (residual is None or residual > UNBALANCED) and not warned:
        yield f"forces balance to {residual} only, and nothing is said of it"


def _csv(lines: Iterable[str]) -> Iterator[str]:
    """Row by row: of a long motion there are millions, which as lists take ten times the memory of the text."""
    rows = csv.reader(lines)
    head = next(rows, [])
    at = head.index("value") if "value" in head else None
    for row in rows:
        if len(row) != len(head):
            yield f"a line of CSV with {len(row)} in place of {len(head)} cells: {row}"
            return
        if at is not None and row[at] and not _finite(row[at]):
            yield f"a number of CSV that is none: {row}"
            return


def _finite(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return word in ("open", "?", "true", "false")


def _size(done: Outcome) -> Iterator[str]:
    """Time and memory within what is stated."""
    command = done.argv[0] if done.argv else ""
    limit = SECONDS.get(command)
    if "--time-limit" in done.argv:
        try:
            limit = max(float(done.argv[done.argv.index("--time-limit") + 1]), 0.0) + WITH_LIMIT
        except (ValueError, IndexError):
            limit = None
    if limit is not None and done.seconds > limit:
        yield f"{command} took {done.seconds:.1f} s, at most {limit:g} s are allowed"
    if done.memory > MEGABYTES.get(command, MOST):
        yield f"{command} held {done.memory:.0f} MB"
