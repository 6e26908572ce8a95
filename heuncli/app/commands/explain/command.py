"""`heun explain TOPIC`: print a page of the manual; without a topic list the pages."""

from __future__ import annotations

import re
from pathlib import Path

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.pager import write_paged
from heuncli.app.cli.registry import COMMANDS, find_command
from heuncli.app.commands.explain.codes import parse_codes
from heuncli.app.commands.explain.request import ExplainRequest
from heuncli.base.errors import Problem
from heuncli.base.spelling import suggest
from heuncli.results.results_schema import TREE

FOLDER = Path(__file__).parents[3] / "manual"
# in reading order; the pages of commands in the order of COMMANDS
PAGES = tuple(dict.fromkeys((
    "commands", "format", "howto", "elements", "python", "results", "signs", "open", "stresses", "collectives", "rest",
    *(command.page for command in COMMANDS), "accuracy", "codes", "impacts", "limits", "theory", "equations",
    "references", "decisions", "speed", "developing", "contributing", "index",
)))  # fmt: skip

OTHERS = (
    ("CODE", "An error or a warning, such as unknown-key: meaning, cause, example, remedy."),
    ("PATH", "A result, such as joints.main.tilting: meaning, unit, sign, axes, error."),
    ("NUMBER", "An equation of the paper, such as 31."),
)


def main(request: ExplainRequest) -> int:
    """Run the command; returns the exit code."""
    write_paged(
        list_pages() if request.topic is None else explain_topic(request.topic), request.output, not request.no_pager
    )
    return 0


def explain_topic(topic: str) -> str:
    """Return the text on a code, a path of the results, or a topic of the manual. Raises UsageError if it is none."""
    codes = parse_codes((FOLDER / "codes.md").read_text(encoding="utf-8"))
    if (code := topic.strip("[]")) in codes:
        return codes[code]
    if "." in topic:
        from heuncli.app.commands.explain.paths import explain_path

        if (text := explain_path(topic)) is not None:
            return text
        if (block := topic.split(".", 1)[0]) in TREE:
            hint = f"heun explain {block}.NAME lists the results"
            raise UsageError(Problem("unknown-path", f"explain {topic}: there is no such result", hint=hint))
    if topic not in PAGES and "-" in topic:
        near = suggest(topic, codes, "codes")
        raise UsageError(
            Problem("bad-option", f"explain {topic}: there is no such code", hint=f"{near}; or give a page")
        )
    return read_page(topic)


def read_page(topic: str) -> str:
    """Read a page, by its name or that of a command. Raises UsageError if there is none."""
    command = find_command(topic)
    if command is not None:
        topic = command.page
    if (number := re.fullmatch(r"\(?(\d+)\)?", topic)) is not None:
        return format_equation(number[1])
    if topic not in PAGES:
        hint = f"{find_in_index(topic) or suggest(topic, PAGES, 'topics')}; heun explain lists the pages"
        raise UsageError(Problem("bad-option", f"explain {topic}: there is no such manual page", hint=hint))
    return (FOLDER / f"{topic}.md").read_text(encoding="utf-8")


def format_equation(number: str) -> str:
    """Return the row of a numbered equation, one cell per line. Raises UsageError for an unknown number."""
    rows = [line.strip("|").split(" | ") for line in read_page("equations").splitlines() if line.startswith("| ")]
    heads, *equations = [[cell.strip() for cell in row] for row in rows]
    row_found = next((row for row in equations if f"({number})" in row[0]), None)
    if row_found is None:
        message = f"explain {number}: no equation of the paper has this number"
        raise UsageError(Problem("bad-option", message, hint="the equations are (16) to (61): heun explain equations"))
    width = max(map(len, heads))
    return "".join(f"{head:<{width}}  {cell}\n" for head, cell in zip(heads, row_found, strict=True))


def find_in_index(word: str) -> str:
    """Return where a key, an option, a word of the results or a subject stands by the index; empty if unknown."""
    named = re.compile(rf"(?<!\w){re.escape(word)}s?(?!\w)", re.IGNORECASE)
    places: dict[str, dict[str, None]] = {}
    for row in re.findall(r"^\| .*", read_page("index"), re.MULTILINE):
        name, _, where = row[2:].partition(" |")
        for part, topic in re.findall(r"\[([^]]*)\]\((\w+)\.md", where) if named.search(name) else ():
            places.setdefault(topic, {})[part] = None
    pages = (f"heun explain {topic} ({', '.join(parts)})" for topic, parts in places.items())
    return f"see {' and '.join(pages)}" if places else ""


def list_pages() -> str:
    """List the name of each page and its subject."""
    width = max(map(len, PAGES))
    pages = "".join(f"{name:<{width}}  {read_summary(name)}\n" for name in PAGES)
    return pages + "\n" + "".join(f"{name:<{width}}  {text}\n" for name, text in OTHERS)


def read_summary(topic: str) -> str:
    """Return the subject of a page: the line below its title."""
    return read_page(topic).split("\n", 3)[2]
