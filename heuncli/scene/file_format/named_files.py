"""The files that a spec names, for tables, curves and meshes: from the disk, or as read before. Impure: reads files.

Names are relative to the spec's folder. A process that has neither the spec nor these files on disk (a worker of a
cluster) receives them with their content and errors (`PreloadedFiles`) and accesses no disk.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from heuncli.base.errors import Finding
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.reading import STANDARD_INPUT, read_bytes

MAX_FILE_SIZE = 200_000_000  # bytes: two million rows of a hundred characters
RELATIVE_PATH_HINT = "a path is relative to the spec's folder"


class FileNotPreloaded(BaseException):
    """A requested file is not among the preloaded ones; not an Exception, because it is not an error of a variant."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.name = name


class PortableFinding(NamedTuple):
    """A finding in a form that can be sent between processes."""

    code: str
    message: str
    hint: str


class NamedFile(NamedTuple):
    """A file as read.

    content: its bytes
    read_error: why it could not be read, or None
    outside_warning: the warning about its place, or None
    """

    content: bytes
    read_error: PortableFinding | None = None
    outside_warning: PortableFinding | None = None


class NamedFiles:
    """The files next to a spec, by the names that it gives them."""

    def __init__(self, spec: str) -> None:
        """spec: path of the spec; files named by standard input are looked up in the working folder"""
        self.folder = Path() if spec == STANDARD_INPUT else Path(spec).parent

    def path(self, name: str) -> Path:
        """Return the path of a file for messages."""
        return self.folder / name

    def read_content(self, name: str) -> bytes | bytearray:
        """Read the bytes of a file. Raises Finding [unreadable] or [too-large]."""
        return read_bytes(str(self.path(name)), MAX_FILE_SIZE)

    def find_outside_warning(self, name: str) -> Finding | None:
        """Return a warning if a file is not in the spec's folder or below it; links are followed."""
        try:
            real_folder, absolute_path = os.path.realpath(self.folder), os.path.abspath(self.path(name))  # noqa: PTH100  # Path's loop
            real_path = os.path.realpath(absolute_path)
        except (OSError, ValueError):  # no working folder, or an invalid name: reported when the file is read
            return None
        if Path(real_path).is_relative_to(real_folder):
            return None
        link_note = f", which is {real_path}" if Path(absolute_path).is_relative_to(real_folder) else ""
        hint = "copy it to the spec's folder, so that others can run the spec and see what it reads"
        return Finding("outside-folder", f"reads a file outside the spec's folder: {name}{link_note}", hint)

    def read_text(self, name: str, sheet: str | None = None) -> str:
        """Read the text of a data file; sheet: of an Excel file. Raises Finding."""
        try:
            content = self.read_content(name)
        except Finding as refused:
            is_large = refused.code == "too-large"
            reason, code = refused.message, refused.code if is_large else "table-file"
            hint = "use a table of fewer points, or with these two columns only" if is_large else RELATIVE_PATH_HINT
            raise Finding(code, f"the file '{self.path(name)}' cannot be read: {reason}", hint) from None
        from heuncli.scene.file_format.column_layout import decode_text  # with csv 2 ms that meshes do not need
        from heuncli.scene.file_format.data_files import convert_binary, convert_text

        try:
            text = convert_binary(content, sheet)
            return convert_text(decode_text(content), name) if text is None else text
        except Finding as refused:
            message = f"the file '{self.path(name)}' cannot be read: {refused.message}"
            raise Finding(refused.code, message, refused.hint) from None

    def get_file(self, name: str) -> NamedFile:
        """Return a file as it is now."""
        outside = _to_portable_finding(self.find_outside_warning(name))
        try:
            return NamedFile(bytes(self.read_content(name)), None, outside)
        except Finding as error:
            return NamedFile(b"", _to_portable_finding(error), outside)


class TrackedFiles(NamedFiles):
    """Files on the disk; records the names of those that are requested."""

    def __init__(self, spec: str) -> None:
        super().__init__(spec)
        self.names: dict[str, None] = {}

    def read_content(self, name: str) -> bytes | bytearray:
        """Read the bytes of a file and record its name."""
        self.names[name] = None
        return super().read_content(name)

    def find_outside_warning(self, name: str) -> Finding | None:
        """Return the warning about a file's place and record its name."""
        self.names[name] = None
        return super().find_outside_warning(name)


class PreloadedFiles(NamedFiles):
    """Files as read before; a request for another file raises FileNotPreloaded."""

    def __init__(self, spec: str, files: Mapping[str, NamedFile]) -> None:
        super().__init__(spec)
        self.files = files

    def read_content(self, name: str) -> bytes:
        """Return the bytes of a file. Raises Finding if it could not be read."""
        file = self.get_file(name)
        if file.read_error is not None:
            raise Finding(*file.read_error)
        return file.content

    def find_outside_warning(self, name: str) -> Finding | None:
        """Return the warning about the file's place when it was read."""
        warning = self.get_file(name).outside_warning
        return Finding(*warning) if warning is not None else None

    def get_file(self, name: str) -> NamedFile:
        """Return a file as it was read. Raises FileNotPreloaded."""
        file = self.files.get(name)
        if file is None:
            raise FileNotPreloaded(name)
        return file


def _to_portable_finding(finding: Finding | None) -> PortableFinding | None:
    return PortableFinding(finding.code, finding.message, finding.hint) if finding is not None else None
