"""One number of a run, in the words of `--measure`."""

from __future__ import annotations

import json

import numpy as np
import pytest

from heuncli.base.errors import HeunError, SpecError
from heuncli.output.tables import measure
from heuncli.output.tables.measure import PATH, parse_measure, require_known_paths
from heuncli.scene.file_format.load import load
from tests.shared.command import HANGING
from tests.shared.fakes import ACCURATE, FakeStudy

STUDY = FakeStudy(np.linspace(0.0, 2.0, 21))


def number(words: str) -> float:
    return float(measure.format_measures([measure.parse_measure(words)], STUDY, "table"))


@pytest.mark.parametrize(
    ("words", "value"),
    [
        ("max joints.pivot.force.x", 3.0),
        ("min joints.pivot.force.x", 3.0 * np.sin(4.0)),
        ("max abs joints.pivot.force.x", 3.0),
        ("abs foundation.force.z", 10.81),
        ("max abs foundation.force.z", 10.81),
        ("max joints.pivot.force", 10.81),
        ("min joints.elbow.moment", 0.0),
        ("first energy.potential", 0.5),
        ("final energy.kinetic", 0.5 * np.sin(2.0) ** 2),
        ("at 0.123 energy.kinetic", 0.5 * np.sin(0.123) ** 2),
        ("at 0.5 joints.pivot.force", np.hypot(3.0 * np.sin(1.0), 9.81 + np.cos(1.0))),
        ("max sections.along.M2", 2.4),
        ("max abs sections.along.M2.4", 2.4),
        ("model.freedoms", 4.0),
        ("accuracy.estimate.motion", 4e-11),
        ("foundation.about.z", 0.0),
    ],
)
def test_the_forms(words: str, value: float) -> None:
    assert number(words) == pytest.approx(value, rel=1e-12, abs=1e-12)


def test_all_digits_are_printed() -> None:
    text = measure.format_measures([measure.parse_measure("final energy.kinetic")], STUDY, "table")
    assert float(text) == STUDY.results.energy["kinetic"][-1]
    assert text.endswith("\n")


def test_json_tells_the_instant_too() -> None:
    text = measure.format_measures([measure.parse_measure("max joints.pivot.force.x")], STUDY, "json")
    block = json.loads(text)
    assert block["measure"] == "max joints.pivot.force.x"
    assert block["value"] == pytest.approx(3.0)
    assert block["at"] == pytest.approx(np.pi / 4.0, abs=1e-6)


def test_what_is_open_reads_open() -> None:
    study = FakeStudy(STUDY.times, {"energy": {"kinetic": np.full(1, np.nan)}})
    assert measure.format_measures([measure.parse_measure("final energy.kinetic")], study, "table") == "open\n"


LOST = FakeStudy(STUDY.times, {"accuracy": {**ACCURATE, "horizon": 1.25}})


@pytest.mark.parametrize(
    "words",
    [
        "max joints.pivot.force.x",
        "min joints.pivot.force.x",
        "abs joints.pivot.force.x",
        "final joints.pivot.force.x",
        "at 1.25 joints.pivot.force.x",
        "at 1.7 joints.pivot.force",
        "joints.pivot.force.13.x",
    ],
)
def test_beyond_the_horizon_nothing_is_told(words: str) -> None:
    """Of a run that goes on beyond its horizon the largest is not known, for it may lie there."""
    assert measure.format_measures([measure.parse_measure(words)], LOST, "table") == "?\n"
    block = json.loads(measure.format_measures([measure.parse_measure(words)], LOST, "json"))
    assert (block["value"], block["at"], block["horizon"]) == (None, None, 1.25)
    assert measure.find_warnings([measure.parse_measure(words)], LOST)[0].endswith("not reliable from t = 1.25 s on")


@pytest.mark.parametrize(
    "words",
    [
        "first joints.pivot.force.x",
        "at 1.2 joints.pivot.force.x",
        "joints.pivot.force.12.x",
        "model.freedoms",
        "final time",
    ],
)
def test_before_the_horizon_all_is_told(words: str) -> None:
    text = measure.format_measures([measure.parse_measure(words)], LOST, "table")
    assert text == measure.format_measures([measure.parse_measure(words)], STUDY, "table")
    assert measure.find_warnings([measure.parse_measure(words)], LOST) == []


@pytest.mark.parametrize(
    "words", ["", "max", "most energy.kinetic", "at energy.kinetic", "at nan energy.kinetic", "a b c d"]
)
def test_other_words_are_refused_with_the_forms(words: str) -> None:
    with pytest.raises(HeunError, match="expected \\[max"):
        measure.parse_measure(words)


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ("energy.kinetic", "has values at 21 instants: use max, min"),
        ("max model.freedoms", "has no time history"),
        ("foundation.about", "is 3 numbers"),
        ("at 3 energy.kinetic", "the run goes from 0 to 2 s"),
        ("final sections.along.M1", "is 5 numbers"),
        ("max energy.kinetc", "energy has no 'kinetc'; known: kinetic, potential, work"),
    ],
)
def test_what_is_not_one_number_is_refused(words: str, why: str) -> None:
    with pytest.raises(HeunError, match=why) as caught:
        number(words)
    assert caught.value.exit_code == 2


def test_several_are_a_line_each_in_their_order_and_a_list_in_json() -> None:
    several = measure.parse_measures(["model.freedoms", "max joints.pivot.force.x", "at 0.5 energy.kinetic"])
    lines = measure.format_measures(several, STUDY, "table").splitlines()
    assert lines == [measure.format_measures([one], STUDY, "table").strip() for one in several]
    blocks = json.loads(measure.format_measures(several, STUDY, "json"))
    assert blocks == [json.loads(measure.format_measures([one], STUDY, "json")) for one in several]


def test_of_several_each_is_known_or_not_by_itself() -> None:
    several = measure.parse_measures(["at 1.2 joints.pivot.force.x", "final joints.pivot.force.x"])
    lines = measure.format_measures(several, LOST, "table").splitlines()
    assert float(lines[0]) == pytest.approx(3.0 * np.sin(2.4), rel=1e-12)
    assert lines[1] == "?"
    assert len(measure.find_warnings(several, LOST)) == 1


def test_of_several_all_that_are_wrong_are_told() -> None:
    with pytest.raises(HeunError) as caught:
        measure.parse_measures(["most x", "model.freedoms", "at x y"])
    assert len(caught.value.problems) == 2
    with pytest.raises(HeunError) as caught:
        several = measure.parse_measures(["energy.kinetic", "model.freedoms", "final sections.along.M1"])
        measure.format_measures(several, STUDY, "table")
    assert len(caught.value.problems) == 2
    assert caught.value.exit_code == 2


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("last energy.kinetic", "did you mean 'final energy.kinetic'?"),
        ("max energy.kinetic abs", "did you mean 'max abs energy.kinetic'?"),
        ("max(energy.kinetic)", "did you mean 'max energy.kinetic'?"),
        ("max |joints.pivot.force|", "did you mean 'max joints.pivot.force'?"),
        ("energy.kinetic at 0.5", "did you mean 'at 0.5 energy.kinetic'?"),
        ("first joints.pivot.force[2]", "did you mean 'first joints.pivot.force.2'?"),
        ("max energy.kinetic, min energy.kinetic", "one number each: --measure may be repeated"),
        ("mean energy.kinetic", "for example --measure 'max abs sections.middle.M1'"),
        ("", "for example --measure 'max abs sections.middle.M1'"),
    ],
)
def test_other_words_get_the_form_that_was_meant(text: str, said: str) -> None:
    with pytest.raises(HeunError) as caught:
        measure.parse_measure(text)
    assert caught.value.problems[0].hint == said


def test_a_path_of_many_colons_ends() -> None:
    assert PATH.match("a:" * 200 + "!") is None
    assert PATH.match("sections.a@0.1:before.M1") and not PATH.match("a b")


def test_stresses_of_an_impulse_need_properties() -> None:
    text = HANGING + (
        "sections: {s: {body: bar, at: [0, 0, -0.2], normal: [0, 0, -1], "
        "piece: {mass: 0.5, center: [0, 0, -0.6], inertia: [0.01, 0.01, 0.001]}}}\n"
        "impulses: {blow: {on: bar.top, vector: [1, 0, 0]}}\n"
    )
    spec = load("scene.yaml", text)
    with pytest.raises(SpecError, match="the section has no properties"):
        require_known_paths([parse_measure("impulses.0.sections.s.stress.mises")], spec)
