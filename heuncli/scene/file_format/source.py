"""Read YAML text into plain data and record the location of every value. Strict; knows nothing of mechanics.

Scalars follow YAML 1.2 (`on` and `012` are texts, `1e-3` is a number). Refused: tags, anchors, aliases, merge keys,
duplicate keys, several documents, nesting deeper than 64, and invisible characters that would shift line numbers.
PyYAML's parser supplies the events; data and locations are built here without recursion.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

import yaml
from yaml import events

from heuncli.base.errors import Finding, Problem, SourceLocation, SpecError
from heuncli.base.records import record, replace
from heuncli.scene.file_format.labels import NO_LABELS, LabelSplitter, iter_moved_paths
from heuncli.scene.file_format.labels import Path_ as Path_
from heuncli.scene.file_format.reading import STANDARD_INPUT, digest, read_bytes

MAX_SIZE = 64_000_000  # bytes, and characters; a scene of 100,000 bodies has about 40 million
MAX_DEPTH = 64
TOO_DEEP = f"the spec is nested more than {MAX_DEPTH} levels deep"
TOO_DEEP_HINT = "no model needs such depth: look for a missing closing bracket"

SMALLEST_SPEC = "{heun: 1, bodies: {ball: {mass: 1, center: [0, 0, 0], inertia: [0, 0, 0]}}}"

Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
Mark = tuple[int, int]  # line, column, from 0

INTEGER = re.compile(r"[-+]?[0-9]+\Z")
FLOAT = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?\Z")
PREFIXED_INTEGER = re.compile(r"0(?:x[0-9a-fA-F]+|o[0-7]+)\Z")
WORD_VALUES: dict[str, Any] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), None),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
    **{sign + word: float(sign + "inf") for sign in ("", "+", "-") for word in (".inf", ".Inf", ".INF")},
    **dict.fromkeys((".nan", ".NaN", ".NAN"), float("nan")),
}
INVISIBLE = "[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]"
INVISIBLE_NON_ASCII = "[\x80-\x9f\u2028\u2029\ufeff\ufffe\uffff\ud800-\udfff]"
INVISIBLE_NAMES = {
    "\x00": "NUL", "\x85": "NEXT LINE", "\u2028": "LINE SEPARATOR", "\u2029": "PARAGRAPH SEPARATOR",
    "\ufeff": "BYTE ORDER MARK",
}  # fmt: skip


@record
class SourceFile:
    """Content of a file: plain data, and for every path the location of its value and of its key.

    labels: texts for readers by the paths of the results; they are not in the data
    """

    file: str
    sha256: str
    data: Any
    values: dict[Path_, Mark]
    keys: dict[Path_, Mark]
    problems: tuple[Problem, ...] = ()
    labels: Mapping[str, str] = NO_LABELS

    def location(self, path: Path_, prefer_key: bool = False) -> SourceLocation:
        """Return the location of a value, or of its key. For an absent value: the location of the nearest enclosing
        mapping.
        """
        nearest_path: Path_ = path
        while nearest_path and nearest_path not in self.values:
            nearest_path = nearest_path[:-1]
        use_key = prefer_key and nearest_path == path and nearest_path in self.keys
        line, column = (self.keys if use_key else self.values).get(nearest_path, (0, 0))
        return SourceLocation(self.file, line + 1, column + 1, format_path(path))


def format_path(path: Path_) -> str:
    """Format a path as users write it: bodies.crank.center.2"""
    return ".".join(map(str, path))


def read_source(path: str, text: str | None) -> SourceFile:
    """Read and parse a spec ("-" is standard input), or parse `text` in its place. Raises SpecError."""
    file = "<stdin>" if path == STANDARD_INPUT else path
    if text is None:
        text = read_text(path)
    try:
        raw = text.encode()
    except UnicodeEncodeError as error:
        line, column = line_and_column(text, error.start)
        raise SpecError(
            Problem("not-utf8", "a character is not Unicode", SourceLocation(file, line, column), "delete it")
        ) from None
    return split_labels(parse_source(file, text.removeprefix("\ufeff"), digest(raw)))


def split_labels(source: SourceFile) -> SourceFile:
    """Return a source whose data hold no labels; what is wrong with one is among its problems."""
    if type(source.data) is not dict:
        return source
    splitter = LabelSplitter()
    data = splitter.split(source.data)
    if data is source.data:
        return source
    problems = [
        Problem(finding.code, finding.message, source.location(path, is_key), finding.hint)
        for path, finding, is_key in splitter.errors
    ]
    values, keys = (
        dict(iter_moved_paths(paths, splitter.unwrapped)) if splitter.unwrapped else paths
        for paths in (source.values, source.keys)
    )
    return replace(
        source, data=data, values=values, keys=keys, problems=(*source.problems, *problems), labels=splitter.labels
    )


def read_text(path: str) -> str:
    """Read the text of a file ("-" is standard input), including a byte order mark. Raises SpecError."""
    file = "<stdin>" if path == STANDARD_INPUT else path
    try:
        raw: bytes | bytearray = read_bytes(path, MAX_SIZE)
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


def line_and_column(text: str, index: int) -> tuple[int, int]:
    """Return line and column, both from 1, of a character index."""
    return text.count("\n", 0, index) + 1, index - text.rfind("\n", 0, index)


def parse_source(file: str, text: str, sha256: str) -> SourceFile:
    """Parse a text. Raises SpecError where parsing cannot continue; other problems are recorded in the source."""
    if "\r" in text:  # YAML treats \r alone as a line end; normalise, so that line numbers agree everywhere
        text = text.replace("\r\n", "\n").replace("\r", "\n")
    if len(text) > MAX_SIZE:
        message = f"{len(text)} characters; at most {MAX_SIZE} are read"
        hint = "put lists of numbers into separate files: tables: {NAME: {file: NAME.csv}}"
        raise SpecError(Problem("too-large", message, SourceLocation(file, 1, 1), hint))
    if invisible := re.search(INVISIBLE if text.isascii() else f"{INVISIBLE}|{INVISIBLE_NON_ASCII}", text):
        name = f"U+{ord(invisible[0]):04X}" + (
            f" ({INVISIBLE_NAMES[invisible[0]]})" if invisible[0] in INVISIBLE_NAMES else ""
        )
        message = f"the character {name} is not allowed in a spec"
        raise SpecError(
            Problem(
                "bad-character", message, SourceLocation(file, *line_and_column(text, invisible.start())), "delete it"
            )
        )
    builder = SourceBuilder(file)
    try:
        for event in iter_events(text):
            builder.handle_event(event)
    except yaml.MarkedYAMLError as error:
        problems = find_syntax_problems(file, text, error)
        first = min(p.location.line for p in problems if p.location)
        # problems found after that line may come from misread keys
        earlier = [p for p in builder.problems if p.location and p.location.line < first]
        raise SpecError(*earlier, *problems) from None
    if builder.documents == 0 or builder.root is None:
        hint = f"write a model into it; the smallest is: {SMALLEST_SPEC}"
        raise SpecError(*builder.problems, Problem("empty", "the file is empty", SourceLocation(file, 1, 1), hint))
    return SourceFile(file, sha256, builder.root, builder.values, builder.keys, tuple(builder.problems))


def iter_events(text: str) -> Iterator[Any]:
    """Yield the parser's events."""
    loader = Loader(text)
    try:
        while True:
            event = loader.get_event()
            if type(event) is events.StreamEndEvent:
                return
            yield event
    finally:
        loader.dispose()


def find_syntax_problems(file: str, text: str, error: yaml.MarkedYAMLError) -> list[Problem]:
    """Explain why a text is not YAML: unmatched brackets and quotes, otherwise the parser's own message."""
    from heuncli.scene.file_format.brackets import find_mismatches  # only on the way to an error

    mark = error.problem_mark or error.context_mark
    line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
    # a bracket opened after the parser stopped cannot be the cause
    stop_index = sum(len(shown) + 1 for shown in text.split("\n")[: line - 1]) + column - 1
    if "nesting depth" in (error.problem or ""):  # the parser's own limit, reached before it yields events
        line_column = line_and_column(text, find_too_deep_bracket(text[:stop_index]))
        return [Problem("too-deep", TOO_DEEP, SourceLocation(file, *line_column), TOO_DEEP_HINT)]
    if unmatched := find_mismatches(text, stop_index):
        locations = [SourceLocation(file, *line_and_column(text, one.offset)) for one in unmatched]
        return [
            Problem("not-yaml", f"not YAML: {one.message}", locations[k], one.hint) for k, one in enumerate(unmatched)
        ]
    what = error.problem or str(error)
    return [
        Problem(
            "not-yaml", f"not YAML: {what}", SourceLocation(file, line, column), suggest_syntax_fix(text, line, what)
        )
    ]


def find_too_deep_bracket(text: str) -> int:
    """Return the index of the first bracket that is nested too deep, or the length of the text."""
    depth = 0
    for index, letter in enumerate(text):
        depth += (letter in "[{") - (letter in "]}")
        if depth > MAX_DEPTH:
            return index
    return len(text)


def suggest_syntax_fix(text: str, line: int, parser_message: str) -> str:
    """Return a hint for the usual syntax mistakes."""
    lines = text.split("\n")
    line_text = lines[line - 1] if 0 < line <= len(lines) else ""
    if (
        "\t" in line_text[: len(line_text) - len(line_text.lstrip())]
        or "'\\t'" in parser_message
        or "tab" in parser_message
    ):
        return "indent with spaces, not tabs"
    if "mapping values are not allowed" in parser_message:
        return "put a text that contains ': ' in quotes, or check the indentation"
    if "could not find expected ':'" in parser_message:
        return "a key needs a colon and a space after it"
    if "cannot start any token" in parser_message:
        return "put a text that starts with %, @ or a backquote in quotes"
    if "unknown escape" in parser_message:
        return "double the backslash within double quotes, or use single quotes"
    if "did not find expected key" in parser_message:
        return "check the indentation: the keys of one mapping begin in one column"
    if "expected ',' or" in parser_message:
        return "check for a missing comma before this place"
    if "expected node content" in parser_message:
        return "check for an extra comma or colon before this place"
    if "alphabetic or numeric" in parser_message or "alias" in parser_message or "anchor" in parser_message:
        return "put a text that starts with * or & in quotes"
    return "check this line and the one before it: brackets, colons, quotes, indentation"


ALIAS_HINT = (
    "define the value under parameters and refer to it by name; a program should write the spec as JSON, which "
    "heun reads, or tell its YAML library to write no aliases (PyYAML: yaml.Dumper.ignore_aliases = lambda *_: True)"
)


class OpenContainer:
    """A mapping or list that is still open.

    skipped: the next value belongs to a refused key and is not stored
    """

    def __init__(self, container: dict[str, Any] | list[Any], path: Path_) -> None:
        self.container, self.path = container, path
        self.key: str | None = None
        self.skipped = False


class SourceBuilder:
    """Build data and locations from parser events; errors after which parsing can continue are collected in
    `problems`.
    """

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
        return Problem(
            code, message, SourceLocation(self.file, mark.line + 1, mark.column + 1, format_path(path)), hint
        )

    def handle_event(self, event: Any) -> None:
        """Handle one parser event. Raises SpecError at a second document."""
        kind = type(event)
        if kind is events.ScalarEvent:
            self.add_scalar(event)
        elif kind is events.MappingStartEvent:
            self.open_container({}, event)
        elif kind is events.SequenceStartEvent:
            self.open_container([], event)
        elif kind is events.MappingEndEvent or kind is events.SequenceEndEvent:
            self.stack.pop()
        elif kind is events.AliasEvent:
            self.problems.append(
                self.problem("alias", f"aliases (*{event.anchor}) are not allowed", event, hint=ALIAS_HINT)
            )
            top = self.stack[-1] if self.stack else None
            if top is not None and top.key is None and type(top.container) is dict:  # the alias stands for a key
                top.key, top.skipped = "", True
            else:
                self.store(None, event)
        elif kind is events.DocumentStartEvent:
            self.documents += 1
            if self.documents > 1:
                raise SpecError(*self.problems, self.make_several_documents_problem(event))

    def make_several_documents_problem(self, event: Any) -> Problem:
        """Make the problem that reports a second document."""
        hint = "move what follows the line --- to a separate file"
        return self.problem("several-documents", "only one spec is allowed in a file", event, hint=hint)

    def refuse_anchor_and_tag(self, event: Any) -> None:
        """Report an anchor or a tag as a problem."""
        if event.anchor is not None:
            self.problems.append(
                self.problem("alias", f"anchors (&{event.anchor}) are not allowed", event, hint=ALIAS_HINT)
            )
        if event.tag is not None and event.tag != "!":
            tag = event.tag.replace("tag:yaml.org,2002:", "!!")
            hint = "values are plain numbers or text; define a value used often under parameters"
            self.problems.append(self.problem("tag", f"tags ({tag}) are not allowed", event, hint=hint))

    def add_scalar(self, event: Any) -> None:
        if event.anchor is not None or event.tag is not None:
            self.refuse_anchor_and_tag(event)
        top = self.stack[-1] if self.stack else None
        if top is not None and top.key is None and type(top.container) is dict:
            self.add_key(event, top)
        else:
            self.store(parse_plain_scalar(event.value) if event.implicit[0] else event.value, event)

    def add_key(self, event: Any, top: OpenContainer) -> None:
        """Begin a mapping entry; report merge keys and duplicate keys."""
        key = event.value
        path = (*top.path, key)
        if key == "<<" and event.implicit[0]:
            hint = "write the keys out, with their common values under parameters"
            self.problems.append(self.problem("alias", "merge keys (<<) are not allowed", event, path, hint=hint))
            top.skipped = True
        elif key in top.container:
            line, _ = self.keys[path]
            message = f"'{key}' is given twice, first in line {line + 1}"
            hint = "give the two different names, or keep one"
            self.problems.append(self.problem("duplicate-key", message, event, path, hint=hint))
            top.skipped = True
        else:
            self.keys[path] = (event.start_mark.line, event.start_mark.column)
        top.key = key

    def open_container(self, container: dict[str, Any] | list[Any], event: Any) -> None:
        """Store a new mapping or list and push it on the stack. Raises SpecError if it stands for a key or is nested
        too deep.
        """
        if event.anchor is not None or event.tag is not None:
            self.refuse_anchor_and_tag(event)
        top = self.stack[-1] if self.stack else None
        if top is not None and top.key is None and type(top.container) is dict:
            hint = "put an expression or a text that starts with { or [ in quotes"
            message = "not a valid key: a key must be a plain word"
            problem = self.problem("not-yaml", message, event, top.path, hint=hint)
            raise SpecError(*self.problems, problem)
        path = self.store(container, event)
        self.stack.append(OpenContainer(container, path))
        if len(self.stack) > MAX_DEPTH:
            problem = self.problem("too-deep", TOO_DEEP, event, hint=TOO_DEEP_HINT)
            raise SpecError(*self.problems, problem)

    def store(self, value: Any, event: Any) -> Path_:
        """Store a value in the innermost open container and return its path."""
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


def parse_plain_scalar(word: str) -> Any:
    """Return the value of an unquoted scalar by the rules of YAML 1.2."""
    if word in WORD_VALUES:
        return WORD_VALUES[word]
    if INTEGER.match(word):
        return int(word) if len(word) < 20 else float(word)
    if FLOAT.match(word):
        return float(word)
    if PREFIXED_INTEGER.match(word):
        return int(word, 0)
    return word
