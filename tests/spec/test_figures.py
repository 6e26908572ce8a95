"""What is a number with a unit, of the words in which variants are asked for, is one when it is read, too."""

from __future__ import annotations

import pytest

from heuncli.analyses.variants.axes import parse_axis_values
from heuncli.analyses.variants.parameters import ParameterAxis
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
