"""What the commands load, seen in fresh processes: start-up is most of a small run's time, and creeps back unseen."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

import heuncli
from tests.shared.loaded_modules import loaded_by

ROOT = Path(heuncli.__file__).parents[1]
CHAIN = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {O: [0, 0, 0]}}
bodies:
  upper: {mass: 1, center: [0, 0, -0.5], inertia: [0.08, 0.09, 0.01], orientation: {axis: [1, 0, 0], angle: 60 deg}}
  lower: {mass: 1, center: [0, 0, -0.5], inertia: [0.08, 0.09, 0.01], orientation: {axis: [1, 0, 0], angle: 20 deg}}
joints:
  pivot: {type: ball, from: ground.O, to: {body: upper, at: [0, 0, 0]}}
  elbow: {type: pin, axis: [1, 0, 0], from: {body: upper, at: [0, 0, -1]}, to: {body: lower, at: [0, 0, 0]}}
analysis: {duration: 0.1, samples: 3}
"""
BAR = """\
heun: 1
bodies:
  bar: {shapes: [{type: cylinder, from: [0, 0, 0], to: [1, 0, 0], radius: 0.01, mass: 1}], angular_velocity: [0, 0, 1]}
sections:
  middle: {body: bar, at: [0.5, 0, 0], normal: [1, 0, 0]}
analysis: {duration: 0.1, samples: 3}
"""
DOOR = """\
heun: 1
gravity: [0, 0, -9.81]
ground: {points: {A: [0, 0, 0], B: [0, 0, 2]}}
bodies:
  door: {mass: 10, center: [0.5, 0, 1], inertia: [3, 4, 1], points: {a: [0, 0, 0], b: [0, 0, 2]}}
joints:
  bottom: {type: pin, axis: [0, 0, 1], from: ground.A, to: door.a}
  top: {type: pin, axis: [0, 0, 1], from: ground.B, to: door.b}
analysis: {duration: 0.1, samples: 3}
"""
# Of the package: only scenes with shapes or sections, with closed chains, with tables; only other commands and options.
SHAPED = {
    "heuncli.scene.shapes.composite_solid",
    "heuncli.loads.kinetostatics.cuts",
    "heuncli.loads.kinetostatics.sections",
}
REDUNDANT = {
    "heuncli.loads.redundancy.resolve",
    "heuncli.loads.redundancy.self_stress",
}
RARE = {
    "heuncli.scene.file_format.tables",
    "heuncli.loads.redundancy.advice",
    "heuncli.output.tables.measure",
    "heuncli.study.queries.measure",
    "heuncli.study.queries.expectations",
    "heuncli.output.tables.export",
    "heuncli.app.cli.typer_reader",
}
# the last: pydantic, for plugins; pydantic_core judges entries with errors
STRANGE = {"scipy", "rich", "typer", "numpy.ma", "pydantic_core", "pydantic", "importlib.metadata"}
COSTLY = {"pathlib", "shutil", "hashlib", "numpy.typing"}  # 2 to 3 ms each, for one function of theirs


def loaded(*words: str, text: str = "") -> set[str]:
    """Modules that a command has loaded when it ends, fresh; its standard input is `text`."""
    code = (
        "import sys\n"
        "from heuncli.app.cli.entry import enter\n"
        "code = enter(sys.argv[1:])\n"
        "print(*sorted(sys.modules), file=sys.stderr)\n"
        "sys.exit(code)"
    )
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    run = subprocess.run(
        [sys.executable, "-c", code, *words],
        input=text, capture_output=True, text=True, check=True, env={**os.environ, "PYTHONPATH": path},
    )  # fmt: skip
    return set(run.stderr.splitlines()[-1].split())


def test_a_plain_run_loads_what_it_needs() -> None:
    found = loaded("run", "-", text=CHAIN)
    assert {"numpy", "yaml", "heuncli.study.compose.recovery"} <= found
    assert not (found - loaded_by("numpy")) & (STRANGE | COSTLY | SHAPED | REDUNDANT | RARE)


@pytest.mark.parametrize(
    ("words", "text", "more"),
    [
        (("run", "-"), BAR, SHAPED),
        (("run", "-"), DOOR, REDUNDANT),
        (("model", "-"), DOOR, {"heuncli.loads.redundancy.advice"}),
        (("run", "-", "--measure", "final energy.kinetic"), CHAIN, {"heuncli.output.tables.measure"}),
        (("run", "-", "--format", "json"), CHAIN, {"heuncli.output.tables.export"}),
        (("run", "--help"), "", {"heuncli.app.cli.typer_reader", "typer"}),
    ],
)
@pytest.mark.third
def test_what_is_left_out_is_loaded_where_it_is_wanted(words: tuple[str, ...], text: str, more: set[str]) -> None:
    assert more <= loaded(*words, text=text)


def test_a_sweep_does_without_what_clusters_need() -> None:
    words = ("sweep", "-", "bodies.bar.angular_velocity.2=1,2", "--measure", "final energy.kinetic")
    found = loaded(*words, text=BAR)
    assert "heuncli.app.commands.sweep.running" in found
    clusters = {
        "distributed",
        "dask",
        "tornado",
        "heuncli.app.commands.sweep.cluster.scheduler",
    }
    assert not found & (clusters | {"scipy", "rich", "pydantic"})


@pytest.mark.heavy
def test_a_sweep_loads_only_what_it_is_asked_for() -> None:
    measure = ("--measure", "final joints.right.force.z", "--jobs", "1", "-q")
    words = ("sweep", str(ROOT / "specs" / "rotor.yaml"), *measure)
    strange = STRANGE | {"pyarrow", "dask", "distributed", "statistics"}
    assert not (loaded(*words, "n=1000,1500rpm") - loaded_by("numpy")) & strange
    random = loaded(*words, "n=uniform(1000,1500)rpm", "--samples", "2")
    assert "scipy.special" in random and "scipy.stats" not in random
    assert "scipy.stats" in loaded(*words, "n=sobol(1000,1500)rpm", "--samples", "2")


def test_what_is_said_to_be_left_out_exists() -> None:
    assert all(importlib.util.find_spec(name) for name in STRANGE | SHAPED | REDUNDANT | RARE)


def test_validate_and_import_do_without_numpy() -> None:
    found = loaded("validate", "-", text=CHAIN)
    assert "heuncli.scene.file_format.load" in found
    assert not found & (STRANGE | {"numpy", "heuncli.scene.importers"})
    found = loaded("import", str(ROOT / "specs" / "arm.urdf"))
    assert "heuncli.scene.importers.urdf.reader" in found
    assert not found & (STRANGE | {"numpy", "heuncli.study"})


@pytest.mark.parametrize("words", [("--help",), ("run", "--help"), ("--version",), ("explain", "format")])
def test_help_and_version_do_without_the_heavy_ones(words: tuple[str, ...]) -> None:
    found = loaded(*words) - loaded_by("typer")
    assert not found & {"numpy", "scipy", "yaml", "rich", "heuncli.scene.file_format.load"}


@pytest.mark.parametrize("words", ["--version", "--help"])
def test_what_is_answered_at_once_needs_next_to_nothing(words: str) -> None:
    """Beside what Python loads when it starts."""
    code = (
        "import os, sys; before = {*sys.modules}; from heuncli.app.cli import terminal; "
        "terminal.try_answer(sys.argv[1:])"
    )
    shown = "print(*sorted({*sys.modules} - before), file=sys.stderr)"
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    run = subprocess.run(
        [sys.executable, "-S", "-c", f"{code}\n{shown}", words],
        capture_output=True, text=True, check=True, env={**os.environ, "PYTHONPATH": path, "COLUMNS": "80"},
    )  # fmt: skip
    costly = {"typing", "collections", "enum", "functools", "re", "contextlib", "pathlib", "dataclasses", "inspect"}
    assert run.stdout and not (costly | {"typer", "numpy", "yaml", "pydantic_core"}) & {*run.stderr.split()}
