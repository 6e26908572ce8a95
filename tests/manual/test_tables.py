"""The tables of the manual are the rows of the code, and its tables of keys say what the models of the format say."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

import pytest

from heuncli.base import tolerances
from heuncli.loads.kinetostatics.stress import UNKNOWN_SHEAR
from heuncli.output.tables.export import MOST_NUMBERS
from heuncli.scene.expressions.grammar import MAX_LENGTH as LONGEST_EXPRESSION
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_joints as fj
from heuncli.scene.file_format import format_loads as fl
from heuncli.scene.file_format.entries import REQUIRED as NO_DEFAULT
from heuncli.scene.file_format.entries import Entry, Field
from heuncli.scene.file_format.named_files import MAX_FILE_SIZE as LARGEST_TABLE
from heuncli.scene.file_format.resolve import DEFAULT_TOLERANCE
from heuncli.scene.file_format.rules.analysis import MAX_DURATION as LONGEST_RUN
from heuncli.scene.file_format.rules.sections import MAX_CUTS
from heuncli.scene.file_format.semantics import DEFAULT_SAMPLES, MAX_SAMPLES
from heuncli.scene.file_format.source import MAX_SIZE as LARGEST_SPEC
from tests.manual.keys import ALL, CHAPTERS, INLINE, NEEDED, TOP, named_fields, pairs, top_keys, unit_of, words_of
from tests.manual.tables import TABLES, Table
from tests.shared.manual import TEXTS, tables_below

KEYS = "| key | unit | default | meaning |"
KEYS_OF = "| key | of | unit | default | meaning |"
Row = dict[str, str]


@pytest.mark.parametrize("table", TABLES, ids=lambda table: f"{table.page}: {table.heading}")
def test_the_rows_of_the_code_stand_in_the_manual(table: Table) -> None:
    found = tables_below(TEXTS[table.page], table.heading)
    assert table.text in found, f"python -m tests.manual.tables writes it:\n\n{table.text}"


def rows(heading: str, first_line: str) -> Iterator[Row]:
    """The rows of the first table of keys below a heading, a row for each key that it names."""
    table = next(found for found in tables_below(TEXTS["format"], heading) if found.startswith(first_line))
    head, _, *lines = table.splitlines()
    for line in lines:
        row = dict(zip(cells(head), cells(line), strict=True))
        for key in re.findall(r"`(\w+)`", row["key"]):
            yield row | {"key": key}


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]


def kinds(row: Row, models: Mapping[str, type[Entry]]) -> list[str]:
    """The types of which a row is."""
    return [*models] if row["of"] == ALL else re.findall(r"`(\w+)`", row["of"])


def described() -> Iterator[tuple[str, Row, Field | None]]:
    """Every row of a table of keys, with the field that it describes."""
    for heading, model in CHAPTERS.items():
        if isinstance(model, Mapping):
            for row in rows(heading, KEYS_OF):
                for kind in kinds(row, model):
                    yield heading, row, pairs(model).get((kind, row["key"]))
        else:
            for row in rows(heading, KEYS):
                yield heading, row, named_fields(model).get(row["key"])
    for row in rows(TOP, KEYS):
        yield TOP, row, named_fields(f.HeadEntry).get(row["key"])


def test_the_top_level_has_its_keys() -> None:
    assert sorted(row["key"] for row in rows(TOP, KEYS)) == sorted(top_keys())


@pytest.mark.parametrize("heading", CHAPTERS)
def test_a_chapter_has_the_keys_of_its_model(heading: str) -> None:
    model = CHAPTERS[heading]
    if isinstance(model, Mapping):
        found = [(kind, row["key"]) for row in rows(heading, KEYS_OF) for kind in kinds(row, model)]
        assert sorted(found) == sorted(pairs(model))
    else:
        listed = [row["key"] for row in rows(heading, KEYS)]
        assert sorted(listed) == sorted(set(named_fields(model)))


def test_small_mappings_are_told_in_their_row() -> None:
    for model, (heading, key) in INLINE.items():
        (text,) = [row["meaning"] for row in rows(heading, KEYS) if row["key"] == key]
        for word in named_fields(model):
            assert re.search(rf"\b{word}\b", text), f"{heading}: {key} lacks {word}"


def test_every_model_has_a_chapter() -> None:
    told = {f.HeadEntry, fj.AnyJoint, fj.Bearing, fl.PairEntry, fl.JointLoadEntry, *INLINE}
    for model in CHAPTERS.values():
        told.update(model.values() if isinstance(model, Mapping) else {model})
    models = {x for x in vars(f).values() if isinstance(x, type) and issubclass(x, Entry) and x is not Entry}
    assert models - told == set()


def test_units_are_those_of_the_models() -> None:
    wrong = [
        f"{heading}: {row['key']} is in {unit}, told is {row['unit']}"
        for heading, row, field in described()
        if field is not None and (unit := unit_of(field)) is not None and unit not in row["unit"].split(" or ")
    ]
    assert wrong == []


def test_defaults_are_those_of_the_models() -> None:
    wrong = []
    for heading, row, field in described():
        if field is None or (heading, row["key"]) in NEEDED:
            continue
        cell = row["default"]
        if field.is_required != (cell == "required"):
            wrong.append(f"{heading}: {row['key']} is {'required' if field.is_required else 'not required'}")
        elif (told := default(field)) is not None and told not in cell:
            wrong.append(f"{heading}: the default of {row['key']} is {told}, not {cell}")
    assert wrong == []


def default(field: Field) -> str | None:
    """The default of a field as the manual writes it; None where there is none to be told."""
    value: Any = field.default
    if value is NO_DEFAULT or value is None or value == "":
        return None
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, str):
        return f"`{value}`"
    return str([int(x) for x in value]) if isinstance(value, tuple) else f"{value:g}"


LATE = {  # defaults that are taken after the models are read
    ("Analysis", "samples"): DEFAULT_SAMPLES,
    ("Analysis", "tolerance"): DEFAULT_TOLERANCE,
    ("Expect", "rel"): tolerances.EXPECTED_RELATIVE,
    ("Expect", "abs"): tolerances.EXPECTED_ABSOLUTE,
    ("Properties", "shear_factor"): UNKNOWN_SHEAR,
}
SIZES = (
    ("numbers to export", MOST_NUMBERS),
    ("samples", MAX_SAMPLES),
    ("cuts in a series", MAX_CUTS),
    ("steps", tolerances.MOST_STEPS),
    ("time", LONGEST_RUN),
    ("an expression", LONGEST_EXPRESSION),
    ("a spec", LARGEST_SPEC),
    ("the file of a table", LARGEST_TABLE),
)


@pytest.mark.parametrize(("place", "value"), LATE.items())
def test_defaults_that_come_later(place: tuple[str, str], value: float) -> None:
    heading, key = place
    (cell,) = {row["default"] for row in rows(heading, KEYS) if row["key"] == key}
    assert float(cell) == value


def test_sizes_are_those_of_the_code() -> None:
    (table,) = tables_below(TEXTS["limits"], "Sizes")
    listed = [tuple(cells(line)) for line in table.splitlines()[2:]]
    assert [what for what, _ in listed] == [what for what, _ in SIZES]
    for (what, told), (_, value) in zip(listed, SIZES, strict=True):
        number, unit, *_ = [*told.replace(",", "").split(), ""]
        assert float(number) * {"million": 1e6, "MB": 1e6}.get(unit, 1.0) == value, what


def test_words_are_those_of_the_models() -> None:
    for heading, row, field in described():
        for word in words_of(field.annotation) if field is not None else ():
            assert f"`{word}`" in " ".join(row.values()), f"{heading}: {row['key']} lacks {word}"


@pytest.mark.parametrize(("heading", "types"), [("Joints", fj.JOINTS), ("Forces", fl.LOADS)])
def test_each_type_is_told_in_a_word(heading: str, types: Mapping[str, type[Entry]]) -> None:
    first, *_ = tables_below(TEXTS["format"], heading)
    assert re.findall(r"^\| `(\w+)`", first, re.MULTILINE) == list(types)
