"""A report as PDF, by the first program found: it gets the page in a folder of its own, and is ended where it hangs."""

from __future__ import annotations

import os
import stat
import sys
import time
from pathlib import Path

import pytest

from heuncli.app import reports
from heuncli.base.programs import BROWSERS
from tests.shared.command import Heun

PRINTS = """\
import sys, pathlib
target = next((a.partition("=")[2] for a in sys.argv if a.startswith("--print-to-pdf=")), sys.argv[-1])
page = sys.argv[-1] if "://" in sys.argv[-1] else sys.argv[-2]
text = pathlib.Path(page.partition("://")[2] or page).read_text()
pathlib.Path(target).write_bytes(b"%PDF-1.4 " + text.encode())
pathlib.Path("@SEEN").write_text("\\n".join(sys.argv))
"""
FAILS = "import sys; print('no display', file=sys.stderr); sys.exit(1)"
HANGS = "import time; time.sleep(60)"


@pytest.fixture
def programs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The only folder on PATH."""
    folder = tmp_path / "programs"
    folder.mkdir()
    monkeypatch.setenv("PATH", str(folder))
    return folder


def install(folder: Path, name: str, text: str) -> Path:
    """Put a program there; returns the file in which it leaves its arguments."""
    path, seen = folder / name, folder / f"{name}.seen"
    path.write_text(f"#!{sys.executable}\n{text.replace('@SEEN', str(seen))}")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return seen


@pytest.mark.parametrize("name", ["chromium", "google-chrome", "weasyprint", "wkhtmltopdf"])
def test_each_program_prints_the_page(name: str, programs: Path, heun: Heun, folder: Path) -> None:
    seen = install(programs, name, PRINTS)
    done = heun("report", "hanging.yaml", "-o", "x.pdf")
    assert done.returncode == 0, done.stderr
    written = (folder / "x.pdf").read_bytes()
    assert written.startswith(b"%PDF") and b"A bar hangs at rest" in written
    words = seen.read_text().splitlines()
    page = next(Path(word.removeprefix("file://")) for word in words if word.endswith("report.html"))
    assert not page.parent.exists()  # its folder is gone
    if name in BROWSERS:
        assert "--host-resolver-rules=MAP * ~NOTFOUND" in words


def test_no_sandbox_for_root_alone(programs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    install(programs, "chromium", PRINTS)
    for user, is_given in ((0, True), (1000, False)):
        monkeypatch.setattr(os, "geteuid", lambda user=user: user)
        assert ("--no-sandbox" in reports.find_printer().options) is is_given


def test_without_a_program_it_is_said_how(programs: Path, heun: Heun, folder: Path) -> None:
    done = heun("report", "hanging.yaml", "-o", "x.pdf")
    assert (done.returncode, done.stdout) == (5, "")
    assert "[no-pdf-printer]" in done.stderr
    assert "WeasyPrint" in done.stderr and "print it" in done.stderr
    assert not (folder / "x.pdf").exists()


def test_a_program_that_fails_leaves_no_file(programs: Path, heun: Heun, folder: Path) -> None:
    install(programs, "chromium", FAILS)
    done = heun("report", "hanging.yaml", "-o", "x.pdf")
    assert done.returncode == 5
    assert "has written no PDF: no display" in done.stderr
    assert not (folder / "x.pdf").exists()


def test_a_program_that_hangs_is_ended(
    programs: Path, heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install(programs, "chromium", HANGS)
    monkeypatch.setattr(reports, "MAX_PRINT_SECONDS", 0.5)
    begun = time.monotonic()
    done = heun("report", "hanging.yaml", "-o", "x.pdf")
    assert done.returncode == 5
    assert "it took longer than 0.5 s" in done.stderr
    assert time.monotonic() - begun < 30.0
    assert not (folder / "x.pdf").exists()
