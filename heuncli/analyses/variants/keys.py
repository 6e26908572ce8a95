"""The key of a variant: a digest of all that its answer hangs on, and of nothing else.

    heun's version, measures, options  |  the spec's data with what is set in them  |  the content of its tables, meshes

The data are those of the YAML text, with the load case's values, what is set in all variants and the variant's own in
their places: comments, the order of blocks and the path of the file are not in it, nor the title, nor what is expected.
A number counts as it is read: 0.1, 1e-1 and, where they give the same bits, "0.1 m" and "100 mm" are one value each
(with a unit another one than without: units are checked). An expression counts as it is written, but for its spaces; in
`tables:` every text does, for there 1 mm may be the name of a column. Two variants of one key have the same answer. Two
of different keys may have, too: then one is solved again, and nothing is wrong.

Impure: reads the files of the spec's tables and meshes, when it is made.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Any

from heuncli.analyses.variants.asking import CASE, Recipe
from heuncli.base.errors import Finding, SourceLocation
from heuncli.base.method_rows import canonical
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.cases import settings_of
from heuncli.scene.file_format.named_files import NamedFiles
from heuncli.scene.file_format.names import mapping
from heuncli.scene.file_format.overrides import Setting, of_words, override
from heuncli.scene.file_format.quantity import Scope, measure, unit_in
from heuncli.scene.file_format.source import FLOAT, INTEGER, SourceFile, read
from heuncli.study.model.options import Options
from heuncli.version import VERSION

LEFT_OUT = frozenset({"title", "expect", "cases"})  # blocks on which no answer hangs; of cases what is set does
VERBATIM = frozenset({"heun", "tables"})  # blocks whose texts and kinds of numbers count as they are written
NO_NAMES = Scope()
NOWHERE = SourceLocation("", 1, 1)
MOST_KEPT = 10_000  # texts whose canonical form is kept


class CaseData(NamedTuple):
    """The data of a load case with what is set in all variants, and the digest of each of their blocks."""

    data: dict[str, Any]
    digests: dict[str, bytes]


class VariantKeys:
    """The keys of the variants of a recipe."""

    def __init__(self, recipe: Recipe, varies_cases: bool) -> None:
        """Read the spec and its tables. Raises SpecError. varies_cases: whether `case` is the load case."""
        self.recipe, self.varies_cases = recipe, varies_cases
        self.source: SourceFile = read(recipe.path, recipe.text)
        self.settings = of_words(recipe.overrides)[0]
        self.head = repr((VERSION, [tuple(one) for one in recipe.measures], told_of(recipe.options))).encode()
        self.files: dict[str, str] = {}
        self.cases: dict[str | None, CaseData] = {}
        self.texts: dict[str, Any] = {}

    def of(self, values: Mapping[str, str]) -> bytes:
        """The key of a variant, 32 bytes. Raises SpecError for a load case that is none."""
        case, own = self.recipe.case, values
        if self.varies_cases and CASE in values:
            case, own = values[CASE], {name: text for name, text in values.items() if name != CASE}
        before = self.case(case)
        data, _, problems = override(before.data, [self.setting(name, text) for name, text in own.items()])
        found = hashlib.sha256(self.head)
        for block in sorted(data):
            if block not in LEFT_OUT:
                same = data[block] is before.data.get(block)
                found.update(before.digests[block] if same else self.digest(block, data[block]))
        if problems:  # what cannot be set is not in the data
            found.update(repr(sorted(own.items())).encode())
        return bytes(found.digest())

    def of_spec(self) -> bytes:
        """The digest of what all variants have in common, with the values that the spec itself gives."""
        return self.of({})

    def case(self, name: str | None) -> CaseData:
        """The data of a load case."""
        if name not in self.cases:
            settings = [*(settings_of(name, self.source) if name is not None else ()), *self.settings]
            data, _, _ = override(self.source.data, settings)
            digests = {block: self.digest(block, value) for block, value in data.items() if block not in LEFT_OUT}
            self.cases[name] = CaseData(data, digests)
        return self.cases[name]

    def setting(self, name: str, text: str) -> Setting:
        """What a variant sets."""
        if text not in self.texts:
            if len(self.texts) >= MOST_KEPT:
                self.texts.clear()
            self.texts[text] = value_of(text)
        return Setting(name, self.texts[text], NOWHERE, NOWHERE)

    def digest(self, block: str, value: Any) -> bytes:
        """The digest of a block."""
        told = json.dumps(value, sort_keys=False) if block in VERBATIM else canonical_text(value)
        files = json.dumps({name: self.content(file) for name, file in FILES.get(block, nothing)(value)})
        files = "" if files == "{}" else files
        return bytes(hashlib.sha256(f"{block}:{told}{files}".encode("utf-8", "surrogatepass")).digest())

    def content(self, file: Any) -> str:
        """The digest of a file; empty where it cannot be read."""
        if type(file) is not str:
            return ""
        if file not in self.files:
            try:
                self.files[file] = hashlib.sha256(NamedFiles(self.recipe.path).content(file)).hexdigest()
            except Finding:
                self.files[file] = ""
        return self.files[file]


def of_tables(value: Any) -> Iterator[tuple[str, Any]]:
    """The files that tables name."""
    return ((name, entry["file"]) for name, entry in mapping(value).items() if "file" in mapping(entry))


def of_bodies(value: Any) -> Iterator[tuple[str, Any]]:
    """The files that shapes name."""
    for name, body in mapping(value).items():
        shapes = mapping(body).get("shapes")
        for i, shape in enumerate(shapes if type(shapes) is list else ()):
            if "file" in mapping(shape):
                yield f"{name}.{i}", shape["file"]


def nothing(value: Any) -> Iterator[tuple[str, Any]]:
    """Of a block that names no files."""
    return iter(())


FILES = {"tables": of_tables, "bodies": of_bodies}  # of the blocks that name files which


def value_of(text: str) -> Any:
    """What stands in a text in the form of `--set`; what cannot be read stands for itself."""
    bare = text.strip()
    if INTEGER.match(bare) or FLOAT.match(bare):
        return float(bare)
    if unit_in(bare) is not None:
        return bare
    settings, _ = of_words({"": text})
    return settings[0].value if settings else text


def canonical_text(value: Any) -> str:
    """Plain data in one of the ways in which they may be written."""
    kind = type(value)
    if kind is str:
        return _text(value)
    if kind is dict:
        return f"{{{','.join(f'{json.dumps(str(key))}:{canonical_text(item)}' for key, item in value.items())}}}"
    if kind is list:
        return f"[{','.join(map(canonical_text, value))}]"
    if kind is int or kind is float:
        try:
            return repr(float(value))
        except OverflowError:
            pass
    return repr(value)


def _text(text: str) -> str:
    """A number with a unit by its value and dimension; an expression, or a word, without spaces to spare."""
    found = unit_in(text)
    if found is not None:
        with suppress(Finding):
            value, dimension = measure(found[1], found[2].strip(), NO_NAMES)
            return f"({value!r}, {dimension})"
    return json.dumps(" ".join(text.split()))


def told_of(options: Options) -> tuple[Any, ...]:
    """What of the options an answer hangs on."""
    method = canonical(options.method) if options.method is not None else None
    return options.tolerance, method, options.step, options.least_norm, options.reduce
