"""The hint below the table of joints where pins everywhere in space leave reactions open."""

from __future__ import annotations

from pathlib import Path

import pytest

from heuncli.output.tables.run_description import PINS_NOTE
from tests.shared.command import Heun
from tests.shared.folders import SPECS

DOOR = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {low: [0, 0, 0], high: [0, 0, 2]}}
bodies: {door: {mass: 20, center: [0.4, 0, 1], inertia: [7, 8, 1], points: {low: [0, 0, 0], high: [0, 0, 2]}}}
joints:
  low: {type: LOW, from: ground.low, to: door.low, axis: [0, 0, 1]}
  high: {type: HIGH, from: ground.high, to: door.high, axis: [0, 0, 1]}
"""


def joints(heun: Heun, *words: str) -> str:
    """The tables of joints in one line."""
    done = heun("run", *words, "--only", "joints")
    assert done.returncode == 0, done.stderr
    return " ".join(done.stdout.split())


def test_pins_everywhere_get_the_hint_once(heun: Heun) -> None:
    spec = str(SPECS / "slider_crank_pins.yaml")
    assert joints(heun, spec).count(PINS_NOTE) == 1
    assert joints(heun, spec, "--at", "first").count(PINS_NOTE) == 1


@pytest.mark.parametrize("words", [("--set", "space=planar"), ("--set", "joints.big.type=line"), ("--least-norm",)])
def test_what_the_hint_says_makes_the_loads_determinate(heun: Heun, words: tuple[str, ...]) -> None:
    told = joints(heun, str(SPECS / "slider_crank_pins.yaml"), *words)
    assert PINS_NOTE not in told and "open:" not in told


@pytest.mark.parametrize("spec", ["table", "bricard", "engine", "planetary"])
def test_other_models_do_not_get_it(heun: Heun, spec: str) -> None:
    assert PINS_NOTE not in joints(heun, str(SPECS / f"{spec}.yaml"))


@pytest.mark.parametrize(
    ("low", "high", "is_hinted"), [("pin", "pin", True), ("pin", "line", False), ("pin", "cylinder", False)]
)
def test_it_is_about_several_pins(heun: Heun, folder: Path, low: str, high: str, is_hinted: bool) -> None:
    (folder / "door.yaml").write_text(DOOR.replace("LOW", low).replace("HIGH", high))
    assert (PINS_NOTE in joints(heun, "door.yaml")) is is_hinted
