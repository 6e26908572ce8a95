"""The files that a spec names, of tables and of curves: on the disk, or as they were read before. Impure: reads files.

Their names are relative to the spec's folder. A process that has neither the spec nor these files beside it (a worker
of a cluster) is given them as they were read (`FilesAtHand`), errors included, and looks at no disk.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes

LARGEST = 200_000_000  # bytes: two million rows of a hundred characters
RELATIVE = "a path is relative to the spec's folder"


class FileNotKept(BaseException):
    """A file is asked for that is not among those that were read before; no Exception: it is no fault of a variant."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.name = name


class KeptFinding(NamedTuple):
    """A finding as it can be sent from process to process."""

    code: str
    message: str
    hint: str


class NamedFile(NamedTuple):
    """A file as it was read: its content, or why it has none; outside: what is said of where it stands."""

    content: bytes
    unread: KeptFinding | None = None
    outside: KeptFinding | None = None


class NamedFiles:
    """The files beside a spec, by the names that it gives them."""

    def __init__(self, spec: str) -> None:
        """spec: the path of the spec; those that standard input names are looked for in the working folder."""
        self.folder = Path() if spec == STANDARD_INPUT else Path(spec).parent

    def path(self, name: str) -> Path:
        """Where a file stands, as it is told."""
        return self.folder / name

    def content(self, name: str) -> bytes | bytearray:
        """The bytes of a file. Raises Finding: unreadable, too-large."""
        return read_bytes(str(self.path(name)), LARGEST)

    def outside(self, name: str) -> Finding | None:
        """What to say of a file that is not in the spec's folder or below it; links count by where they lead."""
        try:
            home, given = os.path.realpath(self.folder), os.path.abspath(self.path(name))  # noqa: PTH100  # Path's loop
            leads_to = os.path.realpath(given)
        except (OSError, ValueError):  # no working folder, no name of a file: told where it is read
            return None
        if Path(leads_to).is_relative_to(home):
            return None
        led = f", which is {leads_to}" if Path(given).is_relative_to(home) else ""
        hint = "copy it beside the spec: whoever runs that then knows what is read"
        return Finding("outside-folder", f"reads a file outside the spec's folder: {name}{led}", hint)

    def text(self, name: str) -> str:
        """The text of a file. Raises Finding."""
        try:
            return self.content(name).decode("utf-8-sig")
        except UnicodeDecodeError:
            reason, code, hint = "it is not UTF-8", "table-file", "save it as CSV in UTF-8"
        except Finding as refused:
            is_large = refused.code == "too-large"
            reason, code = refused.message, refused.code if is_large else "table-file"
            hint = "a table of fewer points, or of these two columns alone" if is_large else RELATIVE
        raise Finding(code, f"the file '{self.path(name)}' cannot be read: {reason}", hint)

    def kept(self, name: str) -> NamedFile:
        """A file as it is now."""
        outside = _kept_finding(self.outside(name))
        try:
            return NamedFile(bytes(self.content(name)), None, outside)
        except Finding as unread:
            return NamedFile(b"", _kept_finding(unread), outside)


class NotedFiles(NamedFiles):
    """Files on the disk; which of them are asked for is written down."""

    def __init__(self, spec: str) -> None:
        super().__init__(spec)
        self.names: dict[str, None] = {}

    def content(self, name: str) -> bytes | bytearray:
        """The bytes of a file."""
        self.names[name] = None
        return super().content(name)

    def outside(self, name: str) -> Finding | None:
        """What to say of where it stands."""
        self.names[name] = None
        return super().outside(name)


class FilesAtHand(NamedFiles):
    """Files as they were read before; asked for another one this raises FileNotKept."""

    def __init__(self, spec: str, files: Mapping[str, NamedFile]) -> None:
        super().__init__(spec)
        self.files = files

    def content(self, name: str) -> bytes:
        """The bytes of a file."""
        found = self.kept(name)
        if found.unread is not None:
            raise Finding(*found.unread)
        return found.content

    def outside(self, name: str) -> Finding | None:
        """What is said of where it stood."""
        found = self.kept(name).outside
        return Finding(*found) if found is not None else None

    def kept(self, name: str) -> NamedFile:
        """A file as it was then."""
        found = self.files.get(name)
        if found is None:
            raise FileNotKept(name)
        return found


def _kept_finding(finding: Finding | None) -> KeptFinding | None:
    return KeptFinding(finding.code, finding.message, finding.hint) if finding is not None else None
