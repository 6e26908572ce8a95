"""The names that users import: documented, typed, and loaded only where they are used."""

from __future__ import annotations

import inspect
import os
import subprocess
import sys
from pathlib import Path

import pytest

import heuncli
from heuncli.version import VERSION
from tests.shared.folders import ROOT

SAMPLE = """\
from pathlib import Path

import numpy as np

import heuncli


def peak(file: str, speed: float) -> float:
    heavier = {"bodies.rod.mass": np.float64(2)}
    study: heuncli.Solved = heuncli.solve(Path(file), n=f"{speed} rpm", set=heavier, tolerance=1e-8)
    force: heuncli.Signal = study["joints.main.force"]
    number: heuncli.Number = study.measure("max abs joints.main.force")
    at: float | None = number.at
    print(force.values[:, 2].max(), np.max(force), force.unit, force.error, at, force.at([0.0, 0.1]).shape)
    return 2.0 * number


def told(file: str) -> list[str]:
    try:
        cases: dict[str, heuncli.Solved] = heuncli.solve_cases(file)
    except heuncli.SpecError as error:
        return [f"{problem.location}: {problem.message} {problem.hint}" for problem in error.problems]
    return [str(study) for study in cases.values()]


def wrong() -> None:
    heuncli.solve("a.yaml", tolerance="fine")
    heuncli.solve("a.yaml")["energy.kinetic"].value
    heuncli.solved("a.yaml")
"""


def test_every_name_is_there_and_documented() -> None:
    assert set(heuncli.__all__) <= {*dir(heuncli)} and heuncli.__version__ == VERSION
    for name in heuncli.__all__:
        named = getattr(heuncli, name)
        assert name == "__version__" or (named.__doc__ and named.__name__ == name)
    for kind in (heuncli.Solved, heuncli.Signal, heuncli.Number, heuncli.Diagram):
        own = {name: each for name, each in vars(kind).items() if not name.startswith("_")}
        functions = [each for each in own.values() if inspect.isroutine(each) or isinstance(each, property)]
        assert all(inspect.getdoc(each) for each in functions)
    with pytest.raises(AttributeError, match="no attribute 'solved'"):
        heuncli.solved  # type: ignore[attr-defined]  # noqa: B018


def test_the_list_for_type_checkers_is_the_list() -> None:
    text = Path(heuncli.__file__).read_text(encoding="utf-8")
    for name, home in heuncli.HOME.items():
        assert f"    from heuncli.{home} import {name} as {name}\n" in text
    assert text.count("\n    from heuncli.") == len(heuncli.__all__)


def fresh(code: str) -> set[str]:
    path = os.pathsep.join([str(Path(heuncli.__file__).parents[1]), os.environ.get("PYTHONPATH", "")])
    run = subprocess.run(
        [sys.executable, "-c", f"{code}\nimport sys\nprint(*sys.modules)"],
        capture_output=True, text=True, check=True, env={**os.environ, "PYTHONPATH": path},
    )  # fmt: skip
    return set(run.stdout.splitlines()[-1].split())


def test_importing_loads_next_to_nothing() -> None:
    assert not [name for name in fresh("import heuncli") if name.startswith(("heuncli.", "numpy", "yaml"))]


def test_solving_loads_no_command_line() -> None:
    code = "import heuncli\nheuncli.solve(text='{heun: 1, bodies: {a: {mass: 1, center: [0,0,0], inertia: [0,0,0]}}}')"
    found = fresh(code)
    strange = ("heuncli.app.cli", "heuncli.app.commands", "scipy", "rich", "typer", "pandas", "matplotlib")
    assert not [name for name in found if name.startswith(strange)]


@pytest.mark.heavy
def test_an_example_of_use_is_typed(tmp_path: Path) -> None:
    """Strictly, as a package that was installed: by its py.typed."""
    api = pytest.importorskip("mypy.api")
    (tmp_path / "sample.py").write_text(SAMPLE)
    lines = SAMPLE.splitlines()
    # as strictly as the package itself, and with what the gate's own look at it has kept
    kept = ROOT / ".mypy_cache"
    cache = kept if os.access(kept if kept.exists() else ROOT, os.W_OK) else tmp_path  # of a checkout of somebody else
    options = ["--config-file", str(ROOT / "pyproject.toml"), "--cache-dir", str(cache)]
    told, complaint, _ = api.run([*options, "--no-error-summary", str(tmp_path / "sample.py")])
    wrong = [int(line.split(":")[1]) for line in told.splitlines() if "sample.py" in line and ": error:" in line]
    assert complaint == "" and wrong == [len(lines) - 2, len(lines) - 1, len(lines)], told
