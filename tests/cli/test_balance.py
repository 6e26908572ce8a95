"""`heun balance`: what it writes, its options, and what it refuses."""

from __future__ import annotations

import csv
import io
import json
import math
from pathlib import Path
from typing import Any

import pytest

from tests.shared.command import Heun

SCENE = """\
heun: 1
title: A crank that turns its rod about
ground: {points: {O: [0, 0, 0], P: [0.5, 0, 0]}}
bodies:
  crank: {mass: 1, center: [0.05, 0, 0], inertia: [1e-3, 1e-3, 1e-3], points: {main: [0, 0, 0], pin: [0.1, 0, 0]}}
  rod: {mass: 0.8, center: [0.15, 0, 0], inertia: [1e-3, 6e-3, 6e-3], points: {big: [0, 0, 0], small: [0.3, 0, 0]}}
  slider: {mass: 1.5, center: [0, 0, 0], inertia: [1e-3, 1e-3, 1e-3], points: {pin: [0, 0, 0]}}
joints:
  main: {type: pin, from: ground.O, to: crank.main, axis: [0, 0, 1]}
  big: {type: line, from: crank.pin, to: rod.big, axis: [0, 0, 1]}
  small: {type: pin, from: rod.small, to: slider.pin, axis: [0, 0, 1]}
  guide: {type: slide, from: ground.O, to: slider.pin, axis: [1, 0, 0]}
"""
DRIVE = "drives: {motor: {joint: main, angle: 1 + 100*t}}\n"
GAS = 'forces: {gas: {type: torque, joint: main, value: "30*cos(main.angle/2)**3"}}\n'


@pytest.fixture
def crank(folder: Path) -> str:
    (folder / "crank.yaml").write_text(SCENE + DRIVE)
    return "crank.yaml"


def found(heun: Heun, *words: str) -> Any:
    done = heun("balance", *words, "--format", "json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_json_keeps_to_the_contract(heun: Heun, crank: str) -> None:
    told = found(heun, crank)
    assert told["cycle"] | {"samples": 0} == {
        "coordinate": "main.angle", "turns": 1, "rate": 100.0, "samples": 0, "settled": True,
    }  # fmt: skip
    assert told.keys() >= {"mean", "harmonics", "residual", "per_rate", "counterweights"}
    assert told["harmonics"].keys() == {"force", "moment", "torque"}
    for row in told["harmonics"]["force"]:
        assert row.keys() == {"order", "amplitude", "phase", "with", "against", "own", "verdict", "error"}
    for row in told["harmonics"]["moment"]:
        assert row.keys() >= {"orbital", "spin"} and row["orbital"].keys() == {"amplitude", "phase"}
    assert told["residual"].keys() == {"force", "moment", "moment_orbital", "moment_spin", "torque"}
    assert told["residual"]["force"].keys() == {"rms", "peak", "at", "error"}
    assert len(told["per_rate"]["second"]["force"]) == len(told["per_rate"]["angle"]) == told["cycle"]["samples"]
    assert told["per_rate"]["angle"][0] == pytest.approx(1.0)


@pytest.mark.heavy
def test_csv_has_the_numbers_of_the_json(heun: Heun, crank: str) -> None:
    rows = list(csv.DictReader(io.StringIO(heun("balance", crank, "--format", "csv").stdout)))
    told = found(heun, crank)["harmonics"]["force"]
    own = [float(row["value"]) for row in rows
           if (row["kind"], row["quantity"], row["component"]) == ("force", "amplitude", "x")]  # fmt: skip
    assert own == [row["amplitude"][0] for row in told]
    assert {row["unit"] for row in rows if row["kind"] == "moment"} == {"N·m", "rad"}


@pytest.mark.heavy
def test_orders_rate_and_turns_are_asked_for(heun: Heun, crank: str) -> None:
    two, one = found(heun, crank, "--turns", "2", "--orders", "0.5,1,2"), found(heun, crank, "--rate", "200 rad/s")
    assert [row["order"] for row in two["harmonics"]["force"]] == [0.5, 1.0, 2.0]
    assert two["harmonics"]["force"][0]["verdict"] == "does not arise"
    plain = found(heun, crank)
    assert one["residual"]["force"]["rms"] == pytest.approx(4.0 * plain["residual"]["force"]["rms"], rel=1e-12)
    assert two["harmonics"]["force"][1]["amplitude"] == pytest.approx(plain["harmonics"]["force"][0]["amplitude"])


@pytest.mark.heavy
def test_two_turns_where_a_load_has_them(heun: Heun, folder: Path) -> None:
    (folder / "gas.yaml").write_text(SCENE + GAS)
    told = found(heun, "gas.yaml")
    assert told["cycle"]["turns"] == 2 and told["cycle"]["rate"] is None
    assert "in kg·m" in heun("balance", "gas.yaml").stdout
    assert found(heun, "gas.yaml", "--turns", "1")["cycle"]["turns"] == 1


@pytest.mark.heavy
def test_moments_about_a_point_by_name_or_numbers(heun: Heun, crank: str) -> None:
    by_name = found(heun, crank, "--about", "P")
    by_numbers = found(heun, crank, "--about", "500mm,0,0")
    assert by_name["about"] == [0.5, 0.0, 0.0] and by_name["harmonics"] == by_numbers["harmonics"]
    assert "about P = (0.5, 0, 0) m" in heun("balance", crank, "--about", "ground.P").stdout
    assert by_name["residual"]["moment"] != found(heun, crank)["residual"]["moment"]


@pytest.mark.heavy
def test_a_counterweight_and_its_cost(heun: Heun, crank: str) -> None:
    told = found(heun, crank, "--counterweight", "crank.main:radius=60mm")
    [weight] = told["counterweights"]
    assert weight["body"] == "crank" and weight["place"] == "main" and weight["radius"] == 0.06
    assert weight["mass"] == pytest.approx(weight["product"] / 0.06)
    assert told["cost"]["before"].keys() == {"force", "moment", "drive", "joints"}
    assert told["cost"]["after"]["joints"].keys() == {"main", "big", "small", "guide"}
    assert told["cost"]["after"]["force"]["rms"] < told["cost"]["before"]["force"]["rms"]
    text = heun("balance", crank, "--counterweight", "crank.main").stdout
    assert "COUNTERWEIGHTS  for minimum force" in text and "COST  model solved again" in text


@pytest.mark.heavy
def test_a_flywheel(heun: Heun, folder: Path) -> None:
    (folder / "gas.yaml").write_text(SCENE + GAS)
    told = found(heun, "gas.yaml", "--rate", "500rpm", "--flywheel", "main=2%")["flywheel"]
    assert told["delta"] == 0.02 and told["added"] > 0.0 and told["mean_rate"] == pytest.approx(500 * math.pi / 30)
    assert told["inertia"] == pytest.approx(told["own"] + told["added"])
    assert "FLYWHEEL  on main" in heun("balance", "gas.yaml", "--rate", "500rpm", "--flywheel", "0.02").stdout


@pytest.mark.heavy
def test_the_table_draws_the_orders_in_letters(heun: Heun, crank: str) -> None:
    lines = heun("balance", crank).stdout.splitlines()
    begin = next(k for k, line in enumerate(lines) if line.startswith("ORDERS"))
    first = lines[begin + 1].partition("│")
    assert first[0].strip() == "1" and first[2].endswith("MF•")  # force and moment are largest there
    assert any("•T" in line for line in lines[begin + 2 : begin + 5])
    assert lines[-1] == "F force, M moment, T torque"


@pytest.mark.heavy
def test_a_picture_is_saved(heun: Heun, crank: str, folder: Path) -> None:
    assert heun("balance", crank, "--save", "orders.svg", "-o", "orders.json").returncode == 0
    drawn = (folder / "orders.svg").read_text()
    assert drawn.startswith("<?xml") and "Inertia force on the foundation" in drawn and ">force [kN]<" in drawn
    assert json.loads((folder / "orders.json").read_text())["cycle"]["turns"] == 1


REFUSED = [
    ("--turns 3", 2, "bad-option"), ("--rate 0", 2, "bad-option"), ("--rate 12mm", 2, "bad-option"),
    ("--orders 0", 2, "bad-option"), ("--orders 1.3", 2, "bad-option"), ("--about nowhere", 2, "bad-option"),
    ("--format xml", 2, "bad-option"), ("--save orders.txt", 2, "bad-option"), ("--minimise all", 2, "bad-option"),
    ("--counterweight crank", 2, "bad-option"), ("--counterweight crank.main:mass=1", 2, "bad-option"),
    ("--counterweight crank.main:radius=0", 2, "bad-option"), ("--lever -1", 2, "bad-option"),
    ("--flywheel 2", 2, "bad-option"), ("--flywheel main=x", 2, "bad-option"),
    ("--cycle mian", 3, "no-cycle"), ("--cycle small", 3, "no-cycle"),
    ("--counterweight crnk.main", 3, "no-counterweight"), ("--counterweight crank.mian", 3, "no-counterweight"),
    ("--counterweight slider.pin", 3, "no-counterweight"), ("--counterweight rod.big", 3, "radius-needed"),
    ("--flywheel big=1%", 3, "no-flywheel"),
]  # fmt: skip


@pytest.mark.parametrize(("words", "code", "named"), REFUSED, ids=[words for words, _, _ in REFUSED])
def test_what_is_refused(heun: Heun, crank: str, words: str, code: int, named: str) -> None:
    done = heun("balance", crank, *words.split())
    assert done.returncode == code and f"[{named}]" in done.stderr and "hint: " in done.stderr
    assert done.stdout == ""


CARRIAGE = """\
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies:
  a: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0], d: [1, 0, 0]}}
  b: {mass: 1, center: [0.1, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}}
joints:
  first: {type: pin, axis: [0, 0, 1], from: ground.O, to: a.c}
  second: {type: pin, axis: [0, 0, 1], from: a.d, to: b.c}
"""
SCENES = {
    "several freedoms": (CARRIAGE, "several-freedoms"),
    "a stop": (SCENE + "stops: {end: {joint: guide, travel: [0.1, 0.5]}}\n", "opens-and-closes"),
    "a rope": (
        CARRIAGE.replace("second: {type: pin, axis: [0, 0, 1]", "second: {type: rod, tension_only: true, length: 1")
        .replace("to: b.c}", "to: {body: b, at: [1, 0, 0]}}"),
        "opens-and-closes",
    ),
    "no angle": (
        "heun: 1\nground: {points: {O: [0, 0, 0]}}\nbodies: {a: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1]}}\n"
        "joints: {s: {type: slide, axis: [1, 0, 0], from: ground.O, to: {body: a, at: [0, 0, 0]}}}\n",
        "no-cycle",
    ),
    "no way round": (SCENE.replace("pin: [0.1, 0, 0]", "pin: [0.4, 0, 0]"), "no-cycle"),
    "drives that are not steady": (
        CARRIAGE + "drives: {one: {joint: first, angle: sin(t)}, two: {joint: second, angle: t}}\n", "no-cycle",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SCENES)
def test_scenes_without_a_cycle_are_refused_by_name(heun: Heun, folder: Path, name: str) -> None:
    text, code = SCENES[name]
    (folder / "scene.yaml").write_text(text)
    words = ["--cycle", "first"] if "drives: {one" in text else []
    done = heun("balance", "scene.yaml", *words)
    assert done.returncode == 3, done.stderr
    assert f"[{code}]" in done.stderr and "scene.yaml:" in done.stderr and "hint: " in done.stderr


def test_what_comes_back_after_two_turns_alone_is_told(heun: Heun, folder: Path) -> None:
    """A shaft that turns half as fast beside the crank: over one turn it is not back, over two it is."""
    text = CARRIAGE + "drives: {one: {joint: first, angle: 10*t}, two: {joint: second, angle: 5*t}}\n"
    (folder / "half.yaml").write_text(text)
    done = heun("balance", "half.yaml", "--cycle", "first")
    assert (
        done.returncode == 3
        and "not back at its start after one revolution" in done.stderr
        and "--turns 2" in done.stderr
    )
    told = found(heun, "half.yaml", "--cycle", "first", "--turns", "2")
    verdicts = {row["order"]: row["verdict"] for row in told["harmonics"]["force"]}
    assert verdicts[1.0] == verdicts[1.5] == "remains" and verdicts[0.5] == "does not arise"


@pytest.mark.heavy
def test_a_title_forges_nothing(heun: Heun, folder: Path) -> None:
    title = '"A\\n\\u001b[31mforce    none"'
    (folder / "evil.yaml").write_text(SCENE.replace("A crank that turns its rod about", title) + DRIVE)
    done = heun("balance", "evil.yaml", "--save", "evil.svg")
    assert done.returncode == 0 and "\x1b" not in done.stdout and "\x1b" not in (folder / "evil.svg").read_text()
    assert done.stdout.count("\nforce  ") == 1
