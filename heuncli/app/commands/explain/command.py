"""`heun explain TOPIC`: show a page of the manual, a section, a code, a path or a word; without a topic a list.

A long text is shown on a terminal through a pager, else written directly. While the pager runs, the terminal's keys
belong to it: heun ignores interrupts and waits until it ends. If heun is ended (SIGTERM, SIGHUP) it ends the pager
first and restores the terminal. Impure: processes, signals.
"""

from __future__ import annotations

import _signal  # type: ignore[import-not-found]
import os
import re
import shlex
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Annotated, Any

from heuncli.app.cli import terminal
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.options import OUTPUT, Option
from heuncli.app.cli.output import emit
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
from heuncli.base.signals import CleanupOnSignal
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
    from heuncli.app.commands.explain.pages import explain_path, suggest_path

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


DEFAULT = ("less", "-FRX")
SHELL_CHARACTERS = frozenset("|&;<>()$`\\\"'*?[]#~=%\n")  # PAGER with none of them is run without a shell
PATIENCE = 2.0  # seconds from the request to end until the pager is killed
KEYS = ("SIGINT", "SIGQUIT")  # signals that a terminal sends for a key, to heun and to the pager


def write_paged(text: str, output: str | None, use_pager: bool = True, contents: str = "") -> None:
    """Write a text to a file or a pipe as it is, and to a terminal through the pager if it has more lines than the
    screen; there the list of its contents comes first.
    """
    command = _find_pager() if output is None and use_pager and terminal.is_terminal() else None
    if command is None or text.count("\n") < shutil.get_terminal_size().lines:
        emit(text, output)
        return
    try:
        with _ignore_key_signals():
            _run_pager(command, (f"{contents}\n{text}" if contents else text).encode())
    except OSError:
        emit(text)


def _find_pager() -> Sequence[str] | None:
    """Return the command of PAGER, else less; None if there is none, or no terminal to read keys from."""
    pager = os.environ.get("PAGER")
    if sys.stdin is None or not sys.stdin.isatty() or pager in ("", "cat"):
        return None
    if not pager:
        return DEFAULT if shutil.which(DEFAULT[0]) else None
    return ("/bin/sh", "-c", pager) if SHELL_CHARACTERS.intersection(pager) else shlex.split(pager) or None


def _run_pager(command: Sequence[str], text: bytes) -> None:
    """Run the pager to its end. Raises OSError if it cannot be started."""
    terminal_state = _read_terminal_state()
    process = subprocess.Popen(command, stdin=subprocess.PIPE)
    with CleanupOnSignal(lambda: _end_pager(process, terminal_state)):
        try:
            with suppress(BrokenPipeError):  # it ended before it had read all
                process.communicate(text)
        finally:
            process.wait()


def _end_pager(process: subprocess.Popen[bytes], terminal_state: list[Any] | None) -> None:
    """End the pager, wait for it, and restore the terminal. May be called at any instant."""
    process.terminate()
    deadline = time.monotonic() + PATIENCE
    while not _has_ended(process) and time.monotonic() < deadline:
        time.sleep(0.005)
    process.kill()
    if terminal_state is not None:
        import termios

        _signal.signal(_signal.SIGTTOU, _signal.SIG_IGN)  # otherwise setting it from the background stops heun
        with suppress(termios.error):  # the terminal is gone
            termios.tcsetattr(sys.stdin.fileno(), termios.TCSANOW, terminal_state)


def _has_ended(process: subprocess.Popen[bytes]) -> bool:
    """Return whether a process ended, by asking the system: `poll` would need a lock that an interrupted wait still
    holds.
    """
    try:
        return process.returncode is not None or os.waitpid(process.pid, os.WNOHANG)[0] != 0
    except ChildProcessError:
        return True


def _read_terminal_state() -> list[Any] | None:
    """Return the settings of the terminal that keys are read from, or None if there is none."""
    try:
        import termios

        assert sys.stdin is not None
        return termios.tcgetattr(sys.stdin.fileno())
    except (ImportError, OSError, termios.error):
        return None


@contextmanager
def _ignore_key_signals() -> Iterator[None]:
    """Ignore the signals of keys, by an empty handler: SIG_IGN would be inherited by the pager."""
    previous_handlers: dict[int, Any] = {}
    try:
        for name in KEYS:
            number = getattr(_signal, name, None)
            if number is not None and _signal.getsignal(number) != _signal.SIG_IGN:
                with suppress(ValueError):  # not the main thread
                    previous_handlers[number] = _signal.signal(number, lambda *_: None)
        yield
    finally:
        for number, handler in previous_handlers.items():
            _signal.signal(number, handler)
