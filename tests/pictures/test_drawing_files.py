"""PNG and PDF by a program on PATH: each with its options, the next where one fails, an error where there is none."""

from __future__ import annotations

import re
import shutil
import struct
from pathlib import Path

import pytest

from heuncli.base.errors import SpecError
from heuncli.output.drawing import drawing_files
from heuncli.output.drawing.shapes import Area, Text, VectorDrawing
from tests.shared.chromium import found

DRAWING = VectorDrawing(320.0, 200.4, "A drawing", "", [Area(((0, 0), (9, 0), (9, 9)), "#0072b2"), Text(20, 50, "−5")])
needs_chromium = pytest.mark.skipif(found() is None, reason="there is no Chromium")


def put_program(folder: Path, name: str, script: str) -> None:
    """Put a program of some lines of shell into a folder."""
    program = folder / name
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(0o755)


@pytest.fixture
def programs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that is the only one on PATH besides the shell's own."""
    folder = tmp_path / "bin"
    folder.mkdir()
    for name in ("sh", "cat", "cp", "printf"):
        if (path := shutil.which(name)) is not None:
            (folder / name).symlink_to(path)
    monkeypatch.setenv("PATH", str(folder))
    return folder


@needs_chromium
@pytest.mark.parametrize("form", ["png", "pdf"])
def test_a_chromium_draws_it_in_its_size(form: str, programs: Path) -> None:
    (programs / "chromium").symlink_to(str(found()))
    content = drawing_files.encode_drawing(DRAWING, form)
    assert content.startswith(drawing_files.MAGIC[form])
    if form == "png":
        assert struct.unpack(">II", content[16:24]) == (640, 400)  # two pixels for one
    else:
        (page,) = re.findall(rb"/MediaBox\s*\[([^\]]*)\]", content)  # one page, in points
        assert [float(length) for length in page.split()] == pytest.approx([0.0, 0.0, 240.0, 150.0], abs=1.0)


OPTIONS = [
    ("rsvg-convert", "png", ["--format=png", "--zoom=2"], 'cp "${4}" "${3#--output=}"'),
    ("rsvg-convert", "pdf", ["--format=pdf"], 'cp "${3}" "${2#--output=}"'),
    ("resvg", "png", ["--zoom=2"], 'cp "$2" "$3"'),
]


@pytest.mark.parametrize(("name", "form", "options", "copying"), OPTIONS)
def test_others_get_the_svg_and_their_options(
    name: str,
    form: str,
    options: list[str],
    copying: str,
    programs: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A stand-in gives the SVG back, so that what it was given is seen."""
    monkeypatch.setitem(drawing_files.MAGIC, form, b"<?xml")
    put_program(programs, name, f'printf "%s\\n" "$@" > {tmp_path}/told; {copying}')
    content = drawing_files.convert(DRAWING, form)
    assert content is not None and "−5" in content.decode()
    assert (tmp_path / "told").read_text().splitlines()[: len(options)] == options


@pytest.mark.parametrize("script", ["exit 1", "exit 0", 'printf "no picture" > "$3"'])
def test_where_one_fails_the_next_draws(script: str, programs: Path) -> None:
    pytest.importorskip("matplotlib")
    put_program(programs, "resvg", script)
    assert drawing_files.convert(DRAWING, "png") is None
    assert drawing_files.encode_drawing(DRAWING, "png").startswith(b"\x89PNG")


def test_where_there_is_none_it_is_said_before_the_work(programs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drawing_files.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(SpecError) as refused:
        drawing_files.require_encoder("pdf", "-o x.pdf")
    (problem,) = refused.value.problems
    assert problem.code == "missing-extra" and "resvg" in str(problem.hint) and ".svg" in str(problem.hint)
    drawing_files.require_encoder("svg", "-o x.svg")
