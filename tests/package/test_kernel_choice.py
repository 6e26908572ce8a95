"""HEUN_KERNEL at run time: which form of the kernel is loaded, and what is said when it cannot be."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import time
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path

import pytest

from heuncli.app.cli import entry
from heuncli.kernel import choose, form
from heuncli.kernel.modules import SOURCES

ROOT = Path(form.FOLDER).parent.parent
REPORT = """\
import json, sys
from heuncli.kernel import choose, form
parts = (choose.enclosure, choose.expressions, choose.integration, choose.jets, choose.steps, choose.workspace)
print(json.dumps([form.KERNEL, sorted({part.__file__ for part in parts})]))
"""


def loaded(wish: str | None) -> tuple[str, list[str]]:
    """Kernel, and the endings of the files that its doors come from, in a fresh process."""
    env = {key: value for key, value in os.environ.items() if key != "HEUN_KERNEL"}
    env["PYTHONPATH"] = os.pathsep.join([str(ROOT), env.get("PYTHONPATH", "")])
    if wish is not None:
        env["HEUN_KERNEL"] = wish
    run = subprocess.run([sys.executable, "-c", REPORT], capture_output=True, text=True, check=True, env=env)
    kernel, files = json.loads(run.stdout)
    return kernel, [Path(file).suffix for file in files]


def test_pure_takes_the_plain_files_whatever_lies_beside_them() -> None:
    assert loaded("pure") == ("pure", [".py"] * 6)


def test_left_alone_it_takes_the_compiled_one_if_it_is_there() -> None:
    kernel, endings = loaded(None)
    if form.find_compiled():
        assert kernel == "compiled" and len(endings) == 1 and endings != [".py"]
    else:
        assert (kernel, endings) == ("pure", [".py"] * 6)


def test_what_runs_here_is_what_was_asked_for() -> None:
    """The suite itself: with HEUN_KERNEL=require it must not have fallen back."""
    wish = os.environ.get("HEUN_KERNEL", "")
    assert str(choose.steps.__file__).endswith(".py") == (form.KERNEL == "pure")
    assert form.KERNEL == {"require": "compiled", "compiled": "compiled", "pure": "pure"}.get(wish, form.KERNEL)


def test_nothing_compiled_is_plain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(form, "FILES", frozenset({"steps.py"}))
    assert form.choose_form("") == "pure"
    with pytest.raises(form.KernelError, match=r"no compiled kernel.*\[kernel-not-compiled\]") as error:
        form.choose_form("require")
    assert error.value.exit_code == 2
    assert "C compiler" in str(error.value)


@pytest.mark.parametrize("wish", ["", "compiled", "require", "pure"])
def test_it_is_there(wish: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(form, "FILES", frozenset({"steps.py", f"compiled{EXTENSION_SUFFIXES[0]}"}))
    monkeypatch.setattr(form, "edited_since_compiled", lambda _: [])
    assert form.choose_form(wish) == ("pure" if wish == "pure" else "compiled")


@pytest.mark.parametrize("wish", ["", "pure", "require"])
def test_modules_that_an_older_heun_compiled_are_not_mixed_in(wish: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(form, "FILES", frozenset({"steps.py", "steps.abi3.so", f"compiled{EXTENSION_SUFFIXES[0]}"}))
    with pytest.raises(form.KernelError, match=r"steps\.abi3\.so, 1 in total.*\[stale-kernel\]"):
        form.choose_form(wish)


def version_of(checkout: Path) -> subprocess.CompletedProcess[str]:
    """`heun --version` in a copy of the package."""
    env = {**os.environ, "PYTHONPATH": str(checkout), "HEUN_KERNEL": "require"}
    command = [sys.executable, "-m", "heuncli", "--version"]
    return subprocess.run(command, capture_output=True, text=True, cwd=checkout, env=env)


@pytest.mark.skipif(form.KERNEL == "pure", reason="nothing is compiled")
def test_a_kernel_compiled_from_older_text_is_not_run(tmp_path: Path) -> None:
    """What decides is the code, in a checkout alone: times of files, comments and docstrings may be anything."""
    shutil.copytree(ROOT / "heuncli", tmp_path / "heuncli", ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "pyproject.toml").touch()
    source = tmp_path / "heuncli" / "kernel" / "tree.py"
    tomorrow = time.time() + 86400.0
    os.utime(source, (tomorrow, tomorrow))
    assert version_of(tmp_path).returncode == 0
    text = source.read_text(encoding="utf-8")
    told = re.sub(r'^ {4}"""(?=\w)', '    """Another one.\n\n    ', text, flags=re.M).replace(
        " -> cython.void:\n", " -> cython.void:  # why\n"
    )
    assert told.count("Another one") > 10 and told.count("# why") > 1
    source.write_text(told + "# edited\n", encoding="utf-8")
    os.utime(source, (tomorrow, tomorrow))
    assert version_of(tmp_path).returncode == 0
    source.write_text(text + "EDITED = 1\n", encoding="utf-8")
    os.utime(source, (tomorrow, tomorrow))
    run = version_of(tmp_path)
    assert (run.returncode, run.stdout) == (2, "")
    assert "the compiled kernel is older than its source: tree.py changed since [stale-kernel]" in run.stderr
    assert "python -m heuncli.build" in run.stderr and "HEUN_KERNEL=pure" in run.stderr
    (tmp_path / "pyproject.toml").unlink()  # as it is where heun is installed
    assert version_of(tmp_path).returncode == 0


def test_a_message_names_some_of_what_was_edited(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(form, "find_compiled", lambda: "compiled.so")
    monkeypatch.setattr(form, "edited_since_compiled", lambda _: [*"abcdefg"])
    with pytest.raises(form.KernelError, match=r"a\.py, b\.py, c\.py, d\.py, e\.py and 2 more changed since"):
        form.choose_form("")
    assert form.choose_form("pure") == "pure"


@pytest.mark.skipif(form.KERNEL == "pure", reason="nothing is compiled")
def test_older_sources_that_differ_are_found_when_heun_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The kernel's file may be newer and yet of other structs: copied, or compiled on another branch."""
    assert form.find_stale_problem() is None
    kernel = tmp_path / "heuncli" / "kernel"
    kernel.mkdir(parents=True)
    (tmp_path / "pyproject.toml").touch()
    for name in SOURCES:
        shutil.copyfile(Path(form.FOLDER, f"{name}.py"), kernel / f"{name}.py")
    monkeypatch.setattr(form, "FOLDER", str(kernel))
    assert form.find_stale_problem() is None
    for name in ("scene", "values"):
        with (kernel / f"{name}.py").open("a", encoding="utf-8") as file:
            file.write("EDITED = 1\n")
    with pytest.raises(form.KernelError, match=r"scene\.py, values\.py changed since \[stale-kernel\]") as error:
        entry.run_contained(lambda: memoryview(b"")[1], ["run"])
    assert error.value.exit_code == 2 and "python -m heuncli.build" in str(error.value)


def test_an_unknown_wish_is_an_error() -> None:
    with pytest.raises(form.KernelError, match=r"'fast'; accepted: pure, compiled, require \[unknown-kernel\]"):
        form.choose_form("fast")


def test_the_command_says_so_without_a_traceback() -> None:
    env = {**os.environ, "HEUN_KERNEL": "fast", "PYTHONPATH": str(ROOT)}
    run = subprocess.run([sys.executable, "-m", "heuncli", "--version"], capture_output=True, text=True, env=env)
    assert run.returncode == 2
    assert run.stdout == ""
    assert "Traceback" not in run.stderr
    assert "[unknown-kernel]" in run.stderr
