"""The gallery: its command; the faults that are gone from its pictures stay away (tests/gallery/mended.py)."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.gallery.__main__ import draw_picture, main
from tests.gallery.checks import find_other_numbers
from tests.gallery.contents import PICTURES, Picture, find_spec
from tests.gallery.mended import MENDED, SLOW
from tests.shared.command import Heun

HELD = [row for row in PICTURES if row.spec not in SLOW and any(row.kind in kinds for kinds in MENDED.values())]
MARKED = [
    ("engine", "joints.main.force"), ("press", "joints.main.force"), ("axle_loads", "joints.front.force"),
    ("bouncing_ball", "bodies.ball.velocity.z"),
]  # fmt: skip


@pytest.mark.heavy
def test_the_gallery_is_drawn_with_its_index(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(tmp_path), "--only", "balance"]) == 0
    shown = (tmp_path / "index.html").read_text()
    rows = [row for row in PICTURES if row.kind == "balance"]
    assert rows and all((tmp_path / f"{row.name}.svg").exists() and row.name in shown for row in rows)
    assert (tmp_path / "findings.txt").exists()
    assert capsys.readouterr().out.count("findings") >= len(rows)


def test_every_row_has_a_spec_and_a_file_of_its_own() -> None:
    assert all(find_spec(row.spec).exists() for row in PICTURES)
    assert len({row.name for row in PICTURES}) == len(PICTURES) >= 40


@pytest.mark.heavy
@pytest.mark.skipif(not HELD, reason="no fault is mended in all pictures of a kind")
@pytest.mark.parametrize("row", HELD, ids=lambda row: row.name)
@pytest.mark.third
def test_faults_that_were_mended_stay_away(row: Picture, tmp_path: Path) -> None:
    held = {fault for fault, kinds in MENDED.items() if row.kind in kinds}
    assert [str(f) for f in draw_picture(row, tmp_path, None).findings if f.kind in held] == []


@pytest.mark.heavy
@pytest.mark.parametrize(("spec", "path"), MARKED)
@pytest.mark.third
def test_marked_numbers_are_extremes_of_the_run(spec: str, path: str, heun: Heun, folder: Path) -> None:
    file = str(find_spec(spec))
    assert heun("plot", file, path, "-o", "x.svg").returncode == 0
    measured = heun("run", file, "-q", "--measure", f"max {path}", "--measure", f"min {path}")
    extremes = [float(line) for line in measured.stdout.split()]
    assert len(extremes) == 2 and find_other_numbers((folder / "x.svg").read_text(), extremes) == []
