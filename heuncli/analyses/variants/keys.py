"""Make the key of a variant: a digest of all that its result depends on, and of nothing else.

    heun's version, measures, options  |  the spec's data with all settings  |  the content of its tables, meshes

The data are those of the YAML text, with the load case's values, the values set in all variants and the variant's own
in their places: comments, the order of blocks and the path of the file are not included, nor the title, nor what is
expected. A number counts by its value: 0.1, 1e-1 and, where they give the same bits, "0.1 m" and "100 mm" are one value
each (with a unit it differs from one without: units are checked). An expression counts as it is written, except for its
spaces; in `tables:` every text does, because there 1 mm may be the name of a column. Two variants with one key have the
same result. Two with different keys may have it, too: then one is solved again, which does no harm.

Impure: reads the files of the spec's tables and meshes, when it is made.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

from heuncli.analyses.variants.evaluation import Recipe
from heuncli.analyses.variants.parameters import CASE, Values, format_value
from heuncli.base.errors import Finding, SourceLocation
from heuncli.base.method_rows import canonical_name
from heuncli.base.named_tuples import NamedTuple
from heuncli.scene.file_format.named_files import NamedFiles
from heuncli.scene.file_format.names import as_mapping
from heuncli.scene.file_format.parameters import Setting, apply_settings, list_case_settings, parse_settings
from heuncli.scene.file_format.quantity import ParameterValue, Scope, evaluate_quantity, match_quantity
from heuncli.scene.file_format.source import FLOAT, INTEGER, SourceFile, read_source
from heuncli.study.model.options import Options
from heuncli.version import VERSION

# results do not depend on them; the settings of a case are separate
IGNORED_BLOCKS = frozenset({"title", "expect", "cases"})
VERBATIM = frozenset({"heun", "tables"})  # blocks whose texts and kinds of numbers are not normalized
NO_NAMES = Scope()
NO_LOCATION = SourceLocation("", 1, 1)
MAX_CACHED = 10_000  # texts whose canonical form is cached


class CaseData(NamedTuple):
    """The data of a load case with the values set in all variants, and the digest of each of their blocks."""

    data: dict[str, Any]
    digests: dict[str, bytes]


class VariantKeys:
    """Makes the keys of the variants of a recipe."""

    def __init__(self, recipe: Recipe, varies_cases: bool) -> None:
        """Read the spec and its tables. Raises SpecError. varies_cases: whether `case` is the load case."""
        self.recipe, self.varies_cases = recipe, varies_cases
        self.source: SourceFile = read_source(recipe.path, recipe.text)
        self.settings = parse_settings(recipe.overrides)[0]
        self.head = repr(
            (VERSION, [tuple(request) for request in recipe.measures], select_options(recipe.options))
        ).encode()
        self.files: dict[str, str] = {}
        self.cases: dict[str | None, CaseData] = {}
        self.texts: dict[str, Any] = {}

    def make_key(self, values: Values) -> bytes:
        """Return the key of a variant, 32 bytes. Raises SpecError for an unknown load case."""
        case, overrides = self.recipe.case, values
        if self.varies_cases and CASE in values:
            case, overrides = (
                format_value(values[CASE]),
                {name: value for name, value in values.items() if name != CASE},
            )
        case_data = self.find_case_data(case)
        data, _, problems = apply_settings(
            case_data.data, [self.make_setting(name, value) for name, value in overrides.items()]
        )
        key = hashlib.sha256(self.head)
        for block in sorted(data):
            if block not in IGNORED_BLOCKS:
                is_same = data[block] is case_data.data.get(block)
                key.update(case_data.digests[block] if is_same else self.digest_block(block, data[block]))
        if problems:  # values that cannot be set are not in the data
            key.update(repr(sorted(overrides.items())).encode())
        return bytes(key.digest())

    def make_spec_key(self) -> bytes:
        """Return the key of the spec with its own values."""
        return self.make_key({})

    def find_case_data(self, name: str | None) -> CaseData:
        """Return the data of a load case."""
        if name not in self.cases:
            settings = [*(list_case_settings(name, self.source) if name is not None else ()), *self.settings]
            data = drop_report_texts(apply_settings(self.source.data, settings)[0])
            digests = {
                block: self.digest_block(block, value) for block, value in data.items() if block not in IGNORED_BLOCKS
            }
            self.cases[name] = CaseData(data, digests)
        return self.cases[name]

    def make_setting(self, name: str, value: ParameterValue) -> Setting:
        """Return the setting of one value of a variant."""
        if not isinstance(value, str):
            return Setting(name, value.to_entry(), NO_LOCATION, NO_LOCATION)
        if value not in self.texts:
            if len(self.texts) >= MAX_CACHED:
                self.texts.clear()
            self.texts[value] = parse_value(value)
        return Setting(name, self.texts[value], NO_LOCATION, NO_LOCATION)

    def digest_block(self, block: str, value: Any) -> bytes:
        """Return the digest of a block."""
        text = json.dumps(value, sort_keys=False) if block in VERBATIM else format_canonical(value)
        files = json.dumps({name: self.digest_file(file) for name, file in FILES.get(block, iter_no_files)(value)})
        files = "" if files == "{}" else files
        return bytes(hashlib.sha256(f"{block}:{text}{files}".encode("utf-8", "surrogatepass")).digest())

    def digest_file(self, file: Any) -> str:
        """Return the digest of a file; empty where it cannot be read."""
        if type(file) is not str:
            return ""
        if file not in self.files:
            try:
                self.files[file] = hashlib.sha256(NamedFiles(self.recipe.path).read_content(file)).hexdigest()
            except Finding:
                self.files[file] = ""
        return self.files[file]


def iter_table_files(value: Any) -> Iterator[tuple[str, Any]]:
    """Yield the files that tables name."""
    return ((name, entry["file"]) for name, entry in as_mapping(value).items() if "file" in as_mapping(entry))


def iter_shape_files(value: Any) -> Iterator[tuple[str, Any]]:
    """Yield the files that shapes name."""
    for name, body in as_mapping(value).items():
        shapes = as_mapping(body).get("shapes")
        for i, shape in enumerate(shapes if type(shapes) is list else ()):
            if "file" in as_mapping(shape):
                yield f"{name}.{i}", shape["file"]


def iter_no_files(value: Any) -> Iterator[tuple[str, Any]]:
    """Yield nothing, for a block that names no files."""
    return iter(())


def drop_report_texts(data: dict[str, Any]) -> dict[str, Any]:
    """Return the data with no more of the report than the results to compute; the rest of it is for readers."""
    report = data.get("report")
    if type(report) is not dict:
        return data
    results = {"report": report["results"]} if "results" in report else {}
    return {block: value for block, value in data.items() if block != "report"} | results


FILES = {"tables": iter_table_files, "bodies": iter_shape_files}  # the functions that yield the files named in a block


def parse_value(text: str) -> Any:
    """Parse a text in the form of `--set`; return the text if it cannot be parsed."""
    stripped = text.strip()
    if INTEGER.match(stripped) or FLOAT.match(stripped):
        return float(stripped)
    if match_quantity(stripped) is not None:
        return stripped
    settings, _ = parse_settings({"": text})
    return settings[0].value if settings else text


def format_canonical(value: Any) -> str:
    """Format plain data in one of the ways in which they may be written."""
    kind = type(value)
    if kind is str:
        return _format_canonical_text(value)
    if kind is dict:
        return f"{{{','.join(f'{json.dumps(str(key))}:{format_canonical(item)}' for key, item in value.items())}}}"
    if kind is list:
        return f"[{','.join(map(format_canonical, value))}]"
    if kind is int or kind is float:
        try:
            return repr(float(value))
        except OverflowError:
            pass
    return repr(value)


def _format_canonical_text(text: str) -> str:
    """Format a number with a unit by its value and dimension; an expression, or a word, without superfluous spaces."""
    found = match_quantity(text)
    if found is not None:
        with suppress(Finding):
            value, dimension = evaluate_quantity(found, NO_NAMES)
            return f"({value!r}, {dimension})"
    return json.dumps(" ".join(text.split()))


def select_options(options: Options) -> tuple[Any, ...]:
    """Return the options that a result depends on."""
    method = canonical_name(options.method) if options.method is not None else None
    return options.tolerance, method, options.step, options.least_norm, options.reduce
