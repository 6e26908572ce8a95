"""Golden files: what two honest runs differ by passes, three times of it fails; files that cannot be used; writing."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from heuncli.base import files
from heuncli.output.snapshots.changes import find_changes
from heuncli.output.snapshots.golden_file import NumberSnapshot, RunSnapshot, format_golden_file, read_golden_file
from heuncli.output.snapshots.take_snapshot import take_run_snapshot
from heuncli.output.tables.report_selection import find_default_reports
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve
from tests.shared.command import Heun
from tests.shared.folders import ROOT

WORDS = ("first", "last", "least", "greatest", "constant")


@cache
def run_of(name: str, **options: Any) -> RunSnapshot:
    """The numbers of a spec of specs/; not to be changed, they are those of all tests."""
    spec = load(str(ROOT / "specs" / f"{name}.yaml"))
    wanted = find_default_reports(spec)
    return take_run_snapshot(solve(spec, Options(requested_reports=wanted, **options)), wanted)


def moved(number: NumberSnapshot, share: float) -> dict[str, NumberSnapshot]:
    """The number with each of its words in turn moved by a share of what two runs of its error may differ by."""
    others: dict[str, NumberSnapshot] = {}
    if number.error == 0.0:
        return others
    for word in WORDS:
        value = getattr(number, word)
        if isinstance(value, float):
            shift = share * 2.0 * number.error + (2.0**-50 * abs(value) if share > 1.0 else 0.0)
            others[word] = number.model_copy(update={word: value + shift})
    for i, value in enumerate(number.tenths):
        if isinstance(value, float):
            shift = share * 2.0 * number.error + (2.0**-46 * abs(value) if share > 1.0 else 0.0)
            tenths = [*number.tenths[:i], value + shift, *number.tenths[i + 1 :]]
            others[f"tenth {i}"] = number.model_copy(update={"tenths": tenths})
    for word in ("mean", "moment"):
        if (value := getattr(number, word)) is not None and number.mean_error is not None:
            others[word] = number.model_copy(update={word: value + share * 2.0 * (number.error + number.mean_error)})
    for i, value in enumerate(number.even[:-1]):
        if isinstance(value, float):
            even = [*number.even[:i], value + share * 2.0 * number.error, *number.even[i + 1 :]]
            others[f"even {i}"] = number.model_copy(update={"even": even})
    return others


def all_moved(run: RunSnapshot, share: float) -> Iterator[tuple[str, list[str], RunSnapshot]]:
    """A word, the paths that have it, and the run with that word of all of them moved."""
    others = {path: moved(number, share) for path, number in run.numbers.items()}
    for word in sorted({word for words in others.values() for word in words}):
        numbers = {path: words[word] for path, words in others.items() if word in words}
        yield word, sorted(numbers), run.model_copy(update={"numbers": run.numbers | numbers})


def with_number(run: RunSnapshot, path: str, number: NumberSnapshot) -> RunSnapshot:
    return run.model_copy(update={"numbers": run.numbers | {path: number}})


@pytest.mark.heavy  # of numbers that are there
@pytest.mark.parametrize("name", ["double", "crankshaft", "hammered_four_bar"])
def test_each_number_moved_by_three_times_what_is_allowed_fails(name: str) -> None:
    run = run_of(name)
    for word, paths, other in all_moved(run, 3.0):
        assert paths and [change.path for change in find_changes(run, other)] == paths, word


@pytest.mark.heavy  # of numbers that are there
@pytest.mark.parametrize("name", ["double", "crankshaft", "hammered_four_bar"])
def test_each_number_moved_by_a_third_of_what_is_allowed_passes(name: str) -> None:
    run = run_of(name)
    for word, _, other in all_moved(run, 0.3):
        assert find_changes(run, other) == [], word


@pytest.mark.heavy  # of numbers
@pytest.mark.parametrize("name", ["double", "slider_crank", "hammered_four_bar", "four_bar"])
def test_a_run_of_the_whole_scene_passes(name: str) -> None:
    """Two models of one scene differ by no more than both state."""
    assert [
        change for change in find_changes(run_of(name), run_of(name, reduce=False)) if "model." not in change.path
    ] == []


@pytest.mark.heavy
def test_what_one_of_them_lacks_is_told_by_name() -> None:
    run = run_of("double")
    path = next(path for path, number in run.numbers.items() if number.greatest is not None)
    others = {
        "missing": run.model_copy(update={"numbers": {k: v for k, v in run.numbers.items() if k != path}}),
        "now open": with_number(run, path, run.numbers[path].model_copy(update={"greatest": "open"})),
        "past the horizon": with_number(run, path, run.numbers[path].model_copy(update={"last": "beyond"})),
        "became open": run.model_copy(update={"open": [*run.open, path]}),
    }
    for word, other in others.items():
        (change,) = find_changes(run, other)
        assert change.path == path
        assert word in change.reason
        (back,) = find_changes(other, run)
        assert back.path == path
    assert "model.freedoms" in {
        c.path for c in find_changes(run, run.model_copy(update={"model": run.model | {"freedoms": 9}}))
    }


def test_a_file_reads_back_as_it_was_and_has_one_number_a_line(heun: Heun, folder: Path) -> None:
    assert heun("check", "swinging.yaml", "--golden", "g", "--update", "--force").returncode == 0
    text = (folder / "g" / "swinging.json").read_text()
    assert format_golden_file(read_golden_file(text)) == text
    assert all(line.count(",") <= 1 for line in text.splitlines())
    assert json.dumps(json.loads(text), indent=1, sort_keys=True, ensure_ascii=False) + "\n" == text


@pytest.mark.heavy
def test_what_was_kept_passes_and_what_changed_fails_with_the_change_of_the_spec(heun: Heun, folder: Path) -> None:
    assert heun("check", "hanging.yaml", "swinging.yaml", "--golden", "g", "--update", "--force").returncode == 0
    assert heun("check", "hanging.yaml", "swinging.yaml", "--golden", "g").returncode == 0
    spec = folder / "hanging.yaml"
    spec.write_text(spec.read_text().replace("m: 1.0", "m: 1.001"))
    done = heun("check", "hanging.yaml", "swinging.yaml", "--golden", "g")
    assert done.returncode == 1
    assert "the spec changed since it was written" in done.stdout
    assert "+0.1 %" in done.stdout
    assert heun("check", "hanging.yaml", "--golden", "g", "--golden-tolerance", "0.01").returncode == 0


def test_update_writes_only_what_left_its_bounds_and_tells_what_changed(heun: Heun, folder: Path) -> None:
    heun("check", "hanging.yaml", "swinging.yaml", "--golden", "g", "--update", "--force")
    before = {path.name: path.stat().st_mtime_ns for path in (folder / "g").iterdir()}
    spec = folder / "hanging.yaml"
    spec.write_text(spec.read_text().replace("m: 1.0", "m: 2.0"))
    done = heun("check", "hanging.yaml", "swinging.yaml", "--golden", "g", "--update", "--force")
    assert done.returncode == 0
    assert "CHANGED" in done.stdout
    after = {path.name: path.stat().st_mtime_ns for path in (folder / "g").iterdir()}
    assert {name for name in after if after[name] != before[name]} == {"hanging.json"}


def test_a_pipeline_does_not_approve_itself(heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CI", "true")
    done = heun("check", "hanging.yaml", "--golden", "g", "--update")
    assert (done.returncode, (folder / "g").exists()) == (2, False)
    monkeypatch.setenv("CI", "false")
    assert heun("check", "hanging.yaml", "--golden", "g", "--update").returncode == 0


def test_a_golden_file_without_a_spec_and_a_spec_without_one(heun: Heun, folder: Path) -> None:
    (folder / "specs").mkdir()
    (folder / "hanging.yaml").rename(folder / "specs" / "hanging.yaml")
    (folder / "g").mkdir()
    (folder / "g" / "old.json").write_text("{}")
    done = heun("check", "specs", "--golden", "g")
    assert done.returncode == 0
    assert "1 spec without a golden file" in done.stdout
    assert "warning: specs/hanging.yaml: no golden file: --update writes it" in done.stderr
    assert "g/old.json: a golden file without a spec" in done.stderr
    strict = heun("check", "specs", "--golden", "g", "--strict")
    assert strict.returncode == 1
    assert "no golden file" in strict.stdout


def cut_off(text: str) -> str:
    return text[: len(text) // 2]


def of_another_format(text: str) -> str:
    return text.replace('"format": 2', '"format": 3')


def of_another_spec(text: str) -> str:
    return text.replace('"path": "hanging.yaml"', '"path": "other.yaml"')


@pytest.mark.heavy
@pytest.mark.parametrize(
    ("spoilt", "told"),
    [
        (lambda text: "hello", "not valid JSON"), (cut_off, "the file is incomplete"),
        (lambda text: "[1]", "no golden file"), (of_another_format, "this version reads 1 and 2"),
        (of_another_spec, "golden file of another spec: other.yaml"),
        (lambda text: text.replace('"status"', '"stat"'), "base.sta"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("update", [False, True])
@pytest.mark.third
def test_a_file_that_cannot_be_used_is_told_and_nothing_is_written(
    heun: Heun, folder: Path, spoilt: Any, told: str, update: bool
) -> None:
    heun("check", "hanging.yaml", "swinging.yaml", "--golden", "g", "--update", "--force")
    file, other = folder / "g" / "hanging.json", folder / "g" / "swinging.json"
    file.write_text(spoilt(file.read_text()))
    other.unlink()
    before = file.read_bytes()
    done = heun("check", "hanging.yaml", "swinging.yaml", "--golden", "g", *(["--update", "--force"] if update else []))
    assert done.returncode == 2
    assert "g/hanging.json:1:1: " in done.stderr
    assert told in done.stderr
    assert (file.read_bytes(), other.exists()) == (before, False)


def test_a_folder_or_a_way_out_in_the_place_of_a_file(heun: Heun, folder: Path, tmp_path_factory: Any) -> None:
    outside = tmp_path_factory.mktemp("outside") / "hanging.json"
    outside.write_text("{}")
    (folder / "g" / "swinging.json").mkdir(parents=True)
    (folder / "g" / "hanging.json").symlink_to(outside)
    done = heun("check", "hanging.yaml", "swinging.yaml", "--golden", "g", "--update", "--force")
    assert done.returncode == 2
    assert "this is a folder" in done.stderr
    assert "this link leads out of g" in done.stderr
    assert outside.read_text() == "{}"


def test_a_full_disk_leaves_what_was_there(heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    heun("check", "hanging.yaml", "--golden", "g", "--update", "--force")
    file = folder / "g" / "hanging.json"
    before = file.read_bytes()
    spec = folder / "hanging.yaml"
    spec.write_text(spec.read_text().replace("m: 1.0", "m: 2.0"))

    def full(*_: object, **__: object) -> int:
        raise OSError(28, os.strerror(28))

    monkeypatch.setattr(files.os, "fsync", full)
    monkeypatch.setattr(files.os, "write", full)
    done = heun("check", "hanging.yaml", "--golden", "g", "--update", "--force")
    assert (done.returncode, "[output-failed]" in done.stderr) == (5, True)
    assert file.read_bytes() == before
    assert [path.name for path in (folder / "g").iterdir()] == ["hanging.json"]
    assert heun("check", "swinging.yaml", "--golden", "new/deep", "--update", "--force").returncode == 5
    assert not (folder / "new").exists()


def without_courses(text: str) -> str:
    """A golden file as format 1 has it: ends, extremes and even instants alone."""
    data = json.loads(text)
    data["format"] = 1
    later = ("tenths", "mean_square", "mean", "moment", "mean_error", "least_at_error", "greatest_at_error")
    for number in data["base"]["numbers"].values():
        for word in later:
            number.pop(word, None)
    return json.dumps(data, indent=1, sort_keys=True)


@pytest.mark.heavy
def test_a_file_of_format_1_is_read_passes_and_is_renewed(heun: Heun, folder: Path) -> None:
    heun("check", "swinging.yaml", "--golden", "g", "--update", "--force")
    file = folder / "g" / "swinging.json"
    whole = file.read_text()
    file.write_text(without_courses(whole))
    done = heun("check", "swinging.yaml", "--golden", "g")
    assert done.returncode == 0
    assert "written by an earlier version without mean values" in done.stderr
    assert "--update renews it" in heun("diff", "swinging.yaml", "g/swinging.json").stdout
    assert heun("check", "swinging.yaml", "--golden", "g", "--update", "--force").returncode == 0
    assert file.read_text() == whole


@pytest.mark.heavy
def test_a_spec_that_changed_without_a_number_is_said_and_renewed(heun: Heun, folder: Path) -> None:
    heun("check", "swinging.yaml", "--golden", "g", "--update", "--force")
    spec, file = folder / "swinging.yaml", folder / "g" / "swinging.json"
    numbers = json.loads(file.read_text())["base"]
    spec.write_text(spec.read_text() + "# another line\n")
    done = heun("check", "swinging.yaml", "--golden", "g")
    assert (done.returncode, "the spec changed since it was written, but no number left its bounds" in done.stderr) == (
        0,
        True,
    )
    assert "the spec files differ" in heun("diff", "swinging.yaml", "g/swinging.json").stdout
    heun("check", "swinging.yaml", "--golden", "g", "--update", "--force")
    assert json.loads(file.read_text())["base"] == numbers
    assert heun("check", "swinging.yaml", "--golden", "g").stderr == ""


@pytest.mark.heavy  # the compiled one keeps
@pytest.mark.parametrize("name", ["double", "slider_crank", "hammered_four_bar"])
@pytest.mark.third
def test_the_plain_kernel_passes_what_the_compiled_one_kept(heun: Heun, folder: Path, name: str) -> None:
    spec = str(ROOT / "specs" / f"{name}.yaml")
    assert heun("check", spec, "--golden", "g", "--update", "--force").returncode == 0
    env = {**os.environ, "HEUN_KERNEL": "pure"}
    words = [sys.executable, "-m", "heuncli", "check", spec, "--golden", "g"]
    done = subprocess.run(words, cwd=folder, env=env, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
