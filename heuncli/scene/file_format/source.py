"""YAML text -> plain data and the location of every value; strict, without any knowledge of mechanics.

Scalars are those of YAML 1.2 (`on` and `012` are what they look like, `1e-3` is a number). Refused: tags, anchors,
aliases, merge keys, keys given twice, several documents, nesting beyond 64, characters that shift lines unseen.
PyYAML's parser gives the events; data and locations are built here without recursion.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import yaml
from yaml import events

from heuncli.base.errors import Finding, Problem, SourceLocation, SpecError
from heuncli.base.records import record
from heuncli.scene.file_format.digest import digest
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes

LARGEST = 64_000_000  # bytes, and characters; a scene of 100,000 bodies has about 40 million
DEEPEST = 64
TOO_DEEP = f"nested more than {DEEPEST} levels deep"
TOO_DEEP_HINT = "no value of a spec is: is a bracket too many open?"

SMALLEST = "{heun: 1, bodies: {ball: {mass: 1, center: [0, 0, 0], inertia: [0, 0, 0]}}}"

Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
Path_ = tuple[str | int, ...]
Mark = tuple[int, int]  # line, column, from 0

INTEGER = re.compile(r"[-+]?[0-9]+\Z")
FLOAT = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?\Z")
BASED = re.compile(r"0(?:x[0-9a-fA-F]+|o[0-7]+)\Z")
WORDS: dict[str, Any] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), None),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
    **{sign + word: float(sign + "inf") for sign in ("", "+", "-") for word in (".inf", ".Inf", ".INF")},
    **dict.fromkeys((".nan", ".NaN", ".NAN"), float("nan")),
}
UNSEEN = "[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]"
UNSEEN_BEYOND_ASCII = "[\x80-\x9f\u2028\u2029\ufeff\ufffe\uffff\ud800-\udfff]"
UNSEEN_NAMES = {
    "\x00": "NUL", "\x85": "NEXT LINE", "\u2028": "LINE SEPARATOR", "\u2029": "PARAGRAPH SEPARATOR",
    "\ufeff": "BYTE ORDER MARK",
}  # fmt: skip


@record
class SourceFile:
    """Content of a file: plain data, and for every path the location of its value and of its key."""

    file: str
    sha256: str
    data: Any
    values: dict[Path_, Mark]
    keys: dict[Path_, Mark]
    problems: tuple[Problem, ...] = ()

    def location(self, path: Path_, key: bool = False) -> SourceLocation:
        """Where a value, or its key, stands; for a value that is absent, where the nearest mapping around it stands."""
        known: Path_ = path
        while known and known not in self.values:
            known = known[:-1]
        use_key = key and known == path and known in self.keys
        line, column = (self.keys if use_key else self.values).get(known, (0, 0))
        return SourceLocation(self.file, line + 1, column + 1, dotted(path))


def dotted(path: Path_) -> str:
    """A path as users write it: bodies.crank.center.2"""
    return ".".join(map(str, path))


def read(path: str, text: str | None) -> SourceFile:
    """The content of a file ("-" is standard input), or of a text that stands for it. Raises SpecError."""
    file = "<stdin>" if path == STANDARD_INPUT else path
    if text is None:
        text = text_in(path)
    try:
        raw = text.encode()
    except UnicodeEncodeError as error:
        line, column = position(text, error.start)
        raise SpecError(
            Problem("not-utf8", "a character is not Unicode", SourceLocation(file, line, column), "delete it")
        ) from None
    return parse(file, text.removeprefix("\ufeff"), digest(raw))


def text_in(path: str) -> str:
    """The text of a file ("-" is standard input), a mark of its byte order included. Raises SpecError."""
    file = "<stdin>" if path == STANDARD_INPUT else path
    try:
        raw: bytes | bytearray = read_bytes(path, LARGEST)
    except Finding as finding:
        raise SpecError(Problem(finding.code, finding.message, SourceLocation(file, 1, 1), finding.hint)) from None
    try:
        return raw.decode()
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start)
        column = error.start - raw.rfind(b"\n", 0, error.start)
        hint = "save the file as UTF-8" + (" (it looks like UTF-16)" if raw[:2] in (b"\xff\xfe", b"\xfe\xff") else "")
        message = f"byte 0x{raw[error.start]:02x} is not UTF-8"
        raise SpecError(Problem("not-utf8", message, SourceLocation(file, line + 1, column), hint)) from None


def position(text: str, index: int) -> tuple[int, int]:
    """Line and column, from 1, of a character."""
    return text.count("\n", 0, index) + 1, index - text.rfind("\n", 0, index)


def parse(file: str, text: str, sha256: str) -> SourceFile:
    """The data in a text. Raises SpecError for what cannot be read on; what can be is in the source's problems."""
    if "\r" in text:  # an end of a line to YAML, alone too: so that all count the same lines
        text = text.replace("\r\n", "\n").replace("\r", "\n")
    if len(text) > LARGEST:
        message = f"{len(text)} characters; at most {LARGEST} are read"
        hint = "put lists of numbers into files of their own: tables: {NAME: {file: NAME.csv}}"
        raise SpecError(Problem("too-large", message, SourceLocation(file, 1, 1), hint))
    if unseen := re.search(UNSEEN if text.isascii() else f"{UNSEEN}|{UNSEEN_BEYOND_ASCII}", text):
        name = f"U+{ord(unseen[0]):04X}" + (f" ({UNSEEN_NAMES[unseen[0]]})" if unseen[0] in UNSEEN_NAMES else "")
        message = f"the character {name} may not stand in a spec"
        raise SpecError(
            Problem("bad-character", message, SourceLocation(file, *position(text, unseen.start())), "delete it")
        )
    builder = Builder(file)
    try:
        for event in event_stream(text):
            builder.take(event)
    except yaml.MarkedYAMLError as error:
        problems = not_yaml(file, text, error)
        first = min(p.location.line for p in problems if p.location)
        # in that line words are taken for keys that are none
        before = [p for p in builder.problems if p.location and p.location.line < first]
        raise SpecError(*before, *problems) from None
    if builder.documents == 0 or builder.root is None:
        hint = f"write the scene into it; the smallest is: {SMALLEST}"
        raise SpecError(*builder.problems, Problem("empty", "the file is empty", SourceLocation(file, 1, 1), hint))
    return SourceFile(file, sha256, builder.root, builder.values, builder.keys, tuple(builder.problems))


def event_stream(text: str) -> Iterator[Any]:
    """The parser's events, one by one."""
    loader = Loader(text)
    try:
        while True:
            event = loader.get_event()
            if type(event) is events.StreamEndEvent:
                return
            yield event
    finally:
        loader.dispose()


def not_yaml(file: str, text: str, error: yaml.MarkedYAMLError) -> list[Problem]:
    """What keeps a text from being YAML: brackets and quotes without their match, else what the parser says."""
    from heuncli.scene.file_format.brackets import mismatches  # only on the way to an error

    mark = error.problem_mark or error.context_mark
    line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
    # what is opened after the place where the parser stopped was not its reason
    stopped = sum(len(shown) + 1 for shown in text.split("\n")[: line - 1]) + column - 1
    if "nesting depth" in (error.problem or ""):  # a bound of the parser's own, met before its events come
        place = position(text, deep_bracket(text[:stopped]))
        return [Problem("too-deep", TOO_DEEP, SourceLocation(file, *place), TOO_DEEP_HINT)]
    if found := mismatches(text, stopped):
        at = [SourceLocation(file, *position(text, one.at)) for one in found]
        return [Problem("not-yaml", f"not YAML: {one.message}", at[k], one.hint) for k, one in enumerate(found)]
    what = error.problem or str(error)
    return [Problem("not-yaml", f"not YAML: {what}", SourceLocation(file, line, column), yaml_hint(text, line, what))]


def deep_bracket(text: str) -> int:
    """Where the bracket stands that is nested one level too deep."""
    depth = 0
    for index, letter in enumerate(text):
        depth += (letter in "[{") - (letter in "]}")
        if depth > DEEPEST:
            return index
    return len(text)


def yaml_hint(text: str, line: int, what: str) -> str:
    """What probably went wrong, for the usual accidents."""
    lines = text.split("\n")
    shown = lines[line - 1] if 0 < line <= len(lines) else ""
    if "\t" in shown[: len(shown) - len(shown.lstrip())] or "'\\t'" in what or "tab" in what:
        return "indent with spaces, not tabs"
    if "mapping values are not allowed" in what:
        return "write a text that contains ': ' in quotes, or look at the indentation"
    if "could not find expected ':'" in what:
        return "a key needs a colon and a space after it"
    if "cannot start any token" in what:
        return "a text that starts with % or @ or a backquote is written in quotes"
    if "unknown escape" in what:
        return "a backslash within double quotes is written twice, or the text stands in single quotes"
    if "did not find expected key" in what:
        return "look at the indentation: the keys of one mapping begin in one column"
    if "expected ',' or" in what:
        return "look for a comma that is missing before this place"
    if "expected node content" in what:
        return "look for a comma or a colon too many before this place"
    if "alphabetic or numeric" in what or "alias" in what or "anchor" in what:
        return "a text that starts with * or & is written in quotes"
    return "look at this line and the one before it: brackets, colons, quotes, indentation"


ALIAS = (
    "name the value once under parameters and use the name; a program writes the spec as JSON, which is read, too, "
    "or tells its YAML library to write no aliases (PyYAML: yaml.Dumper.ignore_aliases = lambda *_: True)"
)


class OpenContainer:
    """An open mapping or list; skipped: the value of a key that was refused."""

    def __init__(self, container: dict[str, Any] | list[Any], path: Path_) -> None:
        self.container, self.path = container, path
        self.key: str | None = None
        self.skipped = False


class Builder:
    """Builds data and locations from events; an error after which reading can go on is added to the problems."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.root: Any = None
        self.values: dict[Path_, Mark] = {}
        self.keys: dict[Path_, Mark] = {}
        self.problems: list[Problem] = []
        self.documents = 0
        self.stack: list[OpenContainer] = []

    def problem(self, code: str, message: str, event: Any, path: Path_ = (), *, hint: str) -> Problem:
        mark = event.start_mark
        return Problem(code, message, SourceLocation(self.file, mark.line + 1, mark.column + 1, dotted(path)), hint)

    def take(self, event: Any) -> None:
        """One event."""
        kind = type(event)
        if kind is events.ScalarEvent:
            self.scalar(event)
        elif kind is events.MappingStartEvent:
            self.open({}, event)
        elif kind is events.SequenceStartEvent:
            self.open([], event)
        elif kind is events.MappingEndEvent or kind is events.SequenceEndEvent:
            self.stack.pop()
        elif kind is events.AliasEvent:
            self.problems.append(self.problem("alias", f"aliases (*{event.anchor}) are not read", event, hint=ALIAS))
            top = self.stack[-1] if self.stack else None
            if top is not None and top.key is None and type(top.container) is dict:  # it stands for a key
                top.key, top.skipped = "", True
            else:
                self.put(None, event)
        elif kind is events.DocumentStartEvent:
            self.documents += 1
            if self.documents > 1:
                raise SpecError(*self.problems, self.several(event))

    def several(self, event: Any) -> Problem:
        """The error of a second document."""
        hint = "what stands behind the line --- belongs into a file of its own"
        return self.problem("several-documents", "a file holds one spec only", event, hint=hint)

    def check(self, event: Any) -> None:
        """No anchors, no tags."""
        if event.anchor is not None:
            self.problems.append(self.problem("alias", f"anchors (&{event.anchor}) are not read", event, hint=ALIAS))
        if event.tag is not None and event.tag != "!":
            tag = event.tag.replace("tag:yaml.org,2002:", "!!")
            hint = "values are plain numbers and texts; a value used often belongs into parameters"
            self.problems.append(self.problem("tag", f"tags ({tag}) are not read", event, hint=hint))

    def scalar(self, event: Any) -> None:
        if event.anchor is not None or event.tag is not None:
            self.check(event)
        top = self.stack[-1] if self.stack else None
        if top is not None and top.key is None and type(top.container) is dict:
            self.key(event, top)
        else:
            self.put(plain(event.value) if event.implicit[0] else event.value, event)

    def key(self, event: Any, top: OpenContainer) -> None:
        """A key of a mapping: a plain word, once."""
        key = event.value
        path = (*top.path, key)
        if key == "<<" and event.implicit[0]:
            hint = "write the keys out, with their common values under parameters"
            self.problems.append(self.problem("alias", "merge keys (<<) are not read", event, path, hint=hint))
            top.skipped = True
        elif key in top.container:
            line, _ = self.keys[path]
            message = f"'{key}' is given twice, first in line {line + 1}"
            hint = "give the two names of their own, or keep one"
            self.problems.append(self.problem("duplicate-key", message, event, path, hint=hint))
            top.skipped = True
        else:
            self.keys[path] = (event.start_mark.line, event.start_mark.column)
        top.key = key

    def open(self, container: dict[str, Any] | list[Any], event: Any) -> None:
        """The start of a mapping or list."""
        if event.anchor is not None or event.tag is not None:
            self.check(event)
        top = self.stack[-1] if self.stack else None
        if top is not None and top.key is None and type(top.container) is dict:
            hint = "an expression or a text that starts with { or [ is written in quotes"
            message = "not YAML as specs use it: a key is a plain word"
            problem = self.problem("not-yaml", message, event, top.path, hint=hint)
            raise SpecError(*self.problems, problem)
        path = self.put(container, event)
        self.stack.append(OpenContainer(container, path))
        if len(self.stack) > DEEPEST:
            problem = self.problem("too-deep", TOO_DEEP, event, hint=TOO_DEEP_HINT)
            raise SpecError(*self.problems, problem)

    def put(self, value: Any, event: Any) -> Path_:
        """Store a value where it belongs; gives its path."""
        path: Path_ = ()
        if not self.stack:
            self.root = value
        else:
            top = self.stack[-1]
            if type(top.container) is list:
                path = (*top.path, len(top.container))
                top.container.append(value)
            else:
                key, top.key = top.key or "", None
                path = (*top.path, key)
                if top.skipped:
                    top.skipped = False
                    return ("", *path)  # a skipped value must not overwrite the location of the first one
                top.container[key] = value  # type: ignore[call-overload]
        self.values[path] = (event.start_mark.line, event.start_mark.column)
        return path


def plain(word: str) -> Any:
    """The value of an unquoted scalar, by YAML 1.2."""
    if word in WORDS:
        return WORDS[word]
    if INTEGER.match(word):
        return int(word) if len(word) < 20 else float(word)
    if FLOAT.match(word):
        return float(word)
    if BASED.match(word):
        return int(word, 0)
    return word
