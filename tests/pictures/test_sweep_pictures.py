"""Sweeps drawn from their store and from their CSV, read back: curves, fields, points, bars; what is none is told."""

from __future__ import annotations

import csv
import re
import sqlite3
import xml.etree.ElementTree as tree
from pathlib import Path

import numpy as np
import pytest

from heuncli.output.drawing.style import find_shade
from heuncli.output.figures.sweeps import describe_measure
from tests.shared.command import HANGING, Heun
from tests.shared.plotted import SVG, PlottedPanel, panels_of, points_of, texts_of

G = 9.81
HANGS = HANGING.replace("{m: 1.0}", "{m: 1.0, g: 9.81}").replace("-9.81", "-g")
FORCE = ("--measure", "joints.pivot.force.z")
SPECS = Path(__file__).parents[2] / "specs"


@pytest.fixture
def swept(heun: Heun, folder: Path) -> Heun:
    """`heun sweep` of a bar that hangs, into s.sqlite and s.csv."""
    (folder / "bar.yaml").write_text(HANGS)

    def run(*words: str, text: str = "") -> object:
        return heun("sweep", "bar.yaml", *words, "-q", "--store", "s.sqlite", "-o", "s.csv", text=text)

    return run  # type: ignore[return-value]


def drawn(heun: Heun, *words: str) -> tuple[list[PlottedPanel], list[str]]:
    """The panels of what is drawn, and all that is written."""
    done = heun("plot", *words, "-o", "drawn.svg")
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    text = Path("drawn.svg").read_text()
    assert not re.search(r"\b(nan|inf)\b", text)
    return panels_of(text), texts_of(text)


@pytest.mark.parametrize("file", ["s.sqlite", "s.csv"])
def test_a_curve_over_one_variable(heun: Heun, swept: Heun, file: str) -> None:
    swept("m=1:3/9", *FORCE)
    (panel,), words = drawn(heun, file)
    (curve,) = panel.lines("joints.pivot.force.z")
    assert np.abs(curve[:, 1] - G * curve[:, 0]).max() < panel.pixel
    assert curve[[0, -1], 0].tolist() == pytest.approx([1.0, 3.0], abs=panel.pixel)
    assert len(panel.spots(filled=False)) == 7 and "29.43 N at 3" in words and "9.81 N at 1" in words


def test_values_by_ratios_stand_evenly(heun: Heun, swept: Heun) -> None:
    swept("m=1:1000/4log", *FORCE)
    drawn(heun, "s.sqlite")
    (line,) = (e for e in tree.parse("drawn.svg").iter(f"{SVG}polyline") if e.findtext(f"{SVG}title"))
    circles = sorted(float(e.get("cx", "nan")) for e in tree.parse("drawn.svg").iter(f"{SVG}circle"))
    assert np.ptp(np.diff(circles)) < 0.05 and points_of(line)[0, 0] == circles[0]


@pytest.mark.parametrize("file", ["s.sqlite", "s.csv"])
def test_a_field_over_two(heun: Heun, swept: Heun, file: str) -> None:
    swept("m=1:3/5", "g=1:9/4", *FORCE)
    (field, shades), words = drawn(heun, file)
    areas = [(points_of(e), e.get("fill")) for e in tree.parse("drawn.svg").iter(f"{SVG}polygon")]
    cells = [(field.in_units(points).min(axis=0), fill) for points, fill in areas if field.holds(points)]
    assert len(cells) == 20
    for (m, g), fill in cells:
        force = (m + 0.25) * (g + 4 / 3)  # the middle of a cell of 0.5 by 8/3
        share = (force - 1.0) / (27.0 - 1.0)
        near = {find_shade(share + off) for off in np.linspace(-0.02, 0.02, 41)}
        assert fill in near
    levels = shades.x.values(np.array([shades.left, shades.right]))
    assert levels == pytest.approx([1.0, 27.0], abs=0.1)
    assert any("min. 1.00 N at m = 1, g = 1; max. 27.00 N at m = 3, g = 9" in word for word in words)


def test_what_could_not_be_solved_is_a_hole_and_counted(heun: Heun, swept: Heun) -> None:
    swept("m=-1,0.5,1,2,3", "g=1:9/4", *FORCE)
    _, words = drawn(heun, "s.sqlite")
    with Path("s.csv").open() as file:
        codes = [row[-2] for row in csv.reader(file)][1:]
    (code,) = set(codes) - {""}
    note = f"4 of 20 variants could not be solved (not drawn): 4 {code}"
    assert note in words
    root = tree.parse("drawn.svg")
    field = panels_of(Path("drawn.svg").read_text())[0]
    assert sum(field.holds(points_of(e)) for e in root.iter(f"{SVG}polygon")) == 16
    assert note in drawn(heun, "s.csv")[1]


@pytest.mark.parametrize("file", ["s.sqlite", "s.csv"])
def test_points_where_variants_are_random(heun: Heun, swept: Heun, file: str) -> None:
    swept("m=uniform(1,3)", "g=uniform(1,9)", "--samples", "40", *FORCE)
    panels, _ = drawn(heun, file)
    with Path("s.csv").open() as text:
        rows = np.array([[float(x) for x in row[1:4]] for row in list(csv.reader(text))[1:]])
    for panel, column in zip(panels, (0, 1), strict=True):
        spots = panel.spots(filled=False)
        assert len(spots) == 40
        assert np.abs(spots - rows[:, [column, 2]]).max() < panel.pixel


def test_bars_over_names(heun: Heun) -> None:
    axles = str(SPECS / "axle_loads.yaml")
    heun("sweep", axles, "case=all", "--measure", "joints.front.force.z", "-q", "-o", "s.csv")
    (panel,), words = drawn(heun, "s.csv", "--units", "N")
    with Path("s.csv").open() as text:
        rows = [(row[1], float(row[2])) for row in list(csv.reader(text))[1:]]
    bars = panel.areas("joints.front.force.z")
    tops = [float(panel.y.values(points_of(e)[:, 1].min())) for e in tree.parse("drawn.svg").iter(f"{SVG}polygon")]
    assert len(bars) == 4 and tops == pytest.approx([force for _, force in rows], abs=abs(panel.y.step))
    assert {case for case, _ in rows} <= set(words)


def test_between_names_there_are_no_lines(heun: Heun) -> None:
    axles = str(SPECS / "axle_loads.yaml")
    heun("sweep", axles, "case=all", "h=0.3,0.9", "--measure", "joints.front.force.z", "-q", "-o", "s.csv")
    (panel,), words = drawn(heun, "s.csv", "case")
    assert not panel.lines("h = 0.3") and {"h = 0.3", "h = 0.9", "braking"} <= set(words)
    assert len(panel.spots(filled=False)) == 4  # of the first; the second has squares
    (panel,), _ = drawn(heun, "s.csv", "h")
    assert len(panel.lines("case = braking")) == 1


def test_more_variables_are_curves_or_are_held(heun: Heun, swept: Heun) -> None:
    swept("m=1:3/5", "g=1:9/5", "bodies.bar.center.2=-0.5,-0.4", *FORCE)
    done = heun("plot", "s.sqlite", "-o", "drawn.svg")
    assert done.returncode == 2 and "3 variables" in done.stderr and "would make 10 curves" in done.stderr
    assert "hint: fix some, such as g=5" in done.stderr and not Path("drawn.svg").exists()
    (panel,), words = drawn(heun, "s.sqlite", "g=1")
    curves = [panel.lines(f"bodies.bar.center.2 = {z}")[0] for z in ("-0.5", "-0.4")]
    assert all(np.abs(curve[:, 1] - curve[:, 0]).max() < panel.pixel for curve in curves)
    assert "with g = 1" in words
    panels, _ = drawn(heun, "s.sqlite", "bodies.bar.center.2=-0.4")
    assert len(panels) == 2


def test_words_pick_measures_and_what_runs_across(heun: Heun, swept: Heun) -> None:
    swept("m=1:3/5", "g=1,9", *FORCE, "--measure", "joints.pivot.force.y")
    assert len(drawn(heun, "s.csv")[0]) == 2
    (panel,), _ = drawn(heun, "s.csv", "force.z", "g")
    (curve,) = panel.lines("m = 3")
    assert curve.tolist() == [pytest.approx([x, 3.0 * x], abs=panel.pixel) for x in (1.0, 9.0)]


def test_of_an_interrupted_sweep_what_is_there(heun: Heun, swept: Heun) -> None:
    swept("m=1:3/9", *FORCE, "--shard", "1/3")
    (panel,), words = drawn(heun, "s.sqlite")
    assert len(panel.lines("joints.pivot.force.z")[0]) == 2 and "3 of 9 variants are done" in words


def test_of_several_sweeps_in_a_store_the_last_or_the_one_named(heun: Heun, swept: Heun) -> None:
    swept("m=1:3/9", *FORCE)
    swept("g=1:3/9", *FORCE)
    assert "g" in drawn(heun, "s.sqlite")[1]
    assert "m" in drawn(heun, "s.sqlite:1")[1]
    done = heun("plot", "s.sqlite:7")
    assert done.returncode == 2 and "there is no sweep 7" in done.stderr


CSV = "number,m [kg],x [N],x [N] error,x [N] at [s],code,reason\n0,1,10,{e},,,\n1,2,20,{e},,,\n2,3,25,{e},,,\n"


def test_an_error_that_is_seen_is_a_band(heun: Heun, folder: Path) -> None:
    (folder / "s.csv").write_text(CSV.format(e=2.0))
    (panel,), _ = drawn(heun, "s.csv")
    (band,) = panel.areas("stated error of x")
    assert sorted(band[:, 1].tolist()) == pytest.approx([8.0, 12.0, 18.0, 22.0, 23.0, 27.0], abs=panel.pixel)
    (folder / "s.csv").write_text(CSV.format(e=0.01))
    assert not drawn(heun, "s.csv")[0][0].areas("stated error of x")


def test_open_measures_are_counted(heun: Heun) -> None:
    door = str(SPECS / "door.yaml")
    measures = ("--measure", "joints.top.force.z", "--measure", "joints.top.force.x")
    assert heun("sweep", door, "gravity=[0,0,-9],[0,0,-10]", *measures, "-q", "-o", "s.csv", "--store", "s.sqlite")
    for file in ("s.csv", "s.sqlite"):
        _, words = drawn(heun, file)
        assert "Top, Fz: open in 2 of 2 variants, not drawn there" in words


def test_hostile_names_are_shown_and_do_nothing(heun: Heun, folder: Path) -> None:
    evil = '"</text><script>alert(1)</script> & ""it"" \u202e"'
    (folder / "s.csv").write_text(CSV.format(e=0).replace("m [kg]", evil))
    _, words = drawn(heun, "s.csv")
    text = Path("drawn.svg").read_text()
    assert "<script" not in text and "\u202e" not in text and any("<script>" in word for word in words)


WRONG = {
    "empty.csv": ("", "it is empty"),
    "other.csv": ("a,b\n1,2\n", "its columns are a, b"),
    "run.csv": ("time,kind,name,quantity,component,unit,value\n", "its columns are time, kind"),
    "short.csv": (CSV.format(e=0) + "3,4\n", "row 5 has 2 cells"),
    "quote.csv": (CSV.format(e=0) + '3,"4', "not a CSV file of a sweep"),
    "heads.csv": (CSV.splitlines()[0] + "\n", "the sweep has no rows"),
    "one.csv": ("\n".join(CSV.format(e=0).splitlines()[:2]) + "\n", "a single variant gives no curve"),
    "bare.csv": ("number,m,code,reason\n0,1,,\n", "it has no measures"),
    "empty.sqlite": ("", "it is empty"),
    "text.sqlite": ("heun: 1\n" * 200, "not a store of sweeps"),
    "huge.csv": (CSV.format(e=0) + "3,4,1e308,0,0,,\n", "is 1e+308"),
    "text.csv": ("\0\0\0", "not a CSV file of a sweep"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_no_sweep_is_told_in_one_line(heun: Heun, folder: Path, name: str) -> None:
    text, why = WRONG[name]
    (folder / name).write_text(text)
    done = heun("plot", name, "-o", "drawn.svg")
    assert done.returncode == 2 and why in done.stderr and done.stdout == ""
    assert len(done.stderr.splitlines()) == 2 and "hint: " in done.stderr
    assert not (folder / "drawn.svg").exists() and (folder / name).read_text() == text


def test_other_files_and_words_are_refused(heun: Heun, swept: Heun, folder: Path) -> None:
    swept("m=1:3/5", *FORCE)
    with sqlite3.connect(folder / "other.sqlite") as other:
        other.execute("CREATE TABLE t (x)")
    for words, why in [
        (("other.sqlite",), "a database of another program"),
        (("none.sqlite",), "file not found"),
        (("none.csv",), "none.csv"),
        (("s.csv", "s.sqlite"), "one sweep at a time"),
        (("s.csv", "joints.pivot.force.w"), "no column of the sweep has this name"),
        (("s.csv", "m=7"), "no variant has this value"),
        (("s.csv", "m=1mm"), "expected a number"),
    ]:
        done = heun("plot", *words)
        assert done.returncode == 2 and why in done.stderr, done.stderr


def test_it_is_the_same_every_time_and_in_letters(heun: Heun, swept: Heun) -> None:
    swept("m=1:3/5", "g=1:9/4", *FORCE)
    for name in ("one.svg", "two.svg"):
        assert heun("plot", "s.sqlite", "-o", name).returncode == 0
    assert Path("one.svg").read_bytes() == Path("two.svg").read_bytes()
    text = heun("plot", "s.sqlite", "--width", "60").stdout
    assert max(map(len, text.splitlines())) <= 60 and set("·░▒▓█") <= set(text)


def test_a_measure_is_named_in_words() -> None:
    measures = ("max joints.main.force", "rms foundation.force.z", "max abs joints.main.moment", "mass of the rod")
    assert [describe_measure(measure) for measure in measures] == [
        "Main, greatest force", "Foundation, effective Fz", "Main, greatest magnitude of moment", "mass of the rod",
    ]  # fmt: skip
