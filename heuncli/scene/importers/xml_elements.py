"""XML text -> its elements with their places; nothing of it is looked up elsewhere, nothing grows.

By the standard library's expat. Refused: a DOCTYPE, and with it every entity but the five of XML itself; what is larger
than the limits below. So neither does a line of text become gigabytes, nor is another file read.
"""

from __future__ import annotations

from typing import Any
from xml.parsers import expat

from heuncli.base.errors import Problem, SourceLocation, SpecError
from heuncli.base.records import record

LARGEST = 64_000_000  # bytes, as of a spec
MOST_ELEMENTS = 1_000_000  # 100,000 links and their joints
DEEPEST = 5000  # levels: URDF has six, a chain of bodies in MJCF one each
LONGEST_VALUE = 100_000  # characters of an attribute: the points of a mesh in MJCF
OF_ENCODING = frozenset({expat.errors.codes[expat.errors.XML_ERROR_UNKNOWN_ENCODING]})
ENCODED = "encodings are UTF-8, and UTF-16, ISO-8859-1, US-ASCII where the first line says so: save it as UTF-8"
POINTER = b"version https://git-lfs"
BROKEN = "the file is cut off, or was edited by hand near this place"
XACRO = "macros are expanded first: xacro robot.urdf.xacro > robot.urdf"
BEGINS = "a URDF begins with <robot name=...>, a model of MuJoCo's with <mujoco>"
DOCTYPE = "delete the DOCTYPE and write out what its entities stand for"


@record
class XmlElement:
    """An element: its tag as written, attributes, elements in it, and the place of its start (line, column from 1)."""

    tag: str
    attributes: dict[str, str]
    inner: list[XmlElement]
    line: int
    column: int

    def all(self, tag: str) -> list[XmlElement]:
        """The elements in it that have this tag."""
        return [element for element in self.inner if element.tag == tag]


def read_elements(content: bytes, file: str) -> XmlElement:
    """The root of the elements in a text. Raises SpecError."""
    return _Reading(file).root_of(content)


def _is_utf8(content: bytes) -> bool:
    try:
        content.decode()
    except UnicodeDecodeError:
        return False
    return True


class _Reading:
    """One text on its way."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.root: XmlElement | None = None
        self.open: list[XmlElement] = []
        self.count = 0
        self.parser = parser = expat.ParserCreate()
        parser.buffer_text = True
        parser.StartElementHandler = self.start
        parser.EndElementHandler = self.end
        parser.StartDoctypeDeclHandler = self.doctype

    def root_of(self, content: bytes) -> XmlElement:
        if not content.strip():
            raise self.refused("not-xml", "the file is empty", BEGINS, at=(1, 1))
        try:
            self.parser.Parse(content, True)
        except expat.ExpatError as error:
            what = expat.errors.messages.get(error.code, "not well-formed")
            hint = ENCODED if error.code in OF_ENCODING or not _is_utf8(content) else BROKEN
            if b"<" not in content[: error.offset + 1]:
                hint = BEGINS
            if content.startswith(POINTER):
                hint = "it is a pointer of Git LFS: git lfs pull fetches the file"
            raise self.refused("not-xml", f"not XML: {what}", hint, at=(error.lineno, error.offset + 1)) from None
        except (LookupError, UnicodeError, ValueError) as error:
            if isinstance(error, SpecError):
                raise
            raise self.refused("not-xml", f"not XML: {error}", ENCODED, at=(1, 1)) from None
        assert self.root is not None  # expat refuses a text without an element
        return self.root

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self.count += 1
        if self.count > MOST_ELEMENTS:
            message = f"more than {MOST_ELEMENTS:,} elements; no more are read"
            raise self.refused("too-large", message, "split what is generated")
        if len(self.open) >= DEEPEST:
            raise self.refused("too-deep", f"nested more than {DEEPEST} levels deep", "is an element left open?")
        for name, value in attributes.items():
            if len(value) > LONGEST_VALUE or len(name) > LONGEST_VALUE:
                message = f"an attribute of {len(value):,} characters; at most {LONGEST_VALUE:,} are read"
                raise self.refused("too-large", message, "is it the right file?")
        element = XmlElement(tag, attributes, [], self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber + 1)
        if self.open:
            self.open[-1].inner.append(element)
        else:
            self.root = element
        self.open.append(element)

    def end(self, _tag: str) -> None:
        self.open.pop()

    def doctype(self, *_given: Any) -> None:
        raise self.refused("xml-entities", "a DOCTYPE, which may define entities, is not read", DOCTYPE)

    def refused(self, code: str, message: str, hint: str, at: tuple[int, int] | None = None) -> SpecError:
        line, column = at or (self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber + 1)
        return SpecError(Problem(code, message, SourceLocation(self.file, line, column), hint))
