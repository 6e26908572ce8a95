"""What is said in more than one place about the package says the same."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from heuncli.kernel.choose import COMPILED_MODULES

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())


def test_the_modules_compiled_are_the_modules_chosen_between() -> None:
    extensions = PROJECT["tool"]["setuptools"]["ext-modules"]
    assert [extension["name"] for extension in extensions] == [f"heuncli.kernel.{name}" for name in COMPILED_MODULES]
    for extension in extensions:
        assert [ROOT / source for source in extension["sources"]] == [
            ROOT / f"{extension['name'].replace('.', '/')}.py"
        ]
        assert all((ROOT / source).exists() for source in extension["sources"])


def test_the_protected_modules_are_the_compiled_ones() -> None:
    contract = next(c for c in PROJECT["tool"]["importlinter"]["contracts"] if c["type"] == "protected")
    assert {f"heuncli.kernel.{name}" for name in COMPILED_MODULES} < set(contract["protected_modules"])


def test_nothing_is_needed_at_run_time_that_only_builds() -> None:
    assert not [need for need in PROJECT["project"]["dependencies"] if re.match("(?i)cython|setuptools", need)]


def test_the_readme_has_one_command_to_run_and_one_to_test() -> None:
    lines = (ROOT / "README.md").read_text().splitlines()
    runs = [line for line in lines if re.match(r"pip install .*&& heun run ", line)]
    tests = [line for line in lines if re.match(r"pip install .*&& pytest$", line)]
    assert (len(runs), len(tests)) == (1, 1)
    assert (ROOT / runs[0].split()[-1]).exists()
