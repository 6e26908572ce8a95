"""Plain data -> Document: every entry read by its model, every violation reported with its path."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from pydantic_core import ValidationError

from heuncli.base.nearest import misspelt
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_shapes as fs
from heuncli.scene.file_format.entries import Entry, fields_of, keys_of
from heuncli.scene.file_format.fields import Context
from heuncli.scene.file_format.judging import judged
from heuncli.scene.file_format.quantity import kind_of
from heuncli.scene.file_format.rules.registry import Path_, Violation
from heuncli.scene.file_format.verdicts import unknown_key, unknown_type, verdicts
from heuncli.scene.file_format.words import FORMS

Report = Callable[[str, Violation], None]


class Reader:
    """Reads the blocks of one spec; reports what is wrong in an entry and goes on with the next."""

    def __init__(self, data: dict[str, Any], context: Context, report: Report) -> None:
        self.data, self.context, self.report = data, context, report
        self.partial: dict[Path_, frozenset[str]] = {}  # entries read without some keys in error, with those left

    def document(self) -> f.Document:
        """All that can be read."""
        blocks = {block: self.entries(block, models) for block, models in f.ENTRIES.items()}
        single = {key: self.single(key, model) for key, model in f.SINGLE.items()}
        return f.Document(head=self.head(), expect=self.expectations(), **blocks, **single)  # type: ignore[arg-type]

    def model(self, path: Path_, data: Any, model: type[Entry]) -> Any:
        """One model; what is wrong in it is reported and the rest read; None where the rest is not enough."""
        try:
            return judged(model, data, self.context)
        except ValidationError as error:
            for code, violation in verdicts(error, data, model):
                self.report(code, violation._replace(path=(*path, *violation.path)))
            return self.rest(path, data, model, {str(e["loc"][0]) for e in error.errors() if e["loc"]})

    def rest(self, path: Path_, data: Any, model: type[Entry], wrong: set[str]) -> Any:
        """The model without the keys in error, so that its other values are checked, too; None where it needs these."""
        if not wrong or type(data) is not dict:
            return None
        right = {key: value for key, value in data.items() if key not in wrong}
        try:
            entry = judged(model, {**misspelt(data, keys_of(model)), **right}, self.context)
        except ValidationError:
            return None
        self.partial[path] = frozenset(right)
        return entry

    def follows(self, path: Path_) -> bool:
        """Whether a violation at this path may be a mere consequence of keys that were left out as wrong."""
        for depth in range(1, len(path) + 1):
            kept = self.partial.get(path[:depth])
            if kept is not None and (depth == len(path) or path[depth] not in kept):
                return True
        return False

    def typed(self, path: Path_, data: Any, models: Mapping[str, type[Entry]], block: str) -> Any:
        """One model of those that the key `type` chooses from."""
        tag = data.get("type") if type(data) is dict else None
        model = models.get(tag) if type(tag) is str else None
        if model is not None:
            return self.model(path, data, model)
        code, violation = unknown_type(data, block, list(models))
        self.report(code, violation._replace(path=(*path, *violation.path)))
        return None

    def head(self) -> f.HeadEntry:
        """The keys that are no blocks."""
        blocks = {*f.ENTRIES, *f.SINGLE, *f.READ_BEFORE, "expect"}
        own = {key: value for key, value in self.data.items() if key not in blocks}
        known = [*fields_of(f.HeadEntry), *f.SINGLE, *f.READ_BEFORE, *f.ENTRIES, "expect"]
        for key in [key for key in own if key not in fields_of(f.HeadEntry)]:
            del own[key]
            self.report(*unknown_key((key,), known))
        return self.model((), own, f.HeadEntry) or f.HeadEntry.model_construct(heun=1)

    def single(self, key: str, model: type[Entry]) -> Any:
        """A block that is one entry; its defaults where it is left out or in error."""
        data = self.data.get(key, {})
        return (self.model((key,), data, model) if data != {} else None) or model.model_construct()

    def entries(self, block: str, models: type[Entry] | Mapping[str, type[Entry]]) -> dict[str, Any]:
        """A block of named entries."""
        entries = self.data.get(block, {})
        if type(entries) is not dict:
            hint = f"each under a name of its own: {block}: {{NAME: {{...}}}}"
            self.report("wrong-kind", Violation((block,), f"expected a mapping, found {kind_of(entries)}", hint))
            return {}
        read = {name: self.entry(block, name, data, models) for name, data in entries.items()}
        return {name: entry for name, entry in read.items() if entry is not None}

    def entry(self, block: str, name: str, data: Any, models: type[Entry] | Mapping[str, type[Entry]]) -> Any:
        """An entry of a block; None where it is in error."""
        path = (block, name)
        entry = self.typed(path, data, models, block) if isinstance(models, Mapping) else self.model(path, data, models)
        if entry is not None and getattr(entry, "shapes", None) is not None:
            entry = self.with_shapes(path, entry)
        return entry

    def with_shapes(self, path: Path_, body: f.BodyEntry) -> f.BodyEntry | None:
        """A body with its shapes read; None where one is in error."""
        shapes = [
            self.typed((*path, "shapes", i), shape, fs.SHAPES, "shapes") for i, shape in enumerate(body.shapes or [])
        ]
        return None if None in shapes else body.model_copy(update={"shapes": shapes})

    def expectations(self) -> dict[int, f.ExpectEntry]:
        """The list of expectations, by their indices in it."""
        items = self.data.get("expect", [])
        if type(items) is not list:
            message = f"expected a list, found {kind_of(items)}"
            self.report("wrong-kind", Violation(("expect",), message, FORMS["expect"]))
            return {}
        read = {i: self.model(("expect", i), item, f.ExpectEntry) for i, item in enumerate(items)}
        return {i: item for i, item in read.items() if item is not None}
