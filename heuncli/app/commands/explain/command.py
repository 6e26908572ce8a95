"""`heun explain TOPIC`: show a page of the manual, a section, a code, a path or a word; without a topic a list."""

from __future__ import annotations

import re
from typing import Annotated

from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.options import OUTPUT, Option
from heuncli.app.cli.pager import write_paged
from heuncli.app.cli.registry import find_command
from heuncli.app.commands.explain.pages import (
    PAGES,
    find_section,
    list_sections,
    make_request,
    parse_codes,
    read_page,
    read_sections,
    read_summary,
)
from heuncli.base.errors import Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.spelling import find_similar, list_words
from heuncli.results.path_words import TREE


class ExplainRequest(NamedTuple):
    """The options and arguments of `heun explain`."""

    topic: Annotated[
        str | None,
        Option(
            (),
            "A page, 'PAGE SECTION', a word, a command, a code, a result path or an equation's number. "
            "Default: list the pages.",
            "TOPIC",
        ),
    ] = None
    output: Annotated[str | None, OUTPUT] = None
    no_pager: Annotated[bool, Option(("--no-pager",), "Do not use a pager on a terminal.")] = False


OTHERS = (
    ("SECTION", 'A section of a page, such as "format stops".'),
    ("WORD", "A key, an option, a result or an engineering term, such as stops, tilting, hardpoint."),
    ("CODE", "An error or a warning, such as unknown-key: meaning, what to do, an example."),
    ("PATH", "A result, such as joints.main.tilting: meaning, unit, sign, axes, error."),
    ("NUMBER", "An equation of Heun's paper, such as 31."),
)
LISTED = "heun explain lists the pages, heun explain words the engineering terms"


def main(request: ExplainRequest) -> int:
    """Run the command; returns the exit code."""
    topic = request.topic
    text = list_pages() if topic is None else explain_topic(topic)
    page = None if topic is None else find_page(topic)
    contents = list_sections(page) if page is not None and len(read_sections(page)) > 2 else ""
    write_paged(text, request.output, not request.no_pager, contents)
    return 0


def explain_topic(topic: str) -> str:
    """Return the text on a page, section, code, path, equation or word. Raises UsageError if it is none."""
    topic = topic.strip()
    codes = parse_codes(read_page("codes"))
    if (code := topic.strip("[]")) in codes:
        return codes[code] + ("" if "-" in topic or code != topic else _list_places(topic))
    if "." in topic and (text := _explain_path(topic)) is not None:
        return text
    if (page := find_page(topic)) is not None:
        return read_page(page)
    if (number := re.fullmatch(r"\(?(\d+)\)?", topic)) is not None:
        return format_equation(number[1])
    name, separator, heading = topic.replace("#", " ", 1).partition(" ")
    page = find_page(name)
    if page is not None and separator and (section := find_section(page, heading)) is not None:
        return section.text
    from heuncli.app.commands.explain.lookup import explain_word

    if (text := explain_word(topic)) is not None:
        return text
    if page is not None and separator:
        raise UsageError(_make_unknown_section(page, heading.strip()))
    raise UsageError(_make_unknown_topic(topic, tuple(codes)))


def _list_places(word: str) -> str:
    """List what to type to see the places that treat a word which is also an error code."""
    from heuncli.app.commands.explain.lookup import find_places, list_requests

    return list_requests(find_places(word))


def find_page(topic: str) -> str | None:
    """Return the page with a name, in any case, or that of a command; None if there is none."""
    command = find_command(topic)
    name = topic.lower() if command is None else command.page
    return name if name in PAGES else None


def _explain_path(topic: str) -> str | None:
    """Return the text on a path of the results, None if it is no path. Raises UsageError if it leads nowhere."""
    from heuncli.app.commands.explain.paths import explain_path, suggest_path

    text = explain_path(topic)
    block, _, rest = topic.partition(".")
    if text is None and block in TREE and rest:
        message = f"explain {topic}: there is no such result"
        raise UsageError(Problem("unknown-path", message, hint=suggest_path(topic)))
    return text


def _make_unknown_section(page: str, heading: str) -> Problem:
    """Make the problem for a section that does not exist on the page."""
    names = [section.heading.lower() for section in read_sections(page)[1:]]
    near = find_similar(heading.lower(), names)
    known = f"its sections: {list_words(names)}"
    hint = f"did you mean: {make_request(page, near)}?" if near else known
    return Problem("bad-option", f'the manual page "{page}" has no section "{heading}"', hint=hint)


def _make_unknown_topic(topic: str, codes: tuple[str, ...]) -> Problem:
    """Describe a topic that the manual does not know, with the most similar one, or where the word occurs."""
    from heuncli.app.commands.explain.lookup import find_mentions, list_names

    near = find_similar(topic, (*PAGES, *codes, *list_names()))
    quoted = f'"{near.lower()}"' if near and " " in near else near
    hints = [f"did you mean: heun explain {quoted}?"] if near else []
    if mentions := find_mentions(topic):
        hints.append(f"The word occurs in: {', '.join(mentions)}.")
    hint = " ".join((*hints, LISTED))
    return Problem("bad-option", f'there is no manual page "{topic}"', hint=hint)


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


def list_pages() -> str:
    """List the name of each page and its subject."""
    width = max(map(len, PAGES))
    pages = "".join(f"{name:<{width}}  {read_summary(name)}\n" for name in PAGES)
    return pages + "\n" + "".join(f"{name:<{width}}  {text}\n" for name, text in OTHERS)
