"""Brackets and quotes that do not match, found where they stand. Imported only for a text that is not YAML.

A parser finds out at the next key, or at the end of the file, that a bracket was left open. Here the text is read once
more by what people write: a new key at the margin of the line that opened a bracket, or further out, ends what is open.
"""

from __future__ import annotations

import re

from heuncli.base.named_tuples import NamedTuple

CLOSING = {"[": "]", "{": "}"}
# the begin of a line in block style: indentation, dashes of lists, a key with its colon
QUOTED_WORD = r"'[^'\n]*'[ \t]*|\"[^\"\n]*\"[ \t]*"
HEAD = re.compile(rf"([ ]*)(?:-[ \t]+)*(?:(?:{QUOTED_WORD}|[^\s'\"\[\]{{}},#&*!|>%@`][^\n]*?):(?=\s|\Z))?[ \t]*")
KEY = re.compile(rf"([ ]*)(?:-[ \t]+)*(?:{QUOTED_WORD}|[A-Za-z_][\w .\t-]*):(?=\s|\Z)")
BLOCK_TEXT = re.compile(r"[|>][-+0-9]*[ \t]*(?:#[^\n]*)?(?=\n|\Z)")
WORD = re.compile(r"[^\s'\"\[\]{}]+")
GAP = re.compile(r"[ \t]*(?:(?<=[ \t])#[^\n]*)?")
BLANK = re.compile(r"[ \t]*(?:#[^\n]*)?(?=\n|\Z)")
# possessive: what is taken is not given back, so that a quote left open takes no memory for every letter after it
QUOTED = {"'": re.compile(r"'(?:[^']++|'')*+'"), '"': re.compile(r'"(?:[^"\\]++|\\.)*+"', re.DOTALL)}
OPEN_STILL = ",:[{"  # after one of these a value or a key may begin in the next line
MOST = 20  # that are told together


class Mismatch(NamedTuple):
    """What is wrong with a bracket or a quote: where in the text, a sentence, and what to do."""

    at: int
    message: str
    hint: str


class Unreadable(Exception):
    """A mismatch, and where to read on."""

    def __init__(self, mismatch: Mismatch, onward: int) -> None:
        super().__init__(mismatch.message)
        self.mismatch, self.onward = mismatch, onward


def mismatches(text: str, until: int) -> list[Mismatch]:
    """Brackets and quotes of the text that are not matched, in order; none if none is before the index `until`."""
    found: list[Mismatch] = []
    at = 0
    while at < (len(text) if found else min(until, len(text))) and len(found) < MOST:
        try:
            at = next_line(text, block_line(text, at))
        except Unreadable as trouble:
            found.append(trouble.mismatch)
            at = trouble.onward
    return found if found and found[0].at <= until else []


def next_line(text: str, at: int) -> int:
    """Where the line after this index begins."""
    end = text.find("\n", at)
    return len(text) if end < 0 else end + 1


def line_of(text: str, at: int) -> int:
    """The number of a line, from 1."""
    return text.count("\n", 0, at) + 1


def place_of(text: str, at: int) -> str:
    """Line and column, as words."""
    return f"line {line_of(text, at)}, column {at - text.rfind(chr(10), 0, at)}"


def block_line(text: str, begin: int) -> int:
    """Read what a line in block style begins; returns an index in the last line that it took."""
    if BLANK.match(text, begin):
        return begin
    head = HEAD.match(text, begin)
    assert head is not None
    margin, at = len(head[1]), head.end()
    if head[0].strip() == "" and margin == 0:
        margin = -1  # what is all in one bracket has no margin
    if at >= len(text) or text[at] == "\n":
        return begin
    if BLOCK_TEXT.match(text, at):
        return end_of_block_text(text, at, margin)
    if text[at] in CLOSING:
        return after_value(text, flow(text, at, margin), text[at], margin)
    if text[at] in QUOTED:
        return after_value(text, quoted(text, at, margin), text[at], margin)
    return at


def end_of_block_text(text: str, at: int, margin: int) -> int:
    """The last line of a text in lines of its own: those further in than its key."""
    line = next_line(text, at)
    while line < len(text):
        shown = text[line : next_line(text, line)]
        if shown.strip() and len(shown) - len(shown.lstrip(" ")) <= margin:
            return line - 1
        line = next_line(text, line)
    return len(text)


def after_value(text: str, at: int, opened: str, margin: int) -> int:
    """What may follow a closed bracket or quote in block style: nothing, a comment, or the colon of a key."""
    gap = GAP.match(text, at)
    assert gap is not None
    at = gap.end()
    if at >= len(text) or text[at] in "\n:":
        return at
    rest = text[at : next_line(text, at)].strip()
    if text[at] in CLOSING.values():
        message, hint = f"'{text[at]}' closes nothing: no bracket is open here", "delete it, or open the bracket before"
    elif opened in CLOSING:
        message = f"'{short(rest)}' stands after the closing '{CLOSING[opened]}'"
        hint = f"a text that starts with {opened} is written in quotes"
    else:
        message = f"'{short(rest)}' stands after the closing quote"
        hint = "an apostrophe within '...' is written twice, or the text stands in \"...\""
    raise Unreadable(Mismatch(at, message, hint), next_key(text, at, margin))


def short(words: str) -> str:
    """The first of some words."""
    return words if len(words) <= 20 else f"{words[:17]}..."


def next_key(text: str, at: int, margin: int) -> int:
    """The next line that begins with a key at the margin, or further out."""
    line = next_line(text, at)
    while line < len(text) and not at_margin(text, line, margin):
        line = next_line(text, line)
    return line


def at_margin(text: str, line: int, margin: int) -> bool:
    """Whether a line begins with a key at the margin, or further out."""
    key = KEY.match(text, line)
    return key is not None and len(key[1]) <= margin


def flow(text: str, begin: int, margin: int) -> int:
    """Read a bracket to its end; returns the index after it. Raises Unreadable."""
    opened, at, last = [begin], begin + 1, text[begin]
    ends: Unreadable | None = None  # where a key at the margin may have ended it
    while True:
        if at >= len(text):
            raise ends or unclosed(text, opened, at)
        c = text[at]
        if c == "\n":
            if at_margin(text, at + 1, margin):
                ends = ends or unclosed(text, opened, at + 1)
                if last not in OPEN_STILL:
                    raise ends
            at += 1
            continue
        if c in " \t":
            gap = GAP.match(text, at)
            assert gap is not None
            at = gap.end()
            continue
        if c in QUOTED and last in OPEN_STILL:
            at = quoted(text, at, margin)
            last = c
            continue
        if c in CLOSING:
            opened.append(at)
        elif c in CLOSING.values():
            if CLOSING[text[opened[-1]]] != c:
                raise ends or crossed(text, opened[-1], at, margin)
            opened.pop()
            if not opened:
                return at + 1
        word = WORD.match(text, at)
        at = word.end() if word else at + 1
        last = text[at - 1]


def unclosed(text: str, opened: list[int], at: int) -> Unreadable:
    """Brackets that are open where they cannot be."""
    missing = "".join(CLOSING[text[i]] for i in reversed(opened))
    others = len(opened) - 1
    within = f", within {others} more that {'is' if others == 1 else 'are'} open," if others else ""
    where = f" before line {line_of(text, at)}, which begins with a key" if at < len(text) else ""
    message = f"the '{text[opened[-1]]}' opened here{within} is not closed{where}"
    return Unreadable(Mismatch(opened[-1], message, f"close it with '{missing}'"), at)


def crossed(text: str, opened: int, at: int, margin: int) -> Unreadable:
    """A closing bracket of the other kind."""
    need = CLOSING[text[opened]]
    message = f"found '{text[at]}' where '{need}' is needed, for the '{text[opened]}' of {place_of(text, opened)}"
    hint = f"write '{need}', or close the '{text[opened]}' before"
    return Unreadable(Mismatch(at, message, hint), next_key(text, at, margin))


def quoted(text: str, begin: int, margin: int) -> int:
    """Read a text in quotes; returns the index after it. Raises Unreadable."""
    mark = text[begin]
    whole = QUOTED[mark].match(text, begin)
    end = whole.end() if whole else len(text)
    line = next_line(text, begin)
    while line < end:
        if at_margin(text, line, margin):
            end, whole = line, None
            break
        line = next_line(text, line)
    if whole:
        return end
    hint = f"close it with {mark}" + ("; an apostrophe within it is written twice" if mark == "'" else "")
    where = f" before line {line_of(text, end)}, which begins with a key" if end < len(text) else ""
    raise Unreadable(Mismatch(begin, f"the text that {mark} opens here is not closed{where}", hint), end)
