"""What the page on pipelines says to copy into a pipeline: each parsed, and each of its commands run as it stands."""

from __future__ import annotations

import contextlib
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from heuncli.app.cli.entry import enter
from tests.shared.folders import ROOT
from tests.shared.manual import blocks

pytestmark = pytest.mark.heavy  # whole runs of whole specs, by the command

PAGE = "pipelines"
WORKFLOW, JOB, HOOKS = (yaml.safe_load(text) for text in blocks(PAGE, "yml"))
(RULE,) = blocks(PAGE, "make")
FEW = ("double.yaml", "engine.yaml", "axle_loads.yaml")


@pytest.fixture(scope="module")
def approved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with specs and their golden files, not to be changed."""
    folder = tmp_path_factory.mktemp("approved")
    (folder / "specs").mkdir()
    for name in (*FEW, *(path.name for path in (ROOT / "specs").glob("*.csv"))):
        shutil.copy(ROOT / "specs" / name, folder / "specs" / name)
    with contextlib.chdir(folder):
        assert enter(["check", "specs", "--golden", "golden", "--update", "--force", "-q"]) == 0
    return folder


@pytest.fixture
def project(approved: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A project with specs and their golden files, in a pipeline."""
    shutil.copytree(approved, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(tmp_path / "summary.md"))
    monkeypatch.setenv("CI", "true")
    return tmp_path


def spoil(project: Path) -> None:
    """Change a load."""
    spec = project / "specs" / "double.yaml"
    spec.write_text(spec.read_text().replace("mass: 0.8", "mass: 0.81"))


def shell(line: str, project: Path) -> int:
    """Run a line of a shell, in which heun is that of this Python."""
    own = project / "bin"
    own.mkdir(exist_ok=True)
    (own / "heun").write_text(f'#!/bin/sh\nexec "{sys.executable}" -m heuncli "$@"\n')
    (own / "heun").chmod(0o755)
    env = {**os.environ, "PATH": f"{own}{os.pathsep}{os.environ['PATH']}"}
    return subprocess.run(line, shell=True, cwd=project, env=env, capture_output=True, check=False).returncode


def commands(steps: list[Any]) -> list[str]:
    return [line for line in steps if isinstance(line, str) and line.startswith("heun ")]


def test_the_workflow_runs_as_it_stands(project: Path) -> None:
    assert WORKFLOW.keys() == {"name", True, "jobs"}  # on is read as true by YAML, and by GitHub as on
    (job,) = WORKFLOW["jobs"].values()
    assert [step["uses"].split("@")[0] for step in job["steps"] if "uses" in step] == [
        "actions/checkout", "actions/setup-python",
    ]  # fmt: skip
    check, summary = commands([step.get("run") for step in job["steps"]])
    assert shell(check, project) == 0
    spoil(project)
    assert shell(check, project) == 1
    assert shell(summary, project) == 1
    assert (project / "summary.md").read_text().startswith("### heun check: failed\n")


def test_the_job_writes_its_report(project: Path) -> None:
    (job,) = JOB.values()
    (check,) = commands(job["script"])
    assert shell(check, project) == 0
    report = project / job["artifacts"]["reports"]["junit"]
    assert report.read_text().count("<testsuite ") == len(FEW)


def test_the_hook_checks_the_files_of_a_commit(project: Path) -> None:
    (hook,) = HOOKS["repos"][0]["hooks"]
    assert HOOKS["repos"][0]["repo"] == "local"
    assert {"id", "name", "entry", "language", "files"} == hook.keys()
    words = [*shlex.split(hook["entry"])[1:], "specs/double.yaml", "specs/engine.yaml"]
    assert enter(words) == 0
    spoil(project)
    assert enter(words) == 1


@pytest.mark.skipif(shutil.which("make") is None, reason="no make")
def test_the_rule_runs_where_a_spec_changed(project: Path) -> None:
    (project / "Makefile").write_text(RULE)
    assert shell("make golden/checked", project) == 0
    assert shell("make -q golden/checked", project) == 0
    spoil(project)
    assert shell("make golden/checked", project) != 0
