"""What only a process of its own shows: full disks, closed outputs, readers that leave, interrupts."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from heuncli.base import programs
from tests.shared.processes import wait_until_solving
from tests.shared.shell import ENVIRONMENT, shell


def test_the_module_runs_as_the_command_does(folder: Path) -> None:
    done = shell("heun run hanging.yaml --measure joints.pivot.force.z", folder)
    assert (done.returncode, done.stderr) == (0, "unit: N\n")
    assert float(done.stdout) == pytest.approx(9.81)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no full device to write to")
@pytest.mark.parametrize("words", ["run hanging.yaml", "--help", "--version"])
def test_a_full_disk_is_5(folder: Path, words: str) -> None:
    done = shell(f"heun {words} > /dev/full", folder)
    assert done.returncode == 5
    assert done.stderr.startswith("heun: standard output: No space left on device [output-failed]\n  hint: ")


@pytest.mark.heavy
@pytest.mark.parametrize(
    ("line", "code", "kept"),
    [
        ("heun run hanging.yaml --only joints -o /dev/stdout > kept", 0, True),
        ("heun run hanging.yaml --only joints -o /dev/stderr 2> kept", 0, True),
        ("heun run hanging.yaml --only joints -o /dev/fd/3 3> kept", 0, True),
        ("heun run hanging.yaml --only joints -o >(cat > kept); wait $!", 0, True),
        ("heun run hanging.yaml --format json -o kept 2>&- >&- <&-", 0, True),
        ("heun run hanging.yaml --format json >&- 2>&- 5> kept", 5, False),
        ("heun run hanging.yaml -o /dev/stdout --format json >&-", 5, False),
        ("heun run - <&- -o kept", 2, False),
        ("heun run hanging.yaml --nosuch 2>&- > kept", 2, False),
        ("ulimit -f 1; heun run swinging.yaml --format json -o kept", 5, False),
        ("ulimit -f 1; heun run swinging.yaml --format json > kept", 5, None),
    ],
)
@pytest.mark.third
def test_wherever_it_is_told_to_go(folder: Path, line: str, code: int, kept: bool | None) -> None:
    """None: what a shell has opened may hold a part."""
    names = {path.name for path in folder.iterdir()}
    done = shell(line, folder)
    assert done.returncode == code
    assert {path.name for path in folder.iterdir()} - names <= {"kept"}
    assert kept is None or bool((folder / "kept").exists() and (folder / "kept").read_text()) == kept
    if kept:
        assert "pivot" in (folder / "kept").read_text()


def test_a_closed_output_is_5(folder: Path) -> None:
    done = shell("heun run hanging.yaml >&-", folder)
    assert done.returncode == 5
    assert "closed" in done.stderr


def test_a_reader_that_goes_away_is_141_and_silent(folder: Path) -> None:
    done = shell("heun run swinging.yaml --all | exec <&-; exit ${PIPESTATUS[0]}", folder)
    assert (done.returncode, done.stderr) == (141, "")


@pytest.mark.heavy
@pytest.mark.parametrize("form", ["json", "csv"])
def test_unbuffered_output_is_whole_or_said_not_to_be(form: str, folder: Path) -> None:
    """PYTHONUNBUFFERED makes writes that take a part only; ulimit -f counts kilobytes."""
    command = f"PYTHONUNBUFFERED=1 heun run swinging.yaml --set analysis.samples=501 --format {form}"
    whole = shell(f"{command} | wc -c; exit ${{PIPESTATUS[0]}}", folder)
    assert whole.returncode == 0 and int(whole.stdout) > 300_000
    cut = shell(f"ulimit -f 100; trap '' XFSZ; {command} > part", folder)
    assert cut.returncode == 5
    gone = shell(f"{command} | head -c 100 > /dev/null; exit ${{PIPESTATUS[0]}}", folder)
    assert (gone.returncode, gone.stderr) == (141, "")


@pytest.mark.heavy
def test_an_interrupt_is_130(folder: Path) -> None:
    command = [sys.executable, "-m", "heuncli", "run", "long.yaml"]
    with subprocess.Popen(command, cwd=folder, stdout=-1, stderr=-1, text=True, env=ENVIRONMENT) as process:
        wait_until_solving(process.pid)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
    assert (process.returncode, out, err) == (130, "", "heun: interrupted\n")


def test_who_profiles_the_process_is_waited_for() -> None:
    line = [sys.executable, "-m", "cProfile", "-m", "heuncli", "--version"]
    done = subprocess.run(line, capture_output=True, text=True, env=ENVIRONMENT, check=True)
    assert "function calls" in done.stdout


@pytest.mark.parametrize(
    ("before", "more"),
    [
        ("atexit.register(print, 'the end')", "the end\n"),
        ("class Kept: __del__ = lambda self: print('gone')\nkept = Kept()", ""),
    ],
)
def test_the_process_ends_at_once_unless_something_waits_for_that(before: str, more: str) -> None:
    code = f"import atexit, sys\n{before}\nfrom heuncli.__main__ import command\ncommand()"
    for words, expected in (("--version", 0), ("run", 2)):
        done = subprocess.run(
            [sys.executable, "-c", code, words], capture_output=True, text=True, env=ENVIRONMENT, check=False
        )
        assert done.returncode == expected
        assert done.stdout.partition("\n")[2] == more if words == "--version" else done.stdout == more


@pytest.mark.skipif(sys.platform == "win32", reason="no process groups")
def test_a_child_that_holds_the_output_ends_too(tmp_path: Path) -> None:
    _, reason = programs.run_program(["sh", "-c", "sleep 60 & echo $! > child"], str(tmp_path), 0.3)
    assert "longer than 0.3 s" in reason
    assert has_ended(tmp_path / "child")


@pytest.mark.skipif(sys.platform == "win32", reason="no process groups")
def test_a_child_ends_with_a_program_that_succeeds(tmp_path: Path) -> None:
    line = "sleep 60 > /dev/null 2>&1 & echo $! > child; echo done"
    assert programs.run_program(["sh", "-c", line], str(tmp_path), 10.0) == (b"done\n", "")
    assert has_ended(tmp_path / "child")


def has_ended(file: Path) -> bool:
    """Whether the process whose number stands in a file has ended, or does so within a second."""
    state = Path(f"/proc/{file.read_text().strip()}/stat")
    for _ in range(100):
        try:
            if state.read_text().split()[2] == "Z":
                return True
        except (FileNotFoundError, ProcessLookupError):
            return True
        time.sleep(0.01)
    return False
