"""What is said in more than one place about the package says the same."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from heuncli.kernel.modules import DECLARED, MODULES
from tests.shared.folders import KERNEL as FOLDER
from tests.shared.folders import ROOT

DECLARATIONS = "\nfrom heuncli.kernel.declarations import *\n"  # each module that is written for Cython begins with it
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())


def test_the_modules_compiled_are_those_written_for_cython() -> None:
    """And what they take from files that are not compiled is declared."""
    written = {path.stem for path in FOLDER.glob("*.py") if DECLARATIONS in path.read_text(encoding="utf-8")}
    assert sorted(MODULES) == sorted(written)
    for name in MODULES:
        text = (FOLDER / f"{name}.py").read_text(encoding="utf-8")
        taken = set(re.findall(r"^ *from heuncli\.kernel\.(\w+) import", text, re.M)) - {"libm", "declarations"}
        assert taken <= set(MODULES), name
    declared = set(
        re.findall(r"^from heuncli\.kernel\.(\w+) import \*$", (FOLDER / "declarations.py").read_text(), re.M)
    )
    assert declared == set(DECLARED)


def test_the_modules_of_the_kernel_are_listed_once() -> None:
    """In kernel/modules.py: what is compiled, checked and protected follows from there, or from the folder."""
    assert "ext-modules" not in PROJECT["tool"]["setuptools"]
    assert "heuncli/kernel/*.py" in PROJECT["tool"]["ruff"]["lint"]["per-file-ignores"]
    contract = next(c for c in PROJECT["tool"]["importlinter"]["contracts"] if c["type"] == "protected")
    assert contract["protected_modules"] == ["heuncli.kernel.*"]
    doors = {line.split(" -> ")[1] for line in contract["ignore_imports"]}
    assert doors == {"heuncli.kernel.choose", "heuncli.kernel.form"}


def test_nothing_is_needed_at_run_time_that_only_builds() -> None:
    assert not [need for need in PROJECT["project"]["dependencies"] if re.match("(?i)cython|setuptools", need)]


def test_what_is_no_module_is_handed_out_too() -> None:
    """Pages, their script and style, starters: every file of the package falls under a pattern of its data."""
    patterns = PROJECT["tool"]["setuptools"]["package-data"]["heuncli"]
    package = ROOT / "heuncli"
    handed = {path for pattern in patterns for path in package.glob(pattern)}
    built = {".py", ".pyc", ".so", ".pyd", ".c", ".pxd"}
    assert not {path for path in package.rglob("*") if path.is_file() and path.suffix not in built} - handed
    assert not [pattern for pattern in patterns if not any(package.glob(pattern))]


def test_the_readme_has_one_command_to_run_and_one_to_test() -> None:
    lines = (ROOT / "README.md").read_text().splitlines()
    runs = [line for line in lines if re.match(r"pip install .*&& heun run ", line)]
    tests = [line for line in lines if re.match(r"pip install .*&& pytest$", line)]
    assert (len(runs), len(tests)) == (1, 1)
    assert (ROOT / runs[0].split()[-1]).exists()


def test_installers_can_load_the_build_by_itself(tmp_path: Path) -> None:
    """They run it from its file, where the package cannot be imported."""
    pytest.importorskip("setuptools", "77")  # as pyproject.toml asks of the build: environments may have older ones
    code = (
        "import os, runpy, sys\n"
        "sys.path = [folder for folder in sys.path if not os.path.exists(os.path.join(folder, 'heuncli'))]\n"
        "sys.meta_path = [finder for finder in sys.meta_path if 'editable' not in str(finder)]\n"
        f"print(runpy.run_path({str(ROOT / 'heuncli' / 'build.py')!r})['BuildKernel'].__name__)\n"
    )
    env = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    run = subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, cwd=tmp_path, env=env)
    assert (run.stdout, run.returncode) == ("BuildKernel\n", 0), run.stderr


@pytest.mark.heavy
def test_a_failed_build_is_an_error_and_leaves_nothing_among_the_sources(tmp_path: Path) -> None:
    """Where there is no compiler: an error here, the plain files where it is installed (.ci/run)."""
    pytest.importorskip("setuptools", "77")
    pytest.importorskip("Cython")
    unwanted = shutil.ignore_patterns("__pycache__", "*.so", "*.pyd")
    shutil.copytree(ROOT / "heuncli", tmp_path / "heuncli", ignore=unwanted)
    for name in ("pyproject.toml", "README.md"):
        shutil.copy(ROOT / name, tmp_path)
    before = sorted(tmp_path.glob("heuncli/**/*.*"))
    env = {key: value for key, value in os.environ.items() if key != "HEUN_KERNEL"}
    env |= {"PYTHONPATH": str(tmp_path), "CC": "false", "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-m", "heuncli.build"]
    run = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=env)
    assert run.returncode == 1 and "'false'" in run.stderr
    assert sorted(tmp_path.glob("heuncli/**/*.*")) == before
