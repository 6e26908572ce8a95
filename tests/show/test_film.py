"""`heun show -o x.png, x.gif, x.mp4`: what is asked of the programs on PATH, and what is told without them."""

from __future__ import annotations

import base64
import os
from pathlib import Path

import pytest

from tests.shared.command import Heun

PICTURES = [base64.b64encode(f"picture {k}".encode()).decode() for k in range(3)]
BROWSER = """#!/bin/sh
for last; do :; done
case "$last" in file://*film.html) ;; *) exit 1 ;; esac
echo '<html><pre id="film">{}</pre></html>'
"""
ENCODER = """#!/bin/sh
for last; do :; done
cat 00000.png 00001.png 00002.png > "$last"
"""


def put(folder: Path, name: str, text: str) -> None:
    """A program in a folder."""
    (folder / name).write_text(text)
    (folder / name).chmod(0o755)


@pytest.fixture
def programs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that alone is searched for browsers; a program in it still finds what a shell needs."""
    home = tmp_path / "programs"
    home.mkdir()
    put(home, "cat", '#!/bin/sh\nexec /bin/cat "$@"\n')
    monkeypatch.setenv("PATH", str(home))
    return home


@pytest.mark.parametrize(
    ("name", "there", "said"),
    [
        ("x.png", (), "no Chromium or Chrome"), ("x.gif", (), "no Chromium or Chrome"),
        ("x.mp4", ("chromium",), "no ffmpeg"),
    ],
)  # fmt: skip
def test_a_missing_program_is_told_before_anything_is_solved(
    name: str,
    there: tuple[str, ...],
    said: str,
    heun: Heun,
    folder: Path,
    programs: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def never(*_: object) -> None:
        raise AssertionError("solved")

    for program in there:
        put(programs, program, BROWSER.format(PICTURES[0]))
    monkeypatch.setattr("heuncli.app.commands.show.solve", never)
    done = heun("show", "swinging.yaml", "-o", name)
    assert done.returncode == 5 and said in done.stderr and "[no-film-program]" in done.stderr
    assert "hint: install" in done.stderr and not (folder / name).exists()


@pytest.mark.skipif(os.name == "nt", reason="the programs are scripts of a shell")
def test_the_file_is_what_the_programs_make(heun: Heun, folder: Path, programs: Path) -> None:
    put(programs, "chromium", BROWSER.format(" ".join(PICTURES)))
    put(programs, "ffmpeg", ENCODER)
    for name, content in (("x.png", b"picture 0"), ("x.gif", b"picture 0"), ("x.mp4", b"picture 0picture 1picture 2")):
        done = heun("show", "swinging.yaml", "-o", name)
        assert done == (0, "", "") and (folder / name).read_bytes() == content


@pytest.mark.skipif(os.name == "nt", reason="the programs are scripts of a shell")
def test_a_program_that_fails_is_told(heun: Heun, folder: Path, programs: Path) -> None:
    put(programs, "chromium", "#!/bin/sh\necho out of colour >&2\nexit 3\n")
    done = heun("show", "swinging.yaml", "-o", "x.png")
    assert done.returncode == 5 and "has drawn nothing: out of colour" in done.stderr
    put(programs, "chromium", BROWSER.format(" ".join(PICTURES)))
    put(programs, "ffmpeg", "#!/bin/sh\necho no such codec >&2\nexit 1\n")
    done = heun("show", "swinging.yaml", "-o", "x.mp4")
    assert done.returncode == 5 and "has written no video: no such codec" in done.stderr
    assert not (folder / "x.mp4").exists() and not (folder / "x.png").exists()
