"""What is neither finite nor open is no result: every kind of number is refused with its path, by every command."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heuncli.base.errors import SolveError
from heuncli.output.tables.export import to_json
from heuncli.results.path_words import find_quantity
from heuncli.results.results import Results
from heuncli.results.results_schema import REPORTS, ROWS, SHARES
from heuncli.scene.file_format.load import load
from heuncli.study.compose import recovery
from heuncli.study.compose.accuracy import iter_numbers, require_finite
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve
from tests.shared.command import Heun
from tests.shared.folders import ROOT

# together they hold every quantity
SCENES = ("stick_slip", "door", "table", "percussion", "ladder", "door_closer", "swing", "jib", "crane", "cardan",
          "sprung", "planetary", "coupled", "hoist_beam", "screw_jack", "bracket", "spindle")  # fmt: skip
MAY_BE_OPEN = ("sections", "sensors", "supports", "elements", "stops", "couplings", "axis", "joints", "rodrigues")
NOT_FLOATS = {"events.EVENT.begins", "events.EVENT.to", "accuracy.horizon"}
SPRUNG = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0], wall: [1, 0, 0]}}
bodies:
  bar: {shapes: [{type: rod, from: [0, 0, 0], to: [0, 0, -1], mass: 1}], points: {top: [0, 0, 0], end: [0, 0, -1]}}
  block: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}, position: [1, 0, 0]}
joints:
  pivot:
    {type: pin, from: ground.O, to: bar.top, axis: [0, 1, 0], initial: {angle: 0.5}, bearing: {diameter: 1, width: 1}}
  guide: {type: slide, from: ground.wall, to: block.c, axis: [0, 0, 1]}
forces: {coil: {type: spring, from: ground.wall, to: bar.end, stiffness: 10, length: 1}}
stops: {buffer: {joint: pivot, angle: [0.1, null]}, floor: {joint: guide, travel: [0, null]}}
sections: {cut: {body: bar, at: [0, 0, -0.5], normal: [0, 0, -1], reduce_to: line}}
analysis: {duration: 0.5, samples: 3}
"""
COUPLED = """\
heun: 1
gravity: [0, -9.81, 0]
tables:
  lift:
    {x: [0, 90 deg, 180 deg, 270 deg, 360 deg], y: [0.1, 0.11, 0.1, 0.09, 0.1], interpolation: cubic, period: 360 deg}
  ramp: {x: [0, 1, 2, 3], y: [0, 1, 2, 3], interpolation: cubic}
ground: {points: {O: [0, 0, 0], A: [0.5, 0, 0], B: [2, 0, 0], C: [2.3, 0, 0], D: [-1, 0, 0], E: [0, 2, 0]}}
bodies:
  disc: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}
  tappet: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {face: [0, 0, 0]}}
  pulley: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}
  spindle: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}
  nut: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], position: [2.3, -2, 0], points: {o: [0, 0, 0]}}
  hung: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], position: [-1, -3, 0], points: {o: [0, 0, 0]}}
  shaft: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0], end: [0.5, 0, 0]}}
  bent: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], position: [0.5, 2, 0], points: {o: [0, 0, 0]}}
  wheel: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], position: [5, 0.5, 0], points: {o: [0, 0, 0]}}
  roller: {mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {o: [0, 0, 0]}}
joints:
  track: {type: curve, from: ground.O, to: roller.o, x: ramp, radius: 0.1, normal: [0, 0, 1], initial: {travel: 1}}
  cam: {type: pin, from: ground.O, to: disc.o, axis: [0, 0, 1], initial: {rate: 1}}
  guide: {type: slide, from: ground.O, to: tappet.face, axis: [0, 1, 0]}
  other: {type: pin, from: ground.A, to: pulley.o, axis: [0, 0, 1]}
  spin: {type: pin, from: ground.B, to: spindle.o, axis: [0, 1, 0]}
  run: {type: slide, from: ground.C, to: nut.o, axis: [0, 1, 0]}
  rails: {type: slide, from: ground.D, to: hung.o, axis: [0, 1, 0]}
  first: {type: pin, from: ground.E, to: shaft.o, axis: [1, 0, 0]}
  bend: {type: cv, from: shaft.end, to: bent.o, axis: [1, 0, 0]}
couplings:
  valve: {type: cam, of: [cam, guide], lift: lift, at: tappet.face, contact: flat, normal: [0, 1, 0], two_sided: true}
  belt: {type: belt, of: [cam, other], radii: [0.1, 0.2], pretension: 5}
  thread: {type: screw, of: [spin, run], lead: 0.1, friction: {coefficient: 0.1, radius: 0.05, speed: 0.1}}
  cable: {type: rope, through: [nut.o, {sheave: pulley.o, radius: 0.2, slip: none, side: over}, hung.o]}
  pair: {type: ratio, of: [spin, first], factors: [1, 2]}
rolling:
  rim: {wheel: wheel.o, axis: [0, 0, 1], radius: 0.5, on: ground.O, normal: [0, 1, 0], friction: 0.9, held: true}
forces:
  mount: {type: bushing, from: ground.D, to: bent.o, stiffness: 1, turning: 1, damping: 1}
impulses: {blow: {on: hung.o, vector: [0, 0.1, 0], time: 0.05}}
analysis: {duration: 0.1, samples: 3}
"""
TEXTS = {"sprung": SPRUNG, "coupled": COUPLED}
BLOCKS = {row.path.partition(".")[0] for row in ROWS if row.units}


@cache
def results(name: str) -> Results:
    """All that a spec's run tells."""
    spec = load(f"{name}.yaml", text=TEXTS[name]) if name in TEXTS else load(ROOT / "specs" / f"{name}.yaml")
    return solve(spec, Options(requested_reports=frozenset({*REPORTS, SHARES}))).results


def places(found: Results) -> Iterator[tuple[tuple[str, ...], Any, Any]]:
    """Every array and number of results: path, value, and the block in which it can be replaced."""
    for block in sorted(BLOCKS):
        for keys, value, owner in iter_numbers(getattr(found, block), (block,), {}):
            if isinstance(owner, dict) and keys[-1] in owner:
                yield keys, value, owner


def of_every_kind(found: Results) -> Iterator[tuple[tuple[str, ...], Any, Any]]:
    """Of each row of the schema the first place, and the first that is open in part."""
    seen = set()
    for keys, value, owner in places(found):
        row = find_quantity(keys)
        kind = row and row.path, bool(np.isnan(value).any())
        if np.size(value) and (row is None or kind not in seen):
            seen.add(kind)
            yield keys, value, owner


def put(found: Results, keys: tuple[str, ...], value: Any, owner: Any, bad: float) -> str:
    """What is told of results in which the last of these numbers is bad; empty: nothing."""
    spoilt = np.array(value, dtype=float, order="C")
    spoilt.reshape(-1)[-1] = bad
    owner[keys[-1]] = spoilt if isinstance(value, np.ndarray) else bad
    try:
        require_finite(found)
    except SolveError as error:
        (problem,) = error.problems
        assert problem.code == "not-finite-result"
        assert problem.hint
        return problem.message
    finally:
        owner[keys[-1]] = value
    return ""


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.third
def test_what_is_infinite_is_refused_by_its_path(name: str) -> None:
    found = require_finite(results(name))
    for keys, value, owner in of_every_kind(found):
        assert put(found, keys, value, owner, np.inf).startswith(f"{'.'.join(keys)} is not finite"), keys


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.third
def test_nan_stands_only_for_what_may_be_open(name: str) -> None:
    found = results(name)
    for keys, value, owner in of_every_kind(found):
        if not np.isnan(value).any():
            told = put(found, keys, value, owner, np.nan)
            may = {*MAY_BE_OPEN} & {*keys}
            assert told or may, keys
            if keys[0] == "joints" and "shares" not in keys:
                assert told, keys


@pytest.mark.heavy
def test_all_kinds_are_among_them() -> None:
    seen = {
        row.path for name in SCENES for keys, _, _ in places(results(name)) if (row := find_quantity(keys)) is not None
    }
    assert {row.path for row in ROWS if row.units} - seen == NOT_FLOATS | {"time"}


def test_what_is_open_is_null_and_nothing_else_is() -> None:
    text = to_json(results("door"))
    assert "null" in text
    assert "NaN" not in text and "Infinity" not in text


@pytest.mark.parametrize("words", [
    ("run", "swinging.yaml", "--format", "json"), ("run", "swinging.yaml", "--format", "csv"),
    ("run", "swinging.yaml"), ("run", "swinging.yaml", "--format", "markdown", "--all"),
    ("run", "swinging.yaml", "--measure", "max energy.kinetic"), ("run", "swinging.yaml", "--at", "0.5"),
    ("check", "swinging.yaml"),
])  # fmt: skip
def test_every_command_refuses_it(heun: Heun, words: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    energy = recovery.make_energy_block

    def broken(*given: Any) -> Any:
        block = energy(*given)
        return block | {"kinetic": block["kinetic"] + np.where(np.arange(len(block["kinetic"])) == 3, np.inf, 0.0)}

    monkeypatch.setattr(recovery, "make_energy_block", broken)
    with Path("swinging.yaml").open("a") as spec:
        spec.write("expect: [{of: energy.kinetic, peak: max, is: 1}]\n")
    done = heun(*words)
    assert done.returncode == 3
    assert "energy.kinetic is not finite" in done.stdout + done.stderr
    assert "[not-finite-result]" in done.stdout + done.stderr
