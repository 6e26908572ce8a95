"""An addition to a copy of the package: the edits that manual/contributing.md lists, no other, and what then runs."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from tests.shared.folders import ROOT
from tests.shared.manual import TEXTS, below

CITED = re.compile(r"`((?:heuncli|tests|specs|README)[\w./-]*)`")


class Edit(NamedTuple):
    """A passage of a file, which stands there once, and what stands in its place afterwards."""

    passage: str
    becomes: str


def after(passage: str, more: str) -> Edit:
    """The passage with more behind it."""
    return Edit(passage, passage + more)


class Addition(NamedTuple):
    """What is added. heading: that of its list in manual/contributing.md.

    edits: of files of the package that there are; files: new ones with their text, in the package or beside it.
    """

    heading: str
    edits: Mapping[str, tuple[Edit, ...]]
    files: Mapping[str, str] = {}

    def made_in(self, folder: Path) -> Path:
        """The folder with a copy of the package in it, to which it is added."""
        shutil.copytree(ROOT / "heuncli", folder / "heuncli")
        for name, edits in self.edits.items():
            text = (folder / name).read_text(encoding="utf-8")
            for passage, becomes in edits:
                assert text.count(passage) == 1, f"{name} does not hold this once:\n{passage}"
                text = text.replace(passage, becomes)
            (folder / name).write_text(text, encoding="utf-8")
        for name, text in self.files.items():
            (folder / name).parent.mkdir(exist_ok=True)
            (folder / name).write_text(text, encoding="utf-8")
        return folder

    def is_as_listed(self) -> bool:
        """Whether the list names the files of the package that are touched, and only these; a new one by its folder."""
        parents = [Path(name).parents for name in self.files if name.startswith("heuncli/")]
        new = {next(f"{folder}/" for folder in above if (ROOT / folder).is_dir()) for above in parents}
        return {name for name in cited(self.heading) if name.startswith("heuncli/") and not is_page(name)} == {
            *self.edits, *new
        }  # fmt: skip


def cited(heading: str) -> list[str]:
    """The files and folders that the list below a heading of the page names."""
    start, end = below(TEXTS["contributing"], heading)
    return CITED.findall(TEXTS["contributing"][start:end])


def is_page(name: str) -> bool:
    """Whether a file is one of the manual's."""
    return name.startswith("heuncli/manual/")


def heun(folder: Path, *words: str, text: str = "") -> subprocess.CompletedProcess[str]:
    """The command of the package in a folder, as a process of its own; text: its standard input."""
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    return subprocess.run(
        [sys.executable, "-m", "heuncli", *words],
        input=text, capture_output=True, text=True, cwd=folder, env=environment, timeout=60, check=False,
    )  # fmt: skip


def answers(folder: Path, text: str, paths: Sequence[str], *words: str) -> list[float]:
    """What `heun run - --measure` answers there to each path, such as `final energy.kinetic`."""
    asked = [word for path in paths for word in ("--measure", path)]
    done = heun(folder, "run", "-", *asked, *words, text=text)
    told = [line for line in done.stderr.splitlines() if not line.startswith("unit: ")]
    assert (done.returncode, told) == (0, []), done.stderr
    return [float(line.split()[-1]) for line in done.stdout.splitlines()]
