"""Locate unmatched brackets and quotes. Imported only for a text that is not YAML.

A parser notices an unclosed bracket only at the next key or at the end of the file. Here the text is scanned again with
a heuristic: a new key at the indentation (margin) of the line that opened the bracket, or further left, ends what is
open.
"""

from __future__ import annotations

import re

from heuncli.base.named_tuples import NamedTuple

CLOSING = {"[": "]", "{": "}"}
# the beginning of a line in block style: indentation, dashes of lists, a key with its colon
QUOTED_WORD = r"'[^'\n]*'[ \t]*|\"[^\"\n]*\"[ \t]*"
LINE_HEAD = re.compile(rf"([ ]*)(?:-[ \t]+)*(?:(?:{QUOTED_WORD}|[^\s'\"\[\]{{}},#&*!|>%@`][^\n]*?):(?=\s|\Z))?[ \t]*")
KEY = re.compile(rf"([ ]*)(?:-[ \t]+)*(?:{QUOTED_WORD}|[A-Za-z_][\w .\t-]*):(?=\s|\Z)")
BLOCK_TEXT = re.compile(r"[|>][-+0-9]*[ \t]*(?:#[^\n]*)?(?=\n|\Z)")
WORD = re.compile(r"[^\s'\"\[\]{}]+")
GAP = re.compile(r"[ \t]*(?:(?<=[ \t])#[^\n]*)?")
BLANK = re.compile(r"[ \t]*(?:#[^\n]*)?(?=\n|\Z)")
# possessive quantifiers: no backtracking, so an unclosed quote needs no memory for each following letter
QUOTED = {"'": re.compile(r"'(?:[^']++|'')*+'"), '"': re.compile(r'"(?:[^"\\]++|\\.)*+"', re.DOTALL)}
CONTINUES_AFTER = ",:[{"  # after one of these letters the next line may begin with a value or a key
MAX_MISMATCHES = 20  # reported together


class Mismatch(NamedTuple):
    """An unmatched bracket or quote: its offset in the text, a message and a hint."""

    offset: int
    message: str
    hint: str


class MismatchError(Exception):
    """A mismatch, and the index at which scanning continues."""

    def __init__(self, mismatch: Mismatch, resume_index: int) -> None:
        super().__init__(mismatch.message)
        self.mismatch, self.onward = mismatch, resume_index


def find_mismatches(text: str, stop_index: int) -> list[Mismatch]:
    """Find unmatched brackets and quotes in order of their position; an empty list if the first one lies after
    `stop_index`.
    """
    found_mismatches: list[Mismatch] = []
    index = 0
    while (
        index < (len(text) if found_mismatches else min(stop_index, len(text)))
        and len(found_mismatches) < MAX_MISMATCHES
    ):
        try:
            index = find_next_line(text, scan_block_line(text, index))
        except MismatchError as error:
            found_mismatches.append(error.mismatch)
            index = error.onward
    return found_mismatches if found_mismatches and found_mismatches[0].offset <= stop_index else []


def find_next_line(text: str, index: int) -> int:
    """Return the index at which the next line begins."""
    end = text.find("\n", index)
    return len(text) if end < 0 else end + 1


def line_number(text: str, index: int) -> int:
    """Return the line number, from 1, of an index."""
    return text.count("\n", 0, index) + 1


def format_position(text: str, index: int) -> str:
    """Format an index as line and column in words."""
    return f"line {line_number(text, index)}, column {index - text.rfind(chr(10), 0, index)}"


def scan_block_line(text: str, begin: int) -> int:
    """Scan the value that a line in block style begins; return an index in the last line it covers. Raises
    MismatchError.
    """
    if BLANK.match(text, begin):
        return begin
    head = LINE_HEAD.match(text, begin)
    assert head is not None
    margin, index = len(head[1]), head.end()
    if head[0].strip() == "" and margin == 0:
        margin = -1  # a document within one bracket has no margin
    if index >= len(text) or text[index] == "\n":
        return begin
    if BLOCK_TEXT.match(text, index):
        return find_block_text_end(text, index, margin)
    if text[index] in CLOSING:
        return scan_after_value(text, scan_flow(text, index, margin), text[index], margin)
    if text[index] in QUOTED:
        return scan_after_value(text, scan_quoted(text, index, margin), text[index], margin)
    return index


def find_block_text_end(text: str, index: int, margin: int) -> int:
    """Return an index in the last line of a block text: the lines indented further than `margin`."""
    line = find_next_line(text, index)
    while line < len(text):
        line_text = text[line : find_next_line(text, line)]
        if line_text.strip() and len(line_text) - len(line_text.lstrip(" ")) <= margin:
            return line - 1
        line = find_next_line(text, line)
    return len(text)


def scan_after_value(text: str, index: int, opening: str, margin: int) -> int:
    """Scan what follows a closed bracket or quote in block style: nothing, a comment, or the colon of a key.

    Raises MismatchError for anything else.
    """
    gap = GAP.match(text, index)
    assert gap is not None
    index = gap.end()
    if index >= len(text) or text[index] in "\n:":
        return index
    rest = text[index : find_next_line(text, index)].strip()
    if text[index] in CLOSING.values():
        message, hint = (
            f"closing '{text[index]}' without an opening bracket",
            "delete it, or add the opening bracket before it",
        )
    elif opening in CLOSING:
        message = f"unexpected '{shorten(rest)}' after the closing '{CLOSING[opening]}'"
        hint = f"put a text that starts with {opening} in quotes"
    else:
        message = f"unexpected '{shorten(rest)}' after the closing quote"
        hint = "double an apostrophe within '...', or put the text in \"...\""
    raise MismatchError(Mismatch(index, message, hint), find_next_key(text, index, margin))


def shorten(words: str) -> str:
    """Shorten a text to 20 characters."""
    return words if len(words) <= 20 else f"{words[:17]}..."


def find_next_key(text: str, index: int, margin: int) -> int:
    """Return the index of the next line that begins with a key at the margin or further left."""
    line = find_next_line(text, index)
    while line < len(text) and not begins_with_key(text, line, margin):
        line = find_next_line(text, line)
    return line


def begins_with_key(text: str, line: int, margin: int) -> bool:
    """Whether a line begins with a key at the margin or further left."""
    key = KEY.match(text, line)
    return key is not None and len(key[1]) <= margin


def scan_flow(text: str, begin: int, margin: int) -> int:
    """Scan a bracket to its end and return the index after it. Raises MismatchError."""
    open_brackets, index, last_letter = [begin], begin + 1, text[begin]
    early_end: MismatchError | None = None  # the error if a key at the margin was meant to end the bracket
    while True:
        if index >= len(text):
            raise early_end or unclosed_error(text, open_brackets, index)
        letter = text[index]
        if letter == "\n":
            if begins_with_key(text, index + 1, margin):
                early_end = early_end or unclosed_error(text, open_brackets, index + 1)
                if last_letter not in CONTINUES_AFTER:
                    raise early_end
            index += 1
            continue
        if letter in " \t":
            gap = GAP.match(text, index)
            assert gap is not None
            index = gap.end()
            continue
        if letter in QUOTED and last_letter in CONTINUES_AFTER:
            index = scan_quoted(text, index, margin)
            last_letter = letter
            continue
        if letter in CLOSING:
            open_brackets.append(index)
        elif letter in CLOSING.values():
            if CLOSING[text[open_brackets[-1]]] != letter:
                raise early_end or wrong_closing_error(text, open_brackets[-1], index, margin)
            open_brackets.pop()
            if not open_brackets:
                return index + 1
        word = WORD.match(text, index)
        index = word.end() if word else index + 1
        last_letter = text[index - 1]


def unclosed_error(text: str, open_brackets: list[int], index: int) -> MismatchError:
    """Make the error for brackets still open at an index where they must be closed."""
    missing = "".join(CLOSING[text[i]] for i in reversed(open_brackets))
    outer_count = len(open_brackets) - 1
    within = f", inside {outer_count} more open bracket{'' if outer_count == 1 else 's'}," if outer_count else ""
    where = f" before line {line_number(text, index)}, which begins with a key" if index < len(text) else ""
    message = f"the '{text[open_brackets[-1]]}' opened here{within} is not closed{where}"
    return MismatchError(Mismatch(open_brackets[-1], message, f"close it with '{missing}'"), index)


def wrong_closing_error(text: str, open_index: int, index: int, margin: int) -> MismatchError:
    """Make the error for a closing bracket of the wrong kind."""
    closing = CLOSING[text[open_index]]
    message = (
        f"found '{text[index]}' where '{closing}' is needed to close the '{text[open_index]}' at "
        f"{format_position(text, open_index)}"
    )
    hint = f"write '{closing}', or close the '{text[open_index]}' earlier"
    return MismatchError(Mismatch(index, message, hint), find_next_key(text, index, margin))


def scan_quoted(text: str, begin: int, margin: int) -> int:
    """Scan a quoted text and return the index after it. Raises MismatchError."""
    quote = text[begin]
    whole = QUOTED[quote].match(text, begin)
    end = whole.end() if whole else len(text)
    line = find_next_line(text, begin)
    while line < end:
        if begins_with_key(text, line, margin):
            end, whole = line, None
            break
        line = find_next_line(text, line)
    if whole:
        return end
    hint = f"close it with {quote}" + ("; double an apostrophe within it" if quote == "'" else "")
    where = f" before line {line_number(text, end)}, which begins with a key" if end < len(text) else ""
    raise MismatchError(Mismatch(begin, f"the {quote} opened here is not closed{where}", hint), end)
