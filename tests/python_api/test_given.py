"""What Python gives: paths, texts, mappings, values with NumPy's numbers; and what is refused, with its place."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import heuncli
from heuncli.scene.file_format.source import read_source
from tests.shared.command import HANGING, SPEC_TEXTS
from tests.shared.folders import SPECS

CASES = HANGING + "cases: {light: {set: {m: 0.5}}, heavy: {set: {m: 5}}}\n"
REST: dict[str, Any] = yaml.safe_load(HANGING)
PULL = "joints.pivot.force.z"


def pull(*given: Any, **asked: Any) -> float:
    return float(heuncli.solve(*given, **asked)[PULL])


def test_a_path_a_text_and_a_mapping_are_the_same_scene(folder: Path) -> None:
    files = (folder / "hanging.yaml", str(folder / "hanging.yaml"))
    assert {pull(file) for file in files} == {pull(text=HANGING), pull(REST), pull("name.yaml", text=HANGING), 9.81}


def test_every_worked_example_may_be_a_mapping() -> None:
    """As the reader of files reads it; the numbers are those of the file."""
    for path in [SPECS / "overhang.yaml", SPECS / "governor.yaml", SPECS / "trolley.yaml", SPECS / "door.yaml"]:
        own, built = heuncli.solve(path), heuncli.solve(read_source(str(path), None).data)
        assert own.paths() == built.paths() and built.as_dict()["spec"]["path"] == "<mapping>"
        assert all(np.array_equal(own[p].computed, built[p].computed, equal_nan=True) for p in own.paths())


def test_numbers_of_numpy_are_numbers() -> None:
    scene = {**REST, "gravity": np.array([0, 0, -9.81]), "parameters": {"m": np.float32(2)}, "title": Path("a")}
    assert pull(scene) == pull(REST, m=2) == pull(REST, m=np.int64(2)) == pull(REST, m=np.array(2.0)) == 19.62
    assert pull(REST, set={"gravity": np.array([0, 0, -1.0]), "bodies.bar.mass": "2000 g"}) == 2.0
    assert pull(REST, m="3 kg") == pull(REST, set={"m": "1 + 2"}) == pytest.approx(29.43)


def test_what_was_given_stays_as_it_is() -> None:
    scene = yaml.safe_load(HANGING)
    heuncli.solve(scene, m=3, set={"bodies.bar.center.2": -0.7})
    assert scene == REST


def test_load_cases() -> None:
    found = heuncli.solve_cases(text=CASES)
    assert {name: float(study[PULL]) for name, study in found.items()} == {"light": 4.905, "heavy": 5 * 9.81}
    assert pull(text=CASES, case="heavy") == 5 * 9.81 and pull(text=CASES, case="heavy", m=1) == 9.81


def test_a_spec_is_judged_without_being_solved() -> None:
    assert heuncli.validate(text=CASES) == ()
    (warning,) = heuncli.validate(text=SPEC_TEXTS["unsound"])
    assert warning.hint and warning.location is not None and warning.location.line > 1
    with pytest.raises(heuncli.SpecError) as caught:
        heuncli.validate("w.yaml", text=SPEC_TEXTS["wrong"])
    assert [str(problem.location) for problem in caught.value.problems] == ["w.yaml:7:9", "w.yaml:9:17"]


CYCLE: dict[str, Any] = {"heun": 1}
CYCLE["bodies"] = CYCLE
REFUSED: list[tuple[Callable[[], Any], str]] = [
    (lambda: heuncli.solve(), "spec: no spec is given [bad-option]"),
    (lambda: heuncli.solve(REST, text="heun: 1"), "spec: both a mapping and text= are given [bad-option]"),
    (lambda: heuncli.solve(HANGING), "spec: this path has several lines [bad-option]\n  hint: pass YAML text as text="),
    (lambda: heuncli.solve("-"), "spec: - is not a file [bad-option]"),
    (lambda: heuncli.solve("none.yaml"), "none.yaml:1:1: file not found [unreadable]"),
    (lambda: heuncli.solve({"heun": 1, "bodies": {1: {}}}), "<mapping>: bodies: expected a string as key, found int"),
    (lambda: heuncli.solve({"heun": 1, "forces": {"f": {True: "a"}}}), "hint: PyYAML reads the key `on` as True"),
    (lambda: heuncli.solve({"heun": 1, "bodies": {"a": {"mass": {2}}}}), "<mapping>: bodies.a.mass: set is not"),
    (lambda: heuncli.solve(CYCLE), "the spec is nested more than 64 levels deep [too-deep]"),
    (lambda: heuncli.solve({}), "<mapping>: "),
    (lambda: heuncli.solve({**REST, "gravty": [0, 0, 1]}), "<mapping>: gravty: "),
    (lambda: heuncli.solve(REST, k=2), "k=2: there is no parameter 'k' to set [no-such-key]"),
    (lambda: heuncli.solve(REST, tolerence=1e-6), "hint: did you mean the option tolerance?"),
    (lambda: heuncli.solve(REST, m="1 m"), "<mapping>: bodies.bar.mass: m is a length (1 m), expected a mass"),
    (lambda: heuncli.solve(REST, m="1 kgg"), "m='1 kgg': parameters.m: "),
    (lambda: heuncli.solve(REST, m=object()), "object is not allowed in a spec [wrong-kind]"),
    (lambda: heuncli.solve(REST, m=float("nan")), "m=nan: "),
    (lambda: heuncli.solve(REST, m=1, set={"m": 2}), "m: set twice"),
    (lambda: heuncli.solve(REST, set={"bodies.bar.mas": 2}), "bodies.bar.mas=2: bodies.bar.mas: "),
    (lambda: heuncli.solve(REST, tolerance=3), "tolerance 3 is not between 1e-14 and 0.1"),
    (lambda: heuncli.solve(REST, step=-1), "step -1: expected a positive number"),
    (lambda: heuncli.solve(REST, time_limit=0), "time_limit 0: expected a positive number"),
    (lambda: heuncli.solve(REST, axes="own"), "axes own: expected world, from, to"),
    (lambda: heuncli.solve(REST, method="magic"), "magic"),
    (lambda: heuncli.solve(REST, only=["joints.pivt"]), "only joints.pivt: not an entry of the results"),
    (lambda: heuncli.solve(REST, at=2), "at 2: there is one instant, t = 0 s"),
    (lambda: heuncli.solve(REST, case="all"), "hint: use heuncli.solve_cases for all load cases"),
    (lambda: heuncli.solve(REST, case="light"), "there is no load case 'light'"),
    (lambda: heuncli.solve_cases(REST), "solve_cases: the spec has no load cases"),
    (lambda: heuncli.solve(REST).measure("biggest x"), "measure 'biggest x': expected [max | min"),
    (lambda: heuncli.solve(REST).measure("max joints.p"), "measure: 'joints.p': 'p' is not a result [unknown-path]"),
    (lambda: heuncli.solve(REST).tables(units="kN,x"), "units kN,x: "),
    (lambda: heuncli.solve(REST).save("x.xls"), "save x.xls: unknown file extension; accepted: .json, .csv"),
    (lambda: heuncli.solve(REST).plot(), "plot: no path is given"),
    (lambda: heuncli.solve(REST).plot("joints.pivot.Fz"), "hint: did you mean joints.pivot.force.z?"),
    (lambda: heuncli.solve(REST).frame("foundation.about"), "frame: foundation.about does not depend on time"),
]  # fmt: skip


@pytest.mark.parametrize(("ask", "told"), REFUSED, ids=[told[:40] for _, told in REFUSED])
def test_what_cannot_be_is_refused_with_its_place(ask: Callable[[], Any], told: str) -> None:
    with pytest.raises(heuncli.HeunError) as caught:
        ask()
    assert told in str(caught.value)
    assert all(problem.hint and problem.code for problem in caught.value.problems)


def test_nothing_is_printed_and_no_other_error_gets_out(capfd: pytest.CaptureFixture[str]) -> None:
    for value in (
        "\x00",
        "\ud800",
        "a: b",
        "[",
        "",
        "1e400",
        10**400,
        -(10**30),
        True,
        None,
        [],
        {},
        [[]],
        {"": {"": 0}},
    ):
        for given in ({"m": value}, {"bodies.bar": value}, {"bodies.bar.center": value}, {"title": value}, {"": value}):
            try:
                heuncli.solve(REST, set=given)
            except heuncli.HeunError as error:
                assert str(error)
    assert capfd.readouterr() == ("", "")


def test_results_are_written_to_files(tmp_path: Path) -> None:
    study = heuncli.solve(REST)
    for name, text in (("a.json", study.to_json()), ("a.CSV", study.to_csv())):
        study.save(tmp_path / name)
        assert (tmp_path / name).read_bytes() == text.encode()
    with pytest.raises(FileNotFoundError):
        study.save(os.fspath(tmp_path / "none" / "a.json"))
