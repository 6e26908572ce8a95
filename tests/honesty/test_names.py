"""Names that are heun's own words change no number and no other word; see names.py."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.honesty.names import QUICK, case, without_twins
from tests.shared.command import Heun
from tests.shared.in_process import run_command

# a stop that strikes; loops and drives; what is held twice; couplings with loads of their own; load cases; sections
QUICKEST = ("door", "overhang", "punch", "screw_press", "axle_loads", "slider_crank_pins")


@pytest.mark.heavy
@pytest.mark.parametrize("stem", QUICKEST)
@pytest.mark.third
def test_words_of_heun_are_names_like_others(stem: str) -> None:
    forms = [form for form in QUICK if form.form != "text" or form.words == ("--by-cause",)]
    assert case(QUICKEST.index(stem), stem, forms) == []


STRUCK = """
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  {0}: {{mass: 3, center: [0.2, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{o: [0, 0, 0]}}}}
joints:
  {1}: {{type: pin, from: ground.O, to: {0}.o, axis: [0, 1, 0]}}
stops:
  {2}: {{joint: {1}, angle: [-80 deg, 0.1], restitution: 0.1}}
analysis: {{duration: 0.3, samples: 4}}
"""


@pytest.mark.parametrize("names", [("arm", "lever", "open"), ("open", "shares", "point"), ("stops", "axis", "at")])
def test_a_stop_that_strikes_may_have_any_name(heun: Heun, folder: Path, names: tuple[str, str, str]) -> None:
    (folder / "plain.yaml").write_text(STRUCK.format("b1", "j1", "s1"))
    (folder / "words.yaml").write_text(STRUCK.format(*names))
    found = [
        json.loads(heun("run", f"{name}.yaml", "--format", "json", "--by-cause").stdout) for name in ("plain", "words")
    ]
    told = []
    for one, (body, joint, stop) in zip(found, (("b1", "j1", "s1"), names), strict=True):
        blow = one["impulses"][0]
        assert blow["names"] == [stop]
        told.append([
            blow["stops"][stop], blow["joints"][joint]["force"], blow["foundation"]["elements"][stop]["moment"],
            blow["joints"][joint]["shares"][stop], blow["bodies"][body], blow["joints"][joint]["open"],
        ])  # fmt: skip
    assert told[0] == told[1]


SHARED = """
heun: 1
gravity: [0, -9.81, 0]
ground: {{points: {{O: [0, 0, 0], P: [1, 0, 0]}}}}
bodies:
  a: {{mass: 1, center: [0.1, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{o: [0, 0, 0]}}}}
  b: {{mass: 1, center: [1, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{o: [1, 0, 0]}}}}
joints:
  p: {{type: pin, from: ground.O, to: a.o, axis: [0, 0, 1]}}
  q: {{type: pin, from: ground.P, to: b.o, axis: [0, 0, 1]}}
drives: {{{drive}: {{joint: p, angle: t**2}}}}
forces: {{{force}: {{type: turn_spring, joint: q, stiffness: 20, angle: 0.3}}}}
couplings: {{{coupling}: {{type: gear, of: [p, q], ratio: 2}}}}
analysis: {{duration: 0.1, samples: 2}}
"""


def test_a_force_a_drive_and_a_coupling_of_one_name(heun: Heun, folder: Path) -> None:
    (folder / "plain.yaml").write_text(SHARED.format(drive="m1", force="m2", coupling="m3"))
    (folder / "shared.yaml").write_text(SHARED.format(drive="m", force="m", coupling="m"))
    plain, shared = (json.loads(heun("run", f"{name}.yaml", "--format", "json").stdout) for name in ("plain", "shared"))
    assert shared["forces"]["m"] == plain["forces"]["m2"] and shared["couplings"]["m"] == plain["couplings"]["m3"]
    elements, own = plain["foundation"]["elements"], shared["foundation"]["elements"]
    keys = {"m2": "m", "m1": "drives.m", "m3": "couplings.m"}
    assert own == {keys[name]: block for name, block in elements.items()}
    assert heun("run", "shared.yaml", "--measure", "max foundation.elements.drives.m.moment.z").returncode == 0


def test_a_force_called_as_the_total(heun: Heun, folder: Path) -> None:
    text = SHARED.format(drive="m1", force="{}", coupling="m3").replace("drives: {m1: {joint: p, angle: t**2}}\n", "")
    (folder / "plain.yaml").write_text(text.replace("{}", "f"))
    (folder / "k.yaml").write_text(text.replace("{}", "k"))
    for words in (["--over", "q.angle=0.1:0.2/2"], ["--only", "forces"]):
        plain, named = (heun("lagrange", f"{name}.yaml", *words).stdout for name in ("plain", "k"))
        assert "k (force)" in named and plain != named
        assert [line.split()[-1:] for line in plain.splitlines()] == [line.split()[-1:] for line in named.splitlines()]


REFUSED = {
    "forces": "a force, and a rope that stretches: {type: rope, through: [ground.O, b.o], stiffness: 1e5}",
    "impulses": "one that catches: {type: rope, through: [ground.O, b.o], tension_only: true, restitution: 0}",
}


@pytest.mark.parametrize("block", REFUSED)
def test_what_is_told_by_one_name_shares_none(heun: Heun, folder: Path, block: str) -> None:
    coupling = REFUSED[block].partition(": ")[2]
    entry = {"forces": "{type: torque, joint: q, value: 1}", "impulses": "{on: b.o, vector: [0, 1, 0]}"}[block]
    head = SHARED.partition("drives:")[0].format()
    (folder / "one.yaml").write_text(f"{head}{block}: {{m: {entry}}}\ncouplings: {{m: {coupling}}}\n")
    done = heun("validate", "one.yaml")
    assert (
        done.returncode == 2 and f"{block}.m: 'm' is already used" in done.stderr and "hint: call it m_1" in done.stderr
    )


def test_a_key_that_stands_twice_is_found() -> None:
    with pytest.raises(KeyError):
        json.loads('{"k": 1, "k": 2}', object_pairs_hook=without_twins)
    assert run_command(["--version"]).returncode == 0
