"""The part of the manual's page on codes that follows from specs/broken: `python -m tests.manual.tables` writes it."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from pathlib import Path

from heuncli.base.errors import HeunError, Problem
from heuncli.scene.file_format.load import load
from heuncli.study.workflow import solve
from tests.shared.broken import FILES, body, cures, head, is_in_words
from tests.shared.folders import ROOT

PAGE = ROOT / "heuncli" / "manual" / "codes.md"
GENERATED = "Each with a spec that causes it, heun's message, and the cure.\n"
WIDEST = 120
SHORTENED = 60


def text() -> str:
    """All sections."""
    return "".join(f"\n### {path.stem}\n\n{''.join(section(path))}" for path in FILES)


def section(path: Path) -> Iterator[str]:
    """What it is about, the spec, what is said, the cure."""
    kind, _, _, _, see, name, value = head(path).groups()
    yield f"{'A warning: ' if kind == 'warning' else ''}{sentence(see)}\n\n"
    spec = "\n".join(map(shortened, body(path).rstrip().splitlines()))
    yield f"```text\n{spec}\n```\n\n" if spec else ""
    problem = found(path)
    given = f" with `--set {name}={value}`" if name else ""
    says = f"heun says{given}: {plain(problem.message)} Hint: {plain(problem.hint)}".replace("specs/broken/", "")
    yield "\n".join(textwrap.wrap(says, WIDEST, break_long_words=False, break_on_hyphens=False)) + "\n\n"
    if is_in_words(path):
        yield f"Cure: {cures(path)[0][0]}.\n"
        return
    yield (
        "Cure:\n\n```text\n"
        + "".join(f"- {old}\n" + (f"+ {new}\n" if new else "") for old, new in map(lines, cures(path)))
        + "```\n"
    )


def lines(pair: tuple[str, str]) -> tuple[str, str]:
    old, new = (text.strip("\n").replace("\n", "\n  ").replace("\u2028", "(U+2028)") for text in pair)
    return shortened(old), new


def shortened(line: str) -> str:
    """A line no longer than a page is wide."""
    line = line.replace("\u2028", "(U+2028)")
    return line if len(line) <= WIDEST else f"{line[:SHORTENED]} ... {line[-SHORTENED + 6 :]}"


def sentence(words: str) -> str:
    return f"{words[0].upper()}{words[1:]}."


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
