"""What holds for all tests: the kernel under test, what the plain one is spared, and the command in this process."""

from __future__ import annotations

import gc
import io
import os
import sys
from collections import defaultdict
from collections.abc import Generator
from pathlib import Path

import pytest

from heuncli.app.cli import timeout
from heuncli.app.cli.entry import enter
from heuncli.base.spelling import reset_effort
from heuncli.kernel.form import FOLDER, KERNEL  # refused where the compiled kernel is older than its text
from tests.shared.command import SPEC_TEXTS, Done, Heun
from tests.shared.processes import hand_down_signals
from tests.shared.seeds import list_long_cases

# Folders that judge numbers: the plain kernel gives the same bits (tests/package/test_kernels_agree.py), but slowly.
# And pictures, pages, reports, decks, collectives and what Python gets, which are shown numbers; and additions, which
# touch no kernel.
JUDGED = {"closed_forms", "convergence", "honesty", "limits"}
SHOWN = {"browser", "pictures", "report", "reporting", "show"}
SPARED = {*JUDGED, *SHOWN, "contributing", "exporting", "importing", "collectives", "python_api"}
# Of every other family of cases it runs one: enough to see what only plain Python does otherwise. These folders judge
# numbers, too, but random scenes pass every line of the kernel: of each file every second family.
DRAWN = {"laws", "oracle", "references"}


@pytest.fixture(autouse=True)
def suggestions() -> None:
    """Suggestions are limited file by file; a test that reads none is a file of its own."""
    reset_effort()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder of specs."""
    for name, text in SPEC_TEXTS.items():
        (tmp_path / f"{name}.yaml").write_text(text)
    return tmp_path


@pytest.fixture
def heun(folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Heun:
    """The command, run in the folder of specs; `text` is its standard input."""
    monkeypatch.chdir(folder)

    def run(*words: str, text: str = "") -> Done:
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(text.encode())))
        capsys.readouterr()
        code = enter(words)
        return Done(code, *capsys.readouterr())

    return run


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--all-cases", action="store_true", help="all cases, not those of every day alone")


def pytest_configure() -> None:
    """Processes that tests start take signals as on a terminal, and warnings are errors in them, too."""
    hand_down_signals()
    timeout.HARD_END = (
        600.0  # s: however slow the machine, a time limit of a command does not end the process of the tests
    )
    os.environ.setdefault("PYTHONWARNINGS", "error::RuntimeWarning")  # NumPy's; of these users would see the paths


def pytest_report_header() -> str:
    return f"heun: {KERNEL} kernel, {Path(FOLDER).parent}"


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Nothing of what is collected becomes garbage: it is not searched for any, now or while the tests run."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def is_spared(folder: Path) -> bool:
    """Whether a folder's tests are for the compiled kernel alone."""
    return KERNEL != "compiled" and folder.parent == Path(__file__).parent and folder.name in SPARED


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    """What the plain kernel is spared is not even imported, unless it is named."""
    return True if is_spared(collection_path) else None


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    named = any("[" in argument for argument in config.args)  # a case that is named runs
    long = set() if named or config.getoption("all_cases") else list_long_cases(items)
    keep(config, items, {item for item in items if item not in long})
    if KERNEL == "compiled":
        return
    files: defaultdict[Path, dict[str, pytest.Item]] = defaultdict(dict)  # a case of each family of a file
    for item in items:
        if not item.get_closest_marker("heavy") and not is_spared(item.path.parent):
            files[item.path].setdefault(item.nodeid.split("[")[0], item)
    shares = ([*cases.values()][:: 2 if file.parent.name in DRAWN else 1] for file, cases in files.items())
    keep(config, items, {case for share in shares for case in share})


def keep(config: pytest.Config, items: list[pytest.Item], kept: set[pytest.Item]) -> None:
    """Deselect all others."""
    config.hook.pytest_deselected(items=[item for item in items if item not in kept])
    items[:] = [item for item in items if item in kept]
