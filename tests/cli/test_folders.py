"""`heun check` over folders that cannot be looked into, lead in circles, or are nested without end."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from heuncli.app.commands.check.spec_files import FoundSpec, SkippedFolder, find_specs
from tests.shared.command import SPEC_TEXTS, Heun

EXPECTING = SPEC_TEXTS["expecting"]


@pytest.fixture
def specs(folder: Path) -> Path:
    """A folder with a spec and two folders in it."""
    specs = folder / "specs"
    for name in ("a", "b"):
        (specs / name).mkdir(parents=True)
        (specs / name / "spec.yaml").write_text(EXPECTING)
    (specs / "spec.yaml").write_text(EXPECTING)
    return specs


@pytest.fixture
def closed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Folders named a may not be looked into: root, who runs tests, may look into all."""
    look = os.scandir

    def scandir(path: str) -> Iterator[os.DirEntry[str]]:
        if Path(path).name == "a":
            raise PermissionError(13, "Permission denied")
        return look(path)

    monkeypatch.setattr(os, "scandir", scandir)


@pytest.mark.usefixtures("specs", "closed")
def test_a_closed_folder_is_told_and_the_rest_is_checked(heun: Heun) -> None:
    done = heun("check", "specs", "--format", "json")
    assert done.returncode == 2
    assert "specs/a:1:1: the folder cannot be read: Permission denied [unreadable]" in done.stderr
    cases = json.loads(done.stdout)["cases"]
    assert [(case["file"], case["passed"]) for case in cases] == [
        ("specs/a", False), ("specs/b/spec.yaml", True), ("specs/spec.yaml", True),
    ]  # fmt: skip


@pytest.mark.usefixtures("specs", "closed")
def test_a_closed_folder_alone(heun: Heun) -> None:
    done = heun("check", "specs/a")
    assert (done.returncode, done.stdout) == (2, "")
    assert "Permission denied [unreadable]" in done.stderr


def test_links_in_a_circle_end(heun: Heun, specs: Path) -> None:
    for name in ("a", "b"):
        (specs / name / "up").symlink_to("..")
        (specs / name / "again").symlink_to("../b")
    (specs / "itself").symlink_to("itself")
    (specs / "itself.yaml").symlink_to("itself.yaml")
    done = heun("check", "specs")
    assert done.returncode == 2
    assert "specs/a/up skipped: same folder as specs" in done.stderr
    assert "specs/itself.yaml:1:1: its links form a loop [unreadable]" in done.stderr
    assert "4 specs, 3 checks passed, 0 failed, 1 spec not solved" in done.stdout


def test_folders_that_meet_again_and_again_are_looked_into_once(tmp_path: Path) -> None:
    for i in range(40):  # 2**40 ways to the last one
        (tmp_path / f"level{i}").mkdir()
        (tmp_path / f"level{i}" / "left").symlink_to(f"../level{i + 1}")
        (tmp_path / f"level{i}" / "right").symlink_to(f"../level{i + 1}")
    (tmp_path / "level40").mkdir()
    (tmp_path / "level40" / "spec.yaml").touch()
    passed_by: list[SkippedFolder] = []
    assert len(list(find_specs(str(tmp_path / "level0"), passed_by))) == 1
    assert len(passed_by) == 40


@pytest.mark.heavy
def test_eleven_hundred_nested_folders(heun: Heun, folder: Path) -> None:
    names = ["nested", *"x" * 1100]
    for name in names:
        Path(name).mkdir()
        os.chdir(name)
    Path("spec.yaml").write_text(EXPECTING)
    os.chdir(folder)
    done = heun("check", "nested")
    os.chdir("/".join(names))  # taken away again: what clears up after tests goes by recursion
    Path("spec.yaml").unlink()
    for name in reversed(names):
        os.chdir("..")
        Path(name).rmdir()
    assert done.stdout == "1 spec, 1 check passed, 0 failed\n"


def test_folders_beyond_the_longest_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for _ in range(30):
        Path("x" * 200).mkdir()
        os.chdir("x" * 200)
    os.chdir(tmp_path)
    (found,) = find_specs(".", [])
    assert found.problem is not None
    assert "File name too long" in found.problem.message


@pytest.mark.parametrize("name", ["none", "x" * 300, "file/x", "a\0b", "", "-"])
def test_what_is_no_folder_is_a_file_to_be_told_of(name: str) -> None:
    assert list(find_specs(name, [])) == [FoundSpec(name)]
