"""Read plain data into a Document: each entry is validated by its model, each violation is reported with its path."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from heuncli.base.spelling import match_misspelt_keys
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_shapes as fs
from heuncli.scene.file_format.entries import Entry, fields_of, keys_of, validate_entry
from heuncli.scene.file_format.fields import ReadContext
from heuncli.scene.file_format.foreign_words import FORM_HINTS
from heuncli.scene.file_format.pydantic_errors import (
    missing_type_errors,
    require_validation_error,
    translate_errors,
    unknown_key_error,
)
from heuncli.scene.file_format.quantity import describe_kind
from heuncli.scene.file_format.rules.registry import Path_, Violation

Report = Callable[[str, Violation], None]


class DocumentReader:
    """Reads the blocks of one spec; reports what is wrong in an entry and continues with the next."""

    def __init__(self, data: dict[str, Any], context: ReadContext, report: Report) -> None:
        self.data, self.context, self.report = data, context, report
        self.partial: dict[Path_, frozenset[str]] = {}  # partly read entries -> keys read

    def read_document(self) -> f.Document:
        """Read every block that can be read."""
        blocks = {block: self.read_entries(block, models) for block, models in f.ENTRY_BLOCKS.items()}
        single = {key: self.read_single(key, model) for key, model in f.SINGLE_BLOCKS.items()}
        return f.Document(head=self.read_head(), expect=self.read_expectations(), **blocks, **single)  # type: ignore[arg-type]

    def read_model(self, path: Path_, data: Any, model: type[Entry]) -> Any:
        """Validate data against one model and report its violations.

        If keys are wrong, the remaining keys are read. Returns None if they are not sufficient.
        """
        try:
            return validate_entry(model, data, self.context)
        except ValueError as refusal:
            error = require_validation_error(refusal)
            for code, violation in translate_errors(error, data, model):
                self.report(code, violation._replace(path=(*path, *violation.path)))
            return self.read_remainder(path, data, model, {str(e["loc"][0]) for e in error.errors() if e["loc"]})

    def read_remainder(self, path: Path_, data: Any, model: type[Entry], wrong: set[str]) -> Any:
        """Read a model without its wrong keys, so that its other values are checked too. Returns None if it needs these
        keys.
        """
        if not wrong or type(data) is not dict:
            return None
        right = {key: value for key, value in data.items() if key not in wrong}
        try:
            entry = validate_entry(model, {**match_misspelt_keys(data, keys_of(model)), **right}, self.context)
        except ValueError:
            return None
        self.partial[path] = frozenset(right)
        return entry

    def is_consequence(self, path: Path_) -> bool:
        """Whether a violation at this path may only be a consequence of keys that were left out as wrong."""
        for depth in range(1, len(path) + 1):
            read_keys = self.partial.get(path[:depth])
            if read_keys is not None and (depth == len(path) or path[depth] not in read_keys):
                return True
        return False

    def read_typed(self, path: Path_, data: Any, models: Mapping[str, type[Entry]], block: str) -> Any:
        """Read the model that the key `type` selects. Returns None after reporting an unknown type."""
        tag = data.get("type") if type(data) is dict else None
        model = models.get(tag) if type(tag) is str else None
        if model is not None:
            return self.read_model(path, data, model)
        for code, violation in missing_type_errors(data, models, block, self.context):
            self.report(code, violation._replace(path=(*path, *violation.path)))
        return None

    def read_head(self) -> f.HeadEntry:
        """Read the keys at the top level that are not blocks."""
        blocks = {*f.ENTRY_BLOCKS, *f.SINGLE_BLOCKS, *f.BLOCKS_READ_FIRST, "expect"}
        head_data = {key: value for key, value in self.data.items() if key not in blocks}
        known = [*fields_of(f.HeadEntry), *f.SINGLE_BLOCKS, *f.BLOCKS_READ_FIRST, *f.ENTRY_BLOCKS, "expect"]
        for key in [key for key in head_data if key not in fields_of(f.HeadEntry)]:
            del head_data[key]
            self.report(*unknown_key_error((key,), known))
        return self.read_model((), head_data, f.HeadEntry) or f.HeadEntry.model_construct(heun=1)

    def read_single(self, key: str, model: type[Entry]) -> Any:
        """Read a block that is one entry; its defaults if it is absent or wrong."""
        data = self.data.get(key, {})
        return (self.read_model((key,), data, model) if data != {} else None) or model.model_construct()

    def read_entries(self, block: str, models: type[Entry] | Mapping[str, type[Entry]]) -> dict[str, Any]:
        """Read a block of named entries; wrong entries are left out."""
        entries = self.data.get(block, {})
        if type(entries) is not dict:
            hint = f"write each under its name: {block}: {{NAME: {{...}}}}"
            self.report("wrong-kind", Violation((block,), f"expected a mapping, found {describe_kind(entries)}", hint))
            return {}
        read_by_name = {name: self.read_entry(block, name, data, models) for name, data in entries.items()}
        return {name: entry for name, entry in read_by_name.items() if entry is not None}

    def read_entry(self, block: str, name: str, data: Any, models: type[Entry] | Mapping[str, type[Entry]]) -> Any:
        """Read one entry of a block. Returns None if it is wrong."""
        path = (block, name)
        entry = (
            self.read_typed(path, data, models, block)
            if isinstance(models, Mapping)
            else self.read_model(path, data, models)
        )
        if entry is not None and getattr(entry, "shapes", None) is not None:
            entry = self.read_shapes(path, entry)
        return entry

    def read_shapes(self, path: Path_, body: f.BodyEntry) -> f.BodyEntry | None:
        """Return the body with its shapes read. Returns None if a shape is wrong."""
        shapes = [
            self.read_typed((*path, "shapes", i), shape, fs.SHAPES, "shapes")
            for i, shape in enumerate(body.shapes or [])
        ]
        return None if None in shapes else body.model_copy(update={"shapes": shapes})

    def read_expectations(self) -> dict[int, f.ExpectEntry]:
        """Read the list of expectations, keyed by their index in it."""
        items = self.data.get("expect", [])
        if type(items) is not list:
            message = f"expected a list, found {describe_kind(items)}"
            self.report("wrong-kind", Violation(("expect",), message, FORM_HINTS["expect"]))
            return {}
        read_by_index = {i: self.read_model(("expect", i), item, f.ExpectEntry) for i, item in enumerate(items)}
        return {i: item for i, item in read_by_index.items() if item is not None}
