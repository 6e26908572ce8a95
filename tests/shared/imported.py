"""Models as `heun import` says them: the text of the spec, without the command around it."""

from __future__ import annotations

from typing import Any

from heuncli.scene.importers.description import DescribedMachine, ImportOptions
from heuncli.scene.importers.readers import find_reader
from heuncli.scene.importers.spec_text import format_spec
from heuncli.scene.importers.xml_elements import parse_xml


def described(text: str | bytes, file: str = "model.xml", **asked: Any) -> DescribedMachine:
    """The machine of a model; file: where it stands, and what it names."""
    content = text.encode() if isinstance(text, str) else text
    root = parse_xml(content, file)
    return find_reader(root, file).read_machine(content, file, root, ImportOptions(**asked), "0" * 64)


def imported(text: str | bytes, **asked: Any) -> str:
    """The spec of a model."""
    return format_spec(described(text, **asked), "model.yaml")
