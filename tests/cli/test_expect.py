"""`expect` of a spec against its results."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import Problem, SolveError, SourceLocation, SpecError
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.queries import expectations as expect
from heuncli.study.queries.expectations import compare
from heuncli.study.workflow import solve
from tests.shared.fakes import ACCURATE, FakeStudy, pendulum

STUDY = FakeStudy(np.linspace(0.0, 2.0, 21))
PLACE = SourceLocation("fake.yaml", 7, 3)
FX = "joints.pivot.force.x"
FX_AT_1 = 3.0 * np.sin(2.0)


def expectation(of: str, is_: Any, **more: Any) -> Any:
    return SimpleNamespace(
        **{
            "of": of,
            "is_": is_,
            "at": None,
            "peak": None,
            "rel": None,
            "abs": None,
            "below": None,
            "curve": None,
            "above": None,
            "location": PLACE,
            **more,
        }
    )


@pytest.mark.parametrize(
    "item",
    [
        expectation(FX, FX_AT_1, at=1.0),
        expectation(FX, FX_AT_1 * (1.0 + 0.9e-3), at=1.0, rel=1e-3),
        expectation(FX, FX_AT_1 + 0.9e-3, at=1.0, abs=1e-3),
        expectation(FX, 3.0, peak="max", rel=1e-12),
        expectation(FX, 3.0 * np.sin(4.0), peak="min", rel=1e-12),
        expectation("foundation.force.z", 10.81, peak="abs", rel=1e-12),
        expectation("joints.pivot.force", (FX_AT_1, 0.0, 9.81 + np.cos(2.0)), at=1.0),
        expectation("model.freedoms", 4.0),
        expectation("sections.along.s", (0.0, 0.2, 0.4, 0.6, 0.8)),
        expectation("joints.pivot.force.10.x", FX_AT_1),
    ],
)
def test_what_holds(item: Any) -> None:
    assert compare(STUDY, item).failure is None


@pytest.mark.parametrize(
    ("item", "why"),
    [
        (expectation(FX, FX_AT_1 * (1.0 + 1.1e-3), at=1.0, rel=1e-3), "off by 0.003, allowed 0.00273"),
        (expectation(FX, FX_AT_1 + 1.1e-3, at=1.0, abs=1e-3), "off by 0.0011, allowed 0.001"),
        (expectation(FX, FX_AT_1 * (1.0 + 2e-6), at=1.0), "off by"),
        (expectation(FX, None, at=1.0), "expected open, found a number"),
        (expectation("joints.pivot.force", None, at=1.0), "3 of 3 are not open (is: null means all of them"),
        (expectation("model.freedoms", 4.0, peak="max"), "has no time history"),
        (expectation("joints.pivot.open", None), "is not a number"),
        (expectation(FX, 1.0, at=1.03), "t = 1.03 s is not an output time; the nearest is 1 s"),
        (expectation(FX, 1.0), "one number expected, a list of 21 found"),
        (expectation("joints.pivot.force", 1.0, at=1.0), "one number expected, a list of 3 found"),
        (expectation("joints.pivt.force", 1.0, at=1.0), "joints has no 'pivt'"),
        (expectation("model.freedoms", 5.0), "off by 1"),
    ],
)
def test_what_does_not_hold_says_why(item: Any, why: str) -> None:
    case = compare(STUDY, item)
    assert not case.is_met
    assert why in (case.failure or "")


LOST = FakeStudy(STUDY.times, {"accuracy": {**ACCURATE, "horizon": 1.25}})
SERIES = tuple((3.0 * np.sin(2.0 * STUDY.times)).tolist())


@pytest.mark.parametrize(
    "item",
    [
        expectation(FX, 3.0 * np.sin(3.0), at=1.5),
        expectation(FX, 3.0, peak="max", rel=1e-12),
        expectation(FX, SERIES),
        expectation("joints.pivot.force.15.x", 3.0 * np.sin(3.0)),
        expectation(FX, None, at=1.5),
    ],
)
def test_beyond_the_horizon_nothing_holds_by_luck(item: Any) -> None:
    """The number is there, and in the JSON, and is not what can be relied on."""
    case = compare(LOST, item)
    assert case.failure == "not reliable from t = 1.25 s on"
    assert case.found_values is None


def test_before_the_horizon_expectations_hold() -> None:
    assert compare(LOST, expectation(FX, FX_AT_1, at=1.0)).is_met
    assert compare(LOST, expectation("joints.pivot.force.10.x", FX_AT_1)).is_met
    assert compare(LOST, expectation("model.freedoms", 4.0)).is_met


def test_open_is_expected_as_null() -> None:
    force = pendulum(STUDY.times).joints["pivot"]["force"].copy()
    force[:, 2] = np.nan
    study = FakeStudy(STUDY.times[:1], {"joints": {"pivot": {"force": force[:1]}}})
    assert compare(study, expectation("joints.pivot.force.z", None)).is_met
    assert compare(study, expectation("joints.pivot.force", (0.0, 0.0, None))).is_met
    assert compare(study, expectation("joints.pivot.force.z", 1.0)).failure == "open"
    assert not compare(study, expectation("joints.pivot.force", None)).is_met


def test_one_instant_needs_no_at() -> None:
    study = FakeStudy(np.array([1.0]))
    assert compare(study, expectation(FX, FX_AT_1)).is_met


BOUNDS = [
    expectation(FX, None, below=3.1),
    expectation(FX, None, below=3.1, above=-2.3),
    expectation(FX, None, above=3.0 * np.sin(4.0) - 1e-9),
    expectation(FX, None, below=FX_AT_1 + 1e-9, at=1.0),
    expectation(FX, None, above=2.9, peak="max"),
    expectation(FX, None, below=-2.0, peak="min"),
    expectation(FX, None, above=2.9, below=3.1, peak="abs"),
    expectation("joints.pivot.force", None, below=10.9, above=8.0),  # a vector counts by its magnitude
    expectation("sections.along.M2", None, below=2.5, above=-2.0),
    expectation("sections.along.M2.1", None, below=0.61),
    expectation("sections.along.M2", None, below=2.4 * np.sin(2.0) + 1e-9, at=1.0),
    expectation("model.freedoms", None, below=5, above=3),
    expectation("foundation.about", None, below=1e-9),
]


@pytest.mark.parametrize("item", BOUNDS)
def test_what_stays_within_bounds(item: Any) -> None:
    assert compare(STUDY, item).failure is None


@pytest.mark.parametrize(
    ("item", "why"),
    [
        (expectation(FX, None, below=2.99), "the largest, 3 at t = 0.785398 s, is not below 2.99"),
        (expectation(FX, None, above=-2.2), "the smallest, -2.27040749 at t = 2 s, is not above -2.2"),
        (expectation(FX, None, below=5.0, above=-2.2), "is not above -2.2"),
        (expectation(FX, None, below=2.7, at=1.0), "2.72789228 at t = 1 s, is not below 2.7"),
        (expectation(FX, None, below=2.9, peak="abs"), "the largest magnitude, 3 at t = 0.785398 s, is not below 2.9"),
        (expectation("joints.pivot.force", None, below=10.0), "the largest, 10.81 at t = 0 s, is not below 10"),
        (expectation("sections.along.M2", None, below=2.3), "at t = 0.785398 s, s = 0.8 m, is not below 2.3"),
        (expectation("model.freedoms", None, below=4.0), "the largest, 4, is not below 4"),
        (expectation("model.freedoms", None, above=4.0), "the smallest, 4, is not above 4"),
    ],
)
def test_what_leaves_its_bounds_says_how_far_when_and_where(item: Any, why: str) -> None:
    failure = compare(STUDY, item).failure
    assert failure is not None
    assert why in failure


def test_no_bound_is_met_by_nothing() -> None:
    study = FakeStudy(STUDY.times, {"accuracy": {**ACCURATE, "unknown": []}})
    assert compare(study, expectation("accuracy.unknown", None, below=1.0)).failure == "there is no value"


def test_no_bound_is_met_by_what_is_open_or_beyond_the_horizon() -> None:
    force = pendulum(STUDY.times).joints["pivot"]["force"].copy()
    force[3:5, 2] = np.nan
    study = FakeStudy(STUDY.times[:1], {"joints": {"pivot": {"force": force[3:4]}}})
    assert compare(study, expectation("joints.pivot.force.z", None, below=1e9)).failure == "open at t = 0 s"
    assert compare(study, expectation("joints.pivot.force.x", None, below=1e9)).is_met
    lost = compare(LOST, expectation(FX, None, below=1e9))
    assert (lost.failure, lost.found_values) == ("not reliable from t = 1.25 s on", None)
    assert compare(LOST, expectation(FX, None, below=3.0, at=1.0)).is_met


def test_several_problems_at_once_fail_one_expectation(monkeypatch: pytest.MonkeyPatch) -> None:
    def found(*_: Any) -> Any:
        raise SolveError(Problem("outside", "one", hint="a hint"), Problem("outside", "two", hint="a hint"))

    monkeypatch.setattr(expect, "_find_values", found)
    assert compare(STUDY, expectation(FX, 3.0, peak="max")).failure == "one (a hint)"


FALLING = """\
heun: 1
gravity: [0, 0, -9.81]
bodies: {ball: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1]}}
analysis: {duration: 1, samples: 5, until: t > 0.3}
expect:
"""


@pytest.mark.parametrize(
    ("at", "failure"), [(0.3, None), (0.25, "off by"), (0.4, "not an output time; the nearest is 0.3 s")]
)
def test_where_a_run_ends_is_known_after_it(at: float, failure: str | None) -> None:
    """The instant at which a condition ends it is one of the output: what is expected there is compared."""
    item = f"  - {{of: bodies.ball.velocity.z, at: {at}, is: {-0.3 * 9.81}}}\n"
    spec = load("falling.yaml", FALLING + item)
    told = compare(solve(spec, Options()), spec.expect[0]).failure
    assert told is None if failure is None else told is not None and failure in told


def test_beyond_the_longest_run_nothing_is_expected() -> None:
    """Nor between the samples of a run that nothing ends."""
    with pytest.raises(SpecError, match="is not an output time"):
        load("falling.yaml", FALLING + "  - {of: bodies.ball.velocity.z, at: 1.2, is: 0}\n")
    with pytest.raises(SpecError, match="is not an output time"):
        text = FALLING.replace(", until: t > 0.3", "")
        load("falling.yaml", text + "  - {of: bodies.ball.velocity.z, at: 0.3, is: 0}\n")
