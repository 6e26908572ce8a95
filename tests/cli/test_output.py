"""Where results go: whole or not at all, and an exit code for whatever keeps them from arriving."""

from __future__ import annotations

import os
import stat
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from heuncli.app.cli import output
from heuncli.app.cli.output import emit
from heuncli.base.errors import OutputError
from heuncli.base.files import ReaderGoneError, find_target
from tests.shared.command import Heun


def test_a_file_is_written_and_keeps_its_mode(tmp_path: Path) -> None:
    target = tmp_path / "out.json"
    target.write_text("old")
    target.chmod(0o640)
    emit("neu: ω → N·m\n", str(target))
    assert target.read_text(encoding="utf-8") == "neu: ω → N·m\n"
    assert stat.S_IMODE(target.stat().st_mode) == 0o640
    assert list(tmp_path.iterdir()) == [target]


def test_a_new_file_has_the_usual_mode(tmp_path: Path) -> None:
    mask = os.umask(0o027)
    try:
        emit("x", str(tmp_path / "new"))
    finally:
        os.umask(mask)
    assert stat.S_IMODE((tmp_path / "new").stat().st_mode) == 0o640


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("old")
    (tmp_path / "link").symlink_to(tmp_path / "file")
    emit("new", str(tmp_path / "link"))
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "file").read_text() == "new"


def test_a_write_that_fails_leaves_the_old_file_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "out"
    target.write_text("old")

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OutputError, match="No space left"):
        emit("new", str(target))
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("target", ["nowhere/out", ".", "/dev/full"])
def test_what_cannot_be_written_is_an_output_error(
    target: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(OutputError) as caught:
        emit("x", target)
    assert caught.value.exit_code == 5


def test_a_pipe_is_written_straight(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    found: list[str] = []
    reader = threading.Thread(target=lambda: found.append(pipe.read_text()))
    reader.start()
    emit("through", str(pipe))
    reader.join(timeout=10)
    assert found == ["through"]
    assert pipe.is_fifo()


def loop(folder: Path) -> str:
    (folder / "a").symlink_to("b")
    (folder / "b").symlink_to("a")
    return "a"


def loop_above(folder: Path) -> str:
    return f"{loop(folder)}/out"


def gone(folder: Path) -> str:
    (folder / "gone").mkdir()
    os.chdir(folder / "gone")
    (folder / "gone").rmdir()
    return "out"


def link_to_nowhere(folder: Path) -> str:
    (folder / "link").symlink_to("nowhere/out")
    return "link"


def file_taken_for_a_folder(folder: Path) -> str:
    (folder / "file").write_text("old")
    return "file/."


def read_only(folder: Path) -> str:
    (folder / "file").write_text("old")
    return f"/dev/fd/{os.open(folder / 'file', os.O_RDONLY)}"


def fixed(name: str) -> Callable[[Path], str]:
    return lambda _: name


@pytest.mark.parametrize(
    ("named", "told"),
    [
        (loop, "Too many levels of symbolic links"),
        (loop_above, "Too many levels of symbolic links"),
        (gone, "No such file or directory"),
        (link_to_nowhere, "there is no folder .*nowhere"),
        (file_taken_for_a_folder, "this is the name of a folder"),
        (read_only, "Bad file descriptor"),
        (fixed("new/"), "this is the name of a folder"),
        (fixed("./"), "this is a folder"),
        (fixed(".."), "this is a folder"),
        (fixed("/dev/fd/987"), "Bad file descriptor"),
        (fixed("x" * 256), "File name too long"),
        (fixed("x/" * 3000), "File name too long"),
        (fixed("a\0b"), "NUL"),
        (fixed("/proc/out"), "."),
    ],
)
def test_where_nothing_can_be_written(
    named: Callable[[Path], str], told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    target = named(tmp_path)
    before = {path: path.read_text() for path in tmp_path.rglob("*") if path.is_file()}
    with pytest.raises(OutputError, match=told) as caught:
        emit("x", target)
    assert all(problem.hint for problem in caught.value.problems)
    assert before == {path: path.read_text() for path in tmp_path.rglob("*") if path.is_file()}


@pytest.mark.parametrize("name", ["x" * 255, "-o", "--", " ", "a\nb", "ü" * 127, os.fsdecode(b"\xff")])
def test_any_name_that_the_system_takes(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    emit("x", name)
    emit("y", name)
    assert (tmp_path / name).read_text() == "y"
    assert list(tmp_path.iterdir()) == [tmp_path / name]


@pytest.mark.parametrize(
    ("denied", "told"), [("file", "no permission to write the file"), ("", "no permission to write in the folder .")]
)
def test_rights_are_asked_for_before_the_work(
    denied: str, told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By what the system says of them: for its administrator nothing is denied."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("old")
    monkeypatch.setattr(os, "access", lambda path, _: Path(path) != tmp_path / denied)
    with pytest.raises(OutputError, match=told):
        find_target("file")


def test_a_file_that_another_makes_while_it_is_looked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not there at the first look, there at the next."""
    monkeypatch.setattr("heuncli.base.files._file_state", lambda name: None)
    (tmp_path / "made").write_text("by another")
    place = find_target(str(tmp_path / "made"))
    assert place.is_replaceable
    assert place.state is not None


@pytest.mark.parametrize("linked", [False, True])
def test_an_open_descriptor_is_written_where_it_stands(linked: bool, tmp_path: Path) -> None:
    """As `3> file` opens it: what was written before stays, and what comes after follows."""
    number = os.open(tmp_path / "file", os.O_WRONLY | os.O_CREAT)
    name = f"/dev/fd/{number}"
    if linked:
        (tmp_path / "link").symlink_to(name)
        name = str(tmp_path / "link")
    os.write(number, b"before ")
    emit("out", name)
    os.write(number, b" after")
    os.close(number)
    assert (tmp_path / "file").read_text() == "before out after"


def test_a_descriptor_that_takes_none_for_a_while(tmp_path: Path) -> None:
    """A pipe that does not block, as some programs hand on, and a reader that is slow."""
    out, number = os.pipe()
    os.set_blocking(number, False)
    found: list[bytes] = []

    def read() -> None:
        while part := os.read(out, 1 << 16):
            found.append(part)

    reader = threading.Thread(target=read)
    threading.Timer(0.2, reader.start).start()
    emit("x" * 300_000, f"/dev/fd/{number}")
    os.close(number)
    while not reader.ident:
        pass
    reader.join(timeout=10)
    assert b"".join(found) == b"x" * 300_000
    os.close(out)


def test_a_reader_of_a_pipe_that_goes_away(tmp_path: Path) -> None:
    out, number = os.pipe()
    os.close(out)
    with pytest.raises(ReaderGoneError):
        emit("x", f"/dev/fd/{number}")
    os.close(number)


@pytest.mark.parametrize(
    "words", ["run {} -o o.json", "model {} -o o.txt", "chart {} -o o.json --save a.svg", "check {} -o o"]
)
def test_a_folder_that_is_gone_is_5(words: str, folder: Path, heun: Heun) -> None:
    gone(folder)
    done = heun(*(word.format(folder / "hanging.yaml") for word in words.split()))
    assert (done.returncode, done.stdout) == (5, "") and "No such file or directory" in done.stderr


def test_output_that_nobody_reads_leaves_no_file_open() -> None:
    """The limit passes between the last piece and the first that is written."""
    pieces = output._collect(["a", "b"])
    store = pieces.gi_frame.f_locals["store"]  # type: ignore[attr-defined]
    del pieces
    assert store.closed
    assert "".join(output._collect(["a", "b"])) == "ab"
