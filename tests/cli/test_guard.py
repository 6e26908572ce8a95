"""What a command reads it never writes over, by whatever name."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from heuncli.app.cli.entry import enter
from tests.shared.command import HANGING, Heun

TABLE = "tables: {g: {file: data/t.csv, x: 1, y: 2}}\n"
WRITERS = (
    ("run", "-o"), ("model", "-o"), ("check", "-o"), ("check", "--junit"), ("modes", "-o"), ("probe", "-o"),
    ("chart", "-o"), ("chart", "--save"), ("balance", "-o"), ("balance", "--save"),
)  # fmt: skip


def plainly(path: Path) -> str:
    return str(path)


def roundabout(path: Path) -> str:
    return f"{path.parent}/../{path.parent.name}/./{path.name}"


def linked(path: Path) -> str:
    (path.parent / "link.svg").symlink_to(path)
    return str(path.parent / "link.svg")


def twice_linked(path: Path) -> str:
    (path.parent / "first").symlink_to(path.name)
    (path.parent / "second.svg").symlink_to("first")
    return str(path.parent / "second.svg")


def hard_linked(path: Path) -> str:
    os.link(path, path.parent / "hard.svg")
    return str(path.parent / "hard.svg")


def opened(path: Path) -> str:
    return f"/dev/fd/{os.open(path, os.O_RDWR)}"


@pytest.fixture
def scene(folder: Path) -> Path:
    """A spec, and the table it reads."""
    (folder / "data").mkdir()
    (folder / "data" / "t.csv").write_text("0,0\n1,1\n")
    (folder / "scene.yaml").write_text(HANGING + TABLE + "analysis: {duration: 0.1, samples: 3}\n")
    return folder


@pytest.mark.parametrize("named", [plainly, roundabout, linked, twice_linked, hard_linked, opened])
@pytest.mark.parametrize("read", ["scene.yaml", "data/t.csv"])
@pytest.mark.parametrize("writer", WRITERS, ids=" ".join)
def test_what_is_read_stays(
    scene: Path, heun: Heun, monkeypatch: pytest.MonkeyPatch, writer: tuple[str, str], read: str,
    named: Callable[[Path], str],
) -> None:  # fmt: skip
    """Refused before anything is solved."""
    for solving in ("run.scene.solve_spec", "check.checking.solve"):
        monkeypatch.setattr(f"heuncli.app.commands.{solving}", None)
    before, inode = (scene / read).read_bytes(), (scene / read).stat().st_ino
    form = () if writer[1] != "-o" else ("--format", "json")
    done = heun(writer[0], "scene.yaml", writer[1], named(scene / read), *form)
    assert (done.returncode, done.stdout) == (2, "")
    assert "[bad-option]" in done.stderr
    assert ((scene / read).read_bytes(), (scene / read).stat().st_ino) == (before, inode)


@pytest.mark.parametrize("command", ["run", "model", "check", "modes", "probe", "chart", "balance", "validate"])
def test_standard_output_at_the_end_of_the_spec(
    scene: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], command: str
) -> None:
    """`heun run scene.yaml >> scene.yaml`, and its table likewise."""
    monkeypatch.chdir(scene)
    for read, words in (("scene.yaml", "the spec itself"), ("data/t.csv", "a table of the spec")):
        before = (scene / read).read_bytes()
        with (scene / read).open("a") as end:
            monkeypatch.setattr(sys, "stdout", end)
            assert enter([command, "scene.yaml"]) == 2
        assert f"standard output: would overwrite {words}" in capsys.readouterr().err
        assert (scene / read).read_bytes() == before


@pytest.mark.parametrize("name", ["gone/../scene.yaml", "link.yaml"])
@pytest.mark.parametrize("command", ["run", "model", "check"])
def test_a_way_through_a_folder_that_is_gone_leads_nowhere(scene: Path, heun: Heun, command: str, name: str) -> None:
    """The system finds no file there, and so no guard does; without the folder the path is that of the spec."""
    (scene / "link.yaml").symlink_to("gone/../scene.yaml")
    before = (scene / "scene.yaml").read_bytes()
    done = heun(command, "scene.yaml", "-o", name, "--format", "json")
    assert (done.returncode, done.stdout) == (5, "")
    assert "[output-failed]" in done.stderr
    assert (scene / "scene.yaml").read_bytes() == before


def test_standard_input_that_is_the_output(scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(scene)
    with (scene / "scene.yaml").open() as spec:
        monkeypatch.setattr(sys, "stdin", spec)
        assert enter(["run", "-", "-o", "scene.yaml", "--format", "json"]) == 2
    assert (scene / "scene.yaml").read_text().startswith("heun: 1")


def test_a_spec_that_is_wrong_keeps_its_table(scene: Path, heun: Heun) -> None:
    """Beside one that is fine, so that there are results to write."""
    (scene / "faulty.yaml").write_text(HANGING.replace("type: ball", "type: bal") + TABLE)
    done = heun("check", "expecting.yaml", "faulty.yaml", "-o", "data/t.csv", "--format", "json")
    assert (done.returncode, done.stdout) == (2, "")
    assert "a table of the spec" in done.stderr
    assert (scene / "data" / "t.csv").read_text() == "0,0\n1,1\n"


def test_the_next_command_may_write_what_the_last_one_read(scene: Path, heun: Heun) -> None:
    assert heun("run", "scene.yaml", "-o", "o.json").returncode == 0
    assert heun("run", "hanging.yaml", "-o", "data/t.csv").returncode == 0


def test_a_picture_goes_elsewhere_than_the_table(scene: Path, heun: Heun) -> None:
    (scene / "a.svg").write_text("")
    os.link(scene / "a.svg", scene / "b.txt")
    done = heun("chart", "scene.yaml", "--save", "a.svg", "-o", "b.txt")
    assert done.returncode == 2 and "the table is written to this file" in done.stderr
