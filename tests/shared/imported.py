"""Models as `heun import` says them: the text of the spec, without the command around it."""

from __future__ import annotations

from typing import Any

from heuncli.scene.importers.asked import ImportAsked
from heuncli.scene.importers.described import DescribedMachine
from heuncli.scene.importers.readers import reader_of
from heuncli.scene.importers.spec_text import spec_text
from heuncli.scene.importers.xml_elements import read_elements


def described(text: str | bytes, file: str = "model.xml", **asked: Any) -> DescribedMachine:
    """The machine of a model; file: where it stands, and what it names."""
    content = text.encode() if isinstance(text, str) else text
    root = read_elements(content, file)
    return reader_of(root, file).described(content, file, root, ImportAsked(**asked), "0" * 64)


def imported(text: str | bytes, **asked: Any) -> str:
    """The spec of a model."""
    return spec_text(described(text, **asked), "model.yaml")
