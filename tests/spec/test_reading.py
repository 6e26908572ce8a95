"""What is opened for reading: files, pipes and devices, up to a limit."""

from __future__ import annotations

import io
import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from heuncli.base.errors import Finding, SpecError
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.reading import read_bytes

SPEC = "heun: 1\nbodies: {ball: {mass: 1, center: [0, 0, 0], inertia: [0, 0, 0]}}\n"
MOST = 1000


def refusal(path: str, most: int = MOST) -> tuple[str, str]:
    with pytest.raises(Finding) as caught:
        read_bytes(path, most)
    return caught.value.code, caught.value.message


@pytest.mark.parametrize("device", ["/dev/zero", "/dev/random", "/dev/full"])
def test_devices_that_never_end_are_refused_unread(device: str) -> None:
    assert refusal(device) == ("unreadable", "this is a device, not a file")


def test_the_null_device_is_empty() -> None:
    assert read_bytes(os.devnull, MOST) == b""


def test_a_file_beyond_the_limit_is_refused_by_its_size(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with (tmp_path / "large").open("wb") as file:
        file.truncate(1_000_000_000)
    monkeypatch.setattr("heuncli.scene.file_format.reading._read_limited", None)  # it is not read
    code, message = refusal(str(tmp_path / "large"), 64_000_000)
    assert (code, message) == ("too-large", "the file has 1000 MB; at most 64 MB are read")


@pytest.mark.parametrize(("size", "fits"), [(MOST, True), (MOST + 1, False)])
def test_the_limit_itself_is_read(size: int, fits: bool, tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"x" * size)
    if fits:
        assert len(read_bytes(str(tmp_path / "file"), MOST)) == size
    else:
        assert refusal(str(tmp_path / "file"))[0] == "too-large"


def test_pipes_are_read_to_their_end_or_to_the_limit(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)

    def write(content: bytes) -> threading.Thread:
        writer = threading.Thread(target=lambda: pipe.write_bytes(content), daemon=True)
        writer.start()
        return writer

    write(b"abc" * 100).join(0.0)
    assert read_bytes(str(pipe), MOST) == b"abc" * 100
    writer = write(b"abc" * 1000)
    assert refusal(str(pipe)) == ("too-large", "the file has more than 0.001 MB; at most 0.001 MB are read")
    writer.join(10.0)


def test_an_open_file_has_a_name(tmp_path: Path) -> None:
    (tmp_path / "spec.yaml").write_text(SPEC)
    with (tmp_path / "spec.yaml").open() as file:
        assert set(load(f"/dev/fd/{file.fileno()}").bodies) == {"ball"}


def test_standard_input_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"x" * (MOST + 1))))
    assert refusal("-")[0] == "too-large"


def test_a_closed_standard_input_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", None)
    assert refusal("-") == ("unreadable", "standard input is closed")
    with pytest.raises(SpecError) as caught:
        load("-")
    assert caught.value.exit_code == 2


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("loop", "links form a loop"),
        ("file/x", "not a folder"),
        ("x" * 300, "too long"),
        ("a\0b", "cannot be the name"),
        ("\ud800", "cannot be the name"),
        ("none", "file not found"),
        (".", "a folder"),
    ],
)
def test_what_cannot_be_opened_is_a_word(
    name: str, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("loop").symlink_to("loop")
    Path("file").touch()
    code, message = refusal(name)
    assert code == "unreadable"
    assert words in message


def test_a_folder_that_is_gone(tmp_path: Path) -> None:
    code = (
        "import os, sys\nos.mkdir('gone')\nos.chdir('gone')\nos.rmdir('../gone')\n"
        "from heuncli.app.cli.entry import enter\nsys.exit(enter(['run', 'spec.yaml']))"
    )
    path = str(Path(__file__).parents[2])  # and no empty one: NumPy cannot be imported by way of a folder that is gone
    run = subprocess.run([sys.executable, "-P", "-c", code], cwd=tmp_path, env={**os.environ, "PYTHONPATH": path},
                         capture_output=True, text=True, check=False)  # fmt: skip
    assert run.returncode == 2
    assert "file not found" in run.stderr


@pytest.mark.parametrize(
    ("file", "code", "words"),
    [
        ("/dev/zero", "table-file", "a device"),
        ("loop.csv", "table-file", "form a loop"),
        ("large.csv", "too-large", "at most 200 MB"),
        ("'a\\0b'", "table-file", "file not found"),
        ('"a\\0b"', "table-file", "cannot be the name"),
    ],
)
def test_tables_are_read_by_the_same_rule(file: str, code: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "loop.csv").symlink_to("loop.csv")
    with (tmp_path / "large.csv").open("wb") as large:
        large.truncate(1_000_000_000)
    text = f"{SPEC}tables: {{f: {{file: {file}}}}}\n"
    with pytest.raises(SpecError) as caught:
        load(tmp_path / "spec.yaml", text)
    (problem,) = caught.value.problems
    assert problem.code == code
    assert words in problem.message


@pytest.mark.parametrize(
    ("file", "told"),
    [
        ("in.csv", None),
        ("below/in.csv", None),
        ("../specs/in.csv", None),
        ("inner.csv", None),
        ("../out.csv", "../out.csv"),
        ("ABSOLUTE/out.csv", "ABSOLUTE/out.csv"),
        ("link.csv", "link.csv, which is ABSOLUTE/out.csv"),
        ("linked/out.csv", "linked/out.csv, which is ABSOLUTE/out.csv"),
    ],
)
@pytest.mark.parametrize("path", ["specs/spec.yaml", "spec.yaml", "-"])
def test_tables_outside_the_specs_folder_are_warned_of(
    path: str, file: str, told: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tmp_path = tmp_path.resolve()
    home = tmp_path / "specs"
    (home / "below").mkdir(parents=True)
    for name in ("out.csv", "specs/in.csv", "specs/below/in.csv"):
        (tmp_path / name).write_text("0,1\n1,2\n")
    (home / "link.csv").symlink_to("../out.csv")
    (home / "linked").symlink_to("..")
    (home / "inner.csv").symlink_to("below/in.csv")
    monkeypatch.chdir(tmp_path if path.startswith("specs") else home)
    spec = load(path, f"{SPEC}tables: {{f: {{file: {file.replace('ABSOLUTE', str(tmp_path))}}}}}\n")
    message = f"reads a file outside the spec's folder: {told}".replace("ABSOLUTE", str(tmp_path))
    found = [(problem.code, problem.message) for problem in spec.warnings]
    assert found == ([("outside-folder", message)] if told else [])
    assert all(problem.location and problem.location.path == "tables.f.file" for problem in spec.warnings)
