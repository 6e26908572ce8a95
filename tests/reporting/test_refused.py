"""What a report is not made of: told in a line, and nothing is written."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.shared.command import HANGING, Heun


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "no output file is given"),
        (("-o", "x.bmp"), "unknown file extension"),
        (("-o", "report"), "unknown file extension"),
        (("-o", "-", "--format", "pdf"), "a PDF needs a file"),
        (("-o", "x.html", "--format", "bmp"), "--format bmp: expected html, pdf, md"),
        (("-o", "x.html", "--paper", "a5"), "--paper a5: expected a4, letter"),
        (("-o", "x.html", "--chapters", "loads,lodas"), "--chapters lodas: there is no such chapter"),
        (("-o", "x.html", "--logo", "absent.png"), "--logo: "),
        (("-o", "x.html", "--logo", "hanging.yaml"), "is not a picture"),
        (("-o", "x.html", "--case", "windy"), "no such load case"),
        (("-o", "x.html", "--units", "parsnip"), "parsnip"),
    ],
)
def test_words_that_mean_no_report(heun: Heun, folder: Path, words: tuple[str, ...], message: str) -> None:
    before = set(folder.iterdir())
    done = heun("report", "hanging.yaml", *words)
    assert (done.returncode, done.stdout) == (2, "")
    assert message in done.stderr
    assert set(folder.iterdir()) == before


def test_a_case_that_cannot_be_solved_leaves_no_report(heun: Heun, folder: Path) -> None:
    text = HANGING.replace("[0, 0, 0]}}\nbodies", "[0, 0, 0], P: [0, 0, z]}}\nbodies").replace(
        "{m: 1.0}", "{m: 1.0, z: -1}"
    )
    text = text.replace("top: [0, 0, 0]}", "top: [0, 0, 0], end: [0, 0, -1]}")
    text += "  low: {type: ball, from: ground.P, to: bar.end}\ncases: {fits: {set: {}}, torn: {set: {z: -5}}}\n"
    (folder / "cased.yaml").write_text(text)
    run = heun("run", "cased.yaml", "--case", "torn")
    done = heun("report", "cased.yaml", "-o", "x.html")
    assert done.returncode == run.returncode == 3
    assert "in case torn: " in done.stderr
    assert not (folder / "x.html").exists()
    alone = heun("report", "cased.yaml", "-o", "x.html", "--case", "fits")
    assert alone.returncode == 0
    assert "load cases torn" in (folder / "x.html").read_text()


def test_the_spec_is_never_written_over(heun: Heun, folder: Path) -> None:
    before = (folder / "hanging.yaml").read_bytes()
    done = heun("report", "hanging.yaml", "-o", "hanging.yaml", "--format", "md")
    assert done.returncode == 2
    assert (folder / "hanging.yaml").read_bytes() == before


def test_the_same_bytes_each_time_and_from_standard_input(heun: Heun, folder: Path) -> None:
    for form in ("html", "md"):
        first, second = (heun("report", "swinging.yaml", "-o", "-", "--format", form).stdout for _ in range(2))
        assert first == second
    text = (folder / "swinging.yaml").read_text()
    piped = heun("report", "-", "-o", "-", text=text).stdout
    named = heun("report", "swinging.yaml", "-o", "-").stdout
    assert piped.replace("&lt;stdin&gt;", "swinging.yaml").replace(" long", "") == named.replace(" long", "")


def test_a_time_limit_leaves_no_report(heun: Heun, folder: Path) -> None:
    done = heun("report", "long.yaml", "-o", "x.html", "--time-limit", "0.05")
    assert done.returncode == 4
    assert not (folder / "x.html").exists()
