"""Parse XML text into elements with their locations. Nothing is looked up elsewhere, and nothing expands.

It uses the standard library's expat. It refuses a DOCTYPE, and with it every entity except the five of XML itself, and
anything larger than the limits below. So one line of text cannot become gigabytes, and no other file is read.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import PurePath
from typing import Any
from xml.parsers import expat

from heuncli.base.errors import Problem, SourceLocation, SpecError
from heuncli.base.records import record

MAX_SIZE = 64_000_000  # bytes, as of a spec
MAX_ELEMENTS = 1_000_000  # 100,000 links and their joints
MAX_DEPTH = 5000  # levels: URDF has six, a chain of bodies in MJCF one each
MAX_ATTRIBUTE_LENGTH = 100_000  # characters of an attribute: the points of a mesh in MJCF
ENCODING_ERRORS = frozenset({expat.errors.codes[expat.errors.XML_ERROR_UNKNOWN_ENCODING]})
ENCODING_HINT = "save it as UTF-8; UTF-16, ISO-8859-1 and US-ASCII are accepted if the first line declares them"
MISPLACED_DECLARATION = frozenset({expat.errors.codes[expat.errors.XML_ERROR_MISPLACED_XML_PI]})
DECLARATION_HINT = "delete all text before <?xml ...?>, blank lines too, or the declaration itself"
LFS_POINTER = b"version https://git-lfs"
BROKEN_HINT = "the file is truncated, or was damaged by hand editing near this place"
XACRO_HINT = "expand the macros first: xacro robot.urdf.xacro > robot.urdf"
ROOT_HINT = "a URDF file begins with <robot name=...>, an SDF file with <sdf version=...>, a MuJoCo model with <mujoco>"
TEXT_ROOTS = frozenset({"sdf", "robot"})  # formats that write values, or extensions of them, as text of elements
DOCTYPE_HINT = "delete the DOCTYPE and replace its entities by their text"


@record
class XmlElement:
    """An element: its tag, attributes and child elements, and where it starts (line and column, from 1).

    texts: the pieces of text in it; kept below a root of TEXT_ROOTS only, for other formats write values as attributes
    """

    tag: str
    attributes: dict[str, str]
    children: list[XmlElement]
    line: int
    column: int
    texts: Sequence[str] = ()

    @property
    def text(self) -> str:
        """The text in the element, without outer spaces."""
        return "".join(self.texts).strip()

    def iter_all(self) -> Iterator[XmlElement]:
        """Yield the element and all elements in it, in the order of the file."""
        waiting = [self]
        while waiting:
            element = waiting.pop()
            yield element
            waiting += reversed(element.children)

    def find_all(self, tag: str) -> list[XmlElement]:
        """Return the child elements with this tag."""
        return [element for element in self.children if element.tag == tag]


def make_xacro_hint(file: str) -> str:
    """Return the command that expands the macros of a file."""
    if file == "-":
        return XACRO_HINT
    import shlex  # only such a file needs it

    path = PurePath(file)
    name = path.name.removesuffix(".xacro").removesuffix(".urdf") or "robot"
    target = path.with_name(f"{name}.urdf" if path.name.endswith(".xacro") else f"{name}_expanded.urdf")
    return f"expand the macros first: xacro {shlex.quote(file)} > {shlex.quote(str(target))}"


def parse_xml(content: bytes, file: str) -> XmlElement:
    """Parse a text and return its root element. Raises SpecError."""
    return _XmlParser(file).parse(content)


def _is_utf8(content: bytes) -> bool:
    try:
        content.decode()
    except UnicodeDecodeError:
        return False
    return True


class _XmlParser:
    """Parses one text, with handlers for expat."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.root: XmlElement | None = None
        self.open_elements: list[XmlElement] = []
        self.count = 0
        self.parser = parser = expat.ParserCreate()
        parser.buffer_text = True
        parser.StartElementHandler = self.start_element
        parser.EndElementHandler = self.end_element
        parser.StartDoctypeDeclHandler = self.refuse_doctype

    def parse(self, content: bytes) -> XmlElement:
        if not content.strip():
            raise self.make_error("not-xml", "the file is empty", ROOT_HINT, position=(1, 1))
        try:
            self.parser.Parse(content, True)
        except expat.ExpatError as error:
            reason = expat.errors.messages.get(error.code, "not well-formed")
            hint = ENCODING_HINT if error.code in ENCODING_ERRORS or not _is_utf8(content) else BROKEN_HINT
            if error.code in MISPLACED_DECLARATION:
                reason, hint = "the declaration <?xml ...?> is not at the very beginning", DECLARATION_HINT
            elif b"<" not in content[: error.offset + 1]:
                hint = ROOT_HINT
            if content.startswith(LFS_POINTER):
                hint = "this is a Git LFS pointer: fetch the file with git lfs pull"
            raise self.make_error(
                "not-xml", f"not XML: {reason}", hint, position=(error.lineno, error.offset + 1)
            ) from None
        except (LookupError, UnicodeError, ValueError) as error:
            if isinstance(error, SpecError):
                raise
            raise self.make_error("not-xml", f"not XML: {error}", ENCODING_HINT, position=(1, 1)) from None
        assert self.root is not None  # expat refuses a text without an element
        return self.root

    def start_element(self, tag: str, attributes: dict[str, str]) -> None:
        self.count += 1
        if self.count > MAX_ELEMENTS:
            message = f"more than {MAX_ELEMENTS:,} elements, the limit"
            raise self.make_error("too-large", message, "split the file")
        if len(self.open_elements) >= MAX_DEPTH:
            raise self.make_error(
                "too-deep",
                f"the file is nested more than {MAX_DEPTH} levels deep",
                "look for an element that is not closed",
            )
        for name, value in attributes.items():
            if len(value) > MAX_ATTRIBUTE_LENGTH or len(name) > MAX_ATTRIBUTE_LENGTH:
                message = f"an attribute of {len(value):,} characters; at most {MAX_ATTRIBUTE_LENGTH:,} are allowed"
                raise self.make_error("too-large", message, "is it the right file?")
        if self.root is None and tag in TEXT_ROOTS:
            self.parser.CharacterDataHandler = self.add_text
        texts: list[str] | tuple[str, ...] = () if self.parser.CharacterDataHandler is None else []
        place = self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber + 1
        element = XmlElement(tag, attributes, [], *place, texts)
        if self.open_elements:
            self.open_elements[-1].children.append(element)
        else:
            self.root = element
        self.open_elements.append(element)

    def add_text(self, text: str) -> None:
        if self.open_elements and text.strip():
            self.open_elements[-1].texts.append(text)  # type: ignore[attr-defined]

    def end_element(self, _tag: str) -> None:
        self.open_elements.pop()

    def refuse_doctype(self, *_given: Any) -> None:
        raise self.make_error("xml-entities", "a DOCTYPE is not allowed, because it may define entities", DOCTYPE_HINT)

    def make_error(self, code: str, message: str, hint: str, position: tuple[int, int] | None = None) -> SpecError:
        line, column = position or (self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber + 1)
        return SpecError(Problem(code, message, SourceLocation(self.file, line, column), hint))
