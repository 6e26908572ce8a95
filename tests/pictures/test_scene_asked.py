"""`heun plot SPEC scene` and `heun model SPEC --sketch`: what is refused, what is written, what is not solved."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from heuncli.base.joint_kinds import JOINTS, TYPES
from heuncli.output.drawing.figure import Symbol
from heuncli.output.drawing.symbols import LINKS, SYMBOLS
from heuncli.output.figures.machine_items import HOLD_SYMBOLS, TURN_SYMBOLS, find_turn_key
from heuncli.output.figures.scenes import make_assembly_figure
from heuncli.scene.file_format.load import load
from tests.shared.command import Heun
from tests.shared.plotted import views_of

SPECS = Path(__file__).parents[2] / "specs"
CRANK = str(SPECS / "slider_crank.yaml")
FOUR_BAR = str(SPECS / "four_bar.yaml")
KINDS = """\
heun: 1
title: One joint of every kind
ground: {points: {O: [0, 0, 0]}}
bodies:
  a: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {p: [1, 0, 0], q: [-1, 0, 0]}}
  b: {mass: 1, center: [2, 0, 0], inertia: [1, 1, 1], points: {p: [1, 0, 0]}}
tables: {line: {x: [0, 1], y: [0, 1], interpolation: cubic}}
joints:
  of_it: {type: KIND, from: END, to: b.p KEYS}
"""


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--view", "w"), "--view w"),
        (("--view", "30"), "azimuth"),
        (("crank.nose",), "crank.nose"),
        (("points.krank.pin",), "krank"),
        (("--at", "7"), "--at 7"),
        (("--at", "peak:joints.no.force"), "--at: "),
        (("--at", "soon"), "--at soon"),
        (("--x", "coordinates.main.angle"), "--x"),
        (("--units", "furlong"), "furlong"),
        (("--width", "80"), "--width"),
    ],
)
def test_what_cannot_be_drawn_is_told_and_nothing_is_written(heun: Heun, words: tuple[str, ...], told: str) -> None:
    done = heun("plot", CRANK, "scene", *words, "-o", "scene.svg")
    assert done.returncode == 2 and done.stdout == ""
    assert told in done.stderr and "hint:" in done.stderr
    assert not Path("scene.svg").exists()


@pytest.mark.heavy
def test_nothing_is_drawn_beyond_the_horizon(heun: Heun, folder: Path) -> None:
    text = (SPECS / "double.yaml").read_text().partition("expect:")[0]
    (folder / "far.yaml").write_text(text.replace("duration: 2, samples: 201", "duration: 60, samples: 61"))
    done = heun("plot", "far.yaml", "scene", "--at", "1,55", "--quiet", "-o", "far.svg")
    assert done.returncode == 2 and "from t = 44." in done.stderr and not Path("far.svg").exists()
    assert heun("plot", "far.yaml", "scene", "--at", "1,40", "--quiet", "-o", "far.svg").returncode == 0


@pytest.mark.parametrize("kind", sorted(TYPES))
@pytest.mark.parametrize("end", ["ground.O", "a.q"])
def test_every_kind_of_joint_has_its_symbol(kind: str, end: str) -> None:
    row = TYPES[kind]
    keys = f", {row.axis_key}: [0, 0, 1]" if row.axis_key else ""
    keys += ", to_axis: [1, 0, 0]" if row.to_axis == "required" else ""
    keys += ", x: line" if kind == "curve" else ""
    text = KINDS.replace("KIND", kind).replace("END", end).replace(" KEYS", keys)
    figures = [make_assembly_figure(load("kinds.yaml", text), view) for view in ("x", "z", "30,20")]
    for figure in figures:
        found = [
            item for panel in figure.panels for item in panel.items if getattr(item, "name", "") == f"of_it: {kind}"
        ]
        assert found
    grounds = [i for f in figures for p in f.panels for i in p.items if isinstance(i, Symbol) and "ground" in i.name]
    assert bool(grounds) == (end == "ground.O" and kind != "curve")  # whose path is drawn, and carries it


def test_the_symbols_follow_from_the_rows_of_joints() -> None:
    for kind in JOINTS.values():
        assert find_turn_key(kind) in TURN_SYMBOLS
        assert kind.hold.gap_type in {"point", "distance", "curve", *HOLD_SYMBOLS}
    assert {name for row in (*TURN_SYMBOLS.values(), *HOLD_SYMBOLS.values()) for name in row} <= set(SYMBOLS)
    for draw in LINKS.values():
        for length in (20.0, 300.0):
            xs = [x for part in draw(length) for x, _ in part.points]
            assert min(xs) <= 0.0 and max(xs) >= length


def test_cases_and_specs_have_a_panel_each(heun: Heun) -> None:
    done = heun("plot", CRANK, FOUR_BAR, "scene", "--quiet", "-o", "both.svg")
    assert done.returncode == 0, done.stderr
    text = Path("both.svg").read_text()
    assert len(views_of(text)) == 2
    assert ">slider_crank<" in text and ">four_bar<" in text


def test_the_same_bytes_again(heun: Heun) -> None:
    found = set()
    for name in ("one.svg", "two.svg"):
        assert heun("plot", FOUR_BAR, "scene", "coupler.C", "--at", "0,0.3", "-o", name).returncode == 0
        found.add(Path(name).read_bytes())
    assert len(found) == 1


def test_a_sketch_stands_below_the_note_and_solves_nothing(heun: Heun, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object, **__: object) -> None:
        raise AssertionError("a motion was solved")

    monkeypatch.setattr("heuncli.study.workflow.integrate", refused)
    plain, done = heun("model", CRANK), heun("model", CRANK, "--sketch")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith(plain.stdout)
    sketch = done.stdout[len(plain.stdout) :]
    assert "1 main, 2 big, 3 small / guide / slider, A crank, B rod" in sketch
    assert "┤ 100 mm   x right, y up" in sketch and "⠒" in sketch


def test_a_sketch_goes_to_a_file_and_from_where_it_is_asked_for(heun: Heun) -> None:
    shown = heun("model", CRANK, "--sketch", "--view", "30,20", "--width", "70")
    assert heun("model", CRANK, "--sketch", "--view", "30,20", "--width", "70", "-o", "note.txt").returncode == 0
    assert Path("note.txt").read_text() == shown.stdout
    assert "seen from azimuth 30, elevation 20 degrees" in shown.stdout
    assert max(len(line) for line in shown.stdout.partition("seen from")[2].splitlines()) <= 70


def test_of_a_rest_pose_and_of_a_state_there_is_a_sketch(heun: Heun) -> None:
    for spec in ("swing", "overhang", "percussion"):
        assert heun("model", str(SPECS / f"{spec}.yaml"), "--sketch", "--quiet").returncode == 0


@pytest.mark.parametrize(
    "words", [("--sketch", "--format", "json"), ("--view", "x"), ("--width", "60"), ("--sketch", "--width", "3")]
)
def test_what_does_not_go_with_a_sketch_is_told(heun: Heun, words: tuple[str, ...]) -> None:
    done = heun("model", CRANK, *words)
    assert done.returncode == 2 and done.stdout == "" and "hint:" in done.stderr


def test_the_json_of_a_model_knows_no_sketch(heun: Heun) -> None:
    found = json.loads(heun("model", CRANK, "--format", "json").stdout)
    assert "sketch" not in found and found["names"]["bodies"] == ["crank", "rod", "slider"]
