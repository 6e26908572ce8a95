"""What Python gets is what the command line writes: numbers to the bit, tables to the letter, errors to the place."""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import heuncli
from heuncli.results.path_words import find_quantity
from tests.shared.broken import FILES, head
from tests.shared.command import Heun
from tests.shared.folders import SPECS

EVERY = sorted(SPECS.glob("*.yaml"))
TABLES = ("overhang", "struck_door", "door", "bricard", "six_cylinder", "schlick")


def solved(path: Path, **asked: Any) -> heuncli.Solved:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", heuncli.HeunWarning)
        return heuncli.solve(path, **asked)


def leaves(node: Any, keys: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """The numbers of a JSON with the keys that lead to them."""
    row = find_quantity(keys) if keys else None
    if row is not None:
        yield from [(keys, node)] if row.units else []
    elif isinstance(node, dict):
        for key, member in node.items():
            yield from leaves(member, (*keys, key))
    elif isinstance(node, list):
        for number, member in enumerate(node):
            yield from leaves(member, (*keys, str(number)))


@pytest.mark.heavy
@pytest.mark.parametrize("path", EVERY, ids=lambda path: path.stem)
@pytest.mark.sixth
def test_numbers_are_those_of_the_json(heun: Heun, path: Path) -> None:
    written = json.loads(heun("run", str(path), "--format", "json", "-q").stdout)
    study = solved(path)
    own = study.as_dict()
    written.setdefault("points", own.get("points", {}))  # which JSON leaves out by default
    own.setdefault("points", {})
    for one in (own, written):
        one["work"].pop("seconds")
    assert own == written
    told = [*leaves(written)]
    assert {".".join(keys) for keys, _ in told} == {*study.paths()}
    for keys, value in told:
        signal = study[".".join(keys)]
        there = np.array(value, dtype=np.float64)  # null is nan
        assert np.array_equal(signal.computed, there, equal_nan=True), keys
        assert len(signal.components) == np.prod(there.shape[signal.times is not None :])
        lost = np.isnan(signal.values) & ~np.isnan(there)
        assert not (lost & ~signal.beyond.reshape(-1, *[1] * (lost.ndim - signal.beyond.ndim))).any()


@pytest.mark.heavy
@pytest.mark.parametrize("name", TABLES)
@pytest.mark.third
def test_tables_are_those_of_the_command(heun: Heun, name: str) -> None:
    path = SPECS / f"{name}.yaml"
    printed = heun("run", str(path)).stdout
    study = solved(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", heuncli.HeunWarning)
        assert str(study) == printed
        own, of_joints = study.tables(units="kN,mm", only="joints"), ("--units", "kN,mm", "--only", "joints")
    # the heading tells how well all that was solved for is known
    assert own.partition("\n\n")[2] == heun("run", str(path), *of_joints).stdout.partition("\n\n")[2]


@pytest.mark.heavy
def test_measures_are_those_of_the_command(heun: Heun) -> None:
    asked = {
        "engine": (
            "max abs joints.main.force",
            "at 0.0123 energy.kinetic",
            "final joints.big.force.y",
            "model.freedoms",
        ),
        "overhang": ("max abs sections.beam.M2", "min sections.beam.Q1"),
        "struck_door": ("max abs impulses.0.joints.low.force", "impulses.0.energy_jump"),
    }
    for name, words in asked.items():
        path = str(SPECS / f"{name}.yaml")
        study = solved(Path(path))
        options = [part for word in words for part in ("--measure", word)]
        for word, block in zip(words, json.loads(heun("run", path, "--format", "json", *options).stdout), strict=True):
            found = study.measure(word)
            assert (float(found), found.at, found.s, found.side, found.cut) == (
                block["value"], block["at"], block.get("s"), block.get("side"), block.get("cut"),
            ), word  # fmt: skip


@pytest.mark.heavy
def test_collectives_and_load_cases_are_those_of_the_command(heun: Heun) -> None:
    path = SPECS / "engine.yaml"
    study = solved(path)
    words = ("--collective", "joints.main.force.y", "--slope", "5", "--format", "json")
    (block,) = json.loads(heun("run", str(path), *words).stdout)["collectives"].values()
    found = study.collective("joints.main.force.y", slopes=5)
    assert block["cycles"] == found.total_cycles and block["equivalent"][0]["range"] == found.equivalents[0].range
    cases = study.load_cases("rod", at="peak:joints.big.force,0.01").cases
    assert cases[1].time == 0.01 and cases[0].time == study["joints.big.force"].largest().at
    force = sum(action.force for action in cases[1].actions if action.name == "big")
    rotation = study["bodies.rod.rotation"].at(0.01)
    assert np.abs(rotation @ force) == pytest.approx(np.abs(study["joints.big.force"].at(0.01)), abs=1e-6)
    with pytest.raises(heuncli.UsageError, match="expected crank, rod, piston"):
        study.load_cases("rood", at=0)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
@pytest.mark.third
def test_errors_are_those_of_the_command(heun: Heun, path: Path) -> None:
    kind, code, _, _, _, name, value = head(path).groups()
    written = heun("run", str(path), *(["--set", f"{name}={value}"] if name else []))
    if kind == "warning" or written.returncode == 0 or name:
        return
    with pytest.raises(heuncli.HeunError) as caught, warnings.catch_warnings():
        warnings.simplefilter("ignore", heuncli.HeunWarning)
        heuncli.solve(path)
    assert caught.value.exit_code == written.returncode
    problems = caught.value.problems
    assert [str(problem) for problem in problems] == _told(written.stderr, len(problems))
    assert code in {problem.code for problem in problems}
    assert all(problem.hint for problem in problems)


def _told(stderr: str, count: int) -> list[str]:
    """The problems that stand on standard error: two lines each, behind the warnings."""
    lines = [line for line in stderr.splitlines() if not line.startswith("warning:")]
    return ["\n".join(lines[2 * i : 2 * i + 2]).removeprefix("heun: ") for i in range(count)]


def test_warnings_are_those_of_the_command(heun: Heun) -> None:
    """They are told as they come, at the line that asked; and stay in a list."""
    path = SPECS / "flat_four_bar.yaml"
    written = heun("run", str(path)).stderr
    with pytest.warns(heuncli.HeunWarning) as caught:
        study = heuncli.solve(path)
        before = [*study.warnings]
        str(study)
    assert [str(one.message) for one in caught] == study.warnings
    assert len(study.warnings) > len(before)
    assert {Path(one.filename) for one in caught} == {Path(__file__)}
    assert [line.removeprefix("warning: heun: ") for line in written.splitlines()] == study.warnings


WORDS = {"joints.elbow": "Elbow bearing", "joints.elbow.force.x": "side load"}
CAPTIONED = ("--title", "Two bars", *(word for path, text in WORDS.items() for word in ("--label", f"{path}={text}")))


def test_titles_and_labels_are_those_of_the_command(heun: Heun) -> None:
    spec = SPECS / "double.yaml"
    study = solved(spec, title="Two bars", labels=WORDS)
    assert study.title == "Two bars"
    assert str(study) == heun("run", str(spec), *CAPTIONED).stdout
    assert "Elbow bearing" in str(study) and "Elbow bearing" not in str(solved(spec))


def test_a_diagram_has_its_own_title_and_labels(heun: Heun, folder: Path) -> None:
    spec, paths = SPECS / "double.yaml", ("joints.elbow.force", "joints.pivot.force")
    heun("plot", str(spec), *paths, "-q", "-o", str(folder / "x.svg"), *CAPTIONED)
    study = solved(spec)
    assert study.plot(*paths, title="Two bars", labels=WORDS).svg == (folder / "x.svg").read_text(encoding="utf-8")
    assert "Elbow bearing" not in study.plot(*paths).svg  # the study itself keeps the words of its spec


def test_labels_of_cases_and_their_titles(folder: Path) -> None:
    cases = heuncli.solve_cases(SPECS / "axle_loads.yaml", title="Axles", labels={"joints.front": "Front axle"})
    assert len(cases) > 1 and all(study.title.startswith("Axles") for study in cases.values())
    assert all("Front axle" in study.tables() for study in cases.values())


@pytest.mark.parametrize(
    "solve",
    [heuncli.solve, heuncli.solve_cases, lambda spec, **words: solved(spec).plot("joints.elbow.force", **words)],
)
def test_wrong_labels_are_told_at_once(solve: Any) -> None:
    spec = SPECS / ("axle_loads.yaml" if solve is heuncli.solve_cases else "double.yaml")
    with pytest.raises(heuncli.UsageError) as told:
        solve(spec, title="a\nb", labels={"joints.elbo": "x", "joints": "y\x1b"})
    assert [problem.message.partition(":")[0] for problem in told.value.problems][:2] == ["title", "labels joints.elbo"]
    for labels in ({"joints.elbow": 3}, ["joints.elbow"]):
        with pytest.raises(heuncli.UsageError, match="labels: expected a mapping of paths to strings"):
            solve(spec, labels=labels)
