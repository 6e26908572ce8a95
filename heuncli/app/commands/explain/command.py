"""`heun explain TOPIC`: a page of the manual as it is written; without a topic a line for each page."""

from __future__ import annotations

import re
from pathlib import Path

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.pager import show
from heuncli.app.cli.registry import COMMANDS, command_of
from heuncli.app.commands.explain.codes import codes_of
from heuncli.app.commands.explain.request import ExplainRequest
from heuncli.base.errors import Problem
from heuncli.base.nearest import did_you_mean
from heuncli.results.results_schema import TREE

FOLDER = Path(__file__).parents[3] / "manual"
# in the order in which a reader may want them, the pages of single commands in the order of those
PAGES = tuple(dict.fromkeys((
    "commands", "format", "howto", "elements", "python", "results", "signs", "open", "stresses", "collectives", "rest",
    *(command.page for command in COMMANDS), "accuracy", "codes", "impacts", "limits", "theory", "equations",
    "references", "decisions", "speed", "developing", "contributing", "index",
)))  # fmt: skip

OTHERS = (
    ("CODE", "An error or a warning, such as unknown-key: what it says, why, an example, the cure."),
    ("PATH", "A number of the results, such as joints.main.tilting: meaning, unit, sign, frame, error."),
    ("NUMBER", "An equation of the paper, such as 31."),
)


def main(request: ExplainRequest) -> int:
    """Run the command; returns the exit code."""
    show(contents() if request.topic is None else told(request.topic), request.output, not request.no_pager)
    return 0


def told(topic: str) -> str:
    """What is told of a code, a path of the results, or a topic of the manual. Raises UsageError where it is none."""
    codes = codes_of((FOLDER / "codes.md").read_text(encoding="utf-8"))
    if (code := topic.strip("[]")) in codes:
        return codes[code]
    if "." in topic:
        from heuncli.app.commands.explain.paths import explained

        if (text := explained(topic)) is not None:
            return text
        if (block := topic.split(".", 1)[0]) in TREE:
            hint = f"heun explain {block}.NAME lists what there is"
            raise UsageError(Problem("unknown-path", f"explain {topic}: this leads to no result", hint=hint))
    if topic not in PAGES and "-" in topic:
        near = did_you_mean(topic, codes, "codes")
        raise UsageError(Problem("bad-option", f"explain {topic}: there is no such code", hint=f"{near}; or a page"))
    return page(topic)


def page(topic: str) -> str:
    """The text of a page, by its name or that of a command. Raises UsageError where there is none."""
    command = command_of(topic)
    if command is not None:
        topic = command.page
    if (number := re.fullmatch(r"\(?(\d+)\)?", topic)) is not None:
        return equation(number[1])
    if topic not in PAGES:
        hint = f"{indexed(topic) or did_you_mean(topic, PAGES, 'topics')}; heun explain lists the pages"
        raise UsageError(Problem("bad-option", f"explain {topic}: no page of the manual is called that", hint=hint))
    return (FOLDER / f"{topic}.md").read_text(encoding="utf-8")


def equation(number: str) -> str:
    """The row of a numbered equation, a line a cell. Raises UsageError for a number that the page does not have."""
    rows = [line.strip("|").split(" | ") for line in page("equations").splitlines() if line.startswith("| ")]
    heads, *equations = [[cell.strip() for cell in row] for row in rows]
    own = next((row for row in equations if f"({number})" in row[0]), None)
    if own is None:
        message = f"explain {number}: no equation of the paper has this number"
        raise UsageError(Problem("bad-option", message, hint="they are (16) to (61): heun explain equations"))
    width = max(map(len, heads))
    return "".join(f"{head:<{width}}  {cell}\n" for head, cell in zip(heads, own, strict=True))


def indexed(word: str) -> str:
    """Where a key, an option, a word of the results or a subject stands by the index; empty where it knows none."""
    named = re.compile(rf"(?<!\w){re.escape(word)}s?(?!\w)", re.IGNORECASE)
    places: dict[str, dict[str, None]] = {}
    for row in re.findall(r"^\| .*", page("index"), re.MULTILINE):
        name, _, where = row[2:].partition(" |")
        for part, topic in re.findall(r"\[([^]]*)\]\((\w+)\.md", where) if named.search(name) else ():
            places.setdefault(topic, {})[part] = None
    told = (f"heun explain {topic} ({', '.join(parts)})" for topic, parts in places.items())
    return f"see {' and '.join(told)}" if places else ""


def contents() -> str:
    """The name of each page, and what it is about."""
    width = max(map(len, PAGES))
    pages = "".join(f"{name:<{width}}  {summary(name)}\n" for name in PAGES)
    return pages + "\n" + "".join(f"{name:<{width}}  {text}\n" for name, text in OTHERS)


def summary(topic: str) -> str:
    """What a page is about: the line below its title."""
    return page(topic).split("\n", 3)[2]
