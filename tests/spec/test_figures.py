"""What is a number with a unit, of the words in which variants are asked for, is one when it is read, too."""

from __future__ import annotations

import pytest

from heuncli.analyses.variants.parameters import ParameterAxis, parse_axis_values
from heuncli.scene.file_format.quantity import parse_number_with_unit
from heuncli.scene.file_format.source import parse_source


@pytest.mark.parametrize("text", ["3", "+3", "010", ".5", "5.", "1e3", "1E-3", "-0.0"])
def test_plain_numbers_are_figures_of_the_same_value(text: str) -> None:
    figure = parse_number_with_unit(text)
    assert figure is not None
    assert (figure.value, figure.unit) == (float(parse_source("word", text, "").data), "")


@pytest.mark.parametrize("text", ["0x32", "0o17", " 0x32 ", "1e400", "true", "2*L", "[1]", "1_0"])
def test_other_values_are_none(text: str) -> None:
    assert parse_number_with_unit(text) is None


def test_a_list_of_others_is_taken_as_it_stands() -> None:
    assert parse_axis_values("n=0x10,0x20") == ParameterAxis("n", ("0x10", "0x20"))
    assert parse_axis_values("n=1,0x20") == ParameterAxis("n", ("1", "0x20"))


def test_a_list_of_numbers_of_one_unit_is_numbers() -> None:
    assert parse_axis_values("n=1,2,3rpm") == ParameterAxis("n", (1.0, 2.0, 3.0), "rpm")
    assert parse_axis_values("n=1000 rpm") == ParameterAxis("n", (1000.0,), "rpm")
    assert parse_axis_values("n=0:1/3mm") == ParameterAxis("n", (0.0, 0.5, 1.0), "mm")
    assert parse_axis_values("L=100mm,0.2m") == ParameterAxis("L", ("100mm", "0.2m"))
    axis = parse_axis_values("k=5,5.0")
    assert isinstance(axis, ParameterAxis) and [*map(type, axis.values)] == [int, float]  # as YAML reads them


def test_names_of_files_are_no_numbers() -> None:
    """In 1.csv, csv is no unit."""
    assert parse_axis_values("tables.f.file=1.csv,2.csv") == ParameterAxis("tables.f.file", ("1.csv", "2.csv"))
