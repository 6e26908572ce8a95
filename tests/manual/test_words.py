"""The manual's page of engineering terms: each row leads to a place, and names only what heun has."""

from __future__ import annotations

import re

import pytest

from heuncli.app.cli.options import list_fields
from heuncli.app.cli.registry import COMMANDS
from heuncli.app.commands.explain.lookup import Row, find_places, find_terms, read_rows
from heuncli.app.commands.explain.pages import find_section
from heuncli.results.path_words import find_quantity
from heuncli.results.results_schema import ROWS as QUANTITIES
from tests.manual.keys import PLACES
from tests.shared.manual import TEXTS, headings

ROWS = [row for row in read_rows() if row.page == "words"]
TERMS = [name for row in ROWS for name in row.names]
ASKED = """
    bore pressure; bearing load; bearing pair; DOF; hardpoint; Coulomb friction; hinge; revolute; prismatic; spherical;
    fixed joint; weld; wishbone; torsion bar; torsion spring; imbalance; jerk; duty cycle; free-body diagram; NVH;
    ball screw; rack and pinion; timing belt; planetary gear; cable; pulley; bump stop; preload; backlash;
    overturning moment; shaft torque; bending moment diagram; von Mises; safety factor; fatigue; rainflow;
    natural frequency; stiffness matrix; Jacobian; Lagrange multiplier; redundant constraint; overconstrained;
    static indeterminacy; MBS; FEA loads
"""
# words of a spec that are values, not keys
VALUES = {
    "ball", "pin", "slide", "cylinder", "universal", "cv", "weld", "line", "rod", "plane", "bushing", "screw", "gear",
    "ratio", "differential", "belt", "rope", "turn_spring", "spring", "damper", "actuator", "motor", "cam", "force",
    "couple", "torque", "distributed", "planar", "rest", "state", "motion", "auto", "none", "tube", "t",
}  # fmt: skip
WORDS_OF_OUTPUT = {"open", "null", "partials", "epsilon", "coriolis", "damping", "acceleration", "bodies"}
OPTIONS = {word for command in COMMANDS for field in list_fields(command.request) for word in field.option.words}


def test_a_term_stands_once() -> None:
    assert len({term.lower() for term in TERMS}) == len(TERMS)
    assert len(ROWS) >= 90


@pytest.mark.parametrize("term", [term.strip() for term in " ".join(ASKED.split()).split(";")])
def test_common_terms_are_found(term: str) -> None:
    assert find_terms(term, find_places(term)[0]) or term == "weld"


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.names[0])
def test_a_row_leads_to_places_that_exist(row: Row) -> None:
    places = list(row.list_places())
    assert places
    for place in places:
        assert place.page in TEXTS
        assert not place.heading or find_section(place.page, place.heading) is not None, place


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.names[0])
def test_a_row_names_only_what_there_is(row: Row) -> None:
    keys = {place.key for place in PLACES}
    for quoted in re.findall(r"`([^`]+)`", row.text):
        if quoted.startswith("heun "):
            _, command, *_ = quoted.split()
            assert command in {command.name for command in COMMANDS}, quoted
        for option in re.findall(r"(?<!\S)--[\w-]+", quoted):
            assert option in OPTIONS, quoted
        if re.match(r"(joints|sections|foundation|bodies|impulses)\.[\w.]+$", quoted) and not quoted.endswith("NUMBER"):
            assert find_quantity(quoted.split(".")) is not None or quoted == "foundation.mass_effect", quoted
        elif re.fullmatch(r"\w+", quoted):
            known = keys | VALUES | WORDS_OF_OUTPUT
            assert quoted in known or any(quoted in each.path.split(".") for each in QUANTITIES), quoted


def test_values_are_words_of_the_format() -> None:
    named = set(re.findall(r"`(\w+)`", TEXTS["format"] + TEXTS["index"] + TEXTS["results"])) | set(headings("format"))
    assert VALUES - named == set()
