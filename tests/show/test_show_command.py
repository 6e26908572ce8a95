"""`heun show`: what it writes where, and what it refuses in one line, before anything is solved."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from heuncli.app.commands.show import MAX_BODIES
from heuncli.output.web_page.frames import MAX_PAGE_FRAMES
from tests.shared.command import TURNED, Heun
from tests.shared.folders import SPECS
from tests.shared.moving_pages import data_of, unpacked


def test_the_page_goes_where_it_is_told(heun: Heun, folder: Path) -> None:
    done = heun("show", "swinging.yaml", "-o", "out.html")
    assert done == (0, "", "")
    shown = heun("show", "swinging.yaml", "-o", "-")
    assert shown.stdout == (folder / "out.html").read_text(encoding="utf-8") and shown.returncode == 0
    assert shown.stdout.startswith("<!DOCTYPE html>\n<html lang=")


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("swinging.yaml",), 2, "no output file is given"),
        (("swinging.yaml", "-o", "x.bmp"), 2, "unknown file extension"),
        (("swinging.yaml", "-o", "x"), 2, "unknown file extension"),
        (("swinging.yaml", "-o", "nowhere/x.html"), 5, "nowhere"),
        (("swinging.yaml", "--glb", "x.glb", "--frames", "3"), 2, "--frames: only for the page, and none is written"),
        (("swinging.yaml", "--glb", "x.glb", "--units", "mm"), 2, "--units: only for the page, and none is written"),
        (("swinging.yaml", "-o", "x.html", "--frames", "1"), 2, "expected 2 to 5000"),
        (("swinging.yaml", "-o", "x.html", "--frames", "5001"), 2, "expected 2 to 5000"),
        (("swinging.yaml", "-o", "x.html", "--units", "kg"), 2, "--units kg"),
        (("swinging.yaml", "-o", "x.html", "--case", "none"), 2, "none"),
        (("swinging.yaml", "-o", "x.html", "--case", "all"), 2, "no load cases"),
        (("swinging.yaml", "-o", "x.png", "--case", "all"), 2, "a page shows all load cases"),
        (("swinging.yaml", "-o", "x.html", "--at", "0.5"), 2, "--at: only for a picture"),
        (("swinging.yaml", "-o", "x.gif", "--frames", "10"), 2, "--frames: only for the page"),
        (("nosuch.yaml", "-o", "x.html"), 2, "nosuch.yaml"),
        (("scene.html", "-o", "scene.html"), 2, "the spec itself"),
    ],
)
def test_what_is_refused(heun: Heun, folder: Path, words: tuple[str, ...], code: int, said: str) -> None:
    (folder / "scene.html").write_text(TURNED)
    before = sorted(folder.iterdir())
    done = heun("show", *words)
    assert done.returncode == code and done.stdout == ""
    lines = done.stderr.splitlines()
    assert said in lines[0] and len([line for line in lines if not line.startswith("  hint: ")]) == 1
    assert sorted(folder.iterdir()) == before


def test_a_scene_of_too_many_bodies_is_refused_before_it_is_solved(
    heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*_: object) -> None:
        raise AssertionError("solved")

    monkeypatch.setattr("heuncli.app.commands.show.solve", never)
    bodies = "".join(f"  b{k}: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1]}}\n" for k in range(MAX_BODIES + 1))
    (folder / "many.yaml").write_text(f"heun: 1\nbodies:\n{bodies}")
    done = heun("show", "many.yaml", "-o", "x.html")
    assert done.returncode == 4 and f"at most {MAX_BODIES}" in done.stderr and not (folder / "x.html").exists()


def written(heun: Heun, folder: Path, *words: str) -> dict[str, object]:
    """The data of the page that is written."""
    done = heun("show", *words, "-o", "x.html")
    assert done.returncode == 0, done.stderr
    return data_of((folder / "x.html").read_text(encoding="utf-8"))


def test_a_long_run_is_thinned_and_that_is_said(heun: Heun, folder: Path) -> None:
    (folder / "fine.yaml").write_text(TURNED + "analysis: {duration: 1, samples: 3001}\n")
    found = written(heun, folder, "fine.yaml")
    assert found["count"] == MAX_PAGE_FRAMES and "of the 3001 output times" in str(found["notes"])
    found = written(heun, folder, "fine.yaml", "--frames", "10")
    times = unpacked(found["time"], 10)  # type: ignore[arg-type]
    assert found["count"] == 10 and times[0] == 0.0 and times[-1] == 1.0


def test_between_few_instants_there_are_more_frames(heun: Heun, folder: Path) -> None:
    found = written(heun, folder, "swinging.yaml")
    count = int(str(found["count"]))
    times = unpacked(found["time"], count)  # type: ignore[arg-type]
    assert 100 < count <= MAX_PAGE_FRAMES
    assert all(np.abs(times - t).min() < 1e-12 for t in np.linspace(0.0, 1.0, 11))


def test_of_one_instant_there_is_one_frame(heun: Heun, folder: Path) -> None:
    assert written(heun, folder, "hanging.yaml")["count"] == 1


def test_nothing_is_shown_beyond_the_horizon(heun: Heun, folder: Path) -> None:
    found = written(heun, folder, str(SPECS / "double.yaml"), "--set", "analysis.duration=80")
    horizon = found["horizon"]
    times = unpacked(found["time"], int(str(found["count"])))  # type: ignore[arg-type]
    assert isinstance(horizon, float) and horizon < 60.0
    assert 0.9 * horizon < times[-1] < horizon and "later results are not claimed" in str(found["notes"])


def test_units_are_those_asked_for_and_numbers_stay_si(heun: Heun, folder: Path) -> None:
    plain, asked = (written(heun, folder, "swinging.yaml", *words) for words in ((), ("--units", "kN,mm")))

    def force(data: dict[str, object]) -> dict[str, object]:
        rows = [row for b in data["blocks"] for g in b["groups"] for row in g["rows"]]  # type: ignore[attr-defined]
        return next(row for row in rows if row["path"] == "joints.pivot.force")

    assert force(plain)["unit"] == "N" and force(asked)["unit"] == "kN" and force(asked)["size"] == 1e-3
    assert force(plain)["parts"] == force(asked)["parts"]
    assert asked["length"] == ["mm", 1e3]


def test_what_is_set_is_solved(heun: Heun, folder: Path) -> None:
    one, two = (written(heun, folder, "hanging.yaml", "--set", f"m={m}")["blocks"] for m in (1, 2))
    assert one != two and "9.81" in str(one) and "19.62" in str(two)


def test_largest_loads_without_room_are_told(heun: Heun, folder: Path) -> None:
    spec = str(SPECS / "engine.yaml")
    for frames, told in (("8", True), ("60", False)):
        assert heun("show", spec, "-o", "page.html", "--frames", frames, "-q").returncode == 0
        said = data_of((folder / "page.html").read_text())["notes"]
        assert any("of the times at which loads are largest" in text for text in said) == told, said


def test_loads_that_were_not_sought_between_the_instants_are_told(
    heun: Heun, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for most, told in ((10**6, False), (0, True)):
        monkeypatch.setattr("heuncli.study.queries.study.MOST_SEARCHED", most)
        assert heun("show", "swinging.yaml", "-o", "page.html").returncode == 0
        said = data_of((folder / "page.html").read_text())["notes"]
        assert any("Too many loads to search" in text for text in said) == told, said


def test_all_load_cases_stand_in_one_page(heun: Heun, folder: Path) -> None:
    cases = "cases:\n  light: {set: {m: 1}}\n  heavy: {set: {m: 4}}\n"
    (folder / "cases.yaml").write_text((folder / "hanging.yaml").read_text() + cases)
    runs = written(heun, folder, "cases.yaml", "--case", "all")["runs"]
    assert isinstance(runs, list) and [run["case"] for run in runs] == ["light", "heavy"]
    for run, case in zip(runs, ("light", "heavy"), strict=True):
        one = written(heun, folder, "cases.yaml", "--case", case)
        assert one["blocks"] == run["blocks"] and one["case"] == case
    assert runs[0]["blocks"] != runs[1]["blocks"]
