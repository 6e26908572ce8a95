"""HEUN_KERNEL at run time: which form of the kernel is loaded, and what is said when it cannot be."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from heuncli.kernel import choose, form

ROOT = form.FOLDER.parent.parent
REPORT = """\
import json, sys
from heuncli.kernel import choose, form
print(json.dumps([form.KERNEL, [sys.modules[f"heuncli.kernel.{name}"].__file__ for name in form.MODULES]]))
"""


def loaded(wish: str | None) -> tuple[str, list[str]]:
    """Kernel, and the endings of the files its modules come from, in a fresh process."""
    env = {key: value for key, value in os.environ.items() if key != "HEUN_KERNEL"}
    env["PYTHONPATH"] = os.pathsep.join([str(ROOT), env.get("PYTHONPATH", "")])
    if wish is not None:
        env["HEUN_KERNEL"] = wish
    run = subprocess.run([sys.executable, "-c", REPORT], capture_output=True, text=True, check=True, env=env)
    kernel, files = json.loads(run.stdout)
    return kernel, [Path(file).suffix for file in files]


def test_pure_takes_the_plain_files_whatever_lies_beside_them() -> None:
    assert loaded("pure") == ("pure", [".py"] * len(form.MODULES))


def test_left_alone_it_takes_the_compiled_ones_if_all_are_there() -> None:
    kernel, endings = loaded(None)
    built = all(form.is_built(name) for name in form.MODULES)
    assert kernel == ("compiled" if built else "pure")
    assert all((ending == ".py") != built for ending in endings)


def test_what_runs_here_is_what_was_asked_for() -> None:
    """The suite itself: with HEUN_KERNEL=require it must not have fallen back."""
    wish = os.environ.get("HEUN_KERNEL", "")
    assert str(choose.steps.__file__).endswith(".py") == (form.KERNEL == "pure")
    assert form.KERNEL == {"require": "compiled", "compiled": "compiled", "pure": "pure"}.get(wish, form.KERNEL)


def test_one_module_missing_makes_all_of_them_plain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(form, "is_built", lambda name: name != "tree")
    assert form.choose("") == "pure"
    with pytest.raises(form.KernelError, match=r"missing: tree.*\[kernel-not-compiled\]") as error:
        form.choose("require")
    assert error.value.exit_code == 2
    assert "C compiler" in str(error.value)


def test_all_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(form, "is_built", lambda name: True)
    assert [form.choose(wish) for wish in ("", "compiled", "require", "pure")] == ["compiled"] * 3 + ["pure"]


def test_an_unknown_wish_is_an_error() -> None:
    with pytest.raises(form.KernelError, match=r"'fast'; known: pure, compiled, require \[unknown-kernel\]"):
        form.choose("fast")


def test_the_command_says_so_without_a_traceback() -> None:
    env = {**os.environ, "HEUN_KERNEL": "fast", "PYTHONPATH": str(ROOT)}
    run = subprocess.run([sys.executable, "-m", "heuncli", "--version"], capture_output=True, text=True, env=env)
    assert run.returncode == 2
    assert run.stdout == ""
    assert "Traceback" not in run.stderr
    assert "[unknown-kernel]" in run.stderr
