"""The part of the manual's page on codes that follows from specs/broken: `python -m tests.manual.tables` writes it."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from difflib import SequenceMatcher
from pathlib import Path

from heuncli.base.errors import HeunError, Problem
from heuncli.scene.file_format.load import load
from heuncli.study.workflow import solve
from tests.shared.broken import FILES, HEAD, body, cured, cures, head, is_in_words
from tests.shared.folders import ROOT

PAGE = ROOT / "heuncli" / "manual" / "codes.md"
GENERATED = "Each with its cause, the remedy, and a spec's lines before (-) and after (+) the correction.\n"
WIDEST = 120
NEAR = 8  # characters that are shown before what changes in a line
LONGEST = 48  # characters of a line that is shown whole
SPECIFIC = (
    "did you mean",
    "for '",
    "known ",
    "along the normal",
    "it is called",
    "call it",
    "add radius",
    "a direction",
)  # the cure says it


def text() -> str:
    """All sections."""
    return "".join(f"\n### {path.stem}\n\n{''.join(section(path))}" for path in FILES)


def section(path: Path) -> Iterator[str]:
    """The cause, what to do, and the lines that the cure changes."""
    kind, see = head(path).group(1, 5)
    hint = found(path).hint
    remedy = "" if hint.startswith(SPECIFIC) else f" Remedy: {plain(hint)}"
    if is_in_words(path):
        remedy = f" Remedy: {plain(cures(path)[0][0])}"
    says = f"{'A warning: ' if kind == 'warning' else ''}{see[0].upper()}{see[1:]}.{remedy}"
    yield "\n".join(textwrap.wrap(says, WIDEST, break_long_words=False, break_on_hyphens=False)) + "\n"
    if not is_in_words(path):
        yield "\n" + textwrap.indent("".join(changes(path)), "    ")


def changes(path: Path) -> Iterator[str]:
    """The lines before and after the cure; of a long line, what stands around the change."""
    if path.stem == "bad-character":
        yield "- title: one(U+2028)two\n+ title: onetwo\n"
        return
    before, after = body(path).splitlines(), cured_body(path).splitlines()
    for tag, start, end, first, last in SequenceMatcher(None, before, after, autojunk=False).get_opcodes():
        if tag == "equal":
            continue
        old, new = before[start:end], after[first:last]
        if len(old) == len(new):
            for pair in zip(old, new, strict=True):
                yield "- {}\n+ {}\n".format(*shortened(*pair))
        else:
            yield "".join(f"{sign} {line.strip()}\n" for sign, lines in (("-", old), ("+", new)) for line in lines)


def cured_body(path: Path) -> str:
    """The spec with its cures applied."""
    first, _, rest = cured(path).partition("\n")
    return HEAD.sub("", f"{first}\n{rest}", count=1)


def shortened(old: str, new: str) -> tuple[str, str]:
    """Two lines without their indentation; of long ones, what stands around the part that differs."""
    old, new = (line.strip().removeprefix("- ") for line in (old, new))
    if max(len(old), len(new)) <= LONGEST:
        return old, new
    shorter = min(len(old), len(new))
    left = next((i for i in range(shorter) if old[i] != new[i]), shorter)
    right = next((i for i in range(shorter - left) if old[-1 - i] != new[-1 - i]), shorter - left)
    return tuple(part(line, left, len(line) - right) for line in (old, new))  # type: ignore[return-value]


def part(line: str, start: int, end: int) -> str:
    """The part of a line from start to end in whole words, and some before it."""
    name, colon, _ = line.partition(": ")
    first = max(line.rfind(" ", 0, max(start - NEAR, 0)) + 1, 0)
    last = line.find(" ", end)
    last = len(line) if last < 0 else last
    opening = (
        f"{name}: ... " if colon and len(name) < LONGEST // 2 and first > len(name) + 2 else "... " if first else ""
    )
    shown = line[first:last]
    shown = shown if len(shown) <= WIDEST - 20 else f"{shown[:LONGEST]} ... {shown[-LONGEST // 2 :]}"
    return f"{opening}{shown}{' ...' if last < len(line) else ''}"


def plain(words: str) -> str:
    """Text as markdown does not read marks into it, a sentence."""
    text = " ".join(words.split()).replace("|", "\\|").rstrip(".")
    return text if text.endswith("?") else f"{text}."


def found(path: Path) -> Problem:
    """The problem of the file's code."""
    name, value = head(path).groups()[-2:]
    overrides = {name: value} if name else {}
    try:
        problems = solve_all(path, overrides)
    except HeunError as error:
        problems = error.problems
    return next(problem for problem in problems if problem.code == path.stem)


def solve_all(path: Path, overrides: dict[str, str]) -> tuple[Problem, ...]:
    spec = load(path.relative_to(ROOT), overrides=overrides)
    if not spec.warnings:
        solve(spec)
    return spec.warnings


def written() -> str:
    """The page with its generated part."""
    kept = PAGE.read_text(encoding="utf-8").partition(GENERATED)[0]
    return kept + GENERATED + text()
