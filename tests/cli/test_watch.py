"""`heun run --watch`: again at each save, errors until they are mended, tables too; an interrupt leaves with 130."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from heuncli.app.commands.run.command import read_state
from tests.shared.command import HANGING, Heun

TABLED = (
    HANGING
    + 'tables: {push: {file: t.csv}}\nforces: {p: {type: force, on: bar.top, vector: ["table(push, 0)", 0, 0]}}\n'
)
WORDS = ("--measure", "foundation.force.x", "--measure", "foundation.force.z", "--watch")


class Watching:
    """A command that watches, and what it has written by now."""

    def __init__(self, folder: Path) -> None:
        self.told = folder / "told.txt"
        self.output = self.told.open("w")
        words = [sys.executable, "-u", "-m", "heuncli", "run", "scene.yaml", *WORDS]
        self.process = subprocess.Popen(words, cwd=folder, stdout=self.output, stderr=subprocess.STDOUT)

    def wait_for(self, text: str, times: int = 1) -> None:
        """Until it was written so often."""
        end = time.monotonic() + 20.0
        while self.told.read_text().count(text) < times:
            assert time.monotonic() < end, self.told.read_text()
            assert self.process.poll() is None, self.told.read_text()
            time.sleep(0.05)


@pytest.fixture
def watching(tmp_path: Path) -> Iterator[Watching]:
    (tmp_path / "t.csv").write_text("0,2\n1,2\n")
    (tmp_path / "scene.yaml").write_text(TABLED)
    one = Watching(tmp_path)
    yield one
    one.process.kill()
    one.process.wait()
    one.output.close()


def test_again_at_each_save_until_it_is_interrupted(watching: Watching, tmp_path: Path) -> None:
    spec = tmp_path / "scene.yaml"
    watching.wait_for("2.0\n-9.81")
    spec.write_text(TABLED.replace("m: 1.0", "m: 2.0"))
    watching.wait_for("-19.62")
    (tmp_path / "t.csv").write_text("0,3.5\n1,3.5\n")
    watching.wait_for("3.5\n-19.62")
    spec.write_text(TABLED.replace("type: ball", "type: bal"))
    watching.wait_for("[unknown-joint-type]")
    replaced = tmp_path / "new.yaml"
    replaced.write_text(TABLED.replace("m: 1.0", "m: 3.0"))
    spec.unlink()
    time.sleep(0.5)
    replaced.replace(spec)
    watching.wait_for("-29.43")
    watching.process.send_signal(signal.SIGINT)
    assert watching.process.wait(timeout=10) == 130
    assert "Traceback" not in watching.told.read_text()
    assert "\x1b" not in watching.told.read_text()


@pytest.mark.parametrize("words", [("hanging.yaml", "--time-limit", "3"), ("-",)])
def test_what_cannot_be_watched(heun: Heun, words: tuple[str, ...]) -> None:
    assert heun("run", *words, "--watch").returncode == 2


def test_the_watch_sees_every_file_of_a_spec(tmp_path: Path) -> None:
    spec = tmp_path / "scene.yaml"
    spec.write_text(
        HANGING + "report: {logo: logo.png}\ncases: {a: {set: {tables.gas.file: b.csv}}}\n"
        "tables: {gas: {file: a.csv}}\nexpect: [{of: x, curve: c.csv}]\n"
        "other: [{shapes: [{type: mesh, file: m.stl}]}]\n"
    )
    names = ("logo.png", "a.csv", "b.csv", "c.csv", "m.stl")
    for name in names:
        (tmp_path / name).write_text("1")
    assert {Path(state[0]).name for state in read_state(str(spec)) if state} == {"scene.yaml", *names}
